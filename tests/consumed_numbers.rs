//! What estimators do with random numbers, seen through samplers of our own: R09 and R13 of the catalogue of hard cases.

use pathmark::estimator::{Bsdf, Estimator, Options, Probe, Smallpt};
use pathmark::math::Rgb;
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler};
use pathmark::scene::{AllEffects, load};
use std::collections::HashSet;
use std::sync::Mutex;

/// Passes numbers on and writes down what they were for.
struct Ledger(Mutex<Vec<Address>>);

impl Sampler for Ledger {
    fn pair(&self, at: Address) -> [f64; 2] {
        self.0.lock().unwrap().push(at);
        Independent.pair(at)
    }
}

const OPTIONS: Options = Options { max_depth: None, roulette: None };

/// R13: within a sample no number is used twice, also where glass splits the path; and every estimator draws for its own sample only.
#[test]
fn no_number_is_used_twice() {
    let scene = load("cornell").unwrap();
    let view = scene.camera.view(64, 48);
    let mut branched = false;
    for pixel in 0..64 * 48 {
        let ledger = Ledger(Mutex::new(Vec::new()));
        let key = SampleKey { seed: 3, pixel, sample: 0 };
        let ray = view.ray::<AllEffects>(pixel % 64, pixel / 64, 0, [0.5, 0.5], || [0.5; 2]);
        for splitting in [true, false] {
            if splitting {
                Smallpt::new(OPTIONS).sample::<_, AllEffects, ()>(&scene, ray, key, &ledger, &mut ());
            } else {
                Bsdf::new(OPTIONS).sample::<_, AllEffects, ()>(&scene, ray, key, &ledger, &mut ());
            }
            let used = std::mem::take(&mut *ledger.0.lock().unwrap());
            assert!(used.iter().all(|at| at.key == key && at.bounce > 0 && at.purpose != Purpose::Film));
            assert_eq!(used.iter().collect::<HashSet<_>>().len(), used.len(), "pixel {pixel}: {used:?}");
            branched |= splitting && used.iter().any(|at| at.branch > 0);
            assert!(splitting || used.iter().all(|at| at.branch == 0), "bsdf does not split");
        }
    }
    assert!(branched, "no path was split");
}

/// The same pair for every use.
struct Always([f64; 2]);

impl Sampler for Always {
    fn pair(&self, _at: Address) -> [f64; 2] {
        self.0
    }
}

#[derive(Default)]
struct Escapes(u32);

impl Probe for Escapes {
    fn escaped(&mut self) {
        self.0 += 1;
    }
}

/// R09: the extremes of [0, 1) through every consumer: finite, no leak, an end. (1 itself is excluded by the conversion, R10.)
#[test]
fn extreme_numbers_do_no_harm() {
    let scene = load("cornell").unwrap().in_equilibrium();
    let view = scene.camera.view(16, 12);
    let last = 1.0 - f64::EPSILON / 2.0;
    for u in [[0.0, 0.0], [0.0, last], [last, 0.0], [last, last], [0.0, 0.5], [0.5, last]] {
        for pixel in 0..16 * 12 {
            let (key, sampler) = (SampleKey { seed: 0, pixel, sample: 0 }, Always(u));
            let ray = view.ray::<AllEffects>(pixel % 16, pixel / 16, pixel % 4, u, || u);
            let mut escapes = Escapes::default();
            let radiance: Rgb =
                Smallpt::new(OPTIONS).sample::<_, AllEffects, _>(&scene, ray, key, &sampler, &mut escapes);
            assert!(radiance.is_valid_radiance(), "numbers {u:?}, pixel {pixel}: {radiance:?}");
            assert_eq!(escapes.0, 0, "numbers {u:?}, pixel {pixel}: left the closed box");
        }
    }
}
