//! Predictions for the real machine: measured makespans beside simulated ones of the same jobs.

use super::contender::Contender;
use super::hardware::Hardware;
use super::inflation::{BusyRatio, WorkInflation};
use crate::analysis::quantile::median;
use std::collections::BTreeMap;

/// Relative difference in CPU time above which a run, or the serial run beside it, counts as disturbed: no schedule
/// causes it.
pub const DISTURBED: f64 = 0.1;

#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    pub decomposition: String,
    pub strategy: String,
    pub workers: usize,
    pub repetition: u32,
    pub makespan_s: f64,
    /// Seconds inside jobs over those of the serial run beside it; `None` if unknown, or if the workers shared
    /// processors.
    pub busy: Option<f64>,
    /// Its CPU time over the CPU time of the serial run beside it; 1 if unknown. Above 1, the jobs themselves took
    /// longer than in the serial run, which no schedule can mend: processors share a core, or the clock rate is lower.
    pub inflation: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    pub decomposition: String,
    pub strategy: String,
    pub workers: usize,
    pub runs: usize,
    pub predicted_s: f64,
    pub measured_s: f64,
    /// Number of undisturbed runs: their CPU time is within [`DISTURBED`] of the serial run's beside them.
    pub undisturbed: usize,
    /// Median of predicted over measured, over the undisturbed runs; `None` if there is none.
    pub undisturbed_ratio: Option<f64>,
    /// Median of predicted over measured, run by run, for jobs with the costs of the serial run.
    pub plain_ratio: f64,
    /// The same, with the costs multiplied by the work inflation that other repetitions had on as many workers; `None`
    /// if there is no other repetition.
    pub modelled_ratio: Option<f64>,
    /// The same, with each run's job costs multiplied by its own inflation, which is no prediction.
    pub ratio: f64,
}

struct Replayed {
    measured_s: f64,
    plain_s: f64,
    modelled_s: Option<f64>,
    told_s: f64,
    inflation: f64,
}

/// Predicts each run from the costs of its jobs, ideally from a serial run made beside it; runs without a contender are
/// left out.
///
/// A strategy with a thread for each job runs on all `processors` of this machine, whatever its number of threads.
pub fn predict<'a>(
    runs: impl IntoIterator<Item = (Observed, &'a [f64])>,
    contenders: &[Contender],
    processors: usize,
) -> Vec<Prediction> {
    let runs: Vec<(Observed, &[f64])> = runs.into_iter().collect();
    let ratios = busy_ratios(runs.iter().map(|(run, _)| run));
    let mut groups: BTreeMap<(String, String, usize), Vec<Replayed>> = BTreeMap::new();
    for (run, costs) in runs {
        let Some(contender) = contenders.iter().find(|contender| contender.name == run.strategy) else { continue };
        let workers = if contender.has_a_thread_per_job() { processors } else { run.workers };
        let replayed = |factor: f64| {
            let costs: Vec<f64> = costs.iter().map(|cost| cost * factor).collect();
            contender.replay(&costs, workers, &Hardware::default()).makespan_s
        };
        let of_others = WorkInflation::of(&ratios, Some(run.repetition)).at(workers);
        let own = Replayed {
            measured_s: run.makespan_s,
            plain_s: replayed(1.0),
            modelled_s: of_others.map(replayed),
            told_s: replayed(run.inflation),
            inflation: run.inflation,
        };
        groups.entry((run.strategy, run.decomposition, run.workers)).or_default().push(own);
    }
    let prediction = |((strategy, decomposition, workers), runs): ((String, String, usize), Vec<Replayed>)| {
        let middle = |value: fn(&Replayed) -> f64| median(&runs.iter().map(value).collect::<Vec<f64>>());
        let quiet = runs.iter().filter(|run| (run.inflation - 1.0).abs() <= DISTURBED);
        let quiet: Vec<f64> = quiet.map(|run| run.plain_s / run.measured_s).collect();
        let modelled = runs.iter().map(|run| Some(run.modelled_s? / run.measured_s)).collect::<Option<Vec<f64>>>();
        Some(Prediction {
            undisturbed: quiet.len(),
            undisturbed_ratio: median(&quiet),
            decomposition,
            strategy,
            workers,
            runs: runs.len(),
            predicted_s: middle(|run| run.plain_s)?,
            measured_s: middle(|run| run.measured_s)?,
            ratio: middle(|run| run.told_s / run.measured_s)?,
            modelled_ratio: modelled.and_then(|ratios| median(&ratios)),
            plain_ratio: middle(|run| run.plain_s / run.measured_s)?,
        })
    };
    groups.into_iter().filter_map(prediction).collect()
}

/// The known ratios of busy times.
pub fn busy_ratios<'a>(runs: impl IntoIterator<Item = &'a Observed>) -> Vec<BusyRatio> {
    let ratio = |run: &Observed| Some(BusyRatio { workers: run.workers, repetition: run.repetition, ratio: run.busy? });
    runs.into_iter().filter_map(ratio).collect()
}

/// Relative errors of predictions, as (predicted - measured) / measured.
#[derive(Debug, Clone, PartialEq)]
pub struct RelativeErrors {
    /// The median error; a value far from 0 shows a systematic error.
    pub bias: f64,
    pub median_absolute: f64,
    pub worst_absolute: f64,
}

/// Compares pairs of (predicted, measured) seconds; `None` without pairs.
pub fn relative_errors(pairs: &[(f64, f64)]) -> Option<RelativeErrors> {
    let errors: Vec<f64> = pairs.iter().map(|(predicted, measured)| (predicted - measured) / measured).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let median_absolute = median(&absolute)?;
    let worst_absolute = absolute.iter().copied().fold(0.0, f64::max);
    Some(RelativeErrors { bias: median(&errors)?, median_absolute, worst_absolute })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulate::Order;
    use crate::simulate::Overheads;
    use crate::strategy::Discipline;

    #[test]
    fn runs_are_paired_with_their_own_costs() {
        let contender = Contender {
            name: "serial".to_owned(),
            discipline: Discipline::InOrder,
            order: Order::ByIndex,
            overheads: Overheads::default(),
            calibrations: Vec::new(),
        };
        let run = |makespan_s| Observed {
            decomposition: "rows".into(),
            strategy: "serial".into(),
            workers: 1,
            repetition: 0,
            makespan_s,
            busy: None,
            inflation: 1.0,
        };
        let other = Observed { strategy: "unknown".into(), ..run(1.0) };
        let runs = [(run(2.0), &[1.0, 1.0][..]), (run(5.0), &[2.0, 2.0]), (run(8.0), &[3.0, 3.0]), (other, &[1.0])];
        let found = predict(runs, std::slice::from_ref(&contender), 2);
        assert_eq!(found.len(), 1);
        // Predicted 2, 4, 6; measured 2, 5, 8: ratios 1, .8, .75.
        assert_eq!((found[0].runs, found[0].predicted_s, found[0].measured_s, found[0].ratio), (3, 4.0, 5.0, 0.8));
        assert_eq!((found[0].plain_ratio, found[0].undisturbed, found[0].undisturbed_ratio), (0.8, 3, Some(0.8)));

        let inflated = Observed { inflation: 1.5, ..run(3.0) };
        let found = predict([(inflated, &[1.0, 1.0][..])], &[contender], 2);
        assert_eq!((found[0].predicted_s, found[0].ratio, found[0].plain_ratio), (2.0, 1.0, 2.0 / 3.0));
        assert_eq!((found[0].undisturbed, found[0].undisturbed_ratio), (0, None));
    }

    /// Two workers make every job 1.25 times as long. Four jobs of a second then take 2.5 s instead of 2 s: a prediction
    /// without the factor is 20 % too fast, one with the factor of the other repetition is right.
    #[test]
    fn work_inflation_of_other_repetitions_is_predicted() {
        let contender = Contender::longest_first();
        let run = |repetition, slower: f64| Observed {
            decomposition: "rows".into(),
            strategy: contender.name.clone(),
            workers: 2,
            repetition,
            makespan_s: 2.0 * slower,
            busy: Some(slower),
            inflation: slower,
        };
        let costs = [1.0; 4];
        let predicted = |slower: &[f64]| {
            let runs = slower.iter().enumerate().map(|(index, slower)| (run(index as u32, *slower), &costs[..]));
            predict(runs, std::slice::from_ref(&contender), 2).remove(0)
        };
        let found = predicted(&[1.25, 1.25]);
        assert!((found.plain_ratio - 0.8).abs() < 1e-12, "{found:?}");
        assert!((found.modelled_ratio.unwrap() - 1.0).abs() < 1e-12, "{found:?}");
        // A run never predicts itself: the ratios are 1.5 / 1.0 and 1.0 / 1.5.
        let found = predicted(&[1.0, 1.5]);
        assert!((found.modelled_ratio.unwrap() - 0.5 * (1.5 + 1.0 / 1.5)).abs() < 1e-12, "{found:?}");
        assert_eq!(predicted(&[1.25]).modelled_ratio, None);
    }

    #[test]
    fn errors_by_hand() {
        let of = relative_errors(&[(1.0, 2.0), (3.0, 2.0), (2.5, 2.0), (2.0, 2.0)]).unwrap();
        assert_eq!((of.bias, of.median_absolute, of.worst_absolute), (0.125, 0.375, 0.5));
        assert_eq!(relative_errors(&[]), None);
    }
}
