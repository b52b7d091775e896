//! The gain of SIMD lanes: samples per second over those of the scalar kernel, by scene, instruction set and precision.

use crate::analysis::price::equal_error;
use crate::contenders::{Contender, contenders};
use crate::kernel::DEVICE_NAME;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Options {
    /// The kernel that the others are compared with.
    yardstick: Option<String>,
    /// The RMSE at which the gain of all choices together is measured, in linear radiance.
    goal: Option<Positive>,
}

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
fn works<'a>(results: &'a Results, yardstick: &str) -> Result<Vec<Vec<Line<'a>>>> {
    let mut works = Vec::new();
    for ((scene, estimator, sampler, _, threads), rows) in
        results.by(|row| (&row.scene, &row.estimator, &row.sampler, &row.roulette, row.threads))
    {
        let measured = rows.into_iter().filter(|row| row.makespan_s.is_some());
        let mut kernels = group(measured, |row| row.kernel_name());
        // Short renders show the start of a kernel rather than its samples, so all kernels are compared at the most
        // samples that the yardstick and another one have.
        let spp = |rows: &[&Row]| rows.iter().map(|row| row.spp).collect::<BTreeSet<u32>>();
        let of_base = kernels.get(yardstick).map(|rows| spp(rows)).unwrap_or_default();
        let others = kernels.iter().filter(|(kernel, _)| *kernel != yardstick).flat_map(|(_, rows)| spp(rows));
        let Some(most) = others.filter(|spp| of_base.contains(spp)).max() else { continue };
        for rows in kernels.values_mut() {
            rows.retain(|row| row.spp == most);
        }
        kernels.retain(|_, rows| !rows.is_empty());
        let Some(base) = kernels.get(yardstick) else { continue };
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
    let Options { yardstick, goal } = options(&results.definition, "kernels")?;
    let (yardstick, goal) = (yardstick.unwrap_or_else(|| "scalar".to_string()), goal.map_or(0.01, |goal| goal.0));
    let works = works(results, &yardstick)?;
    if works.is_empty() {
        return Ok(vec![Block::notice("No two kernels rendered the same, so there is no ratio of them.")]);
    }
    let mut blocks = vec![Block::figure("kernels", plot(results, &works, &yardstick))];
    let scenes = contenders(results)?;
    blocks.extend(scenes.iter().filter_map(|(scene, all)| finding(scene, all, &yardstick, goal)));
    let mut table = Block::table("kernels", "Samples and rays per second, medians", works.iter().flatten())
        .column("workload", |line| line.name.clone())
        .column("threads", |line| line.threads.to_string())
        .column("kernel", |line| line.kernel.clone())
        .number("Msamples/s", Decimals(2), |line| line.rate(|row| row.samples))
        .number("Mrays/s", Decimals(2), |line| line.rate(|row| row.rays))
        .estimated(format!("times as fast as {yardstick}"), Decimals(2), |line| line.ratio.map(Estimated::from));
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

/// The gain of all choices together at the same error, for each number of threads.
fn finding(scene: &str, contenders: &[Contender], yardstick: &str, goal: f64) -> Option<Block> {
    let of = |threads: usize| contenders.iter().filter(move |contender| contender.schedule.threads == threads);
    let slowest = of(1).find(|contender| contender.kernel == yardstick)?;
    let gain = |contender: &Contender| equal_error(&slowest.renderer, &contender.renderer, goal);
    let mut sentences = Vec::new();
    let counts: BTreeSet<usize> = contenders.iter().map(|contender| contender.schedule.threads).collect();
    for threads in counts {
        let (best, gain) = of(threads)
            .filter_map(|contender| Some((contender, gain(contender)?)))
            .max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
        let who = if threads == 1 { "one thread".to_string() } else { format!("{threads} threads") };
        sentences.push(format!(
            "on {who} {:.1} times as fast (95 % {:.1} to {:.1}; {})",
            gain.value, gain.interval.low, gain.interval.high, best.name
        ));
    }
    let of_slowest = &slowest.name;
    Some(Block::finding(format!("{scene}, to an RMSE of {goal}, against {of_slowest}: {}.", sentences.join(", "))))
}

/// The result in a line: how many times as fast the fastest kernel of each workload is.
fn result<'a>(works: impl Iterator<Item = &'a [Line<'a>]>, yardstick: &str) -> Option<String> {
    let fastest = works.filter_map(|lines| {
        let others = lines.iter().filter(|line| line.kernel != yardstick);
        let ratios = others.filter_map(|line| line.ratio).filter(|ratio| !ratio.is_partial);
        ratios.max_by(|a, b| a.value.total_cmp(&b.value))
    });
    let mut fastest: Vec<Ratio> = fastest.collect();
    fastest.sort_by(|a, b| a.value.total_cmp(&b.value));
    let (least, most) = (fastest.first()?, fastest.last()?);
    let is_faster = |ratio: &Ratio| ratio.interval.low > 1.0;
    if !fastest.iter().any(is_faster) {
        return Some(format!("No kernel is faster than the {yardstick} kernel beyond the noise"));
    }
    let factor = if fastest.len() == 1 {
        titles::told(*most)?
    } else if fastest.iter().all(is_faster) {
        format!("{:.1} to {:.1}", least.value, most.value)
    } else if !is_faster(most) {
        return None;
    } else {
        format!("up to {:.1}", most.value)
    };
    Some(format!("The fastest kernel is {factor} times as fast as the {yardstick} kernel"))
}

/// Ratios on one thread: on several, schedules would affect them.
fn plot(results: &Results, works: &[Vec<Line<'_>>], yardstick: &str) -> DotPlot {
    let kernels: BTreeSet<&str> = works.iter().flatten().map(|line| line.kernel.as_str()).collect();
    let kernels = || kernels.iter().copied().filter(|kernel| *kernel != yardstick);
    let alone = || works.iter().filter(|lines| lines[0].threads == 1);
    let ratio = |lines: &[Line<'_>], kernel: &str| lines.iter().find(|line| line.kernel == kernel)?.ratio;
    let rows = alone().map(|lines| {
        let dots = kernels().map(|kernel| Some(Estimated::from(ratio(lines, kernel)?).dot()));
        DotRow::new(&lines[0].name, dots.collect())
    });
    let axis = Axis::log(format!("samples per second / those of the {yardstick} kernel")).including([1.0]);
    let has_devices = kernels().any(|kernel| kernel.contains(DEVICE_NAME));
    let title = if has_devices { "What SIMD lanes and devices are worth" } else { "What SIMD lanes are worth" };
    let result = result(alone().map(Vec::as_slice), yardstick);
    let title = Title::new(title).with_result(result);
    let mut plot = DotPlot::new(title, axis, rows.collect()).grouped(kernels());
    plot.guides = vec![(1.0, format!("the {yardstick} kernel"))];
    let line = results.run.machine.line();
    plot.subtitle = std::iter::once(format!("one thread, {line}"))
        .chain(results.run.devices.clone())
        .collect::<Vec<_>>()
        .join("; ");
    let shown = alone().flatten().filter(|line| line.kernel != yardstick);
    let bars = bars(shown.filter_map(|line| line.ratio));
    plot.caption = format!("Ratios of renders of the same image. {bars}");
    plot
}
