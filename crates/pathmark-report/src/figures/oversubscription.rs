//! More threads than processors: from more sections of the image with a thread each, and from more threads alone.

use crate::input::array;
use crate::prelude::*;
use crate::serial::{with_pieces, without_pieces};
use crate::words::with_interval;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default, rename_all = "kebab-case")]
pub(super) struct Options {
    /// The claim to test.
    claim: Option<Claim>,
}

/// A claim that some numbers of sections, with a thread each, are good ones.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
struct Claim {
    /// The strategy that starts a thread for each section.
    per_section: String,
    /// The strategy with a thread for each processor.
    few: String,
    /// The smallest and the largest number of sections that the claim calls good.
    #[serde(deserialize_with = "array")]
    sections: [usize; 2],
    /// The decomposition that they are compared with.
    against: String,
}

/// Prefix of decompositions into a number of sections of a grid.
const GRID: &str = "grid:";

type Lines = BTreeMap<String, Vec<Point>>;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { claim } = options(&results.definition, "oversubscription")?;
    let (mut by_grid, mut by_threads) = (Vec::new(), Vec::new());
    let groups = results.by(|row| (&row.schedule, results.series_name(row), row.spp)).into_iter();
    let cells = groups.map(|(key, rows)| {
        let seconds = Repeats::of_rows(rows.iter().copied(), |row| row.makespan_s);
        ((key, rows[0].jobs), seconds)
    });
    let times = medians(cells, results.stopping());
    let caption = bars(times.iter().map(|(_, time)| *time));
    for (((schedule, series, _), jobs), time) in times {
        let threads = schedule.key.threads;
        if schedule.key.decomposition.starts_with(GRID) {
            let crew = if threads == jobs { "a thread for each section" } else { "a thread for each processor" };
            let alone = claim.as_ref().is_some_and(|claim| claim.per_section == schedule.key.strategy);
            let name = if alone { crew.to_string() } else { format!("{}, {crew}", schedule.name.replace('-', " ")) };
            by_grid.push((joined([series, name]), time.above(jobs as f64)));
        } else if !schedule.is_serial() {
            by_threads.push((joined([series, schedule.name.clone()]), time.above(threads as f64)));
        }
    }
    let (result, finding) = claim.map_or(Ok(None), |claim| compared(results, &claim))?.unzip();
    let chart = |title: Title, axis: Axis, lines: Lines| {
        let ticks: Vec<f64> = lines.values().flatten().map(|point| point.x).collect();
        let y = Axis::linear("seconds").including([0.0]);
        let mut chart = LineChart::new(title, axis.ticks_at(ticks), y, Series::by_name(lines));
        chart.subtitle = results.workload();
        chart.caption.clone_from(&caption);
        chart.dodge = 4.0;
        chart
    };
    let (sections, threads) = (Axis::linear("sections"), Axis::log("threads"));
    let figure = |stem: &'static str, title: Title, axis: Axis, lines: Lines| {
        (!lines.is_empty()).then(|| Block::figure(stem, chart(title, axis, lines)))
    };
    let title = Title::new("Time against sections of the image").with_result(result);
    let grid = figure("sections", title, sections, gathered(by_grid));
    let by_threads = gathered(by_threads);
    let threads = figure("threads", "Time against threads, the pieces being the same".into(), threads, by_threads);
    Ok([grid, threads, finding].into_iter().flatten().collect())
}

/// Compares report D's "around 16 to 49 is a good number" with few sections, and with the same pieces on a thread for
/// each processor: the second result in a line, and both in a finding.
fn compared(results: &Results, claim: &Claim) -> Result<Option<(String, Block)>> {
    let Claim { per_section, few, sections: [least, most], against } = claim;
    let processors = results.run.machine.processors;
    let of = |strategy: &str| -> Vec<&Row> {
        results.rows().filter(|row| row.strategy == strategy && row.decomposition.starts_with(GRID)).collect()
    };
    let (sections, few) = (of(per_section), of(few));
    let own = || sections.iter().copied().filter(|row| (*least..=*most).contains(&row.jobs));
    let fewer = sections.iter().copied().filter(|row| row.decomposition == *against);
    let few = few.into_iter().filter(|row| row.threads == processors);
    let seconds = |row: &Row| row.makespan_s;
    let against_sections = Partners::of(fewer, without_pieces)?.pairs(own()).costs(seconds);
    let against_few = Partners::of(few, with_pieces)?.pairs(own()).costs(seconds);
    let of_threads = against_few.median(results.stopping()).and_then(Ratio::of).map(|ratio| {
        let each = "A thread for each section";
        match (ratio.interval.low > 1.0, ratio.interval.high < 1.0) {
            (true, _) => format!("{each} takes {}, compared with one for each processor", titles::longer(ratio.value)),
            (_, true) => {
                let less = titles::percent(1.0 - ratio.value);
                format!("{each} takes {less} less time than one for each processor")
            }
            _ => "This machine cannot tell a thread for each section from one for each processor".to_string(),
        }
    });
    let in_words = |ratios: &Repeats| {
        let Estimated { value, interval, .. } = ratios.median(results.stopping())?;
        let interval = interval?;
        let verdict = match (interval.low > 1.0, interval.high < 1.0) {
            (true, _) => "longer",
            (_, true) => "shorter",
            _ => "not told apart",
        };
        Some(format!("{} times as long ({verdict})", with_interval(value, &interval, 2)))
    };
    let Some((sections, few)) = in_words(&against_sections).zip(in_words(&against_few)) else { return Ok(None) };
    let finding = Block::finding(format!(
        "A thread for each of {least} to {most} sections takes, against one for each of {} sections, {sections}; against a thread for each of the {} processors on the same {least} to {most} sections, {few}. \
         The first ratio has smaller pieces and more threads; the second shows what the threads alone gain or cost.",
        against.trim_start_matches(GRID),
        processors,
    ));
    Ok(of_threads.map(|result| (result, finding)))
}
