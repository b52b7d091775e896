//! The look of figures: colours, markers, dashes, sizes.
//!
//! The hues are from M. Okabe and K. Ito, "Color universal design" (2008); people with any of the common colour
//! deficiencies can distinguish them. Light ones are darkened, and yellow is replaced by grey, so that each has a
//! contrast of 3:1 to white (WCAG 2.1, 1.4.11). The marker repeats the information of the colour, so a figure can be
//! read without colour.

/// Red, green, blue, 0 to 255.
pub type Colour = [u8; 3];

/// Text and frame.
pub const INK: Colour = [34, 34, 34];
/// Subtitles, captions and guide lines.
pub const MUTED: Colour = [89, 89, 89];
/// Grid lines.
pub const GRID: Colour = [225, 225, 225];
/// Minor grid lines.
pub const FAINT: Colour = [241, 241, 241];
/// The background.
pub const PAPER: Colour = [255, 255, 255];

/// Colours of series: blue, vermillion, green, orange, purple, sky, black, grey.
pub const SERIES: [Colour; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 140, 103],
    [196, 134, 0],
    [190, 100, 155],
    [50, 148, 205],
    [20, 20, 20],
    [128, 128, 128],
];

/// Size of the title in pixels per em.
pub const TITLE_SIZE: f64 = 17.0;
/// Size of axis titles, legends and subtitles.
pub const TEXT_SIZE: f64 = 12.5;
/// Size of tick labels and captions.
pub const SMALL_SIZE: f64 = 11.5;
/// Distance between lines of text in ems.
pub const LEADING: f64 = 1.45;
/// Space left free at every edge, in pixels.
pub const MARGIN: f64 = 24.0;
/// Width of a series' line.
pub const LINE: f64 = 2.0;
/// Width of frames, grid lines and error bars.
pub const HAIRLINE: f64 = 1.0;

/// The shape at each point of a series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    Disc,
    Square,
    Triangle,
    Diamond,
    /// A filled triangle, point down.
    Nabla,
    Plus,
    Cross,
    /// A circle with an empty middle.
    Ring,
}

/// All markers, in the order in which series get them.
pub const MARKERS: [Marker; 8] = [
    Marker::Disc,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::Nabla,
    Marker::Plus,
    Marker::Cross,
    Marker::Ring,
];

/// The dash pattern of a line: lengths of stroke and gap in turn, in pixels. Empty means solid.
pub type Dash = &'static [f64];

/// Dashes, in the order in which they are used.
pub const DASHES: [Dash; 4] = [&[], &[8.0, 4.0], &[2.0, 3.0], &[10.0, 3.0, 2.0, 3.0]];

/// The properties that distinguish a series from the others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    pub colour: Colour,
    pub marker: Marker,
    pub dash: Dash,
}

impl Look {
    /// The look of series number `index`: colour and marker change first; after each eight, the colours get other
    /// markers and dashes.
    pub fn nth(index: usize) -> Self {
        Self::of(index, index / SERIES.len())
    }

    /// The colour stands for one property of a series, such as its strategy, and the dashes for another, such as its
    /// threads. The marker depends on both, so that points can be distinguished without their lines.
    pub fn of(colour: usize, dash: usize) -> Self {
        Self {
            colour: SERIES[colour % SERIES.len()],
            marker: MARKERS[(colour + 3 * dash) % MARKERS.len()],
            dash: DASHES[dash % DASHES.len()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance as WCAG 2.1 defines it.
    fn luminance(colour: Colour) -> f64 {
        let linear = colour.map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    #[test]
    fn every_colour_stands_out_from_the_ground() {
        let contrast = |colour| (luminance(PAPER) + 0.05) / (luminance(colour) + 0.05);
        for colour in SERIES {
            assert!(contrast(colour) >= 3.0, "{colour:?}: {}", contrast(colour));
        }
        // Text needs more: 4.5.
        assert!(contrast(INK) >= 4.5 && contrast(MUTED) >= 4.5);
    }

    #[test]
    fn sixty_four_series_look_different_in_colour_and_marker() {
        let looks: Vec<Look> = (0..64).map(Look::nth).collect();
        for (i, look) in looks.iter().enumerate() {
            let same = |other: &Look| (other.colour, other.marker) == (look.colour, look.marker);
            assert!(!looks[..i].iter().any(same), "{i}");
        }
        // Among the first eight, colour alone and marker alone distinguish them.
        for (i, look) in looks[..8].iter().enumerate() {
            assert!(looks[..i].iter().all(|other| other.marker != look.marker && other.colour != look.colour));
        }
    }
}
