//! What every strategy promises, checked for every line of the table: a new entry is covered without a change here.

mod coverage;
mod discipline;
mod meeting;
#[cfg(feature = "openmp")]
mod openmp;
mod panics;
mod panics_everywhere;
mod parallelism;
mod spawn_failure;
mod support;
#[path = "../support/watchdog.rs"]
mod watchdog;

use std::collections::HashSet;

use pathmark::strategy::{Config, STRATEGIES, StrategyError, find};

use support::{TestSpawner, guarded, threads};

#[test]
fn names_are_unique_kebab_case_words_and_are_found() {
    let names: HashSet<_> = STRATEGIES.iter().map(|entry| entry.name).collect();
    assert_eq!(names.len(), STRATEGIES.len());
    for entry in STRATEGIES {
        assert!(entry.name.bytes().all(|byte| byte.is_ascii_lowercase() || byte == b'-'), "{}", entry.name);
        assert!(!entry.about.is_empty() && !entry.about.contains('\n'), "{}", entry.name);
        assert_eq!(find(entry.name).unwrap().name, entry.name);
    }
    assert!(find("no-such-strategy").is_none());
}

#[test]
fn a_parameter_that_means_nothing_is_refused() {
    for entry in STRATEGIES {
        guarded(entry.name, || {
            let config = Config { parameter: Some("no-such-parameter".to_owned()), ..Config::new(threads(2)) };
            let error = (entry.new)(config).err().unwrap_or_else(|| panic!("{} took it", entry.name));
            assert!(matches!(&error, StrategyError::Parameter { strategy, .. } if *strategy == entry.name), "{error}");
            assert!(error.to_string().contains("no-such-parameter"), "{error}");
        });
    }
}

#[test]
fn rayon_refuses_more_threads_than_it_would_start() {
    for name in ["rayon", "rayon-join", "rayon-scope"] {
        guarded(name, move || {
            let spawner = TestSpawner::unlimited();
            let asked = threads(rayon::max_num_threads() + 1);
            let error = (find(name).unwrap().new)(spawner.config(asked)).err().unwrap();
            assert!(matches!(error, StrategyError::TooManyThreads { strategy, .. } if strategy == name), "{error}");
            assert_eq!(spawner.asked(), 0);
        });
    }
}
