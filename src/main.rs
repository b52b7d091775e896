//! Pathmark.
fn main() {}
