//! Names at the ends of lines: a reader need not match colours with a legend.

use super::drawing::{Align, Drawing, PartKind, Place};
use super::font;
use super::frame::Frame;
use super::style::{Colour, GRID, HAIRLINE, LEADING, SMALL_SIZE};

/// Space between the frame and the names.
const GAP: f64 = 12.0;
/// The column is wider than its measured text by this factor, because viewers' fonts differ.
const SLACK: f64 = 1.06;
/// More lines than this do not fit beside the data.
const MOST: usize = 22;
/// Longer names are broken.
const WIDEST: f64 = 220.0;
/// Distance of two lines of text.
const LINE: f64 = SMALL_SIZE * LEADING;

pub(super) struct EndLabel {
    /// The part of the drawing that it names.
    pub(super) part: String,
    pub(super) text: String,
    /// The end of its line.
    pub(super) at: Place,
    pub(super) colour: Colour,
}

fn lines(name: &str) -> Vec<String> {
    font::wrap(name, SMALL_SIZE, WIDEST)
}

/// Whether names fit beside the data. A single line of data needs none.
pub(super) fn fit<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> bool {
    names.len() > 1 && names.map(|name| lines(name).len()).sum::<usize>() <= MOST
}

/// Width of the column of names.
pub(super) fn width<'a>(names: impl Iterator<Item = &'a str>) -> f64 {
    SLACK * names.flat_map(lines).map(|line| font::width(&line, SMALL_SIZE)).fold(0.0, f64::max)
}

/// Draws the names right of the frame, each as near to the height of its line's end as the others allow.
pub(super) fn draw(drawing: &mut Drawing, frame: &Frame, mut labels: Vec<EndLabel>) {
    labels.sort_by(|a, b| a.at.1.total_cmp(&b.at.1));
    let (right, ends) = frame.right_side();
    let texts: Vec<Vec<String>> = labels.iter().map(|label| lines(&label.text)).collect();
    let wanted: Vec<[f64; 2]> =
        labels.iter().zip(&texts).map(|(label, text)| [label.at.1, text.len() as f64 * LINE]).collect();
    for ((label, text), y) in labels.into_iter().zip(texts).zip(apart(&wanted, ends)) {
        let first = y - 0.5 * (text.len() as f64 - 1.0) * LINE;
        drawing.part(PartKind::Legend, &label.part, |drawing| {
            drawing.path(vec![label.at, (right + GAP - 3.0, y)], GRID, HAIRLINE);
            for (i, line) in text.iter().enumerate() {
                let at = (right + GAP, first + i as f64 * LINE);
                drawing.text(at, line, SMALL_SIZE, label.colour, Align::Left);
            }
        });
    }
}

/// Moves texts, given by their middles in ascending order and their heights, apart; within the ends where they fit.
fn apart(wanted: &[[f64; 2]], [top, bottom]: [f64; 2]) -> Vec<f64> {
    let mut free = top - 0.5 * LINE;
    let mut middles: Vec<f64> = Vec::new();
    for [middle, height] in wanted {
        let middle = middle.max(free + 0.5 * height);
        middles.push(middle);
        free = middle + 0.5 * height;
    }
    let mut free = bottom + 0.5 * LINE;
    for (middle, [_, height]) in middles.iter_mut().zip(wanted).rev() {
        *middle = middle.min(free - 0.5 * height);
        free = *middle - 0.5 * height;
    }
    middles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_order_and_a_distance() {
        let near = |found: &[f64], expected: &[f64]| {
            let close = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
            assert!(found.len() == expected.len() && found.iter().zip(expected).all(close), "{found:?}");
        };
        let of = |middles: &[f64]| middles.iter().map(|middle| [*middle, LINE]).collect::<Vec<[f64; 2]>>();
        let found = apart(&of(&[5.0, 150.0, 151.0, 299.0, 299.5]), [0.0, 300.0]);
        near(&found, &[5.0, 150.0, 150.0 + LINE, 300.0 - LINE, 300.0]);
        near(&apart(&of(&[20.0, 80.0]), [0.0, 300.0]), &[20.0, 80.0]);
        assert!(apart(&[], [0.0, 300.0]).is_empty());
        // A name of two lines takes the room of two.
        let found = apart(&[[50.0, 2.0 * LINE], [50.0, LINE]], [0.0, 300.0]);
        near(&found, &[50.0, 50.0 + 1.5 * LINE]);
    }
}
