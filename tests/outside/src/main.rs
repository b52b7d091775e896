//! `outside`: the command line of Pathmark with a pool, an estimator and a workload more.

use std::process::ExitCode;

fn main() -> ExitCode {
    outside::lab().main()
}
