//! References: two independent halves against which images are measured, from seeds that no image under test can have.
//!
//! With two halves R₁ and R₂ the mean of (T - R₁)(T - R₂) is the image's squared error without the references' own noise
//! (docs/notes/errors.md: cross form).
//!
//! A film of 16 · 2^k samples is one subtree of its pixels' sums, so a longer film of the same half can continue from
//! it with the same bits. Long renders save such films on the way, so that a killed render does not start anew.

use super::{Cell, Definition, Profile, Progress, SceneVersion};
use crate::atomic_file;
use crate::error::{Error, InputError, Result};
use crate::film::{Film, ProgressiveFilm, SAMPLE_BLOCK};
use crate::film_file::{FilmKey, read_film, write_film};
use crate::kernel::Spec;
use crate::lab::Lab;
use crate::lock::{Lock, Sharing};
use crate::measure::{History, LARGEST_SPP, Rounds, Settings, Setup, available_threads};
use crate::sampling::{REFERENCE_SEEDS, SAMPLERS, is_deterministic};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::path::{Path, PathBuf};

/// The seed of a half: above every seed that an image may have.
pub fn reference_seed(half: u32) -> u64 {
    REFERENCE_SEEDS + u64::from(half)
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reference {
    pub scene: String,
    /// The required version of the scene; any version, if `None`.
    pub version: Option<SceneVersion>,
    pub estimator: String,
    pub sampler: String,
    pub size: [u32; 2],
    pub spp: u32,
}

/// A half on disk, as it was when the experiment began.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct HalfFile {
    pub path: PathBuf,
    pub checksum: String,
}

fn reference_path(folder: &Path, key: &FilmKey) -> PathBuf {
    let half = key.seed - REFERENCE_SEEDS;
    folder.join(format!(
        "{}-{}-{}-{}-{}x{}-{}spp-r{}-half{half}.film",
        key.scene, key.scene_hash, key.estimator, key.sampler, key.width, key.height, key.spp, key.revision
    ))
}

impl Reference {
    pub(super) fn half(&self, lab: &Lab, half: u32) -> Result<Setup> {
        let settings = Settings {
            scene: self.scene.clone(),
            spp: self.spp,
            spec: Spec {
                width: self.size[0],
                height: self.size[1],
                seed: reference_seed(half),
                estimator: self.estimator.clone(),
                sampler: self.sampler.clone(),
                ..Spec::default()
            },
            decomposition: "tiles:16x16".to_string(),
            strategy: "work-stealing".to_string(),
            threads: available_threads(),
            ..Settings::default()
        };
        let setup = lab.prepare(settings)?;
        self.version.as_ref().map_or(Ok(()), |version| version.check(&setup.hash()))?;
        Ok(setup)
    }

    /// Refuses a reference that cannot be rendered, before any file is made.
    pub fn check(&self, lab: &Lab) -> Result<()> {
        if !is_deterministic(&self.sampler) {
            let problem = "draws different random numbers in each run, but a reference must be reproducible";
            let names: Vec<&str> =
                SAMPLERS.iter().filter(|entry| entry.deterministic).map(|entry| entry.name).collect();
            return Err(InputError::new("sampler", &self.sampler, problem).allowed(names.join(", ")).into());
        }
        self.half(lab, 0).map(|_| ())
    }

    pub fn paths(&self, lab: &Lab, folder: &Path) -> Result<[PathBuf; 2]> {
        let path = |half| -> Result<PathBuf> { Ok(reference_path(folder, &self.half(lab, half)?.film_key())) };
        Ok([path(0)?, path(1)?])
    }

    /// Whether images of this cell are measured against this reference: a scene is the same under each of its names.
    pub(super) fn is_for(&self, cell: &Cell) -> bool {
        let spec = &cell.settings.spec;
        self.is_of(&cell.scene.hash) && self.size == [spec.width, spec.height]
    }

    pub fn is_of(&self, scene_hash: &str) -> bool {
        self.version.as_ref().is_some_and(|version| version.hash == scene_hash)
    }

    /// Refuses names that no file can have, and a damaged film in the cache. Such a film is never replaced: it may be
    /// the user's only copy.
    pub fn check_cache(&self, lab: &Lab, folder: &Path) -> Result<()> {
        for path in self.paths(lab, folder)? {
            atomic_file::check_name(&path)?;
            if path.is_file() {
                read_film(&path)?;
            }
        }
        Ok(())
    }
}

/// The references that an experiment's cells need: one for each scene and size.
pub fn wanted_references(definition: &Definition, profile: Profile, cells: &[Cell]) -> Result<Vec<Reference>> {
    let Some((estimator, spp)) = definition.reference(profile)? else { return Ok(Vec::new()) };
    let mut wanted: Vec<Reference> = Vec::new();
    for cell in cells {
        let settings = &cell.settings;
        if !wanted.iter().any(|reference| reference.is_for(cell)) {
            wanted.push(Reference {
                scene: settings.scene.clone(),
                version: Some(cell.scene.clone()),
                estimator: estimator.clone(),
                sampler: "independent".to_string(),
                size: [settings.spec.width, settings.spec.height],
                spp,
            });
        }
    }
    Ok(wanted)
}

/// Returns the two halves, each read from the cache in `folder` if it is there, and rendered otherwise.
pub fn render_reference(
    lab: &Lab,
    reference: &Reference,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<[(PathBuf, Film); 2]> {
    let mut halves = [Half::new(lab, reference, 0, folder)?, Half::new(lab, reference, 1, folder)?];
    let are_cached = halves.iter().all(|half| half.path(reference.spp).is_file());
    // Cached halves are only read, so they may lie on a read-only disk, which allows no lock.
    let _lock = if are_cached { None } else { Some(lock(folder)?) };
    let [first, second] = &mut halves;
    Ok([first.render(reference.spp, progress)?, second.render(reference.spp, progress)?])
}

/// Locks the folder: two processes in it would remove each other's intermediate films.
fn lock(folder: &Path) -> Result<Lock> {
    Lock::of_folder(folder, "references", Sharing::Alone)
}

/// Seconds of rendering that may be lost when the program is killed.
const MOST_LOST_S: f64 = 20.0;

struct Half<'a> {
    rounds: Rounds,
    index: u32,
    folder: &'a Path,
}

impl<'a> Half<'a> {
    fn new(lab: &Lab, reference: &Reference, index: u32, folder: &'a Path) -> Result<Self> {
        Ok(Self { rounds: Rounds::new(reference.half(lab, index)?)?, index, folder })
    }

    fn key(&self, spp: u32) -> FilmKey {
        FilmKey { spp, ..self.rounds.film_key() }
    }

    fn path(&self, spp: u32) -> PathBuf {
        reference_path(self.folder, &self.key(spp))
    }

    fn cached(&self, spp: u32) -> Result<Option<Film>> {
        let path = self.path(spp);
        if !path.is_file() {
            return Ok(None);
        }
        // A damaged file is an error and is never replaced: it may be the user's only copy.
        let (found, film) = read_film(&path)?;
        Ok((found == self.key(spp)).then_some(film))
    }

    /// Continues from the longest cached film that is the beginning of one with `spp` samples.
    fn adopt_beginning(&mut self, spp: u32) -> Result<()> {
        let FilmKey { width, height, spp: done, .. } = self.rounds.film_key();
        for samples in subtrees().rev().filter(|samples| (done + 1..spp).contains(samples)) {
            let parts = self.cached(samples)?.map(|film| vec![(0..samples, film)]);
            let film = parts.and_then(|parts| ProgressiveFilm::from_parts(width, height, parts, |_, _| true));
            if let Some(film) = film {
                self.rounds.adopt(film, History::default());
                break;
            }
        }
        Ok(())
    }

    fn render(&mut self, spp: u32, progress: &dyn Progress) -> Result<(PathBuf, Film)> {
        let path = self.path(spp);
        if let Some(film) = self.cached(spp)? {
            return Ok((path, film));
        }
        self.adopt_beginning(spp)?;
        let title = format!("reference {} of 2: {} at {spp} spp", self.index + 1, self.rounds.setup().name());
        progress.begin(&title, u64::from(spp));
        let (mut unsaved_s, mut stone) = (0.0, None);
        while self.rounds.spp() < spp {
            let done = self.rounds.spp();
            progress.advance(u64::from(done));
            let next = subtrees().find(|samples| *samples > done).map_or(spp, |samples| samples.min(spp));
            unsaved_s += self.rounds.extend_to(next, None)?.makespan_s;
            if next < spp && unsaved_s > MOST_LOST_S {
                write_film(&self.path(next), &self.key(next), &self.rounds.film())?;
                remove(stone.replace(self.path(next)))?;
                unsaved_s = 0.0;
            }
        }
        progress.end();
        let film = self.rounds.film();
        write_film(&path, &self.key(spp), &film)?;
        remove(stone)?;
        Ok((path, film))
    }
}

/// Numbers of samples that form one subtree of a pixel's sum, and that every estimator can render.
fn subtrees() -> impl DoubleEndedIterator<Item = u32> {
    (0..=(LARGEST_SPP / SAMPLE_BLOCK).ilog2()).map(|k| SAMPLE_BLOCK << k)
}

fn remove(stone: Option<PathBuf>) -> Result<()> {
    let Some(path) = stone else { return Ok(()) };
    std::fs::remove_file(&path).map_err(|e| Error::system("removing", &path, e))
}

/// The RMSE of the average of two halves, estimated in two ways.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReferenceError {
    /// By the variance of its samples. Too large if they are stratified or of low discrepancy.
    pub by_variance: f64,
    /// By the difference of the halves, whose mean square is four times the mean squared error of their average. Makes
    /// no assumption about how samples are drawn.
    pub by_difference: f64,
}

impl ReferenceError {
    pub fn of(first: &Film, second: &Film) -> Self {
        let (a, b) = (first.image(), second.image());
        let pairs = a.pixels.as_flattened().iter().zip(b.pixels.as_flattened());
        let mean = pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / (3 * a.pixels.len()) as f64;
        let variance = first.mean_variance() + second.mean_variance();
        Self { by_variance: (variance / 4.0).sqrt(), by_difference: (mean / 4.0).sqrt() }
    }

    pub fn worse(&self) -> f64 {
        self.by_variance.max(self.by_difference)
    }
}

impl fmt::Display for ReferenceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { by_variance, by_difference } = self;
        write!(f, "estimated RMSE of their average: {by_variance:.3e} by variance, {by_difference:.3e} by difference")
    }
}

pub fn check_until(rmse: f64) -> Result<()> {
    if rmse.is_finite() && rmse > 0.0 {
        return Ok(());
    }
    let error = InputError::new("until", rmse.to_string(), "must be a positive number");
    Err(error.allowed("finite numbers above 0").into())
}

/// Doubles the samples of both halves until the larger estimate of their average's error is at most `rmse`. Starts with
/// cached films, and removes intermediate films that this run made.
pub fn refine_reference(
    lab: &Lab,
    reference: &Reference,
    rmse: f64,
    folder: &Path,
    progress: &dyn Progress,
) -> Result<[(PathBuf, Film); 2]> {
    let _lock = lock(folder)?;
    let mut first = Half::new(lab, reference, 0, folder)?;
    let mut second = Half::new(lab, reference, 1, folder)?;
    let longest = subtrees().rev().find(|spp| first.path(*spp).is_file() && second.path(*spp).is_file());
    let mut made: Vec<PathBuf> = Vec::new();
    for spp in subtrees().filter(|spp| longest.is_none_or(|longest| *spp >= longest)) {
        let new = [first.path(spp), second.path(spp)].into_iter().filter(|path| !path.is_file()).collect();
        let halves = [first.render(spp, progress)?, second.render(spp, progress)?];
        for path in std::mem::replace(&mut made, new) {
            remove(Some(path))?;
        }
        let error = ReferenceError::of(&halves[0].1, &halves[1].1);
        progress.note(&format!("{spp} spp: {error}"));
        if error.worse() <= rmse {
            return Ok(halves);
        }
    }
    let error = InputError::new("until", rmse.to_string(), "needs more samples than an image can have");
    Err(error.allowed(format!("errors that {LARGEST_SPP} samples per pixel can reach")).into())
}
