//! The C library's generator: `--sampler libc-rand`.
//!
//! Report A's program (docs/reports.md) draws its numbers from `rand()`. That function has one state for the whole
//! process, and glibc guards it with a lock, so threads wait for each other at every number. Other C libraries need not
//! do so (POSIX), so there the lock is ours. The numbers that a sample
//! gets depend on which thread comes first: no two runs with more than one thread are alike. This sampler exists to be
//! measured, not to be used.

#![expect(unsafe_code, reason = "rand and srand belong to the C library")]

use super::{Address, Sampler};
#[cfg(not(target_env = "gnu"))]
use std::sync::{Mutex, PoisonError};

/// The lock of the generator where the C library may have none.
#[cfg(not(target_env = "gnu"))]
static GENERATOR: Mutex<()> = Mutex::new(());

/// Calls the C library's generator while no other thread does.
fn alone<T>(call: impl FnOnce() -> T) -> T {
    #[cfg(not(target_env = "gnu"))]
    let _guard = GENERATOR.lock().unwrap_or_else(PoisonError::into_inner);
    call()
}

/// The sampler; its state is the C library's.
#[derive(Debug)]
pub struct LibcRand(());

impl LibcRand {
    /// Reseeds the process's single generator.
    pub fn new(seed: u64) -> Self {
        // SAFETY: any number is a seed, and a lock, glibc's or ours, keeps other threads away.
        alone(|| unsafe { libc::srand(seed as libc::c_uint) });
        Self(())
    }
}

/// A multiple of 2^-31 in [0, 1). Report A divides by `RAND_MAX` itself, which can give 1.
fn unit() -> f64 {
    // SAFETY: takes nothing and has no precondition; a lock, glibc's or ours, keeps other threads away.
    let number = alone(|| unsafe { libc::rand() });
    f64::from(number) / (f64::from(libc::RAND_MAX) + 1.0)
}

impl Sampler for LibcRand {
    fn pair(&self, _: Address) -> [f64; 2] {
        [unit(), unit()]
    }
}
