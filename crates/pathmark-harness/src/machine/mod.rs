//! The machine that a process runs on: its processors, how they share cores and caches, and where threads may run.

mod cpu_list;
mod pinning;
mod quota;
mod topology;

pub use cpu_list::{cpu_list, parse_cpu_list};
pub use pinning::{PinPolicy, allowed_cpus, pin_thread};
pub use quota::cpu_quota;
pub use topology::{Cache, Cpu, Topology};
