//! The cost of accuracy in time: error against seconds, a line for each schedule. All schedules of one spp render the
//! same image with the same error; a better schedule moves the curve to the left.

use crate::contenders::one_per_seed;
use crate::prelude::*;

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Options {
    /// The RMSE whose price is extrapolated, in linear radiance.
    goal: Option<Positive>,
}

/// An image's series and its schedule.
type Key<'a> = (String, &'a Schedule);

/// Time and error of a schedule at some number of samples.
struct Place<'a> {
    key: Key<'a>,
    /// Scene and size: prices in others are not compared with its price.
    setting: (&'a str, u32, u32),
    spp: u32,
    seconds: Estimated,
    mse: f64,
}

impl Place<'_> {
    fn point(&self) -> Point {
        let at = Point::new(self.seconds.value, self.mse.sqrt()).with_x(self.seconds.bar());
        Point { hollow: self.seconds.is_partial, ..at }
    }

    fn price(&self) -> f64 {
        self.mse * self.seconds.value
    }
}

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let goal = options::<Options>(&results.definition, "rmse-against-time")?.goal.map_or(0.01, |goal| goal.0);
    let groups = results.by(|row| ((results.series_name(row), &row.schedule), row.spp));
    let cells = groups.into_iter().map(|((key, spp), rows)| {
        let mse = one_per_seed(&rows, |row| row.mse);
        let mse = mse.iter().sum::<f64>() / mse.len() as f64;
        let setting = (rows[0].scene.as_str(), rows[0].width, rows[0].height);
        ((key, setting, spp, mse), Repeats::of_rows(rows, |row| row.rendering_s()))
    });
    let places = along(cells, |(key, ..)| key.clone(), results.stopping()).into_iter();
    let places = places.map(|((key, setting, spp, mse), seconds)| Place { key, setting, spp, seconds, mse });
    let places = places.filter(|place| place.mse > 0.0);
    let places: Vec<Place<'_>> = places.collect();
    let lines = gathered(places.iter().map(|place| (&place.key, place.point())));
    let colour = |key: &Key<'_>| format!("{}{}", key.0, key.1.name);
    let mut colours: Vec<String> = lines.keys().map(|key| colour(key)).collect();
    colours.dedup();
    let dashes: BTreeSet<usize> = lines.keys().map(|(_, schedule)| schedule.key.threads).collect();
    let series = lines.into_iter().map(|(key, points)| {
        let dash = dashes.iter().position(|threads| *threads == key.1.key.threads).unwrap_or(0);
        let colour = colours.iter().position(|own| *own == colour(key)).unwrap_or(0);
        Series::new(label(key), Look::of(colour, dash), points)
    });
    let mut chart = LineChart::new(
        "What accuracy costs in time",
        Axis::log("wall seconds"),
        Axis::log("RMSE, linear radiance"),
        series.collect(),
    );
    chart.subtitle = results.workload();
    let bars = bars(places.iter().map(|place| place.seconds));
    chart.caption = format!("Points along a line: growing samples per pixel. {bars}");
    let ranked = places.iter().filter(|place| !place.seconds.is_partial);
    let by_setting = gathered(ranked.map(|place| (place.setting, (&place.key, place.price())))).into_values();
    let price = by_setting.rev().max_by_key(Vec::len).and_then(|prices| price_finding(&gathered(prices), goal));
    let table = Block::table("rmse-against-time", "Price of accuracy by schedule", &places)
        .column("schedule", |place| label(&place.key))
        .column("spp", |place| place.spp.to_string())
        .estimated("median seconds", Decimals(4), |place| place.seconds)
        .number("RMSE, linear", Decimals(5), |place| place.mse.sqrt())
        .number("MSE x seconds", Significant(4), |place| place.price())
        .end();
    Ok([Block::figure("rmse-against-time", chart)].into_iter().chain(price).chain([table]).collect())
}

/// If the RMSE times the root of the time is constant along a line, one value prices every accuracy: MSE times seconds.
fn price_finding(prices: &BTreeMap<&Key<'_>, Vec<f64>>, goal: f64) -> Option<Block> {
    let spread = |values: &Vec<f64>| {
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        most / values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let widest = prices.values().map(spread).reduce(f64::max)?;
    let costs = || prices.iter().filter_map(|(key, values)| Some((key, median(values)? / (goal * goal))));
    let (cheapest, least) = costs().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let (dearest, most) = costs().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Block::finding(format!(
        "MSE times seconds is the price of accuracy. Along each line its largest value is at most {widest:.2} times its smallest. \
         Extrapolated with its median, an RMSE of {goal} costs about {least:.0} s with {} and {most:.0} s with {}; half that \
         RMSE costs four times as much. These seconds were not measured.",
        label(cheapest),
        label(dearest),
    )))
}

fn label((series, schedule): &Key<'_>) -> String {
    joined([series.clone(), schedule.label()])
}
