//! The gallery: an image of every scene, with the effects that the scene needs.

use crate::image_io::Image;
use crate::prelude::*;
use crate::scene::{effect_names, load};

/// The most images in a row that fit on the page.
const COLUMNS: usize = 4;

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
    let mut cells = Vec::new();
    for (record, image) in scenes.values() {
        cells.push(Some(cell(record, image)?));
    }
    let sheet = ContactSheet {
        title: format!("{} scenes", cells.len()),
        subtitle: "Below each name: what the scene calls for, and the profile that its kernel is compiled for. Values above 1 are white."
            .to_string(),
        rows: cells.chunks(COLUMNS).map(<[Option<Cell>]>::to_vec).collect(),
        bars: Vec::new(),
        comparison: Comparison::Single,
    };
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
