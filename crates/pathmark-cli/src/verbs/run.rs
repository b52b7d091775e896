//! `pathmark run EXPERIMENT`: one experiment, and its report.

use super::prelude::*;
use super::reproduce::print_with_power;
use super::strict::Strict;
use crate::command_line;
use crate::console::output::lock_folder;
use crate::experiment::{
    Definition, LARGEST_REPETITIONS, Options, Profile, StoppingRule, Sweep, SweepShard, Timeout, baseline_folder,
};
use crate::lock::Sharing;
use crate::measure::{LeftOut, TimingConcerns};
use crate::report::{self, check_figures, figure_of_serial};
use crate::shell;

/// `pathmark run thread-scaling --filter strategy=rayon --set scene=my/room.toml`
#[derive(Args)]
pub(crate) struct Arguments {
    /// An experiment of `pathmark list experiments`, or the path of a .toml file
    experiment: String,
    /// Folder of the output: rows and figures in DIR/EXPERIMENT, the page in DIR/report.html
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Resume a sweep that was stopped
    #[arg(long)]
    resume: bool,
    /// Print the number of rows, the estimated seconds and bytes, and the processes and pairs that each comparison needs for a
    /// precision of 3, 2 and 1 %. Runs only a short pilot
    #[arg(long, conflicts_with = "resume")]
    plan: bool,
    /// Also count the instructions of each cell with valgrind, which takes about fifty times as long as a repetition;
    /// `pathmark diff --counts` compares them
    #[arg(long)]
    count_instructions: bool,
    /// Repetitions of each cell, a combination of values [default: set by the experiment]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(LARGEST_REPETITIONS)))]
    repetitions: Option<u32>,
    /// Replace the values of an axis, as in scene=my/room.toml or threads=1,2,4,8; may be given several times
    #[arg(long = "set", value_name = "AXIS=VALUES")]
    values: Vec<String>,
    /// Run only cells with one of these values, as in strategy=rayon or threads=1,2; may be given several times. Serial
    /// runs that a figure compares with are kept
    #[arg(long = "filter", value_name = "AXIS=VALUES")]
    filters: Vec<String>,
    /// Run one of N parts of the cells, as in 2/4, with the serial runs that they are compared with; `pathmark merge`
    /// merges the folders
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    shard: Option<String>,
    /// Another build of this program; both builds run every repetition of every cell in turns, and `pathmark diff` compares
    /// them
    #[arg(long, alias = "against", value_name = "PROGRAM", conflicts_with_all = ["resume", "shard"])]
    baseline: Option<PathBuf>,
    /// Repeat each cell until its speedup (or its time, without serial runs) is known to within this share, as in 3%. With
    /// --baseline: until each cell is known to be slower by more than this share, faster, or the same. `fastest` stops
    /// repeating a schedule once another schedule of the same image is faster, `order` once it can be told apart from all
    /// others. At most 200 repetitions, or those of --repetitions; the intervals account for early stops
    #[arg(long, value_name = "SHARE|fastest|order", allow_hyphen_values = true)]
    until: Option<String>,
    /// With --until: start no repetition after this time, as in 60s
    #[arg(long, alias = "within", value_name = "TIME", requires = "until")]
    max_time: Option<String>,
    /// Time limit of each cell's process, as in 10min, or none. A cell that reaches it is ended, and its rows fail
    /// [default: the experiment's, or ten times the estimated time, at least a minute]
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    timeout: Option<String>,
    #[command(flatten)]
    size: Size,
    #[command(flatten)]
    strict: Strict,
}

/// The size at which an experiment is run; at most one of the options is given.
#[derive(Args)]
#[group(multiple = false)]
pub(super) struct Size {
    /// Small images (the default): all experiments together take about five minutes
    #[arg(long)]
    quick: bool,
    /// Larger images: minutes to hours for an experiment
    #[arg(long)]
    full: bool,
    /// The sizes and parameters of the four reports: all experiments together take more than an hour
    #[arg(long)]
    reports: bool,
}

impl Size {
    pub(super) fn profile(&self) -> Profile {
        match (self.full, self.reports) {
            (true, _) => Profile::Full,
            (_, true) => Profile::Reports,
            _ => Profile::Quick,
        }
    }
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let definition = Definition::load(lab, &arguments.experiment)?.with_values(&arguments.values)?;
    check_figures(&definition)?;
    let kept: Vec<&str> = definition.kept_sizes(arguments.size.profile()).into_iter().collect();
    if !kept.is_empty() {
        console.note(&format!(
            "matrices with a size of their own keep it: {}; --set size=WxH replaces it",
            kept.join(", ")
        ));
    }
    let options = Options {
        out: arguments.out.clone(),
        profile: arguments.size.profile(),
        resume: arguments.resume,
        repetitions: arguments.repetitions,
        filters: arguments.filters.clone(),
        baseline: arguments.baseline.clone(),
        shard: arguments.shard.as_deref().map(SweepShard::parse).transpose()?,
        serial_for: figure_of_serial(&definition),
        until: arguments
            .until
            .as_deref()
            .map(|limit| StoppingRule::parse(limit, arguments.max_time.as_deref()))
            .transpose()?,
        timeout: arguments.timeout.as_deref().map(Timeout::parse).transpose()?,
        count_instructions: arguments.count_instructions,
        command: command_line(),
    };
    let mut files = Files::default();
    let sweep = Sweep::new(&definition, &options, &mut files)?;
    if arguments.plan {
        return print_with_power(lab, &sweep);
    }
    report::claim("out", &arguments.out, &mut files)?;
    // Other experiments may run in the same folder, each in its own subfolder; `reproduce` may not.
    let _lock = lock_folder(&arguments.out, Sharing::Shared)?;
    let summary = sweep.run(console)?;
    let page = report::write(lab, &arguments.out);
    note_doubts(&summary.doubts, console);
    tell_left_out(&summary.left_out, console);
    // Failed rows are reported before a page that could not be written.
    check_failures(summary.rows + summary.other_rows, summary.failed, summary.timed_out)?;
    arguments.strict.check(summary.invalid)?;
    if arguments.baseline.is_some() {
        let old = baseline_folder(&arguments.out, &definition.name);
        let [old, new] = [&old, &summary.folder].map(|folder| folder.display().to_string());
        console.note(&format!("{} compares the two builds", shell::command(["diff", &old, &new])));
    }
    print(&format!(
        "{} in {}, report in {}",
        rows(summary.rows, &summary.left_out),
        summary.folder.display(),
        page?.display()
    ))
}

/// The number of rows in words, with those that were left out.
pub(super) fn rows(count: usize, left_out: &LeftOut) -> String {
    match left_out.count() {
        0 => format!("{count} rows"),
        left => format!("{count} rows ({left} left out)"),
    }
}

/// Names the rows that were not run, if there are any.
pub(super) fn tell_left_out(left_out: &LeftOut, console: &Console) {
    if left_out.count() > 0 {
        console.note(&left_out.to_string());
    }
}

/// Refuses a sweep in which rows have failed.
pub(super) fn check_failures(rows: usize, failed: usize, timed_out: usize) -> Result<()> {
    if failed == 0 {
        return Ok(());
    }
    let at_limit = if timed_out == 0 { String::new() } else { format!(", {timed_out} of them at their time limit") };
    Err(Error::Check(format!("{failed} of {rows} rows failed{at_limit}; their column `error` says why")))
}

/// Says how many rows have times in doubt, if there are any.
pub(super) fn note_doubts(doubts: &TimingConcerns, console: &Console) {
    if doubts.is_any() {
        console.note(&format!("{doubts}; `pathmark list warnings` explains each"));
    }
}
