//! Linux: affinity by system calls, facts from /proc.

use super::cpu_list::cpu_list;
use crate::error::{Error, Result};
use nix::sched::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
use nix::unistd::Pid;
use std::collections::BTreeSet;
use std::fs;

/// The processors that this thread may run on; empty if the system does not tell.
pub fn allowed_cpus() -> Vec<usize> {
    let Ok(set) = sched_getaffinity(Pid::from_raw(0)) else { return Vec::new() };
    (0..CpuSet::count()).filter(|cpu| set.is_set(*cpu).unwrap_or(false)).collect()
}

/// Lets this thread run on these processors only.
pub fn pin_thread(cpus: &[usize]) -> Result<()> {
    let failed = |error: nix::Error| Error::system("pinning a thread to processor", cpu_list(cpus), error.into());
    let mut set = CpuSet::new();
    for cpu in cpus {
        set.set(*cpu).map_err(failed)?;
    }
    sched_setaffinity(Pid::from_raw(0), &set).map_err(failed)
}

/// The processor that this thread runs on now; `None` if the system does not tell. The answer takes no system call.
pub fn current_cpu() -> Option<u32> {
    sched_getcpu().ok().and_then(|cpu| u32::try_from(cpu).ok())
}

/// A text that the processes of one running system share, and no others; empty if the system has none.
pub fn machine_id() -> String {
    fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default()
}

/// The makers' numbers of the processors; empty if the system does not tell.
pub(crate) fn processor_numbers() -> String {
    model_numbers(&fs::read_to_string("/proc/cpuinfo").unwrap_or_default())
}

/// The makers' numbers of the processors in the text of /proc/cpuinfo: vendor, family, model and stepping on x86, and
/// implementer, part, variant and revision on ARM. A machine with cores of several kinds has several, separated by
/// commas. Empty if the text has none of them.
fn model_numbers(cpuinfo: &str) -> String {
    let kinds: BTreeSet<String> = cpuinfo.split("\n\n").filter_map(one).collect();
    kinds.into_iter().collect::<Vec<_>>().join(", ")
}

fn one(paragraph: &str) -> Option<String> {
    let value = |key: &str| {
        let lines = paragraph.lines().filter_map(|line| line.split_once(':'));
        lines.into_iter().find(|(name, _)| name.trim() == key).map(|(_, value)| value.trim())
    };
    let fields = |head: &str, pairs: &[(&str, &str)]| {
        let numbers = pairs.iter().filter_map(|(name, key)| Some(format!(" {name} {}", value(key)?)));
        format!("{head}{}", numbers.collect::<String>())
    };
    if let Some(vendor) = value("vendor_id") {
        return Some(fields(vendor, &[("family", "cpu family"), ("model", "model"), ("stepping", "stepping")]));
    }
    let implementer = value("CPU implementer")?;
    let numbers = [("part", "CPU part"), ("variant", "CPU variant"), ("revision", "CPU revision")];
    Some(fields(&format!("implementer {implementer}"), &numbers))
}

#[cfg(test)]
mod tests {
    use super::super::KeptAffinity;
    use super::*;

    /// A thread of its own, so that the pin ends with it.
    #[test]
    fn a_pinned_thread_stays_until_it_gets_its_affinity_back() {
        let all = allowed_cpus();
        let pinned = std::thread::spawn(move || {
            let kept = KeptAffinity::of_thread();
            pin_thread(&all[..1]).unwrap();
            let there = (allowed_cpus(), current_cpu());
            drop(kept);
            (there, allowed_cpus(), all)
        });
        let (there, after, all) = pinned.join().unwrap();
        assert_eq!(there, (vec![all[0]], u32::try_from(all[0]).ok()));
        assert_eq!(after, all);
    }

    #[test]
    fn refused_pins_are_system_errors() {
        let none = std::thread::spawn(|| pin_thread(&[]).unwrap_err()).join().unwrap();
        assert_eq!(none.exit_code(), 3);
        let unknown = std::thread::spawn(|| pin_thread(&[CpuSet::count() + 1]).unwrap_err()).join().unwrap();
        assert_eq!(unknown.exit_code(), 3);
    }

    fn x86(family: u32) -> String {
        format!(
            "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: {family}\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n\
             stepping\t: 1\n\nprocessor\t: 1\nvendor_id\t: AuthenticAMD\ncpu family\t: {family}\nmodel\t\t: 2\n\
             model name\t: AMD EPYC\nstepping\t: 1\n"
        )
    }

    fn arm(part: &str) -> String {
        format!(
            "processor\t: 0\nBogoMIPS\t: 50.00\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\nCPU architecture: 8\n\
             CPU variant\t: 0x3\nCPU part\t: {part}\nCPU revision\t: 1\n"
        )
    }

    #[test]
    fn families_of_one_name_are_different_processors() {
        assert_eq!(model_numbers(&x86(26)), "AuthenticAMD family 26 model 2 stepping 1");
        assert_ne!(model_numbers(&x86(25)), model_numbers(&x86(26)));
    }

    #[test]
    fn arm_processors_have_numbers_instead_of_a_name() {
        assert_eq!(model_numbers(&arm("0xd0c")), "implementer 0x41 part 0xd0c variant 0x3 revision 1");
        let both = format!("{}\n{}", arm("0xd05"), arm("0xd0b"));
        assert_eq!(
            model_numbers(&both),
            "implementer 0x41 part 0xd05 variant 0x3 revision 1, implementer 0x41 part 0xd0b variant 0x3 revision 1"
        );
    }

    #[test]
    fn a_text_without_numbers_gives_none() {
        assert_eq!(model_numbers(""), "");
        assert_eq!(model_numbers("processor\t: 0\nfeatures\t: vx\n"), "");
    }
}
