//! A render on disk that can go on: `render --checkpoint FILE`.
//!
//! Layout: [`crate::film_file::SumFile`], with the subtrees of the film ([`GrowingFilm::parts`]) as images. What it is of stands in its header, and
//! a file that is of anything else is refused, never overwritten. It is written between rounds, in one rename, so that a reader finds
//! one round or the next. Two renders cannot write one file: a lock file stands beside it as long as the render runs.

use super::{History, Position, Rounds, Setup};
use crate::error::{InputError, Result};
use crate::film::{GrowingFilm, sections};
use crate::film_file::{FilmKey, SumFile};
use crate::lock::Lock;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const FILE: SumFile = SumFile { magic: "pathmark checkpoint 2", field: "checkpoint" };

/// What a checkpoint says of itself.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    /// What the film is of, with the samples that it has.
    film: FilmKey,
    kernel: String,
    /// Seconds of rendering so far.
    rendering_s: f64,
    /// The accuracy that it is on its way to, and the samples at which that is looked at next.
    target_error: Option<f64>,
    look: u32,
    history: History,
}

/// A file for one render's checkpoints.
pub struct Checkpoint {
    path: PathBuf,
    _lock: Lock,
    target_error: Option<f64>,
}

/// Where an earlier process was.
pub struct Saved {
    /// Its film.
    pub film: GrowingFilm,
    /// How far it was.
    pub position: Position,
    /// What happened on the film's paths.
    pub history: History,
}

impl Checkpoint {
    /// Locks the file and reads it, if there is one. Refuses what is damaged, of another render, or being written by one.
    pub fn open(path: &Path, setup: &Setup, target_error: Option<f64>) -> Result<(Self, Option<Saved>)> {
        let refuse = |problem: &str| InputError::new(FILE.field, path.display().to_string(), problem);
        if !setup.is_deterministic() {
            let problem = format!("is of no use: {} gives other numbers in each run", setup.settings().spec.sampler);
            return Err(refuse(&problem).into());
        }
        let lock = Lock::of_file(path, FILE.field)?;
        let checkpoint = Self { path: path.to_path_buf(), _lock: lock, target_error };
        if !path.exists() {
            return Ok((checkpoint, None));
        }
        let images = |spp: u32| sections(&(0..spp)).len();
        let (header, films) =
            FILE.read(path, |header: &Header| (header.film.width, header.film.height, images(header.film.spp)))?;
        let mine = Header {
            film: FilmKey { spp: header.film.spp, ..setup.film_key() },
            kernel: setup.settings().spec.kernel.clone(),
            ..header.clone()
        };
        if let Some(difference) = difference(&header, &mine) {
            return Err(refuse(&format!("is of another render: {difference}"))
                .allowed("another name, or the same settings")
                .into());
        }
        let Header { film: FilmKey { width, height, spp, .. }, rendering_s, look, history, .. } = header;
        let parts = sections(&(0..spp)).into_iter().zip(films).collect();
        let film = GrowingFilm::from_parts(width, height, parts)
            .ok_or_else(|| refuse("does not have the samples that its header says"))?;
        // On the way to another accuracy, the next look is elsewhere.
        let look = if header.target_error == target_error { look } else { 0 };
        Ok((checkpoint, Some(Saved { film, position: Position { rendering_s, look }, history })))
    }

    /// Writes it, whole or not at all.
    pub fn save(&self, rounds: &Rounds, position: Position) -> Result<()> {
        let header = Header {
            film: rounds.film_key(),
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

/// The first field in which two headers differ.
fn difference(found: &Header, mine: &Header) -> Option<String> {
    let fields = |header: &Header| {
        let mut fields = vec![("kernel".to_string(), serde_json::Value::from(header.kernel.as_str()))];
        if let Ok(serde_json::Value::Object(film)) = serde_json::to_value(&header.film) {
            fields.extend(film);
        }
        fields
    };
    let differs = fields(found).into_iter().zip(fields(mine)).find(|(found, mine)| found != mine);
    differs.map(|((field, found), (_, mine))| format!("{field} is {found}, not {mine}"))
}
