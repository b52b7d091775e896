//! The timeline of a run, with a lane for each worker: for the figure of many runs and for the verb that shows one.

use crate::analysis::balance::{Balance, processors_in_use};
use crate::measure::{TraceFile, TraceRow, available_threads, schedule_name};
use crate::plot::number::short;
use crate::plot::{GanttChart, JobBar, Schedule};
use crate::words::counted;

/// The balance of a traced run; `None` if its workers or times are impossible.
pub fn balance(trace: &TraceFile) -> Option<Balance> {
    trace.trace().balance(trace.header.makespan_s, trace.header.workers as usize)
}

/// Strategy, threads and pieces of a run, in words.
pub fn name(trace: &TraceFile) -> String {
    let settings = &trace.header.settings;
    let strategy = schedule_name(&settings.strategy, &settings.decomposition);
    format!("{strategy}, {}, {}", counted(settings.threads, "thread"), settings.decomposition)
}

/// Seconds or milliseconds with three digits.
fn duration(seconds: f64) -> String {
    if seconds >= 1.0 { format!("{} s", short(seconds, 3)) } else { format!("{} ms", short(seconds * 1e3, 3)) }
}

pub(super) fn lanes(trace: &TraceFile, balance: &Balance, processors: usize) -> Schedule {
    let bar = |row: &TraceRow| JobBar {
        job: row.job,
        worker: row.worker as usize,
        start_s: row.start_s,
        stop_s: row.stop_s,
        value: (row.stop_s - row.start_s) * 1e3,
        area: [row.x0, row.y0, row.x1, row.y1],
    };
    let spec = &trace.header.settings.spec;
    let makespan_s = trace.header.makespan_s;
    let workers = trace.header.workers as usize;
    let utilisation = if workers > processors {
        let spans = trace.rows.iter().map(|row| (row.worker as usize, row.start_s, row.stop_s));
        let used = 100.0 * processors_in_use(spans, makespan_s, processors);
        format!("utilisation of {processors} processors {used:.0} %")
    } else {
        format!("utilisation {:.0} %", 100.0 * balance.utilisation())
    };
    Schedule {
        title: format!("{}: {}, {utilisation}", name(trace), duration(makespan_s)),
        workers: trace.header.workers as usize,
        makespan_s,
        size: [spec.width, spec.height],
        jobs: trace.rows.iter().map(bar).collect(),
    }
}

/// The description of such a chart.
pub(super) const TITLE: &str = "Who did what when";

/// A chart of several runs below each other.
pub(super) fn charts(schedules: Vec<Schedule>, subtitle: String) -> GanttChart {
    GanttChart {
        title: TITLE.into(),
        subtitle,
        caption: "White is waiting; a frame ends at the makespan.".to_string(),
        label: "milliseconds of the job".to_string(),
        schedules,
    }
}

pub fn chart(trace: &TraceFile) -> GanttChart {
    let settings = &trace.header.settings;
    let spec = &settings.spec;
    let workload =
        format!("{}, {}x{}, {} spp, {}", settings.scene, spec.width, spec.height, settings.spp, spec.estimator);
    let lanes = balance(trace).map(|balance| lanes(trace, &balance, available_threads()));
    charts(lanes.into_iter().collect(), workload)
}
