//! The machine that a process runs on: its processors, how they share cores and caches, and where threads may run.

mod affinity;
mod clock;
mod condition;
mod cpu_list;
mod layout;
mod pinning;
mod quota;
mod topology;

pub use affinity::{KeptAffinity, allowed_cpus, current_cpu, pin_thread};
pub use clock::clock_mhz;
pub use condition::{Fact, condition};
pub use cpu_list::{cpu_list, parse_cpu_list};
pub use layout::{CacheLayout, CoreKind, Layout};
pub use pinning::PinPolicy;
pub use quota::cpu_quota;
pub use topology::{Cache, Cpu, Topology};

/// A text that the processes of one running system share, and no others; empty if the system has none.
pub fn machine_id() -> String {
    std::fs::read_to_string("/proc/sys/kernel/random/boot_id").unwrap_or_default()
}
