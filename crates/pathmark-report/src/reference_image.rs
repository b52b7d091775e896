//! The reference image that the errors of an experiment are measured against.

use super::results::Results;
use crate::error::Result;
use crate::experiment::wanted_references;
use crate::film_file::read_film;
use crate::image_io::Image;
use std::collections::BTreeSet;

/// The mean of the two half-references of a scene, by the name that rows have for it, or of the first scene; `None` if their files are missing, as in a
/// copied folder.
pub(super) fn reference_image(results: &Results, scene: Option<&str>) -> Result<Option<Image>> {
    let profile = results.profile();
    let cells = results.definition.cells(profile)?;
    let hashes: Option<BTreeSet<&str>> =
        scene.map(|scene| results.rows().filter(|row| row.scene == scene).map(|row| row.scene_hash.as_str()).collect());
    let Some(wanted) = wanted_references(&results.definition, profile, &cells)?
        .into_iter()
        .find(|wanted| hashes.as_ref().is_none_or(|hashes| hashes.iter().any(|hash| wanted.is_of(hash))))
    else {
        return Ok(None);
    };
    let [first, second] = wanted.paths(&results.definition.lab, &results.out.join("references"))?;
    if !(first.is_file() && second.is_file()) {
        return Ok(None);
    }
    let ((_, first), (_, second)) = (read_film(&first)?, read_film(&second)?);
    let mut image = first.image();
    for (pixel, other) in image.pixels.iter_mut().zip(second.image().pixels) {
        *pixel = std::array::from_fn(|channel| 0.5 * (pixel[channel] + other[channel]));
    }
    Ok(Some(image))
}
