//! The program `pathmark`. `pathmark --help` lists its verbs.

use std::process::ExitCode;

fn main() -> ExitCode {
    pathmark::Lab::new().main()
}
