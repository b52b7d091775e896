//! What a pixel converges to: means over scramblings against closed forms.

use super::{LEVEL, Use, all_keyed};
use pathmark::analysis::z_test::{critical_value, sidak};
use pathmark::sampling::{Purpose, Sampler};

/// The numbers of the place in the pixel and of the first two directions.
const USES: [Use; 3] = [
    Use { bounce: 0, branch: 0, purpose: Purpose::Film },
    Use { bounce: 1, branch: 0, purpose: Purpose::Bsdf },
    Use { bounce: 2, branch: 0, purpose: Purpose::Bsdf },
];

/// A function of a sample's subpixel and numbers, and its mean.
struct Integrand {
    name: &'static str,
    value: fn(u32, [[f64; 2]; 3]) -> f64,
    mean: f64,
}

/// Smooth ones, an edge, one of all six numbers, and ones that see a different function in each subpixel.
const INTEGRANDS: [Integrand; 6] = [
    Integrand { name: "product", value: |_, [[u, v], ..]| u * v, mean: 0.25 },
    Integrand { name: "edge", value: |_, [[u, v], ..]| f64::from(u8::from(u + v < 0.7)), mean: 0.245 },
    Integrand { name: "two uses", value: |_, [[u, _], [v, _], _]| u * v, mean: 0.25 },
    Integrand {
        name: "six numbers",
        value: |_, numbers| numbers.iter().flatten().map(|u| 2.0 * u).product(),
        mean: 1.0,
    },
    Integrand {
        name: "first subpixel",
        value: |subpixel, [[u, v], [s, _], _]| if subpixel == 0 { 4.0 * u * u * v + s } else { 0.0 },
        mean: (4.0 / 6.0 + 0.5) / 4.0,
    },
    Integrand {
        name: "edge across subpixels",
        value: |subpixel, [_, [u, v], _]| f64::from(u8::from(u + v < 0.4 * f64::from(subpixel))),
        mean: (0.08 + 0.32 + (1.0 - 0.8 * 0.8 / 2.0)) / 4.0,
    },
];

fn estimate(sampler: &dyn Sampler, integrand: &Integrand, pixel: u32, samples: u32) -> f64 {
    let value = |sample| (integrand.value)(sample % 4, USES.map(|used| sampler.pair(used.of(3, pixel, sample))));
    (0..samples).map(value).sum::<f64>() / f64::from(samples)
}

/// R15: the mean over 2000 scramblings is right after any number of samples, a full set of strata or not.
#[test]
fn means_over_scramblings_are_unbiased() {
    const SCRAMBLINGS: u32 = 2000;
    let counts = [4, 12, 16, 20, 64, 100];
    let samplers = all_keyed();
    let limit = critical_value(sidak(LEVEL, samplers.len() * counts.len() * INTEGRANDS.len()).unwrap()).unwrap();
    for (name, sampler) in samplers {
        for integrand in &INTEGRANDS {
            for samples in counts {
                let all = (0..SCRAMBLINGS).map(|pixel| estimate(&*sampler, integrand, pixel, samples) - integrand.mean);
                let (sum, squares) =
                    all.fold((0.0, 0.0), |(sum, squares), error| (sum + error, squares + error * error));
                let z = sum / squares.sqrt();
                assert!(z.abs() < limit, "{name}, {}, {samples} samples: {z} deviations", integrand.name);
            }
        }
    }
}

/// One scrambling, many samples: the error of each pixel goes to zero, also where each subpixel sees another function. Sobol's own order
/// would leave an error of the size of the integrand for ever.
#[test]
fn each_pixel_converges() {
    const SAMPLES: u32 = 1 << 14;
    for (name, sampler) in all_keyed() {
        for integrand in &INTEGRANDS {
            for pixel in 0..8 {
                let error = estimate(&*sampler, integrand, pixel, SAMPLES) - integrand.mean;
                // Six deviations of independent samples of the most scattered integrand, whose variance is 4.6.
                assert!(error.abs() < 0.1, "{name}, {}, pixel {pixel}: off by {error}", integrand.name);
            }
        }
    }
}
