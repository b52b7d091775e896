//! `README.md` of an artifact, in the form of the appendix that ACM and cTuning ask for.

use super::again::{Costs, folder_of};
use super::citation::Citation;
use super::metadata::METADATA;
use super::recipes::{Program, installing};
use super::{CLAIMS, CONTAINER, FIRST, LEDGER, MEASURE, ROWS, VERDICTS};
use crate::claims::{Answer, Needs, PlainRows, totals};
use crate::experiment::RunFile;
use crate::measure::Machine;
use crate::words::{bytes, counted, seconds};
use std::collections::{BTreeMap, BTreeSet};
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
    pub(super) program: &'a Program,
    /// Optional features that the program needs for new rows.
    pub(super) features: &'a BTreeSet<String>,
    /// The machine that made the archive.
    pub(super) here: &'a Machine,
    /// Their sources are paths in the archive.
    pub(super) answers: &'a [Answer<'a>],
    pub(super) tables: &'a BTreeMap<PathBuf, &'a PlainRows>,
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

/// Results of experiments that another machine can check.
const METRICS: &str = "ratios, orders and slopes with intervals; seconds are not compared between machines";

/// The tables of other programs that answer claims, by the paths of their rows.
pub(super) fn tables<'a>(answers: &[Answer<'a>]) -> BTreeMap<PathBuf, &'a PlainRows> {
    let of = |answer: &Answer<'a>| match answer.report.needs(answer.claim) {
        Needs::Table(table) => answer.sources.iter().map(|source| (source.clone(), table)).collect(),
        _ => Vec::new(),
    };
    answers.iter().flat_map(of).collect()
}

/// Rows by what measured them.
pub(super) fn rows_in_words(experiments: usize, tables: usize) -> String {
    let of_tables = match tables {
        0 => None,
        1 => Some("1 table of another program".to_string()),
        several => Some(format!("{several} tables of other programs")),
    };
    let experiments = (experiments > 0).then(|| counted(experiments, "experiment"));
    let parts: Vec<String> = experiments.into_iter().chain(of_tables).collect();
    if parts.is_empty() { "rows of hard cases".to_string() } else { format!("rows of {}", parts.join(" and ")) }
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
        let parts = parts.into_iter().chain([self.claims(), self.experiments(), self.others()]);
        parts.filter(|part| !part.is_empty()).collect::<Vec<String>>().join("\n\n") + "\n"
    }

    /// The abstract in a sentence, without heading.
    pub(super) fn summary(&self) -> String {
        let titles = distinct(self.answers.iter().map(|answer| answer.report.title.clone()));
        format!(
            "Measured {}, a ledger of {} ({titles}), and the verdicts that the rows give: {}.",
            self.rows(),
            counted(self.answers.len(), "claim"),
            totals(self.answers)
        )
    }

    fn rows(&self) -> String {
        rows_in_words(self.experiments.len(), self.tables.len())
    }

    fn about(&self) -> String {
        let measures = match (self.experiments.is_empty(), self.tables.is_empty()) {
            (true, _) => "",
            (false, true) => ", and measures the rows again",
            (false, false) => ", and measures those of experiments again",
        };
        format!(
            "## Abstract\n\n{} The program `{}` computes the verdicts again from the rows{measures}.",
            self.summary(),
            self.program.command
        )
    }

    fn machines(&self, fact: impl Fn(&Machine) -> String) -> String {
        distinct(self.experiments.iter().map(|own| fact(&own.run.machine)))
    }

    fn check_list(&self) -> String {
        let has_experiments = !self.experiments.is_empty();
        let compiled = self.machines(|machine| format!("{}, profile {}", machine.rustc, machine.profile));
        let system = self.machines(|machine| machine.system.clone());
        let lines = [
            ("Program", Some(format!("{} {}", self.program.name, self.program.version))),
            ("Compilation", Some(compiled).filter(|_| has_experiments)),
            ("Data set", Some(format!("the {}, in `{ROWS}/`", self.rows()))),
            ("Run-time environment", Some(system).filter(|_| has_experiments)),
            ("Hardware", Some(self.hardware())),
            ("Metrics", Some(METRICS.to_string()).filter(|_| has_experiments)),
            ("Output", Some(format!("a verdict on each claim, as in `{CLAIMS}` and `{VERDICTS}`"))),
            ("Disk space", Some(format!("{} here{}", bytes(self.bytes), self.new_bytes()))),
            ("Time to prepare", Some("not measured; it is one build of the program".to_string())),
            ("Time to judge all claims", Some(format!("{}, measured on {}", seconds(self.judge_s), self.here.line()))),
            ("Time to measure all rows again", Some(self.new_seconds())),
            (
                "Program publicly available",
                Some(self.program.address.unwrap_or("at no address that is known here").to_string()),
            ),
            ("Licence of Pathmark", Some(env!("CARGO_PKG_LICENSE").to_string())),
            ("Licence of the data", Some(self.citation.license())),
        ];
        let lines = lines.iter().filter_map(|(name, value)| Some(format!("* **{name}:** {}", value.as_ref()?)));
        format!("## Check-list\n\n{}", lines.collect::<Vec<String>>().join("\n"))
    }

    /// The machines of the rows; those of tables as the ledger tells them.
    fn hardware(&self) -> String {
        let of =
            |machine: &Machine| format!("{}, {:.1} GB of memory", machine.line(), machine.memory_bytes as f64 / 1e9);
        let own = self.experiments.iter().map(|own| of(&own.run.machine));
        let others = self.tables.values().filter_map(|table| table.machine.clone());
        distinct(own.chain(others))
    }

    /// Bytes of new rows, where they are known.
    fn new_bytes(&self) -> String {
        let own = self.costs.values().flatten().map(|cost| cost.plan.bytes);
        let others = self.tables.values().filter_map(|table| table.bytes);
        let known: Vec<u64> = own.chain(others).collect();
        if known.is_empty() { String::new() } else { format!(", and about {} for new rows", bytes(known.iter().sum())) }
    }

    /// Seconds of new rows, and where they come from.
    fn new_seconds(&self) -> String {
        let here = self.here.line();
        let own: Vec<f64> = self.costs.values().flatten().map(|cost| cost.plan.seconds()).collect();
        let failed = self.costs.len() - own.len();
        let others: Vec<f64> = self.tables.values().filter_map(|table| table.seconds).collect();
        let untold = self.tables.len() - others.len();
        let parts = [
            (!own.is_empty()).then(|| format!("{}, estimated by a pilot on {here}", seconds(own.iter().sum()))),
            (failed > 0).then(|| format!("unknown for {} that cannot run there", counted(failed, "experiment"))),
            (!others.is_empty())
                .then(|| format!("{} for rows of other programs, as the ledger tells", seconds(others.iter().sum()))),
            (untold > 0).then(|| format!("unknown for {} of other programs", counted(untold, "table"))),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        if parts.is_empty() { "unknown".to_string() } else { parts.join("; ") }
    }

    fn description(&self) -> String {
        let left_out: Vec<String> = self.left_out.iter().map(|path| format!("`{}`", path.display())).collect();
        let left_out = if left_out.is_empty() {
            String::new()
        } else {
            format!(" New measurements also need these scene files, which are not here: {}.", left_out.join(", "))
        };
        let has_experiments = !self.experiments.is_empty();
        let (own, new) = if has_experiments {
            (
                " Each has a page, `report.html`, and for each experiment its rows (`records.csv`), its machine \
                 (`machine.toml`) and its definition (`experiment.toml`).",
                " New rows of an experiment can only come from a machine with as many processors as the rows used.",
            )
        } else {
            ("", "")
        };
        let others = if self.tables.is_empty() { "" } else { " Rows of other programs are there, too." };
        format!(
            "## Description\n\n`{ROWS}/` has a folder for each run.{own}{others} `{LEDGER}/` has the claims: quotes, queries, \
             predictions and their reasons.{left_out}\n\nThe verdicts need no special hardware or software besides the program.{new}"
        )
    }

    fn installation(&self) -> String {
        let Program { name, command, address, .. } = self.program;
        let commit = Some(&self.here.commit).filter(|commit| *commit != "unknown");
        let commit = commit.map_or_else(String::new, |commit| format!(", commit {commit},"));
        let from = address.map_or_else(String::new, |address| format!(" (<{address}>)"));
        let where_from = if address.is_some() {
            ""
        } else {
            " ADDRESS is that of the sources, which the authors give: none is known here."
        };
        format!(
            "## Installation\n\nInstall {name} from its sources{from}{commit} by `{}`. The scripts call it `{command}`.\n\n\
             Or build the container by `{}`: `{CONTAINER}` names the commit and the compiler. It has not been built as a whole.{where_from}",
            installing(".", self.features),
            self.program.building()
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
        let again = match (answer.report.needs(answer.claim), folder_of(answer)) {
            (_, Some(folder)) => {
                let cost = match self.costs.get(folder) {
                    Some(Ok(cost)) => {
                        let (seconds, bytes) = (seconds(cost.plan.seconds()), bytes(cost.plan.bytes));
                        format!("; {seconds} and {bytes} for the experiment")
                    }
                    Some(Err(why)) => format!("; costs are unknown: {why}"),
                    None => String::new(),
                };
                format!("`{}`{cost}", self.program.measuring(folder, "../again"))
            }
            (Needs::Experiment(name), None) => format!("there are no rows of {name}"),
            (Needs::HardCases, _) => format!("`{} selftest --out ../again`", self.program.command),
            (Needs::Table(table), _) => of_table(table),
            (Needs::Nothing(why), _) => why,
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
            self.program.judging(claim.id)
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
        if lines.is_empty() { String::new() } else { format!("## Experiments\n\n{}", lines.join("\n")) }
    }

    /// The rows of other programs.
    fn others(&self) -> String {
        let line = |(path, table): (&PathBuf, &&PlainRows)| format!("* `{}`: {}", path.display(), of_table(table));
        let lines: Vec<String> = self.tables.iter().map(line).collect();
        if lines.is_empty() { String::new() } else { format!("## Rows of other programs\n\n{}", lines.join("\n")) }
    }
}

/// How another program measures rows, as the ledger tells it.
fn of_table(table: &PlainRows) -> String {
    let (file, costs) = (&table.file, table.costs());
    let command = match &table.command {
        Some(command) => format!("`{command}` writes `{file}`"),
        None => format!("another program wrote `{file}`; the ledger names no command"),
    };
    if costs.is_empty() { command } else { format!("{command}; {costs}, as the ledger tells") }
}
