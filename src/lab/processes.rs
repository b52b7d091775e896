//! Strategies whose workers are processes: `mpi-guided` in an experiment is `mpiexec -n N pathmark render ... --ranks guided`.
//!
//! To the tables of an experiment, its figures and the simulator they are strategies as others are, with a deal or a chunk rule. No process can
//! run them alone, so they are not in the list of strategies.

use super::Lab;
use crate::strategy::{ChunkRule, Discipline, Entry, Parameter, StrategyError};

/// What the names begin with.
const PREFIX: &str = "mpi-";

/// The names, with the strategies whose deals and chunk rules they follow; a master follows none.
const NAMES: [(&str, &str); 8] = [
    ("mpi-static-blocks", "static-blocks"),
    ("mpi-static-cyclic", "static-cyclic"),
    ("mpi-dynamic", "dynamic"),
    ("mpi-guided", "guided"),
    ("mpi-trapezoid", "trapezoid"),
    ("mpi-factoring", "factoring"),
    (MASTER_WORKER, ""),
    (WORKING_MASTER, ""),
];

/// Rank 0 hands out chunks of so many jobs by messages, and renders nothing.
pub const MASTER_WORKER: &str = "mpi-master-worker";
/// Rank 0 hands out chunks of so many jobs by messages, between its own.
pub const WORKING_MASTER: &str = "mpi-working-master";

const ABOUT: &str = "processes that mpiexec starts";

/// Chunks of so many jobs.
fn chunks(text: &str) -> Option<Discipline> {
    let parameter = text.parse().ok().filter(|size| *size > 0)?;
    Some(Discipline::Chunks(ChunkRule { size: |handout| handout.parameter, parameter }))
}

/// The rule by which ranks share jobs, with its parameter, of a strategy whose workers are processes.
pub fn rank_rule(strategy: &str) -> Option<&str> {
    let name = strategy.split_once(':').map_or(strategy, |(name, _)| name);
    strategy.strip_prefix(PREFIX).filter(|_| is_known(name))
}

/// Whether the workers of the strategy of that name are processes.
pub(super) fn is_known(name: &str) -> bool {
    NAMES.iter().any(|(known, _)| *known == name)
}

/// The name of the strategy whose workers are processes that share jobs by a rule.
pub fn of_rank_rule(rule: &str) -> String {
    format!("{PREFIX}{rule}")
}

/// The rules, for errors.
pub fn rank_rules() -> String {
    let rules: Vec<&str> = NAMES.iter().filter_map(|(name, _)| rank_rule(name)).collect();
    rules.join(", ")
}

/// The strategy of that name, if its workers are processes.
pub(super) fn named(lab: &Lab, name: &str) -> Option<Entry> {
    let (name, base) = NAMES.iter().find(|(known, _)| *known == name)?;
    let refuse =
        |blueprint: &crate::strategy::Blueprint| Err(StrategyError::Processes { strategy: blueprint.strategy });
    let own = Entry {
        parameter: Some(Parameter { allowed: "numbers from 1: jobs in a chunk", read: chunks }),
        ..Entry::new(name, ABOUT, Discipline::ONE_BY_ONE, refuse)
    };
    let base = lab.strategies().iter().find(|entry| entry.name == *base);
    Some(base.map_or(own, |base| Entry { discipline: base.discipline, parameter: base.parameter, ..own }))
}
