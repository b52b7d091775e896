//! `--strict`: invalid samples are always left out and reported; with this option they are also a failure.

use super::prelude::*;

#[derive(Args)]
pub(super) struct Strict {
    /// Treat invalid samples (NaN, infinite, negative) as a failure: exit code 1
    #[arg(long)]
    strict: bool,
}

impl Strict {
    /// Refuses the option where it has nothing to check, for the reason given.
    pub(super) fn refuse(&self, problem: &str) -> Result<()> {
        if self.strict { Err(InputError::new("strict", "true", problem).into()) } else { Ok(()) }
    }

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
