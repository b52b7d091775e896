//! Contact sheets: renders at growing spp beside their reference, with maps of their error below.
//!
//! PNG only, because readers look at the pixels.

use image::RgbImage;
use image::imageops;
use serde::Serialize;

use super::drawing::{Align, Drawing};
use super::style::{INK, LEADING, MARGIN, MUTED, SMALL_SIZE, TEXT_SIZE};
use super::title::Title;
use super::{colour_bar, font, frame, number, paint};
use crate::error::{Error, Result};
use crate::image_io::Image;
use crate::image_io::tone_map::quantise_image;

/// Approximate width of an image on the sheet.
const SHOWN: u32 = 240;
/// Approximate width of larger images: every fifth pixel of 1024, so that a page with all sheets stays below 8 MB.
const REDUCED: u32 = 224;
/// Space between images.
const GAP: f64 = 16.0;

#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Lines above the image: the first is the title.
    pub caption: Vec<String>,
    pub width: u32,
    pub height: u32,
    /// Red, green and blue of each pixel, rows from the top; `3 * width * height` bytes.
    pub rgb: Vec<u8>,
}

impl Cell {
    /// The part in the middle that a sheet shows with all its pixels; `None` if it shows all pixels of the image.
    pub fn crop(&self) -> Option<Self> {
        let (_, step) = factors(self.width);
        let (width, height) = (self.width / step, self.height / step);
        let (left, top) = ((self.width - width) / 2, (self.height - height) / 2);
        let start = |row: u32| 3 * ((top + row) * self.width + left) as usize;
        let rows = (0..height).filter_map(|row| self.rgb.get(start(row)..start(row) + 3 * width as usize));
        let rgb = rows.flatten().copied().collect();
        (step > 1).then(|| Self { caption: vec!["middle, every pixel".to_string()], width, height, rgb })
    }

    /// Of how many columns, and of how many rows, the sheet shows one.
    pub fn step(&self) -> u32 {
        factors(self.width).1
    }

    /// An image as it is shown on a display.
    pub fn of(image: &Image, caption: Vec<String>) -> Result<Self> {
        Ok(Self { caption, width: image.width, height: image.height, rgb: quantise_image(image)? })
    }
}

/// The scale of heat maps.
#[derive(Debug, Clone, PartialEq)]
pub struct ColourBar {
    /// Meaning of the colours, with the unit.
    pub label: String,
    /// The value of the lightest colour; the darkest is 0.
    pub full: f64,
    /// Whether `full` is the largest possible value; otherwise larger values also have the lightest colour.
    pub is_largest: bool,
}

/// How a page lets the reader compare the images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Comparison {
    /// The columns are steps of a slider.
    Steps,
    /// Any two images lie on top of each other, with an edge to move.
    Wipe,
    /// Each image is shown alone.
    Single,
}

/// The area of an image on the sheet, in pixels, for a page that shows parts of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Placed {
    /// Its row, from the top.
    pub row: usize,
    /// Its column, from the left.
    pub column: usize,
    /// Left, top, width and height.
    pub area: [u32; 4],
    /// Lines above it.
    pub caption: Vec<String>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct ContactSheet {
    pub title: String,
    /// Scene, size, exposure; may be empty.
    pub subtitle: String,
    /// Rows of images. `None` leaves a cell empty, as below a reference that has no error.
    pub rows: Vec<Vec<Option<Cell>>>,
    /// The scales of the heat maps, if there are any.
    pub bars: Vec<ColourBar>,
    pub comparison: Comparison,
}

/// The most images in a row that fit on the page.
const COLUMNS: usize = 4;

impl ContactSheet {
    /// A sheet of groups of images in rows that fit on a page. Each group begins a row.
    pub fn groups(title: String, subtitle: String, groups: Vec<Vec<Cell>>, comparison: Comparison) -> Self {
        let rows = groups.into_iter().flat_map(|cells| {
            let cells: Vec<Option<Cell>> = cells.into_iter().map(Some).collect();
            cells.chunks(COLUMNS).map(<[Option<Cell>]>::to_vec).collect::<Vec<_>>()
        });
        Self { title, subtitle, rows: rows.collect(), bars: Vec::new(), comparison }
    }

    /// The sheet as pixels, and the areas of its images.
    pub fn pixels(&self) -> Result<(RgbImage, Vec<Placed>)> {
        let rows = self.rows.iter().map(|row| row.iter().map(|cell| cell.as_ref().map(shown).transpose()).collect());
        let images: Vec<Vec<Option<RgbImage>>> = rows.collect::<Result<_>>()?;
        let all = || images.iter().flatten().flatten();
        let column = f64::from(all().map(RgbImage::width).max().unwrap_or(SHOWN));
        let columns = images.iter().map(Vec::len).max().unwrap_or(0).max(2) as f64;
        let width = 2.0 * MARGIN + columns * (column + GAP) - GAP;

        let mut drawing = Drawing::new(&self.title, width, 0.0);
        let mut y = frame::words_above(&mut drawing, &Title::from(&self.title), &self.subtitle);
        let mut placed = Vec::new();
        for (number, (cells, row)) in self.rows.iter().zip(&images).enumerate() {
            y += GAP;
            let captions: Vec<Vec<(String, usize)>> = cells.iter().map(|cell| caption(cell.as_ref(), column)).collect();
            let lines = captions.iter().map(Vec::len).max().unwrap_or(0) as f64;
            for (i, (image, caption)) in row.iter().zip(&captions).enumerate() {
                let x = MARGIN + i as f64 * (column + GAP);
                for (j, (line, of)) in caption.iter().enumerate() {
                    let (size, colour) = if *of == 0 { (TEXT_SIZE, INK) } else { (SMALL_SIZE, MUTED) };
                    let at = (x, y + (j as f64 + 0.5) * TEXT_SIZE * LEADING);
                    drawing.text(at, line, size, colour, Align::Left);
                }
                let top = y + lines * TEXT_SIZE * LEADING + 4.0;
                placed.extend(image.iter().zip(&cells[i]).map(|(image, cell)| {
                    let area = [x.round() as u32, top.round() as u32, image.width(), image.height()];
                    (image, Placed { row: number, column: i, area, caption: cell.caption.clone() })
                }));
            }
            let tallest = row.iter().flatten().map(RgbImage::height).max().unwrap_or(0);
            y += lines * TEXT_SIZE * LEADING + 4.0 + f64::from(tallest);
        }
        if all().next().is_none() {
            y += GAP;
            drawing.text((MARGIN, y + 0.5 * TEXT_SIZE), "no data", TEXT_SIZE, MUTED, Align::Left);
            y += TEXT_SIZE;
        }
        for bar in &self.bars {
            let width = (2.0 * column + GAP).min(width - 2.0 * MARGIN - 40.0);
            let label = |share: f64| {
                let open = if share == 1.0 && !bar.is_largest { "≥ " } else { "" };
                format!("{open}{}", number::short(share * bar.full, 3))
            };
            y = colour_bar::draw(&mut drawing, (MARGIN, y + 1.5 * GAP), width, (0.0, 1.0), &bar.label, label);
        }
        drawing.height = (y + MARGIN).ceil();
        let mut sheet = paint::pixels(&drawing, 1.0)?;
        for (image, Placed { area: [left, top, ..], .. }) in &placed {
            imageops::replace(&mut sheet, *image, i64::from(*left), i64::from(*top));
        }
        Ok((sheet, placed.into_iter().map(|(_, place)| place).collect()))
    }

    /// The bytes of a PNG file, and the areas of its images.
    pub fn png(&self) -> Result<(Vec<u8>, Vec<Placed>)> {
        let (sheet, placed) = self.pixels()?;
        Ok((paint::png(&sheet)?, placed))
    }
}

/// The lines of a caption, broken to a column's width, each with the index of its original line.
fn caption(cell: Option<&Cell>, column: f64) -> Vec<(String, usize)> {
    let lines = cell.map_or(&[][..], |cell| &cell.caption).iter().enumerate();
    lines.flat_map(|(i, line)| font::wrap(line, TEXT_SIZE, column).into_iter().map(move |part| (part, i))).collect()
}

/// The factors by which an image of this width is enlarged and reduced. One of them is 1.
fn factors(width: u32) -> (u32, u32) {
    let nearest = |a: u32, b: u32| ((a + b / 2) / b).max(1);
    (nearest(SHOWN, width), nearest(width, REDUCED))
}

/// Scales an image to about the usual width, by whole factors: repeats each pixel as a square, or keeps one pixel of
/// each square. Averaging would hide the noise that readers look for.
fn shown(cell: &Cell) -> Result<RgbImage> {
    let Some(image) = RgbImage::from_raw(cell.width, cell.height, cell.rgb.clone()).filter(|i| i.width() > 0) else {
        let problem = format!("{} bytes for {} x {} pixels", cell.rgb.len(), cell.width, cell.height);
        return Err(Error::system("drawing", "an image", std::io::Error::other(problem)));
    };
    let (up, down) = factors(image.width());
    let size = |length: u32| (length * up / down).max(1);
    let source = |place: u32, length: u32| (place * down / up + down / 2).min(length - 1);
    Ok(RgbImage::from_fn(size(image.width()), size(image.height()), |x, y| {
        *image.get_pixel(source(x, image.width()), source(y, image.height()))
    }))
}
