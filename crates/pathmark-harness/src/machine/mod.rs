//! The machine that a process runs on: its processors, how they share cores and caches, and where threads may run.

mod affinity;
// Each operating system has a file with the same functions: Linux has /proc and affinity, others have neither.
#[cfg(not(target_os = "linux"))]
mod apple;
mod clock;
mod condition;
mod cpu_list;
mod layout;
#[cfg(target_os = "linux")]
mod linux;
mod pinning;
mod quota;
mod topology;

pub use affinity::KeptAffinity;
#[cfg(not(target_os = "linux"))]
use apple as system;
pub use clock::clock_mhz;
pub use condition::{Fact, condition};
pub use cpu_list::{cpu_list, parse_cpu_list};
pub use layout::{CacheLayout, CoreKind, Layout};
#[cfg(target_os = "linux")]
use linux as system;
pub use pinning::PinPolicy;
pub use quota::cpu_quota;
pub(crate) use system::processor_numbers;
pub use system::{allowed_cpus, current_cpu, machine_id, pin_thread};
pub use topology::{Cache, Cpu, Topology};
