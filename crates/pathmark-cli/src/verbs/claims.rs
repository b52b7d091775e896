//! `pathmark claims`: the claims of the four reports beside the measurements.

use super::prelude::*;
use crate::report::claims::{self, Answer, Report, judge};

/// `pathmark claims out --report A`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Folders that `reproduce` or `run` wrote. If several answer a claim, the first one with the report's conditions counts
    #[arg(default_value = "out", value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Also write all verdicts into this folder, as CLAIMS.md and claims/claims.csv. Files that answer more claims are kept
    #[arg(long, value_name = "DIR", conflicts_with = "report")]
    out: Option<PathBuf>,
    /// Print only the claims of this report
    #[arg(long, value_name = "LETTER")]
    report: Option<String>,
    /// Print an array of objects
    #[arg(long)]
    json: bool,
    /// Exit with code 1 if a verdict differs from the expected one
    #[arg(long)]
    strict: bool,
}

/// A verdict for other programs.
#[derive(Serialize)]
struct Row<'a> {
    claim: u32,
    report: &'a str,
    says: &'a str,
    verdict: &'static str,
    expected: &'a str,
    measured: String,
    predicted: String,
    why: &'a str,
    source: Option<&'a PathBuf>,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>) -> Result<()> {
    let mut reports = Report::all()?;
    if let Some(letter) = &arguments.report {
        let known: Vec<String> = reports.iter().map(|report| report.report.clone()).collect();
        reports.retain(|report| report.report == *letter);
        if reports.is_empty() {
            return Err(InputError::new("report", letter, "there is no such report").allowed(known.join(", ")).into());
        }
    }
    for folder in &arguments.folders {
        if !folder.is_dir() {
            return Err(InputError::new("folder", folder.display().to_string(), "there is no such folder").into());
        }
    }
    if let Some(out) = &arguments.out {
        claims::enter("out", out, &mut Files::default())?;
    }
    let answers = judge(lab, &reports, &arguments.folders)?;
    if let Some(out) = &arguments.out {
        claims::check_no_loss("out", &answers, out)?;
        create_folder("out", out)?;
        claims::save(&answers, out)?;
    }
    if arguments.json {
        print_json(&answers.iter().map(row).collect::<Vec<_>>())?;
    } else {
        print(&answers.iter().map(line).collect::<Vec<String>>().join("\n"))?;
        print(&format!("\n{} claims: {}", answers.len(), claims::totals(&answers)))?;
    }
    let unexpected: Vec<String> =
        answers.iter().filter(|a| a.is_unexpected()).map(|a| a.claim.id.to_string()).collect();
    if arguments.strict && !unexpected.is_empty() {
        return Err(Error::Check(format!("claims {} have unexpected verdicts", unexpected.join(", "))));
    }
    Ok(())
}

fn row<'a>(answer: &'a Answer<'_>) -> Row<'a> {
    Row {
        claim: answer.claim.id,
        report: &answer.report.report,
        says: &answer.claim.claim,
        verdict: answer.verdict.name(),
        expected: &answer.claim.expected,
        measured: answer.measured(),
        predicted: answer.predicted(),
        why: &answer.why,
        source: answer.source.as_ref(),
    }
}

fn line(answer: &Answer<'_>) -> String {
    let claim = answer.claim;
    let numbers = match answer.source {
        Some(_) => format!("\n        {}, predicted {}", answer.measured(), answer.predicted()),
        None => String::new(),
    };
    let why = if answer.why.is_empty() { String::new() } else { format!("\n        {}", answer.why) };
    format!("{:>3} {}  {:15} {}{numbers}{why}", claim.id, answer.report.report, answer.verdict.to_string(), claim.claim)
}
