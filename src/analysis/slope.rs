//! The convergence slope: the exponent of RMSE against samples per pixel, -1/2 for independent samples.
//!
//! The points of one seed may share samples or a reference and so are not independent; one line through all points would then have too
//! narrow an interval. Seeds are independent by construction. So each seed gets its own line, and the spread of the seeds' slopes
//! makes the interval (a summary-measure analysis: J. N. S. Matthews and others, "Analysis of serial measurements in medical
//! research", BMJ 300, 1990).

use serde::Serialize;

use super::fit::{Sums, logarithms};
use super::interval::Estimate;
use super::mean::{Moments, t_interval};

/// y = exp(`log_scale`) x^exponent.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PowerLaw {
    /// The exponent, with an interval over the clusters.
    pub exponent: Estimate,
    /// ln y at x = 1: mean over the clusters, for drawing the line.
    pub log_scale: f64,
    /// How many clusters there were.
    pub clusters: usize,
}

impl PowerLaw {
    /// y at `x`.
    pub fn at(&self, x: f64) -> f64 {
        libm::exp(self.log_scale + self.exponent.value * libm::log(x))
    }
}

/// A power law from clusters of points (x, y), each cluster one seed: log-log slope in each, then the t-interval of their mean.
///
/// `None` below two clusters, for a cluster whose x are all equal, for equal slopes, or a coordinate that is not positive and finite.
pub fn clustered(clusters: &[Vec<(f64, f64)>], level: f64) -> Option<PowerLaw> {
    let sums = clusters.iter().map(|points| Sums::of(&logarithms(points)?)).collect::<Option<Vec<Sums>>>()?;
    let slopes: Vec<f64> = sums.iter().map(Sums::slope).collect();
    let intercepts: Vec<f64> = sums.iter().map(Sums::intercept).collect();
    Some(PowerLaw {
        exponent: t_interval(&slopes, level)?,
        log_scale: Moments::of(&intercepts).mean()?,
        clusters: clusters.len(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::fit::log_log;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    const SPP: [f64; 5] = [8.0, 20.0, 40.0, 80.0, 200.0];

    /// One seed's curve of exponent -1/2: an error common to the whole curve tilts it, which one fit over all points can't see.
    fn cluster(generator: &mut Pcg64Dxsm) -> Vec<(f64, f64)> {
        let mut centred = || (generator.next_u64() >> 11) as f64 / 9_007_199_254_740_992.0 - 0.5;
        let tilt = 0.2 * centred();
        SPP.map(|spp| (spp, libm::exp(tilt * libm::log(spp / 40.0) - 0.5 * libm::log(spp) + 0.02 * centred()))).to_vec()
    }

    #[test]
    fn mean_of_the_seeds_slopes() {
        let power = |exponent: f64| SPP.map(|spp| (spp, 2.0 * libm::pow(spp, exponent))).to_vec();
        let law = clustered(&[power(-0.4), power(-0.5), power(-0.6)], 0.95).unwrap();
        assert!((law.exponent.value + 0.5).abs() < 1e-12);
        // Standard error 0.1 / sqrt(3), t with 2 degrees of freedom 4.30265.
        assert!((law.exponent.interval.high - law.exponent.value - 0.248_414).abs() < 1e-5);
        assert!((law.at(1.0) - 2.0).abs() < 1e-12 && law.clusters == 3);
    }

    #[test]
    fn clustered_interval_covers_where_a_pooled_one_does_not() {
        let mut generator = Pcg64Dxsm::new(9, 4);
        let (mut hits, mut pooled_hits) = (0_u32, 0_u32);
        for _ in 0..1000 {
            let clusters: Vec<_> = (0..6).map(|_| cluster(&mut generator)).collect();
            hits += u32::from(clustered(&clusters, 0.95).unwrap().exponent.interval.contains(-0.5));
            pooled_hits += u32::from(log_log(&clusters.concat(), 0.95).unwrap().slope.interval.contains(-0.5));
        }
        // Nominal 95 %; the simulation's standard deviation is 0.7 %.
        assert!((925..=975).contains(&hits), "{hits} of 1000");
        assert!(pooled_hits < hits - 20, "{pooled_hits} against {hits}");
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        let good = vec![(1.0, 1.0), (4.0, 0.5)];
        assert_eq!(clustered(&[], 0.95), None);
        assert_eq!(clustered(std::slice::from_ref(&good), 0.95), None);
        assert_eq!(clustered(&[good.clone(), good.clone()], 0.95), None);
        assert_eq!(clustered(&[good.clone(), vec![(2.0, 1.0), (2.0, 0.5)]], 0.95), None);
        assert_eq!(clustered(&[good.clone(), vec![(2.0, 1.0)]], 0.95), None);
        assert_eq!(clustered(&[good.clone(), vec![]], 0.95), None);
        assert_eq!(clustered(&[good, vec![(1.0, 0.0), (4.0, 0.5)]], 0.95), None);
    }
}
