//! Errors that are made on purpose, each beside the right way: the time that they cost, and the error of the image's mean.

use crate::analysis::error_ratio::error_ratio;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The mean radiance of the image without any error.
    known: Option<f64>,
    /// The errors, each with the right way.
    pair: Vec<Mistake>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Mistake {
    name: String,
    wrong: Kind,
    right: Kind,
}

/// The settings in which wrong and right rows differ.
#[derive(Deserialize, Clone, PartialEq, Eq, PartialOrd, Ord)]
#[serde(deny_unknown_fields)]
struct Kind {
    sampler: String,
    output: String,
}

impl Kind {
    fn of(row: &Row) -> Self {
        Self { sampler: row.sampler.clone(), output: row.output.clone() }
    }

    fn words(&self) -> String {
        format!("{}, {}", self.sampler, self.output)
    }
}

/// An error with one number of threads, beside the right way.
struct Line<'a> {
    mistake: &'a Mistake,
    threads: usize,
    right: Vec<&'a Row>,
    /// Time over the time of the right way.
    time: Option<Ratio>,
    /// Error of the mean over that of the right way; none if both have the same image.
    error: Option<Estimate>,
}

/// The errors of the image's mean, for images of one sample each. Of the runs of a process only the first counts: the others
/// may repeat its numbers.
fn errors(rows: &[&Row], known: f64) -> Vec<f64> {
    let first = rows.iter().flat_map(|row| row.runs()).filter(|row| row.pair.is_none_or(|pair| pair == 0));
    values(first, |row| Some((row.mean_radiance? - known) * (row.samples? as f64).sqrt()))
}

fn lines<'a>(results: &'a Results, options: &'a Options) -> Result<Vec<Line<'a>>> {
    let by_threads = gathered(
        results
            .by(|row| (row.threads, Kind::of(row)))
            .into_iter()
            .map(|((threads, kind), rows)| (threads, (kind, rows))),
    );
    let mut lines = Vec::new();
    for mistake in &options.pair {
        for (&threads, kinds) in &by_threads {
            let rows = |kind: &Kind| {
                let own = kinds.iter().find(|(own, _)| own == kind);
                own.map_or_else(Vec::new, |(_, rows)| rows.clone())
            };
            let (wrong, right) = (rows(&mistake.wrong), rows(&mistake.right));
            let forget: Forget = |image, schedule| {
                image.sampler.clear();
                schedule.output.clear();
            };
            let time = time_ratio(wrong.iter().copied(), right.iter().copied(), forget, results.stopping())?;
            // A checksum says that the image is the right one.
            let is_same = wrong.iter().all(|row| !row.checksum.is_empty());
            let error = options.known.filter(|_| !is_same);
            let error = error.and_then(|known| error_ratio(&errors(&wrong, known), &errors(&right, known), LEVEL));
            if time.is_some() || error.is_some() {
                lines.push(Line { mistake, threads, right, time, error });
            }
        }
    }
    Ok(lines)
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let options: Options = options(&results.definition, "mistakes")?;
    let lines = lines(results, &options)?;
    let time = |line: &Line<'_>| line.time.map(|time| time.estimate());
    // More threads than processors take turns, so their times tell little of an error.
    let times = lines.iter().filter(|line| line.threads <= results.run.machine.processors && line.time.is_some());
    let times: Vec<&Line<'_>> = times.collect();
    let errors: Vec<&Line<'_>> = lines.iter().filter(|line| line.error.is_some()).collect();
    let mut blocks = Vec::new();
    if !times.is_empty() {
        let title = Title::new("Time of errors on purpose").with_result(Some(result(&times, time, "time")));
        let axis = Axis::log("time / time of the right way");
        let mut plot = plot(title, axis, &times, |line| Some(Estimated::from(line.time?)));
        plot.subtitle = results.workload();
        plot.caption = ratio_bars(times.iter().filter_map(|line| line.time));
        blocks.push(Block::figure("mistakes-time", plot));
    }
    if !errors.is_empty() {
        let result = result(&errors, |line| line.error, "error of the mean");
        let title = Title::new("Error of the mean by errors on purpose").with_result(Some(result));
        let axis = Axis::log("error of the image's mean / error of the right way");
        let mut plot = plot(title, axis, &errors, |line| line.error.map(Estimated::from));
        plot.subtitle = results.workload();
        plot.caption =
            format!("Root mean square over seeds. Bars: {:.0} % by Fisher's F, for normal errors.", 1e2 * LEVEL);
        blocks.push(Block::figure("mistakes-error", plot));
    }
    blocks.push(
        Block::table("mistakes-table", "Errors on purpose, beside the right way", &lines)
            .column("error", |line| line.mistake.name.clone())
            .column("wrong", |line| line.mistake.wrong.words())
            .column("right", |line| line.mistake.right.words())
            .column("threads", |line| line.threads.to_string())
            .number("median ms of the right way", Decimals(2), |line| {
                typical(&line.right, |row| Some(row.makespan_s? * 1e3))
            })
            .estimated("time / time of the right way", Decimals(3), |line| line.time.map(Estimated::from))
            .estimated("error of the mean / that of the right way", Decimals(2), |line| line.error.map(Estimated::from))
            .end(),
    );
    Ok(blocks)
}

/// The result in a line: the error that certainly costs most, if one does so beyond the noise.
fn result(lines: &[&Line<'_>], ratio: impl Fn(&Line<'_>) -> Option<Estimate>, of: &str) -> String {
    let beyond =
        lines.iter().filter_map(|line| Some((line, ratio(line)?))).filter(|(_, ratio)| ratio.interval.low > 1.0);
    let worst = beyond.max_by(|a, b| a.1.interval.low.total_cmp(&b.1.interval.low));
    worst.map_or_else(
        || format!("No error on purpose raises the {of} beyond the noise"),
        |(line, ratio)| {
            let threads = counted(line.threads, "thread");
            format!("The {of} grows most by {}: {:.2} times with {threads}", line.mistake.name, ratio.value)
        },
    )
}

fn plot(title: Title, axis: Axis, lines: &[&Line<'_>], told: impl Fn(&Line<'_>) -> Option<Estimated>) -> DotPlot {
    let threads: BTreeSet<usize> = lines.iter().map(|line| line.threads).collect();
    let rows = lines.chunk_by(|a, b| a.mistake.name == b.mistake.name).map(|own| {
        let dot = |threads: &usize| Some(told(own.iter().find(|line| line.threads == *threads)?)?.dot());
        DotRow::new(&own[0].mistake.name, threads.iter().map(dot).collect())
    });
    let rows = rows.collect();
    let mut plot = DotPlot::new(title, axis, rows).grouped(threads.iter().map(|threads| counted(*threads, "thread")));
    plot.guides = vec![(1.0, "the right way".to_string())];
    plot
}
