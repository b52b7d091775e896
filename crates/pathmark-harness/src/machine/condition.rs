//! The condition of a machine before a measurement: what makes times unequal, as far as the system tells it.

use super::layout::Layout;
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// A fact about the machine, and advice if it disturbs measurements.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fact {
    pub name: String,
    /// `unknown` if the system does not tell it.
    pub value: String,
    /// Empty if there is none.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub advice: String,
}

impl Fact {
    pub(crate) fn new(name: &str, value: Option<String>, advice: &str) -> Self {
        let value = value.filter(|value| !value.is_empty()).unwrap_or_else(|| "unknown".to_string());
        Self { name: name.to_string(), value, advice: advice.to_string() }
    }
}

fn read(root: &Path, path: &str) -> Option<String> {
    fs::read_to_string(root.join(path)).ok().map(|text| text.trim().to_string())
}

/// The facts of this machine.
pub fn condition() -> Vec<Fact> {
    facts(Path::new("/"), &Layout::here())
}

fn facts(root: &Path, layout: &Layout) -> Vec<Fact> {
    let (governor, turbo, virtual_machine) = (governors(root), turbo(root), virtual_machine(root));
    let smt = (!layout.cores.is_empty()).then(|| if layout.has_smt() { "on" } else { "off" }.to_string());
    let kinds = (!layout.kinds.is_empty()).then(|| layout.kinds.len().to_string());
    let quota = layout.quota.map_or_else(|| "none".to_string(), |quota| format!("{quota} processors at once"));
    let clock = read(root, "sys/devices/system/clocksource/clocksource0/current_clocksource");
    let when = |is_so: bool, advice: &'static str| if is_so { advice } else { "" };
    vec![
        Fact::new(
            "governor",
            governor.clone(),
            when(
                governor.is_some_and(|governor| governor != "performance"),
                "the clock follows the load: choose the governor `performance` (cpupower frequency-set -g performance)",
            ),
        ),
        Fact::new(
            "turbo",
            turbo.map(|is_on| if is_on { "on" } else { "off" }.to_string()),
            when(
                turbo == Some(true),
                "the clock depends on temperature and on busy cores: turn it off for small differences",
            ),
        ),
        Fact::new(
            "threads of cores (SMT)",
            smt,
            when(layout.has_smt(), "two threads of one core share it: `--pin one-per-core` uses each core once"),
        ),
        Fact::new(
            "kinds of core",
            kinds,
            when(layout.kinds.len() > 1, "cores differ in speed: `--pin performance` uses the fastest kind"),
        ),
        Fact::new(
            "quota",
            Some(quota),
            when(
                layout.quota.is_some(),
                "the system stops all threads when the quota is used up: use at most so many threads",
            ),
        ),
        Fact::new(
            "virtual machine",
            virtual_machine.clone(),
            when(
                virtual_machine.is_some_and(|told| told != NO_VIRTUAL_MACHINE),
                "the host may give its processors to others, and may run two of yours on one core",
            ),
        ),
        Fact::new(
            "clock source",
            clock.clone(),
            when(
                clock.is_some_and(|clock| !QUICK_CLOCKS.contains(&clock.as_str())),
                "reading the clock takes a system call, which makes short jobs longer",
            ),
        ),
        Fact::new("temperature", temperature(root).map(|degrees| format!("{degrees:.0} degrees Celsius")), ""),
    ]
}

/// Clocks that programs read without a system call.
const QUICK_CLOCKS: [&str; 3] = ["tsc", "kvm-clock", "arch_sys_counter"];

/// The governors of all processors.
fn governors(root: &Path) -> Option<String> {
    let folders = fs::read_dir(root.join("sys/devices/system/cpu")).ok()?;
    let names =
        folders.filter_map(|entry| fs::read_to_string(entry.ok()?.path().join("cpufreq/scaling_governor")).ok());
    let all: BTreeSet<String> = names.map(|name| name.trim().to_string()).collect();
    Some(all.into_iter().collect::<Vec<_>>().join(", ")).filter(|names| !names.is_empty())
}

/// Whether the clock may rise above its base.
fn turbo(root: &Path) -> Option<bool> {
    let off = read(root, "sys/devices/system/cpu/intel_pstate/no_turbo").map(|off| off == "0");
    off.or_else(|| read(root, "sys/devices/system/cpu/cpufreq/boost").map(|boost| boost == "1"))
}

const NO_VIRTUAL_MACHINE: &str = "no";

/// The maker of the virtual machine, if the processor says that it is in one.
fn virtual_machine(root: &Path) -> Option<String> {
    let cpuinfo = read(root, "proc/cpuinfo")?;
    let mut flags = cpuinfo.lines().filter_map(|line| line.split_once(':')).filter(|(key, _)| key.trim() == "flags");
    // Only x86 has the flag; elsewhere nothing is known.
    let (_, flags) = flags.next()?;
    if !flags.split_whitespace().any(|flag| flag == "hypervisor") {
        return Some(NO_VIRTUAL_MACHINE.to_string());
    }
    let maker = ["sys_vendor", "product_name"].map(|name| read(root, &format!("sys/class/dmi/id/{name}")));
    let maker: Vec<String> = maker.into_iter().flatten().collect();
    Some(if maker.is_empty() { "yes".to_string() } else { format!("yes, {}", maker.join(" ")) })
}

/// The highest temperature of all sensors, in degrees Celsius.
fn temperature(root: &Path) -> Option<f64> {
    let zones = fs::read_dir(root.join("sys/class/thermal")).ok()?;
    let each =
        zones.filter_map(|entry| fs::read_to_string(entry.ok()?.path().join("temp")).ok()?.trim().parse::<f64>().ok());
    each.map(|thousandths| thousandths * 1e-3).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::topology::Topology;
    use super::super::topology::tests::{hybrid, two_sockets};
    use super::*;

    fn write(folder: &Path, files: &[(&str, &str)]) {
        for (name, text) in files {
            let path = folder.join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
    }

    fn found(folder: &Path, quota: Option<f64>) -> Vec<(String, String, bool)> {
        let layout = Layout::of(&Topology::read(folder), &[0], quota);
        let facts = facts(folder, &layout).into_iter();
        facts.map(|fact| (fact.name, fact.value, !fact.advice.is_empty())).collect()
    }

    fn table(rows: &[(&str, &str, bool)]) -> Vec<(String, String, bool)> {
        rows.iter().map(|(name, value, is_advised)| (name.to_string(), value.to_string(), *is_advised)).collect()
    }

    #[test]
    fn a_noisy_machine_gets_advice() {
        let folder = two_sockets();
        write(
            folder.path(),
            &[
                ("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave\n"),
                ("sys/devices/system/cpu/cpu1/cpufreq/scaling_governor", "performance\n"),
                ("sys/devices/system/cpu/intel_pstate/no_turbo", "0\n"),
                ("sys/devices/system/clocksource/clocksource0/current_clocksource", "hpet\n"),
                ("proc/cpuinfo", "flags\t\t: fpu hypervisor sse\n"),
                ("sys/class/dmi/id/sys_vendor", "QEMU\n"),
                ("sys/class/thermal/thermal_zone0/temp", "41000\n"),
                ("sys/class/thermal/thermal_zone1/temp", "67500\n"),
            ],
        );
        let expected = table(&[
            ("governor", "performance, powersave", true),
            ("turbo", "on", true),
            ("threads of cores (SMT)", "on", true),
            ("kinds of core", "1", false),
            ("quota", "1.5 processors at once", true),
            ("virtual machine", "yes, QEMU", true),
            ("clock source", "hpet", true),
            ("temperature", "68 degrees Celsius", false),
        ]);
        assert_eq!(found(folder.path(), Some(1.5)), expected);
    }

    #[test]
    fn a_quiet_machine_gets_none_except_for_its_slow_cores() {
        let folder = hybrid();
        write(
            folder.path(),
            &[
                ("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance\n"),
                ("sys/devices/system/cpu/cpufreq/boost", "0\n"),
                ("sys/devices/system/clocksource/clocksource0/current_clocksource", "tsc\n"),
                ("proc/cpuinfo", "flags\t\t: fpu sse\n"),
            ],
        );
        let expected = table(&[
            ("governor", "performance", false),
            ("turbo", "off", false),
            ("threads of cores (SMT)", "off", false),
            ("kinds of core", "2", true),
            ("quota", "none", false),
            ("virtual machine", "no", false),
            ("clock source", "tsc", false),
            ("temperature", "unknown", false),
        ]);
        assert_eq!(found(folder.path(), None), expected);
    }

    #[test]
    fn a_system_that_tells_nothing_gives_unknown_facts() {
        let folder = tempfile::tempdir().unwrap();
        let facts = found(folder.path(), None);
        assert!(facts.iter().all(|(name, value, is_advised)| (value == "unknown" || name == "quota") && !is_advised));
    }
}
