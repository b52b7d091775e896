//! Tests against the normal distribution, for estimates whose standard error is known well.

use statrs::distribution::{ContinuousCDF, Normal};

use super::interval::is_level;

/// The z below which a standard normal value lies with probability `p`; `None` unless `p` is in (0, 1).
pub fn normal_quantile(p: f64) -> Option<f64> {
    is_level(p).then(|| Normal::standard().inverse_cdf(p))
}

/// The |z| beyond which a two-sided test at significance `alpha` rejects: 1.95996 for 0.05.
pub fn critical_value(alpha: f64) -> Option<f64> {
    // From the lower tail, which keeps full precision for a tiny alpha.
    normal_quantile(0.5 * alpha).map(|z| -z)
}

/// The probability of a |z| at least this large if both estimates have the same expectation.
pub fn two_sided_p(z: f64) -> Option<f64> {
    z.is_finite().then(|| libm::erfc(z.abs() * std::f64::consts::FRAC_1_SQRT_2))
}

/// The significance for each of `tests` independent tests at which the probability of any false alarm is `alpha`:
/// 1 - (1 - alpha)^(1/tests) (Z. Sidak, "Rectangular confidence regions for the means of multivariate normal
/// distributions", Journal of the American Statistical Association 62, 1967).
pub fn sidak(alpha: f64, tests: usize) -> Option<f64> {
    (is_level(alpha) && tests > 0).then(|| -libm::expm1(libm::log1p(-alpha) / tests as f64))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Option<f64>, b: f64, tolerance: f64) {
        assert!((a.unwrap() - b).abs() <= tolerance, "{a:?} is not {b}");
    }

    #[test]
    fn quantiles_of_the_normal_table() {
        close(normal_quantile(0.5), 0.0, 1e-12);
        close(normal_quantile(0.975), 1.959_963_984_540_054, 1e-9);
        close(critical_value(0.05), 1.959_963_984_540_054, 1e-9);
        close(critical_value(0.01), 2.575_829_303_548_901, 1e-9);
        close(critical_value(1e-9), 6.109_410_204_869_001, 1e-6);
    }

    #[test]
    fn p_is_the_inverse_of_the_critical_value() {
        for alpha in [0.5, 0.05, 1e-4, 1e-9] {
            close(two_sided_p(critical_value(alpha).unwrap()), alpha, alpha * 1e-6);
        }
        close(two_sided_p(-1.0), 0.317_310_507_862_914, 1e-12);
    }

    #[test]
    fn sidak_of_five() {
        // 1 - 0.95^(1/5) = 0.010206.
        close(sidak(0.05, 5), 0.010_206_218_313_011_5, 1e-12);
        assert_eq!(sidak(0.05, 1).map(|level| (level * 1e12).round()), Some(5e10));
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        assert_eq!(normal_quantile(0.0), None);
        assert_eq!(critical_value(f64::NAN), None);
        assert_eq!(two_sided_p(f64::NAN), None);
        assert_eq!(sidak(0.05, 0), None);
        assert_eq!(sidak(1.0, 3), None);
    }
}
