//! The rules by which processes share jobs: those of strategies that deal or hand out chunks, and two with a master.

use super::Lab;
use crate::error::{InputError, Result};
use crate::strategy::{ChunkRule, Discipline};

/// Rank 0 hands out chunks of so many jobs by messages, and renders nothing.
pub const MASTER_WORKER: &str = "master-worker";
/// Rank 0 hands out chunks of so many jobs by messages, between its own.
pub const WORKING_MASTER: &str = "working-master";

/// The rules, by name. All but those of masters are the strategies of the same names.
const RULES: [&str; 8] =
    ["static-blocks", "static-cyclic", "dynamic", "guided", "trapezoid", "factoring", MASTER_WORKER, WORKING_MASTER];

/// The rules, for errors.
pub fn rank_rules() -> String {
    RULES.join(", ")
}

/// A master's chunks of so many jobs.
fn chunks(text: Option<&str>) -> Option<Discipline> {
    let Some(text) = text else { return Some(Discipline::ONE_BY_ONE) };
    let parameter = text.parse().ok().filter(|size| *size > 0)?;
    Some(Discipline::Chunks(ChunkRule { size: |handout| handout.parameter, parameter }))
}

impl Lab {
    /// The rule that `text` names, with a parameter if a colon follows: its name, and which jobs it gives to whom. `field` is where the text
    /// comes from.
    pub fn rank_rule(&self, field: &'static str, text: &str) -> Result<(&'static str, Discipline)> {
        let (name, parameter) = text.split_once(':').map_or((text, None), |(name, rest)| (name, Some(rest)));
        let known = RULES.into_iter().find(|known| *known == name);
        let discipline = known.and_then(|known| match known {
            MASTER_WORKER | WORKING_MASTER => chunks(parameter),
            _ => self.strategies().iter().find(|entry| entry.name == known)?.discipline(parameter).ok(),
        });
        known.zip(discipline).ok_or_else(|| {
            let problem = "is no rule by which processes can share jobs";
            InputError::new(field, text, problem).allowed(rank_rules()).into()
        })
    }
}
