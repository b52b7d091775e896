//! Profiles: the sizes at which an experiment is run, and their tables in a definition.

use super::Definition;
use super::table::Scale;
use crate::error::{InputError, Result};
use serde::Deserialize;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// Small images: minutes.
    #[default]
    Quick,
    /// Larger images, or more of them, than the question needs: up to hours.
    Full,
    /// The sizes and parameters of the reports: an hour.
    Reports,
}

impl Profile {
    pub const ALL: [Self; 3] = [Self::Quick, Self::Full, Self::Reports];

    /// Its name in files and, after `--`, on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quick => "quick",
            Self::Full => "full",
            Self::Reports => "reports",
        }
    }

    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|profile| profile.name() == name)
    }
}

impl Definition {
    pub fn profiles(&self) -> impl Iterator<Item = Profile> {
        Profile::ALL.into_iter().filter(|profile| self.table(*profile).is_some())
    }

    pub fn has(&self, profile: Profile) -> bool {
        self.table(profile).is_some()
    }

    fn table(&self, profile: Profile) -> Option<&Scale> {
        match profile {
            Profile::Quick => self.quick.as_ref(),
            Profile::Full => self.full.as_ref(),
            Profile::Reports => self.reports.as_ref(),
        }
    }

    pub(super) fn scale(&self, profile: Profile) -> Result<&Scale> {
        self.table(profile).ok_or_else(|| {
            let problem = format!("the experiment {} has no table [{}]", self.name, profile.name());
            let options: Vec<String> = self.profiles().map(|profile| format!("--{}", profile.name())).collect();
            let error = InputError::new("profile", profile.name(), problem).allowed(options.join(", "));
            error.in_file(&self.file, None).into()
        })
    }

    /// Refuses a matrix that names a missing profile, and a profile without a matrix.
    pub(super) fn check_profiles(&self) -> Result<()> {
        let named = self.matrix.iter().filter_map(|matrix| matrix.profiles.as_ref()).flatten();
        if let Some(absent) = named.copied().find(|profile| !self.has(*profile)) {
            let problem = format!("there is no table [{}] in the definition", absent.name());
            let names: Vec<&str> = self.profiles().map(Profile::name).collect();
            let error = InputError::new("profiles", absent.name(), problem).allowed(names.join(", "));
            return Err(self.located(absent, error));
        }
        match self.profiles().find(|profile| !self.matrix.iter().any(|matrix| matrix.is_for(*profile))) {
            None => Ok(()),
            Some(profile) => {
                let problem = format!("no matrix is left for the profile {}", profile.name());
                let error = InputError::new("profiles", "", problem);
                Err(self.located(profile, error.allowed(format!("{} in the profiles of a matrix", profile.name()))))
            }
        }
    }
}
