//! Seconds against samples per pixel: a line through the origin if only sampling takes time.

use crate::analysis::fit::{line, log_log};
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let several = results.by(|row| row.schedule.label()).len() > 1;
    // Times of different schedules must not be mixed.
    let lines = results.by(|row| {
        let image = results.image_name(row);
        if several { format!("{image}, {}", row.schedule.label()) } else { image }
    });
    let (mut overlays, mut findings, mut series, mut all) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (name, rows) in lines {
        let cells = group(rows, |row| row.spp).into_iter();
        let cells = cells.map(|(spp, rows)| (spp, Repeats::of_rows(rows, |row| row.makespan_s)));
        // The fit compares them, so all come from the same repetitions.
        let times = in_common(cells.collect()).into_iter().filter_map(|(spp, seconds)| {
            let seconds = Estimated::typical(&seconds, results.stopping())?;
            all.push(seconds);
            Some(seconds.above(f64::from(spp)))
        });
        let points: Vec<_> = times.collect();
        if points.is_empty() {
            continue;
        }
        let pairs: Vec<(f64, f64)> = points.iter().map(|point| (point.x, point.y)).collect();
        // A line fits any two points, so the fit would say nothing.
        if pairs.len() < 3 {
            series.push(Series::new(name, Look::nth(series.len()), points).scattered());
            continue;
        }
        if let (Some(fit), Some(power)) = (line(&pairs, LEVEL), log_log(&pairs, LEVEL)) {
            let (slope, interval) = (fit.slope.value, fit.slope.interval);
            let curve = Curve::Line { intercept: fit.intercept.value, slope };
            overlays.push(Overlay::fit(format!("fit: {:.2} ms per spp", slope * 1e3), curve, series.len()));
            let exponent = power.slope.interval;
            let verdict = if exponent.contains(1.0) {
                "the interval contains 1: no departure from linear is seen"
            } else {
                "the interval does not contain 1"
            };
            findings.push(Block::finding(format!(
                "{name}: {:.3} ms per sample per pixel (95 % {:.3} to {:.3}) and {:.1} ms besides ({:.1} to {:.1}); the exponent of time \
                 against spp is {:.3} (95 % {:.3} to {:.3}); {verdict}.",
                slope * 1e3,
                interval.low * 1e3,
                interval.high * 1e3,
                fit.intercept.value * 1e3,
                fit.intercept.interval.low * 1e3,
                fit.intercept.interval.high * 1e3,
                power.slope.value,
                exponent.low,
                exponent.high,
            )));
        }
        series.push(Series::new(name, Look::nth(series.len()), points).scattered());
    }
    let mut chart = LineChart::new(
        "Time against samples per pixel",
        Axis::linear("samples per pixel").ticks_at(results.rows().map(|row| f64::from(row.spp))).including([0.0]),
        Axis::linear("wall seconds").including([0.0]),
        series,
    );
    chart.subtitle = results.workload();
    chart.caption = format!("Points: median over seeds and repetitions. {}", bars(all));
    chart.overlays = overlays;
    Ok([Block::figure("time-against-spp", chart)].into_iter().chain(findings).collect())
}
