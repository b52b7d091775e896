//! The machine and the build of a measurement: seconds mean nothing without them.

use serde::{Deserialize, Serialize};
use std::fs;

/// Facts about the machine and the build. Unknown text is `unknown`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Processor model.
    pub cpu: String,
    /// Processors that this process may use.
    pub processors: usize,
    /// Physical cores; 0 if the system does not report them.
    pub physical_cores: usize,
    /// Frequency governor.
    pub governor: String,
    /// Main memory.
    pub memory_bytes: u64,
    /// Operating system and kernel.
    pub system: String,
    /// Load averages over 1, 5 and 15 minutes when the sweep began: other programs' work disturbs timings.
    pub load_average: String,
    /// Compiler.
    pub rustc: String,
    /// Target triple.
    pub target: String,
    /// Extra compiler flags.
    pub rustflags: String,
    /// Build profile.
    pub profile: String,
    /// Version control revision of the sources.
    pub commit: String,
    /// Whether the sources had uncommitted changes.
    pub dirty: bool,
}

fn read(path: &str) -> Option<String> {
    fs::read_to_string(path).ok().map(|text| text.trim().to_string())
}

fn or_unknown(text: Option<String>) -> String {
    text.filter(|text| !text.is_empty()).unwrap_or_else(|| "unknown".to_string())
}

/// Returns a fact that the build stamped. It is a function because the compiler flags are usually the empty text.
fn built_with(fact: &str) -> String {
    fact.to_string()
}

/// The values of `key: value` lines, one for each line that has the key.
fn values<'a>(text: &'a str, key: &'a str) -> impl Iterator<Item = &'a str> {
    text.lines().filter_map(move |line| {
        let (found, value) = line.split_once(':')?;
        (found.trim() == key).then(|| value.trim())
    })
}

impl Machine {
    /// The machine in a few words, for figures.
    pub fn line(&self) -> String {
        format!("{} processors, {}", self.processors, self.cpu)
    }

    /// Inspects this machine and this build.
    pub fn look() -> Self {
        let cpuinfo = read("/proc/cpuinfo").unwrap_or_default();
        let meminfo = read("/proc/meminfo").unwrap_or_default();
        let mut cores: Vec<(&str, &str)> = values(&cpuinfo, "physical id").zip(values(&cpuinfo, "core id")).collect();
        cores.sort_unstable();
        cores.dedup();
        let kib = values(&meminfo, "MemTotal").next().and_then(|text| text.split(' ').next()?.parse::<u64>().ok());
        let load = read("/proc/loadavg").map(|text| text.split(' ').take(3).collect::<Vec<_>>().join(" "));
        Self {
            cpu: or_unknown(values(&cpuinfo, "model name").next().map(str::to_string)),
            processors: super::available_threads(),
            physical_cores: cores.len(),
            governor: or_unknown(read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")),
            memory_bytes: kib.unwrap_or(0) * 1024,
            system: or_unknown(read("/proc/sys/kernel/osrelease").map(|release| format!("Linux {release}"))),
            load_average: or_unknown(load),
            rustc: built_with(env!("PATHMARK_RUSTC")),
            target: built_with(env!("PATHMARK_TARGET")),
            rustflags: built_with(env!("PATHMARK_RUSTFLAGS")),
            profile: built_with(env!("PATHMARK_PROFILE")),
            commit: built_with(env!("PATHMARK_COMMIT")),
            dirty: env!("PATHMARK_DIRTY") == "true",
        }
    }

    /// The facts that must be equal for rows to belong together: rows of another processor or revision are no
    /// repetitions.
    pub fn identity(&self) -> [(&'static str, String); 8] {
        [
            ("rustc", self.rustc.clone()),
            ("target", self.target.clone()),
            ("rustflags", self.rustflags.clone()),
            ("cpu", self.cpu.clone()),
            ("processors", self.processors.to_string()),
            ("commit", self.commit.clone()),
            ("dirty", self.dirty.to_string()),
            ("profile", self.profile.clone()),
        ]
    }
}
