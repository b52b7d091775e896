//! Which rank does which jobs: `--ranks static-blocks | static-cyclic | dynamic:C | guided | ... | master-worker:C | working-master:C`.
//!
//! Deals and chunk rules are those of the strategies of the same names. Chunks are pure functions of their number, so a rank that is free
//! counts up one number in the memory of rank 0 and looks its chunk up. A master answers requests by messages instead.

use crate::error::{InputError, Result};
use crate::lab::Lab;
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

/// Rules that no strategy has: name, master, and meaning.
const MASTERS: [(&str, Master, &str); 2] = [
    ("master-worker", Master::Only, "rank 0 hands out chunks of C jobs by messages, and renders nothing"),
    ("working-master", Master::Working, "rank 0 hands out chunks of C jobs by messages between its own chunks"),
];

/// The strategies whose deal or chunk rule ranks can follow, and the two masters, for the help.
pub const RANK_RULES: &str =
    "static-blocks, static-cyclic, dynamic:C, guided, trapezoid, factoring, master-worker:C, working-master:C";

impl fmt::Display for RankRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl RankRule {
    /// Reads a rule as it stands on the command line.
    pub fn parse(lab: &Lab, text: &str) -> Result<Self> {
        let way = Self::way(lab, text).ok_or_else(|| {
            InputError::new("ranks", text, "is no rule by which ranks can share jobs").allowed(RANK_RULES)
        })?;
        Ok(Self { text: text.to_string(), way })
    }

    fn way(lab: &Lab, text: &str) -> Option<Way> {
        let (name, parameter) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
        if let Some((_, master, _)) = MASTERS.iter().find(|(known, ..)| *known == name) {
            let parameter = parameter.map_or(Some(1), |text| text.parse().ok().filter(|size| *size > 0))?;
            return Some(Way::Asked(*master, ChunkRule { size: |handout| handout.parameter, parameter }));
        }
        let entry = lab.strategies().iter().find(|entry| entry.name == name)?;
        match entry.discipline(parameter).ok()? {
            Discipline::Dealt(deal) => Some(Way::Dealt(deal)),
            Discipline::Chunks(rule) => Some(Way::Counted(rule)),
            _ => None,
        }
    }

    /// Refuses rules that so many ranks cannot follow.
    pub(super) fn check(&self, ranks: usize) -> Result<()> {
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

    #[test]
    fn every_rule_that_is_listed_can_be_read_and_others_cannot() {
        let lab = Lab::built_in();
        for text in RANK_RULES.split(", ") {
            let rule = RankRule::parse(&lab, &text.replace(":C", ":3")).unwrap();
            assert_eq!(rule.check(1).is_err(), text.starts_with("master-worker"), "{text}");
            assert!(rule.check(2).is_ok());
            assert!(RankRule::parse(&lab, text.split(':').next().unwrap()).is_ok());
        }
        for text in ["work-stealing", "serial", "rayon", "", "dynamic:0", "master-worker:0", "master-worker:x", "x:1"] {
            assert_eq!(RankRule::parse(&lab, text).unwrap_err().exit_code(), 2, "{text}");
        }
    }
}
