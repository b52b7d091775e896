//! `pathmark price SCENE --rmse E,E`: predicts the price of accuracies, and checks it with `--verify`.
//!
//! Samplers that spread the samples of a pixel are priced at powers of two times the fewest samples: between these
//! numbers, nets are incomplete and worse.
//!
//! `--estimator all` prices every unbiased estimator. For one estimator, small pilots of the others find out whether
//! one of them would be faster. Estimators are compared by runs in pairs, over several processes.

use super::prelude::*;
use super::rank::letters;
use super::run::note_doubts;
use super::setting_options::SettingOptions;
use crate::analysis::price::{Law, Price};
use crate::analysis::ranking::groups;
use crate::analysis::tail::Tail;
use crate::analysis::{Estimate, Interval};
use crate::experiment::{Pilot, Piloted, law_of, pay, run_pilots};
use crate::kernel::Spec;
use crate::measure::{LARGEST_SEED, LARGEST_SPP, TimingConcerns};
use crate::report::latex::tabular;
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
    /// Samples per pixel of each seed of the pilot, the short renders from which the price follows
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
    /// Print a table for LaTeX, which needs its package booktabs
    #[arg(long, conflicts_with = "json")]
    latex: bool,
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
    /// The factor by which rounding raised the seconds.
    #[serde(skip)]
    surplus: f64,
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
    let own = |settings: &Settings| Pilot { settings: settings.clone(), seeds: arguments.pilot_seeds };
    let pilots: Vec<Pilot> = each.iter().map(own).collect();
    let smaller = if is_comparison { Vec::new() } else { smaller_pilots(lab, arguments, &each[0])? };
    let (found, others) = run_pilots(lab, &pilots, &smaller, LEVEL, console)?;
    let (mut priced, mut texts, mut doubts) = (Vec::new(), Vec::new(), TimingConcerns::default());
    for (settings, piloted) in each.iter().zip(&found) {
        let rows = price(lab, arguments, settings, piloted, console)?;
        texts.push(table(settings, arguments, piloted, &rows));
        doubts.merge(&piloted.doubts);
        priced.extend(rows);
    }
    note_doubts(&doubts, console);
    if is_comparison {
        for goal in &arguments.rmse {
            group(*goal, &mut priced, |own, other| found[own].seconds_over(&found[other], *goal, LEVEL));
        }
    }
    if arguments.json {
        return print_json(&priced);
    }
    if arguments.latex {
        return print(latex(&priced).trim_end());
    }
    if is_comparison {
        texts.push(ranking(&arguments.rmse, &priced));
    } else if let Some(first) = priced.first() {
        // A pilot may have too few samples for a law; that estimator is then left out.
        let others = smaller.iter().zip(others).filter_map(|(pilot, other)| {
            let (name, other) = (pilot.settings.spec.estimator.clone(), other?);
            let seconds = other.renderer.price(first.rmse)?.seconds;
            Some((name, seconds, other.seconds_over(&found[0], first.rmse, LEVEL)?))
        });
        texts.extend(soonest(first.rmse, others.collect()));
    }
    print(&texts.join("\n\n"))
}

/// Small pilots of the other unbiased estimators; none beside a biased one, whose error does not fall to any goal.
fn smaller_pilots(lab: &Lab, arguments: &Arguments, own: &Settings) -> Result<Vec<Pilot>> {
    if !unbiased(lab, own).any(|other| other == *own) {
        return Ok(Vec::new());
    }
    let pilot = |other: Settings| {
        // The pilot's samples may be too few for this estimator.
        let entry = lab.estimators().find(|entry| entry.name == other.spec.estimator);
        let multiple = entry.map_or(1, |entry| entry.spp_multiple);
        let fewest = lab.prepare(Settings { spp: multiple, ..other.clone() })?.fewest_spp();
        let spp = (arguments.pilot_spp / SHORTER).next_multiple_of(fewest).max(fewest);
        Ok(Pilot { settings: Settings { spp, ..other }, seeds: FEW_SEEDS })
    };
    unbiased(lab, own).filter(|other| other != own).map(pilot).collect()
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

/// Puts the estimators of a goal into groups: two share one unless the interval of the ratio of their seconds lies
/// entirely on one side of 1. `seconds_over` has the ratio of two rows of the goal, by their places among these.
fn group(goal: f64, rows: &mut [Row], seconds_over: impl Fn(usize, usize) -> Option<Estimate>) {
    let mut of_goal: Vec<&mut Row> = rows.iter_mut().filter(|row| row.rmse == goal).collect();
    let is_sooner = |own: usize, other: usize| {
        let rounded = of_goal[own].surplus / of_goal[other].surplus;
        seconds_over(own, other).is_some_and(|ratio| ratio.interval.high * rounded < 1.0)
    };
    let count = of_goal.len();
    let pairs = (0..count).flat_map(|a| (0..count).map(move |b| (a, b)));
    let told: BTreeSet<(usize, usize)> = pairs.filter(|(a, b)| a != b && is_sooner(*a, *b)).collect();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| of_goal[*a].seconds.total_cmp(&of_goal[*b].seconds));
    let place = |of: usize| order.iter().position(|own| *own == of).unwrap_or_default();
    // The letters begin with the soonest.
    let told = told.into_iter().map(|(a, b)| (place(a), place(b))).collect();
    let sets = groups(count, &told);
    for (at, own) in order.into_iter().enumerate() {
        of_goal[own].groups = (0..sets.len()).filter(|number| sets[*number].contains(&at)).collect();
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
    let rule =
        "Estimators that share a letter cannot be told apart: the interval of the ratio of their seconds contains 1."
            .to_string();
    goals.iter().map(line).chain([rule]).collect::<Vec<_>>().join("\n")
}

/// Describes the soonest of the estimators that surely reach the goal sooner than the chosen one: each with its seconds,
/// and with these over those of the chosen one.
fn soonest(goal: f64, others: Vec<(String, Estimate, Estimate)>) -> Option<String> {
    let sooner = others.into_iter().filter(|(_, _, ratio)| ratio.interval.high < 1.0);
    let (name, seconds, ratio) = sooner.min_by(|a, b| a.2.value.total_cmp(&b.2.value))?;
    let Interval { low, high, .. } = seconds.interval;
    let times = 1.0 / ratio.value;
    Some(format!(
        "{name} would reach RMSE {goal} in {:.3} s ({low:.3} to {high:.3}), {times:.1} times as fast; compare with --estimator {ALL}",
        seconds.value
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
    let surplus = counts.surplus(samples.value);
    Ok(Row {
        estimator: settings.spec.estimator.clone(),
        rmse,
        spp,
        spp_low: samples.interval.low,
        spp_high: samples.interval.high,
        seconds: seconds.value * surplus,
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
        surplus,
    })
}

/// A row for each estimator and goal, with the letters of its groups if estimators were compared.
fn latex(rows: &[Row]) -> String {
    let is_comparison = rows.iter().any(|row| !row.groups.is_empty());
    let groups = is_comparison.then_some("groups");
    let heads = ["estimator", "RMSE", "spp", "interval", "seconds", "interval"].into_iter().chain(groups);
    let line = |row: &Row| {
        let cells = [
            row.estimator.clone(),
            row.rmse.to_string(),
            row.spp.to_string(),
            format!("{} to {}", row.counts.whole(row.spp_low), row.counts.whole(row.spp_high)),
            format!("{:.3}", row.seconds),
            format!("{:.3} to {:.3}", row.seconds_low, row.seconds_high),
        ];
        cells.into_iter().chain(is_comparison.then(|| letters(&row.groups))).collect()
    };
    tabular(&heads.map(str::to_string).collect::<Vec<_>>(), &rows.iter().map(line).collect::<Vec<_>>())
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

    fn estimate(value: f64, low: f64, high: f64) -> Estimate {
        Estimate { value, interval: Interval { low, high, level: LEVEL } }
    }

    /// a and b cannot be told apart, b and c cannot, a is sooner than c, and d is later than all.
    #[test]
    fn estimators_are_told_apart_by_the_ratio_of_their_seconds() {
        let row = |name: &str, seconds: f64| Row {
            estimator: name.to_string(),
            rmse: 0.1,
            seconds,
            surplus: 1.0,
            ..Row::default()
        };
        let mut rows = [row("d", 9.0), row("b", 3.0), row("a", 1.5), row("c", 4.5)];
        let half_width = [1.1_f64, 2.2, 2.2, 1.4];
        let seconds: Vec<f64> = rows.iter().map(|row| row.seconds).collect();
        let ratio = |own: usize, other: usize| {
            let (value, width) = (seconds[own] / seconds[other], half_width[own].max(half_width[other]));
            Some(estimate(value, value / width, value * width))
        };
        group(0.1, &mut rows, ratio);
        let table = latex(&rows);
        assert!(table.contains("b & 0.1 & 0 & 0 to 0 & 3.000 & 0.000 to 0.000 & a b \\\\\n"), "{table}");
        let text = ranking(&[0.1], &rows);
        let (line, rule) = text.split_once('\n').unwrap();
        assert_eq!(line, "RMSE 0.1: a 1.500 s (a), b 3.000 s (a b), c 4.500 s (b), d 9.000 s (c)");
        assert!(rule.contains("cannot be told apart"), "{rule}");
    }

    /// Rounding up to powers of two belongs to the price: twice the seconds take away an advantage of a third.
    #[test]
    fn rounding_up_counts() {
        let row = |seconds: f64, surplus: f64| Row { rmse: 0.1, seconds, surplus, ..Row::default() };
        let ratio = |own: usize, other: usize| {
            let value = [2.0, 3.0][own] / [2.0, 3.0][other];
            Some(estimate(value, value / 1.01, value * 1.01))
        };
        let mut rows = [row(2.0, 1.0), row(3.0, 1.0)];
        group(0.1, &mut rows, ratio);
        assert_eq!(rows.map(|row| row.groups), [vec![0], vec![1]]);
        let mut rows = [row(3.0, 1.5), row(3.0, 1.0)];
        group(0.1, &mut rows, ratio);
        assert_eq!(rows.map(|row| row.groups), [vec![0], vec![0]]);
    }

    #[test]
    fn the_soonest_is_told_if_it_surely_is_sooner() {
        let told = |others: &[(&str, Estimate, Estimate)]| {
            soonest(0.1, others.iter().map(|(name, seconds, ratio)| ((*name).to_string(), *seconds, *ratio)).collect())
        };
        assert_eq!(told(&[]), None);
        let a = ("a", estimate(2.0, 1.0, 3.0), estimate(0.5, 0.25, 1.0));
        assert_eq!(told(&[a]), None, "the interval of the ratio touches 1");
        let text = told(&[a, ("b", estimate(0.5, 0.4, 0.6), estimate(0.125, 0.1, 0.15))]).unwrap();
        assert!(text.starts_with("b would reach RMSE 0.1 in 0.500 s (0.400 to 0.600), 8.0 times as fast"), "{text}");
    }
}
