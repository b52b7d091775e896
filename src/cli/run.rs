//! `pathmark run EXPERIMENT`: one experiment, and its report.

use super::output::{lock_folder, print};
use super::progress::Talk;
use super::{command_line, profile, strict::Strict};
use crate::error::{Error, Result};
use crate::experiment::{Definition, Options, Progress, Sweep, SweepShard, Until, folder_against};
use crate::files::Files;
use crate::lab::Lab;
use crate::lock::Sharing;
use crate::measure::Doubts;
use crate::report::{self, check_figures, figure_of_serial};
use clap::Args;
use std::path::PathBuf;
use std::sync::Arc;

/// `pathmark run thread-scaling --filter strategy=rayon --set scene=my/room.toml`
#[derive(Args)]
pub(super) struct Arguments {
    /// An experiment of `pathmark list experiments`, or the path of a .toml file
    experiment: String,
    /// Folder for what comes out
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Go on with a sweep that was stopped
    #[arg(long)]
    resume: bool,
    /// After all repetitions run those cells again of which rows are doubtful, once for each; keep both
    #[arg(long)]
    rerun_doubtful: bool,
    /// Count the instructions of each cell besides, by valgrind, which takes some fifty times as long as a repetition;
    /// `pathmark diff --counts` compares them
    #[arg(long)]
    count_instructions: bool,
    /// How often each cell is run [default: what the experiment says]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    repetitions: Option<u32>,
    /// Other values of an axis, as in scene=my/room.toml or threads=1,2,4,8; may be given several times
    #[arg(long = "set", value_name = "AXIS=VALUES")]
    values: Vec<String>,
    /// Only cells with one of these values, as in strategy=rayon or threads=1,2; may be given several times. Serial runs
    /// that a figure compares with stay in
    #[arg(long = "filter", value_name = "AXIS=VALUES")]
    filters: Vec<String>,
    /// Run one of N parts of the cells, as in 2/4, with the serial runs that they are compared with; `pathmark merge` puts
    /// the folders together
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    shard: Option<String>,
    /// Another build of this program, which runs every repetition of every cell in turns with this one; `pathmark diff`
    /// compares the two
    #[arg(long, value_name = "PROGRAM", conflicts_with_all = ["resume", "shard"])]
    against: Option<PathBuf>,
    /// Go on until each speedup (without serial runs, each time) is known to within this, as 3%, and leave out the cells
    /// that are known. With --against: until each cell is known to be slower by more than this, faster, or within it. `fastest` leaves
    /// out schedules once another one of the image is faster, `order` those that are told apart from all others. At most 200
    /// repetitions, or those of --repetitions; intervals allow for it
    #[arg(long, value_name = "SHARE|fastest|order", allow_hyphen_values = true)]
    until: Option<String>,
    /// With --until: begin no repetition later than that, as 60s
    #[arg(long, value_name = "TIME", requires = "until")]
    within: Option<String>,
    /// Cells keep the hierarchies of scenes of 4096 primitives and more in this folder, and take them from there the next
    /// time; the column `build_s` is empty then
    #[arg(long, value_name = "FOLDER", conflicts_with = "against")]
    cache: Option<PathBuf>,
    #[command(flatten)]
    size: profile::Choice,
    #[command(flatten)]
    strict: Strict,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, talk: &Talk) -> Result<()> {
    let definition = Definition::load(lab, &arguments.experiment)?.with_values(&arguments.values)?;
    check_figures(&definition)?;
    let options = Options {
        out: arguments.out.clone(),
        profile: arguments.size.profile(),
        resume: arguments.resume,
        repetitions: arguments.repetitions,
        filters: arguments.filters.clone(),
        against: arguments.against.clone(),
        shard: arguments.shard.as_deref().map(SweepShard::parse).transpose()?,
        serial_for: figure_of_serial(&definition),
        until: arguments.until.as_deref().map(|limit| Until::parse(limit, arguments.within.as_deref())).transpose()?,
        rerun_doubtful: arguments.rerun_doubtful,
        count_instructions: arguments.count_instructions,
        cache: arguments.cache.clone(),
        command: command_line(),
    };
    let mut files = Files::default();
    let sweep = Sweep::new(&definition, &options, &mut files)?;
    report::claim("out", &arguments.out, &mut files)?;
    // Other experiments may run in the same folder, each in its own subfolder; `reproduce` may not.
    let _lock = lock_folder(&arguments.out, Sharing::Shared)?;
    let summary = sweep.run(talk)?;
    let page = report::write(lab, &arguments.out);
    // Failed rows are reported before a page that could not be written.
    if summary.failed > 0 {
        let problem = format!("{} of {} rows failed; their column `error` says why", summary.failed, summary.rows);
        return Err(Error::Check(problem));
    }
    arguments.strict.check(summary.invalid)?;
    talk_of(&summary.doubts, talk);
    if arguments.against.is_some() {
        let old = folder_against(&arguments.out, &definition.name);
        talk.note(&format!("pathmark diff {} {} compares the two builds", old.display(), summary.folder.display()));
    }
    print(&format!("{} rows in {}, report in {}", summary.rows, summary.folder.display(), page?.display()))
}

/// Says how many rows have times in doubt, if there are any.
pub(super) fn talk_of(doubts: &Doubts, talk: &Talk) {
    if doubts.is_any() {
        talk.note(&format!("{doubts}; `pathmark explain` says what each means"));
    }
}
