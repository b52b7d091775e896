//! `README.md` of an artifact, in the form of the appendix that ACM and cTuning ask for.

use super::again::{Again, Costs};
use super::citation::Citation;
use super::metadata::METADATA;
use super::recipes::{judging, measuring};
use super::{CLAIMS, CONTAINER, FIRST, LEDGER, MEASURE, ROWS, VERDICTS};
use crate::claims::{Answer, totals};
use crate::experiment::RunFile;
use crate::measure::Machine;
use crate::words::counted;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

/// An experiment whose rows are in the archive.
pub(super) struct Experiment {
    /// Its folder in the archive.
    pub(super) folder: PathBuf,
    pub(super) title: String,
    /// Optional features that the program needs.
    pub(super) features: Vec<String>,
    pub(super) run: RunFile,
}

/// The facts that the appendix tells.
pub(super) struct Appendix<'a> {
    pub(super) citation: &'a Citation,
    pub(super) date: &'a str,
    pub(super) program: &'a [String; 2],
    /// The machine that made the archive.
    pub(super) here: &'a Machine,
    /// Their sources are paths in the archive.
    pub(super) answers: &'a [Answer<'a>],
    pub(super) first: &'a Answer<'a>,
    pub(super) can_measure: bool,
    pub(super) costs: &'a Costs,
    pub(super) experiments: &'a [Experiment],
    /// Scene files that the archive could not take.
    pub(super) left_out: &'a BTreeSet<PathBuf>,
    /// Seconds in which all claims were judged.
    pub(super) judge_s: f64,
    /// Bytes of the rows and pages.
    pub(super) bytes: u64,
}

fn megabytes(bytes: u64) -> String {
    format!("{:.1} MB", bytes as f64 / 1e6)
}

/// Texts, each once, in a line.
fn distinct(texts: impl Iterator<Item = String>) -> String {
    let all: BTreeSet<String> = texts.filter(|text| !text.is_empty()).collect();
    if all.is_empty() { "unknown".to_string() } else { all.into_iter().collect::<Vec<String>>().join("; ") }
}

impl Appendix<'_> {
    pub(super) fn text(&self) -> String {
        let Self { citation, date, .. } = self;
        let head = format!(
            "# {}\n\n{}, {date}. Licence: {}. `CITATION.cff` says how to cite this artifact, and `{METADATA}` lists its files \
             with their checksums.",
            citation.title,
            citation.names(),
            citation.license()
        );
        let parts = [head, self.about(), self.check_list(), self.description(), self.installation(), self.workflow()];
        let parts = parts.into_iter().chain([self.claims(), self.experiments()]);
        parts.collect::<Vec<String>>().join("\n\n") + "\n"
    }

    /// The abstract in a sentence, without heading.
    pub(super) fn summary(&self) -> String {
        let titles = distinct(self.answers.iter().map(|answer| answer.report.title.clone()));
        format!(
            "Measured rows of {}, a ledger of {} ({titles}), and the verdicts that the rows give: {}.",
            counted(self.experiments.len(), "experiment"),
            counted(self.answers.len(), "claim"),
            totals(self.answers)
        )
    }

    fn about(&self) -> String {
        format!(
            "## Abstract\n\n{} The program `{}` computes the verdicts again from the rows, and measures the rows again.",
            self.summary(),
            self.program[0]
        )
    }

    fn machines(&self, fact: impl Fn(&Machine) -> String) -> String {
        distinct(self.experiments.iter().map(|own| fact(&own.run.machine)))
    }

    fn check_list(&self) -> String {
        let (seconds, bytes) = self
            .costs
            .values()
            .flatten()
            .fold((0.0, 0), |(seconds, bytes), cost| (seconds + cost.plan.seconds(), bytes + cost.plan.bytes));
        let unknown = self.costs.values().filter(|cost| cost.is_err()).count();
        let unknown = if unknown == 0 {
            String::new()
        } else {
            format!(", without {} that cannot run there", counted(unknown, "experiment"))
        };
        let here = self.here.line();
        let lines = [
            ("Program", self.program.join(" ")),
            ("Compilation", self.machines(|machine| format!("{}, profile {}", machine.rustc, machine.profile))),
            ("Data set", format!("the rows in `{ROWS}/`, of {}", counted(self.experiments.len(), "experiment"))),
            ("Run-time environment", self.machines(|machine| machine.system.clone())),
            (
                "Hardware",
                self.machines(|machine| {
                    format!("{}, {:.1} GB of memory", machine.line(), machine.memory_bytes as f64 / 1e9)
                }),
            ),
            (
                "Metrics",
                "ratios, orders and slopes with intervals; seconds are not compared between machines".to_string(),
            ),
            ("Output", format!("a verdict on each claim, as in `{CLAIMS}` and `{VERDICTS}`")),
            ("Disk space", format!("{} here, and about {} for new rows", megabytes(self.bytes), megabytes(bytes))),
            ("Time to prepare", format!("one build of the program, by `cargo install` or by `{CONTAINER}`")),
            ("Time to judge all claims", format!("{:.1} s, measured on {here}", self.judge_s)),
            (
                "Time to measure all rows again",
                format!("about {seconds:.0} s, estimated by a pilot on {here}{unknown}"),
            ),
            ("Publicly available", env!("CARGO_PKG_REPOSITORY").to_string()),
            ("Licence of the program", env!("CARGO_PKG_LICENSE").to_string()),
            ("Licence of the data", self.citation.license()),
        ];
        let lines: Vec<String> = lines.iter().map(|(name, value)| format!("* **{name}:** {value}")).collect();
        format!("## Check-list\n\n{}", lines.join("\n"))
    }

    fn description(&self) -> String {
        let left_out: Vec<String> = self.left_out.iter().map(|path| format!("`{}`", path.display())).collect();
        let left_out = if left_out.is_empty() {
            String::new()
        } else {
            format!(" New measurements also need these scene files, which are not here: {}.", left_out.join(", "))
        };
        format!(
            "## Description\n\n`{ROWS}/` has a folder for each run, with a page, `report.html`. In it, each experiment has its rows \
             (`records.csv`), its machine (`machine.toml`) and its definition (`experiment.toml`). `{LEDGER}/` has the claims: \
             quotes, queries, predictions and their reasons.{left_out}\n\nThe verdicts need no special hardware or software besides \
             the program. New rows can only come from a machine with as many processors as the rows used."
        )
    }

    fn installation(&self) -> String {
        format!(
            "## Installation\n\nInstall `{}` as the repository says, or build the container: `podman build --tag artifact .`. \
             `{CONTAINER}` names the commit and the compiler.",
            self.program[0]
        )
    }

    fn workflow(&self) -> String {
        let measure = if self.can_measure {
            format!(
                "\n\nThis command measures the rows of the claim again, into a new folder, and judges the claim by them:\n\n\
                 ```sh\nsh {MEASURE} ../again\n```"
            )
        } else {
            String::new()
        };
        format!(
            "## First claim\n\nThis command judges claim {} by the rows. It also checks all files, and compares all \
             verdicts with the stated ones.\n\n```sh\nsh {FIRST}\n```{measure}",
            self.first.claim.id
        )
    }

    fn claims(&self) -> String {
        let (answered, others): (Vec<&Answer<'_>>, Vec<&Answer<'_>>) =
            self.answers.iter().partition(|answer| !answer.sources.is_empty());
        let mut text = "## Claims\n\nExpected results, and the resources of each claim.".to_string();
        for answer in answered {
            // Writing to a string cannot fail.
            let _ = write!(text, "\n\n{}", self.claim(answer));
        }
        if !others.is_empty() {
            let ids: Vec<String> = others.iter().map(|answer| answer.claim.id.to_string()).collect();
            let _ = write!(text, "\n\nNo rows here answer these claims: {}. `{VERDICTS}` says why.", ids.join(", "));
        }
        text
    }

    fn claim(&self, answer: &Answer<'_>) -> String {
        let claim = answer.claim;
        let again = match Again::of(answer) {
            Again::Experiment(folder) => {
                let cost = match self.costs.get(&folder) {
                    Some(Ok(cost)) => {
                        format!(
                            "; about {:.0} s and {} for the experiment",
                            cost.plan.seconds(),
                            megabytes(cost.plan.bytes)
                        )
                    }
                    Some(Err(why)) => format!("; costs are unknown: {why}"),
                    None => String::new(),
                };
                format!("`{}`{cost}", measuring(&folder, "../again"))
            }
            Again::HardCases => format!("`{} selftest --out ../again`", self.program[0]),
            Again::Not(why) => why,
        };
        let predicted = Some(answer.predicted()).filter(|predicted| predicted != "-");
        let predicted = predicted.map_or_else(String::new, |predicted| format!("; predicted: {predicted}"));
        format!(
            "### {}. {}\n\n* **Verdict:** {}\n* **Measured:** {}{predicted}\n* **Rows:** {}\n* **Judge:** `{}`\n\
             * **Measure again:** {again}",
            claim.id,
            claim.claim.trim(),
            answer.verdict,
            answer.measured(),
            answer.source().unwrap_or_default(),
            judging(claim.id)
        )
    }

    fn experiments(&self) -> String {
        let line = |own: &Experiment| {
            let RunFile { program, started_utc, machine, command, .. } = &own.run;
            let facts = [
                Some(program.clone()),
                Some(format!("commit {}{}", machine.commit, if machine.dirty { " with changes" } else { "" })),
                Some(machine.line()),
                Some(started_utc).filter(|started| !started.is_empty()).map(|started| format!("from {started}")),
            ];
            let facts: Vec<String> = facts.into_iter().flatten().filter(|fact| !fact.is_empty()).collect();
            format!("* `{}`: {}. {}; `{command}`", own.folder.display(), own.title, facts.join(", "))
        };
        let lines: Vec<String> = self.experiments.iter().map(line).collect();
        format!("## Experiments\n\n{}", lines.join("\n"))
    }
}
