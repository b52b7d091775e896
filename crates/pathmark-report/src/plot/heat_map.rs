//! Heat maps: the pieces of an image as rectangles, coloured by a value such as milliseconds per tile.
//!
//! The colours are those of the error maps, whose lightness rises evenly with the value.

use super::Figure;
use super::drawing::{Align, Drawing};
use super::frame::{self, WIDTH};
use super::style::{GRID, INK, LEADING, MARGIN, MUTED, TEXT_SIZE};
use super::title::Title;
use super::{colour_bar, font, number};
use crate::metric::heat_colour;

/// Space below the image.
const SPACE: f64 = 18.0;
/// Largest height of the image.
const TALLEST: f64 = 420.0;
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

/// The number of different colours less one. Tiles of one colour are one element of an SVG.
const SHADES: f64 = 127.0;

/// The figure: one image. Tiles whose value is not finite are grey, and it reports their number.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    pub title: Title,
    pub subtitle: String,
    pub caption: String,
    /// Meaning of the colours, with the unit.
    pub label: String,
    /// The title of the image, above it.
    pub name: String,
    pub width: u32,
    pub height: u32,
    /// Its rectangles. Uncovered parts stay white; parts beyond the image are cut.
    pub tiles: Vec<Tile>,
}

impl HeatMap {
    /// The values of the darkest and the lightest colour; `None` if there is no value.
    fn ends(&self) -> Option<(f64, f64)> {
        let mut finite = self.tiles.iter().map(|tile| tile.value).filter(|value| value.is_finite());
        let first = finite.next()?;
        Some(finite.fold((first, first), |(low, high), value| (low.min(value), high.max(value))))
    }

    /// Draws the image with its upper left corner at a position and `factor` pixels per image pixel.
    fn draw_image(&self, drawing: &mut Drawing, (left, top): (f64, f64), factor: f64, (low, high): (f64, f64)) {
        let x = |pixel: u32| left + f64::from(pixel.min(self.width)) * factor;
        let y = |pixel: u32| top + f64::from(pixel.min(self.height)) * factor;
        let shade = |tile: &Tile| {
            let share = if high > low { ((tile.value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
            tile.value.is_finite().then(|| (share * SHADES).round() as u32)
        };
        let mut tiles: Vec<(Option<u32>, &Tile)> = self.tiles.iter().map(|tile| (shade(tile), tile)).collect();
        tiles.sort_by_key(|(shade, _)| *shade);
        for (shade, tile) in tiles {
            let colour = shade.map_or(GRID, |shade| heat_colour(f64::from(shade) / SHADES));
            drawing.rectangle([x(tile.x0), y(tile.y0), x(tile.x1), y(tile.y1)], colour);
        }
        drawing.outline([left, top, x(self.width), y(self.height)], INK);
    }
}

impl Figure for HeatMap {
    fn drawing(&self) -> Drawing {
        let (width, height) = (f64::from(self.width.max(1)), f64::from(self.height.max(1)));
        let factor = ((WIDTH - 2.0 * MARGIN) / width).min(TALLEST / height);
        // No wider than the image and the colour bar with the last label.
        let mut drawing = Drawing::new(self.title.head(), 2.0 * MARGIN + (width * factor).max(BAR + MARGIN), 0.0);
        let mut y = frame::words_above(&mut drawing, &self.title, &self.subtitle) + 12.0;
        let ends = self.ends();
        let widest = drawing.width - 2.0 * MARGIN;
        for line in font::wrap(&self.name, TEXT_SIZE, widest) {
            drawing.text((MARGIN, y + 0.5 * TEXT_SIZE * LEADING), &line, TEXT_SIZE, INK, Align::Left);
            y += TEXT_SIZE * LEADING;
        }
        y += 4.0;
        self.draw_image(&mut drawing, (MARGIN, y), factor, ends.unwrap_or((0.0, 0.0)));
        y += height * factor + SPACE;
        if let Some((low, high)) = ends {
            let label = |share: f64| number::short(low + share * (high - low), 3);
            y = colour_bar::draw(&mut drawing, (MARGIN, y), BAR, (0.0, 1.0), &self.label, label) + 10.0;
        } else {
            drawing.text((MARGIN, y + TEXT_SIZE), "no data", TEXT_SIZE, MUTED, Align::Left);
            y += 2.0 * TEXT_SIZE * LEADING;
        }
        y = frame::words_below(&mut drawing, &self.caption, y);
        let lost = self.tiles.iter().filter(|tile| !tile.value.is_finite()).count();
        if lost > 0 {
            let plural = if lost == 1 { "rectangle has" } else { "rectangles have" };
            y = frame::words_below(&mut drawing, &format!("{lost} {plural} no value (grey)"), y);
        }
        drawing.height = (y + 12.0).ceil();
        drawing
    }
}
