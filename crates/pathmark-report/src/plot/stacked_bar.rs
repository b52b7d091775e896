//! Stacked bars: named rows of parts that add up to a whole, such as the uses of the workers' time.
//!
//! Parts have the same order in every row and in the legend, so a reader need not rely on their colours alone.

use super::Figure;
use super::axis::{Axis, Range};
use super::drawing::{Align, Drawing, Note, PartKind};
use super::font;
use super::frame::{self, GAP, TICK, WIDTH};
use super::legend::{self, LegendEntry, Sample};
use super::style::{Colour, INK, LEADING, MARGIN, MUTED, PAPER, SMALL_SIZE, TEXT_SIZE};
use super::title::Title;

/// Largest width of a row's name; longer ones are broken.
const WIDEST: f64 = 260.0;
/// Distance of two bars.
const ROW: f64 = 25.0;
/// Height of a bar.
const BAR: f64 = 17.0;
/// Width of the line between two parts.
const EDGE: f64 = 1.0;

/// A part that every row may have.
#[derive(Debug, Clone, PartialEq)]
pub struct StackPart {
    /// Its name in the legend.
    pub name: String,
    pub colour: Colour,
}

/// The length of a part in a row, and the value that a reader who points at it sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// In the axis' unit; lengths that are not positive are not drawn.
    pub length: f64,
    pub value: f64,
    /// Its low and high end.
    pub interval: Option<(f64, f64)>,
    /// The number of values that it was computed from, if counted.
    pub count: Option<usize>,
}

/// A bar.
#[derive(Debug, Clone, PartialEq)]
pub struct StackRow {
    /// Its name, at its left.
    pub name: String,
    /// Its pieces in the order of the parts; `None` if a part is unknown.
    pub pieces: Vec<Option<Piece>>,
}

impl StackRow {
    /// The pieces that have a length, each with its part's index and its two ends.
    fn placed(&self) -> impl Iterator<Item = (usize, &Piece, [f64; 2])> {
        let drawn = self.pieces.iter().enumerate().filter_map(|(part, piece)| Some((part, piece.as_ref()?)));
        drawn.filter(|(_, piece)| piece.length > 0.0 && piece.length.is_finite()).scan(0.0, |end, (part, piece)| {
            let start = *end;
            *end += piece.length;
            Some((part, piece, [start, *end]))
        })
    }
}

/// The chart.
#[derive(Debug, Clone, PartialEq)]
pub struct StackedBars {
    pub title: Title,
    /// Workload, machine; may be empty.
    pub subtitle: String,
    /// Remarks below the chart; may be empty.
    pub caption: String,
    /// The horizontal axis, from 0.
    pub axis: Axis,
    pub parts: Vec<StackPart>,
    /// The bars, the first at the top.
    pub rows: Vec<StackRow>,
}

impl StackedBars {
    /// The legend: the parts that some row has.
    fn entries(&self) -> Vec<LegendEntry> {
        let has = |part: usize| self.rows.iter().any(|row| row.placed().any(|(own, ..)| own == part));
        let drawn = self.parts.iter().enumerate().filter(|(part, _)| has(*part));
        let sample = |colour| Sample::Line { colour, dash: &[], width: 0.6 * BAR };
        drawn.map(|(_, part)| LegendEntry::new(sample(part.colour), &part.name, &part.name)).collect()
    }

    /// The range from 0 to the longest bar; `None` if no bar has a length.
    fn range(&self) -> Option<Range> {
        let ends = self.rows.iter().flat_map(StackRow::placed).map(|(.., [_, end])| end);
        Range::of(&self.axis.clone().including([0.0]), ends)
    }

    fn draw_row(&self, drawing: &mut Drawing, row: &StackRow, range: &Range, (left, right): (f64, f64), middle: f64) {
        let x = |value: f64| left + range.place(value).unwrap_or(0.0) * (right - left);
        for (part, piece, [start, end]) in row.placed() {
            let Some(part) = self.parts.get(part) else { continue };
            let [top, bottom] = [middle - 0.5 * BAR, middle + 0.5 * BAR];
            drawing.part(PartKind::Series, &part.name, |drawing| {
                drawing.rectangle([x(start), top, x(end), bottom], part.colour);
                drawing.path(vec![(x(end), top), (x(end), bottom)], PAPER, EDGE);
            });
            let text = format!(
                "{}, {}: {}{}",
                row.name,
                part.name,
                super::number::short(piece.value, 3),
                super::number::between(piece.interval, 3)
            );
            let (series, of) = (part.name.clone(), row.name.clone());
            let (at, value) = ((x(0.5 * (start + end)), middle), piece.value);
            drawing.note(Note { at, series, of, value, interval: piece.interval, count: piece.count, text });
        }
    }
}

impl Figure for StackedBars {
    fn drawing(&self) -> Drawing {
        let mut drawing = Drawing::new(self.title.head(), WIDTH, 0.0);
        let top = frame::words_above(&mut drawing, &self.title, &self.subtitle) + 12.0;
        let names: Vec<Vec<String>> = self.rows.iter().map(|row| font::wrap(&row.name, SMALL_SIZE, WIDEST)).collect();
        let widest = names.iter().flatten().map(|line| font::width(line, SMALL_SIZE)).fold(0.0, f64::max);
        let entries = self.entries();
        let legend = legend::size(&entries);
        let left = MARGIN + widest + GAP;
        let right = WIDTH - MARGIN - if legend.0 > 0.0 { legend.0 + 20.0 } else { 0.0 };
        let heights: Vec<f64> =
            names.iter().map(|name| ROW.max(name.len() as f64 * SMALL_SIZE * LEADING + 6.0)).collect();
        let bottom = top + heights.iter().sum::<f64>().max(legend.1).max(2.0 * ROW);
        let area = [left, top, right, bottom];
        if let Some(range) = self.range() {
            frame::ruler(&mut drawing, &range.ticks(self.axis.ticks.as_deref(), 9), area);
            let mut y = top;
            for ((row, name), height) in self.rows.iter().zip(&names).zip(&heights) {
                let middle = y + 0.5 * height;
                for (i, line) in name.iter().enumerate() {
                    let offset = (i as f64 - 0.5 * (name.len() as f64 - 1.0)) * SMALL_SIZE * LEADING;
                    drawing.text((left - GAP, middle + offset), line, SMALL_SIZE, INK, Align::Right);
                }
                self.draw_row(&mut drawing, row, &range, (left, right), middle);
                y += height;
            }
        } else {
            let at = (0.5 * (left + right), 0.5 * (top + bottom));
            drawing.text(at, "no data", TEXT_SIZE, MUTED, Align::Centre);
        }
        drawing.outline(area, INK);
        legend::draw(&mut drawing, &entries, (right + 20.0, top));
        let y = bottom + TICK + GAP + SMALL_SIZE + 14.0;
        drawing.text((0.5 * (left + right), y), &self.axis.label, TEXT_SIZE, INK, Align::Centre);
        let end = frame::words_below(&mut drawing, &self.caption, y + TEXT_SIZE + 14.0);
        drawing.height = (end + 8.0).ceil();
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::super::drawing::Mark;
    use super::super::style::SERIES;
    use super::super::tests::{assert_legible, says};
    use super::*;

    fn bars(lengths: &[&[f64]]) -> StackedBars {
        let piece = |length: &f64| Some(Piece { length: *length, value: *length, interval: None, count: Some(3) });
        let row = |(index, own): (usize, &&[f64])| StackRow {
            name: format!("a schedule of many words, number {index}, on eight threads"),
            pieces: own.iter().map(piece).collect(),
        };
        StackedBars {
            title: "Static blocks lose a quarter".into(),
            subtitle: "cornell; ".repeat(30),
            caption: "A caption of some length. ".repeat(8),
            axis: Axis::linear("share, %").including([100.0]),
            parts: (0..4).map(|i| StackPart { name: format!("part {i} of the time"), colour: SERIES[i] }).collect(),
            rows: lengths.iter().enumerate().map(row).collect(),
        }
    }

    /// Left and right of the rectangles, by colour.
    fn drawn(chart: &StackedBars) -> Vec<(usize, f64, f64)> {
        let rectangle = |mark: &Mark| match mark {
            Mark::Rectangle { sides: [left, _, right, _], colour } => {
                Some((SERIES.iter().position(|own| own == colour)?, *left, *right))
            }
            _ => None,
        };
        chart.drawing().marks.iter().filter_map(rectangle).collect()
    }

    #[test]
    fn parts_lie_end_to_end_in_proportion() {
        let found = drawn(&bars(&[&[50.0, 30.0, 0.0, 20.0], &[100.0, 0.0, 0.0, 0.0]]));
        let order: Vec<usize> = found.iter().map(|(part, ..)| *part).collect();
        assert_eq!(order, [0, 1, 3, 0]);
        let whole = found[3].2 - found[3].1;
        for ((_, left, right), (start, end)) in found.iter().zip([(0.0, 0.5), (0.5, 0.8), (0.8, 1.0)]) {
            let place = |at: f64| (at - found[3].1) / whole;
            assert!((place(*left) - start).abs() < 1e-9 && (place(*right) - end).abs() < 1e-9, "{found:?}");
        }
    }

    #[test]
    fn every_value_is_told_and_every_text_is_legible() {
        let chart = bars(&[&[50.0, 30.0, 0.0, 20.0], &[90.0, f64::NAN, -3.0, 1.0]]);
        let drawing = chart.drawing();
        assert_legible(&drawing);
        assert_eq!(drawing.notes.len(), 5);
        // No bar has the third part, so the legend leaves it out.
        assert!(says(&drawing, "part 1 of") && !says(&drawing, "part 2 of"));
        assert_eq!(chart.svg().unwrap(), chart.svg().unwrap());
        for empty in [bars(&[]), bars(&[&[0.0, f64::INFINITY]])] {
            assert!(says(&empty.drawing(), "no data"));
            assert_legible(&empty.drawing());
        }
    }
}
