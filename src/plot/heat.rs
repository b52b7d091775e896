//! Heat maps: a value to a colour that grows lighter with it.
//!
//! The colours are nine evenly spaced ones of "inferno" (S. van der Walt and N. Smith, 2015, public domain), which are
//! evenly spaced to the eye too, also in grey and for colour-blind readers. Between them colours are interpolated.

use super::style::Colour;

const INFERNO: [Colour; 9] = [
    [0, 0, 4],
    [33, 12, 74],
    [87, 16, 109],
    [138, 34, 106],
    [188, 55, 84],
    [228, 89, 50],
    [249, 140, 10],
    [249, 203, 53],
    [252, 255, 164],
];

/// The colour of a value that is not a number: none of the map's.
pub const INVALID: Colour = [0, 200, 255];

/// The colour of `share`, from 0 (black) to 1 (light yellow); what lies beyond gets the colour of the end.
pub fn colour(share: f64) -> Colour {
    if share.is_nan() {
        return INVALID;
    }
    let place = share.clamp(0.0, 1.0) * (INFERNO.len() - 1) as f64;
    let below = (place.floor() as usize).min(INFERNO.len() - 2);
    let fraction = place - below as f64;
    std::array::from_fn(|i| {
        let (low, high) = (f64::from(INFERNO[below][i]), f64::from(INFERNO[below + 1][i]));
        (low + fraction * (high - low)).round() as u8
    })
}

/// The pixels of a heat map, three bytes a value; `full` is the value that gets the lightest colour.
pub fn map(values: &[f64], full: f64) -> Vec<u8> {
    values.iter().flat_map(|value| colour(if *value == 0.0 { 0.0 } else { value / full })).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_grows_with_the_value() {
        let light = |share: f64| {
            let c = colour(share);
            0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
        };
        for i in 0..100 {
            assert!(light(f64::from(i) / 100.0) <= light(f64::from(i + 1) / 100.0) + 0.5, "{i}");
        }
    }

    #[test]
    fn ends_and_nonsense() {
        assert_eq!(colour(-1.0), INFERNO[0]);
        assert_eq!(colour(f64::INFINITY), INFERNO[8]);
        assert_eq!(colour(f64::NAN), INVALID);
        assert_eq!(map(&[0.0, 2.0], 2.0), [INFERNO[0], INFERNO[8]].concat());
        assert_eq!(map(&[0.0], 0.0), INFERNO[0]);
    }
}
