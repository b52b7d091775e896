//! Clamps: they cut bright radiance, and with it noise and energy. `--clamp subpixel` is smallpt's clamp, `--clamp
//! recursion` is report B's, and `--clamp recursion:10` cuts at 10 instead of 1.

use crate::error::{InputError, Result};
use std::fmt;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clamped {
    /// The mean of each subpixel before averaging, as smallpt does.
    Subpixel,
    /// The radiance that each recursion returns, as report B does.
    Recursion,
}

/// A clamp of radiance in each channel: biased.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clamp {
    pub what: Clamped,
    /// The largest radiance after the clamp, above 0.
    pub limit: f64,
}

impl Clamp {
    /// The values that `--clamp` allows, for error messages.
    pub const ALLOWED: &str = "subpixel or recursion, with a limit above 0 if it is not 1, as in recursion:10";

    /// Reads `subpixel`, `recursion` or `recursion:10`.
    pub fn parse(text: &str) -> Result<Self> {
        let unknown = || InputError::new("clamp", text, "is not a valid clamp").allowed(Self::ALLOWED);
        let (what, limit) = text.split_once(':').unwrap_or((text, "1"));
        let what = match what {
            "subpixel" => Clamped::Subpixel,
            "recursion" => Clamped::Recursion,
            _ => return Err(unknown().into()),
        };
        let limit = limit.parse().ok().filter(|limit: &f64| limit.is_finite() && *limit > 0.0).ok_or_else(unknown)?;
        Ok(Self { what, limit })
    }
}

impl fmt::Display for Clamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = match self.what {
            Clamped::Subpixel => "subpixel",
            Clamped::Recursion => "recursion",
        };
        if self.limit == 1.0 { f.write_str(name) } else { write!(f, "{name}:{}", self.limit) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for name in ["subpixel", "recursion", "recursion:10", "subpixel:0.5"] {
            assert_eq!(Clamp::parse(name).unwrap().to_string(), name);
        }
        assert_eq!(Clamp::parse("recursion:1").unwrap().to_string(), "recursion");
        for name in ["", "pixel", "recursion:", "recursion:0", "subpixel:-1", "subpixel:nan", "recursion:inf"] {
            assert!(Clamp::parse(name).unwrap_err().to_string().contains("recursion:10"), "{name}");
        }
    }
}
