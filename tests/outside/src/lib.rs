//! A pool, an estimator and a workload outside Pathmark.

mod depth;
mod pool;
mod primes;

pub use depth::Depth;
pub use pool::ENTRY;
pub use primes::Primes;

/// Pathmark with the additions of this crate.
pub fn lab() -> pathmark::Lab {
    let lab = pathmark::Lab::new().name("relay-race").version(env!("CARGO_PKG_VERSION"));
    lab.strategy(ENTRY).estimator("depth", Depth).workload("primes", Primes).experiment("ours", OURS)
}

/// An experiment over this crate's additions and built-in entries: thread scaling and granularity on two workloads.
const OURS: &str = r#"
title = "Our pool"
question = "Is it any good?"
analysis = "See the figures."
figures = ["speedup", "granularity"]

[[matrix]]
scene = ["primes", "cornell"]
estimator = ["depth"]
spp = [4]
seed = [1]
strategy = ["serial", "relay", "work-stealing"]
threads = [1, 2]
decomposition = ["rows", "tiles:8x8", "tiles:4x4"]

[quick]
size = [32, 24]
repetitions = 3

[full]
size = [64, 48]
repetitions = 3
"#;
