//! Pinning: which processor each worker may run on.

use super::cpu_list::{cpu_list, parse_cpu_list};
use super::system::allowed_cpus;
use super::topology::{Cpu, Topology};
use crate::error::{InputError, Result};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::Path;
use std::sync::LazyLock;

/// How workers are assigned to processors.
#[derive(Debug, Clone, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum PinPolicy {
    /// The system moves them as it likes.
    #[default]
    None,
    /// Neighbours share as much as possible: a core, then a socket.
    Compact,
    /// Neighbours share as little as possible: sockets in turn, and second processors of cores last.
    Scatter,
    /// The first processor of each core.
    OnePerCore,
    /// The processors of the fastest kind of core, in the order of `Scatter`.
    Performance,
    /// These processors.
    List(Vec<usize>),
}

const ALLOWED: &str = "none, compact, scatter, one-per-core, performance, or a list of processors such as 0-3,8";

impl fmt::Display for PinPolicy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::None => f.write_str("none"),
            Self::Compact => f.write_str("compact"),
            Self::Scatter => f.write_str("scatter"),
            Self::OnePerCore => f.write_str("one-per-core"),
            Self::Performance => f.write_str("performance"),
            Self::List(cpus) => f.write_str(&cpu_list(cpus)),
        }
    }
}

impl PinPolicy {
    /// Reads a policy.
    pub fn parse(text: &str) -> Option<Self> {
        Some(match text {
            "none" => Self::None,
            "compact" => Self::Compact,
            "scatter" => Self::Scatter,
            "one-per-core" => Self::OnePerCore,
            "performance" => Self::Performance,
            _ => Self::List(parse_cpu_list(text).filter(|cpus| !cpus.is_empty())?),
        })
    }

    /// The error for a text that is no policy.
    pub(crate) fn refused(text: &str) -> InputError {
        InputError::new("pin", text, "is neither a policy nor a list of processors").allowed(ALLOWED)
    }

    /// The processor of each worker of this process; empty for [`PinPolicy::None`].
    pub fn cpus(&self, workers: usize) -> Result<Vec<usize>> {
        // Sweeps check thousands of cells, and the machine stays the same.
        static TOPOLOGY: LazyLock<Topology> = LazyLock::new(|| Topology::read(Path::new("/")));
        match self {
            Self::None => Ok(Vec::new()),
            _ => self.cpus_of(&TOPOLOGY.clone().within(&allowed_cpus()), workers),
        }
    }

    /// The same on a machine whose processors this process may use.
    fn cpus_of(&self, topology: &Topology, workers: usize) -> Result<Vec<usize>> {
        let fastest = topology.kinds().first().copied();
        let order = match self {
            Self::None => return Ok(Vec::new()),
            Self::Compact => compact(topology),
            Self::Scatter => scattered(&topology.cpus.iter().collect::<Vec<_>>()),
            Self::OnePerCore => {
                let mut firsts: Vec<&Cpu> = topology.cores().into_iter().map(|core| core[0]).collect();
                firsts.sort_by_key(|cpu| std::cmp::Reverse(cpu.capacity));
                firsts.into_iter().map(|cpu| cpu.id).collect()
            }
            Self::Performance => {
                let fast = topology.cpus.iter().filter(|cpu| Some(cpu.capacity) == fastest);
                scattered(&fast.collect::<Vec<_>>())
            }
            Self::List(cpus) => {
                let there = |id: &usize| topology.cpus.iter().any(|cpu| cpu.id == *id);
                if let Some(unknown) = cpus.iter().find(|id| !there(id)) {
                    let all: Vec<usize> = topology.cpus.iter().map(|cpu| cpu.id).collect();
                    let problem =
                        format!("this process may not run on processor {unknown}, or there is none of that number");
                    return Err(InputError::new("pin", self.to_string(), problem).allowed(cpu_list(&all)).into());
                }
                cpus.clone()
            }
        };
        if order.is_empty() {
            let problem = "workers cannot be pinned, because the system does not list its processors";
            return Err(InputError::new("pin", self.to_string(), problem).allowed("none").into());
        }
        if workers > order.len() {
            let problem = format!("has a processor for only {} of {workers} workers", order.len());
            let allowed = format!("up to {} workers, or another policy", order.len());
            return Err(InputError::new("pin", self.to_string(), problem).allowed(allowed).into());
        }
        Ok(order[..workers].to_vec())
    }
}

/// All processors of a core, then the next core of the socket, fast cores first.
fn compact(topology: &Topology) -> Vec<usize> {
    let mut cpus: Vec<&Cpu> = topology.cpus.iter().collect();
    cpus.sort_by_key(|cpu| (std::cmp::Reverse(cpu.capacity), cpu.socket, cpu.node, cpu.core, cpu.id));
    cpus.into_iter().map(|cpu| cpu.id).collect()
}

/// Processors by their rank in the core, then by the rank of the core in its socket, then by socket; fast cores first.
fn scattered(cpus: &[&Cpu]) -> Vec<usize> {
    let rank = |cpu: &Cpu| {
        let in_core = cpus.iter().filter(|other| other.core == cpu.core && other.id < cpu.id).count();
        let firsts = cpus.iter().filter(|other| other.id == other.core || other.core == cpu.core);
        let of_socket = firsts.filter(|other| other.socket == cpu.socket && other.core < cpu.core);
        (std::cmp::Reverse(cpu.capacity), in_core, of_socket.count(), cpu.socket, cpu.id)
    };
    let mut all = cpus.to_vec();
    all.sort_by_key(|cpu| rank(cpu));
    all.into_iter().map(|cpu| cpu.id).collect()
}

impl From<PinPolicy> for String {
    fn from(policy: PinPolicy) -> Self {
        policy.to_string()
    }
}

impl TryFrom<String> for PinPolicy {
    type Error = InputError;

    fn try_from(text: String) -> std::result::Result<Self, InputError> {
        Self::parse(&text).ok_or_else(|| Self::refused(&text))
    }
}

#[cfg(test)]
mod tests {
    use super::super::topology::tests::{hybrid, two_sockets};
    use super::*;

    fn cpus(policy: &str, topology: &Topology, workers: usize) -> Vec<usize> {
        PinPolicy::parse(policy).unwrap().cpus_of(topology, workers).unwrap()
    }

    fn refused(policy: &str, topology: &Topology, workers: usize) -> String {
        let error = PinPolicy::parse(policy).unwrap().cpus_of(topology, workers).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        error.to_string()
    }

    #[test]
    fn policies_order_processors() {
        let folder = two_sockets();
        let topology = Topology::read(folder.path());
        assert!(cpus("none", &topology, 99).is_empty());
        assert_eq!(cpus("compact", &topology, 8), [0, 4, 1, 5, 2, 6, 3, 7]);
        assert_eq!(cpus("scatter", &topology, 8), [0, 2, 1, 3, 4, 6, 5, 7]);
        assert_eq!(cpus("one-per-core", &topology, 3), [0, 1, 2]);
        assert_eq!(cpus("performance", &topology, 8), cpus("scatter", &topology, 8));
        assert_eq!(cpus("2,5-6", &topology, 2), [2, 5]);
        let folder = hybrid();
        let topology = Topology::read(folder.path());
        assert_eq!(cpus("performance", &topology, 2), [4, 5]);
        assert_eq!(cpus("compact", &topology, 3), [4, 5, 0]);
        assert_eq!(cpus("scatter", &topology, 3), [4, 5, 0]);
        assert_eq!(cpus("one-per-core", &topology, 3), [4, 5, 0]);
    }

    #[test]
    fn impossible_requests_are_refused() {
        let folder = two_sockets();
        let topology = Topology::read(folder.path());
        assert!(refused("one-per-core", &topology, 5).contains("only 4 of 5 workers"));
        assert!(refused("0-1", &topology, 3).contains("up to 2 workers"));
        assert!(refused("0,9", &topology, 1).contains("processor 9"));
        assert!(refused("0", &topology.clone().within(&[1, 2]), 1).contains("allowed: 1-2"));
        for wrong in ["", "far", "1-", "3-1"] {
            assert_eq!(PinPolicy::parse(wrong), None, "{wrong}");
            assert!(PinPolicy::refused(wrong).to_string().contains("one-per-core"), "{wrong}");
        }
        assert!(refused("compact", &Topology::default(), 1).contains("does not list its processors"));
        let folder = hybrid();
        assert!(refused("performance", &Topology::read(folder.path()), 3).contains("only 2 of 3 workers"));
    }

    #[test]
    fn policies_are_written_as_they_are_read() {
        for text in ["none", "compact", "scatter", "one-per-core", "performance", "0-3,8"] {
            assert_eq!(PinPolicy::parse(text).unwrap().to_string(), text);
        }
    }
}
