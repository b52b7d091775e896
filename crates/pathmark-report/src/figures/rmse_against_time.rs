//! The cost of accuracy in time: error against seconds, a panel for each scene and a line for each way to render it. All
//! schedules of one spp render the same image with the same error; a better schedule moves the line to the left.
//!
//! The units of an error are seeds, those of a time are processes. A price is the place where a line crosses an error; it
//! is interpolated between measured points and never extrapolated.

use crate::analysis::jackknife::Curve as ErrorCurve;
use crate::analysis::measured_price::{Crossing, MeasuredPrice, Timed};
use crate::contenders::{GOALS, curves_of_seeds, one_per_seed};
use crate::plot::Panels;
use crate::prelude::*;

/// Scene and size: times in others are not compared with its times.
type Setting<'a> = (&'a str, u32, u32);

/// A way to render a scene.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
struct Renderer<'a> {
    setting: Setting<'a>,
    /// The properties of its images that differ within the scene.
    image: String,
    schedule: &'a Schedule,
}

impl<'a> Renderer<'a> {
    fn of(results: &Results, row: &'a Row) -> Self {
        let setting = (row.scene.as_str(), row.width, row.height);
        Self { setting, image: results.series_name_in_scene(row), schedule: &row.schedule }
    }

    fn name(&self) -> String {
        joined([self.image.clone(), self.schedule.label()])
    }

    /// The property that dashes stand for.
    fn threads(&self) -> usize {
        self.schedule.key.threads
    }
}

struct Line<'a> {
    of: Renderer<'a>,
    points: Vec<MeasuredPoint>,
    /// The error curve of each seed.
    seeds: Vec<ErrorCurve>,
}

struct MeasuredPoint {
    spp: u32,
    seconds: Estimated,
    rmse: Estimated,
}

impl MeasuredPoint {
    fn point(&self) -> Point {
        let at = Point::new(self.seconds.value, self.rmse.value).with_x(self.seconds.bar()).with_y(self.rmse.bar());
        Point { hollow: self.seconds.is_partial, ..at }
    }
}

impl Line<'_> {
    fn price(&self, goal: f64) -> Option<MeasuredPrice> {
        let times = self.points.iter().filter(|point| !point.seconds.is_partial).map(|point| Timed {
            spp: f64::from(point.spp),
            seconds: point.seconds.value,
            interval: point.seconds.interval.filter(|interval| interval.level >= LEVEL),
        });
        MeasuredPrice::of(&self.seeds, &times.collect::<Vec<Timed>>(), goal)
    }

    /// Why it has no price, in words.
    fn without_price(&self) -> String {
        let has_one_seed = (self.seeds.len() == 1).then_some("one seed");
        let is_partial = self.points.iter().all(|point| point.seconds.is_partial);
        let reasons = [has_one_seed, is_partial.then_some("fewer processes than other lines")];
        let known = joined(reasons.into_iter().flatten().map(str::to_string));
        if known.is_empty() { "no error of every seed with a time".to_string() } else { known }
    }

    /// The factor on the seconds that halves the error, from the line's ends.
    fn cost_of_half(&self) -> Option<f64> {
        let (first, last) = (self.points.first()?, self.points.last()?);
        let octaves = libm::log2(first.rmse.value / last.rmse.value);
        let longer = libm::log2(last.seconds.value / first.seconds.value);
        Some(libm::exp2(longer / octaves)).filter(|factor| octaves > 0.5 && factor.is_finite())
    }
}

/// The lines with an error, by scene and name.
fn lines(results: &Results) -> Vec<Line<'_>> {
    let with_error = results.rows().filter(|row| row.mse.is_some());
    let groups = group(with_error, |row| Renderer::of(results, row));
    let cells = groups.iter().flat_map(|(of, rows)| {
        let by_spp = group(rows.iter().copied(), |row| row.spp).into_iter();
        by_spp.map(move |(spp, rows)| {
            let rmse = Estimated::rmse(&one_per_seed(&rows, |row| row.mse));
            ((of, spp, rmse), Repeats::of_rows(rows, |row| row.rendering_s()))
        })
    });
    let points = along(cells, |(of, ..)| *of, results.stopping()).into_iter();
    let points = points.filter(|((.., rmse), _)| rmse.value > 0.0);
    let points = gathered(points.map(|((of, spp, rmse), seconds)| (of, MeasuredPoint { spp, seconds, rmse })));
    let seeds = |of| curves_of_seeds(&groups[of]).into_iter().map(|(curve, _)| curve).collect();
    points.into_iter().map(|(of, points)| Line { of: of.clone(), points, seeds: seeds(of) }).collect()
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let lines = lines(results);
    let by_setting = gathered(lines.iter().map(|line| (line.of.setting, line)));
    let Some((main, _)) = by_setting.iter().rev().max_by_key(|(_, lines)| lines.len()) else {
        let text = "There is no error against time: it takes errors against references.";
        return Ok(vec![Block::notice(text)]);
    };
    let of_image: BTreeSet<(Setting<'_>, &str, usize)> =
        lines.iter().map(|line| (line.of.setting, line.of.image.as_str(), line.of.threads())).collect();
    // Where dashes tell the schedules of an image apart, they have one colour.
    let is_by_image = of_image.len() == lines.len();
    let colour = |line: &Line<'_>| {
        let schedule = if is_by_image { "" } else { line.of.schedule.name.as_str() };
        (line.of.image.clone(), schedule.to_string())
    };
    let colours: BTreeSet<(String, String)> = lines.iter().map(colour).collect();
    let dashes: BTreeSet<usize> = lines.iter().map(|line| line.of.threads()).collect();
    let series = |line: &&Line<'_>| {
        let dash = dashes.iter().position(|threads| *threads == line.of.threads()).unwrap_or(0);
        let colour = colours.iter().position(|own| *own == colour(line)).unwrap_or(0);
        Series::new(line.of.name(), Look::of(colour, dash), line.points.iter().map(MeasuredPoint::point).collect())
    };
    let chart = |lines: &[&Line<'_>]| {
        let axes = (Axis::log("wall seconds"), Axis::log("RMSE, linear radiance"));
        LineChart::new("", axes.0, axes.1, lines.iter().map(series).collect())
    };
    let words = |line: &&&Line<'_>| {
        let word = |point: &MeasuredPoint| (point.point(), point.spp.to_string());
        line.points.iter().map(word).collect::<Vec<_>>()
    };
    let slowest = |lines: &[&Line<'_>]| {
        let end = |line: &Line<'_>| line.points.first().map_or(0.0, |point| point.rmse.value * point.seconds.value);
        lines.iter().max_by(|a, b| end(a).total_cmp(&end(b))).map(|line| words(&line)).unwrap_or_default()
    };
    let shown = &by_setting[main];
    let seeds = lines.iter().flat_map(|line| line.points.iter().filter_map(|point| point.rmse.count));
    let seeds: BTreeSet<usize> = seeds.collect();
    let seeds = seeds.first().map_or_else(String::new, |least| counted(*least, "seed"));
    let first = LineChart {
        title: Title::new("Error against seconds, a line for each schedule").with_result(result(shown)),
        subtitle: format!("{}, {}x{}, {}", main.0, main.1, main.2, results.run.machine.line()),
        caption: format!(
            "Numbers beside points: samples per pixel. Vertical: RMSE over seeds, at least {seeds}, 95 % confidence. Horizontal: time over processes. {}",
            bars(lines.iter().flat_map(|line| line.points.iter().map(|point| point.seconds)))
        ),
        words: slowest(shown),
        ..chart(shown)
    };
    let others = by_setting.iter().filter(|(setting, _)| *setting != main);
    let others = others.map(|((scene, width, height), lines)| LineChart {
        title: format!("{scene}, {width}x{height}").into(),
        ..chart(lines)
    });
    let others: Vec<LineChart> = others.collect();
    let figure = if others.is_empty() {
        Block::figure("rmse-against-time", first)
    } else {
        Block::figure("rmse-against-time", Panels { main: first, others })
    };
    let findings = findings(&by_setting[main]).into_iter().flatten();
    Ok([figure].into_iter().chain(findings).chain([prices(&lines), points(&lines)]).collect())
}

/// The result in the scene with the most lines: the factor on the seconds that halves the error.
fn result(lines: &[&Line<'_>]) -> Option<String> {
    let mut factors: Vec<f64> = lines.iter().filter_map(|line| line.cost_of_half()).collect();
    factors.sort_by(f64::total_cmp);
    let scene = lines.first().map_or("", |line| line.of.setting.0);
    Some(match factors.as_slice() {
        [] => return None,
        [least, .., most] if format!("{least:.1}") != format!("{most:.1}") => {
            format!("Half the error costs {least:.1} to {most:.1} times the seconds: {scene}")
        }
        [factor, ..] => format!("Half the error costs {factor:.1} times the seconds: {scene}"),
    })
}

/// Compares the prices of the smallest goal that most lines of a scene have reached.
fn findings(lines: &[&Line<'_>]) -> Option<[Block; 2]> {
    let measured = |goal: f64| {
        let price = |line: &&Line<'_>| match line.price(goal) {
            Some(MeasuredPrice::Between(found)) => Some((line.of.name(), found)),
            _ => None,
        };
        (goal, lines.iter().filter_map(price).collect::<Vec<_>>())
    };
    let falling = GOALS.into_iter().map(measured);
    let (goal, found) = falling.max_by(|a, b| a.1.len().cmp(&b.1.len()).then(b.0.total_cmp(&a.0)))?;
    let cheapest = found.iter().min_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds))?;
    let most_expensive = found.iter().max_by(|a, b| a.1.seconds.total_cmp(&b.1.seconds))?;
    let told = |(name, found): &(String, Crossing)| {
        let interval = found.interval.map_or_else(String::new, |interval| format!(" ({})", with_level(&interval, 3)));
        format!("{:.3} s{interval} with {name}", found.seconds)
    };
    let (scene, ..) = lines.first()?.of.setting;
    let (least, most) = (cheapest.1.interval, most_expensive.1.interval);
    let (is_told, text, finding) = if found.len() == 1 {
        let costs = format!("an RMSE of {goal} costs {}", told(cheapest));
        (least.is_some(), format!("On {scene}, {costs}."), format!("{scene}: {costs}, measured."))
    } else {
        let [low, high] = [told(cheapest), told(most_expensive)];
        (
            least.zip(most).is_some_and(|(least, most)| least.high < most.low),
            format!("An RMSE of {goal} on {scene} costs {high}, and {low}."),
            format!("{scene}: an RMSE of {goal} costs {low} and {high}, both measured."),
        )
    };
    Some([Block::Answer { text, stem: "rmse-against-time", is_told }, Block::finding(finding)])
}

/// The price of each goal along each line.
fn prices(lines: &[Line<'_>]) -> Block {
    let all = lines.iter().flat_map(|line| GOALS.map(|goal| (line, goal, line.price(goal))));
    let seconds = |price: &Option<MeasuredPrice>| match price {
        Some(MeasuredPrice::Between(found)) => Some(Estimated::of(found.seconds, found.interval)),
        _ => None,
    };
    let place = |line: &Line<'_>, price: &Option<MeasuredPrice>| match price {
        Some(MeasuredPrice::Between(Crossing { between: [low, high], .. })) => format!("between {low} and {high} spp"),
        Some(MeasuredPrice::BeforeFirst(at)) => {
            format!("not measured: reached before {} spp, {:.4} s", at.spp, at.seconds)
        }
        Some(MeasuredPrice::BeyondLast(at)) => {
            format!("not measured: not reached at {} spp, {:.4} s", at.spp, at.seconds)
        }
        None => format!("not measured: {}", line.without_price()),
    };
    Block::table("accuracy-prices", "Seconds to an error, interpolated between measured points", all)
        .column("scene", |(line, ..)| line.of.setting.0.to_string())
        .column("renderer", |(line, ..)| line.of.name())
        .number("RMSE", Significant(3), |(_, goal, _)| *goal)
        .estimated("seconds", Significant(4), |(.., price)| seconds(price))
        .number("seeds", Decimals(0), |(line, ..)| line.seeds.len() as f64)
        .column("measured", |(line, _, price)| place(line, price))
        .end()
}

fn points(lines: &[Line<'_>]) -> Block {
    let all = lines.iter().flat_map(|line| line.points.iter().map(move |point| (line, point)));
    let count = |told: &Estimated| told.count.map(|count| count as f64);
    Block::table("rmse-against-time", "Error and time of each point", all)
        .column("scene", |(line, _)| line.of.setting.0.to_string())
        .column("schedule", |(line, _)| line.of.name())
        .column("spp", |(_, point)| point.spp.to_string())
        .estimated("seconds", Decimals(4), |(_, point)| point.seconds)
        .number("processes", Decimals(0), |(_, point)| count(&point.seconds))
        .estimated("RMSE, linear", Decimals(5), |(_, point)| point.rmse)
        .number("seeds", Decimals(0), |(_, point)| count(&point.rmse))
        .number("MSE x seconds", Significant(4), |(_, point)| point.rmse.value * point.rmse.value * point.seconds.value)
        .end()
}

#[cfg(test)]
mod tests {
    use crate::block::Block;
    use crate::figures::blocks;
    use crate::measure::Record;
    use crate::tests::{results, row, svg, table};

    /// RMSE = .6 / sqrt(n) and t = .02 n on one thread, half of that on two: an RMSE of .1 takes 36 samples, and errors
    /// below .6 / sqrt(64) were not reached.
    fn closed_form() -> Vec<Record> {
        let mut rows = Vec::new();
        for (spp, seed) in [8, 16, 32, 64].into_iter().flat_map(|spp| (1..=9_u32).map(move |seed| (spp, seed))) {
            // Seeds from 4 % below to 4 % above.
            let factor = 1.0 + 0.01 * (f64::from(seed) - 5.0);
            let (mse, seconds) = (0.36 * factor / f64::from(spp), 0.02 * f64::from(spp));
            let serial = Record { spp, seed: seed.into(), mse: Some(mse), makespan_s: Some(seconds), ..row() };
            let parallel =
                Record { strategy: "pool".to_string(), threads: 2, makespan_s: Some(0.5 * seconds), ..serial.clone() };
            let elsewhere = Record { scene: "sky".to_string(), scene_hash: "1".to_string(), ..serial.clone() };
            rows.extend([serial, parallel, elsewhere]);
        }
        rows
    }

    #[test]
    fn one_renderer_is_not_compared_with_itself() {
        let alone = closed_form().into_iter().filter(|row| row.threads == 1 && row.scene == "cornell");
        let blocks = blocks(&results(&["rmse-against-time"], "", alone.collect()).unwrap()).unwrap();
        let findings: Vec<&str> = blocks.iter().filter_map(Block::as_finding).collect();
        let [only] = &findings[..] else { panic!("{findings:?}") };
        assert!(only.starts_with("cornell: an RMSE of ") && only.ends_with(", measured."), "{only}");
        assert_eq!(only.matches(" s (").count(), 1, "{only}");
    }

    /// Serial runs of one of nine seeds, in one of nine processes: their times are not compared with the others'.
    #[test]
    fn a_line_without_prices_tells_why() {
        let mut rows = closed_form();
        rows.retain(|row| row.threads == 2 || row.seed == 1);
        for row in &mut rows {
            row.repetition = row.seed as u32;
        }
        let results = results(&["rmse-against-time"], "", rows).unwrap();
        let prices: Vec<Vec<String>> = table(&blocks(&results).unwrap()).rows().collect();
        let serial = prices.iter().find(|row| row[0] == "cornell" && row[1].contains("serial")).unwrap();
        assert_eq!(serial[5], "not measured: one seed, fewer processes than other lines");
    }

    #[test]
    fn prices_are_interpolated_and_never_extrapolated() {
        let results = results(&["rmse-against-time"], "", closed_form()).unwrap();
        let blocks = blocks(&results).unwrap();
        let prices: Vec<Vec<String>> = table(&blocks).rows().collect();
        let of = |scene: &str, renderer: &str, goal: &str| {
            let found = prices.iter().find(|row| row[0] == scene && row[1].contains(renderer) && row[2] == goal);
            found.unwrap_or_else(|| panic!("{scene} {renderer} {goal}: {prices:?}"))
        };
        for (renderer, seconds) in [("serial", 0.72), ("pool", 0.36)] {
            let own = of("cornell", renderer, "0.1");
            let value: f64 = own[3].split(',').next().unwrap().parse().unwrap();
            assert!((value / seconds - 1.0).abs() < 2e-3, "{own:?}");
            assert!(own[3].contains("to") && own[4] == "9" && own[5] == "between 32 and 64 spp", "{own:?}");
            let beyond = of("cornell", renderer, "0.05");
            assert!(beyond[5].starts_with("not measured: not reached at 64 spp"), "{beyond:?}");
        }
        let figure = svg(&blocks, "rmse-against-time");
        assert!(figure.contains("Half the error costs 4.0 times the seconds: cornell"));
        // Both scenes have a panel, and the points of one line tell their samples.
        assert!(figure.contains("sky, 8x6") && figure.contains(">16</text>") && figure.contains(">64</text>"));
    }
}
