//! The page's server from outside: who is let in, what is said, what hostile bytes do.

mod client;
mod guard;
mod hostile;
mod session;
