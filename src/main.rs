//! The program `pathmark`. `pathmark --help` lists its verbs.

use pathmark::measure::Stamp;
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: pathmark::Allocator = pathmark::Allocator;

fn main() -> ExitCode {
    Stamp { commit: env!("PATHMARK_COMMIT"), is_dirty: env!("PATHMARK_DIRTY") == "true" }.set();
    pathmark::main(pathmark::Lab::new())
}
