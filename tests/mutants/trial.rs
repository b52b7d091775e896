//! Trials of faults in a scratch copy of the committed files.

use super::fault::{Fault, Sources};
use super::killer::{Killer, Killers};
use std::fmt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

pub(crate) enum Outcome {
    /// The failed cases or tests, or a time limit or crash.
    Killed(String),
    /// The cases or tests that should have noticed it.
    Survived(String),
    /// The reason why the fault could not be tried.
    NotTried(String),
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Killed(by) => write!(f, "killed by {by}"),
            Self::Survived(who) => write!(f, "SURVIVED {who}"),
            Self::NotTried(why) => write!(f, "not tried: {why}"),
        }
    }
}

pub(crate) struct Scratch {
    _folder: tempfile::TempDir,
    copy: PathBuf,
    target: PathBuf,
}

impl Scratch {
    pub(crate) fn new(root: &Path) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let scratch = Self { copy: folder.path().join("copy"), target: root.join("target/mutants"), _folder: folder };
        let clone = Command::new("git").args(["clone", "--quiet", "--shared"]).args([root, &scratch.copy]).status();
        assert!(clone.unwrap().success(), "git clone");
        scratch
    }

    pub(crate) fn try_fault(&self, fault: &Fault) -> Outcome {
        self.tried(fault).unwrap_or_else(Outcome::NotTried)
    }

    fn tried(&self, fault: &Fault) -> Result<Outcome, String> {
        let killer = Killers::read(&self.copy).find(&fault.killed_by)?;
        let right = Sources::read(&self.copy);
        let changed = fault.apply(&right)?;
        for (file, text) in &changed {
            std::fs::write(self.copy.join(file), text).unwrap();
        }
        let outcome = self.noticed(&killer);
        for file in changed.keys() {
            std::fs::write(self.copy.join(file), right.text(file)).unwrap();
        }
        let output = outcome?;
        let said = String::from_utf8_lossy(&output.stdout);
        let who: Vec<&str> = said.lines().filter(|line| line.contains("FAIL")).map(str::trim).collect();
        Ok(match output.status.success() {
            true => Outcome::Survived(fault.killed_by.clone()),
            false if who.is_empty() => Outcome::Killed("its time limit or a crash".into()),
            false => Outcome::Killed(who.join(", ")),
        })
    }

    /// Runs the cases or tests that should notice the fault. The error says why the copy does not compile.
    fn noticed(&self, killer: &Killer) -> Result<Output, String> {
        let limited = |program: &Path| {
            let mut command = self.command("timeout");
            command.arg("600").arg(program);
            command
        };
        let cargo = Path::new(env!("CARGO"));
        let (mut build, mut try_it) = (self.command(cargo), limited(cargo));
        match killer {
            Killer::Cases(ids) => {
                build.args(["build", "--quiet", "--bin", "pathmark"]);
                try_it = limited(&self.target.join("debug/pathmark"));
                try_it.arg("selftest").args(ids).arg("--quiet");
            }
            Killer::Tests(program, names) => {
                build.args(["test", "--quiet", "--workspace", "--no-run"]).args(program);
                try_it.args(["test", "--quiet", "--workspace"]).args(program).arg("--").args(names);
            }
        }
        let built = build.output().unwrap();
        if !built.status.success() {
            let said = String::from_utf8_lossy(&built.stderr);
            return Err(format!(
                "does not compile: {}",
                said.lines().find(|line| line.starts_with("error")).unwrap_or("")
            ));
        }
        Ok(try_it.output().unwrap())
    }

    /// A command in the copy. Compiling takes longer than the cases: less optimisation, and only the code that a fault
    /// changes.
    fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new(program);
        command.current_dir(&self.copy).env("CARGO_TARGET_DIR", &self.target).env("CARGO_INCREMENTAL", "1");
        command.env("CARGO_PROFILE_DEV_OPT_LEVEL", "1").env("CARGO_PROFILE_DEV_DEBUG", "false");
        command
    }
}
