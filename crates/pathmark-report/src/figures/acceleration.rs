//! The gain of a hierarchy: time per ray against the number of primitives, and the gain against samples per pixel.

use crate::prelude::*;
use crate::scene::ACCELERATORS;
use crate::words::with_interval;

/// The accelerator that the others are compared with.
const YARDSTICK: &str = "none";

/// Rows by a number (of primitives or samples), then by accelerator.
type Places<'a> = BTreeMap<u64, BTreeMap<&'a str, Vec<&'a Row>>>;

/// An accelerator's gains by that number: how many times as long the yardstick takes.
type Gains = Vec<(u64, Ratio)>;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let names = results.by(|row| row.accelerator.as_str()).into_keys();
    let accelerators = in_table_order(names, ACCELERATORS.iter().map(|entry| entry.name));
    let (generated, others): (Vec<&Row>, Vec<&Row>) = results.rows().partition(|row| primitives(row).is_some());
    // Other generators distribute their primitives differently, so their times do not belong on the same line.
    let generators = group(generated, |row| row.scene.split(':').next().unwrap_or_default());
    let sizes = generators.into_values().map(|rows| places(rows, |row| primitives(row).unwrap_or_default()));
    let sizes = sizes.max_by_key(BTreeMap::len).unwrap_or_default();
    // A line must be of one image; take the one with the most numbers of samples.
    let images = group(others.iter().copied(), |row| (&row.scene, row.width, row.height)).into_values();
    let spp_of = |rows: &Vec<&Row>| rows.iter().map(|row| row.spp).collect::<BTreeSet<_>>().len();
    let of_one_image = images.rev().max_by_key(spp_of).unwrap_or_default();
    let samples = places(of_one_image, |row| u64::from(row.spp));
    let mut blocks = Vec::new();
    let of_sizes = gains(&sizes, results.stopping())?;
    blocks.extend(against_primitives(results, &sizes, &accelerators, fastest(&of_sizes)));
    blocks.extend(crossover(&of_sizes));
    let of_samples = gains(&samples, results.stopping())?;
    blocks.extend(against_spp(results, &samples, &accelerators, &of_samples));
    let further = further(&others, &accelerators, results.stopping())?;
    blocks.extend(marginal(&further));
    let spheres = listed(&of_sizes, |count| format!("{count} spheres"));
    let image = image(&samples);
    let of_spp = listed(&of_samples, |spp| joined([image.clone(), format!("{spp} spp")]));
    blocks.extend(gain_table(spheres.into_iter().chain(of_spp).chain(further).collect()));
    blocks.push(table(results, &accelerators));
    Ok(blocks)
}

fn places(rows: Vec<&Row>, place: impl Fn(&Row) -> u64) -> Places<'_> {
    let places = group(rows, place).into_iter();
    places.map(|(place, rows)| (place, group(rows, |row| row.accelerator.as_str()))).collect()
}

/// The number after the name of a scene that is generated in many sizes.
fn primitives(row: &Row) -> Option<u64> {
    row.scene.split_once(':')?.1.parse().ok()
}

fn ns_per_ray(row: &Row) -> Option<f64> {
    Some(row.makespan_s? * 1e9 / row.rays? as f64)
}

/// Clears the properties in which rows with and without a hierarchy differ.
fn any_accelerator(_: &mut ImageKey, schedule: &mut ScheduleKey) {
    schedule.accelerator.clear();
    schedule.effects.clear();
}

/// The result in a line: the accelerator with the largest gain in the largest scene.
fn fastest(of_sizes: &BTreeMap<&str, Gains>) -> Option<String> {
    let (most, gains) = at_most(&ranked(of_sizes))?;
    let (name, gain) = titles::largest_above_1(gains)?;
    Some(format!("At {most} spheres, {name} is {} times as fast as testing every sphere", titles::told(gain)?))
}

fn against_primitives(
    results: &Results,
    sizes: &Places<'_>,
    accelerators: &[(usize, &str)],
    result: Option<String>,
) -> Option<Block> {
    let first = sizes.values().next()?.values().next()?.first()?;
    let cells = sizes.iter().flat_map(|(count, by_name)| {
        let cell = |(name, rows): (&&'_ str, &Vec<&Row>)| {
            ((*count, (*name).to_string()), Repeats::of_rows(rows.iter().copied(), ns_per_ray))
        };
        by_name.iter().map(cell)
    });
    let times = along(cells, |(_, name)| name.clone(), results.stopping());
    let series = accelerators.iter().map(|(place, name)| {
        let own = times.iter().filter(|((_, of), _)| of == name);
        Series::new(*name, Look::nth(*place), own.map(|((count, _), time)| time.above(*count as f64)).collect())
    });
    let (x, y) = (Axis::log("spheres"), Axis::log("nanoseconds per ray"));
    let title = Title::new("Time per ray against the number of spheres").with_result(result);
    let mut chart = LineChart::new(title, x, y, series.collect());
    chart.subtitle = format!("balls filling the same share of a cube, {}", results.run.machine.line());
    let bars = bars(times.iter().map(|(_, time)| *time));
    chart.caption = format!("Repetitions of {}, shading and all. {bars}", first.estimator);
    Some(Block::figure("acceleration", chart))
}

/// The gains of each accelerator other than the yardstick.
fn gains<'a>(places: &Places<'a>, stopping: Stopping) -> Result<BTreeMap<&'a str, Gains>> {
    let mut cells = Vec::new();
    for (place, rows) in places {
        for (name, own) in rows.iter().filter(|(name, _)| **name != YARDSTICK) {
            let base = rows.get(YARDSTICK).into_iter().flatten().copied();
            let gains = ratios(base, own.iter().copied(), any_accelerator, |row| row.makespan_s)?;
            cells.push(((*name, *place), gains));
        }
    }
    let found = with_intervals(along(cells, |(name, _)| *name, stopping)).into_iter();
    Ok(gathered(found.map(|((name, place), gain)| (name, (place, gain)))))
}

/// The largest of some gains, with the names of those that are not told apart from it.
fn largest<'a>(gains: impl IntoIterator<Item = (&'a str, Ratio)>) -> Option<(&'a str, Ratio, String)> {
    let gains: Vec<(&str, Ratio)> = gains.into_iter().collect();
    let (name, most) = *gains.iter().max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let is_open = |gain: &Ratio| gain.interval.high >= most.interval.low;
    let open = gains.iter().filter(|(other, gain)| *other != name && is_open(gain));
    let open: Vec<&str> = open.map(|(other, _)| *other).collect();
    let remark = if open.is_empty() { String::new() } else { format!(", not told apart from {}", open.join(" and ")) };
    Some((name, most, remark))
}

/// The gains that are ranked, each with its accelerator and its number.
fn ranked<'a>(gains: &BTreeMap<&'a str, Gains>) -> Vec<(&'a str, u64, Ratio)> {
    let whole = |(name, own): (&&'a str, &Gains)| {
        let name = *name;
        let whole = own.iter().filter(|(_, gain)| !gain.is_partial);
        whole.map(move |(number, gain)| (name, *number, *gain)).collect::<Vec<_>>()
    };
    gains.iter().flat_map(whole).collect()
}

/// The largest number with gains, and these.
fn at_most<'a>(ranked: &[(&'a str, u64, Ratio)]) -> Option<(u64, Vec<(&'a str, Ratio)>)> {
    let most = ranked.iter().map(|(_, number, _)| *number).max()?;
    let own = ranked.iter().filter(|(_, number, _)| *number == most);
    Some((most, own.map(|(name, _, gain)| (*name, *gain)).collect()))
}

/// A finding: the largest gain in the largest scene that was also rendered without a hierarchy, and the number of spheres
/// from which on it is certain.
fn crossover(of_sizes: &BTreeMap<&str, Gains>) -> Option<Block> {
    let ranked = ranked(of_sizes);
    let (most, gains) = at_most(&ranked)?;
    let (name, gain, open) = largest(gains)?;
    let own = || ranked.iter().filter(|(other, ..)| *other == name);
    let slower = own().rev().find(|(_, _, gain)| gain.interval.low <= 1.0).map(|(_, count, gain)| (*count, *gain));
    let faster = own().map(|(_, count, _)| *count).find(|count| slower.is_none_or(|(slower, _)| *count > slower));
    let from = match (slower, faster) {
        (None, Some(count)) => format!("It is faster from the smallest number on, {count}."),
        (Some((slower, gain)), Some(count)) => {
            let there = if gain.interval.high < 1.0 { "it is slower" } else { "that is not certain" };
            format!("It is faster from {count} spheres on; at {slower} {there}.")
        }
        (_, None) => "At the largest number that is not certain.".to_string(),
    };
    Some(Block::finding(format!(
        "The best hierarchy at {most} spheres is {name}{open}: {} times as fast as testing every sphere. {from}",
        with_interval(gain.value, &gain.interval, 1)
    )))
}

/// Scene and size of an image that was rendered at several numbers of samples.
fn image(samples: &Places<'_>) -> String {
    let first = samples.values().flat_map(BTreeMap::values).flatten().next();
    first.map_or_else(String::new, |row| format!("{}, {}x{}", row.scene, row.width, row.height))
}

/// The gain at each number of samples, in a scene that is not generated. A gain that does not depend on the samples
/// lies in every interval.
fn against_spp(
    results: &Results,
    samples: &Places<'_>,
    accelerators: &[(usize, &str)],
    gains: &BTreeMap<&str, Gains>,
) -> Vec<Block> {
    if gains.values().all(Vec::is_empty) {
        return Vec::new();
    }
    let point = |(spp, gain): &(u64, Ratio)| Estimated::from(*gain).above(*spp as f64);
    let series = accelerators.iter().filter_map(|(place, name)| {
        Some(Series::new(*name, Look::nth(*place), gains.get(name)?.iter().map(point).collect()))
    });
    let ranked = ranked(gains);
    let result = titles::largest_above_1(ranked.iter().map(|(name, _, gain)| (*name, *gain)));
    let result = result.and_then(|(name, gain)| {
        Some(format!("{name} renders up to {} times as fast as without a hierarchy", titles::told(gain)?))
    });
    let mut chart = LineChart::new(
        Title::new("Gain of a hierarchy against samples per pixel").with_result(result),
        Axis::log("samples per pixel").ticks_at(samples.keys().map(|spp| *spp as f64)),
        Axis::linear("time without / time with").including([1.0]),
        series.collect(),
    );
    chart.subtitle = joined([image(samples), results.run.machine.line()]);
    chart.caption = ratio_bars(gains.values().flatten().map(|(_, gain)| *gain));
    chart.dodge = 4.0;
    let finding = at_most(&ranked).and_then(|(spp, gains)| {
        let (name, gain, open) = largest(gains)?;
        let own = || ranked.iter().filter(|(other, ..)| *other == name).map(|(.., gain)| gain.interval);
        let low = own().map(|interval| interval.low).fold(0.0, f64::max);
        let high = own().map(|interval| interval.high).fold(f64::INFINITY, f64::min);
        let verdict = if low <= high {
            format!("factors from {low:.2} to {high:.2} lie in its interval at every number of samples, so no dependence on the samples is seen")
        } else {
            "no factor lies in its interval at every number of samples, so the gain changes with them".to_string()
        };
        Some(Block::finding(format!(
            "The best hierarchy at {spp} samples per pixel is {name}{open}: {} times as fast as without a hierarchy; {verdict}.",
            with_interval(gain.value, &gain.interval, 2)
        )))
    });
    [Block::figure("acceleration-spp", chart)].into_iter().chain(finding).collect()
}

/// A gain over the yardstick, for the table.
struct Gain {
    workload: String,
    accelerator: String,
    told: Estimated,
}

/// The gains of a list in the order of their numbers.
fn listed(gains: &BTreeMap<&str, Gains>, workload: impl Fn(u64) -> String) -> Vec<Gain> {
    let all = gains.iter().flat_map(|(name, own)| own.iter().map(move |(number, gain)| (*number, *name, *gain)));
    let mut all: Vec<(u64, &str, Ratio)> = all.collect();
    all.sort_by_key(|(number, ..)| *number);
    let gain = |(number, name, gain): (u64, &str, Ratio)| Gain {
        workload: workload(number),
        accelerator: name.to_string(),
        told: gain.into(),
    };
    all.into_iter().map(gain).collect()
}

fn gain_table(gains: Vec<Gain>) -> Option<Block> {
    if gains.is_empty() {
        return None;
    }
    let partial = |told: &Estimated| if told.is_partial { "fewer repetitions than others: not comparable" } else { "" };
    let title = format!("How many times as long {YARDSTICK} takes");
    let table = Block::table("acceleration-gains", title, gains)
        .column("workload", |gain| gain.workload.clone())
        .column("accelerator", |gain| gain.accelerator.clone())
        .estimated(format!("time with {YARDSTICK} / time"), Decimals(2), |gain| gain.told)
        .column("remark", |gain| partial(&gain.told).to_string());
    Some(table.end())
}

/// How many times as long the yardstick takes for each further sample, the largest image last. A difference of two times
/// contains no fixed cost, so a fixed cost cannot bend this factor as it bends the gain at few samples.
fn further(rows: &[&Row], accelerators: &[(usize, &str)], stopping: Stopping) -> Result<Vec<Gain>> {
    let any_samples: Forget = |image, schedule| {
        any_accelerator(image, schedule);
        image.spp = 0;
    };
    let by_image = group(rows.iter().copied(), |row| (row.width, row.height, &row.scene));
    let mut found = Vec::new();
    for ((width, height, scene), rows) in by_image {
        let spp: BTreeSet<u32> = rows.iter().map(|row| row.spp).collect();
        let Some((least, most)) = spp.first().zip(spp.last()).filter(|(least, most)| least < most) else { continue };
        let seconds = |name: &str, spp: u32| {
            let own = rows.iter().copied().filter(|row| row.accelerator == name && row.spp == spp);
            Repeats::of(own, any_samples, |row| row.makespan_s)
        };
        let further = |name: &str| -> Result<Repeats> { Ok(seconds(name, *most)?.minus(&seconds(name, *least)?)) };
        let of_yardstick = further(YARDSTICK)?;
        for (_, name) in accelerators.iter().filter(|(_, name)| *name != YARDSTICK) {
            let told = of_yardstick.over(&further(name)?).median(stopping);
            // Renders that take no longer for more samples have no time of a further one.
            let Some(told) = told.filter(|told| told.value.is_finite()) else { continue };
            let workload = format!("{scene}, {width}x{height}, each sample from {least} to {most}");
            found.push(Gain { workload, accelerator: (*name).to_string(), told });
        }
    }
    Ok(found)
}

/// A finding about the further samples of the largest image.
fn marginal(further: &[Gain]) -> Option<Block> {
    let workload = &further.last()?.workload;
    let own = further.iter().filter(|gain| gain.workload == *workload);
    let own = own.filter_map(|gain| Some((gain.accelerator.as_str(), Ratio::of(gain.told)?)));
    let (name, gain, open) = largest(own)?;
    Some(Block::finding(format!(
        "{workload}: {YARDSTICK} takes {} times as long as {name}{open}. A difference of times contains no fixed cost.",
        with_interval(gain.value, &gain.interval, 2)
    )))
}

fn table(results: &Results, accelerators: &[(usize, &str)]) -> Block {
    let place = |name: &str| accelerators.iter().position(|(_, own)| *own == name);
    let kinds = results.by(|row| (primitives(row), &row.scene, place(&row.accelerator))).into_values();
    Block::table("acceleration-table", "What rays are tested against: medians over repetitions", kinds)
        .column("scene", |rows| rows[0].scene.clone())
        .column("accelerator", |rows| rows[0].accelerator.clone())
        .number("ns per ray", Decimals(0), |rows| typical(rows, ns_per_ray))
        .number("boxes per ray", Decimals(1), |rows| {
            typical(rows, |row| Some(row.box_tests? as f64 / row.rays? as f64))
        })
        .number("primitives per ray", Decimals(1), |rows| {
            typical(rows, |row| Some(row.primitive_tests? as f64 / row.rays? as f64))
        })
        .number("ms to build", Decimals(3), |rows| typical(rows, |row| Some(row.kernel_build_s? * 1e3)))
        .end()
}
