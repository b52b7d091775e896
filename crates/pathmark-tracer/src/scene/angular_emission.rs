//! Emission that depends on the angle: a table by the cosine, between whose entries one reads off a straight line.

use crate::math::Rgb;

/// Intervals of the table.
const INTERVALS: u32 = 128;

/// The radiance that a surface gives off by the angle to its normal, the same on both sides. Entry k stands for the cosine (k/n)², because
/// reflection changes fastest along the surface.
#[derive(Debug, Clone, PartialEq)]
pub struct AngularEmission(Vec<Rgb>);

impl AngularEmission {
    /// The table of a function of the cosine; `None` if it has no value.
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
        // A unit vector may be longer than 1 by a rounding.
        let left = (place as usize).min(INTERVALS as usize - 1);
        let share = place - left as f64;
        self.0[left] * (1.0 - share) + self.0[left + 1] * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Straight in the root of the cosine, so such a function is given back, also at both ends and a rounding beyond.
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
