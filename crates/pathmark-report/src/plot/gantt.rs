//! Gantt charts of schedules: a lane for each worker, a box for each job, time to the right (H. L. Gantt, "Work, Wages
//! and Profits", 1913).
//!
//! Several schedules are drawn below each other on one time axis, so that their lengths can be compared. White inside a
//! schedule's frame is idle time; the frame ends at the makespan. Jobs thinner than a pixel are merged with their
//! neighbours, in the mean of their colours, so none vanishes. Of very many lanes a part is shown, and the title says
//! which.

use super::Figure;
use super::axis::{Axis, Range};
use super::drawing::{Align, Drawing};
use super::frame::{self, GAP, TICK, WIDTH};
use super::style::{INK, LEADING, LINE, MARGIN, MUTED, PAPER, SMALL_SIZE, TEXT_SIZE};
use super::title::Title;
use super::{colour_bar, font, number};
use crate::metric::heat_colour;
use serde::Serialize;

/// Largest height of a schedule.
const TALLEST: f64 = 260.0;
/// Largest height of a lane.
const LANE: f64 = 18.0;
/// The most lanes of one schedule; each then takes three pixels.
const MOST_LANES: usize = 86;
/// Space between schedules.
const SPACE: f64 = 14.0;
/// Smallest distance between the numbers of workers.
const NUMBERS: f64 = 15.0;
/// Width of the colour bar.
const BAR: f64 = 480.0;
/// The ends of the colours used, as shares of the scale: lighter colours look idle, and darker ones hide the start of a
/// job.
const COLOURS: (f64, f64) = (0.15, 0.85);
/// The number of different colours less one. Boxes of one colour are one element of an SVG.
const SHADES: f64 = 63.0;
/// Boxes of at least this width have an edge at the start of the job.
const EDGED: f64 = 4.0;
/// Width of that edge.
const EDGE: f64 = 0.5;

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JobBar {
    pub job: usize,
    /// Its worker, from 0.
    pub worker: usize,
    /// Seconds from the schedule's start to the job's start.
    pub start_s: f64,
    /// Seconds from the schedule's start to the job's end.
    pub stop_s: f64,
    /// The value that its colour shows, in the unit of the chart's label.
    pub value: f64,
    /// Its piece of the picture: first column, first row, and the ones after the last.
    pub area: [u32; 4],
}

#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// Strategy, threads, seconds and other text above it.
    pub title: String,
    /// Number of workers, with or without a job.
    pub workers: usize,
    /// Seconds from start to end.
    pub makespan_s: f64,
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    pub jobs: Vec<JobBar>,
}

/// The chart. Leaves out impossible jobs (without a worker, or with invalid times or values), and reports their number.
#[derive(Debug, Clone, PartialEq)]
pub struct GanttChart {
    pub title: Title,
    pub subtitle: String,
    pub caption: String,
    /// Meaning of the colours, with the unit.
    pub label: String,
    /// The schedules, the first at the top.
    pub schedules: Vec<Schedule>,
}

impl Schedule {
    fn holds(&self, job: &JobBar) -> bool {
        let timed = job.start_s >= 0.0 && job.stop_s >= job.start_s && job.stop_s.is_finite();
        job.worker < self.workers && timed && job.value.is_finite()
    }

    /// The workers whose lanes are shown, and the step between them.
    fn shown(&self) -> (Vec<usize>, usize) {
        let stride = self.workers.div_ceil(MOST_LANES).max(1);
        ((0..self.workers).step_by(stride).collect(), stride)
    }
}

/// The values of all jobs in ascending order. Their ranks become colours, which shows structure if a few jobs cost far
/// more than the rest.
struct Palette(Vec<f64>);

impl Palette {
    fn of(chart: &GanttChart) -> Self {
        let jobs = chart.schedules.iter().flat_map(|schedule| schedule.jobs.iter().filter(|job| schedule.holds(job)));
        let mut values: Vec<f64> = jobs.map(|job| job.value).collect();
        values.sort_by(f64::total_cmp);
        Self(values)
    }

    /// The position of a value on the colour bar, in [0, 1].
    fn share(&self, value: f64) -> f64 {
        let count = |below: &dyn Fn(f64) -> bool| self.0.partition_point(|&other| below(other)) as f64;
        if self.0.first() == self.0.last() {
            return 0.5;
        }
        // Equal values share the middle of their ranks.
        0.5 * (count(&|other| other < value) + count(&|other| other <= value)) / self.0.len() as f64
    }
}

impl GanttChart {
    /// The time axis, its unit in seconds, and the range of times; `None` if no makespan is positive and finite.
    fn time(&self) -> Option<(Axis, f64, Range)> {
        let ends =
            self.schedules.iter().map(|schedule| schedule.makespan_s).filter(|end| *end > 0.0 && end.is_finite());
        let longest = ends.reduce(f64::max)?;
        let units = [(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")];
        let (seconds, unit) = units.into_iter().find(|(seconds, _)| longest >= *seconds).unwrap_or((1e-6, "µs"));
        let axis = Axis::linear(format!("time from start, {unit}")).including([0.0]);
        let range = Range::of(&axis, [longest / seconds])?;
        Some((axis, seconds, range))
    }
}

/// Writes the numbers of the workers beside their lanes, as many as fit.
fn number_lanes(drawing: &mut Drawing, shown: &[usize], left: f64, top: f64, lane: f64) {
    let every = (NUMBERS / lane).ceil().max(1.0) as usize;
    for (i, worker) in shown.iter().enumerate().step_by(every) {
        let at = (left - GAP, top + (i as f64 + 0.5) * lane);
        drawing.text(at, &worker.to_string(), SMALL_SIZE, INK, Align::Right);
    }
}

/// With this many jobs in each schedule, a page is still read in a second.
const MOST_JOBS: usize = 2000;

/// A job in the page's data: its number, its worker, start and stop in microseconds, and its piece of the picture.
type JobData = (usize, usize, f64, f64, [u32; 4]);

/// A schedule in the page's data.
#[derive(Serialize)]
struct ScheduleData {
    title: String,
    workers: usize,
    end: f64,
    size: [u32; 2],
    jobs: Vec<JobData>,
}

impl ScheduleData {
    fn of(schedule: &Schedule) -> Self {
        // Rounding to a nanosecond loses nothing: no clock resolves less.
        let microseconds = |seconds: f64| (seconds * 1e9).round() / 1e3;
        let job = |job: &JobBar| (job.job, job.worker, microseconds(job.start_s), microseconds(job.stop_s), job.area);
        let jobs: Vec<JobData> = schedule.jobs.iter().filter(|job| schedule.holds(job)).map(job).collect();
        let (title, workers, end) = (schedule.title.clone(), schedule.workers, microseconds(schedule.makespan_s));
        if jobs.len() <= MOST_JOBS {
            return Self { title, workers, end, size: schedule.size, jobs };
        }
        let title =
            format!("{title}; its {} jobs are too many for a page, and pathmark inspect jobs draws them", jobs.len());
        Self { title, workers: 0, end: 0.0, size: [0; 2], jobs: Vec::new() }
    }
}

impl Figure for GanttChart {
    fn data(&self) -> Option<String> {
        let schedules: Vec<ScheduleData> = self.schedules.iter().map(ScheduleData::of).collect();
        serde_json::to_string(&schedules).ok()
    }

    fn drawing(&self) -> Drawing {
        let mut drawing = Drawing::new(self.title.head(), WIDTH, 0.0);
        let mut y = frame::words_above(&mut drawing, &self.title, &self.subtitle);
        let first = y;
        let palette = Palette::of(self);
        let last_worker = self.schedules.iter().map(|schedule| schedule.workers).max().unwrap_or(0).saturating_sub(1);
        let left = MARGIN + TEXT_SIZE + 10.0 + font::width(&last_worker.to_string(), SMALL_SIZE) + GAP;
        let right = WIDTH - MARGIN;
        let Some((axis, seconds, range)) = self.time() else {
            drawing.text((MARGIN, y + TEXT_SIZE), "no data", TEXT_SIZE, MUTED, Align::Left);
            y = frame::words_below(&mut drawing, &self.caption, y + 2.0 * TEXT_SIZE * LEADING);
            drawing.height = (y + MARGIN).ceil();
            return drawing;
        };
        let ticks = range.ticks(None, 9);
        let x = |time_s: f64| left + range.place(time_s / seconds).unwrap_or(0.0).clamp(0.0, 1.0) * (right - left);
        for (index, schedule) in self.schedules.iter().enumerate() {
            let (shown, stride) = schedule.shown();
            let note = format!("; every {} of {} workers is shown", ordinal(stride), schedule.workers);
            let title = format!("{}{}", schedule.title, if stride > 1 { &note } else { "" });
            y += SPACE;
            for line in font::wrap(&title, TEXT_SIZE, right - left) {
                drawing.text((left, y + 0.5 * TEXT_SIZE), &line, TEXT_SIZE, INK, Align::Left);
                y += TEXT_SIZE * LEADING;
            }
            let lane = LANE.min(TALLEST / shown.len().max(1) as f64);
            let bottom = y + lane * shown.len().max(1) as f64;
            let area = [left, y, right, bottom];
            if index + 1 == self.schedules.len() {
                frame::ruler(&mut drawing, &ticks, area);
            } else {
                frame::grid(&mut drawing, &ticks, area);
            }
            let end = x(schedule.makespan_s);
            drawing.rectangle([left, y, end, bottom], PAPER);
            let jobs = |worker| schedule.jobs.iter().filter(move |job| job.worker == worker && schedule.holds(job));
            let (mut boxes, mut edges) = (Vec::new(), Vec::new());
            for (i, &worker) in shown.iter().enumerate() {
                let bars = jobs(worker).map(|job| (x(job.start_s), x(job.stop_s), palette.share(job.value)));
                let (top, rim) = (y + i as f64 * lane, if lane >= 8.0 { 1.5 } else { 0.0 });
                for bar in merged(bars.collect()) {
                    let [top, bottom] = [top + rim, top + lane - rim];
                    boxes.push(((bar.2 * SHADES).round() as u32, [bar.0, top, bar.1, bottom]));
                    if bar.1 - bar.0 >= EDGED {
                        edges.push([bar.0, top, bar.0 + EDGE, bottom]);
                    }
                }
            }
            boxes.sort_by_key(|(shade, _)| *shade);
            for (shade, sides) in boxes {
                let share = f64::from(shade) / SHADES;
                drawing.rectangle(sides, heat_colour(COLOURS.0 + share * (COLOURS.1 - COLOURS.0)));
            }
            for sides in edges {
                drawing.rectangle(sides, INK);
            }
            number_lanes(&mut drawing, &shown, left, y, lane);
            drawing.outline([left, y, end, bottom], MUTED);
            drawing.path(vec![(end, y - 3.0), (end, bottom + 3.0)], INK, LINE);
            y = bottom;
        }
        drawing.text_upwards((MARGIN + 0.5 * TEXT_SIZE, 0.5 * (first + SPACE + y)), "worker", TEXT_SIZE, INK);
        y += TICK + GAP + SMALL_SIZE + 14.0;
        drawing.text((0.5 * (left + right), y), &axis.label, TEXT_SIZE, INK, Align::Centre);
        y += TEXT_SIZE + 10.0;
        if let Some(last) = palette.0.len().checked_sub(1) {
            let label = |share: f64| number::short(palette.0[(share * last as f64).round() as usize], 3);
            let name = format!("{} (a quarter of the jobs between labels)", self.label);
            y = colour_bar::draw(&mut drawing, (left, y), BAR, COLOURS, &name, label) + 10.0;
        }
        y = frame::words_below(&mut drawing, &self.caption, y);
        let held = |schedule: &Schedule| schedule.jobs.iter().filter(|job| !schedule.holds(job)).count();
        let lost: usize = self.schedules.iter().map(held).sum();
        if lost > 0 {
            y = frame::words_below(&mut drawing, &format!("left out, as they can't be: {lost} of the jobs"), y);
        }
        drawing.height = (y + 12.0).ceil();
        drawing
    }
}

/// 2nd, 3rd, 4th.
fn ordinal(n: usize) -> String {
    let ending = match (n % 10, n % 100) {
        (_, 11..=13) => "th",
        (1, _) => "st",
        (2, _) => "nd",
        (3, _) => "rd",
        _ => "th",
    };
    format!("{n}{ending}")
}

/// The thinnest box in pixels. Half a pixel could be painted, but would double the boxes of a page, which also contains
/// the times of all jobs.
const THINNEST: f64 = 1.0;

/// Left and right end in pixels, and the position on the colour bar.
type Piece = (f64, f64, f64);

/// Returns the boxes from left to right. Merges a box into its left neighbour if they start less than `THINNEST` apart;
/// the colour is the mean by width.
fn merged(mut pieces: Vec<Piece>) -> Vec<Piece> {
    // Jobs of no width get a small weight, or the mean of several would be 0 / 0.
    const LEAST: f64 = 1e-9;
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut done: Vec<(f64, f64, f64, f64)> = Vec::new();
    for (left, right, share) in pieces {
        let weight = (right - left).max(LEAST);
        match done.last_mut() {
            Some((from, to, sum, weights)) if left - *from < THINNEST => {
                *to = to.max(right).max(*from + THINNEST);
                *sum += weight * share;
                *weights += weight;
            }
            _ => done.push((left, right.max(left + THINNEST), weight * share, weight)),
        }
    }
    done.into_iter().map(|(left, right, sum, weights)| (left, right, sum / weights)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_boxes_stay_and_thin_ones_never_vanish() {
        let pieces = vec![(20.0, 30.0, 1.0), (0.0, 10.0, 0.0), (40.0, 40.0, 0.5)];
        assert_eq!(merged(pieces), [(0.0, 10.0, 0.0), (20.0, 30.0, 1.0), (40.0, 41.0, 0.5)]);
        assert!(merged(Vec::new()).is_empty());
    }

    #[test]
    fn crowds_become_one_with_the_mean_of_their_colours() {
        let crowd: Vec<Piece> =
            (0..10_000).map(|i| (f64::from(i) * 1e-3, f64::from(i + 1) * 1e-3, f64::from(i % 2))).collect();
        let boxes = merged(crowd);
        assert!((9..=11).contains(&boxes.len()), "{}", boxes.len());
        for (left, right, share) in boxes {
            assert!(right - left >= THINNEST - 1e-9 && right - left < 2.0 * THINNEST && (share - 0.5).abs() < 0.01);
        }
    }
}
