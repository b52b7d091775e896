//! Our strategies keep the contract, and the contract notices strategies that don't.

mod broken;
#[cfg(feature = "openmp")]
mod openmp;
mod refusals;

use std::sync::Mutex;
use std::thread;

use pathmark_strategy::contract::Contract;
use pathmark_strategy::{Entry, STRATEGIES, find};

/// As `contract::verify`; if `PATHMARK_THOROUGH` is set, with a panic in each of a thousand jobs.
fn verify(entry: &Entry, parameter: Option<&str>) {
    let thorough = std::env::var_os("PATHMARK_THOROUGH").is_some();
    let contract = Contract { thorough, parameter: parameter.map(str::to_owned), ..Contract::default() };
    contract.verify(entry).unwrap_or_else(|violations| panic!("{}: {violations:#?}", entry.name));
}

/// Runs eight trials at a time, because a trial mostly waits. With many more, waiting for each other could use up the
/// patience.
fn verify_all(trials: &[(&Entry, Option<&str>)]) {
    let next = Mutex::new(trials.iter());
    thread::scope(|scope| {
        for _ in 0..8 {
            scope.spawn(|| {
                while let Some((entry, parameter)) = { next.lock().unwrap().next() } {
                    verify(entry, *parameter);
                }
            });
        }
    });
}

#[test]
fn every_strategy_keeps_the_contract() {
    verify_all(&STRATEGIES.iter().map(|entry| (entry, None)).collect::<Vec<_>>());
}

/// Every parameter that a strategy's documentation names.
const PARAMETERS: &[(&str, &[&str])] = &[
    ("dynamic", &["1", "2", "7", "5000"]),
    ("mfac", &["0", "50", "100000"]),
    #[cfg(feature = "more-pools")]
    ("orx-parallel", &["1", "7", "5000"]),
    ("steal-one", &["neighbour", "random", "richest"]),
    ("steal-half", &["neighbour", "random", "richest"]),
    ("weighted-factoring", &["1", "1:0.5"]),
    #[cfg(feature = "openmp")]
    ("openmp-dynamic", &["1", "7", "5000"]),
    #[cfg(feature = "openmp")]
    ("openmp-guided", &["1", "7", "5000"]),
];

fn parameters() -> impl Iterator<Item = (&'static Entry, Option<&'static str>)> {
    PARAMETERS.iter().flat_map(|(name, parameters)| {
        let entry = find(name).expect("it is in the table");
        parameters.iter().map(move |&parameter| (entry, Some(parameter)))
    })
}

#[test]
fn every_parameter_keeps_the_contract() {
    verify_all(&parameters().collect::<Vec<_>>());
    // Every strategy with a parameter is in the list.
    let listed = |entry: &&Entry| PARAMETERS.iter().any(|(name, _)| *name == entry.name);
    assert!(STRATEGIES.iter().filter(|entry| entry.parameter.is_some()).all(|entry| listed(&entry)));
}
