//! Bias of depth limits and clamps, and the warnings about it.

use crate::Trials;
use crate::estimator::ESTIMATORS;
use crate::exact::{Bench, arriving_estimators, critical, full_estimators, mean, with_kernels};
use crate::kernel::Spec;
use crate::measure::{Record, Settings, Setup, Warning};
use crate::rendering::{run, spec};
use crate::scene::load;
use crate::stage::{diffuse, hollow};
use std::sync::Arc;

/// The cut removes 59.0 % of the light after 5 vertices of albedo 0.9, 0.515 % after 50, and 60.6 % after 500 of
/// albedo 0.999.
pub(super) fn depth(trials: &mut Trials) {
    for (rho, vertices, missing) in
        [(0.9, 1, 0.9), (0.9, 5, 0.590_49), (0.9, 50, 0.005_153_775_207), (0.999, 500, 0.606_378_944_861)]
    {
        let scene = hollow(&diffuse(rho), [1.0; 3]);
        let what = format!("rho {rho}, {vertices} vertices");
        let mut bench = Bench::new(trials);
        bench.max_depth = Some(vertices - 1);
        bench.roulette = Some("never".to_string());
        // Without roulette nothing is random.
        for (way, film) in bench.films(&scene, arriving_estimators(), 4096.0) {
            let missed = 1.0 - mean(&film, 0).0 * (1.0 - rho);
            bench.trials.close(format!("{what}: missing, {way}"), missing, missed, 1e-11);
        }
        bench.roulette = None;
        bench.widest = if rho > 0.9 { [5e-2, 2e-3] } else { [2e-2, 2e-3] };
        bench.each(&what, &scene, arriving_estimators(), &[(1.0 - missing) / (1.0 - rho)]);
    }
    on_record(trials);
}

/// A record names the cut and calls the image biased. It reports neither for an image without a cut.
fn on_record(trials: &mut Trials) {
    let scene = Arc::new(load("cornell").expect("a shipped scene"));
    for entry in ESTIMATORS {
        for max_depth in [None, Some(2)] {
            let spec = Spec { width: 8, height: 6, estimator: entry.name.into(), max_depth, ..Spec::default() };
            let settings = Settings { spp: 4, spec, threads: 1, ..Settings::default() };
            let setup = Setup::for_scene(Arc::clone(&scene), settings).expect("settings that fit");
            let outcome = setup.run(None).expect("a render");
            let is_warned = outcome.warnings.contains(&Warning::Biased);
            let is_cut = outcome.counts.truncated > 0;
            let record = Record::new(&setup, &outcome);
            let depth = max_depth.or(entry.max_depth);
            trials.same(
                format!("{max_depth:?}, {}: depth on record, biased, warned, cut", entry.name),
                (depth, depth.is_some(), depth.is_some(), depth.is_some()),
                (record.max_depth, record.biased, is_warned, is_cut),
            );
        }
    }
}

/// With roulette from the first vertex on, a sample is a tenth of the number of vertices, G/10. Clamped at 1 its mean
/// is (1 - 0.9^10)/(1 - 0.9)/10 = 0.6513215599 instead of 1; clamped at 2, it is (1 - 0.9^20) = 0.8784233454. With one
/// sample in each subpixel, both clamps cut the same.
pub(super) fn clamp(trials: &mut Trials) {
    let scene = hollow(&diffuse(0.9), [0.1; 3]);
    let side = trials.times(128, 2048) as u32;
    for (estimator, kernel) in with_kernels(full_estimators()) {
        let arrives = arriving_estimators().any(|name| name == estimator);
        let is_one_path = ESTIMATORS.iter().any(|entry| entry.name == estimator && entry.is_one_path);
        for clamp in [None, Some("subpixel"), Some("recursion"), Some("subpixel:2"), Some("recursion:2")] {
            if !arrives || (clamp.is_some_and(|clamp| clamp.starts_with("recursion")) && !is_one_path) {
                continue;
            }
            let (roulette, own) = (Some("albedo:0".to_string()), clamp.map(str::to_string));
            let spec = Spec { roulette, clamp: own, ..spec(estimator, kernel, [side; 2], 1) };
            let outcome = run(&scene, spec, 4);
            let exact =
                clamp.map_or(1.0, |clamp| if clamp.ends_with(":2") { 0.878_423_345_4 } else { 0.651_321_559_9 });
            let what = format!("{}, {estimator}, {kernel}", clamp.unwrap_or("none"));
            // A film sums the squares of the unclamped samples, so the standard error comes from the scatter of the
            // pixels.
            let pixels = outcome.film.pixels().iter().map(|pixel| pixel.mean()[0]);
            let moments = crate::analysis::mean::Moments::of(&pixels.collect::<Vec<f64>>());
            let (found, error) = (moments.mean().unwrap_or(f64::NAN), moments.standard_error().unwrap_or(f64::NAN));
            trials.holds(
                &what,
                format_args!("{exact} +- 2 %"),
                format_args!("{found} +- {:.1e}", critical() * error),
                (found - exact).abs() < critical() * error && critical() * error < 0.02 * exact,
            );
            let is_warned = outcome.warnings.contains(&Warning::Biased);
            trials.same(format!("{what}: called biased"), clamp.is_some(), is_warned);
        }
    }
}
