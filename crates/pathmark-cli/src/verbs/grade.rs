//! `pathmark grade PROGRAM..`: do the strategies that programs add keep the contract, and how fast are they?

use super::contract::time;
use super::prelude::*;
use super::rank::letters;
use super::run::note_doubts;
use crate::atomic_file;
use crate::console::output::{aligned, lock_folder};
use crate::error::printable;
use crate::experiment::{Candidate, Grade, LARGEST_REPETITIONS, Rows, Trial, grades, own_checksum};
use crate::lock::Sharing;
use crate::measure::{TimingConcerns, available_threads};
use std::time::Duration;

const DEFINITION: &str = include_str!("../../assets/grade.toml");
/// The definition's file, whose stem is the name of each program's folder of rows.
const FILE: &str = "grade.toml";

/// `pathmark grade target/release/my-program --json grade.json`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Programs that add strategies: `pathmark::main(Lab::new().strategy(ENTRY))`
    #[arg(required = true, value_name = "PROGRAM")]
    programs: Vec<PathBuf>,
    /// Folder for the rows and the page of each program; `pathmark report DIR` puts all on one page
    #[arg(long, value_name = "DIR", default_value = "graded")]
    out: PathBuf,
    /// Also write the grades into this file, for a course system
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Replace a value of the render, as in size=320x240 or threads=4; may be given several times [default: 160x120, 16
    /// samples, rows, a thread for each processor]
    #[arg(long = "set", value_name = "AXIS=VALUE")]
    values: Vec<String>,
    /// Processes of each strategy; intervals follow from their spread
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(3..=i64::from(LARGEST_REPETITIONS)))]
    repetitions: u32,
    /// Time limit of each contract, and of each run
    #[arg(long, value_name = "TIME", default_value = "3min", value_parser = time)]
    timeout: Duration,
}

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let set = settings(&arguments.values)?;
    let candidates = candidates(&arguments.programs)?;
    let definition = arguments.out.join(FILE);
    let mut files = Files::default();
    for candidate in &candidates {
        let rows = arguments.out.join(&candidate.label).join("grade").join("records.csv");
        files.renews("out", &rows, |_| false)?;
    }
    files.renews("out", &definition, |path| std::fs::read_to_string(path).is_ok_and(|text| text == DEFINITION))?;
    arguments.json.as_ref().map_or(Ok(()), |path| files.writes("json", path))?;
    let checksum = own_checksum(lab, DEFINITION, &set)?;
    let _lock = lock_folder(&arguments.out, Sharing::Shared)?;
    atomic_file::write(&definition, |file| file.write_all(DEFINITION.as_bytes()))?;

    let (mut own, mut rows) = (Vec::new(), Rows::new());
    console.begin("grades", 2 * candidates.len() as u64);
    for (done, candidate) in (0..).step_by(2).zip(&candidates) {
        let verdict = |strategy: &String| {
            let broken = candidate.broken_promises(strategy, arguments.timeout);
            Grade::new(Some(&candidate.label), strategy, broken)
        };
        let judged: Vec<Grade> = candidate.strategies.iter().map(verdict).collect();
        console.advance(done + 1);
        let sound: Vec<&str> =
            judged.iter().filter(|grade| grade.is_passed()).map(|grade| grade.strategy.as_str()).collect();
        if !sound.is_empty() {
            let (repetitions, limit) = (arguments.repetitions, arguments.timeout);
            let out = arguments.out.join(&candidate.label);
            let trial = Trial { definition: &definition, out: &out, set: &set, repetitions, limit };
            rows.insert(candidate.label.clone(), candidate.measure(&sound, &trial));
        }
        own.extend(judged);
        console.advance(done + 2);
    }
    console.end();
    let found = grades(own, &rows, checksum.as_deref());
    if let Some(path) = &arguments.json {
        let text = object(&found, &set, checksum.as_deref()).to_string();
        atomic_file::write(path, |file| writeln!(file, "{text}"))?;
    }
    print(&table(&found))?;
    let measured = rows.values().filter_map(|rows| rows.as_ref().ok()).flatten();
    note_doubts(&TimingConcerns::of(measured.map(|row| row.warnings.as_str())), console);
    let own = || found.iter().filter(|grade| grade.program.is_some());
    let failed = own().filter(|grade| !grade.is_passed()).count();
    if failed > 0 {
        return Err(Error::Check(format!("{failed} of {} strategies have a fault", own().count())));
    }
    Ok(())
}

/// The values for every program: those of the command, and a thread for each processor.
fn settings(values: &[String]) -> Result<Vec<String>> {
    let names = |axis: &str| values.iter().any(|pair| pair.split('=').next() == Some(axis));
    if names("strategy") {
        let error = InputError::new("set", "strategy", "is set by the programs");
        return Err(error.allowed("another axis").into());
    }
    let threads = (!names("threads")).then(|| format!("threads={}", available_threads().max(2)));
    Ok(values.iter().cloned().chain(threads).collect())
}

/// Each program with its strategies, under its file's name, or under its path if another has the same name.
fn candidates(programs: &[PathBuf]) -> Result<Vec<Candidate>> {
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let by_path = |path: &Path| {
        let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
        parts.into_iter().filter(|part| !matches!(part.as_str(), "/" | "." | "..")).collect::<Vec<_>>().join("-")
    };
    let label = |path: &Path| {
        let is_alone = programs.iter().filter(|other| name(other) == name(path)).count() == 1;
        if is_alone { name(path) } else { by_path(path) }
    };
    let mut found: Vec<Candidate> = Vec::new();
    for program in programs {
        let label = label(program);
        if found.iter().any(|other| other.label == label) {
            let problem = format!("has the name {label}, as another program does");
            let error = InputError::new("program", program.display().to_string(), problem);
            return Err(error.allowed("each program once").into());
        }
        found.push(Candidate::ask(program, label)?);
    }
    Ok(found)
}

fn verdict(grade: &Grade) -> &'static str {
    match (grade.program.is_some(), grade.is_passed()) {
        (false, _) => "built in",
        (true, true) => "passed",
        (true, false) => "failed",
    }
}

fn table(found: &[Grade]) -> String {
    let heads = ["speedup", "interval", "groups", "verdict", "program", "strategy"].map(str::to_string).to_vec();
    let line = |grade: &Grade| {
        let program = grade.program.as_deref().map_or_else(|| "-".into(), printable).into_owned();
        let interval = grade.interval.map_or_else(|| "-".to_string(), |i| format!("{:.2} to {:.2}", i.low, i.high));
        let speedup = grade.speedup.map_or_else(|| "-".to_string(), |speedup| format!("{speedup:.2}"));
        let strategy = printable(&grade.strategy).into_owned();
        vec![speedup, interval, letters(&grade.groups), verdict(grade).to_string(), program, strategy]
    };
    let words = "\nSpeedups over serial in the same pair, with 95 % intervals. Strategies that share a letter cannot be told \
                 apart; all other orders hold together with 95 % confidence.";
    let faults = found.iter().filter(|grade| !grade.is_passed()).flat_map(|grade| {
        let name = format!("{} {}", grade.program.as_deref().unwrap_or_default(), grade.strategy);
        let promises = grade.contract.iter().map(ToString::to_string);
        promises.chain(grade.faults.iter().cloned()).map(move |fault| format!("{name}: {fault}"))
    });
    let lines = [aligned(heads, found.iter().map(line), false), words.to_string()];
    lines.into_iter().chain(faults).collect::<Vec<_>>().join("\n")
}

fn object(found: &[Grade], set: &[String], checksum: Option<&str>) -> Value {
    let own = |grade: &Grade| {
        json!({
            "program": grade.program, "strategy": grade.strategy, "verdict": verdict(grade), "contract": grade.contract,
            "faults": grade.faults, "speedup": grade.speedup.map(number), "interval": grade.interval,
            "groups": grade.groups, "letters": letters(&grade.groups),
        })
    };
    json!({ "set": set, "checksum": checksum, "grades": found.iter().map(own).collect::<Vec<_>>() })
}
