//! Random numbers by address: a number depends on the place of its use, never on the numbers drawn before.
//!
//! So a sample is a pure function of (scene, seed, pixel, sample index), whichever worker renders it. An effect that
//! draws more numbers leaves all others unchanged. `pathmark list samplers` prints the table; `--sampler independent`
//! chooses.

#[doc(hidden)]
mod burley;
pub mod hash;
#[doc(hidden)]
pub mod independent;
mod libc_rand;
mod locked;
mod owen;
mod padded;
mod per_thread;
mod racy;
mod same_seed;
#[doc(hidden)]
pub mod sobol;
#[doc(hidden)]
mod stratified;
#[cfg(test)]
mod tests;
mod unpadded;
mod warp;

pub use crate::math::unit;
pub use hash::Hash;
pub use independent::{Independent, mix};
pub use libc_rand::LibcRand;
pub use locked::Locked;
pub use padded::Padded;
pub use per_thread::PerThread;
pub use racy::Racy;
pub use same_seed::SameSeed;
pub use sobol::{ORDERS, SUBPIXEL, Sobol, each_third};
pub use stratified::Stratified;
pub use unpadded::Unpadded;
pub use warp::{UNIFORM_SPHERE_DENSITY, concentric_disk, cosine_hemisphere, tent, uniform_sphere};

/// The identity of a sample: its image's seed, its pixel and its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SampleKey {
    /// The image's seed; [`REFERENCE_SEEDS`] and above belong to references.
    pub seed: u64,
    /// The pixel's index, row by row from the top left.
    pub pixel: u32,
    /// The sample's index within its pixel.
    pub sample: u32,
}

/// Seeds from here on are only for references: an image under test never shares a sample with its reference.
pub const REFERENCE_SEEDS: u64 = 1 << 63;

/// The purpose of a pair of random numbers. Each bounce has room for 8 purposes, 16 dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Purpose {
    /// The position inside the pixel's filter.
    Film = 0,
    /// The scattered direction at a surface, and the choice between its lobes.
    Bsdf = 1,
    Roulette = 2,
    /// The position on the camera's lens.
    Lens = 3,
    /// The distance that light travels through a medium.
    Medium = 4,
    /// The point on a light, for next-event estimation.
    Light = 5,
    LightChoice = 6,
}

impl Purpose {
    pub const ALL: [Self; 7] =
        [Self::Film, Self::Bsdf, Self::Roulette, Self::Lens, Self::Medium, Self::Light, Self::LightChoice];
}

/// The place where a pair of random numbers is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Address {
    pub key: SampleKey,
    /// The index of the path's vertex; the camera's is 0.
    pub bounce: u16,
    /// 0 for the main path; each part of a split path has its own number. At the camera: the number of the camera ray.
    pub branch: u16,
    pub purpose: Purpose,
}

/// A source of random numbers by address.
pub trait Sampler: Send + Sync {
    /// Two numbers in [0, 1), the same for the same address unless the table says that the sampler is not deterministic.
    fn pair(&self, at: Address) -> [f64; 2];
}

impl Sampler for &dyn Sampler {
    fn pair(&self, at: Address) -> [f64; 2] {
        (**self).pair(at)
    }
}

impl Sampler for Box<dyn Sampler> {
    fn pair(&self, at: Address) -> [f64; 2] {
        (**self).pair(at)
    }
}

/// One line of the table of samplers.
pub struct Entry {
    /// Its name on the command line, in CSV and TOML.
    pub name: &'static str,
    pub about: &'static str,
    /// Whether a number depends on its address alone. Images of other samplers have no checksum.
    pub deterministic: bool,
    /// Checksum of `cornell` at 96x64, 8 spp, seed 7, by the estimator `bsdf` and the scalar kernel. It is this
    /// program's own output and no evidence of correct light transport. Case P18 compares it, to detect a build or a
    /// machine that changes a bit. A deliberate change of the arithmetic raises `kernel::REVISION` and replaces it.
    /// None if the sampler is not deterministic.
    pub checksum: Option<&'static str>,
}

/// The name of `sobol` in rows of version 0.1, whose `sobol` was another one of this kind.
const OLD_SOBOL: &str = "sobol-burley";

macro_rules! samplers {
    (
        keyed { $($keyed:literal, $keyed_about:literal, $keyed_checksum:literal => $Keyed:ident;)* }
        spread { $($spread:literal, $spread_about:literal, $spread_checksum:literal => $Spread:ident;)* }
        stateful { $($stateful:literal, $stateful_about:literal => $new_stateful:expr;)* }
    ) => {
        /// The samplers, in the order in which they are listed.
        pub const SAMPLERS: &[Entry] = &[
            $(Entry { name: $keyed, about: $keyed_about, deterministic: true, checksum: Some($keyed_checksum) },)*
            $(Entry { name: $spread, about: $spread_about, deterministic: true, checksum: Some($spread_checksum) },)*
            $(Entry { name: $stateful, about: $stateful_about, deterministic: false, checksum: None },)*
        ];

        /// The deterministic sampler of that name; `None` if there is none.
        pub fn keyed_sampler(name: &str) -> Option<Box<dyn Sampler>> {
            match name {
                $($keyed => Some(Box::new($Keyed)),)*
                $($spread => Some(Box::new($Spread)),)*
                _ => None,
            }
        }

        /// Whether the sampler of that name spreads a pixel's samples more evenly than independent random numbers.
        pub fn is_spread(name: &str) -> bool {
            [$($spread,)* OLD_SOBOL].contains(&name)
        }

        /// Creates the stateful sampler of that name for an image's seed; `None` if there is none.
        pub fn stateful_sampler(name: &str, seed: u64) -> Option<Box<dyn Sampler>> {
            match name {
                $($stateful => Some(Box::new($new_stateful(seed))),)*
                _ => None,
            }
        }
    };
}

samplers! {
    keyed {
        "independent", "uniform and independent numbers from PCG32, keyed by a mixed hash of the address", "b1ebf84aaad23140" => Independent;
        "hash", "uniform numbers from one 64-bit hash of the address: independent down to 2^-32, and faster", "00916d15f783380b" => Hash;
    }
    spread {
        "stratified", "4x4 jittered strata for each 16 samples, in a separate order for each use", "0d0de625fc782297" => Stratified;
        "sobol", "Owen-scrambled Sobol pairs (Burley 2020), with separate scrambling and order for each use", "9ad64a7ff83a2dc3" => Sobol;
    }
    stateful {
        "libc-rand", "the C library's one rand() behind its lock (report A); not deterministic" => LibcRand::new;
        "locked", "one PCG32 behind a lock; not deterministic" => Locked::new;
        "per-thread", "a PCG32 for each thread; not deterministic" => PerThread::new;
        "padded", "a SplitMix64 for each thread, each on cache lines of its own; not deterministic" => Padded::new;
        "unpadded", "wrong on purpose: as padded, but side by side on one cache line; not deterministic" => Unpadded::new;
        "racy", "wrong on purpose: one SplitMix64 for all threads, without a lock; not deterministic" => Racy::new;
        "same-seed", "wrong on purpose: as per-thread, but with the same numbers in every thread; not deterministic" => SameSeed::new;
    }
}

/// Whether the sampler of that name returns the same numbers in each run.
pub fn is_deterministic(name: &str) -> bool {
    SAMPLERS.iter().any(|entry| entry.name == name && entry.deterministic)
}
