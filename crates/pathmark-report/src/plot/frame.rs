//! The frame of a chart: positions of title, axes, legend and data, and the grid.

use super::axis::{Axis, Range, Tick};
use super::drawing::{Align, Drawing, Place};
use super::ruler::{GAP, TICK};
use super::style::{INK, LEADING, MARGIN, MUTED, SMALL_SIZE, TEXT_SIZE};
use super::{font, heading, ruler};

pub(super) const WIDTH: f64 = 960.0;
/// Height of the area in which data is drawn, if the legend does not need more.
const DATA_HEIGHT: f64 = 400.0;
/// The texts around a chart.
pub(super) struct Words<'a> {
    pub(super) title: &'a str,
    pub(super) subtitle: &'a str,
    pub(super) caption: &'a str,
}

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
        words: &Words<'_>,
        axes: (&Axis, &Axis),
        ranges: Option<(Range, Range)>,
        legend: (f64, f64),
    ) -> (Drawing, Self) {
        let y_ticks = ranges.map_or_else(Vec::new, |(_, y)| y.ticks(&axes.1.ticks, 8));
        let y_labels = y_ticks.iter().map(|tick| font::width(&tick.label, SMALL_SIZE)).fold(0.0, f64::max);
        let mut drawing = Drawing::new(words.title, WIDTH, 0.0);
        let top = heading::above(&mut drawing, words.title, words.subtitle) + 12.0;
        let frame = Self {
            left: MARGIN + TEXT_SIZE + 12.0 + y_labels + GAP + TICK,
            top,
            right: WIDTH - MARGIN - if legend.0 > 0.0 { legend.0 + 20.0 } else { 0.0 },
            bottom: top + DATA_HEIGHT.max(legend.1),
            ranges,
        };
        let below = frame.bottom + TICK + GAP + SMALL_SIZE + 14.0 + TEXT_SIZE;
        let end = heading::below(&mut drawing, words.caption, below + 14.0);
        // The last line is kept free for a remark about points that could not be drawn.
        drawing.height = (end + SMALL_SIZE * LEADING + 8.0).ceil();
        if let Some((x, _)) = ranges {
            let area = [frame.left, frame.top, frame.right, frame.bottom];
            ruler::below(&mut drawing, &x.ticks(&axes.0.ticks, 9), area);
            frame.vertical_axis(&mut drawing, &y_ticks);
        }
        drawing.outline([frame.left, frame.top, frame.right, frame.bottom], INK);
        let (centre, below) = (frame.centre(), frame.bottom + TICK + GAP + SMALL_SIZE + 14.0);
        drawing.text((centre.0, below), &axes.0.label, TEXT_SIZE, INK, Align::Centre);
        drawing.text_upwards((MARGIN + 0.5 * TEXT_SIZE, centre.1), &axes.1.label, TEXT_SIZE, INK);
        (drawing, frame)
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

    /// The upper left corner of the legend.
    pub(super) fn legend(&self) -> Place {
        (self.right + 20.0, self.top)
    }

    /// Converts shares of the axes to pixels.
    fn at(&self, x: f64, y: f64) -> Place {
        (self.left + x * (self.right - self.left), self.bottom - y * (self.bottom - self.top))
    }

    fn vertical_axis(&self, drawing: &mut Drawing, ticks: &[Tick]) {
        let mut free_below = f64::MAX;
        for tick in ticks {
            let (foot, y) = self.at(0.0, tick.place);
            ruler::grid_line(drawing, tick, (foot, y), (self.right, y), (foot - TICK, y));
            let half = 0.5 * SMALL_SIZE;
            if !tick.label.is_empty() && y + half <= free_below {
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
