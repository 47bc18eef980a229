//! Writes the tables that the examples `fit_similarity` and `similarity` take in place of making them anew.
//!
//! ```text
//! cargo run --release -p translucid-fit -F generators --example similarity_tables > target/similarity_tables.csv
//! ```
//!
//! Some seven minutes of one core. The seed is fixed, and the numbers do not depend on the threads.

#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a table and the progress")]

#[path = "similarity/tables.rs"]
mod tables;

use tables::{Table, cases};

fn main() {
    let cases = cases();
    for (i, case) in cases.iter().enumerate() {
        eprintln!("{} of {}: {case:?}", i + 1, cases.len());
        print!("{}", Table::new(*case).write());
    }
}
