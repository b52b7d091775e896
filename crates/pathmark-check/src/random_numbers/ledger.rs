//! Use of random numbers: each address at most once in a sample: R13.

use super::keyed;
use crate::Trials;
use crate::bare_scene::every_accelerated_scene;
use crate::estimator::{AnyEstimator, ESTIMATORS, Options, any_estimator, camera_ray, extra_camera_rays};
use crate::sampling::{Address, SampleKey, Sampler};
use crate::scene::{AllEffects, Scene};
use std::collections::HashSet;
use std::sync::{Mutex, PoisonError};

/// A sampler that records the addresses of the random numbers that it returns.
struct Ledger {
    sampler: Box<dyn Sampler>,
    used: Mutex<Vec<Address>>,
}

impl Sampler for Ledger {
    fn pair(&self, at: Address) -> [f64; 2] {
        self.used.lock().unwrap_or_else(PoisonError::into_inner).push(at);
        self.sampler.pair(at)
    }
}

/// Samples of some pixels, to be taken by an estimator. Counts the random numbers used, those used twice, those of
/// another sample, and those of a branch where the estimator does not branch.
struct Samples<'a> {
    scene: &'a Scene,
    pixels: u32,
    is_one_path: bool,
    ledger: &'a Ledger,
}

#[derive(Default)]
struct Found {
    used: u64,
    twice: u64,
    foreign: u64,
    branches: u64,
}

impl Found {
    fn add(&mut self, other: &Self) {
        self.used += other.used;
        self.twice += other.twice;
        self.foreign += other.foreign;
        self.branches += other.branches;
    }
}

impl Samples<'_> {
    fn by(self, estimator: &dyn AnyEstimator) -> Found {
        let Self { scene, pixels, is_one_path, ledger } = self;
        let view = scene.camera.view(16, 12);
        let mut found = Found::default();
        for pixel in (0..16 * 12).step_by((192 / pixels) as usize) {
            let key = SampleKey { seed: 3, pixel, sample: pixel % 8 };
            let place = [pixel % 16, pixel / 16];
            let ray = camera_ray::<Ledger, AllEffects, ()>(&view, place, key, 0, ledger, &mut ());
            estimator.estimate(scene, ray, key, ledger, &mut ());
            extra_camera_rays(scene, &view, place, key, 3, ledger, &mut ());
            let used = std::mem::take(&mut *ledger.used.lock().unwrap_or_else(PoisonError::into_inner));
            found.used += used.len() as u64;
            found.twice += (used.len() - used.iter().collect::<HashSet<_>>().len()) as u64;
            found.foreign += used.iter().filter(|at| at.key != key).count() as u64;
            // At the camera, branches are other rays.
            let branches = used.iter().filter(|at| at.bounce > 0 && at.branch > 0).count() as u64;
            found.branches += branches;
            found.foreign += if is_one_path { branches } else { 0 };
        }
        found
    }
}

pub(super) fn once(trials: &mut Trials) {
    let pixels = trials.times(4, 192) as u32;
    let ledgers: Vec<(&str, Ledger)> =
        keyed().map(|(name, sampler)| (name, Ledger { sampler, used: Mutex::new(Vec::new()) })).collect();
    let mut all: Vec<Vec<Found>> =
        ESTIMATORS.iter().map(|_| ledgers.iter().map(|_| Found::default()).collect()).collect();
    for scene in every_accelerated_scene() {
        let lit = scene.lit(&scene.camera.view(16, 12));
        for (entry, all) in ESTIMATORS.iter().zip(&mut all) {
            // An endless mirror room would reach the maximum number of bounces.
            let options = Options { max_depth: entry.max_depth.or(Some(100)), ..Options::default() };
            for ((_, ledger), all) in ledgers.iter().zip(all) {
                let scene = if entry.aims { &lit } else { &scene };
                let samples = Samples { scene, pixels, is_one_path: entry.is_one_path, ledger };
                all.add(&any_estimator(entry.name, options).map(|any| samples.by(&*any)).unwrap_or_default());
            }
        }
    }
    for (entry, all) in ESTIMATORS.iter().zip(&all) {
        for ((name, _), found) in ledgers.iter().zip(all) {
            let variant = format!("{}, {name}", entry.name);
            trials.never(&variant, "numbers that were used twice", found.twice, found.used);
            trials.never(&variant, "numbers of another sample or of a branch that is none", found.foreign, found.used);
        }
    }
    let branches: u64 = all.iter().flatten().map(|found| found.branches).sum();
    trials.at_least("numbers of branches, where paths are split", 1.0, branches as f64);
}
