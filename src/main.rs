//! The program `pathmark`. `pathmark --help` lists its verbs.

use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: pathmark::Allocator = pathmark::Allocator;

fn main() -> ExitCode {
    pathmark::Lab::new().main()
}
