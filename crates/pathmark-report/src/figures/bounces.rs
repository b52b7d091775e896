//! Light by the number of its bounces, and the lengths of paths. Rows with growing bounce limits are the partial sums
//! of the Neumann series, because a truncated path has the same vertices up to the limit.

use crate::prelude::*;

/// One bounce limit of a scene.
struct Step {
    name: String,
    limit: u16,
    /// Share of all light that makes exactly this many bounces, with its interval over seeds.
    light: Estimated,
    /// Share of all light that makes at most this many bounces.
    up_to: f64,
    /// Share of paths that are truncated at the limit.
    cut: f64,
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let images = results.by(|row| {
        let roulette = if row.roulette.is_empty() { "no roulette" } else { &row.roulette };
        format!("{}, {} with {roulette}", row.scene, row.estimator)
    });
    let steps: Vec<Step> = images.iter().flat_map(|(name, rows)| steps(name, rows)).collect();
    if steps.is_empty() {
        return Ok(vec![Block::notice(
            "There is no light by bounce: it takes rows with bounce limits and rows without.",
        )]);
    }
    // A logarithmic axis cannot show a share of zero.
    let lines = |y: fn(&Step) -> Point| {
        let points = steps.iter().map(|step| (&step.name, y(step))).filter(|(_, point)| point.y > 0.0);
        Series::by_name(gathered(points))
    };
    let range = |limit: u16, value: fn(&Step) -> f64| {
        let mut own: Vec<f64> = steps.iter().filter(|step| step.limit == limit).map(value).collect();
        own.sort_by(f64::total_cmp);
        let [least, most] = [own.first()?, own.last()?].map(|share| titles::percent(*share));
        Some(if least == most { most } else { format!("{least} to {most}") })
    };
    let direct = range(1, |step| step.up_to).map(|share| format!("{share} of the light makes at most one bounce"));
    let longer = range(6, |step| step.cut).map(|share| format!("{share} of the paths are longer than six bounces"));
    let mut light = LineChart::new(
        Title::new("Light by the number of its bounces").with_result(direct),
        Axis::linear("bounces"),
        Axis::log("share of all light, %"),
        lines(|step| step.light.times(100.0).above(f64::from(step.limit))),
    );
    light.caption = "Bars: 95 % interval over seeds. Light without a bounce is the lamp as it is seen.".to_string();
    let mut paths = LineChart::new(
        Title::new("Paths that are longer than a limit").with_result(longer),
        Axis::linear("bounces"),
        Axis::log("share of paths, %"),
        lines(|step| Point::new(f64::from(step.limit), 100.0 * step.cut)),
    );
    for chart in [&mut light, &mut paths] {
        chart.subtitle = results.workload();
        chart.dodge = 4.0;
    }
    let findings = images.keys().filter_map(|name| {
        let direct = steps.iter().find(|step| step.name == *name && step.limit == 1)?;
        let sixth = steps.iter().find(|step| step.name == *name && step.limit == 6)?;
        Some(Block::finding(format!(
            "{name}: {:.1} % of the light makes at most one bounce and {:.1} % at most six; {:.1} % of the paths are longer than six bounces.",
            100.0 * direct.up_to,
            100.0 * sixth.up_to,
            100.0 * sixth.cut,
        )))
    });
    let findings: Vec<Block> = findings.collect();
    let table = Block::table("bounces", "Light and paths by bounces", &steps)
        .column("scene and estimator", |step| step.name.clone())
        .column("bounces", |step| step.limit.to_string())
        .estimated("share of the light, %", Decimals(3), |step| step.light.times(100.0))
        .number("share up to here, %", Decimals(3), |step| 100.0 * step.up_to)
        .number("paths that are longer, %", Decimals(3), |step| 100.0 * step.cut)
        .end();
    let figures = [Block::figure("bounces", light), Block::figure("path-lengths", paths)];
    Ok(figures.into_iter().chain(findings).chain([table]).collect())
}

/// The steps of the rows with a limit, relative to the rows of the same image without one.
fn steps(name: &str, rows: &[&Row]) -> Vec<Step> {
    let radiance = |limit: Option<u16>| {
        let own = rows.iter().copied().filter(|row| row.max_depth == limit);
        Repeats::of_images(own, |image| image.max_depth = None, |row| row.mean_radiance)
    };
    let whole = radiance(None);
    let limits: BTreeSet<u16> = rows.iter().filter_map(|row| row.max_depth).collect();
    let step = |limit: u16| {
        let up_to = radiance(Some(limit));
        let own = match limit.checked_sub(1) {
            Some(below) => up_to.minus(&radiance(Some(below))),
            None => up_to.clone(),
        };
        let running = up_to.over(&whole).values();
        let cut = rows.iter().filter(|row| row.max_depth == Some(limit));
        let (cut, paths) = cut
            .filter_map(|row| Some((row.truncated? as f64, row.samples? as f64)))
            .fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
        let light = Estimated::mean(&own.over(&whole).values())?;
        let up_to = running.iter().sum::<f64>() / running.len() as f64;
        Some(Step { name: name.to_string(), limit, light, up_to, cut: cut / paths })
    };
    limits.into_iter().filter_map(step).collect()
}
