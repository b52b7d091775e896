//! Pictures as input of verbs: image files, and film files of references and checkpoints.

use crate::error::{InputError, Result};
use crate::film_file::read_film;
use crate::image_io::{self, Image};
use crate::measure::Provenance;
use std::path::Path;

/// Whether the file is named as a film, which keeps sums in full precision.
pub(in crate::verbs) fn is_film(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "film")
}

/// Reads a picture, and its provenance if the file has it.
pub(in crate::verbs) fn read(path: &Path) -> Result<(Image, Option<Provenance>)> {
    let is_film = is_film(path);
    if is_film && !path.exists() {
        return Err(InputError::new("image", path.display().to_string(), "there is no such file").into());
    }
    if is_film && path.is_file() {
        let (key, film) = read_film(path)?;
        let checksum = Some(film.checksum());
        return Ok((film.image(), Some(Provenance { key, checksum })));
    }
    let (image, notes) = image_io::read_with_notes(path)?;
    Ok((image, Provenance::of_notes(&notes)))
}
