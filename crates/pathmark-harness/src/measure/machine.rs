//! The machine and the build of a measurement: seconds mean nothing without them.

use super::provenance::Stamp;
use crate::machine::{Layout, processor_numbers};
use serde::{Deserialize, Serialize};
use std::fs;
use sysinfo::{CpuRefreshKind, MemoryRefreshKind, RefreshKind, System};

/// Facts about the machine and the build. Unknown text is `unknown`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Machine {
    pub cpu: String,
    /// The maker's numbers of the processor, such as family, model and stepping: one name may stand for many models.
    /// Rows of older versions do not have them.
    #[serde(default)]
    pub cpu_model: String,
    /// Instruction sets of the processor. Rows of older versions do not have them.
    #[serde(default)]
    pub cpu_features: String,
    pub processors: usize,
    /// Physical cores; 0 if the system does not report them.
    pub physical_cores: usize,
    pub governor: String,
    pub memory_bytes: u64,
    pub system: String,
    /// Load averages over 1, 5 and 15 minutes when the sweep began: other programs' work disturbs timings. Experiments
    /// that the same command ran before count, too: hundreds of threads leave a load of hundreds for minutes.
    pub load_average: String,
    pub rustc: String,
    pub target: String,
    pub rustflags: String,
    pub profile: String,
    pub commit: String,
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

/// The kernel's name, before the version that `sysinfo` gives. Rust writes `linux`, and our rows have `Linux`.
const KERNEL: &str = if cfg!(target_os = "linux") { "Linux" } else { std::env::consts::OS };

impl Machine {
    /// The machine in a few words, for figures.
    pub fn line(&self) -> String {
        let model = if self.cpu_model.is_empty() { String::new() } else { format!(" ({})", self.cpu_model) };
        format!("{} processors, {}{model}", self.processors, self.cpu)
    }

    pub fn look() -> Self {
        let asked = RefreshKind::nothing()
            .with_cpu(CpuRefreshKind::nothing())
            .with_memory(MemoryRefreshKind::nothing().with_ram());
        let system = System::new_with_specifics(asked).ok();
        let name = system.as_ref().and_then(|system| Some(system.cpus().first()?.brand().trim().to_string()));
        let kernel = System::kernel_version().ok().map(|version| format!("{KERNEL} {version}"));
        let load = System::load_average().ok();
        let load = load.map(|load| format!("{:.2} {:.2} {:.2}", load.one, load.five, load.fifteen));
        Self {
            cpu: or_unknown(name),
            cpu_model: processor_numbers(),
            cpu_features: instruction_sets(),
            processors: super::available_threads(),
            physical_cores: System::physical_core_count().unwrap_or(0),
            governor: or_unknown(read("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor")),
            memory_bytes: system.as_ref().map_or(0, System::total_memory),
            system: or_unknown(kernel),
            load_average: or_unknown(load),
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

/// The instruction sets of this processor that compilers choose between. Flags of the kernel are not among them: an
/// update of the kernel changes those.
fn instruction_sets() -> String {
    #[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
    macro_rules! detected {
        ($detect:ident: $($name:tt)*) => {
            [$(($name, std::arch::$detect!($name))),*]
        };
    }
    // The standard library has a macro for each architecture.
    #[cfg(target_arch = "x86_64")]
    let sets = detected!(is_x86_feature_detected:
        "sse3" "ssse3" "sse4.1" "sse4.2" "popcnt" "avx" "avx2" "bmi1" "bmi2" "fma" "f16c" "sha" "vaes" "gfni"
        "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl" "avx512ifma" "avx512vnni" "avx512bf16" "avx512fp16");
    #[cfg(target_arch = "aarch64")]
    let sets = detected!(is_aarch64_feature_detected:
        "neon" "fp16" "dotprod" "lse" "rcpc" "crc" "aes" "sha2" "sha3" "i8mm" "bf16" "sve" "sve2");
    // The detection of other architectures is not stable yet.
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let sets: [(&str, bool); 0] = [];
    sets.iter().filter(|(_, is_there)| *is_there).map(|(name, _)| *name).collect::<Vec<_>>().join(" ")
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
