//! Agreement of predictions with measurements, as relative errors.

use crate::analysis::quantile::median;

/// Relative errors of predictions, as (predicted - measured) / measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// The median error; a value far from 0 shows a systematic error.
    pub bias: f64,
    /// The median of the absolute errors.
    pub median_absolute: f64,
    /// The largest absolute error.
    pub worst_absolute: f64,
}

/// Compares pairs of (predicted, measured) seconds; `None` without pairs.
pub fn agreement(pairs: &[(f64, f64)]) -> Option<Agreement> {
    let errors: Vec<f64> = pairs.iter().map(|(predicted, measured)| (predicted - measured) / measured).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let median_absolute = median(&absolute)?;
    let worst_absolute = absolute.iter().copied().fold(0.0, f64::max);
    Some(Agreement { bias: median(&errors)?, median_absolute, worst_absolute })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_by_hand() {
        let of = agreement(&[(1.0, 2.0), (3.0, 2.0), (2.5, 2.0), (2.0, 2.0)]).unwrap();
        assert_eq!((of.bias, of.median_absolute, of.worst_absolute), (0.125, 0.375, 0.5));
        assert_eq!(agreement(&[]), None);
    }
}
