//! Independence of an image, its reference and their estimators.

use super::draw::Draw;
use super::references::slope;
use crate::Trials;
use crate::analysis::z_test::two_sided_p;
use crate::estimator;
use crate::exact::critical;
use crate::experiment::{Definition, experiments, reference_seed};
use crate::film::Film;
use crate::image_io::Image;
use crate::kernel::{KERNELS, Spec};
use crate::lab::Lab;
use crate::measure::LARGEST_SEED;
use crate::metric::{self, bias_squared};
use crate::rendering::{run, spec};
use crate::scene::load;

fn film(seed: u64, estimator: &str, max_depth: Option<u16>, spp: u32) -> Film {
    let scene = load("cornell").expect("a shipped scene");
    run(&scene, Spec { max_depth, ..spec(estimator, KERNELS[0].name, [32, 24], seed) }, spp).film
}

/// Score of the correlation of two images' noise, against a correlation of 0. The noise of each pixel is its mean
/// minus the mean in `truth`.
fn correlation(a: &Film, b: &Film, truth: &Film) -> f64 {
    let (mut product, mut of_a, mut of_b) = (0.0, 0.0, 0.0);
    for ((a, b), truth) in a.pixels().iter().zip(b.pixels()).zip(truth.pixels()) {
        // In units of the pixel's own noise, so that no single pixel dominates. Ranks would not do better.
        let scale = truth.variance().sqrt().max(1e-9);
        let clip = |value: f64| (value / scale).clamp(-30.0, 30.0);
        let (x, y) = (clip(a.mean()[0] - truth.mean()[0]), clip(b.mean()[0] - truth.mean()[0]));
        product += x * y;
        of_a += x * x;
        of_b += y * y;
    }
    product / (of_a * of_b).sqrt() * (a.pixels().len() as f64).sqrt()
}

/// The first N of M samples differ from all of them by sqrt(1/N - 1/M): too little, and by nothing at N = M. So
/// references have seeds that no image can have, and the noise of images with different seeds is independent.
pub(super) fn shared_samples(trials: &mut Trials) {
    let (side, m) = (trials.times(96, 512) as u32, 64.0);
    let mut draw = Draw::new(4);
    for n in [16.0, 48.0, 64.0] {
        let n: f64 = n;
        let first = draw.picture(side, 0.5, n.sqrt().recip());
        let rest = if n < m { draw.picture(side, 0.5, (m - n).sqrt().recip()) } else { Image::new(side, side) };
        let mut all = first.clone();
        for (all, rest) in all.pixels.as_flattened_mut().iter_mut().zip(rest.pixels.as_flattened()) {
            *all = (n * *all + (m - n) * rest) / m;
        }
        let found = metric::find("mse").and_then(|metric| metric.compute(&first, &all)).expect("pictures of one size");
        let exact = 1.0 / n - 1.0 / m;
        let count = f64::from(side * side) * 3.0;
        let width = critical() * exact * (2.0 / count).sqrt();
        trials.close(format!("the first {n} of {m}: squared error"), exact, found, width + 1e-30);
    }
    trials.close("apparent slope, M 4096", -0.5146, slope(|n| 1.0 / n - 1.0 / 4096.0), 5e-5);

    let halves = [0, 1].map(reference_seed);
    let is_apart = halves[0] != halves[1] && halves.iter().all(|seed| *seed > LARGEST_SEED);
    trials.holds("seeds of references", format_args!("two above {LARGEST_SEED}"), format_args!("{halves:?}"), is_apart);
    let spp = trials.times(16, 256) as u32;
    let truth = film(1 << 40, "bsdf", None, 64 * spp);
    let image = film(1, "bsdf", None, spp);
    for seed in [2, halves[0], halves[1]] {
        let z = correlation(&image, &film(seed, "bsdf", None, spp), &truth);
        trials.deviates_below(format!("noise of seeds 1 and {seed}"), critical(), z);
    }
    let z = correlation(&image, &film(1, "bsdf", None, spp), &truth);
    let p = two_sided_p(z).unwrap_or(1.0);
    trials.holds("noise of one seed twice", "p below 1e-9", format_args!("{p:.0e}"), p < 1e-9);
}

/// Light that both an image and its reference miss is in no error. So some of the shipped experiments measure against
/// an estimator that finds light in another way.
pub(super) fn shared_bias(trials: &mut Trials) {
    let spp = trials.times(64, 1024) as u32;
    let image = |seed, estimator, depth| film(seed, estimator, depth, spp).image();
    let [t1, t2, r1, r2] = [1, 2, 3, 4].map(|seed| image(seed, "bsdf", Some(1)));
    let missed = bias_squared([&t1, &t2], [&r1, &r2]).expect("pictures of one size");
    let [full1, full2] = [5, 6].map(|seed| image(seed, "mis", None));
    let seen = bias_squared([&t1, &t2], [&full1, &full2]).expect("pictures of one size");
    trials.holds(
        "cut after one bounce: squared bias against another estimator, and against its own",
        "more than 1e-3, and less than a fifth of that",
        format_args!("{seen:.1e}, {missed:.1e}"),
        seen > 1e-3 && missed.abs() < 0.2 * seen,
    );

    let aims = |name: &str| estimator::find(name).is_some_and(|entry| entry.aims);
    let mut others = Vec::new();
    for (name, _) in experiments() {
        let definition = Definition::load(&Lab::built_in(), name).expect("a shipped experiment");
        let Some(profile) = definition.profiles().next() else { continue };
        let Ok(Some((reference, _))) = definition.reference(profile) else { continue };
        if definition.estimator_names().iter().any(|estimator| aims(estimator) != aims(&reference)) {
            others.push(name.as_str());
        }
    }
    let found = if others.is_empty() { "none".to_string() } else { others.join(", ") };
    trials.holds("experiments with a reference that aims where an image does not", "some", found, !others.is_empty());
}
