//! SVG documents of drawings. A page holds a hundred of them, so lines in one style that follow each other are one element,
//! and a dashed line is one, too.

use super::drawing::{Align, Drawing, Mark, Note, PartKind, Place, Text};
use super::font;
use super::paint::{HALF_CAPITAL, SCALE, device_size, point};
use super::style::{Colour, PAPER};
use crate::error::Result;
use std::fmt::Write;

/// Distance from a value within which a pointer finds it, in pixels of the document.
pub(crate) const REACH: f64 = 9.0 * SCALE;

/// A complete document, with the values that a reader can point at.
pub(super) fn svg(drawing: &Drawing) -> Result<String> {
    let notes: String = drawing.notes.iter().map(circle).collect();
    document(drawing, &notes)
}

/// The document of the marks, with `end` behind them.
pub(crate) fn document(drawing: &Drawing, end: &str) -> Result<String> {
    // Without the font, no text has a width.
    font::face()?;
    let (width, height) = device_size(drawing, SCALE);
    let mut text = format!(
        "<svg width=\"{}\" height=\"{}\" viewBox=\"0 0 {width} {height}\" xmlns=\"http://www.w3.org/2000/svg\" role=\"img\">\n<title>{}</title>\n",
        drawing.width,
        drawing.height,
        escaped(&drawing.title)
    );
    let _ = writeln!(text, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", hex(PAPER));
    let mut done = 0;
    for part in &drawing.parts {
        text += &elements(&drawing.marks[done..part.marks.start]);
        let class = match part.kind {
            PartKind::Series => "series",
            PartKind::Legend => "legend",
        };
        let (series, own) = (escaped(&part.series), elements(&drawing.marks[part.marks.clone()]));
        let _ = writeln!(text, "<g class=\"{class}\" data-series=\"{series}\">\n{own}</g>");
        done = part.marks.end;
    }
    Ok(text + &elements(&drawing.marks[done..]) + end + "</svg>\n")
}

/// The position of a value in the pixels of the document.
pub(crate) fn place_of(note: &Note) -> (i32, i32) {
    point(note.at, SCALE)
}

/// An invisible circle over a value; it shows the value to a reader who points at it.
fn circle(note: &Note) -> String {
    let (low, high) = note.interval.map_or_else(Default::default, |(low, high)| (low.to_string(), high.to_string()));
    let count = note.count.map_or_else(String::new, |count| count.to_string());
    let (x, y) = place_of(note);
    format!(
        "<circle class=\"note\" cx=\"{x}\" cy=\"{y}\" r=\"{}\" fill=\"none\" pointer-events=\"all\" data-series=\"{}\" data-of=\"{}\" data-value=\"{}\" data-low=\"{low}\" data-high=\"{high}\" data-count=\"{count}\"><title>{}</title></circle>\n",
        REACH,
        escaped(&note.series),
        escaped(&note.of),
        note.value,
        escaped(&note.text),
    )
}

fn elements(marks: &[Mark]) -> String {
    marks.chunk_by(is_one_element).map(element).collect()
}

/// Whether two marks that follow each other are parts of one element: lines or rectangles in one style.
fn is_one_element(a: &Mark, b: &Mark) -> bool {
    match (a, b) {
        (
            Mark::Path { colour, width, dash, .. },
            Mark::Path { colour: next_colour, width: next_width, dash: next_dash, .. },
        ) => (colour, width, dash) == (next_colour, next_width, next_dash),
        (Mark::Rectangle { colour, .. }, Mark::Rectangle { colour: next, .. }) => colour == next,
        _ => false,
    }
}

/// The element of marks in one style.
fn element(marks: &[Mark]) -> String {
    let Some(first) = marks.first() else { return String::new() };
    let style = match first {
        Mark::Path { colour, width, dash, .. } => {
            let lengths: Vec<String> = dash.iter().map(|length| (length * SCALE).to_string()).collect();
            let dashes =
                if lengths.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", lengths.join(" ")) };
            let width = (width * SCALE).round().max(1.0);
            format!("fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{dashes}", hex(*colour))
        }
        Mark::Area { colour, opacity, .. } => {
            let opacity = if *opacity < 1.0 { format!(" opacity=\"{opacity}\"") } else { String::new() };
            format!("fill=\"{}\"{opacity}", hex(*colour))
        }
        Mark::Rectangle { colour, .. } => format!("fill=\"{}\" shape-rendering=\"crispEdges\"", hex(*colour)),
        Mark::Disc { at, radius, colour } => {
            let ((x, y), radius) = (point(*at, SCALE), (radius * SCALE).round());
            return format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>\n", hex(*colour));
        }
        Mark::Text(text) => return words(text),
    };
    let data: String = marks.iter().map(outline).collect();
    format!("<path {style} d=\"{data}\"/>\n")
}

/// The path data of a mark.
fn outline(mark: &Mark) -> String {
    match mark {
        Mark::Path { places, .. } => line(places),
        Mark::Area { places, .. } => line(places) + "z",
        Mark::Rectangle { sides: [left, top, right, bottom], .. } => {
            line(&[(*left, *top), (*right, *top), (*right, *bottom), (*left, *bottom)]) + "z"
        }
        Mark::Disc { .. } | Mark::Text(_) => String::new(),
    }
}

/// A line as path data, in steps between whole pixels, which have the fewest digits: `M5 6h9v-3l2-1`.
fn line(places: &[Place]) -> String {
    let mut text = String::new();
    let mut before: Option<(i64, i64)> = None;
    for &place in places {
        let (x, y) = point(place, SCALE);
        let here = (i64::from(x), i64::from(y));
        let _ = match before.map(|before| (here.0 - before.0, here.1 - before.1)) {
            None => write!(text, "M{x} {y}"),
            Some((0, 0)) => Ok(()),
            Some((along, 0)) => write!(text, "h{along}"),
            Some((0, down)) => write!(text, "v{down}"),
            Some((along, down)) => write!(text, "l{along}{}{down}", if down < 0 { "" } else { " " }),
        };
        before = Some(here);
    }
    text
}

fn words(text: &Text) -> String {
    let drop = HALF_CAPITAL * text.size;
    let (x, y) = text.at;
    // In text that reads upwards, down becomes right.
    let (x, y) = point(if text.upwards { (x + drop, y) } else { (x, y + drop) }, SCALE);
    let place = if text.upwards {
        format!("transform=\"translate({x} {y}) rotate(270)\"")
    } else {
        format!("x=\"{x}\" y=\"{y}\"")
    };
    let anchor = match text.align {
        Align::Left => "start",
        Align::Centre => "middle",
        Align::Right => "end",
    };
    format!(
        "<text {place} text-anchor=\"{anchor}\" font-family=\"{}\" font-size=\"{}\" fill=\"{}\">{}</text>\n",
        font::FAMILY,
        text.size * SCALE,
        hex(text.colour),
        escaped(&text.text)
    )
}

fn hex([red, green, blue]: Colour) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// Escapes text between tags, or between quotes in a tag.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::style::DASHES;

    /// A line of 900 pixels in dashes of 8 and gaps of 4 has 75 strokes, and is one element.
    #[test]
    fn a_dashed_line_is_one_element() {
        let mut drawing = Drawing::new("t", 1000.0, 100.0);
        drawing.dashed(vec![(50.0, 10.0), (950.0, 10.0)], [1, 2, 3], 2.0, DASHES[1]);
        let svg = svg(&drawing).unwrap();
        assert_eq!(svg.matches("<path").count(), 1, "{svg}");
        let expected =
            "<path fill=\"none\" stroke=\"#010203\" stroke-width=\"4\" stroke-dasharray=\"16 8\" d=\"M100 20h1800\"/>";
        assert!(svg.contains(expected), "{svg}");
    }

    #[test]
    fn neighbours_in_one_style_are_one_element_and_keep_their_order() {
        let mut drawing = Drawing::new("t", 100.0, 100.0);
        drawing.path(vec![(1.0, 2.0), (3.0, 1.0), (3.0, 5.0), (4.0, 7.0)], [0; 3], 1.0);
        drawing.path(vec![(9.0, 9.0), (8.0, 9.0)], [0; 3], 1.0);
        drawing.path(vec![(9.0, 9.0), (8.0, 9.0)], [0, 0, 1], 1.0);
        drawing.rectangle([1.0, 2.0, 3.0, 4.0], [9; 3]);
        drawing.rectangle([5.0, 6.0, 7.0, 8.0], [9; 3]);
        drawing.path(vec![(9.0, 9.0), (8.0, 9.0)], [0; 3], 1.0);
        let svg = svg(&drawing).unwrap();
        let data: Vec<&str> = svg.split(" d=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
        let expected = ["M2 4l4-2v8l2 4M18 18h-2", "M18 18h-2", "M2 4h4v4h-4zM10 12h4v4h-4z", "M18 18h-2"];
        assert_eq!(data, expected);
    }
}
