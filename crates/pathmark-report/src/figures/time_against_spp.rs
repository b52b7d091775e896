//! Seconds against samples per pixel: a line of slope 1 on logarithmic axes if only sampling takes time, and the seconds
//! of a sample against those of the longest renders, which a line would leave at 1.

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
    let mut shares = Vec::new();
    for (name, rows) in lines {
        shares.push((name.clone(), per_sample(results, &rows)?));
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
    let ticks = || results.rows().map(|row| f64::from(row.spp));
    let axis = || Axis::log("samples per pixel").ticks_at(ticks());
    let linear = series.first().and_then(|series| series.points.last());
    let linear = linear.and_then(|last| Curve::power_through((last.x, last.y), 1.0));
    overlays.extend(linear.map(|curve| Overlay::guide("in proportion to the samples", curve)));
    let mut chart = LineChart::new("Time against samples per pixel", axis(), Axis::log("wall seconds"), series);
    chart.subtitle = results.workload();
    chart.caption = format!("Over seeds and repetitions. {}", bars(all));
    chart.overlays = overlays;
    let mut blocks = vec![Block::figure("time-against-spp", chart)];
    let known: Vec<Estimated> = shares.iter().flat_map(|(_, points)| points).map(|(_, told)| *told).collect();
    if !known.is_empty() {
        let points =
            |points: Vec<(u32, Estimated)>| points.into_iter().map(|(spp, told)| told.above(spp.into())).collect();
        let series = Series::by_name(shares.into_iter().map(|(name, own)| (name, points(own))));
        let y = Axis::linear("seconds of a sample / those at the most samples").including([0.95, 1.05]);
        let mut chart = LineChart::new("Is time in proportion to samples?", axis(), y, series);
        chart.subtitle = results.workload();
        chart.caption = format!("Ratios within a seed and a repetition. {}", bars(known));
        chart.overlays = vec![Overlay::guide("in proportion", Curve::Line { intercept: 1.0, slope: 0.0 })];
        chart.dodge = 4.0;
        blocks.push(Block::figure("time-per-sample", chart));
    }
    Ok(blocks.into_iter().chain(findings).collect())
}

/// The seconds of a sample over those at the most samples, for each smaller number of samples.
fn per_sample(results: &Results, rows: &[&Row]) -> Result<Vec<(u32, Estimated)>> {
    let by_spp = group(rows.iter().copied(), |row| row.spp);
    let Some((most, longest)) = by_spp.iter().next_back() else { return Ok(Vec::new()) };
    let any_spp: Forget = |image, _| image.spp = 0;
    let mut cells = Vec::new();
    for (spp, rows) in by_spp.iter().filter(|(spp, _)| *spp != most) {
        let seconds = |row: &Row| Some(row.makespan_s? / f64::from(row.spp));
        cells.push((*spp, ratios(rows.iter().copied(), longest.iter().copied(), any_spp, seconds)?));
    }
    Ok(along(cells, |_| (), results.stopping()))
}
