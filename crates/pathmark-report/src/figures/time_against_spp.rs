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
    let (mut overlays, mut fits, mut series, mut all) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
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
            let slope = fit.slope.value;
            let curve = Curve::Line { intercept: fit.intercept.value, slope };
            overlays.push(Overlay::fit(format!("fit: {:.2} ms per spp", slope * 1e3), curve, series.len()));
            fits.push(Fit { name: name.clone(), slope: fit.slope, besides: fit.intercept, exponent: power.slope });
        }
        series.push(Series::new(name, Look::nth(series.len()), points).scattered());
    }
    let ticks = || results.rows().map(|row| f64::from(row.spp));
    let axis = || Axis::log("samples per pixel").ticks_at(ticks());
    let linear = series.first().and_then(|series| series.points.last());
    let linear = linear.and_then(|last| Curve::power_through((last.x, last.y), 1.0));
    overlays.extend(linear.map(|curve| Overlay::guide("in proportion to the samples", curve)));
    let title = Title::new("Time against samples per pixel").with_result(result(&fits));
    let mut chart = LineChart::new(title, axis(), Axis::log("wall seconds"), series);
    chart.subtitle = results.workload();
    chart.caption = format!("Over seeds and repetitions. {}", bars(all));
    chart.overlays = overlays;
    let mut blocks = vec![Block::figure("time-against-spp", chart)];
    let known: Vec<Estimated> = shares.iter().flat_map(|(_, points)| points).map(|(_, told)| *told).collect();
    if !known.is_empty() {
        let points =
            |points: Vec<(u32, Estimated)>| points.into_iter().map(|(spp, told)| told.above(spp.into())).collect();
        let longest = titles::largest_above_1(
            shares.iter().flat_map(|(_, own)| own).filter_map(|(spp, told)| Some((*spp, Ratio::of(*told)?))),
        );
        // The fit of all numbers of samples may see a departure that none of them shows alone.
        let none = if fits.iter().any(Fit::departs) {
            "No number of samples shows it alone, but time departs from a proportion to the samples"
        } else {
            "No time per sample is told apart from that of the longest renders"
        };
        let result = longest.map_or_else(
            || none.to_string(),
            |(spp, ratio)| {
                let longer = titles::longer(ratio.value);
                format!("Short renders pay for their start: at {spp} samples per pixel a sample takes {longer}")
            },
        );
        let series = Series::by_name(shares.into_iter().map(|(name, own)| (name, points(own))));
        let y = Axis::linear("seconds of a sample / those at the most samples").including([0.95, 1.05]);
        let title = Title::new("Is time in proportion to samples?").with_result(Some(result));
        let mut chart = LineChart::new(title, axis(), y, series);
        chart.subtitle = results.workload();
        chart.caption = format!("Ratios within a seed and a repetition. {}", bars(known));
        chart.overlays = vec![Overlay::guide("in proportion", Curve::Line { intercept: 1.0, slope: 0.0 })];
        chart.dodge = 4.0;
        blocks.push(Block::figure("time-per-sample", chart));
    }
    let table = (!fits.is_empty()).then(|| table(&fits));
    Ok(blocks.into_iter().chain(finding(&fits)).chain(table).collect())
}

/// A line through the times of an image, in seconds, and the exponent of time against samples per pixel.
struct Fit {
    name: String,
    slope: Estimate,
    besides: Estimate,
    exponent: Estimate,
}

impl Fit {
    fn departs(&self) -> bool {
        !self.exponent.interval.contains(1.0)
    }
}

/// The image whose time departs most from a proportion; only of those that depart, if some do.
fn furthest(fits: &[Fit]) -> Option<&Fit> {
    // Of exponents that differ by rounding only, the last counts.
    let off = |fit: &Fit| (fit.departs(), ((fit.exponent.value - 1.0).abs() * 1e6).round() as u64);
    fits.iter().max_by_key(|fit| off(fit))
}

/// The result in a line.
fn result(fits: &[Fit]) -> Option<String> {
    let fit = furthest(fits)?;
    let of = if fits.len() > 1 { format!(" of {}", fit.name) } else { String::new() };
    Some(if fit.departs() {
        format!("The time{of} grows as samples to the power {:.3}", fit.exponent.value)
    } else {
        "Time grows in proportion to the samples: no departure is seen".to_string()
    })
}

fn finding(fits: &[Fit]) -> Option<Block> {
    let Fit { name, slope, besides, exponent } = furthest(fits)?;
    let departing = fits.iter().filter(|fit| fit.departs()).count();
    let of_all = match (fits.len(), departing) {
        (1, _) => String::new(),
        (all, 0) => format!(", the furthest of {all} from a proportion"),
        (all, some) => format!(", the furthest from a proportion, from which {some} of {all} depart"),
    };
    let verdict = if departing == 0 {
        "the interval contains 1: no departure from linear is seen"
    } else {
        "the interval does not contain 1"
    };
    let ms = |of: &Estimate, digits: usize| {
        let [value, low, high] = [of.value, of.interval.low, of.interval.high].map(|seconds| seconds * 1e3);
        (format!("{value:.digits$}"), format!("{low:.digits$} to {high:.digits$}"))
    };
    let ((slope, slope_interval), (besides, besides_interval)) = (ms(slope, 3), ms(besides, 1));
    Some(Block::finding(format!(
        "{name}{of_all}: {slope} ms per sample per pixel (95 % {slope_interval}) and {besides} ms besides ({besides_interval}); the exponent of time \
         against spp is {:.3} (95 % {:.3} to {:.3}); {verdict}.",
        exponent.value, exponent.interval.low, exponent.interval.high,
    )))
}

fn table(fits: &[Fit]) -> Block {
    let ms = |of: &Estimate| Estimated::from(*of).times(1e3);
    Block::table("time-fits", "Time against samples per pixel: fitted lines", fits)
        .column("image", |fit| fit.name.clone())
        .estimated("ms per sample per pixel", Decimals(3), |fit| ms(&fit.slope))
        .estimated("ms besides", Decimals(1), |fit| ms(&fit.besides))
        .estimated("exponent", Decimals(3), |fit| Estimated::from(fit.exponent))
        .end()
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
