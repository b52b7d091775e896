//! Cost and gain of an approximation: light lost, noise and doubtful pixels by the value of one axis, against rows in
//! which the axis has its usual value.

use crate::plot::Dot;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
pub(super) struct Options {
    /// The axis that is varied: `epsilon`, `filter`, `clamp`, or `scene` for scenes that are variants of the usual one.
    axis: Option<Varied>,
    usual: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Varied {
    Epsilon,
    Filter,
    Clamp,
    Scene,
}

/// The value of an axis in an image.
type Value = fn(&ImageKey) -> &str;

impl Varied {
    /// Its name, its value in an image, and a function that clears it there.
    fn parts(self) -> (&'static str, Value, fn(&mut ImageKey)) {
        match self {
            Self::Epsilon => ("epsilon", |image| &image.epsilon, |image| image.epsilon.clear()),
            Self::Filter => ("filter", |image| &image.filter, |image| image.filter.clear()),
            Self::Clamp => ("clamp", |image| &image.clamp, |image| image.clamp.clear()),
            Self::Scene => {
                ("variant", |image| &image.scene, |image| (image.scene, image.scene_hash) = Default::default())
            }
        }
    }
}

/// Results for one value on one scene at one number of samples.
struct Cost {
    scene: String,
    value: String,
    spp: u32,
    /// Mean radiance over the usual value's, paired by seed.
    light: Estimated,
    rmse: Option<f64>,
    within: Option<f64>,
    black: Option<f64>,
    /// The black pixels less those with the usual value, as a share of the image, paired by seed.
    more_black: Option<Estimated>,
    fireflies: Option<Estimated>,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Options { axis, usual } = options(&results.definition, "bias")?;
    let (name, of, forget) = axis.unwrap_or(Varied::Epsilon).parts();
    let usual = usual.unwrap_or_else(|| "none".to_string());
    let mut costs = costs(results, of, forget, &usual);
    if costs.is_empty() {
        let text = format!("There is nothing to compare: it takes rows with and without {name}.");
        return Ok(vec![Block::notice(text)]);
    }
    let values = in_order(costs.iter().map(|cost| cost.value.clone()), &usual);
    let place = |cost: &Cost| values.iter().position(|value| *value == cost.value);
    costs.sort_by(|a, b| (&a.scene, place(a), a.spp).cmp(&(&b.scene, place(b), b.spp)));
    // The most samples show the bias with the least noise. The usual value does not count: it may have more samples.
    let mut most: BTreeMap<&str, u32> = BTreeMap::new();
    for cost in costs.iter().filter(|cost| cost.value != usual) {
        let spp = most.entry(&cost.scene).or_default();
        *spp = cost.spp.max(*spp);
    }
    let shown = Shown { results, name, usual: &usual, values: &values, most: &most, costs: &costs };
    let is_shown = |cost: &&Cost| cost.value != usual && Some(&cost.spp) == most.get(cost.scene.as_str());
    let worst = costs.iter().filter(is_shown).max_by(|a, b| {
        let off = |cost: &Cost| (cost.light.value - 1.0).abs();
        off(a).total_cmp(&off(b))
    });
    let mut blocks = vec![Block::figure("bias", shown.light(worst))];
    let meaning = "A firefly is brighter than the reference by more than 1, the display's white, in a channel.";
    blocks.extend(shown.share("fireflies", ["Fireflies", "fireflies", meaning], |cost| cost.fireflies));
    let (axis, meaning) = (format!("black pixels less those with {usual}"), "In a black pixel every channel is 0.");
    blocks.extend(shown.share("black-pixels", ["Black pixels", &axis, meaning], |cost| cost.more_black));
    let finding = worst.map(|cost| {
        Block::finding(format!(
            "At {} samples per pixel the light changes most with {name} {} on {}: to {:.2} % of what it is with {usual}{}.",
            cost.spp,
            cost.value,
            cost.scene,
            100.0 * cost.light.value,
            cost.light.bar().map_or_else(String::new, |(low, high)| format!(
                " (95 % {:.2} to {:.2})",
                100.0 * low,
                100.0 * high
            )),
        ))
    });
    let percent = |share: Option<f64>| share.map(|share| 100.0 * share);
    let table = Block::table("bias", format!("Light, noise and doubtful pixels by {name}"), &costs)
        .column("scene", |cost| cost.scene.clone())
        .column(name, |cost| cost.value.clone())
        .column("spp", |cost| cost.spp.to_string())
        .estimated("light, %", Decimals(3), |cost| cost.light.times(100.0))
        .number("RMSE", Decimals(5), |cost| cost.rmse)
        .number("pixels within 0.05 of the display, %", Decimals(2), |cost| percent(cost.within))
        .number("black pixels, %", Decimals(3), |cost| percent(cost.black))
        .estimated("fireflies in a million pixels", Decimals(0), |cost| cost.fireflies.map(|share| share.times(1e6)))
        .end();
    Ok(blocks.into_iter().chain(finding).chain([table]).collect())
}

/// Changes of the light below this many percent are rounding.
const ROUNDING: f64 = 1e-4;

/// The results that the plots show.
struct Shown<'a> {
    results: &'a Results,
    /// The axis.
    name: &'a str,
    usual: &'a str,
    values: &'a [String],
    /// The samples per pixel that are shown of each scene.
    most: &'a BTreeMap<&'a str, u32>,
    costs: &'a [Cost],
}

impl Shown<'_> {
    fn cost(&self, value: &str, scene: &str) -> Option<&Cost> {
        let spp = self.most.get(scene)?;
        self.costs.iter().find(|cost| cost.value == value && cost.scene == scene && cost.spp == *spp)
    }

    /// The change of the light in percent. Its axis is logarithmic, so that a hundredth of a percent and half of the
    /// light both have a place; lighter and darker are groups of their own.
    fn light(&self, worst: Option<&Cost>) -> DotPlot {
        let several = self.most.len() > 1;
        let groups = self.most.keys().flat_map(|scene| ["lighter", "darker"].map(|side| (*scene, side)));
        let groups: Vec<(&str, &str)> = groups.collect();
        let dot = |value: &str, scene: &str, side: &str| {
            let change = self.cost(value, scene)?.light.times(100.0);
            let (own, sign) = (change.value - 100.0, if side == "lighter" { 1.0 } else { -1.0 });
            if own * sign < ROUNDING {
                return None;
            }
            let bar = change.bar().map(|(low, high)| [low, high].map(|end| sign * (end - 100.0)));
            let bar = bar.map(|[a, b]| (a.min(b), a.max(b)));
            let hollow = bar.is_none_or(|(low, _)| low <= 0.0);
            Some(Dot { value: own.abs(), interval: bar, count: change.count, hollow })
        };
        let others = || self.values.iter().filter(|value| *value != self.usual);
        let has_dot = |(scene, side): &(&str, &str)| others().any(|value| dot(value, scene, side).is_some());
        let groups: Vec<(&str, &str)> = groups.into_iter().filter(has_dot).collect();
        let row =
            |value: &String| DotRow::new(value, groups.iter().map(|(scene, side)| dot(value, scene, side)).collect());
        let sides: BTreeSet<&str> = groups.iter().map(|(_, side)| *side).collect();
        let subject = match sides.into_iter().collect::<Vec<&str>>()[..] {
            ["darker"] => "mean radiance lost",
            ["lighter"] => "mean radiance gained",
            _ => "change of the mean radiance",
        };
        let axis = Axis::log(format!("{subject} against {}, %", self.usual));
        let names =
            groups.iter().map(|(scene, side)| if several { format!("{scene}, {side}") } else { (*side).to_string() });
        let certain = worst.filter(|cost| cost.light.interval.is_some_and(|interval| !interval.contains(1.0)));
        let result = certain.map(|cost| {
            let side = if cost.light.value < 1.0 { "darker" } else { "lighter" };
            let share = titles::percent((cost.light.value - 1.0).abs());
            format!("{} is {share} {side} with {} {}", cost.scene, self.name, cost.value)
        });
        let is_open = |cost: &Cost| cost.light.interval.is_some_and(|interval| interval.contains(1.0));
        let nothing = || format!("No {} changes the light beyond the noise", self.name);
        let result = result.or_else(|| self.costs.iter().all(is_open).then(nothing));
        let title = Title::new(format!("Light by {}", self.name)).with_result(result);
        let mut plot = DotPlot::new(title, axis, others().map(row).collect()).grouped(names);
        plot.subtitle = self.results.workload();
        plot.caption = format!(
            "Bars: 95 % interval over seeds, of ratios within a seed. Hollow: the interval contains no change. No dot: less than {ROUNDING} %. Each scene at {}.",
            self.samples()
        );
        plot
    }

    fn samples(&self) -> String {
        let spp: BTreeSet<u32> = self.most.values().copied().collect();
        if let [spp] = spp.into_iter().collect::<Vec<u32>>()[..] {
            return format!("{spp} samples per pixel");
        }
        let each: Vec<String> =
            self.most.iter().map(|(scene, spp)| format!("{spp} samples per pixel ({scene})")).collect();
        each.join(" and ")
    }

    /// A share of the pixels, in a million; `None` if it is 0 in every image.
    fn share(
        &self,
        stem: &'static str,
        [title, axis, meaning]: [&str; 3],
        of: fn(&Cost) -> Option<Estimated>,
    ) -> Option<Block> {
        let dot = |value: &String, scene: &&str| Some(of(self.cost(value, scene)?)?.times(1e6).dot());
        let row = |value: &String| DotRow::new(value, self.most.keys().map(|scene| dot(value, scene)).collect());
        let rows: Vec<DotRow> = self.values.iter().map(row).collect();
        if rows.iter().flat_map(|row| row.dots.iter().flatten()).all(|dot| dot.value == 0.0) {
            return None;
        }
        let axis = Axis::linear(format!("{axis}, in a million pixels")).including([0.0]);
        let mut plot = DotPlot::new(format!("{title} by {}", self.name), axis, rows).grouped(self.most.keys().copied());
        plot.subtitle = self.results.workload();
        plot.caption = format!("{meaning} Bars: 95 % interval over seeds. Each scene at {}.", self.samples());
        Some(Block::figure(stem, plot))
    }
}

/// The values in order: the usual one, then by their numbers; a value without a number counts as 0.
fn in_order(values: impl Iterator<Item = String>, usual: &str) -> Vec<String> {
    let mut values: Vec<String> = values.collect::<BTreeSet<_>>().into_iter().collect();
    let number = |value: &str| value.rsplit(':').next().and_then(|number| number.parse().ok()).unwrap_or(0.0_f64);
    values.sort_by(|a, b| {
        let is_usual = |value: &str| value == usual;
        is_usual(b).cmp(&is_usual(a)).then(number(a).total_cmp(&number(b)))
    });
    values
}

fn costs(results: &Results, of: Value, forget: fn(&mut ImageKey), usual: &str) -> Vec<Cost> {
    // Images are compared whatever the kernel: an approximation may exist for one kernel only, and kernels give the
    // same image.
    let is_plain = |row: &&Row| of(&row.image).is_empty() || of(&row.image) == usual;
    let plain: Vec<&Row> = results.rows().filter(is_plain).collect();
    let black = |row: &Row| Some(row.black_pixels? as f64 / pixels(row));
    let of_black = |rows: &[&Row]| Repeats::of_images(rows.iter().copied(), forget, black);
    let plain_black = of_black(&plain);
    let plain = Repeats::of_images(plain.iter().copied(), forget, |row| row.mean_radiance);
    // Variants of a scene stand beside each other under one name.
    let scene_of = |image: &ImageKey| {
        let mut image = image.clone();
        forget(&mut image);
        if image.scene.is_empty() { usual.to_string() } else { image.scene }
    };
    let cells = results.by(|row| (scene_of(&row.image), of(&row.image), row.spp));
    let cost = |((scene, value, spp), rows): ((String, &str, u32), Vec<&Row>)| {
        let rows = rows.into_iter().map(|row| (&row.image, row)).collect::<BTreeMap<_, _>>().into_values();
        let rows: Vec<&Row> = rows.collect();
        let light = Repeats::of_images(rows.iter().copied(), forget, |row| row.mean_radiance).over(&plain);
        let mean = |value: fn(&Row) -> Option<f64>| {
            let all = values(&rows, value);
            (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
        };
        let share = |value: fn(&Row) -> Option<f64>| Estimated::mean(&values(&rows, value));
        Some(Cost {
            scene,
            value: if value.is_empty() { usual.to_string() } else { value.to_string() },
            spp,
            light: Estimated::mean(&light.values())?,
            rmse: mean(|row| row.rmse),
            within: mean(|row| row.within_tolerance),
            black: mean(black),
            more_black: Estimated::mean(&of_black(&rows).minus(&plain_black).values()),
            fireflies: share(|row| Some(row.fireflies? as f64 / pixels(row))),
        })
    };
    cells.into_iter().filter_map(cost).collect()
}

fn pixels(row: &Row) -> f64 {
    f64::from(row.width) * f64::from(row.height)
}
