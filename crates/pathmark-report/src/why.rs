//! Why a schedule is not as many times as fast as it has workers: the parts of workers × time, the largest loss, and
//! the command that tests a remedy.

use super::estimated::Estimated;
use super::remedy::{Remedies, Remedy};
use super::results::Results;
use super::rows::Row;
use super::rows::naming::joined;
use super::rows::paired::{Pairs, medians};
use super::rows::schedule::Schedule;
use crate::analysis::parallel_overhead::{Part, Run, decompose};
use crate::error::Result;
use crate::plot::number::fixed;
use serde::{Serialize, Serializer};
use std::collections::BTreeSet;

/// A smaller share of the time needs no remedy.
const SMALLEST_LOSS: f64 = 0.01;

/// The time of a schedule's workers, by its use.
#[derive(Serialize)]
pub struct Explained {
    /// Image (if there are several), strategy, workers and pieces, in words.
    pub name: String,
    pub strategy: String,
    pub decomposition: String,
    pub threads: usize,
    /// Workers; processors, if they are fewer.
    pub slots: usize,
    /// Whether several workers shared a processor.
    pub is_oversubscribed: bool,
    /// Whether the rows tell when each worker's first job began.
    pub knows_starts: bool,
    /// The shares of workers × time, over repetitions: first the serial work, then the largest loss and so on.
    #[serde(serialize_with = "as_objects")]
    pub(super) parts: Vec<(Part, Estimated)>,
    /// A remedy for the largest loss, unless all losses are small.
    pub remedy: Option<Remedy>,
    /// The largest loss and its remedy in words; a command stands between backticks.
    pub sentence: String,
}

/// The rows of a schedule, each with its serial run.
pub(super) struct Cell<'a> {
    series: String,
    pub(super) first: &'a Row,
    pairs: Pairs<'a>,
}

/// A schedule with the shares of its parts.
pub(super) type Measured<'a> = (&'a Cell<'a>, &'a [(Part, Estimated)]);

/// Explains every schedule of several workers that has a serial run of the same image in the same repetition: image by
/// image, the one with the least serial work first.
pub fn explain(results: &Results) -> Result<Vec<Explained>> {
    let cells = cells(results)?;
    let processors = results.run.machine.processors;
    let mut parts: Vec<Vec<(Part, Estimated)>> = vec![Vec::new(); cells.len()];
    for part in Part::ALL {
        let shares = cells.iter().enumerate().map(|(index, cell)| {
            let share = |row: &Row, serial: &Row| decompose(&run(row, processors)?, serial.busy_sum_s?)?.share(part);
            (index, cell.pairs.values(share))
        });
        for (index, told) in medians(shares, results.stopping()) {
            parts[index].push((part, told));
        }
    }
    for own in &mut parts {
        own.sort_by(|(a, first), (b, second)| {
            (*a != Part::Work).cmp(&(*b != Part::Work)).then(second.value.total_cmp(&first.value))
        });
    }
    let measured = cells.iter().zip(&parts).filter(|(_, parts)| !parts.is_empty());
    let mut measured: Vec<Measured<'_>> = measured.map(|(cell, parts)| (cell, &parts[..])).collect();
    measured
        .sort_by(|(one, a), (other, b)| one.image().cmp(&other.image()).then(a[0].1.value.total_cmp(&b[0].1.value)));
    let remedies = Remedies::of(results, &measured)?;
    let names = Names::of(results, &cells);
    let explained = |(cell, parts): &Measured<'_>| {
        let row = cell.first;
        let mut explained = Explained {
            name: names.name(cell),
            strategy: row.strategy.clone(),
            decomposition: row.decomposition.clone(),
            threads: row.threads,
            slots: row.threads.min(processors),
            is_oversubscribed: row.threads > processors,
            knows_starts: row.idle_before_first_job_s.is_some(),
            parts: parts.to_vec(),
            remedy: None,
            sentence: String::new(),
        };
        if let Some((part, _)) = explained.largest_loss() {
            explained.remedy = remedies.remedy(cell, part)?;
        }
        explained.sentence = explained.in_words();
        Ok(explained)
    };
    measured.iter().map(explained).collect()
}

/// The schedules of several workers, image by image, with the serial runs on the same pieces or, without those, the
/// fastest serial runs.
fn cells(results: &Results) -> Result<Vec<Cell<'_>>> {
    let serial = results.serial()?;
    let groups = results.by(|row| (results.series_name(row), row.spp, &row.schedule)).into_iter();
    let groups = groups.filter(|((.., schedule), _)| !schedule.is_serial() && schedule.key.threads > 1);
    let cell = |((series, ..), rows): ((String, u32, &Schedule), Vec<_>)| {
        let first = *rows.first()?;
        let on_pieces = serial.on_pieces.pairs(rows.iter().copied());
        let has_pairs = on_pieces.iter().next().is_some();
        Some(Cell { series, first, pairs: if has_pairs { on_pieces } else { serial.fastest.pairs(rows) } })
    };
    Ok(groups.filter_map(cell).collect())
}

/// The measured times of a row; `None` if one is missing.
fn run(row: &Row, processors: usize) -> Option<Run> {
    Some(Run {
        workers: row.threads.max(row.workers_used? as usize),
        processors,
        makespan_s: row.makespan_s?,
        merge_s: row.merge_s?,
        busy_s: row.busy_sum_s?,
        gap_s: row.idle_between_jobs_s?,
        starting_s: row.idle_before_first_job_s,
        cpu_s: row.cpu_s(),
    })
}

impl Cell<'_> {
    /// The image that it renders, apart from seeds.
    pub(super) fn image(&self) -> (&str, u32) {
        (&self.series, self.first.spp)
    }
}

/// The properties that names need: those in which the cells differ.
struct Names {
    with_spp: bool,
    with_pieces: bool,
}

impl Names {
    fn of(results: &Results, cells: &[Cell<'_>]) -> Self {
        let spp: BTreeSet<u32> = results.rows().map(|row| row.spp).collect();
        let pieces: BTreeSet<&str> = cells.iter().map(|cell| cell.first.decomposition.as_str()).collect();
        Self { with_spp: spp.len() > 1, with_pieces: pieces.len() > 1 }
    }

    fn name(&self, cell: &Cell<'_>) -> String {
        let spp = if self.with_spp { format!("{} spp", cell.first.spp) } else { String::new() };
        let pieces = if self.with_pieces { cell.first.decomposition.clone() } else { String::new() };
        joined([cell.series.clone(), spp, cell.first.schedule.label(), pieces])
    }
}

impl Explained {
    /// The share of a part; `None` if it is unknown.
    pub(super) fn share(&self, part: Part) -> Option<Estimated> {
        self.parts.iter().find(|(own, _)| *own == part).map(|(_, told)| *told)
    }

    /// The largest loss; `None` if all are small.
    pub(super) fn largest_loss(&self) -> Option<(Part, Estimated)> {
        self.parts.get(1).copied().filter(|(_, told)| told.value >= SMALLEST_LOSS)
    }

    /// The name of a part in this schedule.
    pub(super) fn name_of(&self, part: Part) -> &'static str {
        if part == Part::Between && !self.knows_starts { "before and between jobs" } else { words(part)[0] }
    }

    /// Each part with its name and its share in percent.
    pub fn percents(&self) -> impl Iterator<Item = (&'static str, String)> + '_ {
        self.parts.iter().map(|(part, told)| (self.name_of(*part), percent(told)))
    }

    fn in_words(&self) -> String {
        let whole = if self.is_oversubscribed { "processors × time" } else { "workers × time" };
        let work = self.share(Part::Work).as_ref().map_or_else(String::new, percent);
        let begin = format!("{}: serial work is {work} of {whole}.", self.name);
        let Some((part, told)) = self.largest_loss() else { return format!("{begin} No loss reaches 1 %.") };
        let remedy = self.remedy.as_ref().map_or_else(String::new, |remedy| format!(" {remedy}"));
        let is_doubtful = told.interval.is_none_or(|interval| interval.low <= 0.0);
        let doubt = if is_doubtful { " More repetitions must show whether it is a loss." } else { "" };
        let (name, share, reason) = (self.name_of(part), percent(&told), words(part)[1]);
        format!("{begin} The largest loss is {name} {share}: {reason}.{doubt}{remedy}")
    }
}

/// Each part as an object.
fn as_objects<S: Serializer>(parts: &[(Part, Estimated)], serializer: S) -> std::result::Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Share<'a> {
        part: Part,
        #[serde(flatten)]
        told: &'a Estimated,
    }
    serializer.collect_seq(parts.iter().map(|(part, told)| Share { part: *part, told }))
}

/// A share in percent, with its interval.
fn percent(told: &Estimated) -> String {
    let Estimated { value, interval, .. } = told.times(100.0);
    let interval = interval.map_or_else(
        || "no interval".to_string(),
        |own| format!("{} to {}, {:.1} % confidence", fixed(own.low, 1), fixed(own.high, 1), own.percent()),
    );
    format!("{} % ({interval})", fixed(value, 1))
}

/// The name of a part, and the event behind it.
fn words(part: Part) -> [&'static str; 2] {
    match part {
        Part::Work => ["serial work", "jobs took as long as in the serial run"],
        Part::Inflation => ["work inflation", "the same jobs took longer than in the serial run"],
        Part::Starting => ["starting", "workers waited for their first job"],
        Part::Between => ["between jobs", "workers waited for their next job"],
        Part::Tail => ["tail", "workers waited for the last job"],
        Part::Merge => ["merge", "one thread assembled the image while the others waited"],
        Part::Idle => ["idle processors", "more workers than processors ran, and processors were idle"],
    }
}

#[cfg(test)]
mod tests {
    use super::super::remedy::Outlook;
    use super::super::tests::{folder_of, results, row, svg, words};
    use super::*;
    use crate::experiment::trace_file;
    use crate::figures::blocks;
    use crate::lab::Lab;
    use crate::measure::{Record, Settings, TraceFile, TraceHeader, TraceRow};

    const EMPTY: TraceRow = TraceRow {
        job: 0,
        worker: 0,
        start_s: 0.0,
        stop_s: 0.0,
        paths: 0,
        rays: 0,
        x0: 0,
        y0: 0,
        x1: 0,
        y1: 0,
        first_sample: 0,
        samples: 0,
    };

    /// A serial run of 4 s, and a run of two workers with these seconds: makespan, busy, gaps, before first jobs, merge.
    fn rows(strategy: &str, [makespan_s, busy_s, gap_s, starting_s, merge_s]: [f64; 5]) -> Vec<Record> {
        let serial = Record {
            makespan_s: Some(4.0),
            busy_sum_s: Some(4.0),
            idle_between_jobs_s: Some(0.0),
            idle_before_first_job_s: Some(0.0),
            merge_s: Some(0.0),
            ..row()
        };
        let run = Record {
            strategy: strategy.to_string(),
            threads: 2,
            workers_used: Some(2),
            makespan_s: Some(makespan_s),
            busy_sum_s: Some(busy_s),
            idle_between_jobs_s: Some(gap_s),
            idle_before_first_job_s: Some(starting_s),
            merge_s: Some(merge_s),
            ..serial.clone()
        };
        (0..6).flat_map(|repetition| [&serial, &run].map(|row| Record { repetition, ..row.clone() })).collect()
    }

    fn explained(rows: Vec<Record>) -> Vec<Explained> {
        let mut results = results(&["losses"], "", rows).unwrap();
        results.run.machine.physical_cores = 1;
        explain(&results).unwrap()
    }

    fn value(found: &Explained, part: Part) -> f64 {
        found.share(part).unwrap().value
    }

    /// Makespan 2.5 s on two workers: 4 s of work, 1 s of tail.
    #[test]
    fn the_sentence_names_the_largest_loss_and_its_remedy() {
        let cases = [
            ("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0], Part::Tail, "tail", "strategy=shared-counter"),
            ("shared-counter", [2.5, 4.0, 0.0, 0.0, 0.0], Part::Tail, "tail", "decomposition=tiles:1x1"),
            ("shared-counter", [2.5, 4.0, 1.0, 0.0, 0.0], Part::Between, "between jobs", "strategy=guided"),
            ("static-blocks", [2.5, 4.0, 1.0, 0.0, 0.0], Part::Between, "between jobs", "decomposition=tiles:4x4"),
            ("shared-counter", [2.5, 4.0, 1.0, 1.0, 0.0], Part::Starting, "starting", "strategy=fixed-pool"),
            ("fixed-pool", [2.5, 4.0, 1.0, 1.0, 0.0], Part::Starting, "starting", "spp=16"),
            ("shared-counter", [2.0, 4.0, 0.0, 0.0, 0.5], Part::Merge, "merge", "output=locked"),
            ("shared-counter", [2.5, 5.0, 0.0, 0.0, 0.0], Part::Inflation, "work inflation", "threads=1"),
        ];
        for (strategy, times, part, name, remedy) in cases {
            let found = explained(rows(strategy, times));
            let [found] = &found[..] else { panic!("one schedule") };
            assert_eq!((value(found, Part::Work), value(found, part)), (0.8, 0.2), "{strategy} {name}");
            assert_eq!(found.largest_loss().unwrap().0, part, "{strategy} {name}");
            let said = format!("The largest loss is {name} 20.0 % (20.0 to 20.0, 96.8 % confidence)");
            assert!(found.sentence.contains(&said), "{}", found.sentence);
            let own = found.remedy.as_ref().unwrap();
            assert_eq!((&own.settings[..], own.outlook), (&[remedy.to_string()][..], None));
            assert!(found.sentence.contains(&own.command), "{}", found.sentence);
        }
    }

    /// Of seven losses, each is as large as it was made, and the shares of each repetition add up to 1.
    #[test]
    fn parts_add_up_and_come_in_order_of_their_size() {
        // 8 s of two workers: work 4, inflation 0.5, starting 0.25, between 0.75, tail 1.5, merge 1.
        let found = explained(rows("static-blocks", [3.5, 4.5, 1.0, 0.25, 0.5]));
        let order: Vec<Part> = found[0].parts.iter().map(|(part, _)| *part).collect();
        assert_eq!(order, [Part::Work, Part::Tail, Part::Merge, Part::Between, Part::Inflation, Part::Starting]);
        let shares: Vec<f64> = found[0].parts.iter().map(|(_, told)| 8.0 * told.value).collect();
        assert_eq!(shares, [4.0, 1.5, 1.0, 0.75, 0.5, 0.25]);
    }

    /// Drift slows a repetition as a whole, so the shares stay and the interval has no width.
    #[test]
    fn shares_are_of_one_repetition() {
        let mut rows = rows("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0]);
        for row in &mut rows {
            let factor = f64::from(1 << row.repetition);
            for time in [&mut row.makespan_s, &mut row.busy_sum_s] {
                *time = time.map(|time| factor * time);
            }
        }
        let found = explained(rows);
        for (part, share) in [(Part::Work, 0.8), (Part::Tail, 0.2)] {
            let told = found[0].share(part).unwrap();
            let interval = told.interval.unwrap();
            assert_eq!((told.value, interval.low, interval.high, told.count), (share, share, share, Some(6)));
        }
    }

    #[test]
    fn a_measured_remedy_is_told_as_measured() {
        let mut rows = rows("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0]);
        let other = super::tests::rows("shared-counter", [2.0, 4.0, 0.0, 0.0, 0.0]);
        rows.extend(other.into_iter().filter(|row| row.threads == 2));
        let found = explained(rows);
        assert_eq!(found[0].strategy, "static-blocks");
        assert_eq!(found[0].remedy.as_ref().unwrap().outlook, Some(Outlook::Measured { loss: 0.0, work: 1.0 }));
        assert!(
            found[0].sentence.contains("runs of this folder lose 0.0 % there; 100.0 % is serial work."),
            "{}",
            found[0].sentence
        );
        assert!(found[1].remedy.is_none() && found[1].sentence.ends_with("No loss reaches 1 %."));
    }

    /// Jobs took longer in four repetitions and less time in two.
    #[test]
    fn a_loss_that_may_be_none_is_told_as_doubtful() {
        let mut rows = rows("shared-counter", [2.5, 5.0, 0.0, 0.0, 0.0]);
        for row in rows.iter_mut().filter(|row| row.threads == 2 && row.repetition < 2) {
            row.busy_sum_s = Some(3.0);
        }
        let said = "work inflation 20.0 % (−20.0 to 20.0, 96.8 % confidence): the same jobs took longer than in the \
                    serial run. More repetitions must show whether it is a loss.";
        let found = explained(rows);
        assert!(found[0].sentence.contains(said), "{}", found[0].sentence);
    }

    /// Rows of schema 11 do not tell when first jobs began.
    #[test]
    fn older_rows_have_one_part_before_and_between_jobs() {
        let mut rows = rows("shared-counter", [2.5, 4.0, 1.0, 0.0, 0.0]);
        for row in &mut rows {
            row.idle_before_first_job_s = None;
        }
        let found = explained(rows);
        assert!(found[0].share(Part::Starting).is_none());
        assert!(
            found[0].sentence.contains("The largest loss is before and between jobs 20.0 %"),
            "{}",
            found[0].sentence
        );
    }

    #[test]
    fn more_workers_than_processors_are_told_by_processors() {
        let mut rows = rows("shared-counter", [2.5, 20.0, 0.0, 0.0, 0.0]);
        for row in rows.iter_mut().filter(|row| row.threads == 2) {
            (row.threads, row.workers_used, row.cpu_user_s) = (8, Some(8), Some(4.5));
        }
        let found = explained(rows);
        let shares = [Part::Work, Part::Inflation, Part::Idle].map(|part| value(&found[0], part));
        assert_eq!((found[0].slots, shares), (2, [0.8, 0.1, 0.1]));
        assert!(found[0].sentence.contains("80.0 % (80.0 to 80.0, 96.8 % confidence) of processors × time"));
        assert_eq!(found[0].remedy.as_ref().unwrap().settings, ["threads=2"]);
    }

    /// One repetition has no interval, one worker no speedup, and a run without its serial run no work.
    #[test]
    fn little_is_told_as_little() {
        let rows = rows("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0]);
        let once: Vec<Record> = rows.iter().take(2).cloned().collect();
        assert!(explained(once)[0].sentence.contains("tail 20.0 % (no interval)"));
        assert!(explained(rows.iter().skip(1).step_by(2).cloned().collect()).is_empty());
        let alone = rows.iter().map(|row| Record { threads: 1, ..row.clone() });
        assert!(explained(alone.collect()).is_empty());
    }

    #[test]
    fn the_figure_has_a_result_as_its_title() {
        let results = results(&["losses"], "", rows("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0])).unwrap();
        let text = words(&blocks(&results).unwrap());
        assert!(text.contains("Why not 2 times? static-blocks, 2 threads, loses 20 % (tail)"), "{text}");
        assert!(text.contains("static-blocks, 2 threads, tail: 20 (20 to 20)"), "{text}");
    }

    /// Eight workers on two processors lose more, and the title of the speedups is not about them either.
    #[test]
    fn the_title_is_about_a_thread_for_each_processor() {
        let mut rows = rows("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0]);
        let crowd = self::rows("crowd", [5.0, 20.0, 0.0, 0.0, 0.0]);
        let crowd = crowd.into_iter().filter(|row| row.threads == 2);
        let crowd = crowd.map(|row| Record { threads: 8, workers_used: Some(8), cpu_user_s: Some(4.5), ..row });
        let crowd: Vec<Record> = crowd.collect();
        let title = |rows: Vec<Record>| svg(&blocks(&results(&["losses"], "", rows).unwrap()).unwrap(), "losses");
        let serial: Vec<Record> = rows.iter().filter(|row| row.threads == 1).cloned().collect();
        let alone = title([serial, crowd.clone()].concat());
        assert!(alone.contains("Why not 2 times? crowd, 8 threads, loses 55 % (idle processors)"), "{alone}");
        rows.extend(crowd);
        let both = title(rows);
        assert!(both.contains("Why not 2 times? static-blocks, 2 threads, loses 20 % (tail)"), "{both}");
    }

    /// `static-blocks` loses twice as much, but over half of the repetitions.
    #[test]
    fn the_title_ranks_no_loss_over_fewer_repetitions() {
        let mut rows = rows("static-blocks", [2.5, 4.0, 0.0, 0.0, 0.0]);
        rows.retain(|row| row.threads == 1 || row.repetition < 3);
        let other = super::tests::rows("shared-counter", [2.5, 4.5, 0.0, 0.0, 0.0]);
        rows.extend(other.into_iter().filter(|row| row.threads == 2));
        let text = words(&blocks(&results(&["losses"], "", rows).unwrap()).unwrap());
        assert!(text.contains("Why not 2 times? shared-counter, 2 threads, loses 10 %"), "{text}");
        assert!(text.contains("static-blocks, 2 threads, fewer repetitions"), "{text}");
    }

    #[test]
    fn rows_without_a_loss_are_a_notice() {
        let none = results(&["losses"], "", vec![row()]).unwrap();
        assert!(words(&blocks(&none).unwrap()).starts_with("No schedule of several workers"));
    }

    /// Jobs of 1.5, 0.5, 0.5 and 1.5 s: taken one by one, the last ends at 2.5 s, one second after the other worker.
    #[test]
    fn a_forecast_is_a_simulation_of_the_serial_jobs() {
        let rows = rows("static-blocks", [3.0, 4.0, 0.0, 0.0, 0.0]);
        let out = folder_of(&["losses"], "", rows);
        let folder = out.path().join("an-experiment");
        std::fs::create_dir(folder.join("traces")).unwrap();
        let mut start_s = 0.0;
        let job = |(job, seconds): (usize, f64)| {
            let x0 = job as u32;
            let own = TraceRow { job, start_s, stop_s: start_s + seconds, x0, x1: x0 + 1, y1: 1, samples: 4, ..EMPTY };
            start_s = own.stop_s;
            own
        };
        let rows = [1.5, 0.5, 0.5, 1.5].into_iter().enumerate().map(job).collect();
        let header =
            TraceHeader { settings: Settings::default(), makespan_s: 4.0, workers: 1, warnings: String::new() };
        let trace = TraceFile { header, rows };
        for repetition in 0..6 {
            let name = trace_file(&format!("cell {}", 2 * repetition), repetition);
            trace.write(&folder.join("traces").join(name)).unwrap();
        }
        let found = explain(&Results::open(&Lab::built_in(), &folder).unwrap()).unwrap();
        assert_eq!(found[0].remedy.as_ref().unwrap().outlook, Some(Outlook::Forecast { loss: 0.2 }));
        let said = "A simulation forecasts 20.0 % with `strategy=shared-counter`.";
        assert!(found[0].sentence.contains(said), "{}", found[0].sentence);
    }
}
