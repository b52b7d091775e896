//! A render on disk that can continue: `render --checkpoint FILE`.
//!
//! Layout: [`crate::film_file::SumFile`], with the subtrees of the film ([`ProgressiveFilm::parts`]) as images. The header
//! identifies the render; a file of any other render is refused, never overwritten. The file is written between rounds,
//! in one rename, so that a reader finds one round or the next. Two renders cannot write one file: a lock file stands
//! beside it as long as the render runs.

use super::{History, Position, Rounds};
use crate::error::{InputError, Result};
use crate::film::{Film, ProgressiveFilm, Shard, check_size, sections};
use crate::film_file::{FilmKey, SumFile};
use crate::lock::Lock;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::{Path, PathBuf};

const FILE: SumFile = SumFile { magic: "pathmark checkpoint 2", field: "checkpoint" };

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Part {
    pub(super) shard: Shard,
    /// Samples per pixel of the whole image.
    pub(super) spp: u32,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    /// The key of the film, with the number of its samples.
    pub(super) film: FilmKey,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) part: Option<Part>,
    pub(super) kernel: String,
    rendering_s: f64,
    /// The target accuracy, and the samples at the next look.
    target_error: Option<f64>,
    look: u32,
    pub(super) history: History,
}

impl Header {
    pub(super) fn samples(&self) -> Range<u32> {
        let FilmKey { width, height, spp, .. } = self.film;
        let start = match self.part {
            // For an impossible size, or more shards than there can be, nothing is read, let alone allocated.
            Some(part)
                if check_size(width, height).and_then(|()| part.shard.check(width, height, part.spp)).is_ok() =>
            {
                part.shard.samples(part.spp).start
            }
            _ => 0,
        };
        start..spp
    }

    fn shape(&self) -> (u32, u32, usize) {
        (self.film.width, self.film.height, sections(&self.samples()).len())
    }

    /// Reads the header of a file that is as long as its header says.
    pub(super) fn of(path: &Path) -> Result<Self> {
        FILE.header(path, Self::shape)
    }

    pub(super) fn read(path: &Path) -> Result<(Self, ProgressiveFilm)> {
        let (header, films): (Self, Vec<Film>) = FILE.read(path, Self::shape)?;
        let parts = sections(&header.samples()).into_iter().zip(films).collect();
        let FilmKey { width, height, spp, .. } = header.film;
        let owns = |x, y| header.part.is_none_or(|part| part.shard.owns(x, y));
        let film = ProgressiveFilm::from_parts(width, height, parts, owns).filter(|film| film.spp() == spp);
        let film = film.ok_or_else(|| refused(path, "does not contain the samples that its header states"))?;
        Ok((header, film))
    }
}

fn refused(path: &Path, problem: &str) -> InputError {
    InputError::new(FILE.field, path.display().to_string(), problem)
}

pub struct Checkpoint {
    path: PathBuf,
    _lock: Lock,
    target_error: Option<f64>,
}

pub struct Saved {
    pub film: ProgressiveFilm,
    pub position: Position,
    pub history: History,
}

impl Checkpoint {
    /// Locks the file and reads it, if it exists. Refuses a file that is damaged, of another render, or in use by a
    /// render.
    pub fn open(path: &Path, rounds: &Rounds, target_error: Option<f64>) -> Result<(Self, Option<Saved>)> {
        let setup = rounds.setup();
        if !setup.is_deterministic() {
            let problem =
                format!("cannot be used: {} draws different random numbers in each run", setup.settings().spec.sampler);
            return Err(refused(path, &problem).into());
        }
        let lock = Lock::of_file(path, FILE.field)?;
        let checkpoint = Self { path: path.to_path_buf(), _lock: lock, target_error };
        if !path.exists() {
            return Ok((checkpoint, None));
        }
        let (found, film) = Header::read(path)?;
        let mine = Header {
            film: FilmKey { spp: found.film.spp, ..setup.film_key() },
            part: part_of(rounds),
            ..found.clone()
        };
        if let Some(difference) = difference(&found, &mine) {
            return Err(refused(path, &format!("belongs to another render: {difference}"))
                .allowed("another name, or the same settings")
                .into());
        }
        let Header { rendering_s, look, history, target_error: found, .. } = found;
        // With another target accuracy, the next look is elsewhere.
        let look = if found == target_error { look } else { 0 };
        Ok((checkpoint, Some(Saved { film, position: Position { rendering_s, look }, history })))
    }

    pub fn save(&self, rounds: &Rounds, position: Position) -> Result<()> {
        let header = Header {
            film: rounds.film_key(),
            part: part_of(rounds),
            kernel: rounds.setup().settings().spec.kernel.clone(),
            rendering_s: position.rendering_s,
            target_error: self.target_error,
            look: position.look,
            history: rounds.history().clone(),
        };
        let films: Vec<_> = rounds.growing().parts().iter().map(|(_, film)| film).collect();
        FILE.write(&self.path, &header, &films)
    }
}

fn part_of(rounds: &Rounds) -> Option<Part> {
    rounds.shard().map(|shard| Part { shard, spp: rounds.setup().settings().spp })
}

/// The first field in which two headers differ, apart from their progress.
pub(super) fn difference(found: &Header, mine: &Header) -> Option<String> {
    let fields = |header: &Header| {
        let part = header.part.map(|Part { shard, spp }| format!("{shard} by {} of {spp} spp", shard.cut()));
        // The kernel is not compared: in the same precision all kernels give the same bits.
        let mut fields = vec![("shard".to_string(), serde_json::Value::from(part))];
        if let Ok(serde_json::Value::Object(film)) = serde_json::to_value(&header.film) {
            fields.extend(film);
        }
        fields
    };
    let differs = fields(found).into_iter().zip(fields(mine)).find(|(found, mine)| found != mine);
    differs.map(|((field, found), (_, mine))| format!("{field} is {found}, not {mine}"))
}
