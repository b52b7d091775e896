//! Efficiency against the size of a job, the size at which half is lost (METG), and the overhead of a job.

use crate::analysis::metg::{Grain, HALF, Metg, metg};
use crate::input::optional_array;
use crate::measure::SERIAL;
use crate::plot::Panels;
use crate::plot::number::short;
use crate::prelude::*;
use crate::serial::Serial;
use crate::titles::Sides;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Options {
    /// Two strategies whose times are compared on each decomposition.
    #[serde(default, deserialize_with = "optional_array")]
    compare: Option<[String; 2]>,
}

/// The serial runs, and the seconds of their jobs.
struct Baseline<'a> {
    results: &'a Results,
    serial: Serial<'a>,
    per_job: BTreeMap<(ImageKey, &'a str), f64>,
}

impl<'a> Baseline<'a> {
    fn of(results: &'a Results) -> Result<Self> {
        let serial = results.rows().filter(|row| row.schedule.is_serial());
        let jobs = serial.filter_map(|row| {
            let key = (row.image.without_seed(), row.decomposition.as_str());
            Some((key, row.busy_sum_s? / row.jobs as f64))
        });
        let per_job = gathered(jobs).into_iter().filter_map(|(key, times)| Some((key, median(&times)?))).collect();
        Ok(Self { results, serial: results.serial()?, per_job })
    }

    /// The workers that can run at the same time, by their weights.
    fn in_use(&self, row: &Row) -> f64 {
        self.results.weight_in_use(row.threads.max(1))
    }

    /// The time of the fastest serial run over the makespan times the number of workers in use.
    fn efficiency(&self, rows: &[&'a Row]) -> Repeats {
        let pairs = self.serial.fastest.pairs(rows.iter().copied());
        let spent = Repeats::of_rows(rows.iter().copied(), |row| Some(self.in_use(row)));
        pairs.gains(|row| row.makespan_s).over(&spent)
    }

    /// Processor time per job beyond the serial work on the same pieces, in nanoseconds.
    fn extra_ns(&self, rows: Vec<&'a Row>) -> Repeats {
        self.serial.on_pieces.pairs(rows).values(|row, serial| {
            let extra_s = self.in_use(row) * row.makespan_s? - serial.busy_sum_s?;
            Some(extra_s / row.jobs as f64 * 1e9)
        })
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let baseline = Baseline::of(results)?;
    let cells = results.by(|row| (&row.schedule, row.image.without_seed()));
    let cells = cells.into_iter().filter_map(|((schedule, image), rows)| {
        let job_s = *baseline.per_job.get(&(image, schedule.key.decomposition.as_str()))?;
        Some(((name(results, rows[0]), job_s), baseline.efficiency(&rows)))
    });
    let cells: Vec<((String, f64), Repeats)> = cells.collect();
    let efficiencies = medians(cells.clone(), results.stopping());
    let caption = bars(efficiencies.iter().map(|(_, efficiency)| *efficiency)) + results.weights_in_words();
    let lines = gathered(efficiencies.into_iter().map(|((name, job_s), efficiency)| (name, (job_s, efficiency))));
    let line = |(index, (strategy, mut places)): (usize, (String, Vec<(f64, Estimated)>))| {
        places.sort_by(|a, b| a.0.total_cmp(&b.0));
        let points = places.iter().map(|(job_s, efficiency)| efficiency.above(job_s * 1e6));
        Series::new(strategy, Look::nth(index), points.collect())
    };
    let series: Vec<Series> = lines.into_iter().enumerate().map(line).collect();
    let grains = gathered(cells.into_iter().map(|((name, job_s), own)| (name, (job_s, own))));
    let grain = |(job_s, values): (f64, Vec<f64>)| -> Grain { (job_s, values) };
    let grains: BTreeMap<String, Vec<Grain>> =
        grains.into_iter().map(|(name, own)| (name, in_common(own).into_iter().map(grain).collect())).collect();
    let found: Vec<(&String, Metg)> =
        grains.iter().map(|(strategy, grains)| (strategy, metg(grains, HALF, LEVEL))).collect();
    let panels = panels(results, &series, &caption, result(&found));
    let smallest = found.iter().map(|(strategy, found)| (*strategy, in_words(found)));
    let table = Block::table("metg", "Smallest job that keeps half of the processors", smallest)
        .column("strategy", |(strategy, _)| (*strategy).clone())
        .column("METG(50 %), microseconds", |(_, [value, _])| value.clone())
        .column("how sure", |(_, [_, remark])| remark.clone())
        .end();
    let mut blocks = vec![Block::figure("granularity", panels), table, overhead(results, &baseline)];
    let Options { compare } = options(&results.definition, "granularity")?;
    if let Some([first, second]) = compare {
        blocks.extend(compared(results, &first, &second)?);
    }
    Ok(blocks)
}

/// The result in a line: the strategies that need the smallest and the largest jobs, if their intervals are disjoint.
fn result(found: &[(&String, Metg)]) -> Option<String> {
    let ends = |found: &Metg| match found {
        Metg::Value { interval, .. } => interval.map(|interval| [interval.low, interval.high]),
        Metg::Below(least) => Some([0.0, *least]),
        Metg::Above(most) => Some([*most, f64::INFINITY]),
        Metg::Undefined(_) => None,
    };
    let size = |found: &Metg| match found {
        Metg::Value { seconds, .. } => format!("{} µs", short(seconds * 1e6, 2)),
        Metg::Below(least) => format!("less than {} µs", short(least * 1e6, 2)),
        Metg::Above(most) => format!("more than {} µs", short(most * 1e6, 2)),
        Metg::Undefined(_) => String::new(),
    };
    let parallel = found.iter().filter(|(name, _)| !is_serial(name));
    let known: Vec<(&str, &Metg, [f64; 2])> =
        parallel.filter_map(|(name, found)| Some((name.as_str(), found, ends(found)?))).collect();
    let (best, small, [_, high]) = known.iter().min_by(|a, b| a.2[1].total_cmp(&b.2[1]))?;
    let (worst, large, [low, _]) = known.iter().max_by(|a, b| a.2[0].total_cmp(&b.2[0]))?;
    let (small, large) = (size(small), size(large));
    if known.len() == 1 {
        return Some(format!("With {best}, jobs of {small} use half of the processors"));
    }
    Some(if high < low {
        format!("With {best}, jobs of {small} use half of the processors; {worst} needs {large}")
    } else {
        "This machine cannot tell which strategy keeps up with the smallest jobs".to_string()
    })
}

/// All strategies in one chart, without intervals, and each in a small one with its intervals.
fn panels(results: &Results, series: &[Series], caption: &str, result: Option<String>) -> Panels {
    let points = || series.iter().flat_map(|series| &series.points);
    let ends = |ends: fn(&Point) -> [f64; 2]| points().flat_map(ends).collect::<Vec<f64>>();
    let sizes = ends(|point| [point.x, point.x]);
    let heights = ends(|point| point.y_interval.map_or([point.y; 2], |(low, high)| [low, high]));
    let x = Axis::log("microseconds of work per job (serial)").including(sizes);
    let y = Axis::linear("best serial time / (processors in use × time)").including([0.0, 1.0]);
    let half = || vec![Overlay::guide("one half: METG(50 %)", Curve::Line { intercept: HALF, slope: 0.0 })];
    // The large chart names the axes.
    let unnamed = |axis: &Axis| Axis { label: String::new(), ..axis.clone() };
    let small = |series: &Series| {
        let y = unnamed(&y).including(heights.iter().copied());
        let mut chart = LineChart::new(&series.name, unnamed(&x), y, vec![series.clone()]);
        chart.overlays = half();
        chart
    };
    let others = if series.len() > 1 { series.iter().map(small).collect() } else { Vec::new() };
    let title = Title::new("Efficiency against the size of a job").with_result(result);
    let bare = |series: &Series| {
        let mut bare = series.clone();
        bare.points.iter_mut().for_each(|point| point.y_interval = None);
        bare
    };
    let drawn = if others.is_empty() { series.to_vec() } else { series.iter().map(bare).collect() };
    let mut main = LineChart::new(title, x.clone(), y.clone(), drawn);
    main.subtitle = results.workload();
    main.caption = caption.to_string();
    main.overlays = half();
    Panels { main, others }
}

/// Compares two strategies on the same pieces in the same repetition, from the smallest jobs to the largest.
fn compared(results: &Results, first: &str, second: &str) -> Result<Vec<Block>> {
    let groups = results.by(|row| (&row.image, row.decomposition.as_str(), row.threads));
    let pairs = groups.into_values().map(|rows| {
        let of = |name: &str| rows.iter().copied().filter(|row| row.strategy == name).collect::<Vec<&Row>>();
        (rows[0], of(first), of(second))
    });
    let pairs: Vec<(&Row, Vec<&Row>, Vec<&Row>)> = pairs.collect();
    let cells = pairs.iter().map(|(row, first, second)| (*row, &first[..], &second[..]));
    let mut lines = time_ratios(cells, |_, schedule| schedule.strategy.clear(), results.stopping())?;
    if lines.is_empty() {
        return Ok(Vec::new());
    }
    lines.sort_by_key(|(row, _)| std::cmp::Reverse(row.jobs));
    let sides = Sides::of(lines.iter().map(|(_, ratio)| *ratio));
    let finding = format!(
        "{first} takes longer than {second} on {} of {} decompositions, and shorter on {}. On {} the two are not told apart.",
        sides.above,
        sides.count(),
        sides.below,
        sides.open,
    );
    let title = format!("Seconds of {first} over seconds of {second} on the same pieces");
    let table = Block::table("compared", title, lines)
        .column("pieces", |(row, _)| row.decomposition.clone())
        .column("jobs", |(row, _)| row.jobs.to_string())
        .column("threads", |(row, _)| row.threads.to_string())
        .estimated("ratio", Decimals(3), |(_, ratio)| Estimated::from(*ratio))
        .end();
    Ok(vec![Block::finding(finding), table])
}

/// The strategy, with the image if there are several.
fn name(results: &Results, row: &Row) -> String {
    joined([results.series_name(row), row.schedule.name.clone()])
}

/// Whether a name is that of the serial program, which hands out no jobs.
fn is_serial(name: &str) -> bool {
    name.split([',', ' ']).any(|word| word == SERIAL)
}

/// The size in microseconds, and its uncertainty.
fn in_words(found: &Metg) -> [String; 2] {
    let microseconds = |seconds: f64| format!("{:.3}", seconds * 1e6);
    match found {
        Metg::Value { seconds, interval, between, crossings } => {
            let bracket = format!("between {} and {}", microseconds(between.0), microseconds(between.1));
            let interval = interval.map_or_else(String::new, |interval| {
                let (low, high) = (microseconds(interval.low), microseconds(interval.high));
                format!("; {low} to {high} ({:.1} %)", interval.percent())
            });
            let often = if *crossings > 1 { format!("; crosses one half {crossings} times") } else { String::new() };
            [microseconds(*seconds), format!("{bracket}{interval}{often}")]
        }
        Metg::Below(least) => [format!("< {}", microseconds(*least)), "even the smallest jobs keep half".to_string()],
        Metg::Above(most) => [format!("> {}", microseconds(*most)), "even the largest jobs do not".to_string()],
        Metg::Undefined(reason) => ["-".to_string(), (*reason).to_string()],
    }
}

/// The overhead of a job, at the largest number of jobs.
fn overhead(results: &Results, baseline: &Baseline<'_>) -> Block {
    let extra = results.by(|row| name(results, row)).into_iter().filter_map(|(strategy, rows)| {
        let most = rows.iter().map(|row| row.jobs).max()?;
        let smallest = rows.into_iter().filter(|row| row.jobs == most);
        Some((format!("{strategy} ({most} jobs)"), baseline.extra_ns(smallest.collect())))
    });
    let mut extra = medians(extra, results.stopping());
    extra.sort_by(|(_, a), (_, b)| (a.is_partial).cmp(&b.is_partial).then(a.value.total_cmp(&b.value)));
    let rows = extra.iter().map(|(name, told)| DotRow::new(name, vec![Some(told.dot())])).collect();
    let parallel = extra.iter().filter(|(name, _)| !is_serial(name));
    let ends = titles::ends_apart(parallel.map(|(name, told)| (name.as_str(), *told)));
    let result = ends.map(|[(cheap, least), (dear, most)]| {
        let [least, most] = [least, most].map(|told| short(told.value, 2));
        format!("A job costs {least} ns beside its work with {cheap}, {most} ns with {dear}")
    });
    let title = Title::new("What a job costs beside its work").with_result(result);
    let mut plot = DotPlot::new(title, Axis::log("nanoseconds per job"), rows);
    plot.subtitle = results.workload();
    plot.caption = format!(
        "(Processors in use × time - serial work on the same pieces) / jobs, at the most jobs measured; starting threads is in it. {}",
        bars(extra.iter().map(|(_, told)| *told)),
    );
    Block::figure("overhead", plot)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Record;
    use crate::tests::{results, row};

    #[test]
    fn smallest_jobs_are_ranked_only_if_their_intervals_are_disjoint() {
        let of = |seconds: f64, low: f64, high: f64| {
            let interval = Some(Interval { low, high, level: LEVEL });
            Metg::Value { seconds, interval, between: (0.0, 1.0), crossings: 1 }
        };
        let names = ["one", "other"].map(str::to_string);
        let told = |first: Metg, second: Metg| result(&[(&names[0], first), (&names[1], second)]).unwrap();
        let large = || of(9e-6, 8e-6, 1e-5);
        let apart = told(of(2e-6, 1e-6, 3e-6), large());
        assert_eq!(apart, "With one, jobs of 2 µs use half of the processors; other needs 9 µs");
        let below = told(large(), Metg::Below(1e-6));
        assert_eq!(below, "With other, jobs of less than 1 µs use half of the processors; one needs 9 µs");
        let open = told(of(2e-6, 1e-6, 8.5e-6), large());
        assert_eq!(open, "This machine cannot tell which strategy keeps up with the smallest jobs");
        assert_eq!(result(&[(&names[0], Metg::Undefined(""))]), None);
        assert_eq!(result(&[(&"serial".to_string(), large())]), None);
    }

    /// Work of 12 s takes 8 s on a fast core and one of half its speed: that is all of both, and three quarters of two fast ones.
    #[test]
    fn slow_cores_count_by_their_capacity() {
        let row = |strategy: &str, threads: usize, seconds: f64| {
            let strategy = strategy.to_string();
            Record { strategy, threads, makespan_s: Some(seconds), busy_sum_s: Some(12.0), ..row() }
        };
        let mut results = results(&["granularity"], "", vec![row("serial", 1, 12.0), row("pool", 2, 8.0)]).unwrap();
        let told = |results: &Results| {
            let baseline = Baseline::of(results).unwrap();
            let pool: Vec<&Row> = results.rows().filter(|row| row.threads == 2).collect();
            let jobs = pool[0].jobs as f64;
            let extra_s: Vec<f64> = baseline.extra_ns(pool.clone()).values().iter().map(|ns| ns * jobs / 1e9).collect();
            (baseline.efficiency(&pool).values(), extra_s)
        };
        let kinds = serde_json::json!([{"capacity": 1024, "processors": "1"}, {"capacity": 512, "processors": "0"}]);
        for (layout, efficiency, extra_s) in
            [(serde_json::json!({}), 0.75, 4.0), (serde_json::json!({"allowed": "0-1", "kinds": kinds}), 1.0, 0.0)]
        {
            results.run.machine.layout = serde_json::from_value(layout).unwrap();
            let (found, extra) = told(&results);
            assert!((found[0] - efficiency).abs() < 1e-12 && (extra[0] - extra_s).abs() < 1e-9, "{found:?} {extra:?}");
        }
    }
}
