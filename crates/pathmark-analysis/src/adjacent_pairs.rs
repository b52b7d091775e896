//! Ratios of adjacent runs on two levels: pairs within a process, and processes.
//!
//! Two runs that follow each other share the machine's speed, so drift and most disturbances leave their ratio (L. Bulej
//! et al., "Duet Benchmarking: Improving Measurement Accuracy in the Cloud", ICPE 2020). A process has one memory layout
//! for its whole life, which may favour either side: many pairs within one process repeat that layout, and say nothing
//! about others. So the interval follows from the spread of processes (T. Kalibera and R. Jones, "Rigorous Benchmarking
//! in Reasonable Time", ISMM 2013, section 6), and a process counts as one value, however many pairs it has.
//!
//! The value of a process is the median of its logarithms of ratios, because single pairs are disturbed on one side. Of
//! many processes a few may be disturbed for their whole life; from sixteen on, the eighth at either end does not count
//! (`trimmed.rs`).

use crate::bisection::smallest;
use crate::equivalence::Measured;
use crate::interval::{Estimate, is_level};
use crate::mean::{Moments, t_quantile};
use crate::quantile::median;
pub use crate::trimmed::FEWEST as FEWEST_TRIMMED;
use crate::trimmed::{Centre, centre, degrees_of_freedom};
use serde::{Deserialize, Serialize};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// The variance of a median of n normal values is this over n.
const OF_MEDIAN: f64 = std::f64::consts::FRAC_PI_2;

/// Fewest processes for an interval: with two, Student's t multiplies the standard error by 12.7.
pub const FEWEST_PROCESSES: usize = 3;

/// A ratio of two kinds of runs, from adjacent pairs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PairedRatio {
    /// The geometric mean over processes, of many without the farthest, with its interval.
    pub ratio: Estimate,
    pub pairs: usize,
    /// Processes: the independent values.
    pub processes: usize,
    /// The spread of ratios, for plans.
    pub spread: Spread,
}

/// Standard deviations of logarithms of ratios.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Spread {
    /// Of pairs within a process; 0 if each process has one pair, whose spread then belongs to the processes.
    pub within: f64,
    /// Of processes, without the part that pairs contribute.
    pub between: f64,
}

/// Returns the ratio from the pairs of each process; `None` below [`FEWEST_PROCESSES`], for a process without pairs, for
/// ratios that are not positive and finite, or without any spread.
pub fn paired_ratio(processes: &[Vec<f64>], level: f64) -> Option<PairedRatio> {
    let ratio = log_ratio(processes)?.estimate(level)?.exp()?;
    let pairs = processes.iter().map(Vec::len).sum();
    Some(PairedRatio { ratio, pairs, processes: processes.len(), spread: spread(processes)? })
}

/// The logarithm of the ratio with its error; `None` as for [`paired_ratio`].
pub fn log_ratio(processes: &[Vec<f64>]) -> Option<Measured> {
    let logarithms = logarithms(processes).filter(|all| all.len() >= FEWEST_PROCESSES)?;
    let medians = logarithms.iter().map(|own| median(own)).collect::<Option<Vec<f64>>>()?;
    let Centre { value, standard_error, degrees_of_freedom } = centre(&medians)?;
    Some(Measured { value, standard_error, degrees_of_freedom: degrees_of_freedom as f64, units: processes.len() })
}

/// The pairs of each process, from ratios with the numbers of their processes.
pub fn by_process(ratios: impl IntoIterator<Item = (u32, f64)>) -> Vec<Vec<f64>> {
    let mut processes: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
    for (process, ratio) in ratios {
        processes.entry(process).or_default().push(ratio);
    }
    processes.into_values().collect()
}

/// The probability, if the ratio were 1 or more, that the processes show one as small as this or smaller (Student's t).
/// 1 where [`paired_ratio`] has no answer.
pub fn p_of_less(processes: &[Vec<f64>]) -> f64 {
    let t = log_ratio(processes).and_then(|Measured { value, standard_error, degrees_of_freedom, .. }| {
        Some((value / standard_error, StudentsT::new(0.0, 1.0, degrees_of_freedom).ok()?))
    });
    t.map_or(1.0, |(t, law)| law.cdf(t))
}

/// Returns the spread of ratios within and between processes; `None` below two processes.
pub fn spread(processes: &[Vec<f64>]) -> Option<Spread> {
    spread_of(&logarithms(processes)?, 1.0)
}

/// Confidence that the spread between processes is no larger than a cautious plan takes it for.
const CAUTIOUS: f64 = 0.8;

/// The spread with which few processes promise a precision: that between them is taken at the upper end of its one-sided
/// interval of 80 %, because a few are often alike by chance (R. H. Browne, "On the use of a pilot sample for sample size
/// determination", Statistics in Medicine 14, 1995).
pub fn cautious_spread(processes: &[Vec<f64>]) -> Option<Spread> {
    let degrees = processes.len().checked_sub(1).filter(|degrees| *degrees > 0)? as f64;
    let least = ChiSquared::new(degrees).ok()?.inverse_cdf(1.0 - CAUTIOUS);
    spread_of(&logarithms(processes)?, degrees / least)
}

fn logarithms(processes: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let is_ratio = |ratio: &f64| *ratio > 0.0 && ratio.is_finite();
    let are_ratios = |own: &Vec<f64>| !own.is_empty() && own.iter().all(is_ratio);
    let of_process = |own: &Vec<f64>| own.iter().map(|ratio| libm::log(*ratio)).collect();
    processes.iter().all(are_ratios).then(|| processes.iter().map(of_process).collect())
}

/// The robust standard deviation of values: their median distance from the median, as for normal values.
fn deviation(values: &[f64]) -> Option<f64> {
    const OF_NORMAL: f64 = 1.482_602_218_505_602;
    let middle = median(values)?;
    let distances: Vec<f64> = values.iter().map(|value| (value - middle).abs()).collect();
    Some(OF_NORMAL * median(&distances)?)
}

/// The spread, with the variance of processes multiplied by a factor of caution.
fn spread_of(logarithms: &[Vec<f64>], caution: f64) -> Option<Spread> {
    let within: Vec<f64> = logarithms.iter().filter(|own| own.len() > 1).filter_map(|own| deviation(own)).collect();
    let within = median(&within).unwrap_or(0.0);
    let values = logarithms.iter().map(|own| median(own)).collect::<Option<Vec<f64>>>()?;
    let pairs = logarithms.len() as f64 / logarithms.iter().map(|own| 1.0 / own.len() as f64).sum::<f64>();
    let all = caution * Moments::of(&values).sample_variance()?;
    Some(Spread { within, between: (all - OF_MEDIAN * within * within / pairs).max(0.0).sqrt() })
}

/// The durations of a measurement by pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Costs {
    pub pair_s: f64,
    /// Seconds to start a process and warm it up.
    pub process_s: f64,
}

/// A number of pairs that reaches a precision.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PowerPlan {
    pub processes: usize,
    pub pairs: usize,
    /// Expected half width of the interval, as a share of the ratio.
    pub half_width: f64,
    pub seconds: f64,
}

/// Most processes and pairs in a process that a plan considers.
const MOST: usize = 1 << 12;

impl Spread {
    /// The expected half width of an interval, as a share of the ratio.
    pub fn half_width(&self, processes: usize, pairs: usize, level: f64) -> Option<f64> {
        let t = t_quantile(level, degrees_of_freedom(processes)?)?;
        let variance = self.between * self.between + OF_MEDIAN * self.within * self.within / pairs.max(1) as f64;
        Some(libm::expm1(t * (variance / processes as f64).sqrt()))
    }

    /// The plan with the narrowest interval that takes at most so many seconds; `None` if no plan does.
    pub fn narrowest(&self, seconds: f64, level: f64, costs: Costs) -> Option<PowerPlan> {
        let plans = (FEWEST_PROCESSES..=MOST).map_while(|processes| {
            let pairs = ((seconds / processes as f64 - costs.process_s) / costs.pair_s).floor();
            // A NaN ends the search, too.
            let pairs = (pairs >= 1.0).then(|| (pairs as usize).min(MOST))?;
            let half_width = self.half_width(processes, pairs, level)?;
            let seconds = processes as f64 * (costs.process_s + pairs as f64 * costs.pair_s);
            Some(PowerPlan { processes, pairs, half_width, seconds })
        });
        plans.min_by(|a, b| a.half_width.total_cmp(&b.half_width))
    }

    /// The cheapest plan for a half width of at most `share` of the ratio; `None` if none is short enough to be tried.
    ///
    /// For a number of processes, the fewest pairs that reach the precision cost least.
    pub fn plan(&self, share: f64, level: f64, costs: Costs) -> Option<PowerPlan> {
        if !is_level(level) || share.is_nan() || share <= 0.0 {
            return None;
        }
        let plans = (FEWEST_PROCESSES..=MOST).filter_map(|processes| {
            let enough = |pairs: usize| self.half_width(processes, pairs, level).is_some_and(|width| width <= share);
            let pairs = smallest(0, MOST, enough)?;
            let seconds = processes as f64 * (costs.process_s + pairs as f64 * costs.pair_s);
            Some(PowerPlan { processes, pairs, half_width: self.half_width(processes, pairs, level)?, seconds })
        });
        // More processes than needed for single pairs only add to the cost.
        let mut best: Option<PowerPlan> = None;
        for plan in plans {
            if best.is_none_or(|best| plan.seconds < best.seconds) {
                best = Some(plan);
            }
            if plan.pairs == 1 {
                break;
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use rand_pcg::Pcg64Dxsm;

    /// With two degrees of freedom, a fifth of chi-squared lies below -2 ln .8.
    #[test]
    fn a_cautious_spread_is_the_upper_end_of_its_interval() {
        let processes = [-1.0_f64, 0.0, 1.0].map(|log| vec![libm::exp(0.01 * log)]);
        let [plain, cautious] = [spread(&processes), cautious_spread(&processes)].map(|spread| spread.unwrap().between);
        assert!((plain - 0.01).abs() < 1e-12);
        assert!((cautious / plain - (2.0 / (-2.0 * libm::log(0.8))).sqrt()).abs() < 1e-6, "{cautious}");
        assert_eq!(cautious_spread(&processes[..1]), None);
    }

    /// A machine as it disturbs runs: its speed drifts, bursts of other programs slow some runs, a host takes a processor
    /// away for a while, and each process has a layout that favours one side.
    struct Machine {
        generator: Pcg64Dxsm,
        drift: f64,
        stolen: u32,
        layout: f64,
    }

    impl Machine {
        fn new(seed: u128) -> Self {
            Self { generator: Pcg64Dxsm::new(seed, 7), drift: 0.0, stolen: 0, layout: 0.0 }
        }

        fn unit(&mut self) -> f64 {
            ((self.generator.next_u64() >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
        }

        fn normal(&mut self) -> f64 {
            let radius = (-2.0 * libm::log(self.unit())).sqrt();
            radius * libm::cos(std::f64::consts::TAU * self.unit())
        }

        fn start_process(&mut self) {
            self.layout = 0.003 * self.normal();
        }

        /// The seconds of a run of that length; `side` is 1 or -1.
        fn run(&mut self, seconds: f64, side: f64) -> f64 {
            self.drift += 0.004 * self.normal();
            let other = if self.unit() < 0.05 { 0.3 * self.unit() } else { 0.0 };
            if self.stolen == 0 && self.unit() < 0.01 {
                self.stolen = 1 + (20.0 * self.unit()) as u32;
            }
            let stolen = if self.stolen > 0 { 0.5 } else { 0.0 };
            self.stolen = self.stolen.saturating_sub(1);
            let noise = 0.01 * self.normal() + 0.5 * side * self.layout;
            seconds * libm::exp(self.drift + noise + other + stolen)
        }

        /// The ratios of pairs in alternating order, by process.
        fn pairs(&mut self, processes: usize, pairs: usize, ratio: f64) -> Vec<Vec<f64>> {
            let process = |machine: &mut Self| {
                machine.start_process();
                let pair = |number: usize, machine: &mut Self| {
                    if number.is_multiple_of(2) {
                        let first = machine.run(ratio, 1.0);
                        first / machine.run(1.0, -1.0)
                    } else {
                        let second = machine.run(1.0, -1.0);
                        machine.run(ratio, 1.0) / second
                    }
                };
                (0..pairs).map(|number| pair(number, machine)).collect()
            };
            (0..processes).map(|_| process(self)).collect()
        }
    }

    /// Level of the test: with a coverage of exactly 95 %, fewer than 181 of 200 have a probability of 0.5 %, and the
    /// seed is fixed.
    #[test]
    fn intervals_cover_the_ratio_on_a_machine_that_disturbs() {
        for (ratio, processes, pairs) in [(1.0, 8, 30), (1.013, 8, 30), (0.5, 8, 30), (1.0, 16, 5), (0.98, 16, 5)] {
            let covered = (0..200).filter(|seed| {
                let found = paired_ratio(&Machine::new(1 + *seed).pairs(processes, pairs, ratio), 0.95).unwrap();
                assert_eq!((found.pairs, found.processes), (processes * pairs, processes));
                found.ratio.interval.contains(ratio)
            });
            let covered = covered.count();
            assert!(covered >= 186, "{ratio}, {processes} x {pairs}: {covered} of 200");
        }
    }

    /// A/A: of sweeps that compare a program with itself, 5 % find a difference. With a level of exactly 5 %, more than 557 of
    /// 10 000 have a probability of 0.5 %; a level of 6 % would be seen with a probability of 96 %.
    #[test]
    fn equal_sides_differ_in_one_sweep_of_twenty() {
        for (processes, pairs) in [(8, 30), (16, 5)] {
            let differ = (0..10_000).filter(|seed| {
                let found = paired_ratio(&Machine::new(5000 + *seed).pairs(processes, pairs, 1.0), 0.95).unwrap();
                !found.ratio.interval.contains(1.0)
            });
            let differ = differ.count();
            println!("{processes} x {pairs}: {differ} of 10 000");
            assert!(differ <= 557, "{processes} x {pairs}: {differ} of 10 000");
        }
    }

    /// Pairs of one process repeat its layout, so an interval from them alone would miss the ratio far too often.
    #[test]
    fn pairs_of_one_process_tell_too_little() {
        let missed = (0..200).filter(|seed| {
            let pairs = Machine::new(1000 + *seed).pairs(1, 240, 1.0);
            let interval = crate::quantile::median_interval(&pairs[0], 0.95).unwrap();
            !interval.contains(1.0)
        });
        assert!(missed.count() > 50);
        let one = Machine::new(1).pairs(2, 240, 1.0);
        assert_eq!(paired_ratio(&one, 0.95), None);
    }

    #[test]
    fn ratios_without_an_answer_have_none() {
        let alike = vec![vec![2.0, 2.0]; 3];
        assert_eq!(paired_ratio(&alike, 0.95), None);
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(paired_ratio(&[vec![1.0], vec![1.1], vec![wrong]], 0.95), None);
        }
        assert_eq!(paired_ratio(&[vec![1.0], vec![1.1], vec![]], 0.95), None);
        assert_eq!(paired_ratio(&[], 0.95), None);
    }

    /// Three processes of one pair each: log ratios -d, 0, d have the standard error d / √3, and t is 4.303.
    #[test]
    fn the_interval_is_students() {
        let d = 0.1;
        let processes = [-d, 0.0, d].map(|value| vec![libm::exp(value)]);
        let moments = Moments::of(&[-d, 0.0, d]);
        assert!((moments.standard_error().unwrap() - d / 3.0_f64.sqrt()).abs() < 1e-15);
        let expected = libm::exp(4.302_652_729_911_275 * d / 3.0_f64.sqrt());
        // Repeated pairs of a process add nothing.
        for processes in [processes.clone(), processes.map(|own| vec![own[0]; 2])] {
            let found = paired_ratio(&processes, 0.95).unwrap();
            assert!((found.ratio.value - 1.0).abs() < 1e-12);
            assert!((found.ratio.interval.high - expected).abs() < 1e-9, "{found:?}");
            assert!((found.spread.between - d).abs() < 1e-12 && found.spread.within == 0.0);
        }
    }

    /// Student's t with two degrees of freedom has the closed form 1/2 + t / (2 √(2 + t²)).
    #[test]
    fn small_ratios_have_small_probabilities() {
        let processes = |shift: f64| [-0.1, 0.0, 0.1].map(|value| vec![libm::exp(value + shift)]);
        for shift in [-0.3, -0.01, 0.0, 0.2] {
            let t = shift / (0.1 / 3.0_f64.sqrt());
            let expected = 0.5 + t / (2.0 * (2.0 + t * t).sqrt());
            assert!((p_of_less(&processes(shift)) - expected).abs() < 1e-9);
        }
        assert_eq!(p_of_less(&[vec![0.5], vec![0.6]]), 1.0);
        assert_eq!(by_process([(3, 1.0), (1, 2.0), (3, 4.0)]), [vec![2.0], vec![1.0, 4.0]]);
    }

    /// Expensive processes ask for more pairs in each, cheap ones for single pairs; a plan reaches its precision.
    #[test]
    fn plans_reach_their_precision_at_the_least_cost() {
        let spread = Spread { within: 0.05, between: 0.002 };
        let cheap = Costs { pair_s: 1.0, process_s: 0.0 };
        let dear = Costs { pair_s: 0.02, process_s: 1.0 };
        let [few, many] = [cheap, dear].map(|costs| spread.plan(0.01, 0.95, costs).unwrap());
        assert!(few.half_width <= 0.01 && many.half_width <= 0.01);
        assert!(few.pairs < many.pairs && few.processes > many.processes, "{few:?} {many:?}");
        for plan in [few, many] {
            let costs = if plan == few { cheap } else { dear };
            for processes in [plan.processes - 1, plan.processes + 1].into_iter().filter(|n| *n >= FEWEST_PROCESSES) {
                let enough = (1..=MOST).find(|n| spread.half_width(processes, *n, 0.95).unwrap() <= 0.01);
                let cost = |pairs: usize| processes as f64 * (costs.process_s + pairs as f64 * costs.pair_s);
                assert!(enough.is_none_or(|pairs| cost(pairs) >= plan.seconds), "{processes} {plan:?}");
            }
        }
        assert_eq!(spread.plan(1e-9, 0.95, cheap), None);
        assert_eq!(spread.plan(0.0, 0.95, cheap), None);
    }

    /// A plan for a narrower interval takes longer.
    #[test]
    fn the_narrowest_interval_of_a_time_is_that_of_the_cheapest_plan() {
        let spread = Spread { within: 0.05, between: 0.002 };
        let costs = Costs { pair_s: 0.02, process_s: 1.0 };
        let found = spread.narrowest(60.0, 0.95, costs).unwrap();
        assert!(found.seconds <= 60.0, "{found:?}");
        assert_eq!(spread.half_width(found.processes, found.pairs, 0.95), Some(found.half_width));
        let finer = spread.plan(0.99 * found.half_width, 0.95, costs).unwrap();
        assert!(finer.seconds > 60.0, "{found:?} {finer:?}");
        assert_eq!(spread.narrowest(2.0, 0.95, costs), None);
        assert_eq!(spread.narrowest(f64::NAN, 0.95, costs), None);
    }

    /// Without disturbances other than layout and noise, the spreads are those of the machine.
    #[test]
    fn spreads_are_found_again() {
        let mut machine = Machine::new(3);
        let processes: Vec<Vec<f64>> = (0..200)
            .map(|_| {
                let layout = 0.01 * machine.normal();
                (0..50).map(|_| libm::exp(layout + 0.03 * machine.normal())).collect()
            })
            .collect();
        let Spread { within, between } = spread(&processes).unwrap();
        assert!((within - 0.03).abs() < 0.002 && (between - 0.01).abs() < 0.002, "{within} {between}");
    }
}
