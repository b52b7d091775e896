//! The layout of a machine as a table: for `pathmark machine` and the file beside the rows of a sweep.

use super::cpu_list::{cpu_list, parse_cpu_list};
use super::quota::cpu_quota;
use super::system::allowed_cpus;
use super::topology::{Cpu, FULL, Topology};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// Processors, what they share, and which of them this process may use. Lists of processors are as Linux writes them,
/// such as `0-3,8`. Everything is empty if the system does not tell it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// The processors that are online.
    pub processors: String,
    /// Those that this process may use: by its affinity, which control groups limit (cpuset).
    pub allowed: String,
    /// Processors that this process may use at once, by the quota of its control groups; `None` without a limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quota: Option<f64>,
    /// The processors of each socket.
    pub sockets: Vec<String>,
    /// The processors of each memory node.
    pub memory_nodes: Vec<String>,
    /// The processors of each core: several if the core runs several threads at a time.
    pub cores: Vec<String>,
    /// The kinds of core, the fastest first.
    pub kinds: Vec<CoreKind>,
    pub caches: Vec<CacheLayout>,
}

/// Processors whose cores have the same speed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CoreKind {
    /// Speed relative to the fastest core that the system knows, out of 1024.
    pub capacity: usize,
    pub processors: String,
}

/// Caches of one level and size.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct CacheLayout {
    pub level: u32,
    /// `Data`, `Instruction` or `Unified`.
    pub kind: String,
    /// As the system writes it, such as `32K`.
    pub size: String,
    /// The processors that share each of them.
    pub processors: Vec<String>,
}

impl Layout {
    /// The layout of this machine for this process.
    pub fn here() -> Self {
        let root = Path::new("/");
        Self::of(&Topology::read(root), &allowed_cpus(), cpu_quota(root))
    }

    pub(super) fn of(topology: &Topology, allowed: &[usize], quota: Option<f64>) -> Self {
        let lists =
            |key: fn(&Cpu) -> usize| by(topology, key).into_values().map(|own| cpu_list(&own)).collect::<Vec<String>>();
        let kinds = by(topology, |cpu| cpu.capacity).into_iter().rev();
        let mut caches: Vec<CacheLayout> = Vec::new();
        for cache in &topology.caches {
            let processors = cpu_list(&cache.cpus);
            let is_like = |known: &&mut CacheLayout| {
                (known.level, &known.kind, &known.size) == (cache.level, &cache.kind, &cache.size)
            };
            match caches.iter_mut().find(is_like) {
                Some(known) => known.processors.push(processors),
                None => caches.push(CacheLayout {
                    level: cache.level,
                    kind: cache.kind.clone(),
                    size: cache.size.clone(),
                    processors: vec![processors],
                }),
            }
        }
        Self {
            processors: cpu_list(&topology.cpus.iter().map(|cpu| cpu.id).collect::<Vec<_>>()),
            allowed: cpu_list(allowed),
            quota,
            sockets: lists(|cpu| cpu.socket),
            memory_nodes: lists(|cpu| cpu.node),
            cores: lists(|cpu| cpu.core),
            kinds: kinds.map(|(capacity, own)| CoreKind { capacity, processors: cpu_list(&own) }).collect(),
            caches,
        }
    }

    /// Whether a core runs several threads at a time.
    pub fn has_smt(&self) -> bool {
        self.cores.iter().any(|core| core.contains([',', '-']))
    }

    /// Cores in use by so many workers on the processors that this process may use, the fastest first: a slower core counts
    /// by its capacity. The number of workers if all are alike, or if the system tells nothing.
    pub fn weight(&self, workers: usize) -> f64 {
        let [fastest, _, ..] = &self.kinds[..] else { return workers as f64 };
        let allowed = parse_cpu_list(&self.allowed).unwrap_or_default();
        let of_kind = |kind: &CoreKind| {
            let own = parse_cpu_list(&kind.processors).unwrap_or_default();
            own.into_iter().filter(|cpu| allowed.contains(cpu)).count()
        };
        let capacities = self.kinds.iter().flat_map(|kind| std::iter::repeat_n(kind.capacity, of_kind(kind)));
        capacities.take(workers).sum::<usize>() as f64 / fastest.capacity as f64
    }

    /// Its facts in words, each with a name.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        if self.processors.is_empty() {
            return vec![("processors", "the system does not list them, so workers cannot be pinned".to_string())];
        }
        let counted = |own: &[String]| format!("{}: {}", own.len(), own.join(" "));
        let mut facts = vec![
            ("processors", self.processors.clone()),
            ("allowed", self.allowed.clone()),
            ("quota", self.quota.map_or_else(|| "none".to_string(), |quota| format!("{quota} processors at once"))),
            ("sockets", counted(&self.sockets)),
            ("memory nodes", counted(&self.memory_nodes)),
            ("cores", counted(&self.cores)),
        ];
        if self.kinds.len() > 1 {
            let kind = |kind: &CoreKind| format!("capacity {} of {FULL}: {}", kind.capacity, kind.processors);
            facts.push(("kinds of core", self.kinds.iter().map(kind).collect::<Vec<_>>().join("; ")));
        }
        facts.extend(self.caches.iter().map(|cache| {
            let kind = if cache.kind == "Unified" { String::new() } else { format!(" {}", cache.kind.to_lowercase()) };
            let count = cache.processors.len();
            ("cache", format!("level {}{kind}, {count} of {}: {}", cache.level, cache.size, cache.processors.join(" ")))
        }));
        facts
    }
}

/// The processors with each value of a property.
fn by(topology: &Topology, key: fn(&Cpu) -> usize) -> BTreeMap<usize, Vec<usize>> {
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    topology.cpus.iter().for_each(|cpu| groups.entry(key(cpu)).or_default().push(cpu.id));
    groups
}

#[cfg(test)]
mod tests {
    use super::super::topology::tests::{hybrid, two_sockets};
    use super::*;

    #[test]
    fn sockets_with_smt_are_described() {
        let folder = two_sockets();
        let layout = Layout::of(&Topology::read(folder.path()), &[0, 1, 4], Some(1.5));
        let facts: Vec<String> = layout.facts().iter().map(|(name, text)| format!("{name}: {text}")).collect();
        assert_eq!(
            facts,
            [
                "processors: 0-7",
                "allowed: 0-1,4",
                "quota: 1.5 processors at once",
                "sockets: 2: 0-1,4-5 2-3,6-7",
                "memory nodes: 2: 0-1,4-5 2-3,6-7",
                "cores: 4: 0,4 1,5 2,6 3,7",
                "cache: level 1 data, 4 of 32K: 0,4 1,5 2,6 3,7",
                "cache: level 2, 4 of 1024K: 0,4 1,5 2,6 3,7",
            ]
        );
        assert!(layout.has_smt());
        let text = toml::to_string(&layout).unwrap();
        assert_eq!(toml::from_str::<Layout>(&text).unwrap(), layout);
    }

    #[test]
    fn kinds_of_core_are_described() {
        let folder = hybrid();
        let layout = Layout::of(&Topology::read(folder.path()), &[0], None);
        let kinds = "capacity 1024 of 1024: 4-5; capacity 446 of 1024: 0-3".to_string();
        assert!(layout.facts().contains(&("kinds of core", kinds)) && !layout.has_smt());
        assert!(layout.facts().contains(&("quota", "none".to_string())));
    }

    /// Two cores of capacity 1024, and slower ones of 446, of which the process may use one.
    #[test]
    fn slow_cores_count_by_their_capacity() {
        let folder = hybrid();
        let layout = Layout::of(&Topology::read(folder.path()), &[3, 4, 5], None);
        let found = [1, 2, 3, 9].map(|workers| layout.weight(workers));
        let all = (2.0 * 1024.0 + 446.0) / 1024.0;
        assert_eq!(found, [1.0, 2.0, all, all]);
        let folder = two_sockets();
        assert_eq!(Layout::of(&Topology::read(folder.path()), &[0, 1], None).weight(3), 3.0);
        assert_eq!(Layout::default().weight(3), 3.0);
    }

    #[test]
    fn a_system_that_tells_nothing_is_described_as_such() {
        let layout = Layout::of(&Topology::default(), &[], None);
        assert_eq!(layout, Layout::default());
        assert!(layout.facts()[0].1.contains("cannot be pinned"));
    }
}
