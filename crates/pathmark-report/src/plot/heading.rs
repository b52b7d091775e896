//! The texts above and below a figure.

use super::drawing::{Align, Drawing};
use super::font;
use super::style::{Colour, INK, LEADING, MARGIN, MUTED, SMALL_SIZE, TEXT_SIZE, TITLE_SIZE};

/// Writes title and subtitle at the top, broken to the drawing's width, and returns the y below them.
pub(super) fn above(drawing: &mut Drawing, title: &str, subtitle: &str) -> f64 {
    let y = lines(drawing, title, MARGIN, TITLE_SIZE, INK);
    lines(drawing, subtitle, y, TEXT_SIZE, MUTED)
}

/// Writes a caption from `y` on and returns the y below it.
pub(super) fn below(drawing: &mut Drawing, caption: &str, y: f64) -> f64 {
    lines(drawing, caption, y, SMALL_SIZE, MUTED)
}

fn lines(drawing: &mut Drawing, text: &str, mut y: f64, size: f64, colour: Colour) -> f64 {
    for line in font::wrap(text, size, drawing.width - 2.0 * MARGIN) {
        drawing.text((MARGIN, y + 0.5 * size * LEADING), &line, size, colour, Align::Left);
        y += size * LEADING;
    }
    y
}
