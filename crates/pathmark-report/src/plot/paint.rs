//! Painting: marks on plotters' bitmaps, letters of the embedded font, and PNG files.

use std::io::{Cursor, Error as IoError};

use ab_glyph::{Font, PxScale, point as glyph_point};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgb, RgbImage};
use plotters::coord::Shift;
use plotters::prelude::{
    BitMapBackend, Circle, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoDrawingArea, PathElement, Polygon,
    RGBAColor, RGBColor, Rectangle, ShapeStyle,
};
use plotters::style::Color;

use super::drawing::{Align, Drawing, Mark, Place, Text, strokes};
use super::font;
use super::style::{Colour, PAPER};
use crate::error::{Error, Result};

/// Backends have whole pixels only; twice as many place lines and letters more accurately.
pub(super) const SCALE: f64 = 2.0;

/// Half the height of a capital letter of `DejaVu` Sans, in ems.
pub(super) const HALF_CAPITAL: f64 = 0.3645;

pub(super) fn pixels(drawing: &Drawing, scale: f64) -> Result<RgbImage> {
    let (width, height) = device_size(drawing, scale);
    let mut image = RgbImage::new(width, height);
    let area = BitMapBackend::with_buffer(&mut image, (width, height)).into_drawing_area();
    paint(&drawing.marks, &area, scale)?;
    drop(area);
    for text in drawing.texts() {
        write(&mut image, text, scale)?;
    }
    Ok(image)
}

/// The bytes of a PNG file.
pub(super) fn png(image: &RgbImage) -> Result<Vec<u8>> {
    let mut bytes = Cursor::new(Vec::new());
    // Large even areas compress best without a filter; noise does not compress at all. The best compression makes files
    // 1 % smaller, but `report` of the authors' results takes 4.5 s instead of 2.7 s.
    let encoder = PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::NoFilter);
    image.write_with_encoder(encoder).map_err(|error| failure(&error))?;
    Ok(bytes.into_inner())
}

pub(super) fn device_size(drawing: &Drawing, scale: f64) -> (u32, u32) {
    ((drawing.width * scale).ceil() as u32, (drawing.height * scale).ceil() as u32)
}

fn failure(error: &dyn std::error::Error) -> Error {
    Error::system("drawing", "a figure", IoError::other(error.to_string()))
}

/// Paints all marks but text.
fn paint<B: DrawingBackend>(marks: &[Mark], area: &DrawingArea<B, Shift>, scale: f64) -> Result<()> {
    let painted = || -> std::result::Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.fill(&opaque(PAPER))?;
        for mark in marks {
            match mark {
                Mark::Path { places, colour, width, dash } => {
                    let style = opaque(*colour).stroke_width((width * scale).round().max(1.0) as u32);
                    for stroke in strokes(places, dash).iter().filter(|stroke| stroke.len() > 1) {
                        area.draw(&PathElement::new(device(stroke, scale), style))?;
                    }
                }
                Mark::Area { places, colour, opacity } => {
                    let style = RGBAColor(colour[0], colour[1], colour[2], *opacity).filled();
                    area.draw(&Polygon::new(device(places, scale), style))?;
                }
                Mark::Rectangle { sides: [left, top, right, bottom], colour } => {
                    let corners = [point((*left, *top), scale), point((*right, *bottom), scale)];
                    area.draw(&Rectangle::new(corners, opaque(*colour).filled()))?;
                }
                Mark::Disc { at, radius, colour } => {
                    let style: ShapeStyle = opaque(*colour).filled();
                    area.draw(&Circle::new(point(*at, scale), (radius * scale).round() as u32, style))?;
                }
                Mark::Text(_) => {}
            }
        }
        area.present()
    };
    painted().map_err(|error| failure(&error))
}

fn opaque(colour: Colour) -> RGBColor {
    RGBColor(colour[0], colour[1], colour[2])
}

fn device(places: &[Place], scale: f64) -> Vec<(i32, i32)> {
    places.iter().map(|&place| point(place, scale)).collect()
}

pub(super) fn point(place: Place, scale: f64) -> (i32, i32) {
    ((place.0 * scale).round() as i32, (place.1 * scale).round() as i32)
}

/// Writes `text` with `scale` pixels per pixel of the drawing. plotters' own text drops the space at the left of each
/// letter and rounds every letter to a whole pixel, so words look torn. Here letters have fractional positions.
fn write(image: &mut RgbImage, text: &Text, scale: f64) -> Result<()> {
    let face = font::face()?;
    let em = text.size * scale;
    let (glyphs, width) = font::set(face, &text.text);
    let start = match text.align {
        Align::Left => 0.0,
        Align::Centre => -0.5 * width,
        Align::Right => -width,
    };
    // ab_glyph's size is the height of a line; this is the size whose em is as wanted.
    let size = PxScale::from(em as f32 * face.height_unscaled() / face.units_per_em().unwrap_or(1.0));
    let base_line = (HALF_CAPITAL * em).round() as f32;
    let (x, y) = ((text.at.0 * scale).round() as i64, (text.at.1 * scale).round() as i64);
    for (glyph, pen) in glyphs {
        let placed = glyph.with_scale_and_position(size, glyph_point(((start + pen) * em) as f32, base_line));
        let Some(outline) = face.outline_glyph(placed) else { continue };
        let corner = outline.px_bounds().min;
        outline.draw(|dx, dy, cover| {
            let (along, down) = (corner.x as i64 + i64::from(dx), corner.y as i64 + i64::from(dy));
            let (px, py) = if text.upwards { (x + down, y - 1 - along) } else { (x + along, y + down) };
            blend(image, px, py, text.colour, cover);
        });
    }
    Ok(())
}

/// Mixes a colour into a pixel, if the image contains that position.
fn blend(image: &mut RgbImage, x: i64, y: i64, colour: [u8; 3], cover: f32) {
    let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
    let Some(Rgb(below)) = image.get_pixel_mut_checked(x, y) else { return };
    for (old, new) in below.iter_mut().zip(colour) {
        *old = (f32::from(*old) + cover.clamp(0.0, 1.0) * (f32::from(new) - f32::from(*old))).round() as u8;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::drawing::Drawing;

    /// Left, top, right and bottom of the dark pixels.
    fn inked(image: &RgbImage) -> [u32; 4] {
        let dark = image.enumerate_pixels().filter(|(_, _, pixel)| pixel.0[0] < 128);
        dark.fold([u32::MAX, u32::MAX, 0, 0], |[l, t, r, b], (x, y, _)| [l.min(x), t.min(y), r.max(x), b.max(y)])
    }

    #[test]
    fn capitals_are_centred_on_their_place() {
        let mut drawing = Drawing::new("t", 100.0, 100.0);
        drawing.text((50.0, 50.0), "HHH", 20.0, [0; 3], Align::Centre);
        drawing.text_upwards((50.0, 50.0), "HHH", 20.0, [0; 3]);
        let texts: Vec<&Text> = drawing.texts().collect();
        for (text, turned) in texts.into_iter().zip([false, true]) {
            let mut image = RgbImage::from_pixel(200, 200, Rgb([255; 3]));
            write(&mut image, text, 2.0).unwrap();
            let [left, top, right, bottom] = inked(&image).map(f64::from);
            assert!((left + right - 199.0).abs() <= 3.0 && (top + bottom - 199.0).abs() <= 3.0);
            assert_eq!(right - left < bottom - top, turned);
        }
    }

    #[test]
    fn text_beyond_the_edge_is_cut() {
        let mut image = RgbImage::new(10, 10);
        let mut drawing = Drawing::new("t", 10.0, 10.0);
        drawing.text((-5.0, 9.0), "wide text", 20.0, [255; 3], Align::Left);
        write(&mut image, drawing.texts().next().unwrap(), 1.0).unwrap();
        assert!(image.pixels().any(|pixel| pixel.0[0] > 0));
    }
}
