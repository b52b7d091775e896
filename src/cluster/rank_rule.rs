//! Which rank does which jobs: `--ranks static-blocks | static-cyclic | dynamic:C | guided | ... | master-worker:C | working-master:C`.
//!
//! Deals and chunk rules are those of the strategies of the same names. Chunks are pure functions of their number, so a rank that is free
//! counts up one number in the memory of rank 0 and looks its chunk up. A master answers requests by messages instead.

use crate::error::{InputError, Result};
use crate::lab::{Lab, MASTER_WORKER, WORKING_MASTER};
use crate::strategy::{ChunkRule, Deal, Discipline};
use std::fmt;
use std::ops::Range;

/// Who hands out chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Master {
    /// Rank 0, which renders nothing.
    Only,
    /// Rank 0, between its own chunks.
    Working,
}

/// How jobs get to ranks.
#[derive(Debug, Clone, Copy)]
pub(super) enum Way {
    /// Each rank knows its jobs beforehand.
    Dealt(Deal),
    /// A rank that is free takes the next number from a counter in the memory of rank 0.
    Counted(ChunkRule),
    /// A rank that is free asks rank 0.
    Asked(Master, ChunkRule),
}

/// A rule, as the user named it.
#[derive(Debug, Clone)]
pub struct RankRule {
    text: String,
    pub(super) way: Way,
}

impl fmt::Display for RankRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl RankRule {
    /// Reads a rule as it stands in an option or an axis of that name.
    pub fn parse(lab: &Lab, field: &'static str, text: &str) -> Result<Self> {
        let way = match lab.rank_rule(field, text)? {
            (MASTER_WORKER, Discipline::Chunks(rule)) => Way::Asked(Master::Only, rule),
            (WORKING_MASTER, Discipline::Chunks(rule)) => Way::Asked(Master::Working, rule),
            (_, Discipline::Chunks(rule)) => Way::Counted(rule),
            (_, Discipline::Dealt(deal)) => Way::Dealt(deal),
            (name, _) => {
                let problem = "neither deals jobs nor hands out chunks";
                return Err(InputError::new(field, name, problem).into());
            }
        };
        Ok(Self { text: text.to_string(), way })
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

    /// The chunks of a rule in the order of their numbers, for so many ranks that render.
    pub(super) fn chunks(rule: ChunkRule, jobs: usize, ranks: usize) -> Vec<Range<usize>> {
        rule.chunks(jobs, ranks.max(1)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::rank_rules;

    #[test]
    fn every_rule_that_is_listed_can_be_read_and_others_cannot() {
        let lab = Lab::built_in();
        for text in rank_rules().split(", ").chain(["dynamic:3", "master-worker:3", "working-master:3"]) {
            let rule = RankRule::parse(&lab, "ranks", text).unwrap();
            assert_eq!(rule.check(1).is_err(), text.starts_with("master-worker"), "{text}");
            assert!(rule.check(2).is_ok());
        }
        for text in ["work-stealing", "serial", "rayon", "", "dynamic:0", "master-worker:0", "master-worker:x", "x:1"] {
            assert_eq!(RankRule::parse(&lab, "ranks", text).unwrap_err().exit_code(), 2, "{text}");
        }
    }
}
