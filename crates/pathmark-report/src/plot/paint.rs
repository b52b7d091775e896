//! Painting: marks on plotters' backends, fonts and file formats.

use std::io::{Cursor, Error as IoError};

use image::RgbImage;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use plotters::coord::Shift;
use plotters::prelude::{
    BitMapBackend, Circle, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoDrawingArea, PathElement, Polygon,
    RGBAColor, RGBColor, Rectangle, SVGBackend, ShapeStyle, Text as Label,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, TextStyle};

use super::drawing::{Align, Drawing, Mark, Note, PartKind, Place, Text};
use super::style::{Colour, PAPER};
use super::{font, lettering};
use crate::error::{Error, Result};

/// Backends have whole pixels only; twice as many place lines and letters more accurately.
pub(super) const SCALE: f64 = 2.0;

/// plotters' SVG backend writes font-size = size / 1.24.
const SVG_SIZE: f64 = 1.24;
/// It puts the base line half the height of a small x below the position, in ems: 0.27 for `DejaVu` Sans and about the
/// same for other fonts.
const SVG_BASE_LINE: f64 = 0.27;

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
        lettering::write(&mut image, text, scale)?;
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
    let drop = (lettering::HALF_CAPITAL - SVG_BASE_LINE) * text.size;
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
