//! `pathmark reproduce`: all committed experiments.

use super::overall_progress::OverallProgress;
use super::prelude::*;
use super::run::{Size, check_failures, note_doubts, rows, tell_left_out};
use super::selftest::{claim_cases, claim_guards, has_prices, price_guards, try_cases, write_cases, write_guards};
use super::{bursts, doctor, replicate, strict::Strict};
use crate::cases_file;
use crate::check::{self, Case, Effort};
use crate::command_line;
use crate::console::output::lock_folder;
use crate::experiment::{
    DOCTOR, Definition, Examination, Options, Plan, Power, Prices, Profile, REPLICATION, RecordsFile, Replication,
    Summary, Sweep, Timeout,
};
use crate::guard_prices::FOLDER;
use crate::lock::Sharing;
use crate::measure::{LeftOut, TimingConcerns, utc_now};
use crate::report::{self, claims};

/// `pathmark reproduce --reports --out results-here`
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    size: Size,
    /// Output folder; results of an earlier run move into its folder `earlier`
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Resume a run that was stopped
    #[arg(long)]
    resume: bool,
    /// Print rows, estimated seconds and bytes of each experiment, and run none but a short pilot
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
    files.renews("out", &arguments.out.join(DOCTOR), |path| Examination::read(path).is_ok())?;
    let _lock = lock_folder(&arguments.out, Sharing::Alone)?;
    if !arguments.resume {
        put_aside(&arguments.out, lab, console)?;
    }
    if !has_prices(&arguments.out) {
        claim_guards(&arguments.out, &mut files)?;
    }
    // The cases take longer than a sixth of all quick experiments, so the quick profile leaves them to `selftest --out`.
    let tries_cases = profile != Profile::Quick && !cases_file::is_in(&arguments.out);
    if tries_cases {
        claim_cases(&arguments.out, &mut files)?;
    }
    // Bursts take more than half a minute, so the quick profile leaves them to `bursts --out`.
    let runs_bursts = profile != Profile::Quick && !report::bursts::are_in(&arguments.out);
    if runs_bursts {
        bursts::claim(&arguments.out.join(report::bursts::FOLDER), &mut files)?;
    }
    doctor::examine_into(&arguments.out, console)?;
    let Total { rows, failed, timed_out, invalid, left_out, doubts } = run_all(&sweeps, profile, lab, console)?;
    if tries_cases {
        let all: Vec<&'static Case> = check::cases().collect();
        write_cases(&arguments.out, lab, &all, &try_cases(&all, Effort::Quick, console)?)?;
    }
    if !has_prices(&arguments.out) {
        write_guards(&arguments.out, lab, &price_guards(console))?;
    }
    if runs_bursts {
        bursts::measure_into(&arguments.out, lab, console)?;
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
    let examination = Some(DOCTOR).filter(|name| Examination::read(&out.join(name)).is_ok());
    let is_replication = Replication::read(&out.join(REPLICATION)).is_ok();
    let replication = [REPLICATION, replicate::TEXT, replicate::AGAIN].into_iter().filter(|_| is_replication);
    let others = [FOLDER, report::bursts::FOLDER, cases_file::FOLDER, claims::FOLDER]
        .into_iter()
        .chain(verdicts)
        .chain(examination)
        .chain(replication);
    for name in names.into_iter().chain(others) {
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

/// The plans of all sweeps: the table of `--plan`, and a line before a long run.
struct Plans {
    each: Vec<Plan>,
    kinds: usize,
    guessed: usize,
}

impl Plans {
    /// Renders the pilot and plans all sweeps.
    fn new(lab: &Lab, sweeps: &[Sweep<'_>]) -> Result<Self> {
        let mut prices = Prices::new(lab);
        let each = sweeps.iter().map(|sweep| sweep.plan(&mut prices)).collect::<Result<Vec<_>>>()?;
        Ok(Self { each, kinds: prices.kinds(), guessed: prices.guessed })
    }

    fn sum(&self) -> Plan {
        self.each.iter().fold(Plan::default(), |sum, plan| Plan {
            name: "all".to_string(),
            cells: sum.cells + plan.cells,
            rows: sum.rows + plan.rows,
            references_s: sum.references_s + plan.references_s,
            halves: sum.halves + plan.halves,
            cells_s: sum.cells_s + plan.cells_s,
            bytes: sum.bytes + plan.bytes,
        })
    }

    /// The sum of all plans, in a line.
    fn told(&self) -> String {
        let all = self.sum();
        let (minutes, megabytes) = ((all.seconds() / 60.0).ceil(), megabytes(&all));
        format!(
            "about {minutes:.0} min for {} rows of {} experiments and {megabytes:.0} MB, estimated by a pilot of {} renders; existing rows take no time",
            all.rows,
            self.each.len(),
            self.kinds - self.guessed
        )
    }

    /// Prints the table of all experiments, and how its seconds were estimated.
    fn print(&self, left_out: usize) -> Result<()> {
        let width = self.each.iter().map(|plan| plan.name.len()).max().unwrap_or(0).max(10);
        let head = format!("{:width$}  {:>6}  {:>6}  {:>8}  {:>8}", "experiment", "cells", "rows", "seconds", "MB");
        let row = |plan: &Plan| {
            let (seconds, megabytes) = (plan.seconds(), megabytes(plan));
            format!("{:width$}  {:>6}  {:>6}  {seconds:>8.0}  {megabytes:>8.1}", plan.name, plan.cells, plan.rows)
        };
        print(&head)?;
        let sum = Some(self.sum()).filter(|_| self.each.len() > 1);
        for plan in self.each.iter().chain(&sum) {
            print(&row(plan))?;
        }
        let pilot = self.kinds - self.guessed;
        print(&format!(
            "Seconds are an estimate: {pilot} small renders on one thread gave the time of a sample, and a cell's samples are divided by the processors \
             that its threads can use. The cost of schedules, locks and other programs is not included; MB exclude figures."
        ))?;
        if self.guessed > 0 {
            print(&format!(
                "{} kinds of images were not rendered; the estimate uses the mean of the others.",
                self.guessed
            ))?;
        }
        if left_out > 0 {
            print(&format!("{left_out} experiments do not have this profile."))?;
        }
        Ok(())
    }
}

/// Prints the plan of some sweeps.
pub(super) fn print_plans(lab: &Lab, sweeps: &[Sweep<'_>]) -> Result<()> {
    Plans::new(lab, sweeps)?.print(0)
}

/// Prints the plan of one experiment, and what pairs of its comparisons reach.
pub(super) fn print_with_power(lab: &Lab, sweep: &Sweep<'_>) -> Result<()> {
    Plans::new(lab, std::slice::from_ref(sweep))?.print(0)?;
    for Power { with, comparisons, round_s, plans } in sweep.power()? {
        print(&format!("\n{comparisons} comparisons with {with}; a round of all its cells takes {round_s:.2} s"))?;
        print(&format!("{:>9}  {:>9}  {:>7}  {:>8}", "precision", "processes", "pairs", "seconds"))?;
        for (share, plan) in plans {
            let goal = format!("±{:.0} %", 100.0 * share);
            print(&match plan {
                Some(plan) => {
                    format!("{goal:>9}  {:>9}  {:>7}  {:>8.0}", plan.processes, plan.pairs, plan.seconds)
                }
                None => format!("{goal:>9}  not within {} processes", 1 << 12),
            })?;
        }
    }
    Ok(())
}

fn megabytes(plan: &Plan) -> f64 {
    plan.bytes as f64 / 1e6
}
