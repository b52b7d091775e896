//! Mean squared error against two independent references, whose noise cancels.
//!
//! With test picture T and references R1, R2 that share no samples, the expectation of (T - R1)(T - R2) is bias squared
//! plus the variance of T, whatever the noise of R1 and R2: their errors enter only as products of independent errors
//! with mean 0. The plain mean squared error against one reference of M samples is too large by that reference's
//! variance. At N samples of the test, the error then looks (1 + N/M)^(1/2) times as large, and the slope of a
//! convergence plot is flattened.
//!
//! Counts of pixels within a tolerance, and of pixels that are far too bright, compare with the mean of the two halves. The
//! noise of the reference affects both counts, so a reference needs many more samples than the picture.

use super::{REL_MSE_EPSILON, check_sizes};
use crate::error::Result;
use crate::image_io::{Image, tone_map};

/// Returns the mean of (T - R1)(T - R2) over pixels and channels of linear radiance. It is unbiased, so it can be
/// negative if the true error is small compared with the noise of the references.
pub fn cross_mse(test: &Image, reference1: &Image, reference2: &Image) -> Result<f64> {
    mean_product(test, [reference1, reference2], |value| value)
}

/// The terms of [`cross_mse`]: for each pixel the mean of (T - R1)(T - R2) over its channels.
pub fn cross_products(test: &Image, reference1: &Image, reference2: &Image) -> Result<Vec<f64>> {
    check_sizes(test, reference1)?;
    check_sizes(test, reference2)?;
    let pixels = test.pixels.iter().zip(&reference1.pixels).zip(&reference2.pixels);
    let product = |((t, r1), r2): ((&[f64; 3], &[f64; 3]), &[f64; 3])| {
        t.iter().zip(r1).zip(r2).map(|((t, r1), r2)| (t - r1) * (t - r2)).sum::<f64>() / 3.0
    };
    Ok(pixels.map(product).collect())
}

/// [`cross_mse`] of display values in [0, 1].
///
/// Not exactly unbiased: clamp and gamma are not linear, so the display value of a noisy mean is not, on average, the
/// display value of the mean. The remaining bias is the squared curvature times variance of the references. It is far
/// below the excess of the plain form for references that are much better than the test.
pub fn cross_mse_display(test: &Image, reference1: &Image, reference2: &Image) -> Result<f64> {
    mean_product(test, [reference1, reference2], tone_map::display)
}

/// Returns the mean of (T - R1)(T - R2) / (R^2 + [`REL_MSE_EPSILON`]), with R the mean of the two references. Their
/// noise remains in the divisor: the result is nearly unbiased if they are much better than the test.
pub fn cross_rel_mse(test: &Image, reference1: &Image, reference2: &Image) -> Result<f64> {
    mean_of(test, [reference1, reference2], |t, r1, r2| {
        let mean = 0.5 * (r1 + r2);
        (t - r1) * (t - r2) / (mean * mean + REL_MSE_EPSILON)
    })
}

/// Returns the mean of (T1 - R1)(T2 - R2), the squared bias alone, for two test pictures of different seeds. The
/// variance of the tests cancels like the variance of the references, so the result scatters around zero for an
/// unbiased estimator.
pub fn bias_squared(tests: [&Image; 2], references: [&Image; 2]) -> Result<f64> {
    for other in [tests[1], references[0], references[1]] {
        check_sizes(tests[0], other)?;
    }
    let [t1, t2] = tests.map(|image| image.pixels.as_flattened());
    let [r1, r2] = references.map(|image| image.pixels.as_flattened());
    let products = t1.iter().zip(r1).zip(t2.iter().zip(r2)).map(|((t1, r1), (t2, r2))| (t1 - r1) * (t2 - r2));
    Ok(products.sum::<f64>() / t1.len() as f64)
}

/// Returns the root of a cross mean squared error. Average over seeds first, and take the root last. `None` for NaN,
/// and for a negative error, which shows that the references are too noisy to measure the error.
pub fn root(mse: f64) -> Option<f64> {
    (mse >= 0.0).then(|| mse.sqrt())
}

fn mean_product(test: &Image, halves: [&Image; 2], map: fn(f64) -> f64) -> Result<f64> {
    mean_of(test, halves, |t, r1, r2| {
        let t = map(t);
        (t - map(r1)) * (t - map(r2))
    })
}

/// The mean of `f(test, first half, second half)` over channels and pixels.
fn mean_of(test: &Image, halves: [&Image; 2], f: impl Fn(f64, f64, f64) -> f64) -> Result<f64> {
    halves.into_iter().try_for_each(|half| check_sizes(test, half))?;
    let [t, r1, r2] = [test, halves[0], halves[1]].map(|image| image.pixels.as_flattened());
    let values = t.iter().zip(r1).zip(r2).map(|((&t, &r1), &r2)| f(t, r1, r2));
    Ok(values.sum::<f64>() / t.len() as f64)
}

fn count(test: &Image, halves: [&Image; 2], is_wanted: impl Fn([f64; 3], [f64; 3]) -> bool) -> Result<usize> {
    halves.into_iter().try_for_each(|half| check_sizes(test, half))?;
    let references = halves[0].pixels.iter().zip(&halves[1].pixels);
    let pairs = test.pixels.iter().zip(references);
    let means = pairs.map(|(test, (a, b))| (*test, std::array::from_fn(|k| 0.5 * (a[k] + b[k]))));
    Ok(means.filter(|(test, reference)| is_wanted(*test, *reference)).count())
}

/// Returns the share of pixels whose display value is at most `tolerance` from the reference's in every channel; NaN
/// for pictures without pixels.
pub fn share_within(test: &Image, first: &Image, second: &Image, tolerance: f64) -> Result<f64> {
    let is_near = |(t, r): (&f64, &f64)| (tone_map::display(*t) - tone_map::display(*r)).abs() <= tolerance;
    let near = count(test, [first, second], |test, reference| test.iter().zip(&reference).all(is_near))?;
    Ok(near as f64 / test.pixels.len() as f64)
}

/// Returns the number of pixels that are brighter than the reference by more than `excess` in linear radiance, in any
/// channel. With a large `excess`, these are fireflies.
pub fn brighter_pixels(test: &Image, first: &Image, second: &Image, excess: f64) -> Result<u64> {
    let is_brighter = |(t, r): (&f64, &f64)| t - r > excess;
    let bright = count(test, [first, second], |test, reference| test.iter().zip(&reference).any(is_brighter))?;
    Ok(bright as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(values: &[f64]) -> Image {
        Image { width: values.len() as u32, height: 1, pixels: values.iter().map(|value| [*value, 0.5, 0.5]).collect() }
    }

    /// The mean of the halves is 0.5 everywhere, a display value of 0.7297. Within 0.05 of it, the radiance is from
    /// 0.428 to 0.579.
    #[test]
    fn pixels_count_by_their_distance_to_the_mean_of_the_halves() {
        let (first, second) = (picture(&[0.25; 5]), picture(&[0.75; 5]));
        let test = picture(&[0.5, 0.57, 0.59, 0.42, 1.6]);
        assert_eq!(share_within(&test, &first, &second, 0.05).unwrap(), 0.4);
        assert_eq!(brighter_pixels(&test, &first, &second, 1.0).unwrap(), 1);
        assert_eq!(brighter_pixels(&test, &first, &second, 0.05).unwrap(), 3);
        assert!(share_within(&test, &picture(&[0.5; 4]), &second, 0.05).is_err());
    }
}
