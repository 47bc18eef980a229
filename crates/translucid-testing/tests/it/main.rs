//! The order of the code: what imports what, in every crate.

mod circles;
mod floors;
mod imports;
