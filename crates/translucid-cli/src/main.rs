//! The `translucid` command.
fn main() {}
