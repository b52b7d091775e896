//! Independence of the images of different seeds: R07.

use super::unguarded::seed_plus_pixel;
use super::{first, keyed, worst};
use crate::analysis::randomness::fourier::{Square, correlations};
use crate::kernel::{KERNELS, Spec};
use crate::rendering::{run, spec};
use crate::sampling::{Purpose, REFERENCE_SEEDS};
use crate::scene::load;
use crate::{Trials, critical};

const SEED: u64 = 5;

pub(super) fn seeds(trials: &mut Trials) {
    draws(trials);
    images(trials);
}

/// Correlates the first random number of each pixel of a square, minus 1/2, with that of another seed, shifted by
/// every lag. The square is a torus, so every lag uses all pixels.
fn draws(trials: &mut Trials) {
    let side = trials.times(128, 1024) as usize;
    let limit = critical(keyed().count() * 64 * side * side);
    let scale = 12.0 / side as f64;
    let noise = |of: &dyn Fn(u32) -> f64| Square::new(side, (0..(side * side) as u32).map(|pixel| of(pixel) - 0.5));
    for (name, sampler) in keyed() {
        let image = |seed: u64| noise(&|pixel| first(&*sampler, seed, pixel, 0, (0, Purpose::Film))[0]).transformed();
        let own = image(SEED);
        for k in 0..64 {
            let scores = correlations(&own, &image(SEED.wrapping_add(1 << k)));
            let z = worst(&scores) * scale;
            trials.deviates_below(format!("{name}, seeds s and s + 2^{k}, {} lags", side * side), limit, z);
        }
    }
    // A key that is the sum of seed and pixel gives the same noise, shifted by pixels or by a row.
    let shifted = |seed: u64| noise(&|pixel| seed_plus_pixel(seed, pixel)).transformed();
    for k in [0, 4, side.trailing_zeros()] {
        let scores = correlations(&shifted(SEED), &shifted(SEED + (1 << k)));
        // All pixels agree except those at the edge. The limit is in standard deviations.
        trials.at_least(format!("seed plus pixel, seeds s and s + 2^{k}"), 0.8 * side as f64, worst(&scores) * scale);
    }
}

/// Correlates rendered images. An image of a reference seed is subtracted from each, so that only noise remains. The
/// noise varies by pixel, so the score of each lag is scaled by its standard deviation.
fn images(trials: &mut Trials) {
    let side = trials.times(32, 64) as usize;
    let scene = load("cornell").expect("a shipped scene");
    let powers: Vec<u32> = if trials.times(0, 1) == 0 { vec![0, 6, 31, 32, 62] } else { (0..63).collect() };
    let limit = critical(KERNELS.len() * keyed().count() * powers.len() * side * side);
    for kernel in KERNELS {
        for (name, _) in keyed() {
            let image = |seed: u64| -> Vec<f64> {
                let spec = Spec { sampler: name.into(), ..spec("smallpt", kernel.name, [side as u32; 2], seed) };
                // Clamped to 1 as on a display, so that no single pixel dominates the noise.
                run(&scene, spec, 4).film.image().pixels.iter().map(|pixel| pixel[1].min(1.0)).collect()
            };
            let noise = |seed: u64, reference: u64| -> Vec<f64> {
                image(seed).iter().zip(image(REFERENCE_SEEDS | reference)).map(|(a, b)| a - b).collect()
            };
            let square = |values: &[f64], power: fn(f64) -> f64| {
                Square::new(side, values.iter().map(|x| power(*x))).transformed()
            };
            let own = noise(SEED, 1);
            let (first, size) = (square(&own, |x| x), square(&own, |x| x * x));
            for k in &powers {
                let other = noise(SEED + (1 << k), 2 + u64::from(*k));
                let products = correlations(&first, &square(&other, |x| x));
                let sizes = correlations(&size, &square(&other, |x| x * x));
                let scores: Vec<f64> =
                    products.iter().zip(sizes).map(|(product, size)| product / size.sqrt()).collect();
                let variant = format!("{}, {name}, images of s and s + 2^{k}, {} lags", kernel.name, side * side);
                trials.deviates_below(variant, limit, worst(&scores));
            }
        }
    }
}
