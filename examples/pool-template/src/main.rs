//! Pathmark's command line with one more pool and one more experiment.

mod pool;

use std::process::ExitCode;

fn main() -> ExitCode {
    let lab = pathmark::Lab::new().name("my-pool").version(env!("CARGO_PKG_VERSION"));
    pathmark::main(lab.strategy(pool::ENTRY).experiment("bench", include_str!("../bench.toml")))
}
