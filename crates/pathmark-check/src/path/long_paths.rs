//! Paths that never end, or end only after thousands of bounces.

use crate::Trials;
use crate::analytic::corridors::corridor;
use crate::estimator::MAX_BOUNCES;
use crate::exact::{arriving_estimators, full_estimators, with_kernels};
use crate::film::{Bounds, Piece, PixelSum, TileBuffer};
use crate::kernel::{self, Counts, Spec};
use crate::measure::Warning;
use crate::rendering::{run, spec};
use crate::scene::Scene;
use crate::stage::{diffuse, hollow, mirror};
use std::sync::Arc;
use std::thread;

/// The samples of an image of one pixel, rendered in a thread with a small stack; the default in Rust is 2 MiB.
fn pixel(scene: &Scene, spec: &Spec, spp: u32) -> (PixelSum, Counts) {
    let kernel = kernel::build(&Arc::new(scene.clone()), spec).expect("a kernel");
    let render = move || {
        let bounds = Bounds { x0: 0, y0: 0, x1: 1, y1: 1 };
        let mut buffer = TileBuffer::new(bounds);
        let counts = kernel.render(&Piece { bounds, samples: 0..spp }, &mut buffer);
        (buffer.row_mut(0)[0], counts)
    };
    let thread = thread::Builder::new().stack_size(128 << 10).spawn(render).expect("a thread");
    thread.join().expect("no overflow of the stack")
}

/// The loop ends after 65 536 vertices, and the cut is counted and reported. Each vertex has added its emission.
pub(super) fn endless(trials: &mut Trials) {
    for (material, name) in [(mirror(1.0), "mirror"), (diffuse(1.0), "matte")] {
        for emission in [0.0, 1.0] {
            let scene = hollow(&material, [emission; 3]);
            for (estimator, kernel) in with_kernels(full_estimators()) {
                let outcome = run(&scene, spec(estimator, kernel, [1; 2], 1), 4);
                let counts = outcome.counts;
                let what = format!("{name}, Le {emission}, {estimator}, {kernel}");
                let found = (counts.paths, counts.truncated, counts.escaped, counts.invalid);
                trials.same(format!("{what}: paths, cut, escaped, invalid"), (4, 4, 0, 0), found);
                let is_told = outcome.warnings.contains(&Warning::Truncated(4));
                trials.holds(format!("{what}: warning"), "truncated(4)", format_args!("{is_told}"), is_told);
                if arriving_estimators().any(|name| name == estimator) {
                    let vertices = u64::from(MAX_BOUNCES) + 1;
                    trials.same(format!("{what}: rays"), 4 * vertices, counts.rays);
                    let found = outcome.film.pixels()[0].mean()[0];
                    trials.same(format!("{what}: radiance"), emission * vertices as f64, found);
                }
            }
        }
    }
}

/// 0.999^10000, with a relative tolerance of 1e-11.
pub(super) fn ten_thousand(trials: &mut Trials) {
    let scene = corridor(10_000, 0.999);
    for (estimator, kernel) in with_kernels(full_estimators()) {
        let roulette = Some("never".to_string());
        let (sum, counts) = pixel(&scene, &Spec { roulette, ..spec(estimator, kernel, [1; 2], 1) }, 8);
        let what = format!("{estimator}, {kernel}");
        let exact = 4.517_334_597_704_865e-5;
        trials.close(&what, exact, sum.mean()[0], 1e-11 * exact);
        trials.same(format!("{what}: rays"), 8 * 10_001, counts.rays);
    }
    // Roulette ends these paths; some of them are very long.
    let furnace = hollow(&diffuse(0.999), [1.0; 3]);
    for (estimator, kernel) in with_kernels(full_estimators()) {
        let (_, counts) = pixel(&furnace, &spec(estimator, kernel, [1; 2], 1), 200);
        let is_long = counts.rays > 300 * counts.paths && counts.escaped + counts.invalid + counts.truncated == 0;
        trials.holds(format!("a furnace, {estimator}, {kernel}"), "long paths", format_args!("{counts:?}"), is_long);
    }
}

/// A throughput that is halved at each bounce is 2^-1022, the smallest normal number, after 1022 bounces. The next
/// bounce ends the path: 1023 rays. An albedo of 0.9 takes 6724 rays. Without this rule the path would never end: 0.9
/// times 4 units of the smallest number rounds to 4 units. The sum of the series is right to its last term, also where
/// another channel loses nothing and keeps the path alive.
pub(super) fn underflow(trials: &mut Trials) {
    for (estimator, kernel) in with_kernels(arriving_estimators()) {
        let what = format!("{estimator}, {kernel}");
        let roulette = Some("never".to_string());
        let spec = Spec { roulette, ..spec(estimator, kernel, [1; 2], 1) };
        for (albedo, rays, radiance) in [(0.5, 1023, 2.0), (0.9, 6724, 10.0)] {
            let (sum, counts) = pixel(&hollow(&mirror(albedo), [1.0; 3]), &spec, 4);
            let found = (counts.rays, counts.truncated);
            trials.same(format!("{albedo}, {what}: rays, cut"), (4 * rays, 0), found);
            trials.close(format!("{albedo}, {what}: radiance"), radiance, sum.mean()[0], 1e-12);
        }

        let three = hollow("{ mirror = { albedo = [1.0, 0.999, 0.9] } }", [0.0, 1.0, 1.0]);
        let (sum, counts) = pixel(&three, &spec, 4);
        let [red, green, blue] = sum.mean();
        trials.close(format!("no light, {what}"), 0.0, red, 0.0);
        trials.close(format!("0.999, {what}"), 1000.0, green, 1e-8);
        trials.close(format!("0.9, {what}"), 10.0, blue, 1e-12);
        trials.never(format!("0.9, {what}"), "samples that are no number", counts.invalid, counts.paths);
    }
}
