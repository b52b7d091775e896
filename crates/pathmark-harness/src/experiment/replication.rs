//! Replication: whether the ratios and the images of somebody's rows come out here, too. Seconds are never compared.

use super::comparisons::Comparisons;
use super::records_file::read_records;
use super::{Cell, Definition, Profile, packed_rows};
use crate::analysis::adjacent_pairs::by_process;
use crate::analysis::agreement::{Agreement, LogRatio, agreement, more_processes};
use crate::error::{InputError, Result};
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{Record, SETTINGS, Setting};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

/// Confidence that no verdict *not reproduced* is wrong, over all statements together.
pub const JOINT_LEVEL: f64 = 0.95;

/// The definition and the profile of somebody's rows, and the processors of their machine.
pub fn definition_of(lab: &Arc<Lab>, theirs: &Path) -> Result<(Definition, Profile, usize)> {
    let path = theirs.join("experiment.toml");
    let name = theirs.canonicalize().unwrap_or_else(|_| theirs.to_path_buf());
    let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let definition = Definition::from_text(lab, &name, &path.display().to_string(), &read_text(&path)?)?;
    let path = theirs.join(super::MACHINE);
    let run = super::read_run_file(&path)?;
    let profile = Profile::from_name(&run.profile).ok_or_else(|| {
        InputError::new("profile", &run.profile, "is no profile").in_file(path.display().to_string(), None)
    })?;
    Ok((definition, profile, run.machine.processors))
}

/// A statement of somebody's rows, and what the rows here say about it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statement {
    pub experiment: String,
    pub says: String,
    /// Their ratio and the one here; `None` for an image.
    pub theirs: Option<f64>,
    pub here: Option<f64>,
    /// Here over theirs, with the ends of its interval.
    pub difference: Option<[f64; 3]>,
    pub verdict: Reproduction,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "is", content = "why")]
pub enum Reproduction {
    Reproduced,
    NotReproduced,
    /// How many more processes would tell; `None` if theirs are too few.
    CannotTell(Option<usize>),
    /// Why there are no rows here: something that this machine lacks, or the error of its rows.
    OtherHardware(String),
}

impl Reproduction {
    pub fn name(&self) -> &'static str {
        match self {
            Self::Reproduced => "reproduced",
            Self::NotReproduced => "not reproduced",
            Self::CannotTell(_) => "cannot tell",
            Self::OtherHardware(_) => "other hardware",
        }
    }
}

/// A ratio of somebody's rows beside the one here, before all are judged together.
struct Ratio {
    says: String,
    theirs: LogRatio,
    here: std::result::Result<LogRatio, String>,
}

/// The statements of an experiment.
#[derive(Default)]
pub struct Statements {
    experiment: String,
    ratios: Vec<Ratio>,
    /// Images by what they show: whether the checksums are the same; `Err` if there is no image here, and why.
    images: Vec<(String, std::result::Result<bool, String>)>,
}

type Times = BTreeMap<(u32, Option<u32>), f64>;

/// Rows that did not fail, by cell; and the errors of the others.
struct Rows {
    rows: Vec<Record>,
    failed: BTreeMap<String, String>,
}

impl Rows {
    fn read(folder: &Path) -> Result<Self> {
        let path = packed_rows::records_path(folder);
        let all = if path.is_file() { read_records(&path)? } else { Vec::new() };
        let (rows, failed): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|row| row.error.is_empty() && !row.is_left_out());
        let why = |row: Record| {
            let why = if row.error.is_empty() { row.warnings } else { row.error };
            (row.cell, why)
        };
        Ok(Self { rows, failed: failed.into_iter().map(why).collect() })
    }

    fn times(&self) -> BTreeMap<&str, Times> {
        let mut times: BTreeMap<&str, Times> = BTreeMap::new();
        for row in &self.rows {
            if let Some(seconds) = row.makespan_s {
                times.entry(&row.cell).or_default().insert((row.repetition, row.pair), seconds);
            }
        }
        times
    }

    /// The checksums of each cell: repetitions and pairs share one. Samplers that draw other numbers in each run leave none.
    fn checksums(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let mut found: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
        for row in self.rows.iter().filter(|row| !row.checksum.is_empty()) {
            found.entry(&row.cell).or_default().insert(&row.checksum);
        }
        found
    }

    fn why_not(&self, cell: &str) -> String {
        self.failed.get(cell).cloned().unwrap_or_else(|| "no rows here".to_string())
    }
}

impl Statements {
    /// Compares the rows of one experiment. `absent` says why a cell is not run here, if it is not.
    pub fn of(
        (definition, profile): (&Definition, Profile),
        [theirs, here]: [&Path; 2],
        absent: impl Fn(&Cell) -> Option<String>,
    ) -> Result<Self> {
        let [theirs, here] = [Rows::read(theirs)?, Rows::read(here)?];
        let cells = definition.cells(profile)?;
        let [their_times, times] = [&theirs, &here].map(Rows::times);
        let ratio = |times: &BTreeMap<&str, Times>, [what, with]: [&Cell; 2]| {
            let (what, with) = (times.get(what.id.as_str())?, times.get(with.id.as_str())?);
            let ratios = what.iter().filter_map(|(turn, seconds)| Some((turn.0, seconds / with.get(turn)?)));
            LogRatio::of(&by_process(ratios))
        };
        let mut ratios = Vec::new();
        for pair in Comparisons::of_any(definition, profile, &cells)?.pairs {
            let both = [&cells[pair.what], &cells[pair.with]];
            let Some(theirs) = ratio(&their_times, both) else { continue };
            let lacking = both.into_iter().find_map(&absent);
            let own = lacking.map_or_else(|| ratio(&times, both).ok_or_else(|| here.why_not(&both[0].id)), Err);
            ratios.push(Ratio { says: told(both), theirs, here: own });
        }
        let [their_sums, sums] = [&theirs, &here].map(Rows::checksums);
        let mut by_image: BTreeMap<&str, Vec<(&Cell, &str)>> = BTreeMap::new();
        for cell in cells.iter().filter(|cell| cell.external.is_none()) {
            for point in &cell.points {
                by_image.entry(&point.image).or_default().push((cell, &point.id));
            }
        }
        let mut images = Vec::new();
        for (image, points) in by_image {
            let all = |sums: &BTreeMap<&str, BTreeSet<&str>>| -> BTreeSet<String> {
                let own = points.iter().filter_map(|(_, id)| sums.get(id)).flatten();
                own.map(ToString::to_string).collect()
            };
            let (theirs, own) = (all(&their_sums), all(&sums));
            let Some((first, id)) = points.first().filter(|_| !theirs.is_empty()) else { continue };
            let same =
                if own.is_empty() { Err(absent(first).unwrap_or_else(|| here.why_not(id))) } else { Ok(own == theirs) };
            images.push((format!("image {image}"), same));
        }
        Ok(Self { experiment: definition.name.clone(), ratios, images })
    }
}

/// The two cells of a comparison, by the settings in which they differ.
fn told([what, with]: [&Cell; 2]) -> String {
    let differing: Vec<&Setting> = SETTINGS.iter().filter(|own| what.shown(own) != with.shown(own)).collect();
    let of = |cell: &Cell| differing.iter().map(|own| cell.shown(own)).collect::<Vec<_>>().join(" ");
    format!("time of {} over {}, {}", of(what), of(with), what.settings.scene)
}

/// Judges the statements of all experiments together: ratios against the margin, at one joint level, and images by their
/// checksums.
pub fn judge_together(all: Vec<Statements>, margin: f64) -> Vec<Statement> {
    let count = all.iter().flat_map(|own| &own.ratios).filter(|ratio| ratio.here.is_ok()).count();
    let level = 1.0 - (1.0 - JOINT_LEVEL) / count.max(1) as f64;
    let of_ratio = |experiment: &str, Ratio { says, theirs, here }: Ratio| {
        let mut statement = Statement {
            experiment: experiment.to_string(),
            says,
            theirs: Some(libm::exp(theirs.value)),
            here: here.as_ref().ok().map(|own| libm::exp(own.value)),
            difference: None,
            verdict: Reproduction::CannotTell(None),
        };
        statement.verdict = match here {
            Err(why) => Reproduction::OtherHardware(why),
            Ok(own) => match agreement(theirs, own, margin, level) {
                None => Reproduction::CannotTell(None),
                Some((difference, verdict)) => {
                    statement.difference = Some(difference);
                    match verdict {
                        Agreement::Reproduced => Reproduction::Reproduced,
                        Agreement::NotReproduced => Reproduction::NotReproduced,
                        Agreement::CannotTell => Reproduction::CannotTell(more_processes(theirs, own, margin, level)),
                    }
                }
            },
        };
        statement
    };
    let of_image = |experiment: &str, (says, same): (String, std::result::Result<bool, String>)| Statement {
        experiment: experiment.to_string(),
        says,
        theirs: None,
        here: None,
        difference: None,
        verdict: match same {
            Ok(true) => Reproduction::Reproduced,
            Ok(false) => Reproduction::NotReproduced,
            Err(why) => Reproduction::OtherHardware(why),
        },
    };
    let mut statements = Vec::new();
    for Statements { experiment, ratios, images } in all {
        statements.extend(ratios.into_iter().map(|ratio| of_ratio(&experiment, ratio)));
        statements.extend(images.into_iter().map(|image| of_image(&experiment, image)));
    }
    statements
}
