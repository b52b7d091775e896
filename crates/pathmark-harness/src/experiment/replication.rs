//! Replication: whether the statements of somebody's rows come out here, too.

use super::comparisons::{Comparison, Comparisons};
use super::diff::{Cells, times};
use super::image_bits::{ImageBits, SameBits};
use super::ranking::{MISS, capped, schedules_of, told_orders};
use super::records_file::read_records;
use super::statements::{Evidence, JOINT_LEVEL, Kind, Reproduction, Statement, Unjudged, judge_together};
use super::together::Schedules;
use super::turns::turns;
use super::{Cell, Definition, MACHINE, Options, Plan, Prices, Profile, RunFile, Sweep, packed_rows, read_run_file};
use crate::analysis::adjacent_pairs::{FEWEST_PROCESSES, by_process, log_ratio};
use crate::analysis::confidence_sequence::Stopping;
use crate::analysis::equivalence::Measured;
use crate::analysis::jackknife::{SeedCurves, curves_of};
use crate::analysis::quantile::median;
use crate::analysis::ranking::ratios_in_pairs;
use crate::analysis::slope::exponent;
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::files::Files;
use crate::input::read_text;
use crate::lab::Lab;
use crate::measure::{ImageKey, Machine, Record, SETTINGS, Setting, available_threads};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet, HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The file of verdicts in the folder of a replication.
pub const REPLICATION: &str = "replication.json";

/// Fewest seeds for the interval of a slope.
const FEWEST_SEEDS: usize = 2;

/// The name of the fact that tells two versions of the program apart.
const SOURCES: &str = "Pathmark's sources";

/// The rows of somebody's experiment.
pub struct Theirs {
    pub folder: PathBuf,
    pub definition: Definition,
    pub profile: Profile,
    pub machine: Machine,
}

impl Theirs {
    pub fn read(lab: &Arc<Lab>, folder: &Path) -> Result<Self> {
        let path = folder.join("experiment.toml");
        let name = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
        let name = name.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let definition = Definition::from_text(lab, &name, &path.display().to_string(), &read_text(&path)?)?;
        let path = folder.join(MACHINE);
        let RunFile { profile, machine, .. } = read_run_file(&path)?;
        let profile = Profile::from_name(&profile).ok_or_else(|| {
            InputError::new("profile", &profile, "is no profile").in_file(path.display().to_string(), None)
        })?;
        Ok(Self { folder: folder.to_path_buf(), definition, profile, machine })
    }

    /// Why a cell cannot be measured here: on their machine it used more processors than there are here.
    fn absent(&self, cell: &Cell) -> Option<String> {
        more_than_here(cell.settings.threads.min(self.machine.processors), "processor")
    }

    /// The filters that leave the cells which can run here. If there are none, the verdict on all of them.
    pub fn runnable(&self) -> Result<std::result::Result<Vec<String>, Reproduction>> {
        if let Some((feature, takes)) = self.definition.missing_feature() {
            return Ok(Err(Reproduction::NotMeasured(format!("this build lacks {feature}: {takes}"))));
        }
        let cells = self.definition.cells(self.profile)?;
        let absent: Vec<String> = cells.iter().filter_map(|cell| self.absent(cell)).collect();
        let here = cells.iter().filter(|cell| self.absent(cell).is_none()).map(|cell| cell.settings.threads);
        let here: Vec<String> = here.collect::<BTreeSet<usize>>().iter().map(usize::to_string).collect();
        Ok(match (absent.first(), here.is_empty()) {
            (None, _) => Ok(Vec::new()),
            (Some(why), true) => Err(Reproduction::OtherHardware(why.clone())),
            (Some(_), false) => Ok(vec![format!("threads={}", here.join(","))]),
        })
    }

    /// Compares their rows with those in a folder. Ratios and exponents that differ by less than `share` count as equal.
    pub fn compare(&self, here: &Path, share: f64) -> Result<Statements> {
        let cells = self.definition.cells(self.profile)?;
        let pairs = Comparisons::of_any(&self.definition, self.profile, &cells)?.pairs;
        let [theirs, here] = [self.folder.as_path(), here].map(Rows::read);
        let absent = |cell: &Cell| self.absent(cell);
        let experiment = &self.definition.name;
        let both = Both { experiment, cells: &cells, theirs: theirs?, here: here?, share, absent: &absent };
        Ok(Statements(both.statements(&pairs)))
    }

    /// The plan of a measurement here; `folder` is that of the rows.
    pub fn plan(&self, folder: &Path, prices: &mut Prices<'_>) -> Result<Plan> {
        let Self { definition, profile, .. } = self;
        if let Some((_, takes)) = definition.missing_feature() {
            return Err(InputError::new("requires", &definition.name, format!("needs {takes}")).into());
        }
        // Nothing is written there.
        let options = Options { out: folder.join("again"), profile: *profile, ..Options::default() };
        Sweep::new(definition, &options, &mut Files::default())?.plan(prices)
    }

    /// The statement that none of it can be measured here, with its verdict.
    pub fn cannot_be_measured(&self, verdict: Reproduction) -> Statements {
        let (experiment, says) = (self.definition.name.clone(), "all cells".to_string());
        Statements(vec![Unjudged { experiment, kind: Kind::Cells, says, evidence: Evidence::lacking(None, verdict) }])
    }
}

/// Names the number of threads or processors if it is larger than the number of processors here.
fn more_than_here(count: usize, thing: &str) -> Option<String> {
    let here = available_threads();
    let plural = if count == 1 { "" } else { "s" };
    (count > here).then(|| format!("{count} {thing}{plural} instead of {here}"))
}

/// The statements of an experiment, before those of all are judged together.
pub struct Statements(Vec<Unjudged>);

/// Rows that did not fail; and by cell the verdicts for the others.
pub(super) struct Rows {
    measured: Vec<Record>,
    failed: BTreeMap<String, Reproduction>,
    stopping: Stopping,
    /// Whether the limits of matrices on repetitions did not apply.
    uncapped: bool,
}

impl Rows {
    fn read(folder: &Path) -> Result<Self> {
        let (rows, run) = (packed_rows::records_path(folder), folder.join(MACHINE));
        let all = if rows.is_file() { read_records(&rows)? } else { Vec::new() };
        let run = if run.is_file() { read_run_file(&run)? } else { RunFile::default() };
        Ok(Self::of(all, run.stopping(), run.uncapped))
    }

    pub(super) fn of(all: Vec<Record>, stopping: Stopping, uncapped: bool) -> Self {
        let (measured, failed): (Vec<_>, Vec<_>) =
            all.into_iter().partition(|row| row.error.is_empty() && !row.is_left_out());
        let why = |row: Record| {
            let verdict = if row.lacks_device() { Reproduction::OtherHardware } else { Reproduction::NotMeasured };
            let why = row.lacks().unwrap_or(row.error);
            (row.cell, verdict(why))
        };
        Self { measured, failed: failed.into_iter().map(why).collect(), stopping, uncapped }
    }

    fn schedules(&self, cells: &[Cell]) -> BTreeMap<ImageKey, Schedules> {
        let shown_only = if self.uncapped { BTreeSet::new() } else { capped(cells) };
        schedules_of(self.measured.iter().zip(turns(&self.measured)), &shown_only)
    }

    /// The exponent of RMSE against samples of each image that has several numbers of samples, and how many seeds it has.
    fn slopes(&self) -> BTreeMap<ImageKey, (Option<Measured>, usize)> {
        let mut images: BTreeMap<ImageKey, BTreeMap<u32, BTreeMap<u64, f64>>> = BTreeMap::new();
        for (row, mse) in self.measured.iter().filter_map(|row| Some((row, row.mse?))) {
            let errors = images.entry(of_curve(row.image_key())).or_default();
            errors.entry(row.spp).or_default().entry(row.seed).or_insert(mse);
        }
        images.retain(|_, errors| errors.len() > 1);
        let slope = |errors: BTreeMap<u32, BTreeMap<u64, f64>>| {
            let seeds = errors.values().flat_map(BTreeMap::keys).copied().collect();
            let curves: Vec<_> = curves_of(&seeds, errors).into_values().collect();
            (SeedCurves::of_errors(&curves).and_then(|curves| exponent(&curves)), seeds.len())
        };
        images.into_iter().map(|(image, errors)| (image, slope(errors))).collect()
    }
}

/// The key that the points of an error curve share.
fn of_curve(image: ImageKey) -> ImageKey {
    ImageKey { spp: 0, seed: 0, ..image }
}

/// Their rows of an experiment, and those here.
pub(super) struct Both<'a> {
    pub(super) experiment: &'a str,
    pub(super) cells: &'a [Cell],
    pub(super) theirs: Rows,
    pub(super) here: Rows,
    /// Ratios and exponents that differ by less count as equal.
    pub(super) share: f64,
    /// Why a cell is not measured here, if it is not.
    pub(super) absent: &'a dyn Fn(&Cell) -> Option<String>,
}

impl Both<'_> {
    pub(super) fn statements(&self, pairs: &[Comparison]) -> Vec<Unjudged> {
        let kinds = [self.ratios(pairs), self.orders(), self.slopes(), self.images(), self.others()];
        kinds.into_iter().flatten().collect()
    }

    fn unjudged(&self, kind: Kind, says: String, evidence: Evidence) -> Unjudged {
        Unjudged { experiment: self.experiment.to_string(), kind, says, evidence }
    }

    /// The verdict if none of the cells that are meant has rows here.
    fn why_not(&self, is_meant: impl Fn(&Cell) -> bool) -> Reproduction {
        let meant: Vec<&Cell> = self.cells.iter().filter(|cell| is_meant(cell)).collect();
        if let Some(why) = meant.iter().find_map(|cell| (self.absent)(cell)) {
            return Reproduction::OtherHardware(why);
        }
        let failed = meant.iter().flat_map(|cell| &cell.points).find_map(|point| self.here.failed.get(&point.id));
        failed.cloned().unwrap_or_else(|| Reproduction::NotMeasured("no rows here".to_string()))
    }

    fn ratios(&self, pairs: &[Comparison]) -> Vec<Unjudged> {
        let [theirs, here] = [&self.theirs, &self.here].map(|rows| times(&rows.measured));
        let processes = |times: &Cells, [what, with]: [&Cell; 2]| {
            Some(by_process(ratios_in_pairs(times.get(&what.id)?, times.get(&with.id)?)))
        };
        let of_pair = |pair: &Comparison| {
            let both = [&self.cells[pair.what], &self.cells[pair.with]];
            let told = processes(&theirs, both).filter(|own| !own.is_empty())?;
            let Some(theirs) = log_ratio(&told) else {
                return Some((both, Evidence::of_theirs(told.len(), FEWEST_PROCESSES, "repetition")));
            };
            let ratio = libm::exp(theirs.value);
            let own = processes(&here, both).filter(|own| !own.is_empty());
            let own = own.filter(|_| !both.into_iter().any(|cell| (self.absent)(cell).is_some()));
            let evidence = match own.map(|own| (log_ratio(&own), own.len())) {
                None => Evidence::lacking(Some(ratio), self.why_not(|cell| both.iter().any(|own| own.id == cell.id))),
                Some((Some(here), _)) => Evidence::Values { theirs, here, limit: libm::log(1.0 + self.share) },
                Some((None, count)) => Evidence::of_few_here(ratio, count, FEWEST_PROCESSES),
            };
            Some((both, evidence))
        };
        let (cells, evidence): (Vec<_>, Vec<_>) = pairs.iter().filter_map(of_pair).unzip();
        told(&cells).into_iter().zip(evidence).map(|(says, own)| self.unjudged(Kind::Ratio, says, own)).collect()
    }

    /// For each image the orders by more than the margin of which `rank` is sure in their rows.
    fn orders(&self) -> Vec<Unjudged> {
        let (theirs, mut here) = (self.theirs.schedules(self.cells), self.here.schedules(self.cells));
        let miss = MISS / theirs.len().max(1) as f64;
        let of_image = |(image, schedules): (ImageKey, Schedules)| {
            let is_apart = |(faster, slower): &(String, String)| {
                let ratios = ratios_in_pairs(&schedules[slower].times, &schedules[faster].times);
                let ratios: Vec<f64> = ratios.into_iter().map(|(_, ratio)| ratio).collect();
                median(&ratios).is_some_and(|ratio| ratio > 1.0 + self.share)
            };
            let told = told_orders(&schedules, miss, self.theirs.stopping);
            let told: BTreeSet<(String, String)> = told.into_iter().filter(is_apart).collect();
            let named: BTreeSet<&String> = told.iter().flat_map(|(faster, slower)| [faster, slower]).collect();
            let mut own = here.remove(&image).unwrap_or_default();
            own.retain(|name, _| named.contains(name));
            let says = format!("orders of {} schedules, {image}", named.len());
            let evidence = if own.len() < 2 {
                let lacks = |cell: &Cell| {
                    let schedule = cell.id.strip_prefix(&format!("{image}/")).unwrap_or(&cell.id);
                    named.contains(&schedule.to_string()) && !own.contains_key(schedule)
                };
                Evidence::lacking(Some(told.len() as f64), self.why_not(lacks))
            } else {
                Evidence::Orders { theirs: told.clone(), here: own, stopping: self.here.stopping }
            };
            (!told.is_empty()).then(|| self.unjudged(Kind::Order, says, evidence))
        };
        theirs.into_iter().filter_map(of_image).collect()
    }

    fn slopes(&self) -> Vec<Unjudged> {
        let here = self.here.slopes();
        let of_image = |(image, (theirs, seeds)): (ImageKey, (Option<Measured>, usize))| {
            // Points differ in samples and seeds.
            let says = format!("slope of RMSE, {}", image.to_string().replace("/0spp/seed0", ""));
            let why_not = || self.why_not(|cell| of_curve(cell.keys.0.clone()) == image);
            let evidence = match (theirs, here.get(&image)) {
                (None, _) => Evidence::of_theirs(seeds, FEWEST_SEEDS, "seed"),
                (Some(theirs), Some((Some(here), _))) => {
                    Evidence::Values { theirs, here: *here, limit: self.share * theirs.value.abs() }
                }
                (Some(theirs), Some((None, seeds))) => Evidence::of_few_here(theirs.value, *seeds, FEWEST_SEEDS),
                (Some(theirs), None) => Evidence::lacking(Some(theirs.value), why_not()),
            };
            self.unjudged(Kind::Slope, says, evidence)
        };
        self.theirs.slopes().into_iter().map(of_image).collect()
    }

    fn images(&self) -> Vec<Unjudged> {
        let [theirs, here] = [&self.theirs, &self.here].map(|rows| {
            let mut images = ImageBits::default();
            // A time limit ends each run at other samples.
            images.add(rows.measured.iter().filter(|row| row.time_limit_s.is_none()));
            images
        });
        let of_image = |(image, bits): (&ImageKey, SameBits)| {
            let says = format!("image {image}");
            let known = |verdict, note| Evidence::Known { theirs: None, verdict, note };
            let evidence = match bits {
                SameBits::Same => known(Reproduction::Reproduced, String::new()),
                SameBits::Other(note) => known(Reproduction::NotReproduced, note),
                SameBits::Lacking => {
                    let word = image.to_string();
                    let shows = |cell: &Cell| cell.points.iter().any(|point| point.image == word);
                    Evidence::lacking(None, self.why_not(shows))
                }
            };
            self.unjudged(Kind::Image, says, evidence)
        };
        here.beside(&theirs).map(of_image).collect()
    }

    /// Their cells that the definition does not have here, such as those with a thread for each of their processors.
    fn others(&self) -> Vec<Unjudged> {
        let points = self.cells.iter().flat_map(|cell| &cell.points);
        let known: HashSet<&str> = points.map(|point| point.id.as_str()).collect();
        let mut others: BTreeMap<Reproduction, BTreeSet<&str>> = BTreeMap::new();
        for row in self.theirs.measured.iter().filter(|row| !known.contains(row.cell.as_str())) {
            let without = || Reproduction::NotMeasured("this version of the program has no such cell".to_string());
            let verdict = more_than_here(row.threads, "thread").map_or_else(without, Reproduction::OtherHardware);
            others.entry(verdict).or_default().insert(&row.cell);
        }
        let of_reason = |(verdict, cells): (Reproduction, BTreeSet<&str>)| {
            let first = cells.first().copied().unwrap_or_default();
            let says = match cells.len() {
                1 => format!("cell {first}"),
                count => format!("{count} cells, such as {first}"),
            };
            self.unjudged(Kind::Cells, says, Evidence::lacking(None, verdict))
        };
        others.into_iter().map(of_reason).collect()
    }
}

/// The two cells of each comparison: the settings in which they differ, their scene, and the settings that keep apart
/// comparisons which would say the same.
fn told(pairs: &[[&Cell; 2]]) -> Vec<String> {
    let short = |[what, with]: &[&Cell; 2]| {
        let differing: Vec<&Setting> = SETTINGS.iter().filter(|own| what.shown(own) != with.shown(own)).collect();
        let of = |cell: &Cell| differing.iter().map(|own| cell.shown(own)).collect::<Vec<_>>().join(" ");
        format!("time of {} over {}, {}", of(what), of(with), what.settings.scene)
    };
    let said: Vec<String> = pairs.iter().map(short).collect();
    let mut alike: BTreeMap<&str, Vec<&Cell>> = BTreeMap::new();
    for (says, [what, _]) in said.iter().zip(pairs) {
        alike.entry(says).or_default().push(what);
    }
    let in_full = |(says, [what, with]): (&String, &[&Cell; 2])| {
        let others = &alike[says.as_str()];
        let apart = SETTINGS.iter().filter(|own| {
            let value = what.shown(own);
            value == with.shown(own) && others.iter().any(|other| other.shown(own) != value)
        });
        apart.fold(says.clone(), |says, own| format!("{says}, {} {}", own.name, what.shown(own)))
    };
    said.iter().zip(pairs).map(in_full).collect()
}

/// A fact about the machines: theirs, and the one here.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MachineFact {
    pub name: String,
    pub theirs: String,
    pub here: String,
}

/// The verdicts on all statements of a folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Replication {
    /// The folder of their rows, as the user gave it.
    pub theirs: String,
    /// Ratios and exponents that differ by less than this share count as equal.
    pub share: f64,
    /// Confidence that no verdict on a ratio, an order or a slope is wrong.
    pub joint_level: f64,
    /// Confidence of each interval.
    pub level: f64,
    pub machines: Vec<MachineFact>,
    pub statements: Vec<Statement>,
}

impl Replication {
    /// Judges the statements of all experiments together. `machines` are theirs and those of the rows here.
    pub fn of(theirs: &Path, share: f64, all: Vec<Statements>, machines: [&[Machine]; 2]) -> Self {
        let (statements, level) = judge_together(all.into_iter().flat_map(|Statements(own)| own).collect());
        Self {
            theirs: theirs.display().to_string(),
            share,
            joint_level: JOINT_LEVEL,
            level,
            machines: side_by_side(machines),
            statements,
        }
    }

    /// The versions of the program that measured their rows and those here, if they differ.
    pub fn versions(&self) -> Option<[&str; 2]> {
        let own = self.machines.iter().find(|fact| fact.name == SOURCES && fact.theirs != fact.here)?;
        Some([&own.theirs, &own.here])
    }

    /// The experiments with a ratio or an order that is not reproduced.
    pub fn with_other_times(&self) -> BTreeSet<String> {
        let own = self.statements.iter().filter(|own| own.is_timed() && own.verdict == Reproduction::NotReproduced);
        own.map(|own| own.experiment.clone()).collect()
    }

    /// Looks at a second measurement of some experiments here: the repetitions of one measurement follow each other so
    /// closely that all of them may be disturbed alike. A ratio stays *not reproduced* if the second measurement differs
    /// from theirs in the same direction by more than the margin, and an order if it is reversed there, too. So the
    /// second measurement takes verdicts back and adds none, and the joint level holds.
    pub fn confirm(&mut self, again: Vec<Statements>) {
        let (again, _) = judge_together(again.into_iter().flat_map(|Statements(own)| own).collect());
        // Both measurements have the statements of their rows, in the same order.
        let mut second: BTreeMap<String, VecDeque<Statement>> = BTreeMap::new();
        for own in again.into_iter().filter(Statement::is_timed) {
            second.entry(own.experiment.clone()).or_default().push_back(own);
        }
        let limit = 1.0 + self.share;
        for own in self.statements.iter_mut().filter(|own| own.is_timed()) {
            let Some(other) = second.get_mut(&own.experiment).and_then(VecDeque::pop_front) else { continue };
            if own.verdict != Reproduction::NotReproduced {
                continue;
            }
            let is_confirmed = match own.kind {
                Kind::Order => other.verdict == Reproduction::NotReproduced,
                _ => match [&*own, &other].map(Statement::here_over_theirs) {
                    [Some(first), Some(second)] if first > 1.0 => second > limit,
                    [Some(_), Some(second)] => second < 1.0 / limit,
                    _ => false,
                },
            };
            if !is_confirmed {
                own.verdict = Reproduction::CannotTell(None);
                let here = other.here.filter(|_| own.kind == Kind::Ratio).map(|here| format!(" ({here:.3})"));
                let said = format!("a second measurement here does not show it{}", here.unwrap_or_default());
                own.note = if own.note.is_empty() { said } else { format!("{}; {said}", own.note) };
            }
        }
    }

    pub fn write(&self, path: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).map_err(|e| Error::system("writing", path, e.into()))?;
        atomic_file::write(path, |file| file.write_all(format!("{text}\n").as_bytes()))
    }

    pub fn read(path: &Path) -> Result<Self> {
        serde_json::from_str(&read_text(path)?).map_err(|e| {
            let error = InputError::new("replication", "", format!("is not the result of a replication: {e}"));
            error.in_file(path.display().to_string(), Some((e.line(), e.column()))).into()
        })
    }
}

/// A fact of a machine and how it is told.
type Fact = (&'static str, fn(&Machine) -> String);

fn side_by_side(machines: [&[Machine]; 2]) -> Vec<MachineFact> {
    let facts: [Fact; 9] = [
        ("processor", |own| own.cpu.clone()),
        ("model", |own| own.cpu_model.clone()),
        ("instruction sets", |own| own.cpu_features.clone()),
        ("processors", |own| own.processors.to_string()),
        ("memory", |own| format!("{:.1} GiB", own.memory_bytes as f64 / f64::from(1 << 30))),
        ("system", |own| own.system.clone()),
        ("governor", |own| own.governor.clone()),
        ("compiler", |own| [own.rustc.as_str(), own.rustflags.as_str()].join(" ").trim().to_string()),
        (SOURCES, |own| format!("{}{}", own.commit, if own.dirty { " with changes" } else { "" })),
    ];
    let fact = |(name, of): Fact| {
        let [theirs, here] = machines.map(|all| {
            let values: BTreeSet<String> = all.iter().map(of).collect();
            values.into_iter().collect::<Vec<String>>().join("; ")
        });
        MachineFact { name: name.to_string(), theirs, here }
    };
    facts.into_iter().map(fact).collect()
}
