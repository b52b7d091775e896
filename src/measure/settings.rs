//! The three axes of a run, by name: what is rendered, in which pieces, and who renders them when.

use crate::error::{InputError, Result};
use crate::film::check_size;
use crate::kernel::Spec;
use crate::lab::{SERIAL, THREAD_PER_ROW};
use crate::sampling::REFERENCE_SEEDS;
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::LazyLock;

/// Most workers that can be asked for, and most threads that a strategy may start by its own rule: systems refuse some tens of
/// thousands, some of them by ending the process.
pub(super) const LARGEST_THREADS: usize = 1 << 14;
/// Most samples per pixel.
pub const LARGEST_SPP: u32 = 1 << 24;
/// Largest seed of an image under test: the seeds above belong to references.
pub const LARGEST_SEED: u64 = REFERENCE_SEEDS - 1;

/// What to run. Every field is a name as it stands on the command line or in an experiment.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// Scene: a name or a path.
    pub scene: String,
    /// Samples per pixel.
    pub spp: u32,
    /// Whether each cell of a grid has as many samples as its noise calls for; `spp` is their mean then.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub adaptive: bool,
    /// What the kernel is built from.
    pub spec: Spec,
    /// How the film is cut into jobs.
    pub decomposition: String,
    /// How pieces get into the film.
    pub output: String,
    /// Who renders them.
    pub strategy: String,
    /// How many workers; of processes, in each.
    pub threads: usize,
    /// The rule by which processes that MPI connects share the jobs, if there are any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rank_rule: Option<String>,
    /// How many processes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranks: Option<u16>,
    /// Folder in which hierarchies of large scenes are looked for and kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cache: Option<PathBuf>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            scene: "cornell".to_string(),
            spp: 16,
            adaptive: false,
            spec: Spec::default(),
            decomposition: "tiles:32x32".to_string(),
            output: "slots".to_string(),
            strategy: "work-stealing".to_string(),
            threads: available_threads(),
            rank_rule: None,
            ranks: None,
            cache: None,
        }
    }
}

/// What a strategy on a decomposition is called.
pub fn schedule_name<'a>(strategy: &'a str, decomposition: &str) -> &'a str {
    if strategy == "thread-per-job" && decomposition == "rows" { THREAD_PER_ROW } else { strategy }
}

/// Refuses numbers of samples that no image of the estimator can have, which takes multiples of a number.
pub(super) fn check_spp(spp: u32, estimator: &str, multiple: u32) -> Result<()> {
    if !(1..=LARGEST_SPP).contains(&spp) {
        let allowed = format!("1 to {LARGEST_SPP}");
        return Err(InputError::new("spp", spp.to_string(), "is out of range").allowed(allowed).into());
    }
    if !spp.is_multiple_of(multiple) {
        let problem = format!("is no multiple of {multiple}, which {estimator} needs for its subpixels");
        let near = spp.next_multiple_of(multiple);
        let below = near - multiple;
        let allowed = if below == 0 { near.to_string() } else { format!("{below} or {near}") };
        return Err(InputError::new("spp", spp.to_string(), problem).allowed(allowed).into());
    }
    Ok(())
}

/// Threads that this process may use at once, as it was when somebody first asked: the answer takes eight calls of the system.
pub fn available_threads() -> usize {
    static THREADS: LazyLock<usize> =
        LazyLock::new(|| std::thread::available_parallelism().map_or(1, NonZeroUsize::get));
    *THREADS
}

impl Settings {
    /// The same with [`THREAD_PER_ROW`] spelled out.
    #[must_use]
    pub fn resolved(mut self) -> Self {
        if self.strategy == THREAD_PER_ROW {
            self.strategy = "thread-per-job".to_string();
            self.decomposition = "rows".to_string();
        }
        self
    }

    /// Workers over all processes, where each has so many threads.
    pub fn workers(&self, threads: usize) -> usize {
        threads * usize::from(self.ranks.unwrap_or(1))
    }

    /// Whether it is one worker that does one job after the other.
    pub fn is_serial(&self) -> bool {
        self.strategy == SERIAL && self.ranks.is_none()
    }

    /// Refuses numbers out of range, before anything is allocated or started. Seeds of references are allowed; whoever takes a seed
    /// from a user refuses those.
    pub(super) fn check(&self) -> Result<()> {
        check_size(self.spec.width, self.spec.height)?;
        if !(1..=LARGEST_THREADS).contains(&self.threads) {
            let allowed = format!("1 to {LARGEST_THREADS}");
            return Err(InputError::new("threads", self.threads.to_string(), "is out of range")
                .allowed(allowed)
                .into());
        }
        Ok(())
    }
}
