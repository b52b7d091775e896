//! The price of an effect: absent, compiled in but unused, used; and the gain of each scene from the profile that fits
//! it.

use super::effect_steps;
use crate::prelude::*;
use crate::scene::PROFILES;
use crate::titles::Sides;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The effects to price.
    price: Vec<Price>,
    /// Scenes that add effects one by one.
    steps: Vec<String>,
}

/// An effect, and the rows in which it is absent, compiled in but unused, and used.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Price {
    effect: String,
    absent: Kind,
    /// `None` if no kernel has the effect compiled in where the absent one has not.
    unused: Option<Kind>,
    used: Kind,
}

/// The properties that distinguish the kernels of rows.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kind {
    scene: String,
    profile: String,
    #[serde(default = "scalar")]
    kernel: String,
    /// Whether rays are tested against bounding boxes first.
    #[serde(default)]
    hierarchy: bool,
}

/// The kernel that has a version for each profile.
const SCALAR: &str = "scalar";

/// The profile that contains every effect.
const LARGEST: &str = "all";

fn scalar() -> String {
    SCALAR.to_string()
}

impl Kind {
    fn of(row: &Row) -> Self {
        let hierarchy = row.accelerator != "none";
        Self { scene: row.scene.clone(), profile: row.effects.clone(), kernel: kernel(row).to_string(), hierarchy }
    }
}

/// The kernel of a row. A row of the kernel that took its place counts for neither.
fn kernel(row: &Row) -> &str {
    if row.kernel_fallback.is_empty() { &row.kernel } else { "fallback" }
}

/// The rows of a kind.
struct Times {
    /// CPU seconds of a sample, without the properties in which kinds differ. Other processes on the machine disturb
    /// them less than wall time. Several rows of one repetition are averaged.
    sample_s: Repeats,
    rays: Option<f64>,
}

/// Keeps the setting, but neither the scene nor the choices that fit it, so that rows with and without an effect pair.
fn setting(image: &mut ImageKey, schedule: &mut ScheduleKey) {
    image.forget_scene();
    schedule.forget_kernel();
}

impl Times {
    fn of(rows: &[&Row]) -> Self {
        let sample_s = Repeats::means(rows.iter().copied(), setting, |row| Some(row.cpu_s()? / row.samples? as f64));
        let rays = rows.first().and_then(|row| Some(row.rays? as f64 / row.samples? as f64));
        Self { sample_s, rays }
    }

    fn nanoseconds(&self) -> Option<f64> {
        median(&self.sample_s.values().iter().map(|s| s * 1e9).collect::<Vec<f64>>())
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { price, steps } = options(&results.definition, "effects")?;
    let times: BTreeMap<Kind, Times> =
        results.by(Kind::of).into_iter().map(|(kind, r)| (kind, Times::of(&r))).collect();
    let mut blocks = Vec::new();
    for (kernel, stem, table) in
        [(SCALAR, "effects", "effects-table"), ("lanes", "effects-in-lanes", "effects-in-lanes-table")]
    {
        let own: Vec<&Price> = price.iter().filter(|price| price.absent.kernel == kernel).collect();
        blocks.extend(prices(results, &own, &times, (kernel, stem, table)));
    }
    blocks.extend(effect_steps::blocks(results, &steps)?);
    blocks.extend(scenes(results));
    if blocks.is_empty() {
        let text = "Nothing was run with and without an effect, so there is no price of one.";
        blocks.push(Block::notice(text));
    }
    Ok(blocks)
}

/// An effect's price, and the times that it is computed from.
struct Priced<'a> {
    price: &'a Price,
    absent: &'a Times,
    unused: Option<(&'a Kind, &'a Times, Ratio)>,
    used: (&'a Times, Ratio),
}

impl Priced<'_> {
    fn unused_ratio(&self) -> Option<Ratio> {
        self.unused.map(|(.., ratio)| ratio)
    }
}

fn prices(
    results: &Results,
    prices: &[&Price],
    times: &BTreeMap<Kind, Times>,
    (kernel, stem, table): (&str, &'static str, &'static str),
) -> Vec<Block> {
    let cells = prices.iter().enumerate().flat_map(|(index, price)| {
        let over = |kind: &Kind| Some(times.get(kind)?.sample_s.over(&times.get(&price.absent)?.sample_s));
        let kinds = price.unused.iter().chain([&price.used]);
        kinds.map(|kind| ((index, kind), over(kind).unwrap_or_default())).collect::<Vec<_>>()
    });
    let ratios: BTreeMap<(usize, &Kind), Ratio> = ratios_of_groups(cells, results.stopping()).into_iter().collect();
    let found = prices.iter().enumerate().filter_map(|(index, price)| {
        let of = |kind| Some((times.get(kind)?, *ratios.get(&(index, kind))?));
        let unused = price.unused.as_ref().and_then(|kind| of(kind).map(|(times, ratio)| (kind, times, ratio)));
        Some(Priced { price, absent: times.get(&price.absent)?, unused, used: of(&price.used)? })
    });
    let found: Vec<Priced<'_>> = found.collect();
    if found.is_empty() {
        return Vec::new();
    }
    // Several effects may share one kernel in which they are unused: its price is drawn once.
    let mut drawn = BTreeSet::new();
    let mut rows = Vec::new();
    for found in &found {
        let dot = |ratio: Ratio| Estimated::from(ratio).dot();
        let is_new = drawn.insert((&found.price.absent, found.unused.map(|(kind, ..)| kind)));
        let unused = found.unused_ratio().filter(|_| is_new);
        rows.push(DotRow::new(&found.price.effect, vec![unused.map(dot), Some(dot(found.used.1))]));
    }
    let axis = Axis::linear("processor time of a sample / without the effect").including([0.95, 1.05]);
    let title = Title::new(format!("The price of an effect, kernel {kernel}")).with_result(result(&found));
    let mut plot = DotPlot::new(title, axis, rows);
    plot = plot.grouped(["compiled in, unused", "used"]);
    plot.guides = vec![(1.0, "absent".to_string())];
    plot.subtitle = machine(results);
    plot.caption = format!(
        "{} A used effect is another image, with other paths. A kernel in which several effects are unused is drawn once.",
        ratio_bars(found.iter().flat_map(|found| found.unused_ratio().into_iter().chain([found.used.1]))),
    );
    let count = |ratio: Ratio| ratio.count.map(|count| count as f64);
    let place = |kind: &Kind| format!("{}, {}", kind.scene, kind.profile);
    let findings = generality(&found, stem).into_iter().flatten();
    let table = Block::table(table, format!("The price of an effect, kernel {kernel}"), &found)
        .column("effect", |found| found.price.effect.clone())
        .column("absent", |found| place(&found.price.absent))
        .number("ns per sample, absent", Decimals(0), |found| found.absent.nanoseconds())
        .number("rays per sample, absent", Decimals(2), |found| found.absent.rays)
        .column("unused: profile", |found| found.unused.map_or("", |(kind, ..)| &kind.profile).to_string())
        .number("ns per sample, unused", Decimals(0), |found| found.unused.and_then(|(_, own, _)| own.nanoseconds()))
        .estimated("ratio unused / absent", Decimals(3), |found| found.unused_ratio().map(Estimated::from))
        .column("used", |found| place(&found.price.used))
        .number("ns per sample, used", Decimals(0), |found| found.used.0.nanoseconds())
        .number("rays per sample, used", Decimals(2), |found| found.used.0.rays)
        .estimated("ratio used / absent", Decimals(3), |found| Estimated::from(found.used.1))
        .number("processes, unused", Decimals(0), |found| count(found.unused_ratio()?))
        .number("processes, used", Decimals(0), |found| count(found.used.1))
        .end();
    [Block::figure(stem, plot)].into_iter().chain(findings).chain([table]).collect()
}

/// The result in a line: the effect that costs most if it is compiled in but not used, or the most that one may cost.
fn result(found: &[Priced<'_>]) -> Option<String> {
    let ratios = || found.iter().filter_map(|found| Some((found.price.effect.as_str(), found.unused_ratio()?)));
    if let Some((effect, Ratio { value, interval, .. })) = titles::largest_above_1(ratios()) {
        let [value, low, high] = [value, interval.low, interval.high].map(|ratio| titles::percent(ratio - 1.0));
        return Some(format!("An unused effect costs up to {value} ({low} to {high}): {effect}"));
    }
    let most = ratios().map(|(_, ratio)| ratio.interval.high - 1.0).reduce(f64::max)?;
    let share = titles::percent(most);
    Some(if 100.0 * most <= 2.0 * MOST_PERCENT {
        format!("An unused effect costs at most {share}")
    } else {
        format!("This machine cannot tell the price of an unused effect: it is at most {share}")
    })
}

fn generality(found: &[Priced<'_>], stem: &'static str) -> Option<[Block; 2]> {
    let ratios = || found.iter().filter_map(|found| Some((found.price.effect.as_str(), found.unused_ratio()?)));
    let ranked = ratios().filter(|(_, ratio)| !ratio.is_partial);
    let (most, ratio) = ranked.max_by(|a, b| a.1.value.total_cmp(&b.1.value))?;
    let sides = Sides::of(ratios().map(|(_, ratio)| ratio));
    let verdict = match sides.above {
        0 => "None of them costs more than the noise".to_string(),
        above => format!("{above} of {} cost more than the noise", sides.count()),
    };
    let percent = Estimated::from(ratio).times(100.0);
    let (low, high) = percent.bar().unwrap_or_default();
    let text = format!(
        "An effect that the scene does not use costs up to {:.1} % ({:.1} to {:.1}; {most}) of the time if it is compiled in. An absent one costs nothing: it is not compiled in.",
        percent.value - 100.0,
        low - 100.0,
        high - 100.0,
    );
    let answer = Block::Answer { text, stem, is_told: high - low <= 2.0 * MOST_PERCENT };
    let finding = Block::finding(format!(
        "An effect that is compiled into the {} kernel but not used by the scene makes a sample take {} times as long at most ({most}). {verdict}.",
        found.first()?.price.absent.kernel,
        ratio.in_words(3),
    ));
    Some([answer, finding])
}

/// Half of the interval of a price in percent with which it counts as known.
const MOST_PERCENT: f64 = 2.0;

/// A scene under the profile that fits it and under the largest, and the ratio of their times.
struct Fit<'a> {
    scene: &'a str,
    profile: &'a str,
    fitting: Times,
    largest: Times,
    ratio: Ratio,
}

/// Compares the rows of each scene in the largest profile with those in the smallest other one.
fn fits<'a>(results: &'a Results) -> Vec<Fit<'a>> {
    let of_scalar = results.rows().filter(|row| kernel(row) == SCALAR);
    let groups = group(of_scalar, |row| (row.scene.as_str(), row.accelerator.as_str()));
    let of_scene = |((scene, _), rows): ((&'a str, &str), Vec<&'a Row>)| {
        let mut by_profile = gathered(rows.into_iter().map(|row| (row.effects.as_str(), row)));
        let all = Times::of(&by_profile.remove(LARGEST)?);
        let names = in_table_order(by_profile.keys().copied(), PROFILES.iter().map(|entry| entry.name));
        let (_, profile) = *names.first()?;
        let fitting = Times::of(by_profile.get(profile)?);
        let ratios = all.sample_s.over(&fitting.sample_s);
        Some(((scene, profile, fitting, all), ratios))
    };
    let mut fits: Vec<Fit<'_>> = ratios_of_groups(groups.into_iter().filter_map(of_scene), results.stopping())
        .into_iter()
        .map(|((scene, profile, fitting, largest), ratio)| Fit { scene, profile, fitting, largest, ratio })
        .collect();
    // One accelerator for each scene is enough: the first by name that has a ratio.
    fits.dedup_by(|later, first| later.scene == first.scene);
    fits.sort_by(|a, b| a.ratio.falling(&b.ratio));
    fits
}

fn scenes(results: &Results) -> Vec<Block> {
    let fits = fits(results);
    let Some(overall) = median(&fits.iter().map(|fit| fit.ratio.value).collect::<Vec<f64>>()) else {
        return Vec::new();
    };
    let rows = fits.iter().map(|fit| {
        DotRow::new(format!("{} ({})", fit.scene, fit.profile), vec![Some(Estimated::from(fit.ratio).dot())])
    });
    let axis =
        Axis::linear("processor time with every effect compiled in / with the fitting profile").including([0.95, 1.1]);
    let sides = Sides::of(fits.iter().map(|fit| fit.ratio));
    let result = match sides.above {
        0 => "No scene gains from the profile that fits it beyond the noise".to_string(),
        above if overall > 1.0 => format!(
            "With every effect compiled in, {above} of {} scenes take longer; the median takes {}",
            sides.count(),
            titles::longer(overall)
        ),
        above => format!("With every effect compiled in, {above} of {} scenes take longer", sides.count()),
    };
    let title = Title::new("What a fitting profile gains").with_result(Some(result));
    let mut plot = DotPlot::new(title, axis, rows.collect());
    plot.guides = vec![(1.0, "no gain".to_string())];
    plot.subtitle = machine(results);
    let bars = bars(fits.iter().map(|fit| fit.ratio));
    plot.caption = format!("Ratios within a repetition, same image. {bars}");
    let slower: Vec<&str> = fits.iter().filter(|fit| fit.ratio.interval.high < 1.0).map(|fit| fit.scene).collect();
    let faster = fits.iter().filter(|fit| fit.ratio.interval.low > 1.0).count();
    let never = if slower.is_empty() {
        "for none is it slower beyond the noise".to_string()
    } else {
        format!("beyond the noise it is slower for {}", slower.join(", "))
    };
    let finding = Block::finding(format!(
        "Of {} scenes the fitting profile renders {faster} faster than the largest profile beyond the noise; {never}. The largest one takes {overall:.3} times as long in the median.",
        fits.len(),
    ));
    let diffuse = fits.iter().find(|fit| fit.profile == "diffuse").map(|fit| {
        let verdict = match (fit.ratio.interval.low >= 1.1, fit.ratio.interval.high < 1.1) {
            (true, _) => "the fitting profile is at least 1.1 times as fast",
            (_, true) => "the fitting profile gains less than a tenth: the tests that it leaves out are predicted well",
            _ => "this run cannot tell whether that is more or less than 1.1",
        };
        Block::finding(format!(
            "Diffuse spheres alone ({}) take {} times as long with every effect compiled in: {verdict}.",
            fit.scene,
            fit.ratio.in_words(3)
        ))
    });
    let table = Block::table("profiles-table", "Every scene under the fitting and the largest profile", &fits)
        .column("scene", |fit| fit.scene.to_string())
        .column("fitting profile", |fit| fit.profile.to_string())
        .number("ns per sample", Decimals(0), |fit| fit.fitting.nanoseconds())
        .number("ns per sample with all effects", Decimals(0), |fit| fit.largest.nanoseconds())
        .estimated("ratio", Decimals(3), |fit| Estimated::from(fit.ratio))
        .end();
    [Block::figure("profiles", plot), finding].into_iter().chain(diffuse).chain([table]).collect()
}

fn machine(results: &Results) -> String {
    let schedule = |row: &Row| format!("{}, {}, {} spp, ", row.strategy, results.size(), row.spp);
    format!("{}{}", results.first().map_or_else(String::new, schedule), results.run.machine.cpu)
}
