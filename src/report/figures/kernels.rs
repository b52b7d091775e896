//! What SIMD lanes are worth: how many times as many samples per second as the scalar kernel, by scene, instruction set and precision.

use crate::analysis::Estimate;
use crate::analysis::quantile::median;
use crate::analysis::versus::equal_error;
use crate::error::Result;
use crate::measure::Record;
use crate::plot::style::Look;
use crate::plot::{Axis, Dot, DotPlot, Group, Row};
use crate::report::block::{Block, Table};
use crate::report::contenders::{Contender, contenders};
use crate::report::results::{Results, confidence, with_level};
use std::collections::BTreeSet;

/// What the others are compared with.
const SCALAR: &str = "scalar";

/// The error at which everything together is compared.
const GOAL: f64 = 0.01;

/// What is rendered, on how many threads.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Work {
    scene: String,
    estimator: String,
    sampler: String,
    roulette: String,
    threads: usize,
}

impl Work {
    fn of(record: &Record) -> Self {
        Self {
            scene: record.scene.clone(),
            estimator: record.estimator.clone(),
            sampler: record.sampler.clone(),
            roulette: record.roulette.clone(),
            threads: record.threads,
        }
    }

    fn name(&self) -> String {
        format!("{}: {} + {}", self.scene, self.estimator, self.sampler)
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let kernels: BTreeSet<String> = results.records.iter().map(Record::kernel_name).collect();
    let works = results.by(Work::of).into_keys();
    let ratio = |work: &Work, kernel: &str| {
        let is = |record: &Record, name: &str| Work::of(record) == *work && record.kernel_name() == name;
        results.kind_ratio(|record| is(record, SCALAR), |record| is(record, kernel))
    };
    // What has no scalar row of its own is compared with nothing.
    let compared: Vec<(Work, Vec<Option<Estimate>>)> = works
        .map(|work| (work.clone(), kernels.iter().map(|kernel| ratio(&work, kernel)).collect()))
        .filter(|(_, ratios): &(Work, Vec<Option<Estimate>>)| ratios.iter().any(Option::is_some))
        .collect();
    if compared.is_empty() {
        return Ok(vec![Block::Finding("No two kernels rendered the same, so there is no ratio of them.".to_string())]);
    }
    let columns = ["", "threads", "kernel", "Msamples/s", "Mrays/s", "times as fast as scalar (confidence)"];
    let rows = compared.iter().flat_map(|(work, ratios)| {
        kernels.iter().zip(ratios).filter_map(|(kernel, ratio)| row(results, work, kernel, *ratio))
    });
    let table = Table {
        title: "Samples and rays per second, medians".to_string(),
        columns: columns.map(String::from).to_vec(),
        rows: rows.collect(),
    };
    let mut blocks = vec![Block::Figure { stem: "kernels", figure: Box::new(plot(results, &kernels, &compared)) }];
    blocks.extend(contenders(results).iter().filter_map(|(scene, contenders)| finding(scene, contenders)));
    blocks.push(Block::Table { stem: "kernels", table });
    Ok(blocks)
}

/// What everything together gains to the same error, on one thread and on all.
fn finding(scene: &str, contenders: &[Contender]) -> Option<Block> {
    let of = |threads: usize| contenders.iter().filter(move |contender| contender.threads == threads);
    let slowest = of(1).find(|contender| contender.kernel == SCALAR)?;
    let gain = |contender: &&Contender| equal_error(&slowest.renderer, &contender.renderer, GOAL);
    let mut sentences = Vec::new();
    let counts: BTreeSet<usize> = contenders.iter().map(|contender| contender.threads).collect();
    for threads in counts {
        let (best, gain) = of(threads)
            .filter_map(|contender| Some((contender, gain(&contender)?)))
            .max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
        let who = if threads == 1 { "one thread".to_string() } else { format!("{threads} threads") };
        sentences.push(format!(
            "on {who} {:.1} times as fast (95 % {:.1} to {:.1}; {})",
            gain.value, gain.interval.low, gain.interval.high, best.name
        ));
    }
    let of_slowest = &slowest.name;
    Some(Block::Finding(format!("{scene}, to an RMSE of {GOAL}, against {of_slowest}: {}.", sentences.join(", "))))
}

/// Ratios on one thread: on more, schedules have their part in them.
fn plot(results: &Results, kernels: &BTreeSet<String>, compared: &[(Work, Vec<Option<Estimate>>)]) -> DotPlot {
    let is_lanes = |kernel: &&String| *kernel != SCALAR;
    let mut intervals = Vec::new();
    let mut rows = Vec::new();
    for (work, ratios) in compared.iter().filter(|(work, _)| work.threads == 1) {
        let lanes = kernels.iter().zip(ratios).filter(|(kernel, _)| is_lanes(kernel));
        let dots = lanes.map(|(_, ratio)| {
            let ratio = (*ratio)?;
            intervals.push(ratio.interval);
            Some(Dot { value: ratio.value, interval: Some((ratio.interval.low, ratio.interval.high)) })
        });
        rows.push(Row { name: work.name(), dots: dots.collect() });
    }
    let axis = Axis::log("samples per second / those of the scalar kernel").including([1.0]);
    let mut plot = DotPlot::new("What SIMD lanes are worth", axis, rows);
    let group = |(index, kernel): (usize, &String)| Group { name: kernel.clone(), look: Look::nth(index) };
    plot.groups = kernels.iter().filter(is_lanes).enumerate().map(group).collect();
    plot.guides = vec![(1.0, "the scalar kernel".to_string())];
    plot.subtitle = format!("one thread, {}", results.machine_line());
    plot.caption = format!("Median of ratios of renders of the same image. Bars: {}.", confidence(&intervals));
    plot
}

fn row(results: &Results, work: &Work, kernel: &str, ratio: Option<Estimate>) -> Option<Vec<String>> {
    let rows = || results.records.iter().filter(|record| Work::of(record) == *work && record.kernel_name() == kernel);
    // Of a curve, its end: the longest of its renders.
    let spp = rows().map(|record| record.spp).max()?;
    let rate = |count: fn(&Record) -> Option<u64>| {
        let rates = rows().filter(|record| record.spp == spp);
        let rates: Vec<f64> =
            rates.filter_map(|record| Some(count(record)? as f64 / record.makespan_s? / 1e6)).collect();
        median(&rates).map_or_else(|| "-".to_string(), |rate| format!("{rate:.2}"))
    };
    Some(vec![
        work.name(),
        work.threads.to_string(),
        kernel.to_string(),
        rate(|record| record.paths),
        rate(|record| record.rays),
        ratio.map_or_else(|| "-".to_string(), |e| format!("{:.2}, {}", e.value, with_level(&e.interval, 2))),
    ])
}
