//! Processors, cores, sockets, memory nodes and caches, as Linux describes them in `/sys`.
//!
//! Libraries for this (hwloc) must be installed; the files are few and stable (Linux, "CPU topology info is exported via
//! sysfs", Documentation/admin-guide/cputopology.rst).

use super::cpu_list::parse_cpu_list;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// A processor, as the system schedules threads on it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cpu {
    /// The system's number.
    pub id: usize,
    /// The first processor of its core: those of one core share it.
    pub core: usize,
    pub socket: usize,
    /// Memory node.
    pub node: usize,
    /// Speed relative to the fastest kind of core here, out of 1024.
    pub capacity: usize,
}

/// A cache and the processors that share it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Cache {
    pub level: u32,
    /// `Data`, `Instruction` or `Unified`.
    pub kind: String,
    /// As the system writes it, such as `32K`.
    pub size: String,
    pub cpus: Vec<usize>,
}

/// The capacity of the fastest kind of core.
pub(super) const FULL: usize = 1024;

/// The processors that are online, by number.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Topology {
    pub cpus: Vec<Cpu>,
    pub caches: Vec<Cache>,
}

fn number(path: &Path) -> Option<usize> {
    fs::read_to_string(path).ok()?.trim().parse().ok()
}

fn list(path: &Path) -> Option<Vec<usize>> {
    parse_cpu_list(&fs::read_to_string(path).ok()?)
}

impl Topology {
    /// Reads the description below `root`, which is `/`; empty if the system has none.
    pub fn read(root: &Path) -> Self {
        let base = root.join("sys/devices/system/cpu");
        let online = list(&base.join("online")).unwrap_or_default();
        let nodes = nodes(root);
        let slow: BTreeSet<usize> =
            list(&root.join("sys/devices/cpu_atom/cpus")).unwrap_or_default().into_iter().collect();
        let mut cpus = Vec::new();
        let mut caches = BTreeSet::new();
        for id in online {
            let own = base.join(format!("cpu{id}"));
            let topology = own.join("topology");
            let siblings =
                list(&topology.join("core_cpus_list")).or_else(|| list(&topology.join("thread_siblings_list")));
            cpus.push(Cpu {
                id,
                core: siblings.and_then(|siblings| siblings.first().copied()).unwrap_or(id),
                // Some virtual machines write -1.
                socket: number(&topology.join("physical_package_id")).unwrap_or(0),
                node: nodes.get(&id).copied().unwrap_or(0),
                capacity: number(&own.join("cpu_capacity")).unwrap_or(if slow.contains(&id) { FULL / 2 } else { FULL }),
            });
            caches.extend((0..).map(|index| own.join(format!("cache/index{index}"))).map_while(|path| cache(&path)));
        }
        Self { cpus, caches: caches.into_iter().collect() }
    }

    /// Those of its processors that a process may use.
    #[must_use]
    pub fn within(mut self, allowed: &[usize]) -> Self {
        self.cpus.retain(|cpu| allowed.contains(&cpu.id));
        self
    }

    /// The processors of each core, cores in the order of their first processor.
    pub fn cores(&self) -> Vec<Vec<&Cpu>> {
        let mut cores: BTreeMap<usize, Vec<&Cpu>> = BTreeMap::new();
        self.cpus.iter().for_each(|cpu| cores.entry(cpu.core).or_default().push(cpu));
        cores.into_values().collect()
    }

    /// Capacities of its kinds of core, the fastest first.
    pub fn kinds(&self) -> Vec<usize> {
        let kinds: BTreeSet<usize> = self.cpus.iter().map(|cpu| cpu.capacity).collect();
        kinds.into_iter().rev().collect()
    }
}

/// The memory node of each processor.
fn nodes(root: &Path) -> BTreeMap<usize, usize> {
    let base = root.join("sys/devices/system/node");
    let nodes = list(&base.join("online")).unwrap_or_default();
    let of_node = |node: usize| list(&base.join(format!("node{node}/cpulist"))).unwrap_or_default().into_iter();
    nodes.into_iter().flat_map(|node| of_node(node).map(move |cpu| (cpu, node))).collect()
}

fn cache(path: &Path) -> Option<Cache> {
    let text = |name: &str| fs::read_to_string(path.join(name)).ok().map(|text| text.trim().to_string());
    Some(Cache {
        level: text("level")?.parse().ok()?,
        kind: text("type")?,
        size: text("size").unwrap_or_else(|| "unknown size".to_string()),
        cpus: list(&path.join("shared_cpu_list"))?,
    })
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::cpu_list::cpu_list;
    use super::*;

    /// Files as a system has them for these processors: (number, siblings, socket, node, capacity).
    pub(crate) fn system(cpus: &[(usize, &str, usize, usize, Option<usize>)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: String, text: &str| {
            let path = folder.path().join("sys/devices/system").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, format!("{text}\n")).unwrap();
        };
        let all: Vec<usize> = cpus.iter().map(|cpu| cpu.0).collect();
        write("cpu/online".to_string(), &cpu_list(&all));
        let nodes: BTreeSet<usize> = cpus.iter().map(|cpu| cpu.3).collect();
        write("node/online".to_string(), &cpu_list(&nodes.iter().copied().collect::<Vec<_>>()));
        for node in nodes {
            let own: Vec<usize> = cpus.iter().filter(|cpu| cpu.3 == node).map(|cpu| cpu.0).collect();
            write(format!("node/node{node}/cpulist"), &cpu_list(&own));
        }
        for (id, siblings, socket, _, capacity) in cpus {
            write(format!("cpu/cpu{id}/topology/core_cpus_list"), siblings);
            write(format!("cpu/cpu{id}/topology/physical_package_id"), &socket.to_string());
            if let Some(capacity) = capacity {
                write(format!("cpu/cpu{id}/cpu_capacity"), &capacity.to_string());
            }
            for (index, (level, kind, size, shared)) in
                [("1", "Data", "32K", *siblings), ("2", "Unified", "1024K", *siblings)].into_iter().enumerate()
            {
                for (name, text) in [("level", level), ("type", kind), ("size", size), ("shared_cpu_list", shared)] {
                    write(format!("cpu/cpu{id}/cache/index{index}/{name}"), text);
                }
            }
        }
        folder
    }

    /// Two sockets of two cores with two processors each, numbered as Linux numbers them on such machines.
    pub(crate) fn two_sockets() -> tempfile::TempDir {
        system(&[
            (0, "0,4", 0, 0, None),
            (1, "1,5", 0, 0, None),
            (2, "2,6", 1, 1, None),
            (3, "3,7", 1, 1, None),
            (4, "0,4", 0, 0, None),
            (5, "1,5", 0, 0, None),
            (6, "2,6", 1, 1, None),
            (7, "3,7", 1, 1, None),
        ])
    }

    /// Two fast cores and four slow ones.
    pub(crate) fn hybrid() -> tempfile::TempDir {
        let slow = Some(446);
        system(&[
            (0, "0", 0, 0, slow),
            (1, "1", 0, 0, slow),
            (2, "2", 0, 0, slow),
            (3, "3", 0, 0, slow),
            (4, "4", 0, 0, Some(1024)),
            (5, "5", 0, 0, Some(1024)),
        ])
    }

    #[test]
    fn sockets_cores_and_caches_are_read() {
        let folder = two_sockets();
        let topology = Topology::read(folder.path());
        assert_eq!(topology.cpus[6], Cpu { id: 6, core: 2, socket: 1, node: 1, capacity: 1024 });
        assert_eq!(topology.cores().len(), 4);
        assert_eq!(topology.caches.len(), 8);
        assert_eq!(topology.caches[1].cpus, [1, 5]);
        assert_eq!(topology.within(&[1, 5, 99]).cores().len(), 1);
    }

    #[test]
    fn kinds_of_core_are_told_apart() {
        let folder = hybrid();
        let topology = Topology::read(folder.path());
        assert_eq!(topology.kinds(), [1024, 446]);
        // Intel's list of its slower cores.
        let plain = system(&[(0, "0", 0, 0, None), (1, "1", 0, 0, None)]);
        fs::create_dir_all(plain.path().join("sys/devices/cpu_atom")).unwrap();
        fs::write(plain.path().join("sys/devices/cpu_atom/cpus"), "1\n").unwrap();
        assert_eq!(Topology::read(plain.path()).kinds(), [1024, 512]);
    }

    #[test]
    fn a_system_that_tells_nothing_has_no_topology() {
        let folder = tempfile::tempdir().unwrap();
        let topology = Topology::read(folder.path());
        assert_eq!(topology, Topology::default());
    }
}
