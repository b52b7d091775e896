//! `--strict`: invalid samples are always left out and reported; with this option they are also a failure.

use crate::error::{Error, Result};
use clap::Args;

#[derive(Args)]
pub(super) struct Strict {
    /// Take invalid samples (NaN, infinite, negative) for a failure: exit code 1
    #[arg(long)]
    strict: bool,
}

impl Strict {
    /// Fails if there are invalid samples and the option is set.
    pub(super) fn check(&self, count: u64) -> Result<()> {
        if !self.strict || count == 0 {
            return Ok(());
        }
        Err(Error::Check(format!("{count} samples were NaN, infinite or negative, and contributed nothing")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_strict_refuse() {
        let [lax, strict] = [false, true].map(|strict| Strict { strict });
        assert!(lax.check(0).is_ok() && lax.check(3).is_ok() && strict.check(0).is_ok());
        assert_eq!(strict.check(3).unwrap_err().exit_code(), 1);
    }
}
