//! Scaled speedup: the serial program's time for the larger problem over the schedule's time.

use super::scaling_laws;
use crate::analysis::scaling_law::Law;
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let serial = results.serial()?;
    let speedups = serial.speedups();
    let threads = speedups.iter().map(|(schedule, _)| schedule.key.threads as f64);
    let lines = gathered(
        speedups
            .iter()
            .map(|(schedule, speedup)| (&schedule.name, Estimated::from(*speedup).above(schedule.key.threads as f64))),
    );
    let processors = results.run.machine.processors;
    let alone = speedups.iter().filter(|(schedule, ratio)| schedule.key.threads <= processors && !ratio.is_partial);
    let best = alone.max_by(|a, b| a.0.key.threads.cmp(&b.0.key.threads).then(a.1.value.total_cmp(&b.1.value)));
    let result = best.filter(|(schedule, _)| schedule.key.threads > 1).and_then(|(schedule, ratio)| {
        let (name, threads) = (&schedule.name, schedule.key.threads);
        Some(format!("On {threads} threads {name} renders {} times as much in the same time", titles::told(*ratio)?))
    });
    let mut chart = LineChart::new(
        Title::new("Weak scaling: scaled speedup against threads").with_result(result),
        Axis::log("threads, each with the same samples per pixel").ticks_at(threads),
        Axis::linear("serial time for the same samples / time").including([0.0]),
        Series::by_name(lines),
    );
    chart.subtitle = results.workload();
    chart.caption = ratio_bars(speedups.iter().map(|(_, speedup)| *speedup));
    chart.overlays = vec![Overlay::guide("ideal: one per thread", Curve::Line { intercept: 0.0, slope: 1.0 })];
    chart.dodge = 6.0;
    Ok(vec![Block::figure("weak-scaling", chart), scaling_laws::table(results, &[Law::Gustafson], "gustafson")?])
}
