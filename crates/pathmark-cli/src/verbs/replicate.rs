//! `pathmark replicate THEIRS`: do somebody's ratios, orders, slopes and images come out on this machine, too?

use super::prelude::*;
use super::reproduce::print_plans;
use super::run::{note_doubts, tell_left_out};
use crate::atomic_file;
use crate::command_line;
use crate::console::markdown;
use crate::console::output::lock_folder;
use crate::experiment::{
    Options, REPLICATION, Replication, Reproduction, Statements, Sweep, Theirs, has_records, parse_share,
};
use crate::files::entries;
use crate::lock::Sharing;
use crate::measure::Machine;
use crate::report::replication::{HEADS, cells, notices, rule, sentence, sorted};
use crate::report::{self, check_figures};

/// `pathmark replicate results/reports --plan`
#[derive(Args)]
pub(crate) struct Arguments {
    /// The folder of somebody's rows: of an experiment, or of several
    theirs: PathBuf,
    /// Output folder: the rows that are measured here, their page, and the verdicts in REPLICATION.md and
    /// replication.json. DIR/again has the rows of experiments that were measured a second time
    #[arg(long, value_name = "DIR", default_value = "replication")]
    out: PathBuf,
    /// Replicate only these experiments; may be given several times
    #[arg(long = "experiment", value_name = "NAME")]
    experiments: Vec<String>,
    /// Runs of each cell [default: theirs]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    repetitions: Option<u32>,
    /// At most four runs of each cell: enough for large differences
    #[arg(long, conflicts_with = "repetitions")]
    quick: bool,
    /// Ratios and exponents that differ by less than this are reproduced
    #[arg(long, value_name = "SHARE", default_value = "10%", allow_hyphen_values = true)]
    margin: String,
    /// Print what would run here, with estimated seconds and bytes, and run only a pilot
    #[arg(long, conflicts_with = "form")]
    plan: bool,
    /// Resume a replication that was stopped; if it was finished, judge its rows again
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    form: Form,
}

/// The form of what is printed.
#[derive(Args)]
#[group(id = "form", multiple = false)]
struct Form {
    /// Print the statements as an array of objects
    #[arg(long)]
    json: bool,
    /// Print the text of REPLICATION.md
    #[arg(long)]
    markdown: bool,
}

/// The runs of each cell with `--quick`. With fewer, Student's t leaves no verdict.
const QUICK: u32 = 4;

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let share = parse_share("margin", &arguments.margin)?;
    if share <= 0.0 {
        return Err(InputError::new("margin", &arguments.margin, "leaves no ratio that is reproduced")
            .allowed("shares above 0, such as 10%")
            .into());
    }
    let (mut runs, mut statements, mut machines) = (Vec::new(), Vec::new(), Vec::new());
    for folder in folders(&arguments.theirs, &arguments.experiments)? {
        let theirs = Theirs::read(lab, &folder)?;
        machines.push(theirs.machine.clone());
        match theirs.runnable()? {
            Err(verdict) => {
                console.note(&format!("{} is left out: {}", theirs.definition.name, verdict.lacks()));
                statements.push(theirs.cannot_be_measured(verdict));
            }
            Ok(filters) => {
                check_figures(&theirs.definition)?;
                let usual = theirs.definition.repetitions(theirs.profile)?;
                let options = Options {
                    out: arguments.out.clone(),
                    profile: theirs.profile,
                    resume: arguments.resume,
                    repetitions: arguments.repetitions.or(Some(QUICK).filter(|few| arguments.quick && *few < usual)),
                    filters,
                    command: command_line(),
                    ..Options::default()
                };
                runs.push((theirs, options));
            }
        }
    }
    let mut files = Files::default();
    let sweeps = runs.iter().map(|(theirs, options)| Sweep::new(&theirs.definition, options, &mut files));
    let sweeps = sweeps.collect::<Result<Vec<_>>>()?;
    if arguments.plan {
        return print_plans(lab, &sweeps);
    }
    let [text, data] = [TEXT, REPLICATION].map(|name| arguments.out.join(name));
    files.renews("out", &text, is_replication)?;
    files.renews("out", &data, |path| Replication::read(path).is_ok())?;
    report::claim("out", &arguments.out, &mut files)?;
    let _lock = lock_folder(&arguments.out, Sharing::Shared)?;
    measure(&sweeps, console)?;
    for (theirs, _) in &runs {
        statements.push(theirs.compare(&arguments.out.join(&theirs.definition.name), share)?);
    }
    let mut found = Replication::of(&arguments.theirs, share, statements, [&machines, &[Machine::look()]]);
    let differing = found.with_other_times();
    runs.retain(|(theirs, _)| differing.contains(&theirs.definition.name));
    found.confirm(measured_again(runs, arguments, share, console)?);
    let words = in_words(&found);
    found.write(&data)?;
    atomic_file::write(&text, |file| file.write_all(words.as_bytes()))?;
    let page = report::write(lab, &arguments.out);
    let is_wrong = |own: &&[String; 8]| own[6] == Reproduction::NotReproduced.name();
    let rows: Vec<[String; 8]> = found.statements.iter().map(cells).collect();
    let wrong: Vec<&[String; 8]> = rows.iter().filter(is_wrong).collect();
    if arguments.form.json {
        print_json(&found.statements)?;
    } else if arguments.form.markdown {
        print(words.trim_end())?;
    } else {
        let lines = wrong.iter().map(|[experiment, _, says, theirs, here, _, verdict, note]| {
            let values = if theirs == "-" { String::new() } else { format!(": {theirs} there, {here} here") };
            let note = if note.is_empty() { String::new() } else { format!("; {note}") };
            format!("{verdict}: {experiment}, {says}{values}{note}")
        });
        let lines = lines.chain([sentence(&found)]).chain(notices(&found));
        print(&lines.collect::<Vec<String>>().join("\n"))?;
    }
    // Verdicts are told before a page that could not be written.
    let page = page?;
    if !arguments.form.json && !arguments.form.markdown {
        print(&format!("statements in {}, report in {}", text.display(), page.display()))?;
    }
    match wrong.len() {
        0 if found.statements.iter().any(|own| own.verdict.is_judged()) => Ok(()),
        0 => Err(Error::Check("no statement could be judged".to_string())),
        count => Err(Error::Check(format!("{} not reproduced", counted(count, "statement")))),
    }
}

fn measure(sweeps: &[Sweep<'_>], console: &Console) -> Result<()> {
    for sweep in sweeps {
        let summary = sweep.run(console)?;
        note_doubts(&summary.doubts, console);
        tell_left_out(&summary.left_out, console);
    }
    Ok(())
}

/// The folder within the output folder for what is measured a second time.
pub(super) const AGAIN: &str = "again";

/// Measures experiments a second time, and returns their statements.
fn measured_again(
    runs: Vec<(Theirs, Options)>,
    arguments: &Arguments,
    share: f64,
    console: &Console,
) -> Result<Vec<Statements>> {
    let out = arguments.out.join(AGAIN);
    let mut statements = Vec::new();
    for (theirs, options) in runs {
        let name = &theirs.definition.name;
        console.note(&format!("{name}: times differ from theirs, so it is measured a second time"));
        let options = Options { out: out.clone(), ..options };
        measure(&[Sweep::new(&theirs.definition, &options, &mut Files::default())?], console)?;
        statements.push(theirs.compare(&out.join(name), share)?);
    }
    Ok(statements)
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
    let mut found = entries(theirs)?;
    found.retain(|path| has_records(path));
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

const HEADING: &str = "# Replication of ";
pub(super) const TEXT: &str = "REPLICATION.md";

/// Whether a file is such a text, which a new one may replace: the sentence of counts is below the heading.
fn is_replication(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).unwrap_or_default();
    let below = text.strip_prefix(HEADING).and_then(|rest| rest.split_once("\n\n"));
    below.is_some_and(|(theirs, below)| {
        let words = below.trim_start_matches(|sign: char| sign.is_ascii_digit());
        let is_sentence = |noun: &str| words.starts_with(&format!(" {noun} of {theirs}: "));
        words.len() < below.len() && (is_sentence("statement") || is_sentence("statements"))
    })
}

/// The verdicts in Markdown: counts, all statements, those first that are not reproduced, and the machines.
fn in_words(found: &Replication) -> String {
    let parts = [
        format!("{HEADING}{}", found.theirs),
        sentence(found),
        notices(found).join("\n\n"),
        rule(found),
        markdown::table(HEADS, sorted(found).into_iter().map(cells)),
        markdown::table(
            ["machine", "theirs", "here"],
            found.machines.iter().map(|fact| [fact.name.clone(), fact.theirs.clone(), fact.here.clone()]),
        ),
    ];
    let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    format!("{}\n", parts.join("\n\n"))
}
