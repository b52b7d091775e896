//! Predictions for the real machine: measured makespans beside simulated ones of the same jobs.

use super::contender::Contender;
use super::hardware::Hardware;
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
    pub makespan_s: f64,
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
    /// The same, with each run's job costs multiplied by its inflation.
    pub ratio: f64,
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
    let mut groups: BTreeMap<(String, String, usize), Vec<[f64; 4]>> = BTreeMap::new();
    for (run, costs) in runs {
        let Some(contender) = contenders.iter().find(|contender| contender.name == run.strategy) else { continue };
        let workers = if contender.has_a_thread_per_job() { processors } else { run.workers };
        let replayed = |costs: &[f64]| contender.replay(costs, workers, &Hardware::default()).makespan_s;
        let inflated: Vec<f64> = costs.iter().map(|cost| cost * run.inflation).collect();
        let (predicted_s, plain_s) = (replayed(&inflated), replayed(costs));
        let key = (run.strategy, run.decomposition, run.workers);
        groups.entry(key).or_default().push([predicted_s, run.makespan_s, plain_s, run.inflation]);
    }
    let prediction = |((strategy, decomposition, workers), runs): ((String, String, usize), Vec<[f64; 4]>)| {
        let middle = |value: fn(&[f64; 4]) -> f64| median(&runs.iter().map(value).collect::<Vec<f64>>());
        let quiet = runs.iter().filter(|run| (run[3] - 1.0).abs() <= DISTURBED);
        let quiet: Vec<f64> = quiet.map(|run| run[2] / run[1]).collect();
        Some(Prediction {
            undisturbed: quiet.len(),
            undisturbed_ratio: median(&quiet),
            decomposition,
            strategy,
            workers,
            runs: runs.len(),
            predicted_s: middle(|run| run[2])?,
            measured_s: middle(|run| run[1])?,
            ratio: middle(|run| run[0] / run[1])?,
            plain_ratio: middle(|run| run[2] / run[1])?,
        })
    };
    groups.into_iter().filter_map(prediction).collect()
}

/// Relative errors of predictions, as (predicted - measured) / measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Agreement {
    /// The median error; a value far from 0 shows a systematic error.
    pub bias: f64,
    pub median_absolute: f64,
    pub worst_absolute: f64,
}

/// Compares pairs of (predicted, measured) seconds; `None` without pairs.
pub fn agreement(pairs: &[(f64, f64)]) -> Option<Agreement> {
    let errors: Vec<f64> = pairs.iter().map(|(predicted, measured)| (predicted - measured) / measured).collect();
    let absolute: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    let median_absolute = median(&absolute)?;
    let worst_absolute = absolute.iter().copied().fold(0.0, f64::max);
    Some(Agreement { bias: median(&errors)?, median_absolute, worst_absolute })
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
        };
        let run = |makespan_s| Observed {
            decomposition: "rows".into(),
            strategy: "serial".into(),
            workers: 1,
            makespan_s,
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

    #[test]
    fn errors_by_hand() {
        let of = agreement(&[(1.0, 2.0), (3.0, 2.0), (2.5, 2.0), (2.0, 2.0)]).unwrap();
        assert_eq!((of.bias, of.median_absolute, of.worst_absolute), (0.125, 0.375, 0.5));
        assert_eq!(agreement(&[]), None);
    }
}
