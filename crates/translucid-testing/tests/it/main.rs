//! The order of the code: what imports what, in every crate, and which crates come from elsewhere; and that of the book:
//! which command writes a table.

mod book;
mod circles;
mod dependencies;
mod floors;
mod imports;
mod measured_tables;
