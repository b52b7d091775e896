//! The reference image that the errors of an experiment are measured against.

use super::results::Results;
use crate::error::Result;
use crate::experiment::wanted_references;
use crate::film_file::read_film;
use crate::image_io::Image;

/// The mean of the two half-references of a scene, or of the first scene; `None` if their files are missing, as in a
/// copied folder.
pub(super) fn reference_image(results: &Results, scene: Option<&str>) -> Result<Option<Image>> {
    let profile = results.profile();
    let cells = results.definition.cells(profile)?;
    let Some(wanted) = wanted_references(&results.definition, profile, &cells)?
        .into_iter()
        .find(|wanted| scene.is_none_or(|scene| wanted.scene == scene))
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
