//! The machine and the build of a measurement: seconds mean nothing without them.

use super::processor::{instruction_sets, model_numbers};
use super::stamp::Stamp;
use crate::machine::Layout;
use serde::{Deserialize, Serialize};
use std::fs;
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

/// Facts about the machine and the build. Unknown text is `unknown`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor.
    pub cpu: String,
    /// The maker's numbers of the processor, such as family, model and stepping: one name may stand for many models.
    /// Rows of older versions do not have them.
    #[serde(default)]
    pub cpu_model: String,
    /// Instruction sets of the processor. Rows of older versions do not have them.
    #[serde(default)]
    pub cpu_features: String,
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
    /// Cores, sockets, memory nodes and caches, and the processors that this process may use. Empty in older files.
    #[serde(default)]
    pub layout: Layout,
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

type Facts = Vec<(&'static str, String)>;

fn differing(own: impl Into<Facts>, other: impl Into<Facts>) -> Option<(&'static str, String, String)> {
    let pairs = own.into().into_iter().zip(other.into());
    pairs.map(|((name, own), (_, other))| (name, own, other)).find(|(_, own, other)| own != other)
}

const KERNEL: &str = if cfg!(target_os = "linux") { "Linux" } else { std::env::consts::OS };

/// Load averages over 1, 5 and 15 minutes.
fn load_average() -> String {
    let load = System::load_average().ok();
    or_unknown(load.map(|load| format!("{:.2} {:.2} {:.2}", load.one, load.five, load.fifteen)))
}

impl Machine {
    /// The machine in a few words, for figures.
    pub fn line(&self) -> String {
        let model = if self.cpu_model.is_empty() { String::new() } else { format!(" ({})", self.cpu_model) };
        format!("{} processors, {}{model}", self.processors, self.cpu)
    }

    /// Inspects this machine and this build.
    pub fn look() -> Self {
        let asked = RefreshKind::nothing()
            .with_cpu(CpuRefreshKind::nothing())
            .with_memory(MemoryRefreshKind::nothing().with_ram());
        let system = System::new_with_specifics(asked).ok();
        let name = system.as_ref().and_then(|system| Some(system.cpus().first()?.brand().trim().to_string()));
        let kernel = System::kernel_version().ok().map(|version| format!("{KERNEL} {version}"));
        Self {
            cpu: or_unknown(name),
            cpu_model: model_numbers(&read("/proc/cpuinfo").unwrap_or_default()),
            cpu_features: instruction_sets(),
            processors: super::available_threads(),
            physical_cores: System::physical_core_count().unwrap_or(0),
            governor: or_unknown(read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")),
            memory_bytes: system.as_ref().map_or(0, System::total_memory),
            system: or_unknown(kernel),
            load_average: load_average(),
            rustc: built_with(env!("PATHMARK_RUSTC")),
            target: built_with(env!("PATHMARK_TARGET")),
            rustflags: built_with(env!("PATHMARK_RUSTFLAGS")),
            profile: built_with(env!("PATHMARK_PROFILE")),
            commit: built_with(Stamp::of_program().commit),
            dirty: Stamp::of_program().is_dirty,
            layout: Layout::here(),
        }
    }

    /// The first fact of the build or the processors that differs, with both values: rows of another processor or
    /// revision are no repetitions.
    pub fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        differing(self.build(), other.build()).or_else(|| self.hardware_difference(other))
    }

    /// The first fact of the processors that differs, with both values. Files of older versions lack some of them; a
    /// fact that one side lacks is not compared.
    pub fn hardware_difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        let known = |(own, other): &((_, String), (_, String))| !own.1.is_empty() && !other.1.is_empty();
        let (own, other): (Vec<_>, Vec<_>) = self.hardware().into_iter().zip(other.hardware()).filter(known).unzip();
        differing(own, other)
    }

    fn hardware(&self) -> [(&'static str, String); 4] {
        [
            ("cpu", self.cpu.clone()),
            ("cpu_model", self.cpu_model.clone()),
            ("cpu_features", self.cpu_features.clone()),
            ("processors", self.processors.to_string()),
        ]
    }

    /// The facts of the build: parts of one sweep may run on several machines, but with one build.
    pub fn build(&self) -> [(&'static str, String); 6] {
        [
            ("rustc", self.rustc.clone()),
            ("target", self.target.clone()),
            ("rustflags", self.rustflags.clone()),
            ("commit", self.commit.clone()),
            ("dirty", self.dirty.to_string()),
            ("profile", self.profile.clone()),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_of_one_name_are_different_machines() {
        let here = Machine { cpu: "AMD EPYC".to_string(), cpu_model: "family 25".to_string(), ..Machine::look() };
        let other = Machine { cpu_model: "family 26".to_string(), ..here.clone() };
        let both = || ("family 25".to_string(), "family 26".to_string());
        assert_eq!(here.difference(&other), Some(("cpu_model", both().0, both().1)));
        assert_ne!(here.line(), other.line());
        let newer = Machine { cpu_features: "none of today's".to_string(), ..here.clone() };
        assert_eq!(here.hardware_difference(&newer).unwrap().0, "cpu_features");
        let rebuilt = Machine { commit: "another".to_string(), ..here.clone() };
        assert_eq!((here.difference(&rebuilt).unwrap().0, here.hardware_difference(&rebuilt)), ("commit", None));
    }

    #[test]
    fn the_processor_of_this_machine_is_known() {
        let here = Machine::look();
        assert_ne!(here.cpu, "unknown");
        assert!(here.memory_bytes > 0 && here.processors > 0);
    }

    #[test]
    fn machine_files_of_older_versions_are_read() {
        let mut table = toml::Table::try_from(Machine::look()).unwrap();
        table.remove("cpu_model");
        table.remove("cpu_features");
        table.remove("layout");
        let old: Machine = table.try_into().unwrap();
        assert_eq!((old.cpu_model.as_str(), old.cpu_features.as_str()), ("", ""));
        assert_eq!(old.layout, Layout::default());
        // A fact that an old file lacks is no difference.
        assert_eq!((old.difference(&Machine::look()), Machine::look().difference(&old)), (None, None));
    }
}
