//! The gallery: an image of every scene, with the effects that the scene needs.

use crate::image_io::Image;
use crate::prelude::*;
use crate::scene::{effect_names, load};

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    // If a scene was rendered more than once, take the image with the most samples.
    let mut scenes: BTreeMap<&str, (&Row, Image)> = BTreeMap::new();
    for (record, image) in results.kept_images(|_| true)? {
        if scenes.get(record.scene.as_str()).is_none_or(|(known, _)| record.spp > known.spp) {
            scenes.insert(&record.scene, (record, image));
        }
    }
    if scenes.is_empty() {
        return Ok(vec![Block::notice("There is no gallery: this experiment kept no images.")]);
    }
    let cells = scenes.values().map(|(record, image)| cell(record, image)).collect::<Result<Vec<Cell>>>()?;
    let title = format!("{} scenes", cells.len());
    let subtitle = "Below each name: what the scene calls for, and the profile that its kernel is compiled for. Values above 1 are white.";
    let sheet = ContactSheet::grid(title, subtitle.to_string(), cells, Comparison::Single);
    Ok(vec![Block::sheet("gallery", &sheet)?])
}

fn cell(record: &Row, image: &Image) -> Result<Cell> {
    // A user's scene file may have been deleted or changed since.
    let scene = load(&record.scene).ok().filter(|scene| scene.hash == record.scene_hash);
    let mut caption = vec![record.scene.clone()];
    caption.extend(scene.iter().map(|scene| scene.about.clone()));
    let calls =
        scene.map_or_else(String::new, |scene| format!("{}; ", effect_names(scene.effects()).replace('+', ", ")));
    caption.push(format!("{calls}profile {}; estimator {}; {} spp", record.effects, record.estimator, record.spp));
    Cell::of(image, caption)
}
