//! `pathmark reproduce`: all committed experiments.

use super::overall_progress::OverallProgress;
use super::plan::Plans;
use super::run::{check_failures, note_doubts, rows, tell_left_out};
use super::{cases, guards, profile, strict::Strict};
use crate::cases_file;
use crate::check::{self, Case, Effort};
use crate::command_line;
use crate::console::Console;
use crate::console::output::{lock_folder, print};
use crate::error::{Error, Result};
use crate::experiment::{Definition, Options, Profile, Progress, RecordsFile, Summary, Sweep, Timeout};
use crate::files::Files;
use crate::guard_prices::FOLDER;
use crate::lab::Lab;
use crate::lock::Sharing;
use crate::measure::{LeftOut, TimingConcerns, utc_now};
use crate::report::{self, claims};
use clap::Args;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// `pathmark reproduce --reports --out results-here`
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    size: profile::Choice,
    /// Output folder; results of an earlier run move into its folder `earlier`
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Resume a run that was stopped
    #[arg(long)]
    resume: bool,
    /// Print rows, estimated seconds and bytes of each experiment, and run none
    #[arg(long)]
    plan: bool,
    /// Time limit of each cell's process, as in 10min, or none [default: the experiment's, or ten times the estimated
    /// time, at least a minute]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    timeout: Option<String>,
    #[command(flatten)]
    strict: Strict,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let profile = arguments.size.profile();
    let options = Options {
        out: arguments.out.clone(),
        profile,
        resume: arguments.resume,
        timeout: arguments.timeout.as_deref().map(Timeout::parse).transpose()?,
        command: command_line(),
        ..Options::default()
    };
    let mut definitions =
        Definition::known(lab).map(|(name, _)| Definition::load(lab, name)).collect::<Result<Vec<_>>>()?;
    let known = definitions.len();
    definitions.retain(|definition| definition.has(profile));
    let left_out = known - definitions.len();
    definitions.retain(|definition| match definition.missing_feature() {
        None => true,
        Some((_, takes)) => {
            console.note(&format!("{} is left out: it needs {takes}", definition.name));
            false
        }
    });
    let mut files = Files::default();
    let sweeps = definitions.iter().map(|definition| Sweep::new(definition, &options, &mut files));
    let sweeps = sweeps.collect::<Result<Vec<_>>>()?;
    if arguments.plan {
        return Plans::new(lab, &sweeps)?.print(left_out);
    }
    report::claim("out", &arguments.out, &mut files)?;
    let _lock = lock_folder(&arguments.out, Sharing::Alone)?;
    if !arguments.resume {
        put_aside(&arguments.out, lab, console)?;
    }
    if !guards::are_in(&arguments.out) {
        guards::claim(&arguments.out, &mut files)?;
    }
    let Total { rows, failed, timed_out, invalid, left_out, doubts } = run_all(&sweeps, profile, lab, console)?;
    // The cases take longer than a sixth of all quick experiments, so the quick profile leaves them to `selftest --out`.
    if profile != Profile::Quick && !cases_file::is_in(&arguments.out) {
        let all: Vec<&'static Case> = check::cases().collect();
        cases::write(&arguments.out, &all, &cases::try_all(&all, Effort::Quick, console)?)?;
    }
    if !guards::are_in(&arguments.out) {
        guards::write(&arguments.out, lab, &guards::measure(console))?;
    }
    let page = report::write(lab, &arguments.out)?;
    note_doubts(&doubts, console);
    tell_left_out(&left_out, console);
    let told = self::rows(rows, &left_out);
    print(&format!("{told} from {} experiments, report in {}", definitions.len(), page.display()))?;
    check_failures(rows, failed, timed_out)?;
    arguments.strict.check(invalid)
}

/// The outcome of all sweeps.
#[derive(Default)]
struct Total {
    rows: usize,
    failed: usize,
    timed_out: usize,
    invalid: u64,
    left_out: LeftOut,
    doubts: TimingConcerns,
}

/// Runs all sweeps. Quick sweeps end before an estimate would be useful; for the others, the time left is of all
/// sweeps.
fn run_all(sweeps: &[Sweep<'_>], profile: Profile, lab: &Lab, console: &Console) -> Result<Total> {
    let mut total = Total::default();
    let mut add = |summary: &Summary| {
        total.rows += summary.rows;
        total.failed += summary.failed;
        total.timed_out += summary.timed_out;
        total.invalid += summary.invalid;
        total.left_out.merge(&summary.left_out);
        total.doubts.merge(&summary.doubts);
    };
    if profile == Profile::Quick {
        for sweep in sweeps {
            add(&sweep.run(console)?);
        }
        return Ok(total);
    }
    let plans = Plans::new(lab, sweeps)?;
    console.note(&plans.told());
    let whole = OverallProgress::new(console, &plans.each);
    for (sweep, plan) in sweeps.iter().zip(&plans.each) {
        whole.enter(plan);
        add(&sweep.run(&whole)?);
    }
    Ok(total)
}

/// Moves the results of an earlier run away, whatever its experiments and profile: measurements are never overwritten,
/// and a report is of one run.
fn put_aside(out: &Path, lab: &Lab, console: &Console) -> Result<()> {
    let names: Vec<&str> = Definition::known(lab).map(|(name, _)| name).collect();
    // All are checked before any is moved: a running sweep may hold the lock of one of them.
    for rows in names.iter().map(|name| out.join(name).join("records.csv")) {
        if rows.is_file() {
            RecordsFile::check_idle(&rows)?;
        }
    }
    let stamp = utc_now().replace(':', "-");
    if stamp.is_empty() {
        let problem = std::io::Error::other(
            "its date is not within 1970 to 9999, and the folder for earlier results is named after it",
        );
        return Err(Error::system("reading", "the system's clock", problem));
    }
    let earlier = out.join("earlier").join(stamp);
    // Verdicts are of the rows beside them.
    let verdicts = Some(claims::MARKDOWN).filter(|name| claims::is_markdown(&out.join(name)));
    for name in names.into_iter().chain([FOLDER, cases_file::FOLDER, claims::FOLDER]).chain(verdicts) {
        let folder = out.join(name);
        if folder.exists() {
            std::fs::create_dir_all(&earlier).map_err(|e| Error::system("creating", &earlier, e))?;
            let target = earlier.join(name);
            std::fs::rename(&folder, &target).map_err(|e| Error::system("moving", &folder, e))?;
            console.note(&format!("moved {} to {}", folder.display(), target.display()));
        }
    }
    Ok(())
}
