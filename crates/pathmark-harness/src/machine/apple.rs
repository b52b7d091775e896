//! Apple's systems, and others that have `sysctl` instead of /proc.
//!
//! They take hints about threads instead of lists of processors, so no list is known and none can be set.

use super::cpu_list::cpu_list;
use crate::error::{Error, Result};
use std::io::ErrorKind;
use std::process::Command;

/// The processors that this thread may run on: the system does not tell.
pub fn allowed_cpus() -> Vec<usize> {
    Vec::new()
}

/// Refuses to let this thread run on these processors only.
pub fn pin_thread(cpus: &[usize]) -> Result<()> {
    Err(Error::system("pinning a thread to processor", cpu_list(cpus), ErrorKind::Unsupported.into()))
}

/// The processor that this thread runs on now: the system does not tell.
pub fn current_cpu() -> Option<u32> {
    None
}

/// A text that the processes of one running system share, and no others; empty if the system has none.
pub fn machine_id() -> String {
    sysctl(&["kern.bootsessionuuid"])
}

/// The makers' numbers of the processors; empty if the system does not tell.
pub(crate) fn processor_numbers() -> String {
    labelled(&sysctl(&["hw.cputype", "hw.cpusubtype", "hw.cpufamily"]))
}

/// A processor's numbers with their names, from a line for each; empty if a number is missing.
fn labelled(lines: &str) -> String {
    let numbers: Vec<&str> = lines.split_whitespace().collect();
    let [kind, subtype, family] = numbers[..] else { return String::new() };
    format!("type {kind} subtype {subtype} family {family}")
}

/// The values of these names, one per line; empty if the system lacks a name. The program is called instead of the
/// system's function, which would need unsafe code.
fn sysctl(names: &[&str]) -> String {
    let output = Command::new("sysctl").arg("-n").args(names).output().ok().filter(|output| output.status.success());
    output.map_or_else(String::new, |output| String::from_utf8_lossy(&output.stdout).trim().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_processor_has_all_its_numbers_or_none() {
        assert_eq!(labelled("16777228\n2\n458787763"), "type 16777228 subtype 2 family 458787763");
        assert_eq!((labelled("16777228\n2"), labelled("")), (String::new(), String::new()));
    }

    #[test]
    fn pins_are_refused_as_system_errors() {
        assert_eq!(pin_thread(&[0]).unwrap_err().exit_code(), 3);
    }
}
