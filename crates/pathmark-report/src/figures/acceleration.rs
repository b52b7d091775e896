//! The gain of a hierarchy: time per ray against the number of primitives, and the gain against samples per pixel.

use crate::prelude::*;
use crate::scene::ACCELERATORS;

/// Rows by a number (of primitives or samples), then by accelerator.
type Places<'a> = BTreeMap<u64, BTreeMap<&'a str, Vec<&'a Row>>>;

/// An accelerator's gains by that number: how many times as long the yardstick takes.
type Gains = Vec<(u64, Ratio)>;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let yardstick = yardstick(results, "acceleration", "none")?;
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
    let hierarchies = || accelerators.iter().copied().filter(|(_, name)| *name != yardstick);
    let mut of_sizes = gains(&sizes, &yardstick, results.stopping())?;
    blocks.extend(against_primitives(results, &sizes, &accelerators, fastest(&of_sizes)));
    for (_, name) in hierarchies() {
        blocks.extend(crossover(name, &of_sizes.remove(name).unwrap_or_default()));
    }
    let mut of_samples = gains(&samples, &yardstick, results.stopping())?;
    let gains = hierarchies().map(|(place, name)| (place, name, of_samples.remove(name).unwrap_or_default()));
    blocks.extend(against_spp(results, &samples, &gains.collect::<Vec<_>>()));
    for (_, name) in hierarchies() {
        blocks.extend(marginal(&others, &yardstick, name, results.stopping())?);
    }
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
    let ranked = of_sizes.iter().flat_map(|(name, gains)| {
        gains.iter().filter(|(_, gain)| !gain.is_partial).map(move |(count, gain)| (*name, *count, *gain))
    });
    let most = ranked.clone().map(|(_, count, _)| count).max()?;
    let largest = ranked.filter(|(_, count, _)| *count == most).map(|(name, _, gain)| (name, gain));
    let (name, gain) = titles::largest_above_1(largest)?;
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
fn gains<'a>(places: &Places<'a>, yardstick: &str, stopping: Stopping) -> Result<BTreeMap<&'a str, Gains>> {
    let mut cells = Vec::new();
    for (place, rows) in places {
        for (name, own) in rows.iter().filter(|(name, _)| **name != yardstick) {
            let base = rows.get(yardstick).into_iter().flatten().copied();
            let gains = ratios(base, own.iter().copied(), any_accelerator, |row| row.makespan_s)?;
            cells.push(((*name, *place), gains));
        }
    }
    let found = with_intervals(along(cells, |(name, _)| *name, stopping)).into_iter();
    Ok(gathered(found.map(|((name, place), gain)| (name, (place, gain)))))
}

/// A finding: the number of primitives from which a hierarchy is faster, and its gain in the largest scene that was
/// also rendered without it.
fn crossover(name: &str, gains: &Gains) -> Option<Block> {
    let ranked = || gains.iter().filter(|(_, gain)| !gain.is_partial);
    let (most, largest) = ranked().next_back()?;
    let slower = ranked().rev().find(|(_, gain)| gain.interval.low <= 1.0);
    let faster = ranked().find(|(count, _)| slower.is_none_or(|(slower, _)| count > slower));
    let from = match (slower, faster) {
        (None, Some((count, _))) => {
            format!("is faster than testing every sphere from the smallest number on, {count}")
        }
        (Some((slower, _)), Some((count, _))) => {
            format!(
                "is faster than testing every sphere from {count} spheres on (the interval lies above 1), and at {slower} that is not certain"
            )
        }
        (_, None) => "is at no number faster than testing every sphere by an interval that lies above 1".to_string(),
    };
    Some(Block::finding(format!(
        "{name} {from}; at {most} spheres it is {:.1} times as fast, {}.",
        largest.value,
        with_level(&largest.interval, 1)
    )))
}

/// The gain at each number of samples, in a scene that is not generated. A gain that does not depend on the samples
/// lies in every interval.
fn against_spp(results: &Results, samples: &Places<'_>, gains: &[(usize, &str, Gains)]) -> Vec<Block> {
    if gains.iter().all(|(.., gains)| gains.is_empty()) {
        return Vec::new();
    }
    let point = |(spp, gain): &(u64, Ratio)| Estimated::from(*gain).above(*spp as f64);
    let series = gains
        .iter()
        .map(|(place, name, gains)| Series::new(*name, Look::nth(*place), gains.iter().map(point).collect()));
    let largest = gains.iter().flat_map(|(_, name, gains)| gains.iter().map(move |(_, gain)| (*name, *gain)));
    let result = titles::largest_above_1(largest).and_then(|(name, gain)| {
        Some(format!("{name} renders up to {} times as fast as without a hierarchy", titles::told(gain)?))
    });
    let mut chart = LineChart::new(
        Title::new("Gain of a hierarchy against samples per pixel").with_result(result),
        Axis::log("samples per pixel").ticks_at(samples.keys().map(|spp| *spp as f64)),
        Axis::linear("time without / time with").including([1.0]),
        series.collect(),
    );
    let first = samples.values().flat_map(BTreeMap::values).flatten().next();
    let image = first.map_or_else(String::new, |row| format!("{}, {}x{}, ", row.scene, row.width, row.height));
    chart.subtitle = format!("{image}{}", results.run.machine.line());
    chart.caption = ratio_bars(gains.iter().flat_map(|(.., gains)| gains).map(|(_, gain)| *gain));
    chart.dodge = 4.0;
    let finding = |(_, name, gains): &(usize, &str, Gains)| {
        let gains: Vec<_> = gains.iter().filter(|(_, gain)| !gain.is_partial).collect();
        let low = gains.iter().map(|(_, gain)| gain.interval.low).fold(0.0, f64::max);
        let high = gains.iter().map(|(_, gain)| gain.interval.high).fold(f64::INFINITY, f64::min);
        let listed: Vec<String> = gains.iter().map(|(spp, gain)| format!("{:.2} at {spp}", gain.value)).collect();
        let verdict = if low <= high {
            format!("factors from {low:.2} to {high:.2} lie in every interval, so no dependence on the samples is seen")
        } else {
            "no factor lies in every interval".to_string()
        };
        Block::finding(format!(
            "Times without a hierarchy over times with {name}, by samples per pixel: {}; {verdict}.",
            listed.join(", ")
        ))
    };
    let findings = gains.iter().filter(|(.., gains)| gains.iter().any(|(_, gain)| !gain.is_partial)).map(finding);
    [Block::figure("acceleration-spp", chart)].into_iter().chain(findings).collect()
}

/// How many times as long the yardstick takes for each further sample. A difference of two times contains no fixed
/// cost, so a fixed cost cannot bend this factor as it bends the gain at few samples.
fn marginal(rows: &[&Row], yardstick: &str, name: &str, stopping: Stopping) -> Result<Vec<Block>> {
    let any_samples: Forget = |image, schedule| {
        any_accelerator(image, schedule);
        image.spp = 0;
    };
    let by_size = group(rows.iter().copied(), |row| (row.width, row.height));
    let mut findings = Vec::new();
    for ((width, height), rows) in by_size {
        let spp: BTreeSet<u32> = rows.iter().map(|row| row.spp).collect();
        let Some((least, most)) = spp.first().zip(spp.last()).filter(|(least, most)| least < most) else { continue };
        let seconds = |name: &str, spp: u32| {
            let own = rows.iter().copied().filter(|row| row.accelerator == name && row.spp == spp);
            Repeats::of(own, any_samples, |row| row.makespan_s)
        };
        let further = |name: &str| -> Result<Repeats> { Ok(seconds(name, *most)?.minus(&seconds(name, *least)?)) };
        let Some(ratio) = further(yardstick)?.over(&further(name)?).median(stopping) else { continue };
        let interval = ratio.interval.map_or_else(String::new, |interval| format!(", {}", with_level(&interval, 2)));
        findings.push(Block::finding(format!(
            "For each sample from {least} to {most} at {width}x{height}, {yardstick} takes {:.2} times as long as {name}{interval}: \
             differences of times, in which a fixed cost has no part.",
            ratio.value
        )));
    }
    Ok(findings)
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
