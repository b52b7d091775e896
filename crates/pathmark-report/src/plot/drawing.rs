//! Drawings: marks in pixels, x to the right and y down, painted in order.

use super::style::{Colour, Dash, HAIRLINE};
use std::ops::Range;

/// A position in a drawing, in pixels.
pub type Place = (f64, f64);

/// The part of a text that is at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    Left,
    Centre,
    Right,
}

/// One line of text. The middle of its capital letters is vertically at its position.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    pub at: Place,
    pub text: String,
    /// Size in pixels per em.
    pub size: f64,
    pub colour: Colour,
    pub align: Align,
    /// Whether it reads upwards, as the title of a vertical axis does.
    pub upwards: bool,
}

/// One element to paint.
#[derive(Debug, Clone, PartialEq)]
pub enum Mark {
    /// A line through points, at least two.
    Path { places: Vec<Place>, colour: Colour, width: f64, dash: Dash },
    /// A filled polygon; its opacity goes from 0, invisible, to 1.
    Area { places: Vec<Place>, colour: Colour, opacity: f64 },
    /// A filled rectangle, by its left, top, right and bottom. Neighbours that share a side neither overlap nor leave a
    /// gap.
    Rectangle { sides: [f64; 4], colour: Colour },
    /// A filled circle.
    Disc { at: Place, radius: f64, colour: Colour },
    /// A line of text.
    Text(Text),
}

/// The kind of a part of a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartKind {
    /// Data of a series.
    Series,
    /// The legend's entry of a series.
    Legend,
}

/// Marks of one series, or of its entry in the legend.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    pub series: String,
    pub kind: PartKind,
    /// The indices of its marks in the drawing.
    pub marks: Range<usize>,
}

/// A drawn value, which a page shows when a reader points at it.
#[derive(Debug, Clone, PartialEq)]
pub struct Note {
    pub at: Place,
    /// The name of its series; empty if there is only one.
    pub series: String,
    /// The value's x, or the name of its row.
    pub of: String,
    pub value: f64,
    /// Its low and high end.
    pub interval: Option<(f64, f64)>,
    /// The number of values that it was computed from, if counted.
    pub count: Option<usize>,
    /// The whole note in words.
    pub text: String,
}

/// A picture of a given size.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    pub width: f64,
    pub height: f64,
    /// Its subject, for readers who cannot see it.
    pub title: String,
    /// The marks in painting order, lowest first.
    pub marks: Vec<Mark>,
    /// Groups of marks, in order; no mark is in two parts.
    pub parts: Vec<Part>,
    pub notes: Vec<Note>,
}

impl Drawing {
    pub fn new(title: &str, width: f64, height: f64) -> Self {
        let (marks, parts, notes) = (Vec::new(), Vec::new(), Vec::new());
        Self { width, height, title: title.to_string(), marks, parts, notes }
    }

    /// Draws marks as a part; parts are not nested.
    pub fn part<T>(&mut self, kind: PartKind, series: &str, draw: impl FnOnce(&mut Self) -> T) -> T {
        let from = self.marks.len();
        let drawn = draw(self);
        self.parts.push(Part { series: series.to_string(), kind, marks: from..self.marks.len() });
        drawn
    }

    /// Adds a line; nothing for fewer than two points.
    pub fn path(&mut self, places: Vec<Place>, colour: Colour, width: f64) {
        self.dashed(places, colour, width, &[]);
    }

    /// Adds a line in dashes; nothing for fewer than two points.
    pub fn dashed(&mut self, places: Vec<Place>, colour: Colour, width: f64, dash: Dash) {
        if places.len() > 1 {
            self.marks.push(Mark::Path { places, colour, width, dash });
        }
    }

    pub fn area(&mut self, places: Vec<Place>, colour: Colour, opacity: f64) {
        self.marks.push(Mark::Area { places, colour, opacity });
    }

    /// Adds a filled rectangle, given by its left, top, right and bottom.
    pub fn rectangle(&mut self, sides: [f64; 4], colour: Colour) {
        self.marks.push(Mark::Rectangle { sides, colour });
    }

    /// Adds the outline of a rectangle, as a hairline.
    pub fn outline(&mut self, [left, top, right, bottom]: [f64; 4], colour: Colour) {
        let corners = [(left, bottom), (right, bottom), (right, top), (left, top), (left, bottom)];
        for pair in corners.windows(2) {
            self.path(pair.to_vec(), colour, HAIRLINE);
        }
    }

    pub fn disc(&mut self, at: Place, radius: f64, colour: Colour) {
        self.marks.push(Mark::Disc { at, radius, colour });
    }

    pub fn text(&mut self, at: Place, text: &str, size: f64, colour: Colour, align: Align) {
        self.marks.push(Mark::Text(Text { at, text: text.to_string(), size, colour, align, upwards: false }));
    }

    /// Adds a line of text that reads upwards, centred at its position.
    pub fn text_upwards(&mut self, at: Place, text: &str, size: f64, colour: Colour) {
        let align = Align::Centre;
        self.marks.push(Mark::Text(Text { at, text: text.to_string(), size, colour, align, upwards: true }));
    }

    /// Adds a drawn value. Leaves out an interval with an end that is not finite.
    pub fn note(&mut self, note: Note) {
        let is_finite = |ends: &(f64, f64)| ends.0.is_finite() && ends.1.is_finite();
        self.notes.push(Note { interval: note.interval.filter(is_finite), ..note });
    }

    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        self.marks.iter().filter_map(|mark| if let Mark::Text(text) = mark { Some(text) } else { None })
    }
}

/// Cuts a line into the strokes of a dash pattern.
pub(super) fn strokes(places: &[Place], dash: Dash) -> Vec<Vec<Place>> {
    let Some((&first, rest)) = places.split_first() else { return Vec::new() };
    if dash.is_empty() {
        return vec![places.to_vec()];
    }
    let mut done = Vec::new();
    let (mut from, mut stroke) = (first, vec![first]);
    let (mut phase, mut left) = (0, dash[0]);
    for &to in rest {
        let length = libm::hypot(to.0 - from.0, to.1 - from.1);
        let mut covered = 0.0;
        while length - covered > left {
            covered += left;
            let share = covered / length;
            let cut = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
            if phase % 2 == 0 {
                stroke.push(cut);
                done.push(std::mem::take(&mut stroke));
            } else {
                stroke = vec![cut];
            }
            phase += 1;
            left = dash[phase % dash.len()];
        }
        left -= length - covered;
        if phase % 2 == 0 {
            stroke.push(to);
        }
        from = to;
    }
    if phase % 2 == 0 {
        done.push(stroke);
    }
    done
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_follow_the_pattern_round_corners() {
        let places = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)];
        let cut = strokes(&places, &[8.0, 4.0]);
        assert_eq!(cut, [vec![(0.0, 0.0), (8.0, 0.0)], vec![(10.0, 2.0), (10.0, 10.0)]]);
        let corner = strokes(&places, &[12.0, 4.0]);
        assert_eq!(corner[0], [(0.0, 0.0), (10.0, 0.0), (10.0, 2.0)]);
        assert_eq!(strokes(&places, &[]), [places.to_vec()]);
        assert!(strokes(&[], &[8.0, 4.0]).is_empty());
    }

    #[test]
    fn bounds_of_text_follow_its_alignment() {
        let mut drawing = Drawing::new("t", 100.0, 100.0);
        drawing.text((50.0, 50.0), "888", 10.0, [0; 3], Align::Right);
        drawing.text_upwards((50.0, 50.0), "888", 10.0, [0; 3]);
        let bounds: Vec<_> = drawing.texts().map(Text::bounds).collect();
        assert!((bounds[0][2] - 50.0).abs() < 1e-9 && bounds[0][0] < 35.0);
        assert!((bounds[1][1] + bounds[1][3] - 100.0).abs() < 1e-9 && bounds[1][3] - bounds[1][1] > 15.0);
    }
}
