//! The colour bar, which shows the values of colours.

use super::drawing::{Align, Drawing, Place};
use super::style::{GRID, HAIRLINE, INK, LEADING, SMALL_SIZE, TEXT_SIZE};
use crate::metric::heat_colour;

const HEIGHT: f64 = 14.0;
/// Number of colours in a bar.
const STEPS: u32 = 128;

/// Draws a bar with its name above and labels at its quarters below, which are given by shares of its length; the upper
/// left corner is at a position. Returns the y below it.
///
/// `ends`, in [0, 1], are the positions of the bar's ends on the whole colour scale.
pub(super) fn draw(
    drawing: &mut Drawing,
    (left, y): Place,
    width: f64,
    ends: (f64, f64),
    name: &str,
    label: impl Fn(f64) -> String,
) -> f64 {
    drawing.text((left, y + 0.5 * TEXT_SIZE), name, TEXT_SIZE, INK, Align::Left);
    let top = y + TEXT_SIZE * LEADING + 2.0;
    let x = |share: f64| left + share * width;
    for i in 0..STEPS {
        let edge = |j: u32| x(f64::from(j) / f64::from(STEPS)).round();
        let share = (f64::from(i) + 0.5) / f64::from(STEPS);
        let colour = heat_colour(ends.0 + share * (ends.1 - ends.0));
        drawing.rectangle([edge(i), top, edge(i + 1), top + HEIGHT], colour);
    }
    for share in [0.0, 0.25, 0.5, 0.75, 1.0] {
        drawing.path(vec![(x(share), top + HEIGHT), (x(share), top + HEIGHT + 4.0)], INK, HAIRLINE);
        let align = if share == 0.0 { Align::Left } else { Align::Centre };
        drawing.text((x(share), top + HEIGHT + 12.0), &label(share), SMALL_SIZE, INK, align);
    }
    drawing.path(vec![(left, top), (x(1.0), top)], GRID, HAIRLINE);
    top + HEIGHT + 12.0 + SMALL_SIZE
}
