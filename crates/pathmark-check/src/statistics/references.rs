//! Errors against noisy references. The test has N samples a pixel with deviation 1, the reference M.

use super::draw::Draw;
use crate::Trials;
use crate::analysis::fit::log_log;
use crate::exact::critical;
use crate::image_io::Image;
use crate::metric::{self, bias_squared, cross_mse};

fn value(name: &str, test: &Image, reference: &Image) -> f64 {
    metric::find(name).expect("a metric").compute(test, reference).expect("pictures of one size")
}

fn numbers(image: &Image) -> f64 {
    image.pixels.as_flattened().len() as f64
}

/// The slope of RMSE over N = 1, 2, .. 1024 on logarithmic axes, for the squared error `mse`.
pub(super) fn slope(mse: impl Fn(f64) -> f64) -> f64 {
    let points: Vec<(f64, f64)> = (0..=10).map(|k| f64::from(1 << k)).map(|n| (n, mse(n))).collect();
    0.5 * log_log(&points, 0.95).expect("a line").slope.value
}

/// E[MSE] = bias^2 + 1/N + 1/M: the reference's noise bends the slope of convergence.
pub(super) fn independent(trials: &mut Trials) {
    let side = trials.times(128, 1024) as u32;
    let mut draw = Draw::new(1);
    for (n, m, bias) in [(16.0, 4.0, 0.0), (16.0, 16.0, 0.0), (16.0, 64.0, 0.1), (4.0, 400.0, 0.5)] {
        let test = draw.picture(side, 1.0 + bias, f64::sqrt(1.0 / n));
        let reference = draw.picture(side, 1.0, f64::sqrt(1.0 / m));
        let (found, variance) = (value("mse", &test, &reference), 1.0 / n + 1.0 / m);
        // The square of a normal value of this mean and variance has the variance 2 v^2 + 4 b^2 v.
        let error = (2.0 * variance * variance + 4.0 * bias * bias * variance) / numbers(&test);
        let z = (found - bias * bias - variance) / error.sqrt();
        trials.deviates_below(format!("N {n}, M {m}, bias {bias}"), critical(), z);
        let rmse = value("rmse", &test, &reference);
        trials.close(format!("N {n}, M {m}, bias {bias}: the root"), found.sqrt(), rmse, 1e-14);
    }
    for (m, expected) in
        [(256.0, -0.3994), (1024.0, -0.4607), (4096.0, -0.4880), (16384.0, -0.4968), (65536.0, -0.4992)]
    {
        trials.close(format!("apparent slope, M {m}"), expected, slope(|n| 1.0 / n + 1.0 / m), 5e-5);
    }
    trials.close("slope without a reference's noise", -0.5, slope(|n| 1.0 / n), 1e-12);
}

/// The RMSE is too large by the share d if M = N/((1 + d)^2 - 1). Both compared errors contain the noise of the test,
/// so that mainly the reference's noise is left. The ratio of the squares has the variance 4 (N/M)/P + 2 (N/M)^2/P
/// over P values.
pub(super) fn enough(trials: &mut Trials) {
    let side = trials.times(192, 1024) as u32;
    let mut draw = Draw::new(2);
    for (inflation, times) in [(0.10, 4.76), (0.05, 9.76), (0.02, 24.8), (0.01, 49.8), (0.001, 499.8)] {
        let n = 16.0;
        let test = draw.picture(side, 1.0, f64::sqrt(1.0 / n));
        let truth = draw.picture(side, 1.0, 0.0);
        let halves = [0, 1].map(|_| draw.picture(side, 1.0, f64::sqrt(1.0 / (times * n))));
        let exact = value("rmse", &test, &truth);
        let found = value("rmse", &test, &halves[0]) / exact - 1.0;
        let share: f64 = 1.0 / times;
        let error = ((4.0 * share + 2.0 * share * share) / numbers(&test)).sqrt() / (2.0 * (1.0 + inflation));
        // The catalogue's multiples have three digits.
        trials.close(format!("M = {times} N: too large by"), inflation, found, critical() * error + 2e-3 * inflation);
        let crossed = cross_mse(&test, &halves[0], &halves[1]).expect("pictures of one size") / (exact * exact) - 1.0;
        // With two references, their noise enters twice in products with the test's noise, and once in the product
        // with each other.
        let error = ((2.0 * share + share * share) / numbers(&test)).sqrt();
        trials.close(format!("M = {times} N: cross form, too large by"), 0.0, crossed, critical() * error);
    }
}

/// N = 16, M = 64, bias 0.01: the truth is 0.0626. One reference gives 0.0782, two give the truth, and two tests with
/// them give the bias alone.
pub(super) fn cross(trials: &mut Trials) {
    let side = trials.times(192, 2048) as u32;
    let mut draw = Draw::new(3);
    for (n, m, bias) in [(16.0, 64.0, 0.01), (16.0, 4.0, 0.01), (16.0, 64.0, 0.3)] {
        let bias: f64 = bias;
        let (variance, noise) = (1.0 / n, 1.0 / m);
        let [t1, t2] = [0, 1].map(|_| draw.picture(side, 0.5 + bias, f64::sqrt(variance)));
        let [r1, r2] = [0, 1].map(|_| draw.picture(side, 0.5, f64::sqrt(noise)));
        let truth = bias * bias + variance;
        let what = format!("N {n}, M {m}, bias {bias}");
        let error = 2.0 * variance * variance + 4.0 * bias * bias * variance + 2.0 * truth * noise + noise * noise;
        let found = cross_mse(&t1, &r1, &r2).expect("pictures of one size");
        trials.deviates_below(format!("{what}: cross"), critical(), (found - truth) / (error / numbers(&t1)).sqrt());
        let naive = value("mse", &t1, &r1);
        let both = variance + noise;
        let error = 2.0 * both * both + 4.0 * bias * bias * both;
        let z = (naive - truth - noise) / (error / numbers(&t1)).sqrt();
        trials.deviates_below(format!("{what}: one reference"), critical(), z);
        let found = bias_squared([&t1, &t2], [&r1, &r2]).expect("pictures of one size");
        let error = both * both + 2.0 * bias * bias * both;
        let z = (found - bias * bias) / (error / numbers(&t1)).sqrt();
        trials.deviates_below(format!("{what}: bias alone"), critical(), z);
    }
}

/// Linear values keep the light that a display clips: white against a sun of 50 has the error 49 in linear values and
/// 0 on a display. Above white the linear squared error falls as 1/N, and the displayed error vanishes long before.
pub(super) fn linear(trials: &mut Trials) {
    let mut draw = Draw::new(8);
    let (white, sun) = (draw.picture(16, 1.0, 0.0), draw.picture(16, 50.0, 0.0));
    trials.close("rmse of a sun", 49.0, value("rmse", &sun, &white), 1e-12);
    trials.close("rmse-display of a sun", 0.0, value("rmse-display", &sun, &white), 0.0);
    let side = trials.times(192, 1024) as u32;
    let truth = draw.picture(side, 2.0, 0.0);
    let [few, many] = [1.0, 64.0].map(|n: f64| draw.picture(side, 2.0, n.sqrt().recip()));
    let fallen = |name: &str| value(name, &few, &truth) / value(name, &many, &truth);
    let error = (4.0 / numbers(&truth)).sqrt();
    trials.deviates_below("mse falls as 1/N", critical(), (fallen("mse") / 64.0 - 1.0) / error);
    let [few, many] = [&few, &many].map(|image| value("rmse-display", image, &truth));
    let found = format!("{few:.1e} and {many:.1e}");
    trials.holds(
        "what a display shows falls to nothing",
        "more than 0.01, less than 1e-6",
        found,
        few > 0.01 && many < 1e-6,
    );
}
