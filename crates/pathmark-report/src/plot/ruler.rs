//! The marks of a horizontal axis: grid lines through the data, ticks and labels below it.

use super::axis::Tick;
use super::drawing::{Align, Drawing, Place};
use super::font;
use super::style::{FAINT, GRID, HAIRLINE, INK, SMALL_SIZE};

/// Length of a tick.
pub(super) const TICK: f64 = 5.0;
/// Space between an axis and its labels.
pub(super) const GAP: f64 = 8.0;
/// Smallest distance between labels; nearer ones are left out.
const APART: f64 = 6.0;

/// Draws grid lines, ticks and labels of an area, given by its left, top, right and bottom.
pub(super) fn below(drawing: &mut Drawing, ticks: &[Tick], area: [f64; 4]) {
    let [left, top, right, foot] = area;
    let mut free_from = f64::MIN;
    for tick in ticks {
        let x = left + tick.place * (right - left);
        grid_line(drawing, tick, (x, foot), (x, top), (x, foot + TICK));
        let half = 0.5 * font::width(&tick.label, SMALL_SIZE);
        if !tick.label.is_empty() && x - half >= free_from {
            let at = (x, foot + TICK + GAP + 0.5 * SMALL_SIZE - 2.0);
            drawing.text(at, &tick.label, SMALL_SIZE, INK, Align::Centre);
            free_from = x + half + APART;
        }
    }
}

/// Draws only the grid lines, for an area whose axis is further below.
pub(super) fn grid(drawing: &mut Drawing, ticks: &[Tick], [left, top, right, foot]: [f64; 4]) {
    for tick in ticks {
        let x = left + tick.place * (right - left);
        drawing.path(vec![(x, foot), (x, top)], if tick.label.is_empty() { FAINT } else { GRID }, HAIRLINE);
    }
}

/// Draws a line through the data area and the tick outside it; minor ticks have a fainter line and no tick.
pub(super) fn grid_line(drawing: &mut Drawing, tick: &Tick, foot: Place, end: Place, outside: Place) {
    if tick.label.is_empty() {
        drawing.path(vec![foot, end], FAINT, HAIRLINE);
    } else {
        drawing.path(vec![foot, end], GRID, HAIRLINE);
        drawing.path(vec![foot, outside], INK, HAIRLINE);
    }
}
