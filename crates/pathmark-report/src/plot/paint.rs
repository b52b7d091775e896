//! Painting: marks on plotters' backends, fonts and file formats.

use std::io::{Cursor, Error as IoError};

use ab_glyph::{Font, PxScale, point as glyph_point};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{Rgb, RgbImage};
use plotters::coord::Shift;
use plotters::prelude::{
    BitMapBackend, Circle, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoDrawingArea, PathElement, Polygon,
    RGBAColor, RGBColor, Rectangle, SVGBackend, ShapeStyle, Text as Label,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, TextStyle};

use super::drawing::{Align, Drawing, Mark, Note, PartKind, Place, Text};
use super::font;
use super::style::{Colour, PAPER};
use crate::error::{Error, Result};

/// Backends have whole pixels only; twice as many place lines and letters more accurately.
pub(super) const SCALE: f64 = 2.0;

/// plotters' SVG backend writes font-size = size / 1.24.
const SVG_SIZE: f64 = 1.24;
/// It puts the base line half the height of a small x below the position, in ems: 0.27 for `DejaVu` Sans and about the
/// same for other fonts.
const SVG_BASE_LINE: f64 = 0.27;

/// Half the height of a capital letter of `DejaVu` Sans, in ems.
const HALF_CAPITAL: f64 = 0.3645;

/// A complete SVG document.
pub(super) fn svg(drawing: &Drawing) -> Result<String> {
    let size = device_size(drawing, SCALE);
    let mut text = format!(
        "<svg width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\">\n<title>{}</title>",
        drawing.width,
        drawing.height,
        size.0,
        size.1,
        escaped(&drawing.title)
    );
    let mut done = 0;
    for part in &drawing.parts {
        text += &elements(&drawing.marks[done..part.marks.start], size, done == 0)?;
        let class = match part.kind {
            PartKind::Series => "series",
            PartKind::Legend => "legend",
        };
        let own = elements(&drawing.marks[part.marks.clone()], size, false)?;
        let series = escaped(&part.series);
        text += &["<g class=\"", class, "\" data-series=\"", &series, "\">", &own, "</g>\n"].concat();
        done = part.marks.end;
    }
    text += &elements(&drawing.marks[done..], size, done == 0)?;
    for note in &drawing.notes {
        text += &circle(note);
    }
    Ok(text + "</svg>\n")
}

/// Distance from a value within which a pointer finds it, in pixels of the drawing.
const REACH: f64 = 9.0;

/// An invisible circle over a value; it shows the value to a reader who points at it.
fn circle(note: &Note) -> String {
    let (low, high) = note.interval.map_or_else(Default::default, |(low, high)| (low.to_string(), high.to_string()));
    let count = note.count.map_or_else(String::new, |count| count.to_string());
    format!(
        "<circle class=\"note\" cx=\"{:.0}\" cy=\"{:.0}\" r=\"{}\" fill=\"none\" pointer-events=\"all\" data-series=\"{}\" data-of=\"{}\" data-value=\"{}\" data-low=\"{low}\" data-high=\"{high}\" data-count=\"{count}\"><title>{}</title></circle>\n",
        note.at.0 * SCALE,
        note.at.1 * SCALE,
        REACH * SCALE,
        escaped(&note.series),
        escaped(&note.of),
        note.value,
        escaped(&note.text),
    )
}

/// The SVG elements of some marks, with the paper if they are the first.
fn elements(marks: &[Mark], size: (u32, u32), with_paper: bool) -> Result<String> {
    if marks.is_empty() && !with_paper {
        return Ok(String::new());
    }
    let mut text = String::new();
    paint(marks, with_paper, &SVGBackend::with_string(&mut text, size).into_drawing_area(), SCALE, true)?;
    // plotters' own first tag gives the size in the finer pixels and has no title for readers who cannot see.
    let body = text.split_once('>').map_or(text.as_str(), |(_, body)| body);
    let body = body.trim_end().trim_end_matches("</svg>");
    // Default values of attributes take a quarter of the text.
    Ok(body.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", ""))
}

/// Escapes text between tags, or between quotes in a tag.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

pub(super) fn pixels(drawing: &Drawing, scale: f64) -> Result<RgbImage> {
    let (width, height) = device_size(drawing, scale);
    let mut image = RgbImage::new(width, height);
    let area = BitMapBackend::with_buffer(&mut image, (width, height)).into_drawing_area();
    paint(&drawing.marks, true, &area, scale, false)?;
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

fn device_size(drawing: &Drawing, scale: f64) -> (u32, u32) {
    ((drawing.width * scale).ceil() as u32, (drawing.height * scale).ceil() as u32)
}

fn failure(error: &dyn std::error::Error) -> Error {
    Error::system("drawing", "a figure", IoError::other(error.to_string()))
}

/// Paints marks; text only if the backend sets it.
fn paint<B: DrawingBackend>(
    marks: &[Mark],
    with_paper: bool,
    area: &DrawingArea<B, Shift>,
    scale: f64,
    with_text: bool,
) -> Result<()> {
    font::face()?;
    let painted = || -> std::result::Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        if with_paper {
            area.fill(&opaque(PAPER))?;
        }
        for mark in marks {
            match mark {
                Mark::Path { places, colour, width } => {
                    let style = opaque(*colour).stroke_width((width * scale).round().max(1.0) as u32);
                    area.draw(&PathElement::new(device(places, scale), style))?;
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
                Mark::Text(text) if with_text => area.draw(&label(text, &opaque(text.colour), scale))?,
                Mark::Text(_) => {}
            }
        }
        area.present()
    };
    painted().map_err(|error| failure(&error))
}

fn label<'a>(text: &Text, colour: &'a RGBColor, scale: f64) -> Label<'a, (i32, i32), String> {
    let drop = (HALF_CAPITAL - SVG_BASE_LINE) * text.size;
    let (x, y) = text.at;
    // In text that reads upwards, down becomes right.
    let at = if text.upwards { (x + drop, y) } else { (x, y + drop) };
    let horizontal = match text.align {
        Align::Left => HPos::Left,
        Align::Centre => HPos::Center,
        Align::Right => HPos::Right,
    };
    let turn = if text.upwards { FontTransform::Rotate270 } else { FontTransform::None };
    let style = TextStyle::from(font::describe(text.size * scale * SVG_SIZE).transform(turn))
        .color(colour)
        .pos(Pos::new(horizontal, VPos::Center));
    Label::new(text.text.clone(), point(at, scale), style)
}

fn opaque(colour: Colour) -> RGBColor {
    RGBColor(colour[0], colour[1], colour[2])
}

fn device(places: &[Place], scale: f64) -> Vec<(i32, i32)> {
    places.iter().map(|&place| point(place, scale)).collect()
}

fn point(place: Place, scale: f64) -> (i32, i32) {
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
