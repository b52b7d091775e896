//! Legends: a column beside a chart that names its lines. It never covers data.

use super::drawing::{Align, Drawing, PartKind, Place};
use super::font;
use super::marker;
use super::style::{Colour, Dash, INK, LEADING, LINE, Look, SMALL_SIZE};

/// Width of the line sample before each text.
const SAMPLE: f64 = 30.0;
/// Space between sample and text.
const GAP: f64 = 8.0;
/// Largest width of a text; longer ones are broken.
const WIDEST: f64 = 190.0;
/// The column is wider than its measured text by this factor, because viewers' fonts differ.
const SLACK: f64 = 1.06;
/// Free space between entries.
const SPACING: f64 = 5.0;

/// The sample before a text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sample {
    /// A series: its marker, and its line if it has one.
    Series { look: Look, line: bool },
    /// A line without points.
    Line { colour: Colour, dash: Dash, width: f64 },
}

#[derive(Debug, Clone, PartialEq)]
pub struct LegendEntry {
    sample: Sample,
    name: String,
    lines: Vec<String>,
}

impl LegendEntry {
    /// An entry for the part of the figure called `name`; its text is broken to fit the column.
    pub fn new(sample: Sample, name: &str, text: &str) -> Self {
        Self { sample, name: name.to_string(), lines: font::wrap(text, SMALL_SIZE, WIDEST) }
    }
}

/// Width and height of the column; zero for no entries.
pub fn size(entries: &[LegendEntry]) -> (f64, f64) {
    let widest = entries.iter().flat_map(|entry| &entry.lines).map(|line| font::width(line, SMALL_SIZE));
    let Some(text) = widest.reduce(f64::max) else { return (0.0, 0.0) };
    (SAMPLE + GAP + SLACK * text, entries.iter().map(entry_height).sum())
}

fn entry_height(entry: &LegendEntry) -> f64 {
    entry.lines.len() as f64 * SMALL_SIZE * LEADING + SPACING
}

/// Draws the column with its upper left corner at a position.
pub fn draw(drawing: &mut Drawing, entries: &[LegendEntry], (x, mut y): Place) {
    for entry in entries {
        let middle = y + 0.5 * SMALL_SIZE * LEADING;
        let ends = [(x, middle), (x + SAMPLE, middle)];
        drawing.part(PartKind::Legend, &entry.name, |drawing| {
            match entry.sample {
                Sample::Line { colour, dash, width } => drawing.dashed(ends.to_vec(), colour, width, dash),
                Sample::Series { look, line } => {
                    if line {
                        drawing.dashed(ends.to_vec(), look.colour, LINE, look.dash);
                    }
                    marker::draw(drawing, (x + 0.5 * SAMPLE, middle), look.marker, look.colour);
                }
            }
            for (i, line) in entry.lines.iter().enumerate() {
                let at = (x + SAMPLE + GAP, middle + i as f64 * SMALL_SIZE * LEADING);
                drawing.text(at, line, SMALL_SIZE, INK, Align::Left);
            }
        });
        y += entry_height(entry);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn column_holds_its_entries() {
        let sample = Sample::Series { look: Look::nth(0), line: true };
        let entries =
            [LegendEntry::new(sample, "a", "rayon"), LegendEntry::new(sample, "b", &"many words ".repeat(12))];
        let (width, height) = size(&entries);
        let mut drawing = Drawing::new("t", 500.0, 500.0);
        draw(&mut drawing, &entries, (100.0, 50.0));
        for text in drawing.texts() {
            let [left, top, right, bottom] = text.bounds();
            assert!(left >= 100.0 && right <= 100.0 + width && top >= 50.0 && bottom <= 50.0 + height);
        }
        assert_eq!(size(&[]), (0.0, 0.0));
    }
}
