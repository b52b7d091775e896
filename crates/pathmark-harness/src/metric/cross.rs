//! Mean squared error against two independent references, whose noise cancels.
//!
//! With test picture T and references R1, R2 that share no samples, the expectation of (T - R1)(T - R2) is bias squared
//! plus the variance of T, whatever the noise of R1 and R2: their errors enter only as products of independent errors
//! with mean 0. The plain mean squared error against one reference of M samples is too large by that reference's
//! variance. At N samples of the test, the error then looks (1 + N/M)^(1/2) times as large, and the slope of a
//! convergence plot is flattened.

use super::{REL_MSE_EPSILON, check_sizes};
use crate::error::Result;
use crate::image_io::{Image, tone_map};

/// Returns the mean of (T - R1)(T - R2) over pixels and channels of linear radiance. It is unbiased, so it can be
/// negative if the true error is small compared with the noise of the references.
pub fn cross_mse(test: &Image, reference1: &Image, reference2: &Image) -> Result<f64> {
    mean_product(test, reference1, reference2, |value| value)
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
    mean_product(test, reference1, reference2, tone_map::display)
}

/// Returns the mean of (T - R1)(T - R2) / (R^2 + [`REL_MSE_EPSILON`]), with R the mean of the two references. Their
/// noise remains in the divisor: the result is nearly unbiased if they are much better than the test.
pub fn cross_rel_mse(test: &Image, reference1: &Image, reference2: &Image) -> Result<f64> {
    check_sizes(test, reference1)?;
    check_sizes(test, reference2)?;
    let [t, r1, r2] = [test, reference1, reference2].map(|image| image.pixels.as_flattened());
    let ratios = t.iter().zip(r1).zip(r2).map(|((t, r1), r2)| {
        let mean = 0.5 * (r1 + r2);
        (t - r1) * (t - r2) / (mean * mean + REL_MSE_EPSILON)
    });
    Ok(ratios.sum::<f64>() / t.len() as f64)
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

fn mean_product(test: &Image, reference1: &Image, reference2: &Image, map: fn(f64) -> f64) -> Result<f64> {
    check_sizes(test, reference1)?;
    check_sizes(test, reference2)?;
    let (t, r1, r2) = (&test.pixels, &reference1.pixels, &reference2.pixels);
    let products = t.as_flattened().iter().zip(r1.as_flattened()).zip(r2.as_flattened()).map(|((&t, &r1), &r2)| {
        let t = map(t);
        (t - map(r1)) * (t - map(r2))
    });
    Ok(products.sum::<f64>() / (3 * t.len()) as f64)
}
