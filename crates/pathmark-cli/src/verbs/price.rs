//! `pathmark price SCENE --rmse E,E`: predicts the price of accuracies, and checks it with `--verify`.
//!
//! Samplers that spread the samples of a pixel are priced at powers of two times the fewest samples: between these
//! numbers, nets are incomplete and worse.
//!
//! `--estimator all` prices every unbiased estimator. For one estimator, small pilots of the others find out whether
//! one of them would be faster.

use super::prelude::*;
use super::rank::letters;
use super::run::note_doubts;
use super::setting_options::SettingOptions;
use crate::analysis::price::{Law, Price};
use crate::analysis::ranking::groups;
use crate::analysis::tail::Tail;
use crate::analysis::{Estimate, Interval};
use crate::experiment::{Pilot, Piloted, law_of, pay};
use crate::kernel::Spec;
use crate::measure::{LARGEST_SEED, LARGEST_SPP, TimingConcerns};
use std::collections::BTreeSet;

const LEVEL: f64 = 0.95;

/// A larger share of the variance in one value of one pixel makes a price doubtful.
const LARGEST_SHARE: f64 = 0.05;
/// A larger kurtosis makes it doubtful, too: the relative error of a variance from n values is about the root of
/// kurtosis / n.
const LARGEST_KURTOSIS: f64 = 200.0;

const ALL: &str = "all";
/// The pilots of other estimators have fewer samples by this factor.
const SHORTER: u32 = 4;
/// Seeds of the pilots of other estimators: the fewest that give a useful interval.
const FEW_SEEDS: u32 = 4;

/// `pathmark price cornell --rmse 0.05,0.02,0.01 --verify`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A scene of `pathmark list scenes`, or the path of a .toml file
    scene: String,
    /// Goals: root mean squared errors in linear radiance
    #[arg(long, value_name = "E,E,..", value_delimiter = ',', required = true, allow_hyphen_values = true)]
    rmse: Vec<f64>,
    /// Samples per pixel of each seed of the pilot
    #[arg(long, value_name = "N", default_value_t = 16)]
    pilot_spp: u32,
    /// Seeds of the pilot
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(3..=1000))]
    pilot_seeds: u32,
    /// Seed of the first render of --verify; the second render uses the next seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Render each goal with two seeds, and print the measured error and time
    #[arg(long, alias = "pay")]
    verify: bool,
    #[command(flatten)]
    axes: SettingOptions,
    /// Print an array of JSON objects
    #[arg(long)]
    json: bool,
}

/// A goal, its price, and the measured time and error.
#[derive(Serialize, Default)]
struct Row {
    estimator: String,
    rmse: f64,
    /// Samples per pixel that will be rendered: those of the price, rounded up.
    spp: u32,
    spp_low: f64,
    spp_high: f64,
    seconds: f64,
    seconds_low: f64,
    seconds_high: f64,
    half_rmse_seconds: Option<f64>,
    paid_rmse: Option<f64>,
    paid_seconds: Option<f64>,
    rmse_ratio: Option<f64>,
    seconds_ratio: Option<f64>,
    /// With all estimators: the numbers of its groups. Two estimators that share a group cannot be told apart.
    groups: Vec<usize>,
    #[serde(flatten)]
    tail: Tail,
    /// Seeds of the pilot whose times are in doubt.
    doubted_seeds: usize,
    #[serde(skip)]
    counts: Counts,
}

/// The numbers of samples that can be rendered.
#[derive(Clone, Copy, Default)]
struct Counts {
    /// Fewest samples that make a whole image.
    fewest: u32,
    /// Whether only `fewest` times a power of two can be rendered.
    doubled: bool,
}

impl Counts {
    fn of(settings: &Settings, fewest: u32) -> Self {
        Self { fewest, doubled: law_of(&settings.spec.sampler) == Law::Fitted }
    }

    /// `spp`, rounded up to a number that can be rendered.
    fn whole(self, spp: f64) -> f64 {
        let fewest = f64::from(self.fewest);
        let times = (spp / fewest).ceil().max(1.0);
        fewest * if self.doubled { libm::exp2(libm::ceil(libm::log2(times) - 1e-9)) } else { times }
    }

    /// The factor by which rounding up raises `spp`, if only powers of two are rendered; otherwise 1.
    fn surplus(self, spp: f64) -> f64 {
        if self.doubled { self.whole(spp) / spp } else { 1.0 }
    }
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    for goal in &arguments.rmse {
        if !(*goal > 0.0 && goal.is_finite()) {
            let error = InputError::new("rmse", goal.to_string(), "must be a positive number");
            return Err(error.allowed("one number or a list, as in 0.05,0.01").into());
        }
    }
    if arguments.seed >= LARGEST_SEED / 2 {
        let error = InputError::new("seed", arguments.seed.to_string(), "is reserved for pilots and references");
        return Err(error.allowed(format!("0 to {}", LARGEST_SEED / 2 - 1)).into());
    }
    let asked = arguments.axes.settings(lab, &arguments.scene, arguments.pilot_spp, arguments.seed)?;
    let is_comparison = asked.spec.estimator == ALL;
    let each = if is_comparison { unbiased(lab, &asked).collect() } else { vec![asked] };
    lab.prepare(each[0].clone())?.remarks().iter().for_each(|remark| console.note(remark));
    let (mut priced, mut texts, mut doubts) = (Vec::new(), Vec::new(), TimingConcerns::default());
    let pilot = Pilot { spp: arguments.pilot_spp, seeds: arguments.pilot_seeds };
    for (settings, piloted) in each.iter().zip(pilot.run_side_by_side(lab, &each, LEVEL, console)?) {
        let rows = price(lab, arguments, settings, &piloted, console)?;
        texts.push(table(settings, arguments, &piloted, &rows));
        doubts.merge(&piloted.doubts);
        priced.extend(rows);
    }
    note_doubts(&doubts, console);
    if is_comparison {
        arguments.rmse.iter().for_each(|goal| group(*goal, &mut priced));
    }
    if arguments.json {
        return print_json(&priced);
    }
    if is_comparison {
        texts.push(ranking(&arguments.rmse, &priced));
    } else {
        texts.extend(sooner(lab, arguments, &each[0], &priced, console)?);
    }
    print(&texts.join("\n\n"))
}

/// The settings with each unbiased estimator: those that have no bounce limit of their own.
fn unbiased<'a>(lab: &'a Lab, settings: &'a Settings) -> impl Iterator<Item = Settings> + 'a {
    let names = lab.estimators().filter(|entry| entry.max_depth.is_none()).map(|entry| entry.name.to_string());
    names.map(|estimator| Settings { spec: Spec { estimator, ..settings.spec.clone() }, ..settings.clone() })
}

/// Prices each goal.
fn price(
    lab: &Lab,
    arguments: &Arguments,
    settings: &Settings,
    piloted: &Piloted,
    console: &Console,
) -> Result<Vec<Row>> {
    let counts = Counts::of(settings, lab.prepare(settings.clone())?.fewest_spp());
    arguments.rmse.iter().map(|goal| row(lab, arguments, settings, piloted, *goal, counts, console)).collect()
}

/// Puts the estimators of a goal into groups: two share one if their intervals overlap.
fn group(goal: f64, rows: &mut [Row]) {
    let mut of_goal: Vec<&mut Row> = rows.iter_mut().filter(|row| row.rmse == goal).collect();
    of_goal.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let pairs = (0..of_goal.len()).flat_map(|a| (0..of_goal.len()).map(move |b| (a, b)));
    let told: BTreeSet<(usize, usize)> =
        pairs.filter(|(a, b)| of_goal[*a].seconds_high < of_goal[*b].seconds_low).collect();
    let sets = groups(of_goal.len(), &told);
    for (at, row) in of_goal.into_iter().enumerate() {
        row.groups = (0..sets.len()).filter(|number| sets[*number].contains(&at)).collect();
    }
}

/// The estimators, sorted by their seconds for each goal, with the letters of their groups.
fn ranking(goals: &[f64], rows: &[Row]) -> String {
    let line = |goal: &f64| {
        let mut of_goal: Vec<&Row> = rows.iter().filter(|row| row.rmse == *goal).collect();
        of_goal.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let each =
            of_goal.iter().map(|row| format!("{} {:.3} s ({})", row.estimator, row.seconds, letters(&row.groups)));
        format!("RMSE {goal}: {}", each.collect::<Vec<_>>().join(", "))
    };
    let rule = "Estimators that share a letter cannot be told apart: their intervals overlap.".to_string();
    goals.iter().map(line).chain([rule]).collect::<Vec<_>>().join("\n")
}

/// Describes an estimator that would certainly reach the first goal sooner than the chosen one; `None` if short pilots
/// find none.
fn sooner(lab: &Lab, arguments: &Arguments, own: &Settings, rows: &[Row], console: &Console) -> Result<Option<String>> {
    let Some(first) = rows.first().filter(|_| unbiased(lab, own).any(|other| other == *own)) else { return Ok(None) };
    let mut others = Vec::new();
    for other in unbiased(lab, own).filter(|other| other != own) {
        // The pilot's samples may be too few for this estimator.
        let entry = lab.estimators().find(|entry| entry.name == other.spec.estimator);
        let multiple = entry.map_or(1, |entry| entry.spp_multiple);
        let fewest = lab.prepare(Settings { spp: multiple, ..other.clone() })?.fewest_spp();
        let spp = (arguments.pilot_spp / SHORTER).next_multiple_of(fewest).max(fewest);
        // The pilot may have too few samples for a law; the estimator is then left out.
        let Ok(found) = (Pilot { spp, seeds: FEW_SEEDS }).run(lab, &other, LEVEL, console) else { continue };
        others.extend(found.renderer.price(first.rmse).map(|price| (other.spec.estimator, price.seconds)));
    }
    Ok(soonest(first, others))
}

/// Describes the soonest of the estimators whose intervals lie entirely below the row's.
fn soonest(row: &Row, others: Vec<(String, Estimate)>) -> Option<String> {
    let sooner = others.into_iter().filter(|(_, seconds)| seconds.interval.high < row.seconds_low);
    let (name, seconds) = sooner.min_by(|(_, a), (_, b)| a.value.total_cmp(&b.value))?;
    let Interval { low, high, .. } = seconds.interval;
    let times = row.seconds / seconds.value;
    Some(format!(
        "{name} would reach RMSE {} in {:.3} s ({low:.3} to {high:.3}), {times:.1} times as fast; compare with --estimator {ALL}",
        row.rmse, seconds.value
    ))
}

fn row(
    lab: &Lab,
    arguments: &Arguments,
    settings: &Settings,
    piloted: &Piloted,
    goal: f64,
    counts: Counts,
    console: &Console,
) -> Result<Row> {
    let renderer = &piloted.renderer;
    let Price { rmse, spp: samples, seconds } = renderer.price(goal).ok_or_else(|| {
        Error::Check(format!("{goal} has no price: the error of {} does not fall with more samples", arguments.scene))
    })?;
    let wanted = counts.whole(samples.value);
    if wanted > f64::from(LARGEST_SPP) {
        let problem = format!("takes {wanted:.0} samples per pixel, more than the maximum of {LARGEST_SPP}");
        return Err(InputError::new("rmse", goal.to_string(), problem).into());
    }
    let spp = wanted as u32;
    let paid = if arguments.verify { Some(pay(lab, settings, spp, console)?) } else { None };
    // The rendered samples are rounded up, so the prediction for comparison must use the same number.
    let expected_s = f64::from(spp) * renderer.seconds_per_spp.value;
    let expected = renderer.rmse_after(expected_s).map(|error| error.value);
    let half = renderer.price(0.5 * rmse);
    Ok(Row {
        estimator: settings.spec.estimator.clone(),
        rmse,
        spp,
        spp_low: samples.interval.low,
        spp_high: samples.interval.high,
        seconds: seconds.value * counts.surplus(samples.value),
        seconds_low: seconds.interval.low * counts.surplus(samples.interval.low),
        seconds_high: seconds.interval.high * counts.surplus(samples.interval.high),
        half_rmse_seconds: half.map(|half| half.seconds.value * counts.surplus(half.spp.value)),
        paid_rmse: paid.map(|paid| paid.rmse),
        paid_seconds: paid.map(|paid| paid.seconds),
        rmse_ratio: paid.zip(expected).map(|(paid, expected)| paid.rmse / expected),
        seconds_ratio: paid.map(|paid| paid.seconds / expected_s),
        groups: Vec::new(),
        tail: piloted.tail,
        doubted_seeds: piloted.doubts.count(),
        counts,
    })
}

fn table(settings: &Settings, arguments: &Arguments, piloted: &Piloted, rows: &[Row]) -> String {
    let (spec, Piloted { renderer, tail, .. }) = (&settings.spec, piloted);
    let Interval { low, high, .. } = renderer.seconds_per_spp.interval;
    let mut lines = vec![
        format!(
            "{}, {} + {}, {}x{}, {} on {}, {}",
            settings.scene,
            spec.estimator,
            spec.sampler,
            spec.width,
            spec.height,
            settings.strategy,
            settings.decomposition,
            counted(settings.threads, "thread")
        ),
        format!(
            "pilot of {} seeds at {} spp: {:.4} s per sample and pixel ({low:.4} to {high:.4}); intervals have 95 % confidence",
            arguments.pilot_seeds, arguments.pilot_spp, renderer.seconds_per_spp.value
        ),
        format!(
            "one value of one pixel makes up at most {:.2} % of the variance, kurtosis {:.0}",
            100.0 * tail.largest_share,
            tail.kurtosis
        ),
        format!("{:>9}  {:>8}  {:>21}  {:>9}  {:>19}  {:>10}", "RMSE", "spp", "", "seconds", "", "half RMSE"),
    ];
    if tail.largest_share > LARGEST_SHARE || tail.kurtosis > LARGEST_KURTOSIS {
        let text = "doubtful: few values dominate the variance, so another pilot could give another price; try a larger --pilot-spp";
        lines.insert(lines.len() - 1, text.to_string());
    }
    for row in rows {
        lines.push(format!(
            "{:>9}  {:>8}  {:>21}  {:>9.3}  {:>19}  {:>8}",
            row.rmse,
            row.spp,
            format!("({} to {})", row.counts.whole(row.spp_low), row.counts.whole(row.spp_high)),
            row.seconds,
            format!("({:.3} to {:.3})", row.seconds_low, row.seconds_high),
            row.half_rmse_seconds.map_or_else(|| "-".to_string(), |seconds| format!("{seconds:.2} s")),
        ));
        if let [Some(error), Some(seconds), Some(by_error), Some(by_seconds)] =
            [row.paid_rmse, row.paid_seconds, row.rmse_ratio, row.seconds_ratio]
        {
            lines.push(format!(
                "     paid  RMSE {error:.5}, {:+.1} % from the prediction; {seconds:.3} s, {:+.1} %",
                100.0 * (by_error - 1.0),
                100.0 * (by_seconds - 1.0)
            ));
        }
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_rounded_up_to_renderable_counts() {
        let [plain, doubled] = [false, true].map(|doubled| Counts { fewest: 4, doubled });
        assert_eq!([0.1, 4.0, 5.0, 64.0, 65.0].map(|spp| plain.whole(spp)), [4.0, 4.0, 8.0, 64.0, 68.0]);
        assert_eq!([0.1, 4.0, 5.0, 64.0, 65.0].map(|spp| doubled.whole(spp)), [4.0, 4.0, 8.0, 64.0, 128.0]);
        assert_eq!((plain.surplus(65.0), doubled.surplus(80.0)), (1.0, 1.6));
    }

    fn seconds(value: f64, low: f64, high: f64) -> Estimate {
        Estimate { value, interval: Interval { low, high, level: LEVEL } }
    }

    /// Intervals that overlap leave the order open: a and b overlap, b and c do, a and c do not, and d is far from all.
    #[test]
    fn estimators_are_told_apart_by_disjoint_intervals() {
        let row = |name: &str, low: f64, seconds: f64, high: f64| {
            let estimator = name.to_string();
            Row { estimator, rmse: 0.1, seconds, seconds_low: low, seconds_high: high, ..Row::default() }
        };
        let mut rows =
            [row("d", 8.0, 9.0, 10.0), row("b", 1.9, 3.0, 4.0), row("a", 1.0, 1.5, 2.0), row("c", 3.9, 4.5, 5.0)];
        group(0.1, &mut rows);
        let text = ranking(&[0.1], &rows);
        let (line, rule) = text.split_once('\n').unwrap();
        assert_eq!(line, "RMSE 0.1: a 1.500 s (a), b 3.000 s (a b), c 4.500 s (b), d 9.000 s (c)");
        assert!(rule.contains("cannot be told apart"), "{rule}");
    }

    #[test]
    fn the_soonest_is_told_if_it_surely_is_sooner() {
        let row = Row { rmse: 0.1, seconds: 4.0, seconds_low: 3.0, seconds_high: 5.0, ..Row::default() };
        let told = |others: &[(&str, Estimate)]| {
            soonest(&row, others.iter().map(|(name, seconds)| ((*name).to_string(), *seconds)).collect())
        };
        assert_eq!(told(&[]), None);
        assert_eq!(told(&[("a", seconds(2.0, 1.0, 3.0))]), None, "the intervals touch");
        let text = told(&[("a", seconds(2.0, 1.0, 2.9)), ("b", seconds(0.5, 0.4, 0.6))]).unwrap();
        assert!(text.starts_with("b would reach RMSE 0.1 in 0.500 s (0.400 to 0.600), 8.0 times as fast"), "{text}");
    }
}
