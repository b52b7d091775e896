//! Named rows with a dot and an interval each (W. S. Cleveland, "The Elements of Graphing Data", 1985): overhead by strategy, time by output.
//!
//! A row may have a dot for each group, such as one for each number of threads; groups differ in colour and marker.

use super::Figure;
use super::axis::{Axis, Range};
use super::drawing::{Align, Drawing, Note, PartKind, Place};
use super::frame::{self, GAP, TICK, WIDTH};
use super::legend::{self, LegendEntry, Sample};
use super::number::{between, short};
use super::style::{DASHES, FAINT, HAIRLINE, INK, LEADING, Look, MARGIN, MUTED, SMALL_SIZE, TEXT_SIZE};
use super::title::Title;
use super::{font, marker};

/// Largest width of a row's name; longer ones are broken.
const WIDEST: f64 = 260.0;
/// Height of a row with one group.
const ROW: f64 = 25.0;
/// Distance of the groups' dots in a row.
const GROUP: f64 = 11.0;
/// Space between two areas.
const BETWEEN: f64 = 34.0;
/// More areas than this leave each too little width.
const MOST_AREAS: usize = 4;
/// Width of a guide's line.
const GUIDE: f64 = 1.5;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dot {
    /// The value, in the axis' unit.
    pub value: f64,
    /// Its low and high end.
    pub interval: Option<(f64, f64)>,
    /// The number of values that it was computed from, if counted.
    pub count: Option<usize>,
    /// Whether it is drawn hollow: not comparable with the others.
    pub hollow: bool,
}

impl Dot {
    /// A value that was computed from an unknown number of values.
    pub fn new(value: f64, interval: Option<(f64, f64)>) -> Self {
        Self { value, interval, count: None, hollow: false }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct DotRow {
    /// Its name, at its left.
    pub name: String,
    /// Its dots, in the order of the groups; `None` if nothing was measured.
    pub dots: Vec<Option<Dot>>,
}

impl DotRow {
    pub fn new(name: impl Into<String>, dots: Vec<Option<Dot>>) -> Self {
        Self { name: name.into(), dots }
    }
}

/// The plot. Leaves out dots without a position on its axis, and reports their number.
#[derive(Debug, Clone, PartialEq)]
pub struct DotPlot {
    pub title: Title,
    pub subtitle: String,
    pub caption: String,
    pub axis: Axis,
    /// The names of the groups. A single one has no entry in the legend.
    pub groups: Vec<String>,
    /// Whether each group has an area and a range of its own; the areas stand side by side.
    pub side_by_side: bool,
    /// The rows, the first at the top.
    pub rows: Vec<DotRow>,
    /// Vertical lines, such as one at a ratio of 1, each with its name in the legend.
    pub guides: Vec<(f64, String)>,
}

impl DotPlot {
    /// A plot of `rows` with one group.
    pub fn new(title: impl Into<Title>, axis: Axis, rows: Vec<DotRow>) -> Self {
        let (subtitle, caption) = (String::new(), String::new());
        let (groups, guides) = (vec![String::new()], Vec::new());
        Self { title: title.into(), subtitle, caption, axis, groups, side_by_side: false, rows, guides }
    }

    /// The same plot with a group for each name; each row has a dot for each group.
    #[must_use]
    pub fn grouped(mut self, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.groups = names.into_iter().map(Into::into).collect();
        self
    }

    /// The same plot with a group for each name, and with an area for each if they are few.
    #[must_use]
    pub fn in_areas(self, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        let grouped = self.grouped(names);
        Self { side_by_side: (2..=MOST_AREAS).contains(&grouped.groups.len()), ..grouped }
    }

    /// The groups of each area.
    fn areas(&self) -> Vec<Vec<usize>> {
        let groups = 0..self.groups.len();
        if self.side_by_side { groups.map(|group| vec![group]).collect() } else { vec![groups.collect()] }
    }

    /// The range of all dots of an area and their intervals; `None` if no dot can be drawn.
    fn range(&self, groups: &[usize]) -> Option<Range> {
        let dots = self.rows.iter().flat_map(|row| dots(row, groups)).map(|(_, dot)| dot);
        let drawable: Vec<&Dot> = dots.filter(|dot| Range::of(&self.axis, [dot.value]).is_some()).collect();
        let ends = drawable.iter().filter_map(|dot| dot.interval).flat_map(|(low, high)| [low, high]);
        let values: Vec<f64> = drawable.iter().map(|dot| dot.value).chain(ends).collect();
        // A guide for one number of threads would squeeze the areas of the others.
        let guides = self.guides.iter().filter(|_| !self.side_by_side);
        Range::of(&self.axis.clone().including(guides.map(|guide| guide.0)), values)
    }

    fn entries(&self) -> Vec<LegendEntry> {
        let groups = self.groups.iter().enumerate().filter(|_| self.groups.len() > 1 && !self.side_by_side);
        let sample = |group| Sample::Series { look: Look::nth(group), line: false };
        let dots = groups.map(|(group, name)| LegendEntry::new(sample(group), name, name));
        let guides = self.guides.iter().enumerate().map(|(index, (_, name))| {
            LegendEntry::new(Sample::Line { colour: MUTED, dash: DASHES[1 + index % 2], width: GUIDE }, name, name)
        });
        dots.chain(guides).collect()
    }

    /// Draws an area with the dots of some groups in rows around `middles`; returns the number of dots without a position.
    fn draw_area(&self, drawing: &mut Drawing, groups: &[usize], area: [f64; 4], middles: &[f64]) -> usize {
        let [left, top, right, bottom] = area;
        let centre = 0.5 * (left + right);
        if let ([group], true) = (groups, self.side_by_side) {
            let at = (centre, top - 0.6 * TEXT_SIZE * LEADING);
            drawing.text(at, &self.groups[*group], TEXT_SIZE, Look::nth(*group).colour, Align::Centre);
        }
        let lost = if let Some(range) = self.range(groups) {
            let most = if self.side_by_side { 4 } else { 9 };
            frame::ruler(drawing, &range.ticks(self.axis.ticks.as_deref(), most), area);
            for &middle in middles {
                drawing.path(vec![(left, middle), (right, middle)], FAINT, HAIRLINE);
            }
            for (index, (value, _)) in self.guides.iter().enumerate() {
                if let Some(place) = range.place(*value).filter(|place| (0.0..=1.0).contains(place)) {
                    let x = left + place * (right - left);
                    drawing.dashed(vec![(x, top), (x, bottom)], MUTED, GUIDE, DASHES[1 + index % 2]);
                }
            }
            let rows = self.rows.iter().zip(middles);
            rows.map(|(row, middle)| self.draw_row(drawing, (row, groups), &range, (left, right), *middle)).sum()
        } else {
            drawing.text((centre, 0.5 * (top + bottom)), "no data", TEXT_SIZE, MUTED, Align::Centre);
            self.rows.iter().map(|row| dots(row, groups).count()).sum()
        };
        drawing.outline(area, INK);
        lost
    }

    /// Draws the dots of a row around `middle`; returns the number of dots without a position.
    fn draw_row(
        &self,
        drawing: &mut Drawing,
        (row, groups): (&DotRow, &[usize]),
        range: &Range,
        (left, right): (f64, f64),
        middle: f64,
    ) -> usize {
        let x = |place: f64| left + place * (right - left);
        let mut lost = 0;
        let last = dots(row, groups).count().saturating_sub(1) as f64;
        // Dots are centred on the row's line, whichever groups have one, so that dots of two rows do not mix.
        for (index, (group, dot)) in dots(row, groups).enumerate() {
            let look = Look::nth(group);
            let y = middle + GROUP * (index as f64 - 0.5 * last);
            let Some(place) = range.place(dot.value) else {
                lost += 1;
                continue;
            };
            // An end that is too low for a logarithmic axis is drawn at the edge.
            let end = |value: f64| Some(x(range.place(value).or((value <= 0.0).then_some(0.0))?.clamp(0.0, 1.0)));
            let name = &self.groups[group];
            drawing.part(PartKind::Series, name, |drawing| {
                if let Some((low, high)) = dot.interval.and_then(|(low, high)| end(low).zip(end(high))) {
                    marker::bar(drawing, (low, y), (high, y), look.colour);
                }
                marker::draw(drawing, (x(place), y), look.marker, look.colour);
                if dot.hollow {
                    marker::hollow(drawing, (x(place), y), look.marker);
                }
            });
            drawing.note(note(row, name, dot, (x(place), y)));
        }
        lost
    }
}

/// The dots of some groups in a row, each with the index of its group.
fn dots<'a>(row: &'a DotRow, groups: &'a [usize]) -> impl Iterator<Item = (usize, &'a Dot)> {
    groups.iter().filter_map(|group| Some((*group, row.dots.get(*group)?.as_ref()?)))
}

fn note(row: &DotRow, group: &str, dot: &Dot, at: Place) -> Note {
    let of_group = if group.is_empty() { String::new() } else { format!(", {group}") };
    let text = format!("{}{of_group}: {}{}", row.name, short(dot.value, 4), between(dot.interval, 4));
    let (series, of) = (group.to_string(), row.name.clone());
    Note { at, series, of, value: dot.value, interval: dot.interval, count: dot.count, text }
}

impl Figure for DotPlot {
    fn drawing(&self) -> Drawing {
        let mut drawing = Drawing::new(self.title.head(), WIDTH, 0.0);
        let mut top = frame::words_above(&mut drawing, &self.title, &self.subtitle) + 12.0;
        let areas = self.areas();
        if self.side_by_side {
            top += TEXT_SIZE * LEADING;
        }
        let names: Vec<Vec<String>> = self.rows.iter().map(|row| font::wrap(&row.name, SMALL_SIZE, WIDEST)).collect();
        let widest = names.iter().flatten().map(|line| font::width(line, SMALL_SIZE)).fold(0.0, f64::max);
        let entries = self.entries();
        let legend = legend::size(&entries);
        let left = MARGIN + widest + GAP;
        let right = WIDTH - MARGIN - if legend.0 > 0.0 { legend.0 + 20.0 } else { 0.0 };
        let height = |(row, name): (&DotRow, &Vec<String>)| {
            let most = areas.iter().map(|groups| dots(row, groups).count()).max().unwrap_or(0);
            (ROW + GROUP * most.saturating_sub(1) as f64).max(name.len() as f64 * SMALL_SIZE * LEADING + 6.0)
        };
        let heights: Vec<f64> = self.rows.iter().zip(&names).map(height).collect();
        let bottom = top + heights.iter().sum::<f64>().max(legend.1).max(2.0 * ROW);
        let below = |y: &mut f64, height: &f64| {
            *y += height;
            Some(*y - 0.5 * height)
        };
        let middles: Vec<f64> = heights.iter().scan(top, below).collect();
        let width = (right - left - BETWEEN * areas.len().saturating_sub(1) as f64) / areas.len().max(1) as f64;
        let mut lost = 0;
        for (index, groups) in areas.iter().enumerate() {
            let start = left + index as f64 * (width + BETWEEN);
            lost += self.draw_area(&mut drawing, groups, [start, top, start + width, bottom], &middles);
        }
        if areas.iter().any(|groups| self.range(groups).is_some()) {
            for (name, middle) in names.iter().zip(&middles) {
                for (i, line) in name.iter().enumerate() {
                    let offset = (i as f64 - 0.5 * (name.len() as f64 - 1.0)) * SMALL_SIZE * LEADING;
                    drawing.text((left - GAP, middle + offset), line, SMALL_SIZE, INK, Align::Right);
                }
            }
        }
        legend::draw(&mut drawing, &entries, (right + 20.0, top));
        let mut y = bottom + TICK + GAP + SMALL_SIZE + 14.0;
        drawing.text((0.5 * (left + right), y), &self.axis.label, TEXT_SIZE, INK, Align::Centre);
        y = frame::words_below(&mut drawing, &self.caption, y + TEXT_SIZE + 14.0);
        if lost > 0 {
            let plural = if lost == 1 { "dot has" } else { "dots have" };
            y = frame::words_below(&mut drawing, &format!("{lost} {plural} no place on this axis"), y);
        }
        drawing.height = (y + 8.0).ceil();
        drawing
    }
}
