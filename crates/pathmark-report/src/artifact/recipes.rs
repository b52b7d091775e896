//! The scripts of an artifact, and the recipe of its container.

use super::again::folder_of;
use super::{FIRST, LEDGER, MEASURE};
use crate::claims::Answer;
use crate::lab::Lab;
use crate::measure::Machine;
use crate::shell;
use std::collections::BTreeSet;
use std::path::Path;

/// The program that an archive calls.
pub(super) struct Program {
    pub(super) name: String,
    pub(super) version: String,
    /// The name of its executable where it was installed.
    pub(super) command: String,
    /// The public address of its sources, if it is known.
    pub(super) address: Option<&'static str>,
}

/// The command that installs a program from its sources.
pub(super) fn installing(sources: &str, features: &BTreeSet<String>) -> String {
    let features = features.iter().map(String::as_str).collect::<Vec<&str>>().join(",");
    let features = if features.is_empty() { features } else { format!(" --features {features}") };
    format!("cargo install --locked --path {sources}{features}")
}

impl Program {
    /// `cargo install` gives Pathmark's own program its name, whatever that of this executable is.
    pub(super) fn of(lab: &Lab) -> Self {
        if !lab.is_pathmark() {
            let [name, version] = lab.program();
            return Self { name, version, command: shell::executable_name(), address: None };
        }
        let name = "pathmark".to_string();
        // The address in the sources stands for one that is not chosen yet.
        let address = Some(env!("CARGO_PKG_REPOSITORY")).filter(|address| !address.contains(".invalid/"));
        Self { command: name.clone(), name, version: env!("CARGO_PKG_VERSION").to_string(), address }
    }

    fn called<const N: usize>(&self, arguments: [&str; N]) -> String {
        shell::command_of(&self.command, arguments)
    }

    /// The command that judges a claim by the rows of the archive.
    pub(super) fn judging(&self, claim: u32) -> String {
        self.called(["artifact", ".", "--check", "--claim", &claim.to_string()])
    }

    /// The command that measures the experiment of a folder of rows again, into the folder that `out` names in a shell.
    pub(super) fn measuring(&self, folder: &Path, out: &str) -> String {
        format!("{} --out {out}", self.called(["replicate", &folder.display().to_string()]))
    }

    /// The script that judges the first claim by the rows.
    pub(super) fn first(&self, claim: u32) -> String {
        format!(
            "#!/bin/sh\n# Judges claim {claim} by the rows of this archive, and compares the verdict with the stated one.\nset -eu\n\
             cd \"$(dirname \"$0\")\"\n{}\n",
            self.judging(claim)
        )
    }

    /// The script that measures the rows of a claim again, if this program can.
    pub(super) fn measure(&self, answer: &Answer<'_>) -> Option<String> {
        let folder = folder_of(answer)?;
        Some(format!(
            "#!/bin/sh\n# Measures the rows of claim {} again and judges the claim by them. The argument is a folder for the new rows,\n\
             # from the folder of this script.\nset -eu\ncd \"$(dirname \"$0\")\"\nout=${{1:-../again}}\n\
             # Code 1 says that a statement is not reproduced, or that none could be judged; REPLICATION.md has them.\n{} || [ $? -eq 1 ]\n\
             {} \"$out\" {}\n",
            answer.claim.id,
            self.measuring(folder, "\"$out\""),
            self.called(["claims"]),
            ["--ledger", LEDGER, "--report", &answer.report.report].map(shell::quoted).join(" "),
        ))
    }

    /// The command that builds the container.
    pub(super) fn building(&self) -> String {
        let address = if self.address.is_some() { "" } else { "--build-arg REPOSITORY=ADDRESS " };
        format!("podman build --tag artifact {address}.")
    }

    /// The recipe of a container that builds the program of `machine`, which computed the verdicts, and judges the first
    /// claim. `measured` are the commits of the rows.
    pub(super) fn container(
        &self,
        machine: &Machine,
        measured: &BTreeSet<String>,
        features: &BTreeSet<String>,
        can_measure: bool,
    ) -> String {
        let Machine { commit, rustc, dirty, .. } = machine;
        let is_known = commit != "unknown";
        let name = &self.name;
        let mut notes = Vec::new();
        if self.address.is_none() {
            notes.push(format!("# ADDRESS is where git finds the sources of {name}; no public one is known here.\n"));
        }
        if !is_known {
            notes.push("# The program did not know its commit: give it with --build-arg COMMIT=...\n".to_string());
        } else if *dirty {
            notes.push("# The program had uncommitted changes, which this build lacks.\n".to_string());
        }
        let others: Vec<&str> = measured.iter().map(String::as_str).filter(|other| other != commit).collect();
        if !others.is_empty() {
            notes.push(format!("# COMMIT computed the verdicts; rows were measured at {}.\n", others.join(", ")));
        }
        let again = if can_measure { format!("#   podman run --rm artifact sh {MEASURE}\n") } else { String::new() };
        let notes = notes.concat();
        let commit = if is_known { commit.as_str() } else { "HEAD" };
        let rust = rustc.split_whitespace().nth(1).unwrap_or("stable");
        let address = self.address.map_or_else(String::new, |address| format!("={address}"));
        format!(
            "# Builds {name} and judges the first claim by the rows of this folder:\n\
             #   {}\n#   podman run --rm artifact\n{again}# `{} artifact` wrote this recipe and has not built it.\n{notes}\
             FROM docker.io/library/debian:13.8-slim\n\
             ARG REPOSITORY{address}\nARG COMMIT={commit}\nARG RUST={rust}\n\
             RUN apt-get update \\\n && apt-get install --yes --no-install-recommends ca-certificates g++ git rustup \\\n \
             && rm -rf /var/lib/apt/lists/*\n\
             RUN rustup toolchain install \"$RUST\" --profile minimal && rustup default \"$RUST\"\n\
             RUN git clone \"${{REPOSITORY:?needs --build-arg REPOSITORY=ADDRESS}}\" /sources \\\n \
             && git -C /sources checkout --detach \"$COMMIT\"\n\
             RUN {} --root /usr/local\n\
             COPY . /artifact\nWORKDIR /artifact\nCMD [\"sh\", \"{FIRST}\"]\n",
            self.building(),
            self.command,
            installing("/sources", features),
        )
    }
}
