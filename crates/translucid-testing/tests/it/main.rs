//! The order of the code: what imports what, in every crate, and which crates come from elsewhere.

mod budget;
mod circles;
mod dependencies;
mod floors;
mod imports;
