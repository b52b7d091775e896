//! `outside`: Pathmark's command line with an additional pool, estimator and workload.

use std::process::ExitCode;

fn main() -> ExitCode {
    pathmark::main(outside::lab())
}
