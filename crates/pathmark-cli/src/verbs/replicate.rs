//! `pathmark replicate THEIRS`: do somebody's ratios and images come out on this machine, too?

use super::prelude::*;
use super::reproduce::print_plans;
use super::run::{note_doubts, tell_left_out};
use crate::atomic_file;
use crate::command_line;
use crate::console::markdown;
use crate::console::output::lock_folder;
use crate::experiment::{
    Cell, Definition, JOINT_LEVEL, Options, Profile, Reproduction, Statement, Statements, Sweep, definition_of,
    has_records, judge_together, parse_share,
};
use crate::lock::Sharing;
use crate::measure::available_threads;
use std::collections::BTreeSet;

/// `pathmark replicate results/reports --plan`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder of somebody's rows: of an experiment, or of several
    theirs: PathBuf,
    /// Output folder: the rows that are measured here, and the verdicts in REPLICATION.md
    #[arg(long, value_name = "DIR", default_value = "replication")]
    out: PathBuf,
    /// Replicate only these experiments; may be given several times
    #[arg(long = "experiment", value_name = "NAME")]
    experiments: Vec<String>,
    /// Runs of each cell [default: theirs]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    repetitions: Option<u32>,
    /// Ratios that differ by less than this are reproduced
    #[arg(long, value_name = "SHARE", default_value = "10%", allow_hyphen_values = true)]
    margin: String,
    /// Print what would run here, with estimated seconds and bytes, and run only a pilot
    #[arg(long)]
    plan: bool,
    /// Resume a replication that was stopped; if it was finished, judge its rows again
    #[arg(long)]
    resume: bool,
    /// Print the statements as an array of objects
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let margin = 1.0 + parse_share("margin", &arguments.margin)?;
    if margin <= 1.0 {
        return Err(InputError::new("margin", &arguments.margin, "leaves no ratio that is reproduced")
            .allowed("shares above 0, such as 10%")
            .into());
    }
    let mut runs = Vec::new();
    for folder in folders(&arguments.theirs, &arguments.experiments)? {
        let (definition, profile, theirs) = definition_of(lab, &folder)?;
        if let Some((_, takes)) = definition.missing_feature() {
            console.note(&format!("{} is left out: it needs {takes}", definition.name));
            continue;
        }
        let Some(filters) = runnable(&definition, profile, theirs)? else {
            console.note(&format!(
                "{} is left out: all of its cells use more processors than there are here",
                definition.name
            ));
            continue;
        };
        let options = Options {
            out: arguments.out.clone(),
            profile,
            resume: arguments.resume,
            repetitions: arguments.repetitions,
            filters,
            command: command_line(),
            ..Options::default()
        };
        runs.push((folder, definition, options, theirs));
    }
    let mut files = Files::default();
    let sweeps = runs.iter().map(|(_, definition, options, _)| Sweep::new(definition, options, &mut files));
    let sweeps = sweeps.collect::<Result<Vec<_>>>()?;
    if arguments.plan {
        return print_plans(lab, &sweeps);
    }
    let page = arguments.out.join("REPLICATION.md");
    files.renews("out", &page, is_replication)?;
    let _lock = lock_folder(&arguments.out, Sharing::Shared)?;
    for sweep in &sweeps {
        let summary = sweep.run(console)?;
        note_doubts(&summary.doubts, console);
        tell_left_out(&summary.left_out, console);
    }
    let mut all = Vec::new();
    for (theirs, definition, options, processors) in &runs {
        let here = arguments.out.join(&definition.name);
        let absent = |cell: &Cell| absent(cell, *processors);
        all.push(Statements::of((definition, options.profile), [theirs, &here], absent)?);
    }
    let statements = judge_together(all, margin);
    let text = in_words(&statements, &arguments.theirs, margin);
    atomic_file::write(&page, |file| file.write_all(text.as_bytes()))?;
    if arguments.json {
        print_json(&statements)?;
    } else {
        print(text.trim_end())?;
    }
    let wrong = statements.iter().filter(|own| own.verdict == Reproduction::NotReproduced).count();
    if wrong == 0 { Ok(()) } else { Err(Error::Check(format!("{} not reproduced", counted(wrong, "statement")))) }
}

/// The folders of the experiments, sorted by name.
fn folders(theirs: &Path, wanted: &[String]) -> Result<Vec<PathBuf>> {
    let refused = |problem: &str| InputError::new("theirs", theirs.display().to_string(), problem);
    if !theirs.is_dir() {
        return Err(refused("there is no such folder").into());
    }
    if has_records(theirs) && wanted.is_empty() {
        return Ok(vec![theirs.to_path_buf()]);
    }
    let system = |e| Error::system("reading", theirs, e);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(theirs).map_err(system)? {
        let path = entry.map_err(system)?.path();
        if has_records(&path) {
            found.push(path);
        }
    }
    found.sort();
    let name = |path: &PathBuf| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let names: Vec<String> = found.iter().map(name).collect();
    if names.is_empty() {
        return Err(refused("holds no experiment: no folder in it has rows").into());
    }
    if let Some(unknown) = wanted.iter().find(|own| !names.contains(own)) {
        return Err(InputError::new("experiment", unknown, "is not in that folder").allowed(names.join(", ")).into());
    }
    found.retain(|path| wanted.is_empty() || wanted.contains(&name(path)));
    Ok(found)
}

/// Why a cell cannot be replicated here: on their machine it used more processors than there are here.
fn absent(cell: &Cell, theirs: usize) -> Option<String> {
    let (used, here) = (cell.settings.threads.min(theirs), available_threads());
    (used > here).then(|| format!("{} instead of {here}", counted(used, "processor")))
}

/// The filter that leaves the cells which can run here; `None` if there are none.
fn runnable(definition: &Definition, profile: Profile, theirs: usize) -> Result<Option<Vec<String>>> {
    let cells = definition.cells(profile)?;
    let runs = |cell: &&Cell| absent(cell, theirs).is_none();
    let here: BTreeSet<usize> = cells.iter().filter(runs).map(|cell| cell.settings.threads).collect();
    if here.is_empty() {
        return Ok(None);
    }
    if cells.iter().all(|cell| runs(&cell)) {
        return Ok(Some(Vec::new()));
    }
    let here: Vec<String> = here.iter().map(usize::to_string).collect();
    Ok(Some(vec![format!("threads={}", here.join(","))]))
}

const HEADING: &str = "# Replication";

/// Whether a file is such a text, which a new one may replace.
fn is_replication(path: &Path) -> bool {
    std::fs::read_to_string(path).is_ok_and(|text| text.starts_with(HEADING))
}

/// The verdicts in Markdown: counts, then all statements, those that are not reproduced first.
fn in_words(statements: &[Statement], theirs: &Path, margin: f64) -> String {
    let order = ["not reproduced", "cannot tell", "other hardware", "reproduced"];
    let count = |name: &str| statements.iter().filter(|own| own.verdict.name() == name).count();
    let counts: Vec<String> = order.iter().rev().map(|name| format!("{} {name}", count(name))).collect();
    let mut sorted: Vec<&Statement> = statements.iter().collect();
    sorted.sort_by_key(|own| order.iter().position(|name| *name == own.verdict.name()));
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_string(), |value| format!("{value:.3}"));
    let row = |own: &&Statement| {
        let interval = own.difference.map(|[_, low, high]| format!("{low:.3} to {high:.3}"));
        let why = match &own.verdict {
            Reproduction::CannotTell(Some(more)) => format!(": {}", counted(*more, "more repetition")),
            Reproduction::CannotTell(None) => ": their rows are too few".to_string(),
            Reproduction::OtherHardware(why) => format!(": {why}"),
            Reproduction::Reproduced | Reproduction::NotReproduced => String::new(),
        };
        let verdict = format!("{}{why}", own.verdict.name());
        let change = interval.unwrap_or_else(|| "-".to_string());
        [own.experiment.clone(), own.says.clone(), number(own.theirs), number(own.here), change, verdict]
    };
    let heads = ["experiment", "statement", "theirs", "here", "here / theirs", "verdict"];
    format!(
        "{HEADING}\n\nOf {} of {}: {}. Ratios count as reproduced within {:.0} %; with {:.0} % confidence no *not reproduced* of a \
         ratio is wrong. Images are compared by their checksums, and seconds are not compared.\n\n{}\n",
        counted(statements.len(), "statement"),
        theirs.display(),
        counts.join(", "),
        100.0 * (margin - 1.0),
        100.0 * JOINT_LEVEL,
        markdown::table(heads, sorted.iter().map(row))
    )
}
