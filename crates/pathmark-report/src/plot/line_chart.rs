//! Line charts: lines and points over two axes, such as error against samples, or speedup against threads.

use super::Figure;
use super::axis::{Axis, Range, Scale};
use super::drawing::{Align, Drawing, Note, PartKind, Place};
use super::end_labels::{self, EndLabel};
use super::frame::{self, Frame};
use super::legend::{self, LegendEntry, Sample};
use super::marker;
use super::number::{between, short};
use super::overlay::{Overlay, inside};
use super::style::{Colour, DASHES, Dash, LINE, Look, MUTED, SMALL_SIZE, TEXT_SIZE};
use super::title::Title;
use std::collections::HashMap;

/// Distance of a word from its point, in pixels.
const BESIDE: f64 = 7.0;
/// Width of a fitted line: thinner than the data it belongs to.
const FIT_LINE: f64 = 1.5;
/// Width of a line that a later one covers: it shows at both sides.
const COVERED_LINE: f64 = 3.5 * LINE;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub x: f64,
    pub y: f64,
    /// Low and high end of x.
    pub x_interval: Option<(f64, f64)>,
    /// Low and high end of y.
    pub y_interval: Option<(f64, f64)>,
    /// The number of values that y was computed from, if counted.
    pub count: Option<usize>,
    /// Whether it is drawn hollow: not comparable with the others.
    pub hollow: bool,
}

impl Point {
    /// A point without intervals.
    pub fn new(x: f64, y: f64) -> Self {
        Self { x, y, x_interval: None, y_interval: None, count: None, hollow: false }
    }

    /// Adds the interval of y; `None` leaves the point without one.
    #[must_use]
    pub fn with_y(mut self, interval: Option<(f64, f64)>) -> Self {
        self.y_interval = interval;
        self
    }

    /// Adds the interval of x; `None` leaves the point without one.
    #[must_use]
    pub fn with_x(mut self, interval: Option<(f64, f64)>) -> Self {
        self.x_interval = interval;
        self
    }
}

/// How the intervals of a series are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spread {
    /// A bar at each point.
    Bars,
    /// A band behind the line, for intervals of y only.
    Band,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    pub name: String,
    /// Its points, in the order in which a line joins them.
    pub points: Vec<Point>,
    pub look: Look,
    pub spread: Spread,
    /// Whether a line joins its points.
    pub line: bool,
}

impl Series {
    /// A series with a line and error bars.
    pub fn new(name: impl Into<String>, look: Look, points: Vec<Point>) -> Self {
        Self { name: name.into(), points, look, spread: Spread::Bars, line: true }
    }

    /// A series for each name; its points are sorted from left to right.
    pub fn by_name(lines: impl IntoIterator<Item = (impl Into<String>, Vec<Point>)>) -> Vec<Self> {
        let series = |(index, (name, mut points)): (usize, (_, Vec<Point>))| {
            points.sort_by(|a, b| a.x.total_cmp(&b.x));
            Self::new(name, Look::nth(index), points)
        };
        lines.into_iter().enumerate().map(series).collect()
    }

    /// Shows the intervals as a band.
    #[must_use]
    pub fn banded(mut self) -> Self {
        self.spread = Spread::Band;
        self
    }

    /// Leaves the points unjoined.
    #[must_use]
    pub fn scattered(mut self) -> Self {
        self.line = false;
        self
    }
}

/// The chart. Leaves out points without a position on its axes (not finite, or not positive on a logarithmic axis), and
/// reports their number.
#[derive(Debug, Clone, PartialEq)]
pub struct LineChart {
    pub title: Title,
    /// Workload, machine, meaning of the bars; may be empty.
    pub subtitle: String,
    /// Remarks below the chart; may be empty.
    pub caption: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    /// Guides and fits.
    pub overlays: Vec<Overlay>,
    /// Pixels by which neighbouring series are moved apart sideways, so that points at one x stay visible; 0 for none.
    pub dodge: f64,
    /// Words beside points, such as their samples per pixel.
    pub words: Vec<(Point, String)>,
}

impl LineChart {
    /// The chart on linear axes if one is logarithmic, else on logarithmic ones; `None` without points, or if a value
    /// would have no position on those.
    fn toggled(&self) -> Option<Self> {
        let is_log = [&self.x, &self.y].iter().any(|axis| axis.scale == Scale::Log);
        let values = || self.series.iter().flat_map(|series| &series.points).flat_map(|point| [point.x, point.y]);
        if values().next().is_none() || (!is_log && values().any(|value| value <= 0.0)) {
            return None;
        }
        let toggled = |axis: &Axis| Axis {
            scale: if is_log { Scale::Linear } else { Scale::Log },
            // Labels that fit on a logarithmic axis may overlap on a linear one.
            ticks: axis.ticks.clone().filter(|_| !is_log),
            include: axis.include.iter().copied().filter(|value| is_log || *value > 0.0).collect(),
            label: axis.label.clone(),
        };
        Some(Self { x: toggled(&self.x), y: toggled(&self.y), ..self.clone() })
    }

    /// A chart of `series`, without guides.
    pub fn new(title: impl Into<Title>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        let (subtitle, caption) = (String::new(), String::new());
        let (overlays, words) = (Vec::new(), Vec::new());
        Self { title: title.into(), subtitle, caption, x, y, series, overlays, dodge: 0.0, words }
    }

    /// The ranges of both axes; `None` if no point can be drawn.
    pub(super) fn ranges(&self) -> Option<(Range, Range)> {
        let points = self.series.iter().flat_map(|series| &series.points).filter(|point| self.has_place(point));
        let points: Vec<&Point> = points.collect();
        let ends = |interval: Option<(f64, f64)>| interval.into_iter().flat_map(|(low, high)| [low, high]);
        let x = Range::of(&self.x, points.iter().flat_map(|p| ends(p.x_interval).chain([p.x])))?;
        let y = Range::of(&self.y, points.iter().flat_map(|p| ends(p.y_interval).chain([p.y])))?;
        Some((x, y))
    }

    /// Whether a point has a position on both axes; otherwise it counts for neither.
    fn has_place(&self, point: &Point) -> bool {
        Range::of(&self.x, [point.x]).is_some() && Range::of(&self.y, [point.y]).is_some()
    }

    /// For each series the index of the first one with the same points. The later one would hide it, so both are drawn
    /// as one.
    fn first_alike(&self) -> Vec<usize> {
        let mut known = HashMap::new();
        let first = |(index, series): (usize, &Series)| {
            if series.points.is_empty() { index } else { *known.entry(format!("{:?}", series.points)).or_insert(index) }
        };
        self.series.iter().enumerate().map(first).collect()
    }

    /// The series that are drawn as number `index`, which comes first.
    fn alike<'a>(&'a self, first_alike: &'a [usize], index: usize) -> impl Iterator<Item = &'a Series> {
        self.series.iter().zip(first_alike).filter(move |(_, first)| **first == index).map(|(series, _)| series)
    }

    fn entries(&self, first_alike: &[usize]) -> Vec<LegendEntry> {
        let own = self.series.iter().enumerate().filter(|(index, _)| first_alike[*index] == *index);
        let series = own.map(|(index, series)| {
            let sample = Sample::Series { look: series.look, line: series.line };
            let names: Vec<&str> = self.alike(first_alike, index).map(|series| series.name.as_str()).collect();
            let note = if series.points.is_empty() { " (no data)" } else { "" };
            LegendEntry::new(sample, &series.name, &format!("{}{note}", names.join(" = ")))
        });
        let overlays = self.overlays.iter().enumerate().map(|(index, overlay)| {
            let (colour, dash) = self.stroke(index, overlay);
            LegendEntry::new(Sample::Line { colour, dash, width: FIT_LINE }, &overlay.label, &overlay.label)
        });
        series.chain(overlays).collect()
    }

    /// Draws the data into a frame; returns the number of points without a position.
    pub(super) fn draw_data(&self, drawing: &mut Drawing, frame: &Frame) -> usize {
        if self.ranges().is_none() {
            drawing.text(frame.centre(), "no data", TEXT_SIZE, MUTED, Align::Centre);
            return self.series.iter().map(|series| series.points.len()).sum();
        }
        let first_alike = self.first_alike();
        let own = || self.series.iter().enumerate().filter(|(index, _)| first_alike[*index] == *index);
        for (_, series) in own().filter(|(_, series)| series.spread == Spread::Band) {
            drawing.part(PartKind::Series, &series.name, |drawing| Self::draw_band(drawing, frame, series));
        }
        for (index, overlay) in self.overlays.iter().enumerate() {
            let (colour, dash) = self.stroke(index, overlay);
            drawing.part(PartKind::Series, self.part_of(overlay, &first_alike), |drawing| {
                for stretch in frame.curve(|x, y| inside(&overlay.curve, x, y)) {
                    drawing.dashed(stretch, colour, FIT_LINE, dash);
                }
            });
        }
        let mut lost = 0;
        for (index, series) in own() {
            lost += drawing
                .part(PartKind::Series, &series.name, |drawing| self.draw_series(drawing, frame, &first_alike, index));
        }
        for (point, word) in &self.words {
            if let Some((x, y)) = frame.spot(point.x, point.y) {
                drawing.text((x + BESIDE, y - BESIDE), word, SMALL_SIZE, MUTED, Align::Left);
            }
        }
        lost
    }

    /// The names at the ends of lines, each with its line's part of the drawing. A fit is named with its series.
    fn end_names(&self, first_alike: &[usize]) -> Vec<EndName<'_>> {
        let own = self.series.iter().enumerate().filter(|(index, _)| first_alike[*index] == *index);
        let series = own.map(|(index, series)| {
            let names: Vec<&str> = self.alike(first_alike, index).map(|series| series.name.as_str()).collect();
            let fits = self.overlays.iter().filter(|overlay| overlay.fitted_to == Some(index));
            let fits: Vec<&str> = fits.map(|overlay| overlay.label.as_str()).collect();
            let fitted = if fits.is_empty() { String::new() } else { format!(" ({})", fits.join(", ")) };
            let text = names.join(" = ") + &fitted;
            EndName { part: &series.name, text, line: End::Series(index), colour: series.look.colour }
        });
        let guides = self.overlays.iter().enumerate().filter(|(_, overlay)| overlay.fitted_to.is_none());
        let guides = guides.map(|(index, overlay)| EndName {
            part: &overlay.label,
            text: overlay.label.clone(),
            line: End::Guide(index),
            colour: MUTED,
        });
        series.chain(guides).collect()
    }

    /// The end of a line, in pixels; `None` if it cannot be drawn.
    fn end(&self, frame: &Frame, end: End) -> Option<Place> {
        match end {
            End::Series(index) => {
                let mut spots = self.series[index].points.iter().rev().filter_map(|point| frame.spot(point.x, point.y));
                spots.next().map(|spot| (spot.0 + self.shift(index) + BESIDE, spot.1))
            }
            End::Guide(index) => {
                let stretches = frame.curve(|x, y| inside(&self.overlays[index].curve, x, y));
                stretches.last()?.last().copied()
            }
        }
    }

    /// Whether the names stand at the ends of the lines: all have an end, and the names fit beside the data.
    fn is_named_at_ends(&self, names: &[EndName<'_>]) -> bool {
        let has_end = |series: &Series| series.points.iter().any(|point| self.has_place(point));
        self.series.iter().all(has_end) && end_labels::fit(names.iter().map(|name| name.text.as_str()))
    }

    /// The part of the drawing that a guide or fit belongs to: a fit goes with its series if its name does.
    fn part_of<'a>(&'a self, overlay: &'a Overlay, first_alike: &[usize]) -> &'a str {
        let with_series = self.is_named_at_ends(&self.end_names(first_alike));
        let fitted = overlay.fitted_to.filter(|_| with_series).and_then(|index| self.series.get(index));
        fitted.map_or(&overlay.label, |series| &series.name)
    }

    /// Pixels by which a series is moved sideways.
    fn shift(&self, index: usize) -> f64 {
        self.dodge * (index as f64 - 0.5 * (self.series.len() as f64 - 1.0))
    }

    /// Colour and dashes of overlay number `index`; neighbouring guides differ in their dashes.
    fn stroke(&self, index: usize, overlay: &Overlay) -> (Colour, Dash) {
        match overlay.fitted_to {
            None => (MUTED, DASHES[1 + index % 2]),
            Some(series) => (self.series.get(series).map_or(MUTED, |series| series.look.colour), DASHES[3]),
        }
    }

    /// Whether a line that is drawn later runs over all points of a series.
    fn is_covered(&self, frame: &Frame, first_alike: &[usize], index: usize) -> bool {
        let spots = |index: usize| -> Vec<Place> {
            let shift = self.shift(index);
            let places = self.series[index].points.iter().filter_map(|point| frame.spot(point.x, point.y));
            places.map(|(x, y)| (x + shift, y)).collect()
        };
        let own = spots(index);
        let later =
            (index + 1..self.series.len()).filter(|later| first_alike[*later] == *later && self.series[*later].line);
        own.len() > 1
            && later.map(spots).any(|other| {
                let is_near = |own: &Place| other.windows(2).any(|ends| distance(*own, [ends[0], ends[1]]) < LINE);
                own.iter().all(is_near)
            })
    }

    /// Draws a series, and those with the same points, into the frame; returns the number of points without a position.
    fn draw_series(&self, drawing: &mut Drawing, frame: &Frame, first_alike: &[usize], index: usize) -> usize {
        let series = &self.series[index];
        let shift = self.shift(index);
        let moved = |place: Place| (place.0 + shift, place.1);
        let spots: Vec<Option<Place>> = series.points.iter().map(|p| frame.spot(p.x, p.y).map(moved)).collect();
        if series.line {
            let width = if self.is_covered(frame, first_alike, index) { COVERED_LINE } else { LINE };
            // A point without a position leaves a gap in the line.
            for run in spots.split(Option::is_none) {
                let places: Vec<Place> = run.iter().flatten().copied().collect();
                drawing.dashed(places, series.look.colour, width, series.look.dash);
            }
        }
        for (point, &spot) in series.points.iter().zip(&spots) {
            let Some((x, y)) = spot else { continue };
            if let Some((low, high)) = point.y_interval.filter(|_| series.spread == Spread::Bars)
                && let Some((low, high)) = frame.upright(low).zip(frame.upright(high))
            {
                marker::bar(drawing, (x, low), (x, high), series.look.colour);
            }
            if let Some((low, high)) = point.x_interval
                && let Some((low, high)) = frame.across(low).zip(frame.across(high))
            {
                marker::bar(drawing, (low + shift, y), (high + shift, y), series.look.colour);
            }
        }
        for (point, &spot) in series.points.iter().zip(&spots) {
            let Some(at) = spot else { continue };
            marker::draw(drawing, at, series.look.marker, series.look.colour);
            if point.hollow {
                marker::hollow(drawing, at, series.look.marker);
            }
            for alike in self.alike(first_alike, index) {
                drawing.note(self.note(alike, point, at));
            }
        }
        spots.iter().filter(|spot| spot.is_none()).count()
    }

    fn note(&self, series: &Series, point: &Point, at: Place) -> Note {
        let (of, value, interval) = (point.x.to_string(), point.y, point.y_interval);
        let text = format!(
            "{}: {} at {} = {}",
            series.name,
            short(value, 4) + &between(interval, 4),
            self.x.label,
            short(point.x, 4)
        );
        Note { at, series: series.name.clone(), of, value, interval, count: point.count, text }
    }

    /// Draws the band of a series. Bands are drawn first, so they are below all lines.
    fn draw_band(drawing: &mut Drawing, frame: &Frame, series: &Series) {
        let edge = |point: &Point| {
            let (low, high) = point.y_interval?;
            let x = frame.spot(point.x, point.y)?.0;
            Some(((x, frame.upright(low)?), (x, frame.upright(high)?)))
        };
        let edges: Vec<Option<(Place, Place)>> = series.points.iter().map(edge).collect();
        for run in edges.split(Option::is_none).filter(|run| run.len() > 1) {
            let low = run.iter().flatten().map(|edge| edge.0);
            let high = run.iter().rev().flatten().map(|edge| edge.1);
            drawing.area(low.chain(high).collect(), series.look.colour, 0.18);
        }
    }
}

/// A line that has a name at its end: a series, or a guide among the overlays.
#[derive(Debug, Clone, Copy)]
enum End {
    Series(usize),
    Guide(usize),
}

/// A name at the end of a line.
struct EndName<'a> {
    /// The part of the drawing that it names.
    part: &'a str,
    text: String,
    line: End,
    colour: Colour,
}

impl Figure for LineChart {
    fn other_axes(&self) -> Option<(&'static str, Drawing)> {
        let toggled = self.toggled()?;
        let name = if toggled.y.scale == Scale::Log { "logarithmic axes" } else { "linear axes" };
        Some((name, toggled.drawing()))
    }

    fn drawing(&self) -> Drawing {
        let first_alike = self.first_alike();
        let (entries, names) = (self.entries(&first_alike), self.end_names(&first_alike));
        let at_ends = self.is_named_at_ends(&names);
        let beside = if at_ends {
            (end_labels::width(names.iter().map(|name| name.text.as_str())), 0.0)
        } else {
            legend::size(&entries)
        };
        let words = [&self.subtitle, &self.caption].map(String::as_str);
        let (mut drawing, frame) = Frame::begin(&self.title, words, (&self.x, &self.y), self.ranges(), beside);
        let lost = self.draw_data(&mut drawing, &frame);
        if lost > 0 {
            let plural = if lost == 1 { "point has" } else { "points have" };
            frame::remark(&mut drawing, &format!("{lost} {plural} no place on these axes"));
        }
        if at_ends {
            let label = |name: &EndName<'_>| {
                let at = self.end(&frame, name.line)?;
                Some(EndLabel { part: name.part.to_string(), text: name.text.clone(), at, colour: name.colour })
            };
            end_labels::draw(&mut drawing, &frame, names.iter().filter_map(label).collect());
        } else {
            legend::draw(&mut drawing, &entries, frame.legend());
        }
        drawing
    }
}

/// The distance of a point from a stretch.
fn distance((x, y): Place, [from, to]: [Place; 2]) -> f64 {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let along = ((x - from.0) * dx + (y - from.1) * dy) / (dx * dx + dy * dy).max(f64::MIN_POSITIVE);
    let along = along.clamp(0.0, 1.0);
    let (across, up) = (x - from.0 - along * dx, y - from.1 - along * dy);
    (across * across + up * up).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stretch along x: beside it the distance is upright, beyond an end it is that of the end.
    #[test]
    fn distances_are_from_the_nearest_place_of_a_stretch() {
        let stretch = [(0.0, 0.0), (10.0, 0.0)];
        let found = [(5.0, 2.0), (5.0, 0.0), (13.0, 4.0), (-3.0, -4.0)].map(|place| distance(place, stretch));
        assert_eq!(found, [2.0, 0.0, 5.0, 5.0]);
        assert_eq!(distance((3.0, 4.0), [(0.0, 0.0); 2]), 5.0);
    }

    /// A line of three points under one of two: the lower one is wide. Crossing lines have the usual width.
    #[test]
    fn a_covered_line_shows_at_both_sides() {
        let series = |index: usize, points: &[(f64, f64)]| {
            Series::new(index.to_string(), Look::nth(index), points.iter().map(|(x, y)| Point::new(*x, *y)).collect())
        };
        let widths = |first: &[(f64, f64)], second: &[(f64, f64)]| {
            let series = vec![series(0, first), series(1, second)];
            let chart = LineChart::new("t", Axis::linear("x"), Axis::linear("y"), series);
            let (x, y) = chart.ranges().unwrap();
            let (_, frame) = Frame::begin(&chart.title, [""; 2], (&chart.x, &chart.y), Some((x, y)), (0.0, 0.0));
            [0, 1].map(|index| chart.is_covered(&frame, &chart.first_alike(), index))
        };
        let line = [(0.0, 0.0), (5.0, 0.5), (10.0, 1.0)];
        assert_eq!(widths(&line, &[(0.0, 0.0), (10.0, 1.0)]), [true, false]);
        assert_eq!(widths(&line, &[(0.0, 1.0), (10.0, 0.0)]), [false, false]);
        assert_eq!(widths(&line, &line), [false, false], "equal series are one line with both names");
    }
}
