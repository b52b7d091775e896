//! The power plan of a sweep: how many pairs give which precision, and how long they take.
//!
//! A pilot runs some pairs of each group in a few processes. Its spreads within and between processes give the cheapest
//! numbers of processes and pairs for an interval (T. Kalibera and R. Jones, "Rigorous Benchmarking in Reasonable Time",
//! ISMM 2013, section 7).

use super::pairs::{Contestant, run_pairs};
use super::sweep::Sweep;
use crate::analysis::adjacent_pairs::{Costs, PowerPlan, Spread, by_process, spread};
use crate::error::Result;
use crate::measure::Record;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Processes and pairs of the pilot.
const PROCESSES: u32 = 4;
const PAIRS: u32 = 4;
/// The time after which no other group is tried.
const MOST: Duration = Duration::from_secs(20);
/// Halves of intervals that are planned for.
const SHARES: [f64; 3] = [0.03, 0.02, 0.01];
const LEVEL: f64 = 0.95;

/// The pairs that a group of cells needs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Power {
    /// The cell with which most others of the group are compared.
    pub with: String,
    pub comparisons: usize,
    /// Seconds of a round, in which each cell runs once.
    pub round_s: f64,
    /// For each half of an interval, as a share of the ratio, the plan that reaches it in every comparison of the group;
    /// `None` if none does.
    pub plans: Vec<(f64, Option<PowerPlan>)>,
}

impl Sweep<'_> {
    /// Plans the pairs of each group, from a pilot.
    pub fn power(&self) -> Result<Vec<Power>> {
        let (begun, mut found) = (Instant::now(), Vec::new());
        for group in self.comparisons.groups(self.cells.len()) {
            if begun.elapsed() >= MOST {
                break;
            }
            let mut times: BTreeMap<usize, BTreeMap<(u32, Option<u32>), f64>> = BTreeMap::new();
            let mut seconds = 0.0;
            for process in 0..PROCESSES {
                let own = std::env::current_exe().map_err(|e| format!("finding this program: {e}"));
                let job = |index: &usize| self.job(&self.cells[*index], (process, 0), &self.options.out, &[], None);
                let contestant = |index| Contestant::new(job(index).alone(), own.clone(), None);
                let mut contestants: Vec<Contestant> = group.iter().map(contestant).collect();
                let before = Instant::now();
                for (at, Record { pair, makespan_s, runs, .. }) in
                    run_pairs(&mut contestants, PAIRS, &self.definition.name, process)
                {
                    seconds += makespan_s.unwrap_or(0.0) * f64::from(runs.unwrap_or(1));
                    makespan_s.and_then(|time| times.entry(group[at]).or_default().insert((process, pair), time));
                }
                drop(contestants);
                if process == 0 && before.elapsed() > MOST {
                    break;
                }
            }
            found.extend(self.plan_of(&group, &times, seconds));
        }
        Ok(found)
    }

    fn plan_of(
        &self,
        group: &[usize],
        times: &BTreeMap<usize, BTreeMap<(u32, Option<u32>), f64>>,
        seconds: f64,
    ) -> Option<Power> {
        let own = || self.comparisons.pairs.iter().filter(|pair| group.contains(&pair.what));
        let spreads: Vec<Spread> = own()
            .filter_map(|pair| {
                let (what, with) = (times.get(&pair.what)?, times.get(&pair.with)?);
                let ratios = what.iter().filter_map(|(turn, time)| Some((turn.0, time / with.get(turn)?)));
                spread(&by_process(ratios))
            })
            .collect();
        let rounds = times.values().map(BTreeMap::len).max().unwrap_or(0);
        let round_s = seconds / rounds.max(1) as f64;
        // A process runs each cell once before it counts.
        let costs = Costs { pair_s: round_s, process_s: round_s + START_S * group.len() as f64 };
        let plans = SHARES.map(|share| {
            let each: Option<Vec<PowerPlan>> = spreads.iter().map(|spread| spread.plan(share, LEVEL, costs)).collect();
            (share, each.and_then(|each| each.into_iter().max_by(|a, b| a.seconds.total_cmp(&b.seconds))))
        });
        let with = own().map(|pair| pair.with);
        let with = group.iter().max_by_key(|index| with.clone().filter(|with| with == *index).count())?;
        Some(Power { with: self.cells[*with].id.clone(), comparisons: spreads.len(), round_s, plans: plans.to_vec() })
    }
}

/// Seconds to start a cell's process.
const START_S: f64 = 0.03;
