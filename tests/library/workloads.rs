//! Workloads other than light keep the same promise: one result with every strategy and decomposition.

use pathmark::kernel::workload::WORKLOADS;
use pathmark::measure::{Record, Settings, Setup};
use pathmark::strategy::STRATEGIES;
use std::collections::BTreeSet;

fn settings(workload: &str, strategy: &str, decomposition: &str) -> Settings {
    let mut settings = Settings {
        scene: workload.to_string(),
        spp: 32,
        decomposition: decomposition.to_string(),
        strategy: strategy.to_string(),
        threads: 2,
        ..Settings::default()
    };
    (settings.spec.width, settings.spec.height, settings.spec.seed) = (12, 9, 3);
    settings
}

#[test]
fn every_strategy_and_decomposition_gives_the_same_result() {
    for workload in WORKLOADS {
        let mut checksums = BTreeSet::new();
        for strategy in STRATEGIES {
            for decomposition in ["rows", "tiles:4x4:hilbert", "samples:16"] {
                let outcome =
                    Setup::prepare(settings(workload.name, strategy.name, decomposition)).unwrap().run(None).unwrap();
                assert_eq!((outcome.counts.paths, outcome.counts.invalid), (12 * 9 * 32, 0), "{}", workload.name);
                checksums.insert(outcome.checksum.unwrap());
            }
        }
        assert_eq!(checksums.len(), 1, "{}: {checksums:?}", workload.name);
    }
}

#[test]
fn a_row_describes_the_work_and_no_light() {
    let setup = Setup::prepare(settings("mandelbrot", "rayon", "rows")).unwrap();
    let row = Record::new(&setup, &setup.run(None).unwrap());
    assert_eq!((row.scene.as_str(), row.kernel.as_str(), row.jobs), ("mandelbrot", "workload", 9));
    assert_eq!([row.estimator, row.sampler, row.effects, row.accelerator, row.roulette], [const { String::new() }; 5]);
    assert_eq!(setup.image_key().scene_hash, row.scene_hash);
}

/// Another seed changes the result of a workload that draws random numbers.
#[test]
fn seeds_change_the_drawn_numbers() {
    let checksum = |seed: u64| {
        let mut settings = settings("costs-exponential", "serial", "rows");
        settings.spec.seed = seed;
        Setup::prepare(settings).unwrap().run(None).unwrap().checksum
    };
    assert_ne!(checksum(1), checksum(2));
}
