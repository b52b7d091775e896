//! The gain of SIMD lanes: samples per second over those of the scalar kernel, by scene, instruction set and precision.

use crate::analysis::price::equal_error;
use crate::contenders::{Contender, contenders};
use crate::kernel::DEVICE_NAME;
use crate::prelude::*;
use crate::words::with_interval;

/// The kernel that the others are compared with.
const YARDSTICK: &str = "scalar";

/// The RMSE at which the gain of all choices together is measured, in linear radiance.
const GOAL: f64 = 0.01;

/// The rows of one kernel, for one workload and number of threads.
struct Line<'a> {
    name: String,
    threads: usize,
    kernel: String,
    rows: Vec<&'a Row>,
    /// How many times as long the yardstick takes.
    ratio: Option<Ratio>,
}

/// Clears the properties in which rows of different kernels and precisions differ.
pub(super) fn any_kernel(image: &mut ImageKey, schedule: &mut ScheduleKey) {
    image.precision.clear();
    schedule.forget_kernel();
}

/// The lines of each workload. Leaves out workloads in which no kernel can be compared with the yardstick.
fn works<'a>(results: &'a Results) -> Result<Vec<Vec<Line<'a>>>> {
    let mut works = Vec::new();
    for ((scene, estimator, sampler, _, threads), rows) in
        results.by(|row| (&row.scene, &row.estimator, &row.sampler, &row.roulette, row.threads))
    {
        let measured = rows.into_iter().filter(|row| row.makespan_s.is_some());
        let mut kernels = group(measured, |row| row.kernel_name());
        // Short renders show the start of a kernel rather than its samples, so all kernels are compared at the most
        // samples that the yardstick and another one have.
        let spp = |rows: &[&Row]| rows.iter().map(|row| row.spp).collect::<BTreeSet<u32>>();
        let of_base = kernels.get(YARDSTICK).map(|rows| spp(rows)).unwrap_or_default();
        let others = kernels.iter().filter(|(kernel, _)| *kernel != YARDSTICK).flat_map(|(_, rows)| spp(rows));
        let Some(most) = others.filter(|spp| of_base.contains(spp)).max() else { continue };
        for rows in kernels.values_mut() {
            rows.retain(|row| row.spp == most);
        }
        kernels.retain(|_, rows| !rows.is_empty());
        let Some(base) = kernels.get(YARDSTICK) else { continue };
        let cells = kernels.iter().map(|(kernel, rows)| (kernel, &base[..], &rows[..]));
        let gains: BTreeMap<&String, Ratio> = time_ratios(cells, any_kernel, results.stopping())?.into_iter().collect();
        let line = |(kernel, rows): (&String, &Vec<&'a Row>)| {
            let name = format!("{scene}: {estimator} + {sampler}, {most} spp");
            let ratio = gains.get(kernel).copied();
            Line { name, threads, kernel: kernel.clone(), rows: rows.clone(), ratio }
        };
        let lines: Vec<Line<'_>> = kernels.iter().map(line).collect();
        if lines.iter().any(|line| line.ratio.is_some()) {
            works.push(lines);
        }
    }
    Ok(works)
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let works = works(results)?;
    if works.is_empty() {
        return Ok(vec![Block::notice("No two kernels rendered the same, so there is no ratio of them.")]);
    }
    let mut blocks = vec![Block::figure("kernels", plot(results, &works))];
    blocks.extend(finding(&fastest(&works)));
    blocks.extend(at_equal_error(results)?);
    let mut table = Block::table("kernels", "Samples and rays per second, medians", works.iter().flatten())
        .column("workload", |line| line.name.clone())
        .column("threads", |line| line.threads.to_string())
        .column("kernel", |line| line.kernel.clone())
        .number("Msamples/s", Decimals(2), |line| line.rate(|row| row.samples))
        .number("Mrays/s", Decimals(2), |line| line.rate(|row| row.rays))
        .estimated(format!("times as fast as {YARDSTICK}"), Decimals(2), |line| line.ratio.map(Estimated::from));
    if results.rows().any(|row| row.device_compile_s.is_some()) {
        table = table
            .number("s to compile", Decimals(2), |line| typical(&line.rows, |row| row.device_compile_s))
            .number("s to copy the scene", Decimals(4), |line| typical(&line.rows, |row| row.device_copy_s));
    }
    blocks.push(table.end());
    Ok(blocks)
}

impl Line<'_> {
    fn rate(&self, count: fn(&Row) -> Option<u64>) -> Option<f64> {
        typical(&self.rows, |row| Some(count(row)? as f64 / row.makespan_s? / 1e6))
    }
}

/// The workloads on one thread: on several, schedules would affect the ratios.
fn alone<'a, 'b>(works: &'a [Vec<Line<'b>>]) -> impl Iterator<Item = &'a Vec<Line<'b>>> {
    works.iter().filter(|lines| lines[0].threads == 1)
}

/// The kernel with the largest ratio of each workload on one thread, in the order of the ratios. Partial ratios are not
/// ranked.
fn fastest<'a, 'b>(works: &'a [Vec<Line<'b>>]) -> Vec<(&'a Line<'b>, Ratio)> {
    let largest = alone(works).filter_map(|lines| {
        let others = lines.iter().filter(|line| line.kernel != YARDSTICK);
        let ratios = others.filter_map(|line| Some((line, line.ratio.filter(|ratio| !ratio.is_partial)?)));
        ratios.max_by(|a, b| a.1.value.total_cmp(&b.1.value))
    });
    let mut found: Vec<(&Line<'_>, Ratio)> = largest.collect();
    found.sort_by(|a, b| a.1.value.total_cmp(&b.1.value));
    found
}

fn is_faster((_, ratio): &(&Line<'_>, Ratio)) -> bool {
    ratio.interval.low > 1.0
}

/// A finding: the workloads that gain the least and the most from the fastest kernel.
fn finding(fastest: &[(&Line<'_>, Ratio)]) -> Option<Block> {
    let told = |(line, ratio): &(&Line<'_>, Ratio)| {
        let times = with_interval(ratio.value, &ratio.interval, 2);
        format!("{times} times as fast as {YARDSTICK} on {} ({})", line.name, line.kernel)
    };
    Some(Block::finding(match (fastest.first()?, fastest.last()?) {
        _ if !fastest.iter().any(is_faster) => {
            format!("On one thread no kernel is faster than {YARDSTICK} beyond the noise.")
        }
        (_, most) if fastest.len() == 1 => format!("On one thread the fastest kernel is {}.", told(most)),
        (least, most) => format!("On one thread the fastest kernel is {}, and {}.", told(least), told(most)),
    }))
}

/// The gain of all choices together at the same error, over the yardstick on one thread: a finding for each scene, and a
/// table by numbers of threads.
fn at_equal_error(results: &Results) -> Result<Vec<Block>> {
    let scenes = contenders(results)?;
    let (mut blocks, mut lines) = (Vec::new(), Vec::new());
    for (scene, all) in &scenes {
        let of = |threads: usize| all.iter().filter(move |contender| contender.schedule.threads == threads);
        let Some(slowest) = of(1).find(|contender| contender.kernel == YARDSTICK) else { continue };
        let counts: BTreeSet<usize> = all.iter().map(|contender| contender.schedule.threads).collect();
        let of_counts = counts.into_iter().filter_map(|threads| {
            let gain = |contender: &Contender| equal_error(&slowest.renderer, &contender.renderer, GOAL);
            let gains = of(threads).filter_map(|contender| Some((contender, gain(contender)?)));
            gains.max_by(|a, b| a.1.value.total_cmp(&b.1.value))
        });
        let best: Vec<(&Contender, Estimate)> = of_counts.collect();
        let Some((fastest, gain)) = best.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value)) else { continue };
        if std::ptr::eq(*fastest, slowest) {
            continue;
        }
        let times = with_interval(gain.value, &gain.interval, 1);
        let (fastest, slowest) = (&fastest.name, &slowest.name);
        let text = format!("{scene}: {fastest} is {times} times as fast as {slowest} to an RMSE of {GOAL}.");
        blocks.push(Block::finding(text));
        lines.extend(best.into_iter().map(|(contender, gain)| (scene, contender, slowest, gain)));
    }
    if !lines.is_empty() {
        let title = format!("Times as fast to an RMSE of {GOAL}, all choices together");
        let table = Block::table("kernels-at-equal-error", title, lines)
            .column("scene", |(scene, ..)| (*scene).clone())
            .column("threads", |(_, contender, ..)| contender.schedule.threads.to_string())
            .column("fastest", |(_, contender, ..)| contender.name.clone())
            .column("against", |(_, _, slowest, _)| (*slowest).clone())
            .estimated("times as fast", Decimals(1), |(.., gain)| Estimated::from(*gain));
        blocks.push(table.end());
    }
    Ok(blocks)
}

/// The result in a line: how many times as fast the fastest kernel of each workload is.
fn result(fastest: &[(&Line<'_>, Ratio)]) -> Option<String> {
    let ((_, least), (_, most)) = (fastest.first()?, fastest.last()?);
    if !fastest.iter().any(is_faster) {
        return Some(format!("No kernel is faster than the {YARDSTICK} kernel beyond the noise"));
    }
    let factor = if fastest.len() == 1 {
        titles::told(*most)?
    } else if fastest.iter().all(is_faster) {
        format!("{:.1} to {:.1}", least.value, most.value)
    } else if most.interval.low <= 1.0 {
        return None;
    } else {
        format!("up to {:.1}", most.value)
    };
    Some(format!("The fastest kernel is {factor} times as fast as the {YARDSTICK} kernel"))
}

fn plot(results: &Results, works: &[Vec<Line<'_>>]) -> DotPlot {
    let kernels: BTreeSet<&str> = works.iter().flatten().map(|line| line.kernel.as_str()).collect();
    let kernels = || kernels.iter().copied().filter(|kernel| *kernel != YARDSTICK);
    let ratio = |lines: &[Line<'_>], kernel: &str| lines.iter().find(|line| line.kernel == kernel)?.ratio;
    let rows = alone(works).map(|lines| {
        let dots = kernels().map(|kernel| Some(Estimated::from(ratio(lines, kernel)?).dot()));
        DotRow::new(&lines[0].name, dots.collect())
    });
    let axis = Axis::log(format!("samples per second / those of the {YARDSTICK} kernel")).including([1.0]);
    let has_devices = kernels().any(|kernel| kernel.contains(DEVICE_NAME));
    let title = if has_devices { "What SIMD lanes and devices are worth" } else { "What SIMD lanes are worth" };
    let result = result(&fastest(works));
    let title = Title::new(title).with_result(result);
    let mut plot = DotPlot::new(title, axis, rows.collect()).grouped(kernels());
    plot.guides = vec![(1.0, format!("the {YARDSTICK} kernel"))];
    let line = results.run.machine.line();
    plot.subtitle = std::iter::once(format!("one thread, {line}"))
        .chain(results.run.devices.clone())
        .collect::<Vec<_>>()
        .join("; ");
    let shown = alone(works).flatten().filter(|line| line.kernel != YARDSTICK);
    let bars = bars(shown.filter_map(|line| line.ratio));
    plot.caption = format!("Ratios of renders of the same image. {bars}");
    plot
}
