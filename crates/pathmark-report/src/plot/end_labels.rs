//! Names at the ends of lines: a reader need not match colours with a legend.

use super::drawing::{Align, Drawing, PartKind};
use super::font;
use super::frame::Frame;
use super::line_chart::Point;
use super::style::{Colour, GRID, HAIRLINE, LEADING, SMALL_SIZE};

/// Space between the frame and the names.
const GAP: f64 = 12.0;
/// The column is wider than its measured text by this factor, because viewers' fonts differ.
const SLACK: f64 = 1.06;

pub(super) struct EndLabel<'a> {
    pub(super) text: &'a str,
    /// The last point of its line.
    pub(super) point: Point,
    pub(super) colour: Colour,
}

/// Width of the column of names.
pub(super) fn width(labels: &[EndLabel<'_>]) -> f64 {
    SLACK * labels.iter().map(|label| font::width(label.text, SMALL_SIZE)).fold(0.0, f64::max)
}

/// Draws the names right of the frame, each as near to the height of its line's end as the others allow.
pub(super) fn draw(drawing: &mut Drawing, frame: &Frame, labels: &[EndLabel<'_>]) {
    let placed = labels.iter().filter_map(|label| Some((frame.spot(label.point.x, label.point.y)?, label)));
    let mut placed: Vec<_> = placed.collect();
    placed.sort_by(|a, b| a.0.1.total_cmp(&b.0.1));
    let (right, [top, bottom]) = frame.right_side();
    let wanted: Vec<f64> = placed.iter().map(|(end, _)| end.1).collect();
    let heights = apart(&wanted, SMALL_SIZE * LEADING, [top, bottom]);
    for ((end, label), y) in placed.into_iter().zip(heights) {
        drawing.part(PartKind::Legend, label.text, |drawing| {
            drawing.path(vec![end, (right + GAP - 3.0, y)], GRID, HAIRLINE);
            drawing.text((right + GAP, y), label.text, SMALL_SIZE, label.colour, Align::Left);
        });
    }
}

/// Moves ascending heights apart by at least `step`, within the ends where they fit.
fn apart(wanted: &[f64], step: f64, [top, bottom]: [f64; 2]) -> Vec<f64> {
    let mut heights: Vec<f64> = Vec::new();
    for y in wanted {
        let free = heights.last().map_or(top, |last| last + step);
        heights.push(y.max(free));
    }
    let mut free = bottom;
    for y in heights.iter_mut().rev() {
        *y = y.min(free);
        free = *y - step;
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_keep_their_order_and_a_distance() {
        let found = apart(&[5.0, 50.0, 51.0, 99.0, 99.5], 10.0, [0.0, 100.0]);
        assert_eq!(found, [5.0, 50.0, 60.0, 90.0, 100.0]);
        assert_eq!(apart(&[20.0, 80.0], 10.0, [0.0, 100.0]), [20.0, 80.0]);
        assert!(apart(&[], 10.0, [0.0, 100.0]).is_empty());
    }
}
