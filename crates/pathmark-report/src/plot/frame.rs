//! The frame of a figure: its words, its axes with their grid, and the positions of legend and data.

use super::axis::{Axis, Range, Tick};
use super::drawing::{Align, Drawing, Place};
use super::font;
use super::style::{Colour, FAINT, GRID, HAIRLINE, INK, LEADING, MARGIN, MUTED, SMALL_SIZE, TEXT_SIZE, TITLE_SIZE};
use super::title::Title;

pub(super) const WIDTH: f64 = 960.0;
/// Height of the area in which data is drawn, if the legend does not need more.
const DATA_HEIGHT: f64 = 400.0;
/// Length of a tick.
pub(super) const TICK: f64 = 5.0;
/// Space between an axis and its labels.
pub(super) const GAP: f64 = 8.0;
/// Smallest distance between labels; nearer ones are left out.
const APART: f64 = 6.0;

/// The rectangle in which data is drawn and the ranges of its axes.
pub(super) struct Frame {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
    ranges: Option<(Range, Range)>,
}

impl Frame {
    /// Lays out a chart and draws all of it except data and legend.
    pub(super) fn begin(
        title: &Title,
        [subtitle, caption]: [&str; 2],
        axes: (&Axis, &Axis),
        ranges: Option<(Range, Range)>,
        legend: (f64, f64),
    ) -> (Drawing, Self) {
        let mut drawing = Drawing::new(title.head(), WIDTH, 0.0);
        let top = words_above(&mut drawing, title, subtitle) + 12.0;
        let right = WIDTH - MARGIN - if legend.0 > 0.0 { legend.0 + 20.0 } else { 0.0 };
        let frame = Self::within(&mut drawing, [MARGIN, top, right, top + DATA_HEIGHT.max(legend.1)], axes, ranges);
        let end = words_below(&mut drawing, caption, frame.end() + TEXT_SIZE + 14.0);
        // The last line is kept free for a remark about points that could not be drawn.
        drawing.height = (end + SMALL_SIZE * LEADING + 8.0).ceil();
        (drawing, frame)
    }

    /// Draws frame and axes. The area goes from the title of the vertical axis to the right end of the data; the labels of
    /// the horizontal axis are below it.
    pub(super) fn within(
        drawing: &mut Drawing,
        [edge, top, right, bottom]: [f64; 4],
        axes: (&Axis, &Axis),
        ranges: Option<(Range, Range)>,
    ) -> Self {
        let y_ticks = ranges.map_or_else(Vec::new, |(_, y)| y.ticks(axes.1.ticks.as_deref(), 8));
        let y_labels = y_ticks.iter().map(|tick| font::width(&tick.label, SMALL_SIZE)).fold(0.0, f64::max);
        let left = edge + TEXT_SIZE + 12.0 + y_labels + GAP + TICK;
        let frame = Self { left, top, right, bottom, ranges };
        if let Some((x, _)) = ranges {
            let most = if right - left < 0.5 * WIDTH { 5 } else { 9 };
            ruler(drawing, &x.ticks(axes.0.ticks.as_deref(), most), [left, top, right, bottom]);
            frame.vertical_axis(drawing, &y_ticks);
        }
        drawing.outline([left, top, right, bottom], INK);
        let centre = frame.centre();
        drawing.text((centre.0, frame.end()), &axes.0.label, TEXT_SIZE, INK, Align::Centre);
        drawing.text_upwards((edge + 0.5 * TEXT_SIZE, centre.1), &axes.1.label, TEXT_SIZE, INK);
        frame
    }

    /// The middle of the title below the horizontal axis.
    pub(super) fn end(&self) -> f64 {
        self.bottom + TICK + GAP + SMALL_SIZE + 14.0
    }

    /// The position of a point, if it has one.
    pub(super) fn spot(&self, x: f64, y: f64) -> Option<Place> {
        let (x_range, y_range) = self.ranges?;
        Some(self.at(x_range.place(x)?, y_range.place(y)?))
    }

    /// The height of an end of an interval of y. An end that is too low for a logarithmic axis is at the frame.
    pub(super) fn upright(&self, y: f64) -> Option<f64> {
        let place = self.ranges?.1.place(y).or((y <= 0.0).then_some(0.0))?;
        Some(self.at(0.0, place.clamp(0.0, 1.0)).1)
    }

    /// The horizontal position of an end of an interval of x.
    pub(super) fn across(&self, x: f64) -> Option<f64> {
        let place = self.ranges?.0.place(x).or((x <= 0.0).then_some(0.0))?;
        Some(self.at(place.clamp(0.0, 1.0), 0.0).0)
    }

    /// Converts lines from shares of the axes to pixels.
    pub(super) fn curve(&self, parts: impl FnOnce(&Range, &Range) -> Vec<Vec<Place>>) -> Vec<Vec<Place>> {
        let Some((x, y)) = self.ranges else { return Vec::new() };
        parts(&x, &y).iter().map(|part| part.iter().map(|place| self.at(place.0, place.1)).collect()).collect()
    }

    /// The middle of the data area.
    pub(super) fn centre(&self) -> Place {
        self.at(0.5, 0.5)
    }

    /// The right end of the data area, and its top and bottom.
    pub(super) fn right_side(&self) -> (f64, [f64; 2]) {
        (self.right, [self.top, self.bottom])
    }

    /// The upper left corner of the legend.
    pub(super) fn legend(&self) -> Place {
        (self.right + 20.0, self.top)
    }

    /// Converts shares of the axes to pixels.
    fn at(&self, x: f64, y: f64) -> Place {
        (self.left + x * (self.right - self.left), self.bottom - y * (self.bottom - self.top))
    }

    fn vertical_axis(&self, drawing: &mut Drawing, ticks: &[Tick]) {
        grid_lines(drawing, ticks, |tick| [self.at(0.0, tick.place), self.at(1.0, tick.place)]);
        let labelled = || ticks.iter().filter(|tick| !tick.label.is_empty());
        for (foot, y) in labelled().map(|tick| self.at(0.0, tick.place)) {
            drawing.path(vec![(foot, y), (foot - TICK, y)], INK, HAIRLINE);
        }
        let mut free_below = f64::MAX;
        for tick in labelled() {
            let (foot, y) = self.at(0.0, tick.place);
            let half = 0.5 * SMALL_SIZE;
            if y + half <= free_below {
                drawing.text((foot - TICK - GAP + 3.0, y), &tick.label, SMALL_SIZE, INK, Align::Right);
                free_below = y - half - 2.0;
            }
        }
    }
}

/// Writes a remark into the last line of the chart.
pub(super) fn remark(drawing: &mut Drawing, text: &str) {
    let y = drawing.height - 8.0 - 0.5 * SMALL_SIZE * LEADING;
    drawing.text((MARGIN, y), text, SMALL_SIZE, MUTED, Align::Left);
}

/// Writes title, description and subtitle at the top, broken to the drawing's width, and returns the y below them.
pub(super) fn words_above(drawing: &mut Drawing, title: &Title, subtitle: &str) -> f64 {
    let y = lines(drawing, title.head(), MARGIN, TITLE_SIZE, INK);
    lines(drawing, &title.below(subtitle), y, TEXT_SIZE, MUTED)
}

/// Writes a caption from `y` on and returns the y below it.
pub(super) fn words_below(drawing: &mut Drawing, caption: &str, y: f64) -> f64 {
    lines(drawing, caption, y, SMALL_SIZE, MUTED)
}

fn lines(drawing: &mut Drawing, text: &str, mut y: f64, size: f64, colour: Colour) -> f64 {
    for line in font::wrap(text, size, drawing.width - 2.0 * MARGIN) {
        drawing.text((MARGIN, y + 0.5 * size * LEADING), &line, size, colour, Align::Left);
        y += size * LEADING;
    }
    y
}

/// Draws the horizontal axis of an area, given by its left, top, right and bottom: grid lines through the area, ticks
/// and labels below it.
pub(super) fn ruler(drawing: &mut Drawing, ticks: &[Tick], area: [f64; 4]) {
    grid(drawing, ticks, area);
    let [left, _, right, foot] = area;
    let labelled = || ticks.iter().filter(|tick| !tick.label.is_empty());
    let x = |tick: &Tick| left + tick.place * (right - left);
    for tick in labelled() {
        drawing.path(vec![(x(tick), foot), (x(tick), foot + TICK)], INK, HAIRLINE);
    }
    let mut free_from = f64::MIN;
    for tick in labelled() {
        let half = 0.5 * font::width(&tick.label, SMALL_SIZE);
        if x(tick) - half >= free_from {
            let at = (x(tick), foot + TICK + GAP + 0.5 * SMALL_SIZE - 2.0);
            drawing.text(at, &tick.label, SMALL_SIZE, INK, Align::Centre);
            free_from = x(tick) + half + APART;
        }
    }
}

/// Draws only the grid lines, for an area whose axis is further below.
pub(super) fn grid(drawing: &mut Drawing, ticks: &[Tick], [left, top, right, foot]: [f64; 4]) {
    let x = |tick: &Tick| left + tick.place * (right - left);
    grid_lines(drawing, ticks, |tick| [(x(tick), foot), (x(tick), top)]);
}

/// Draws the lines through the data area: first the fainter ones of ticks without a label, then the others.
fn grid_lines(drawing: &mut Drawing, ticks: &[Tick], ends: impl Fn(&Tick) -> [Place; 2]) {
    for (colour, is_minor) in [(FAINT, true), (GRID, false)] {
        for tick in ticks.iter().filter(|tick| tick.label.is_empty() == is_minor) {
            drawing.path(ends(tick).to_vec(), colour, HAIRLINE);
        }
    }
}
