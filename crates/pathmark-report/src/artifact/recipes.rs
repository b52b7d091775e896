//! The scripts of an artifact, and the recipe of its container.

use super::again::Again;
use super::{FIRST, LEDGER, MEASURE};
use crate::claims::Answer;
use crate::measure::Machine;
use crate::shell;
use std::collections::BTreeSet;
use std::path::Path;

/// The command that judges a claim by the rows of the archive.
pub(super) fn judging(claim: u32) -> String {
    shell::command(["artifact", ".", "--check", "--claim", &claim.to_string()])
}

/// The command that measures the experiment of a folder of rows again, into the folder that `out` names in a shell.
pub(super) fn measuring(folder: &Path, out: &str) -> String {
    format!("{} --out {out}", shell::command(["replicate", &folder.display().to_string()]))
}

/// The script that judges the first claim by the rows.
pub(super) fn first(claim: u32) -> String {
    format!(
        "#!/bin/sh\n# Judges claim {claim} by the rows of this archive, and compares the verdict with the stated one.\nset -eu\n\
         cd \"$(dirname \"$0\")\"\n{}\n",
        judging(claim)
    )
}

/// The script that measures the rows of a claim again, if this program can.
pub(super) fn measure(answer: &Answer<'_>) -> Option<String> {
    let Again::Experiment(folder) = Again::of(answer) else { return None };
    Some(format!(
        "#!/bin/sh\n# Measures the rows of claim {} again and judges the claim by them. The argument is a folder for the new rows,\n\
         # from the folder of this script.\nset -eu\ncd \"$(dirname \"$0\")\"\nout=${{1:-../again}}\n\
         # Code 1 says that a ratio or an image differs; REPLICATION.md names it.\n{} || [ $? -eq 1 ]\n\
         {} \"$out\" {}\n",
        answer.claim.id,
        measuring(&folder, "\"$out\""),
        shell::command(["claims"]),
        ["--ledger", LEDGER, "--report", &answer.report.report].map(shell::quoted).join(" "),
    ))
}

/// The recipe of a container that builds the program of `machine`, which computed the verdicts, and judges the first claim.
/// `measured` are the commits of the rows.
pub(super) fn container(
    machine: &Machine,
    measured: &BTreeSet<String>,
    features: &BTreeSet<String>,
    can_measure: bool,
) -> String {
    let Machine { commit, rustc, dirty, .. } = machine;
    let is_known = commit != "unknown";
    let mut notes = Vec::new();
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
    let features = features.iter().map(String::as_str).collect::<Vec<&str>>().join(",");
    let features = if features.is_empty() { features } else { format!(" --features {features}") };
    format!(
        "# Builds Pathmark and judges the first claim by the rows of this folder:\n\
         #   podman build --tag artifact .\n#   podman run --rm artifact\n{again}{notes}\
         FROM docker.io/library/debian:13.8-slim\n\
         ARG REPOSITORY={}\nARG COMMIT={commit}\nARG RUST={rust}\n\
         RUN apt-get update \\\n && apt-get install --yes --no-install-recommends ca-certificates g++ git rustup \\\n \
         && rm -rf /var/lib/apt/lists/*\n\
         RUN rustup toolchain install \"$RUST\" --profile minimal && rustup default \"$RUST\"\n\
         RUN git clone \"$REPOSITORY\" /pathmark && git -C /pathmark checkout --detach \"$COMMIT\"\n\
         RUN cargo install --locked --path /pathmark --root /usr/local{features}\n\
         COPY . /artifact\nWORKDIR /artifact\nCMD [\"sh\", \"{FIRST}\"]\n",
        env!("CARGO_PKG_REPOSITORY")
    )
}
