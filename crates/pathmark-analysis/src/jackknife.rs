//! The jackknife over seeds: estimates and intervals from the error curves of several seeds.
//!
//! The points of one curve are prefixes of one render and so depend on each other; curves of different seeds are
//! independent by construction. The jackknife therefore leaves out one seed at a time: J. W. Tukey, "Bias and
//! confidence in not quite large samples", Annals of Mathematical Statistics 29 (1958). Let `f` be a statistic of all n
//! seeds and `f_i` the same without seed i. The n pseudovalues `n f - (n - 1) f_i` are approximately independent. Their
//! mean is free of the bias of f of order 1/n, and their t-interval is the interval of the statistic. This holds for
//! means and for variances between seeds (J. N. Arvesen, "Jackknifing U-statistics", Annals of Mathematical Statistics
//! 40, 1969).

use super::equivalence::Measured;
use super::interval::Estimate;
use super::mean::t_interval;
use std::collections::{BTreeMap, BTreeSet};

/// Points (samples per pixel, mean squared error), ordered by samples per pixel.
pub type Curve = Vec<(f64, f64)>;

/// The curve of each seed, from squared errors by samples per pixel and seed. If a seed has no positive squared error at some
/// number of samples, that number is left out for all seeds: leaving it out for that seed alone would bias the rest upwards.
pub fn curves_of(seeds: &BTreeSet<u64>, mut errors: BTreeMap<u32, BTreeMap<u64, f64>>) -> BTreeMap<u64, Curve> {
    errors.retain(|_, own| own.len() == seeds.len() && own.values().all(|mse| *mse > 0.0));
    let of = |seed: &u64| errors.iter().filter_map(|(spp, own)| Some((f64::from(*spp), *own.get(seed)?))).collect();
    seeds.iter().map(|seed| (*seed, of(seed))).collect()
}

/// The error curve of all seeds, and the curve without each one of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SeedCurves {
    whole: Curve,
    without: Vec<Curve>,
}

impl SeedCurves {
    /// Averages the measured error curves of the seeds. `None` below two curves, or for curves that differ in their
    /// samples per pixel.
    pub fn of_errors(curves: &[Curve]) -> Option<Self> {
        let first = curves.first().filter(|_| curves.len() > 1)?;
        let same_places = |curve: &Curve| {
            curve.len() == first.len() && curve.iter().zip(first).all(|(point, other)| point.0 == other.0)
        };
        if !curves.iter().all(same_places) {
            return None;
        }
        let mean = |left_out: Option<usize>| -> Curve {
            let kept = || curves.iter().enumerate().filter(|(index, _)| Some(*index) != left_out);
            let count = kept().count() as f64;
            let sum = |k: usize| kept().map(|(_, curve)| curve[k].1).sum::<f64>();
            (0..first.len()).map(|k| (first[k].0, sum(k) / count)).collect()
        };
        Some(Self { whole: mean(None), without: (0..curves.len()).map(|seed| mean(Some(seed))).collect() })
    }

    /// Computes errors from the images of several seeds, without a reference: the variance between the seeds, averaged
    /// over the values of an image. It is the error of an unbiased estimator; it does not show a bias.
    ///
    /// `images[p]` holds the images of all seeds at `spp[p]`. `None` below three seeds, for images of different sizes
    /// or without values.
    pub fn of_images(spp: &[f64], images: &[Vec<&[f64]>]) -> Option<Self> {
        let seeds = images.first()?.len();
        let length = images.first()?.first()?.len();
        let alike = images.iter().all(|at| at.len() == seeds && at.iter().all(|image| image.len() == length));
        if seeds < 3 || length == 0 || !alike || spp.len() != images.len() {
            return None;
        }
        let spreads: Vec<Spread> = images.iter().map(|at| Spread::of(at)).collect();
        let curve = |left_out: Option<usize>| {
            spp.iter().zip(&spreads).map(|(&spp, spread)| (spp, spread.variance(left_out))).collect()
        };
        Some(Self { whole: curve(None), without: (0..seeds).map(|seed| curve(Some(seed))).collect() })
    }

    pub fn whole(&self) -> &Curve {
        &self.whole
    }

    pub fn seeds(&self) -> usize {
        self.without.len()
    }

    /// Estimates a value that `of` computes from a curve, with its interval; `None` if it does not exist for every
    /// curve, or does not vary.
    pub fn estimate(&self, level: f64, of: impl Fn(&Curve) -> Option<f64>) -> Option<Estimate> {
        t_interval(&self.pseudovalues(of)?, level)
    }

    /// The same value with its error, for a comparison of two measurements.
    pub(super) fn measured(&self, of: impl Fn(&Curve) -> Option<f64>) -> Option<Measured> {
        Measured::of_mean(&self.pseudovalues(of)?).filter(Measured::has_spread)
    }

    fn pseudovalues(&self, of: impl Fn(&Curve) -> Option<f64>) -> Option<Vec<f64>> {
        let (n, whole) = (self.without.len() as f64, of(&self.whole)?);
        self.without.iter().map(|curve| Some(n * whole - (n - 1.0) * of(curve)?)).collect()
    }

    /// Like [`Self::estimate`] for a positive value, by way of its logarithm, which varies more evenly.
    pub fn positive_estimate(&self, level: f64, of: impl Fn(&Curve) -> Option<f64>) -> Option<Estimate> {
        self.estimate(level, |curve| of(curve).filter(|&value| value > 0.0).map(libm::log))?.exp()
    }
}

/// Sums of squared deviations from the mean over seeds, in total and of each seed.
struct Spread {
    /// Sum over values of the squared deviations of all seeds.
    total: f64,
    /// Sum over values of each seed's squared deviation.
    own: Vec<f64>,
    values: f64,
}

impl Spread {
    fn of(images: &[&[f64]]) -> Self {
        let length = images.first().map_or(0, |image| image.len());
        let mut own = vec![0.0; images.len()];
        for value in 0..length {
            let mean = images.iter().map(|image| image[value]).sum::<f64>() / images.len() as f64;
            for (sum, image) in own.iter_mut().zip(images) {
                *sum += (image[value] - mean) * (image[value] - mean);
            }
        }
        Self { total: own.iter().sum(), own, values: length as f64 }
    }

    /// The mean over values of the sample variance of the seeds. Without seed i, whose deviation is d, the sum of squared deviations falls by
    /// d^2 n / (n - 1).
    fn variance(&self, left_out: Option<usize>) -> f64 {
        let n = self.own.len() as f64;
        match left_out {
            None => self.total / (n - 1.0) / self.values,
            Some(seed) => (self.total - self.own[seed] * n / (n - 1.0)) / (n - 2.0) / self.values,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mean::Moments;

    #[test]
    fn the_interval_of_a_mean_is_the_t_interval() {
        let values = [1.0, 2.0, 3.0, 4.0, 5.0];
        let curves: Vec<Curve> = values.iter().map(|&value| vec![(1.0, value)]).collect();
        let found = SeedCurves::of_errors(&curves).unwrap();
        let (estimate, plain) =
            (found.estimate(0.95, |curve| Some(curve[0].1)).unwrap(), t_interval(&values, 0.95).unwrap());
        assert!((estimate.value - plain.value).abs() < 1e-12);
        assert!((estimate.interval.low - plain.interval.low).abs() < 1e-9);
        assert!((found.whole()[0].1 - 3.0).abs() < 1e-12 && found.seeds() == 5);
        // The jackknife removes the bias of the square of a mean: mean^2 - s^2/n = 9 - 2.5/5.
        let square = found.estimate(0.95, |curve| Some(curve[0].1 * curve[0].1)).unwrap();
        assert!((square.value - 8.5).abs() < 1e-9, "{square:?}");
    }

    #[test]
    fn images_are_measured_by_each_other() {
        let images = [[1.0, 5.0], [2.0, 5.5], [4.0, 9.0], [7.0, 2.0]];
        let seeds: Vec<&[f64]> = images.iter().map(<[f64; 2]>::as_slice).collect();
        let found = SeedCurves::of_images(&[8.0], &[seeds]).unwrap();
        let variance = |kept: &[usize]| {
            let of = |value: usize| {
                Moments::of(&kept.iter().map(|&i| images[i][value]).collect::<Vec<f64>>()).sample_variance().unwrap()
            };
            0.5 * of(0) + 0.5 * of(1)
        };
        assert!((found.whole()[0].1 - variance(&[0, 1, 2, 3])).abs() < 1e-12);
        for (left_out, kept) in [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]].iter().enumerate() {
            assert!((found.without[left_out][0].1 - variance(kept)).abs() < 1e-12);
        }
    }

    /// At four samples the second seed has a negative error, and at eight it has none: only one and two are left.
    #[test]
    fn a_number_of_samples_counts_for_all_seeds_or_for_none() {
        let all: [(u32, &[(u64, f64)]); 4] =
            [(1, &[(3, 1.0), (5, 2.0)]), (2, &[(3, 0.5), (5, 1.0)]), (4, &[(3, 0.2), (5, -0.1)]), (8, &[(3, 0.1)])];
        let errors = all.map(|(spp, own)| (spp, own.iter().copied().collect()));
        let found = curves_of(&BTreeSet::from([3, 5]), errors.into());
        let curve = |factor: f64| vec![(1.0, factor), (2.0, 0.5 * factor)];
        assert_eq!(found, BTreeMap::from([(3, curve(1.0)), (5, curve(2.0))]));
    }

    #[test]
    fn degenerate_input_has_no_answer() {
        let curve = vec![(1.0, 1.0)];
        assert_eq!(SeedCurves::of_errors(std::slice::from_ref(&curve)), None);
        assert_eq!(SeedCurves::of_errors(&[curve.clone(), vec![(2.0, 1.0)]]), None);
        assert_eq!(SeedCurves::of_errors(&[curve.clone(), vec![]]), None);
        let negative = SeedCurves::of_errors(&[curve, vec![(1.0, -3.0)]]).unwrap();
        assert_eq!(negative.positive_estimate(0.95, |curve| Some(curve[0].1)), None);
        let image: &[f64] = &[1.0];
        assert_eq!(SeedCurves::of_images(&[1.0], &[vec![image, image]]), None);
        assert_eq!(SeedCurves::of_images(&[1.0], &[vec![image, image, &[1.0, 2.0]]]), None);
        assert_eq!(SeedCurves::of_images(&[], &[vec![image; 3]]), None);
        assert_eq!(SeedCurves::of_images(&[], &[]), None);
    }
}
