//! OpenMP's strategies keep the contract, too, and report a team that OpenMP would silently make too small.

use std::env;
use std::num::NonZeroUsize;
use std::process::Command;
use std::sync::Arc;

use pathmark_strategy::{Config, STRATEGIES, StrategyError, find};

/// The environment variable that OpenMP reads once, when its program starts.
const LIMIT: &str = "OMP_THREAD_LIMIT";

const NAMES: [&str; 3] = ["openmp-static", "openmp-dynamic", "openmp-guided"];

/// A separate test, because the feature does not affect the other strategies: those tested without it need no second
/// test.
#[test]
fn every_strategy_on_openmp_keeps_the_contract() {
    let ours = |name: &str| NAMES.contains(&name);
    let plain = STRATEGIES.iter().filter(|entry| ours(entry.name)).map(|entry| (entry, None));
    let trials: Vec<_> = plain.chain(super::parameters().filter(|(entry, _)| ours(entry.name))).collect();
    assert_eq!(trials.len(), 9, "three strategies, and two of them with three parameters");
    super::verify_all(&trials);
}

/// A limit in the environment would silently give a smaller team, and a record with a wrong number of threads. This
/// test runs itself again under such a limit.
#[test]
fn a_team_that_is_too_small_is_an_error() {
    if env::var_os(LIMIT).is_none() {
        let mut again = Command::new(env::current_exe().expect("a test is a program"));
        again.args(["openmp::a_team_that_is_too_small_is_an_error", "--exact"]).env(LIMIT, "2");
        let output = again.output().expect("a program that runs can be run");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        assert!(String::from_utf8_lossy(&output.stdout).contains("1 passed"), "nothing was tried");
        return;
    }
    for strategy in NAMES {
        let run = |threads: usize| {
            let config = Config::new(NonZeroUsize::new(threads).expect("at least one thread"));
            let made = find(strategy).expect("it is in the table").build(config);
            made.and_then(|mut strategy| strategy.run(100, Arc::new(|_| ())))
        };
        assert!(run(2).is_ok(), "{strategy}");
        let beyond = run(3).expect_err("OpenMP gives two");
        assert!(matches!(beyond, StrategyError::TooManyThreads { threads: 3, most: 2, .. }), "{strategy}: {beyond}");
    }
}
