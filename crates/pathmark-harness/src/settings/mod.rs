//! The settings of a run, by name, and everything that follows from their list: keys, columns, options and labels.

mod keys;
mod list;
mod seconds;
mod table;
mod value;

use crate::error::{InputError, Result};
use crate::film::check_size;
use crate::kernel::Spec;
use crate::lab::{SERIAL, THREAD_PER_ROW};
use crate::sampling::REFERENCE_SEEDS;
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::sync::LazyLock;

pub use keys::{ImageKey, ScheduleKey};
pub(crate) use list::settings_list;
pub use seconds::Seconds;
pub use table::{SETTINGS, Setting, image_columns, parse_size, schedule_columns};
pub(crate) use value::Asked;
pub use value::Kind;

/// Most workers that a user may request, and most threads that a strategy may start by its own rule: systems refuse
/// some tens of thousands, and some of them end the process.
pub(crate) const LARGEST_THREADS: usize = 1 << 14;
/// Most bytes that numbers of the user may reserve at once. Images of the largest size need a quarter of them, in
/// pieces of usual sizes.
pub const LARGEST_BYTES: u64 = 16 << 30;
pub const LARGEST_SPP: u32 = 1 << 24;
/// Largest seed of an image under test: the seeds above belong to references.
pub const LARGEST_SEED: u64 = REFERENCE_SEEDS - 1;

/// Reads the list until no entry is left: fields and defaults of those that are a run's own.
macro_rules! asked {
    ({} image { $($image:tt)* } schedule { $($schedule:tt)* }) => {
        asked! { [] [] $($image)* $($schedule)* }
    };
    ([$($fields:tt)*] [$($defaults:tt)*]
        $(#[doc = $about:literal])+ own $field:ident: $kind:ty = $default:expr, $setting:expr
        $(, when $when:meta)? $(, read $read:meta)?; $($rest:tt)*
    ) => {
        asked! {
            [$($fields)* $(#[doc = $about])+ $(#[$when])?
                #[serde(default, skip_serializing_if = "is_unset")] pub $field: $kind,]
            [$($defaults)* $(#[$when])? $field: $default,]
            $($rest)*
        }
    };
    ($fields:tt $defaults:tt
        $(#[doc = $about:literal])+ $place:ident $field:ident: $kind:ty, $setting:expr
        $(, when $when:meta)? $(, read $read:meta)?; $($rest:tt)*
    ) => {
        asked! { $fields $defaults $($rest)* }
    };
    ([$($fields:tt)*] [$($defaults:tt)*]) => {
        /// The settings of a run. Every field is a name as on the command line or in an experiment.
        #[derive(Debug, Clone, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct Settings {
            $($fields)*
            pub spec: Spec,
        }

        impl Default for Settings {
            fn default() -> Self {
                Self { $($defaults)* spec: Spec::default() }
            }
        }
    };
}

settings_list!(asked {});

fn is_unset<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

pub fn schedule_name<'a>(strategy: &'a str, decomposition: &str) -> &'a str {
    if strategy == "thread-per-job" && decomposition == "rows" { THREAD_PER_ROW } else { strategy }
}

/// Refuses numbers of samples that no image of the estimator can have: it needs a multiple of `multiple`.
pub(crate) fn check_spp(spp: u32, estimator: &str, multiple: u32) -> Result<()> {
    if !(1..=LARGEST_SPP).contains(&spp) {
        let allowed = format!("1 to {LARGEST_SPP}");
        return Err(InputError::new("spp", spp.to_string(), "is out of range").allowed(allowed).into());
    }
    if !spp.is_multiple_of(multiple) {
        let problem = format!("is not a multiple of {multiple}, which {estimator} needs for its subpixels");
        let near = spp.next_multiple_of(multiple);
        let below = near - multiple;
        let allowed = if below == 0 { near.to_string() } else { format!("{below} or {near}") };
        return Err(InputError::new("spp", spp.to_string(), problem).allowed(allowed).into());
    }
    Ok(())
}

/// Refuses a number that is not above 0, or not finite.
pub(crate) fn check_positive(field: &str, value: f64) -> Result<()> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    let error = InputError::new(field, value.to_string(), "is out of range");
    Err(error.allowed("finite numbers above 0").into())
}

/// Threads that this process may use at once, as of the first call: the answer takes eight system calls.
pub fn available_threads() -> usize {
    static THREADS: LazyLock<usize> =
        LazyLock::new(|| std::thread::available_parallelism().map_or(1, NonZeroUsize::get));
    *THREADS
}

impl Settings {
    /// The same settings with [`THREAD_PER_ROW`] spelled out.
    #[must_use]
    pub fn resolved(mut self) -> Self {
        if self.strategy == THREAD_PER_ROW {
            self.strategy = "thread-per-job".to_string();
            self.decomposition = "rows".to_string();
        }
        self
    }

    /// Workers over all processes, if each has `threads` threads.
    pub fn workers(&self, threads: usize) -> usize {
        threads * usize::from(self.ranks.unwrap_or(1))
    }

    /// Whether one worker runs one job after the other.
    pub fn is_serial(&self) -> bool {
        self.strategy == SERIAL && self.ranks.is_none()
    }

    /// Refuses numbers out of range, before anything is allocated or started. Seeds of references are allowed; callers
    /// that take a seed from a user refuse those.
    pub(crate) fn check(&self) -> Result<()> {
        check_size(self.spec.width, self.spec.height)?;
        if !(1..=LARGEST_THREADS).contains(&self.threads) {
            let allowed = format!("1 to {LARGEST_THREADS}");
            return Err(InputError::new("threads", self.threads.to_string(), "is out of range")
                .allowed(allowed)
                .into());
        }
        self.time_limit_s.map_or(Ok(()), |limit| check_positive("time-limit", limit.into()))
    }
}
