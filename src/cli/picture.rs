//! Pictures that verbs are given: image files, and film files of references and checkpoints.

use crate::error::{InputError, Result};
use crate::film_file::{FilmKey, read_film};
use crate::image_io::{self, Image};
use std::path::Path;

/// A picture, and what it is of where its file knows.
pub(super) fn read(path: &Path) -> Result<(Image, Option<FilmKey>)> {
    let is_film = path.extension().is_some_and(|extension| extension == "film");
    if is_film && !path.exists() {
        return Err(InputError::new("image", path.display().to_string(), "there is no such file").into());
    }
    if is_film && path.is_file() {
        let (key, film) = read_film(path)?;
        return Ok((film.image(), Some(key)));
    }
    Ok((image_io::read(path)?, None))
}
