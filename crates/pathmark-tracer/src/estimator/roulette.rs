//! Russian roulette: when paths may end, and with which probability. `--roulette albedo:5` is smallpt's rule: after the
//! fifth vertex, by the largest channel of the surface's albedo. `--roulette constant:0.8` is report B's rule: the same
//! probability after every vertex.
//!
//! The throughput of a surviving path is divided by its survival probability, so the mean stays the same under every
//! rule (Arvo and Kirk, "Particle Transport and Image Synthesis", 1990).

use crate::error::{InputError, Result};
use crate::math::{Real, Rgb};
use std::fmt;

/// The quantity that determines the survival probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum By {
    /// The largest channel of the vertex's albedo; in fog, of the transmittance.
    Albedo,
    /// The largest channel of the path's throughput after the vertex, at most 1.
    Throughput,
    /// The same probability at every vertex.
    Constant(f64),
}

/// A rule of Russian roulette: when and with which probability paths end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Roulette {
    /// The number that the survival of a path depends on.
    pub by: By,
    after: u16,
}

impl Roulette {
    /// The rule of smallpt: `if (++depth > 5)`.
    pub const SMALLPT: Self = Self { by: By::Albedo, after: 5 };

    /// The values that `--roulette` allows.
    pub const ALLOWED: &str = "albedo:N or throughput:N after the N-th vertex, N from 0 to 65534, constant:P with survival probability P after every vertex, 0 < P < 1, or never";

    /// Parses `albedo:5`, `throughput:2`, `constant:0.8` or `never`.
    pub fn parse(text: &str) -> Result<Self> {
        let unknown = || InputError::new("roulette", text, "is not a valid rule").allowed(Self::ALLOWED);
        if text == "never" {
            return Ok(Self { by: By::Albedo, after: u16::MAX });
        }
        let (by, after) = text.split_once(':').ok_or_else(unknown)?;
        if by == "constant" {
            let chance = after.parse().ok().filter(|chance| 0.0 < *chance && *chance < 1.0).ok_or_else(unknown)?;
            return Ok(Self { by: By::Constant(chance), after: 0 });
        }
        let by = match by {
            "albedo" => By::Albedo,
            "throughput" => By::Throughput,
            _ => return Err(unknown().into()),
        };
        let after = after.parse().ok().filter(|after| *after < u16::MAX).ok_or_else(unknown)?;
        Ok(Self { by, after })
    }

    /// The number of first vertices without roulette.
    #[inline]
    pub fn after(self) -> u16 {
        self.after
    }

    /// The survival probability at a vertex that passes on `passed` of the light, for a path with `throughput`.
    #[inline(always)]
    pub fn chance<T: Real>(self, throughput: Rgb<T>, passed: Rgb<T>) -> T {
        match self.by {
            By::Albedo => passed.largest(),
            By::Throughput => {
                let (one, largest) = (T::splat(1.0), (throughput * passed).largest());
                T::select(largest.lt(one), largest, one)
            }
            By::Constant(chance) => T::splat(chance),
        }
    }

    /// The survival probability after the `vertices`-th vertex, which passes on `passed` of the light, for a path with
    /// `throughput`; `None` before roulette begins.
    #[inline(always)]
    pub(super) fn survival(self, vertices: u16, throughput: Rgb, passed: impl FnOnce() -> Rgb) -> Option<f64> {
        if vertices <= self.after {
            return None;
        }
        Some(self.chance(throughput, passed()))
    }
}

impl fmt::Display for Roulette {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.by, self.after) {
            (_, u16::MAX) => f.write_str("never"),
            (By::Albedo, after) => write!(f, "albedo:{after}"),
            (By::Throughput, after) => write!(f, "throughput:{after}"),
            (By::Constant(chance), _) => write!(f, "constant:{chance}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for name in ["albedo:5", "albedo:0", "throughput:2", "throughput:65534", "constant:0.8", "never"] {
            assert_eq!(Roulette::parse(name).unwrap().to_string(), name);
        }
        assert_eq!(Roulette::parse("albedo:5").unwrap(), Roulette::SMALLPT);
        for name in [
            "",
            "albedo",
            "albedo:",
            "albedo:-1",
            "albedo:65535",
            "luck:3",
            "throughput:2.5",
            "never:1",
            "constant:0",
            "constant:1",
            "constant:nan",
            "constant:-.5",
        ] {
            assert!(Roulette::parse(name).unwrap_err().to_string().contains("throughput:N"), "{name}");
        }
    }

    #[test]
    fn survives_by_its_rule() {
        let (throughput, passed) = (Rgb { r: 0.5, g: 4.0, b: 0.1 }, Rgb { r: 0.25, g: 0.5, b: 0.75 });
        let survival = |name: &str, n| Roulette::parse(name).unwrap().survival(n, throughput, || passed);
        assert_eq!([survival("albedo:2", 2), survival("albedo:2", 3)], [None, Some(0.75)]);
        // The product is (0.125, 2, 0.075): a probability is at most 1.
        assert_eq!([survival("throughput:0", 1), survival("never", u16::MAX)], [Some(1.0), None]);
        assert_eq!([survival("constant:0.4", 0), survival("constant:0.4", 1)], [None, Some(0.4)]);
    }
}
