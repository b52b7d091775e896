//! Pinning: which processor each worker may run on.

use super::cpu_list::{cpu_list, parse_cpu_list};
use super::topology::{Cpu, Topology};
use crate::error::{Error, InputError, Result};
use nix::sched::{CpuSet, sched_getaffinity, sched_setaffinity};
use nix::unistd::Pid;
use std::fmt;

/// How workers are assigned to processors.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
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
    pub fn parse(text: &str) -> Result<Self> {
        Ok(match text {
            "none" => Self::None,
            "compact" => Self::Compact,
            "scatter" => Self::Scatter,
            "one-per-core" => Self::OnePerCore,
            "performance" => Self::Performance,
            _ => match parse_cpu_list(text).filter(|cpus| !cpus.is_empty()) {
                Some(cpus) => Self::List(cpus),
                None => return Err(InputError::new("pin", text, "is no policy").allowed(ALLOWED).into()),
            },
        })
    }

    /// The processor of each worker; empty for [`PinPolicy::None`]. `topology` holds the processors that the process may
    /// use.
    pub fn cpus(&self, topology: &Topology, workers: usize) -> Result<Vec<usize>> {
        let fastest = topology.kinds().first().copied();
        let order = match self {
            Self::None => return Ok(Vec::new()),
            Self::Compact => compact(topology),
            Self::Scatter => scattered(&topology.cpus.iter().collect::<Vec<_>>()),
            Self::OnePerCore => topology.cores().iter().map(|core| core[0].id).collect(),
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
            let problem = "the system does not tell its processors, so workers cannot be pinned";
            return Err(InputError::new("pin", self.to_string(), problem).allowed("none").into());
        }
        if workers > order.len() {
            let problem = format!("gives {} processors to {workers} workers", order.len());
            let allowed = format!("at most {} threads, or another policy", order.len());
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

/// The processors that this thread may run on; empty if the system does not tell.
pub fn allowed_cpus() -> Vec<usize> {
    let Ok(set) = sched_getaffinity(Pid::from_raw(0)) else { return Vec::new() };
    (0..CpuSet::count()).filter(|cpu| set.is_set(*cpu).unwrap_or(false)).collect()
}

/// Lets this thread run on these processors only.
pub fn pin_thread(cpus: &[usize]) -> Result<()> {
    let failed = |error: nix::Error| Error::system("pinning a thread to", cpu_list(cpus), error.into());
    let mut set = CpuSet::new();
    for cpu in cpus {
        set.set(*cpu).map_err(failed)?;
    }
    sched_setaffinity(Pid::from_raw(0), &set).map_err(failed)
}

#[cfg(test)]
mod tests {
    use super::super::topology::tests::{hybrid, two_sockets};
    use super::*;

    fn cpus(policy: &str, topology: &Topology, workers: usize) -> Vec<usize> {
        PinPolicy::parse(policy).unwrap().cpus(topology, workers).unwrap()
    }

    fn refused(policy: &str, topology: &Topology, workers: usize) -> String {
        let error = PinPolicy::parse(policy).and_then(|policy| policy.cpus(topology, workers)).unwrap_err();
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
    }

    #[test]
    fn impossible_requests_are_refused() {
        let folder = two_sockets();
        let topology = Topology::read(folder.path());
        assert!(refused("one-per-core", &topology, 5).contains("gives 4 processors to 5 workers"));
        assert!(refused("0-1", &topology, 3).contains("at most 2 threads"));
        assert!(refused("0,9", &topology, 1).contains("processor 9"));
        assert!(refused("0", &topology.clone().within(&[1, 2]), 1).contains("allowed: 1-2"));
        for wrong in ["", "far", "1-", "3-1"] {
            assert!(refused(wrong, &topology, 1).contains("one-per-core"), "{wrong}");
        }
        assert!(refused("compact", &Topology::default(), 1).contains("does not tell"));
        let folder = hybrid();
        assert!(refused("performance", &Topology::read(folder.path()), 3).contains("gives 2 processors"));
    }

    #[test]
    fn policies_are_written_as_they_are_read() {
        for text in ["none", "compact", "scatter", "one-per-core", "performance", "0-3,8"] {
            assert_eq!(PinPolicy::parse(text).unwrap().to_string(), text);
        }
    }

    /// A thread of its own, so that the pin ends with it.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_pinned_thread_stays() {
        let allowed = allowed_cpus();
        let pinned = std::thread::spawn(move || {
            pin_thread(&allowed[..1]).unwrap();
            (allowed_cpus(), allowed[0])
        });
        let (now, cpu) = pinned.join().unwrap();
        assert_eq!(now, [cpu]);
        let none = std::thread::spawn(|| pin_thread(&[]).unwrap_err().exit_code()).join().unwrap();
        assert_eq!(none, 3);
    }
}
