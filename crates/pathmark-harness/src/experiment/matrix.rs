//! The axes of an experiment and the cells that they span.

use super::definition::FEATURES;
use super::processes::check_processes;
use super::table::{Matrix, Scale, TIME_LIMIT};
use super::{Cell, Definition, Profile};
use crate::error::{Error, InputError, Result};
use crate::measure::{ImageKey, Kind, LARGEST_SEED, SETTINGS, ScheduleKey, Setting, Settings, Setup};
use crate::sampling::{SAMPLERS, is_deterministic};
use std::collections::{HashMap, HashSet};
use std::path::Path;

const FITTING: &str = "fitting";

/// Most cells of a sweep: checking and comparing more takes minutes before the first one runs.
pub(super) const LARGEST_CELLS: u64 = 10_000;
pub const LARGEST_REPETITIONS: u32 = 10_000;

/// Distinct cells. Two words may mean the same run, such as `fitting` and the name of the profile that fits a scene; a
/// point that two curves share is kept once.
#[derive(Default)]
struct Cells {
    list: Vec<Cell>,
    places: HashMap<String, usize>,
    known: HashSet<(ImageKey, ScheduleKey)>,
}

impl Cells {
    /// Adds the points of a setup's cell that are not there yet.
    fn add(&mut self, setup: &Setup, is_curve: bool, at_most: Option<u32>) {
        let cell = if is_curve { Cell::curve(setup) } else { Cell::new(setup) };
        let mut cell = Cell { at_most, ..cell };
        // If two matrices have the cell, the larger number of repetitions counts.
        if let Some(known) = self.places.get(&cell.id).map(|place| &mut self.list[*place]) {
            known.at_most = known.at_most.zip(at_most).map(|(first, second)| first.max(second));
        }
        let (image, schedule) = (setup.image_key(), setup.schedule_key());
        let known = &mut self.known;
        cell.points.retain(|point| known.insert((ImageKey { spp: point.spp, ..image.clone() }, schedule.clone())));
        if !cell.points.is_empty() {
            self.places.entry(cell.id.clone()).or_insert(self.list.len());
            self.list.push(cell);
        }
    }
}

impl Definition {
    /// The cells, each once, in the order of the matrix. Every cell is checked, so no error of the definition can
    /// appear later.
    pub fn cells(&self, profile: Profile) -> Result<Vec<Cell>> {
        let repetitions = self.repetitions(profile)?;
        if !(1..=LARGEST_REPETITIONS).contains(&repetitions) {
            let error = InputError::new("repetitions", repetitions.to_string(), "is out of range");
            return Err(self.located(profile, error.allowed(format!("1 to {LARGEST_REPETITIONS}"))));
        }
        if let Some(unknown) = self.requires.iter().find(|name| !FEATURES.iter().any(|(known, _)| known == name)) {
            let names: Vec<&str> = FEATURES.iter().map(|(name, _)| *name).collect();
            let error = InputError::new("requires", unknown, "there is no feature of that name");
            return Err(self.located(profile, error.allowed(names.join(", "))));
        }
        let mut cells = Cells::default();
        let mut combinations = 0_u64;
        for matrix in self.matrices(profile) {
            let product = Product { definition: self, profile, scale: self.scale(profile)?, matrix };
            product.check_axes()?;
            product.check_time_limit()?;
            product.check_combinations(&mut combinations)?;
            product.add(&SETTINGS, &Settings::default(), &mut cells)?;
        }
        cells.list.extend(self.external_cells(profile)?);
        Ok(cells.list)
    }

    /// The path of a scene file, which is relative to the experiment that uses it; other names stay unchanged.
    fn scene_path(&self, scene: &str) -> String {
        let beside = Path::new(&self.file).parent().map(|folder| folder.join(scene));
        match beside {
            Some(path) if path.extension().is_some_and(|e| e == "toml") && path.is_file() => path.display().to_string(),
            _ => scene.to_string(),
        }
    }
}

struct Product<'a> {
    definition: &'a Definition,
    profile: Profile,
    scale: &'a Scale,
    matrix: &'a Matrix,
}

impl<'a> Product<'a> {
    fn at_field(&self, error: Error) -> Error {
        error.placed(|input| self.definition.located(self.profile, input))
    }

    /// The values of an axis as they are written. A profile's values replace the matrix's, except the size, where the
    /// matrix's own come first.
    fn written(&self, axis: &Setting) -> Option<&'a Vec<String>> {
        let (own, scale) = (self.matrix.values(axis.name), self.scale.values(axis.name));
        if axis.name == "size" { own.or(scale) } else { scale.or(own) }
    }

    /// Refuses axes without a value, except the bounce limit, which may have none.
    fn check_axes(&self) -> Result<()> {
        let is_empty = |axis: &&Setting| self.written(axis).is_some_and(Vec::is_empty) && axis.name != "max-depth";
        let problem = "has no values, so there is nothing to run";
        SETTINGS.iter().find(is_empty).map_or(Ok(()), |axis| {
            Err(self.at_field(InputError::new(axis.name, "[]", problem).allowed("at least one value").into()))
        })
    }

    /// Refuses, beside a time limit, what fixes the number of samples: a curve, several `spp`, or processes that share the
    /// samples in advance.
    fn check_time_limit(&self) -> Result<()> {
        let count = |name| Setting::named(name).map_or(0, |axis| self.values(axis).count());
        if count(TIME_LIMIT) == 0 {
            return Ok(());
        }
        let spps = count("spp");
        let conflicts = [
            (self.matrix.curve, "curve", "true".to_string(), "false, or no time-limit"),
            (spps > 1, "spp", format!("{spps} values"), "one value, the most samples per pixel"),
            (count("ranks") > 0, "ranks", "processes".to_string(), "no ranks, or no time-limit"),
        ];
        conflicts.into_iter().find(|(is_there, ..)| *is_there).map_or(Ok(()), |(_, field, value, allowed)| {
            let problem = "fixes the samples, but a time limit ends the render";
            Err(self.at_field(InputError::new(field, value, problem).allowed(allowed).into()))
        })
    }

    /// The values of an axis, one of which may stand for all that there are.
    fn values(&self, axis: &Setting) -> impl Iterator<Item = String> {
        self.written(axis).into_iter().flatten().flat_map(|value| match axis.all {
            Some(all) if value == "all" => all(&self.definition.lab),
            _ => vec![value.clone()],
        })
    }

    /// Adds the number of combinations to those of earlier matrices, and refuses too many. The axis with the most values
    /// is named.
    fn check_combinations(&self, sum: &mut u64) -> Result<()> {
        let counts: Vec<u64> = SETTINGS.iter().map(|axis| (self.values(axis).count() as u64).max(1)).collect();
        *sum = counts.iter().fold(1_u64, |product, count| product.saturating_mul(*count)).saturating_add(*sum);
        let longest = SETTINGS.iter().zip(&counts).max_by_key(|(_, count)| **count);
        let Some((axis, count)) = longest.filter(|_| *sum > LARGEST_CELLS) else { return Ok(()) };
        let problem = format!("the matrices have {sum} combinations of their values, of which each is a cell");
        let error = InputError::new(axis.name, format!("{count} values"), problem);
        Err(self.at_field(error.allowed(format!("at most {LARGEST_CELLS} combinations")).into()))
    }

    fn add(&self, axes: &[Setting], settings: &Settings, cells: &mut Cells) -> Result<()> {
        let Some((axis, inner)) = axes.split_first() else { return self.add_cell(settings.clone(), cells) };
        if self.written(axis).is_none_or(Vec::is_empty) {
            let mut settings = settings.clone();
            if axis.name == "estimator" {
                settings.spec.estimator = self.own_estimator(&settings.scene)?;
            }
            return self.add(inner, &settings, cells);
        }
        for value in self.values(axis) {
            let mut settings = settings.clone();
            if axis.kind != Kind::Auto || value != FITTING {
                axis.set(&mut settings, &value)?;
            }
            match axis.name {
                "scene" => settings.scene = self.definition.scene_path(&value),
                "estimator" if value == "default" => settings.spec.estimator = self.own_estimator(&settings.scene)?,
                _ => {}
            }
            self.add(inner, &settings, cells)?;
        }
        Ok(())
    }

    /// The estimator that a scene names; empty for a workload.
    fn own_estimator(&self, scene: &str) -> Result<String> {
        let lab = &self.definition.lab;
        if lab.workload_named(scene).is_some() {
            return Ok(String::new());
        }
        let scene = lab.load_scene(scene).map_err(|error| self.at_field(error))?;
        Ok(scene.estimator().to_string())
    }

    fn add_cell(&self, mut settings: Settings, cells: &mut Cells) -> Result<()> {
        self.check_sampler(&settings.spec.sampler)?;
        if settings.spec.seed > LARGEST_SEED {
            let error = InputError::new("seed", settings.spec.seed.to_string(), "is reserved for references");
            return Err(self.at_field(error.allowed(format!("0 to {LARGEST_SEED}")).into()));
        }
        if self.matrix.weak {
            settings.spp =
                settings.spp.saturating_mul(u32::try_from(settings.workers(settings.threads)).unwrap_or(u32::MAX));
        }
        let setup = self.definition.lab.prepare(settings).map_err(|error| self.at_field(error))?;
        check_processes(&setup).map_err(|error| self.at_field(error))?;
        if self.matrix.curve || setup.settings().time_limit_s.is_some() {
            setup.check_rounds().map_err(|error| self.at_field(error))?;
        }
        let at_most = self.matrix.at_most.filter(|most| *most < self.scale.repetitions);
        cells.add(&setup, self.matrix.curve, at_most);
        Ok(())
    }

    /// Refuses a sampler that gives other checksums in each run, unless the definition is `unverified`: rows of one
    /// image are compared by checksum.
    fn check_sampler(&self, sampler: &str) -> Result<()> {
        let is_known = SAMPLERS.iter().any(|entry| entry.name == sampler);
        if self.definition.unverified || is_deterministic(sampler) || !is_known {
            return Ok(());
        }
        let problem = "draws different random numbers in each run, but the experiment compares checksums";
        let names: Vec<&str> = SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
        let allowed = format!("{}; or unverified = true in the definition", names.join(", "));
        Err(self.at_field(InputError::new("sampler", sampler, problem).allowed(allowed).into()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Lab;

    /// A definition of two matrices, which have these lines besides the axes that none can leave out.
    fn defined(first: &str, second: &str) -> Definition {
        let matrix = |own: &str| {
            let axes =
                "scene = [\"cornell\"]\nspp = [4]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]";
            format!("[[matrix]]\n{axes}\n{own}\n")
        };
        let head = "title = \"t\"\nquestion = \"q\"\nfigures = []\n";
        let text = format!("{head}{}{}[quick]\nrepetitions = 5\n[full]", matrix(first), matrix(second));
        Definition::from_text(&Lab::built_in(), "x", "x.toml", &text).unwrap()
    }

    fn limits(first: &str, second: &str) -> Vec<Option<u32>> {
        defined(first, second).cells(Profile::Quick).unwrap().into_iter().map(|cell| cell.at_most).collect()
    }

    /// A case that a search through all cells for each cell would slow down: two matrices with the same thousands of
    /// cells give each of them once.
    #[test]
    fn cells_of_two_large_matrices_are_found_again() {
        let seeds: Vec<u32> = (0..3000).collect();
        let own = |repetitions: u32| format!("seed = {seeds:?}\nrepetitions = {repetitions}");
        assert_eq!(limits(&own(2), &own(3)), vec![Some(3); 3000]);
    }

    /// If two matrices have a cell, the larger number of repetitions counts. A limit that is not below the profile's
    /// repetitions is none.
    #[test]
    fn a_cell_has_the_repetitions_of_the_matrix_that_gives_it_most() {
        assert_eq!(limits("repetitions = 2", "repetitions = 3"), [Some(3)]);
        assert_eq!(limits("repetitions = 3", "repetitions = 2"), [Some(3)]);
        assert_eq!((limits("repetitions = 2", ""), limits("", "repetitions = 2")), (vec![None], vec![None]));
        assert_eq!(limits("repetitions = 2", "repetitions = 5"), [None]);
    }

    #[test]
    fn a_matrix_is_for_the_profiles_that_it_names() {
        let found = defined("seed = [1, 2]\nprofiles = [\"full\"]", "seed = [3]");
        let count = |profile| found.cells(profile).unwrap().len();
        assert_eq!((count(Profile::Quick), count(Profile::Full)), (1, 3));
    }
}
