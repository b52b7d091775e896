//! Heat maps: the pieces of an image as rectangles, coloured by a value such as milliseconds per tile.
//!
//! The colours are those of the error maps, whose lightness rises evenly with the value. All panels share one scale.

use super::Figure;
use super::drawing::{Align, Drawing};
use super::frame::WIDTH;
use super::style::{GRID, INK, LEADING, MARGIN, MUTED, TEXT_SIZE};
use super::{colour_bar, font, heading, number};
use crate::metric::heat_colour;

/// Space between panels.
const SPACE: f64 = 18.0;
/// Largest height of a panel.
const TALLEST: f64 = 420.0;
/// Most panels in a row.
const COLUMNS: usize = 3;
/// Width of the colour bar.
const BAR: f64 = 480.0;

/// A rectangle of an image, from its first pixel to the one after its last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    pub x0: u32,
    pub y0: u32,
    pub x1: u32,
    pub y1: u32,
    /// The value that its colour shows.
    pub value: f64,
}

/// One image.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatPanel {
    pub title: String,
    pub width: u32,
    pub height: u32,
    /// Its rectangles. Uncovered parts stay white; parts beyond the image are cut.
    pub tiles: Vec<Tile>,
}

/// The figure. Tiles whose value is not finite are grey, and it reports their number.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    pub title: String,
    pub subtitle: String,
    pub caption: String,
    /// Meaning of the colours, with the unit.
    pub label: String,
    /// Values of the darkest and the lightest colour; `None` for the smallest and the largest value.
    pub scale: Option<(f64, f64)>,
    pub panels: Vec<HeatPanel>,
}

impl HeatMap {
    /// The values of the darkest and the lightest colour; `None` if there is no value.
    fn ends(&self) -> Option<(f64, f64)> {
        let finite = self.panels.iter().flat_map(|panel| &panel.tiles).map(|tile| tile.value).filter(|v| v.is_finite());
        let data = finite.fold(None, |ends: Option<(f64, f64)>, value| {
            Some(ends.map_or((value, value), |(low, high)| (low.min(value), high.max(value))))
        });
        data.map(|data| self.scale.unwrap_or(data))
    }
}

/// Draws a panel with its upper left corner at a position and `factor` pixels per image pixel.
fn draw_panel(drawing: &mut Drawing, panel: &HeatPanel, (left, top): (f64, f64), factor: f64, ends: (f64, f64)) {
    let (low, high) = ends;
    for tile in &panel.tiles {
        let x = |pixel: u32| left + f64::from(pixel.min(panel.width)) * factor;
        let y = |pixel: u32| top + f64::from(pixel.min(panel.height)) * factor;
        let share = if high > low { ((tile.value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
        let colour = if tile.value.is_finite() { heat_colour(share) } else { GRID };
        drawing.rectangle([x(tile.x0), y(tile.y0), x(tile.x1), y(tile.y1)], colour);
    }
    let (right, bottom) = (left + f64::from(panel.width) * factor, top + f64::from(panel.height) * factor);
    drawing.outline([left, top, right, bottom], INK);
}

impl Figure for HeatMap {
    fn drawing(&self) -> Drawing {
        let mut drawing = Drawing::new(&self.title, WIDTH, 0.0);
        let mut y = heading::above(&mut drawing, &self.title, &self.subtitle) + 12.0;
        let columns = self.panels.len().clamp(1, COLUMNS);
        let column = (WIDTH - 2.0 * MARGIN - SPACE * (columns - 1) as f64) / columns as f64;
        let ends = self.ends();
        for row in self.panels.chunks(columns) {
            let titles: Vec<Vec<String>> =
                row.iter().map(|panel| font::wrap(&panel.title, TEXT_SIZE, column)).collect();
            let lines = titles.iter().map(Vec::len).max().unwrap_or(0) as f64;
            let top = y + lines * TEXT_SIZE * LEADING + 4.0;
            let mut tallest = 0.0_f64;
            for (i, (panel, title)) in row.iter().zip(&titles).enumerate() {
                let left = MARGIN + i as f64 * (column + SPACE);
                for (j, line) in title.iter().enumerate() {
                    let at = (left, y + (j as f64 + 0.5) * TEXT_SIZE * LEADING);
                    drawing.text(at, line, TEXT_SIZE, INK, Align::Left);
                }
                let (width, height) = (f64::from(panel.width.max(1)), f64::from(panel.height.max(1)));
                let factor = (column / width).min(TALLEST / height);
                draw_panel(&mut drawing, panel, (left, top), factor, ends.unwrap_or((0.0, 0.0)));
                tallest = tallest.max(height * factor);
            }
            y = top + tallest + SPACE;
        }
        if let Some((low, high)) = ends {
            let label = |share: f64| number::short(low + share * (high - low), 3);
            let labels = [0.0, 0.25, 0.5, 0.75, 1.0].map(label);
            y = colour_bar::draw(&mut drawing, (MARGIN, y), BAR, (0.0, 1.0), &self.label, &labels) + 10.0;
        } else {
            drawing.text((MARGIN, y + TEXT_SIZE), "no data", TEXT_SIZE, MUTED, Align::Left);
            y += 2.0 * TEXT_SIZE * LEADING;
        }
        y = heading::below(&mut drawing, &self.caption, y);
        let lost = self.panels.iter().flat_map(|panel| &panel.tiles).filter(|tile| !tile.value.is_finite()).count();
        if lost > 0 {
            let plural = if lost == 1 { "rectangle has" } else { "rectangles have" };
            y = heading::below(&mut drawing, &format!("{lost} {plural} no value (grey)"), y);
        }
        drawing.height = (y + 12.0).ceil();
        drawing
    }
}
