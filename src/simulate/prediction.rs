//! The real machine predicted: measured makespans beside those that the simulator finds for the same jobs.

use super::contender::Contender;
use super::hardware::Hardware;
use crate::analysis::quantile::median;
use std::collections::BTreeMap;

/// Relative difference in CPU time from which a run, or the serial one beside it, was disturbed by something that is no schedule.
pub const DISTURBED: f64 = 0.1;

/// A measured run.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// How the film was cut.
    pub decomposition: String,
    /// Strategy, with its parameter if it has one.
    pub strategy: String,
    /// Its workers.
    pub workers: usize,
    /// What it took, in seconds.
    pub makespan_s: f64,
    /// Its CPU time over that of the serial run beside it; 1 if that is not known. Above 1 the jobs themselves took longer than the serial run
    /// says, which no schedule can help: processors that share a core, a lower clock.
    pub inflation: f64,
}

/// The runs of one schedule, predicted.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// How the film was cut.
    pub decomposition: String,
    /// Strategy.
    pub strategy: String,
    /// Its workers.
    pub workers: usize,
    /// How many runs there were.
    pub runs: usize,
    /// Median of what the simulator finds, in seconds.
    pub predicted_s: f64,
    /// Median of what was measured, in seconds.
    pub measured_s: f64,
    /// How many of them were undisturbed: their CPU time is within [`DISTURBED`] of that of the serial run beside them.
    pub undisturbed: usize,
    /// Median of predicted over measured, over the undisturbed runs; `None` if there is none.
    pub undisturbed_ratio: Option<f64>,
    /// Median of predicted over measured, run by run, for jobs that cost what they cost the serial run.
    pub plain_ratio: f64,
    /// The same for jobs that cost more by the run's inflation.
    pub ratio: f64,
}

/// Predicts each run from the costs of its jobs, which should come from a serial run made beside it; runs of no contender are left out.
///
/// A strategy with a thread for each job runs on all processors of this machine, however many threads it has.
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
        // Predicted 2, 4, 6 against 2, 5, 8: ratios 1, .8, .75.
        assert_eq!((found[0].runs, found[0].predicted_s, found[0].measured_s, found[0].ratio), (3, 4.0, 5.0, 0.8));
        assert_eq!((found[0].plain_ratio, found[0].undisturbed, found[0].undisturbed_ratio), (0.8, 3, Some(0.8)));

        let inflated = Observed { inflation: 1.5, ..run(3.0) };
        let found = predict([(inflated, &[1.0, 1.0][..])], &[contender], 2);
        assert_eq!((found[0].predicted_s, found[0].ratio, found[0].plain_ratio), (2.0, 1.0, 2.0 / 3.0));
        assert_eq!((found[0].undisturbed, found[0].undisturbed_ratio), (0, None));
    }
}
