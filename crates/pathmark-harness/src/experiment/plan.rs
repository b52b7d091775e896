//! The plan of a sweep before it starts: rows, bytes, and seconds estimated by a short pilot.
//!
//! The pilot renders each kind of image once, on one thread and at a small size, to measure the time of a sample. A
//! cell's time is its samples times that, divided by the processors that its threads can use. This assumes an ideal
//! speedup and ignores the overhead of schedules. Threads that draw from one generator wait for each other, so the pilot
//! of such a cell has its schedule.

use super::cell::Cell;
use super::pairs::{LONG_S, affordable};
use super::sweep::Sweep;
use super::{Keep, Reference};
use crate::error::Result;
use crate::kernel::Spec;
use crate::lab::Lab;
use crate::measure::{Settings, available_threads, batch_runs};
use crate::sampling::is_deterministic;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::time::Instant;

const RENDER_S: f64 = 0.01;
/// Seconds after which no other kind is rendered.
const MOST_S: f64 = 10.0;
/// Columns of the pilot's images: enough paths at a time for the lanes.
const WIDTH: u32 = 64;
/// Seconds of a row besides rendering: starting its process and checking its image.
const ROW_S: f64 = 0.03;
/// Bytes of a row, of a job in a trace, of a pixel in an image, and of a pixel in the film of a reference.
const BYTES: [u64; 4] = [760, 60, 12, 52];

/// The estimated cost of a sweep, from its first row to its last.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plan {
    pub name: String,
    pub cells: usize,
    pub rows: usize,
    /// Estimated seconds of the references that are neither in an earlier plan nor in the cache.
    pub references_s: f64,
    pub halves: usize,
    pub cells_s: f64,
    /// Estimated bytes of rows, traces, images and references, without figures.
    pub bytes: u64,
}

impl Plan {
    pub fn seconds(&self) -> f64 {
        self.references_s + self.cells_s
    }
}

/// The times of samples that the pilot measured, and the references that have been planned.
pub struct Prices<'a> {
    lab: &'a Lab,
    begun: Instant,
    kinds: HashMap<Settings, f64>,
    /// Number of kinds that were not rendered for lack of time; the mean of the others stands for them.
    pub guessed: usize,
    planned: HashSet<PathBuf>,
}

impl<'a> Prices<'a> {
    pub fn new(lab: &'a Lab) -> Self {
        Self { lab, begun: Instant::now(), kinds: HashMap::new(), guessed: 0, planned: HashSet::new() }
    }

    pub fn kinds(&self) -> usize {
        self.kinds.len()
    }

    /// Seconds of a sample of these settings on one processor.
    fn sample_s(&mut self, settings: &Settings) -> Result<f64> {
        let kind = pilot(settings);
        if let Some(seconds) = self.kinds.get(&kind) {
            return Ok(*seconds);
        }
        let seconds = if self.begun.elapsed().as_secs_f64() < MOST_S {
            self.measure(&kind, settings.spp)?
        } else {
            self.guessed += 1;
            self.kinds.values().sum::<f64>() / self.kinds.len().max(1) as f64
        };
        self.kinds.insert(kind, seconds);
        Ok(seconds)
    }

    /// Renders a kind of image and returns the seconds of a sample on one processor; `spp` is a number of samples that it can
    /// have.
    fn measure(&self, kind: &Settings, spp: u32) -> Result<f64> {
        let with = |spp: u32| self.lab.prepare(Settings { spp, ..kind.clone() });
        let processors = kind.threads.min(available_threads()) as f64;
        let samples = |spp: u32| f64::from(kind.spec.width) * f64::from(kind.spec.height) * f64::from(spp) / processors;
        let fewest = with(spp)?.fewest_spp();
        let setup = with(fewest)?;
        // Without the GPU that it needs, a cell renders nothing.
        if setup.scene().is_some_and(|(_, choice)| choice.plan.lacks_device()) {
            return Ok(0.0);
        }
        // The first run of a setup builds its kernel, and the first of a process is slower than the rest.
        setup.run(None)?;
        let once_s = setup.run(None)?.makespan_s;
        let times = (RENDER_S / once_s).clamp(1.0, 64.0) as u32;
        if times == 1 {
            return Ok(once_s / samples(fewest));
        }
        Ok(with(fewest * times)?.run(None)?.makespan_s / samples(fewest * times))
    }

    /// Adds the halves of a reference that are neither cached nor in an earlier plan.
    fn add_reference(&mut self, reference: &Reference, folder: &Path, plan: &mut Plan) -> Result<()> {
        let pixels = u64::from(reference.size[0]) * u64::from(reference.size[1]);
        for (half, path) in reference.paths(self.lab, folder)?.into_iter().enumerate() {
            if path.is_file() || !self.planned.insert(path) {
                continue;
            }
            let setup = reference.half(self.lab, half as u32)?;
            let samples = pixels as f64 * f64::from(reference.spp);
            plan.references_s += samples * self.sample_s(setup.settings())? / available_threads() as f64;
            plan.halves += 1;
            plan.bytes += pixels * BYTES[3];
        }
        Ok(())
    }
}

/// The image of these settings at the pilot's size, on one thread, without seed and samples; equal for cells of one
/// kind.
fn small(settings: &Settings) -> Settings {
    let spec = &settings.spec;
    let height = (u64::from(WIDTH) * u64::from(spec.height)).div_ceil(u64::from(spec.width).max(1));
    let spec = Spec { width: WIDTH, height: height.clamp(1, 4 * u64::from(WIDTH)) as u32, seed: 0, ..spec.clone() };
    let schedule = Settings { strategy: "serial".to_string(), threads: 1, ..Settings::default() };
    Settings { scene: settings.scene.clone(), spp: 0, spec, ..schedule }
}

/// The run that tells the time of a cell's samples: [`small`], and with a generator that threads share, by the cell's schedule.
fn pilot(settings: &Settings) -> Settings {
    let kind = small(settings);
    if is_deterministic(&settings.spec.sampler) || settings.ranks.is_some() {
        return kind;
    }
    let Settings { strategy, decomposition, threads, .. } = settings.clone();
    Settings { strategy, decomposition, threads, ..kind }
}

impl Sweep<'_> {
    /// Estimates the cost of the sweep. Other programs have no price, so their seconds are not included.
    pub fn plan(&self, prices: &mut Prices<'_>) -> Result<Plan> {
        let (definition, options) = (self.definition, self.options);
        let repetitions = self.repetitions()?;
        let mut plan = Plan { name: definition.name.clone(), cells: self.cells.len(), ..Plan::default() };
        let folder = options.out.join("references");
        for reference in &self.references {
            prices.add_reference(reference, &folder, &mut plan)?;
        }
        let mut images = HashSet::new();
        let side_by_side: HashSet<usize> = self.comparisons.groups(self.cells.len()).into_iter().flatten().collect();
        for (index, cell) in self.cells.iter().enumerate() {
            let repetitions = cell.repetitions(repetitions);
            let run_s =
                if cell.external.is_none() { cell.weight as f64 * prices.sample_s(&cell.settings)? } else { 0.0 };
            let run_s = cell.settings.time_limit_s.map_or(run_s, |limit| run_s.min(limit.into()));
            // A process of pairs runs its cell once before it counts, unless that takes long.
            let (rows, runs) = if side_by_side.contains(&index) {
                let pairs = affordable(self.pairs()?, run_s);
                (pairs, pairs * batch_runs(run_s, cell.settings.is_serial()) + u32::from(run_s < LONG_S))
            } else {
                (1, 1)
            };
            plan.rows += cell.points.len() * (repetitions * rows) as usize;
            if cell.external.is_none() {
                plan.cells_s += (run_s * f64::from(runs) + ROW_S) * f64::from(repetitions);
            }
            if definition.keeps(Keep::Traces) && cell.external.is_none() {
                plan.bytes +=
                    prices.lab.prepare(cell.settings.clone())?.jobs() as u64 * BYTES[1] * u64::from(repetitions);
            }
            if definition.keeps(Keep::Images) {
                images.extend(cell.points.iter().map(|point| (point.image.as_str(), pixels(cell))));
            }
        }
        if let Some(max_time) = self.until.as_ref().and_then(|until| until.max_time) {
            let share = (max_time.as_secs_f64() / plan.cells_s).min(1.0);
            plan.cells_s *= share;
            plan.rows = (plan.rows as f64 * share).ceil() as usize;
        }
        plan.bytes += plan.rows as u64 * BYTES[0];
        plan.bytes += images.iter().map(|(_, pixels)| pixels * BYTES[2]).sum::<u64>();
        Ok(plan)
    }
}

fn pixels(cell: &Cell) -> u64 {
    u64::from(cell.settings.spec.width) * u64::from(cell.settings.spec.height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::{Definition, Options};
    use crate::files::Files;

    /// Threads wait for a generator that they share, which one thread alone would not show.
    #[test]
    fn a_shared_generator_is_tried_with_the_threads_of_its_cell() {
        let of = |sampler: &str, ranks: Option<u16>| {
            let spec = Spec { sampler: sampler.to_string(), ..Spec::default() };
            let schedule = Settings { strategy: "pool".to_string(), threads: 5, ranks, ..Settings::default() };
            let found = pilot(&Settings { spec, ..schedule });
            (found.strategy, found.threads)
        };
        assert_eq!(of("locked", None), ("pool".to_string(), 5));
        for alone in [of("independent", None), of("locked", Some(2))] {
            assert_eq!(alone, ("serial".to_string(), 1));
        }
    }

    /// A machine without the GPU that a cell needs can plan it, as it can run it.
    #[test]
    fn a_cell_for_a_device_has_a_plan_on_every_machine() {
        let text = "title = \"t\"\nquestion = \"q\"\nfigures = []\n[matrix]\nscene = [\"cornell\"]\nspp = [4]\nstrategy = [\"serial\"]\nthreads = [1]\ndecomposition = [\"rows\"]\nkernel = [\"device\"]\n";
        let lab = Lab::built_in();
        let definition = Definition::from_text(&lab, "x", "x.toml", text).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let options = Options { out: folder.path().to_path_buf(), ..Options::default() };
        let sweep = Sweep::new(&definition, &options, &mut Files::default()).unwrap();
        let plan = sweep.plan(&mut Prices::new(&lab)).unwrap();
        assert_eq!((plan.cells, plan.rows), (1, 6));
    }
}
