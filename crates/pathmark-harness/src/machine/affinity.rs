//! Affinity: the processors on which the system may run a thread.
//!
//! Only Linux lets programs choose them. Apple's systems take hints alone, so there no list is known and none can be set.

use super::cpu_list::cpu_list;
use crate::error::{Error, Result};
#[cfg(target_os = "linux")]
use nix::sched::{CpuSet, sched_getaffinity, sched_getcpu, sched_setaffinity};
#[cfg(target_os = "linux")]
use nix::unistd::Pid;

/// The processors that this thread may run on; empty if the system does not tell.
#[cfg(target_os = "linux")]
pub fn allowed_cpus() -> Vec<usize> {
    let Ok(set) = sched_getaffinity(Pid::from_raw(0)) else { return Vec::new() };
    (0..CpuSet::count()).filter(|cpu| set.is_set(*cpu).unwrap_or(false)).collect()
}

#[cfg(not(target_os = "linux"))]
pub fn allowed_cpus() -> Vec<usize> {
    Vec::new()
}

/// Lets this thread run on these processors only.
#[cfg(target_os = "linux")]
pub fn pin_thread(cpus: &[usize]) -> Result<()> {
    let failed = |error: nix::Error| Error::system("pinning a thread to processor", cpu_list(cpus), error.into());
    let mut set = CpuSet::new();
    for cpu in cpus {
        set.set(*cpu).map_err(failed)?;
    }
    sched_setaffinity(Pid::from_raw(0), &set).map_err(failed)
}

#[cfg(not(target_os = "linux"))]
pub fn pin_thread(cpus: &[usize]) -> Result<()> {
    let error = std::io::ErrorKind::Unsupported.into();
    Err(Error::system("pinning a thread to processor", cpu_list(cpus), error))
}

/// The processor that this thread runs on now; `None` if the system does not tell. On Linux the answer takes no system
/// call.
#[cfg(target_os = "linux")]
pub fn current_cpu() -> Option<u32> {
    sched_getcpu().ok().and_then(|cpu| u32::try_from(cpu).ok())
}

#[cfg(not(target_os = "linux"))]
pub fn current_cpu() -> Option<u32> {
    None
}

/// The affinity of a thread, which it gets back when this is dropped.
pub struct KeptAffinity(Vec<usize>);

impl KeptAffinity {
    /// The affinity of this thread.
    pub fn of_thread() -> Self {
        Self(allowed_cpus())
    }
}

impl Drop for KeptAffinity {
    fn drop(&mut self) {
        if !self.0.is_empty() {
            // The thread had this affinity before, so a refusal means that the system has taken processors away.
            pin_thread(&self.0).ok();
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
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
}
