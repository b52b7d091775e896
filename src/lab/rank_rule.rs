//! Which rank does which jobs: `--ranks static-blocks | static-cyclic | dynamic:C | guided | ... | master-worker:C | working-master:C | awf-b`.
//!
//! Deals and rules are those of the strategies of the same names. Where chunks are pure functions of their number, a rank that is free counts up
//! one number in the memory of rank 0 and looks its chunk up. A master answers requests by messages instead. Where chunks depend on how fast the
//! ranks have been, a rank's request says how long its last chunk took.

use super::Lab;
use crate::error::{InputError, Result};
use crate::strategy::{ChunkRule, Deal, Discipline, LearnedRule};
use std::fmt;
use std::time::Duration;

/// Rank 0 hands out chunks of so many jobs by messages, and renders nothing.
const MASTER_WORKER: &str = "master-worker";
/// Rank 0 hands out chunks of so many jobs by messages, between its own.
const WORKING_MASTER: &str = "working-master";

/// The rules, by name. All but those of masters are the strategies of the same names.
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

/// How often rank 0 looks after the other ranks' requests while it renders. Some libraries answer them without its help, others only when it
/// calls MPI. Looking takes some microseconds, and the thread that renders is interrupted for it: every 0.2 ms cost 2 to 3 % of the makespan.
pub const LOOK: Duration = Duration::from_millis(1);

/// Chunks of at most this share of what each rank gets on average are small.
const SMALL: f64 = 1.0 / 32.0;

/// Whether a rank that counts asks for its next chunk while it renders one of so many jobs. The answer may need rank 0, which renders too; but
/// of large chunks who asks early has soon more than its share.
pub fn is_small(chunk: usize, jobs: usize, ranks: usize) -> bool {
    chunk as f64 <= SMALL * jobs as f64 / ranks as f64
}

/// Who hands out chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Master {
    /// Rank 0, which renders nothing.
    Only,
    /// Rank 0, between its own chunks.
    Working,
}

/// How jobs get to ranks.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    /// Each rank knows its jobs beforehand.
    Dealt(Deal),
    /// A rank that is free takes the next number from a counter in the memory of rank 0.
    Counted(ChunkRule),
    /// A rank that is free asks rank 0.
    Asked(Master, ChunkRule),
    /// A rank that is free asks rank 0, which renders beside that, and tells how long its last chunk took.
    Told(LearnedRule),
}

/// A rule, as the user named it.
#[derive(Debug, Clone)]
pub struct RankRule {
    text: String,
    way: Way,
}

impl fmt::Display for RankRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl RankRule {
    /// How jobs get to ranks under this rule.
    pub fn way(&self) -> Way {
        self.way
    }

    /// Refuses rules that so many ranks cannot follow.
    pub fn check(&self, ranks: usize) -> Result<()> {
        match self.way {
            Way::Asked(Master::Only, _) if ranks < 2 => {
                let problem = format!("needs a rank besides the master, and there is {ranks}");
                let error = InputError::new("ranks", &self.text, problem);
                Err(error.allowed("2 ranks or more, as by mpiexec -n 2").into())
            }
            _ => Ok(()),
        }
    }
}

impl Lab {
    /// The rule that `text` names, with a parameter if a colon follows. `field` is where the text comes from: an option or an axis.
    pub fn rank_rule(&self, field: &'static str, text: &str) -> Result<RankRule> {
        let (name, parameter) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
        let way = match name {
            MASTER_WORKER => chunks_of(parameter).map(|rule| Way::Asked(Master::Only, rule)),
            WORKING_MASTER => chunks_of(parameter).map(|rule| Way::Asked(Master::Working, rule)),
            _ if RULES.contains(&name) => self.way_of_strategy(name, parameter),
            _ => None,
        };
        way.map(|way| RankRule { text: text.to_string(), way }).ok_or_else(|| {
            let problem = "is no rule by which processes can share jobs";
            InputError::new(field, text, problem).allowed(RULES.join(", ")).into()
        })
    }

    fn way_of_strategy(&self, name: &str, parameter: Option<&str>) -> Option<Way> {
        let entry = self.strategies().iter().find(|entry| entry.name == name)?;
        match entry.discipline(parameter).ok()? {
            Discipline::Chunks(rule) => Some(Way::Counted(rule)),
            Discipline::Learned(rule) => Some(Way::Told(rule)),
            Discipline::Dealt(deal) => Some(Way::Dealt(deal)),
            _ => None,
        }
    }
}

/// A master's chunks of so many jobs.
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
