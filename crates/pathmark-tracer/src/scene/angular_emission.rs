//! Emission that depends on the angle: a table by the cosine, with linear interpolation between its entries.

use crate::math::Rgb;

const INTERVALS: u32 = 128;

/// The radiance that a surface emits, by the angle to its normal, the same on both sides. Entry k of n is for the
/// cosine (k/n)², because reflection changes fastest at grazing angles.
#[derive(Debug, Clone, PartialEq)]
pub struct AngularEmission(Vec<Rgb>);

impl AngularEmission {
    /// Tabulates a function of the cosine; `None` if the function returns `None`.
    pub fn tabulate(emission: impl Fn(f64) -> Option<Rgb>) -> Option<Self> {
        let entry = |k: u32| {
            let root = f64::from(k) / f64::from(INTERVALS);
            emission(root * root)
        };
        (0..=INTERVALS).map(entry).collect::<Option<_>>().map(Self)
    }

    /// The radiance at a cosine from 0 to 1, per channel.
    #[inline(always)]
    pub fn at(&self, cos: f64) -> Rgb {
        let place = cos.sqrt() * f64::from(INTERVALS);
        // Rounding may make a unit vector longer than 1.
        let left = (place as usize).min(INTERVALS as usize - 1);
        let share = place - left as f64;
        self.0[left] * (1.0 - share) + self.0[left + 1] * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The table is linear in the root of the cosine, so it reproduces such a function, also at both ends and one ulp
    /// beyond.
    #[test]
    fn reads_between_the_entries() {
        let table = AngularEmission::tabulate(|cos| Some(Rgb { r: cos.sqrt(), g: 1.0, b: 2.0 - cos.sqrt() })).unwrap();
        for k in 0..=1000 {
            let root = f64::from(k) / 1000.0;
            let Rgb { r, g, b } = table.at(root * root);
            assert!((r - root).abs() < 1e-14 && (g - 1.0).abs() < 1e-15 && (b - 2.0 + root).abs() < 1e-14, "{root}");
        }
        assert!((table.at(1.0 + f64::EPSILON).r - 1.0).abs() < 1e-15);
        assert_eq!(AngularEmission::tabulate(|cos| (cos < 0.5).then_some(Rgb::WHITE)), None);
    }
}
