//! Rank rules: the assignment of jobs to ranks.
//!
//! `--ranks static-blocks | static-cyclic | dynamic:C | guided | ... | master-worker:C | working-master:C | awf-b`
//!
//! Deals and chunk rules are those of the strategies with the same names. If chunks are pure functions of their number,
//! a free rank increments a counter in the memory of rank 0 and looks up the chunk of that number. A master answers
//! requests by messages instead. If chunks depend on the speeds of the ranks, a rank's request reports the time of its
//! last chunk.

use super::Lab;
use crate::error::{InputError, Result};
use crate::strategy::{ChunkRule, Deal, Discipline, LearnedRule};
use std::fmt;
use std::time::Duration;

/// Rank 0 hands out chunks of C jobs by messages, and renders nothing.
const MASTER_WORKER: &str = "master-worker";
/// Rank 0 hands out chunks of C jobs by messages, between its own chunks.
const WORKING_MASTER: &str = "working-master";

/// The names of the rules. All except the master rules are strategies of the same names.
const RULES: [&str; 13] = [
    "static-blocks",
    "static-cyclic",
    "dynamic",
    "guided",
    "trapezoid",
    "factoring",
    "mfac",
    "weighted-factoring",
    "awf-b",
    "awf-c",
    "adaptive-factoring",
    MASTER_WORKER,
    WORKING_MASTER,
];

/// Interval at which rank 0 checks for requests of the other ranks while it renders. Some MPI libraries answer them
/// without its help, others only when it calls MPI. A check takes some microseconds and interrupts the rendering
/// thread: an interval of 0.2 ms cost 2 to 3 % of the makespan.
pub const LOOK: Duration = Duration::from_millis(1);

/// Chunks up to this fraction of a rank's average share are small.
const SMALL: f64 = 1.0 / 32.0;

/// Returns whether a rank that uses the counter asks for its next chunk while it still renders one of `chunk` jobs.
/// Asking early saves time, because the answer may need rank 0, which renders, too. But with large chunks a rank that
/// asks early soon has more than its share.
pub fn is_small(chunk: usize, jobs: usize, ranks: usize) -> bool {
    chunk as f64 <= SMALL * jobs as f64 / ranks as f64
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Master {
    /// Rank 0, which renders nothing.
    Only,
    /// Rank 0, between its own chunks.
    Working,
}

#[derive(Debug, Clone, Copy)]
pub enum Distribution {
    /// Each rank knows its jobs beforehand.
    Static(Deal),
    /// A free rank takes the next number from a counter in the memory of rank 0.
    SharedCounter(ChunkRule),
    /// A free rank asks rank 0.
    Master(Master, ChunkRule),
    /// A free rank asks rank 0, which also renders, and reports the time of its last chunk.
    Adaptive(LearnedRule),
}

/// A rank rule, with its text as the user wrote it.
#[derive(Debug, Clone)]
pub struct RankRule {
    text: String,
    distribution: Distribution,
}

impl fmt::Display for RankRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl RankRule {
    pub fn distribution(&self) -> Distribution {
        self.distribution
    }

    pub fn check(&self, ranks: usize) -> Result<()> {
        match self.distribution {
            Distribution::Master(Master::Only, _) if ranks < 2 => {
                let problem = format!("needs at least one rank besides the master, but the number of ranks is {ranks}");
                let error = InputError::new("ranks", &self.text, problem);
                Err(error.allowed("2 ranks or more, as in mpiexec -n 2").into())
            }
            _ => Ok(()),
        }
    }
}

impl Lab {
    /// Returns the rule that `text` names, with the parameter after the colon if there is one. `field` is the source of
    /// the text: an option or an axis.
    pub fn rank_rule(&self, field: &'static str, text: &str) -> Result<RankRule> {
        let (name, parameter) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
        let distribution = match name {
            MASTER_WORKER => chunks_of(parameter).map(|rule| Distribution::Master(Master::Only, rule)),
            WORKING_MASTER => chunks_of(parameter).map(|rule| Distribution::Master(Master::Working, rule)),
            _ if RULES.contains(&name) => self.distribution_of_strategy(name, parameter),
            _ => None,
        };
        distribution.map(|distribution| RankRule { text: text.to_string(), distribution }).ok_or_else(|| {
            let problem = "is not a valid rule for sharing jobs among processes";
            InputError::new(field, text, problem).allowed(RULES.join(", ")).into()
        })
    }

    fn distribution_of_strategy(&self, name: &str, parameter: Option<&str>) -> Option<Distribution> {
        let entry = self.strategies().iter().find(|entry| entry.name == name)?;
        match entry.discipline(parameter).ok()? {
            Discipline::Chunks(rule) => Some(Distribution::SharedCounter(rule)),
            Discipline::Learned(rule) => Some(Distribution::Adaptive(rule)),
            Discipline::Dealt(deal) => Some(Distribution::Static(deal)),
            _ => None,
        }
    }
}

/// Parses the chunk size of a master; without text it is 1. `None` if it is not a number above 0.
fn chunks_of(text: Option<&str>) -> Option<ChunkRule> {
    let parameter = text.map_or(Some(1), |text| text.parse().ok().filter(|size| *size > 0))?;
    Some(ChunkRule { size: |handout| handout.parameter, parameter })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_that_is_listed_can_be_read_and_others_cannot() {
        let lab = Lab::built_in();
        for text in RULES.into_iter().chain([
            "dynamic:3",
            "master-worker:3",
            "working-master:3",
            "mfac:50",
            "weighted-factoring:1:0.5",
        ]) {
            let rule = lab.rank_rule("ranks", text).unwrap();
            assert_eq!(rule.check(1).is_err(), text.starts_with("master-worker"), "{text}");
            assert!(rule.check(2).is_ok());
        }
        for text in ["work-stealing", "serial", "rayon", "", "dynamic:0", "master-worker:0", "master-worker:x", "x:1"] {
            assert_eq!(lab.rank_rule("ranks", text).unwrap_err().exit_code(), 2, "{text}");
        }
    }
}
