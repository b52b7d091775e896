//! What every scene looks like, and what it calls for.

use crate::error::Result;
use crate::image_io::Image;
use crate::image_io::tone_map::quantise_image;
use crate::measure::Record;
use crate::plot::{Cell, ContactSheet};
use crate::report::block::Block;
use crate::report::results::Results;
use crate::scene::{effect_names, load};
use std::collections::BTreeMap;

/// Images beside each other: so many fit the page.
const COLUMNS: usize = 4;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    // Where a scene was rendered more than once, the image with the most samples.
    let mut scenes: BTreeMap<&str, (&Record, Image)> = BTreeMap::new();
    for (record, image) in results.kept_images(|_| true)? {
        if scenes.get(record.scene.as_str()).is_none_or(|(known, _)| record.spp > known.spp) {
            scenes.insert(&record.scene, (record, image));
        }
    }
    if scenes.is_empty() {
        return Ok(vec![Block::Finding("There is no gallery: this experiment kept no images.".to_string())]);
    }
    let mut cells = Vec::new();
    for (record, image) in scenes.values() {
        cells.push(Some(cell(record, image)?));
    }
    let title = format!("{} scenes", cells.len());
    let sheet = ContactSheet {
        title: title.clone(),
        subtitle: "Below each name: what the scene calls for, and the profile that its kernel is compiled for. Values above 1 are white."
            .to_string(),
        rows: cells.chunks(COLUMNS).map(<[Option<Cell>]>::to_vec).collect(),
        bar: None,
    };
    Ok(vec![Block::Picture { stem: "gallery", title, png: sheet.png()? }])
}

fn cell(record: &Record, image: &Image) -> Result<Cell> {
    // A scene of the user's own may have gone since.
    let scene = load(&record.scene).ok().filter(|scene| scene.hash == record.scene_hash);
    let mut caption = vec![record.scene.clone()];
    caption.extend(scene.iter().map(|scene| scene.about.clone()));
    let calls =
        scene.map_or_else(String::new, |scene| format!("{}; ", effect_names(scene.effects()).replace('+', ", ")));
    caption.push(format!("{calls}profile {}; estimator {}; {} spp", record.effects, record.estimator, record.spp));
    Ok(Cell { caption, width: image.width, height: image.height, rgb: quantise_image(image)? })
}
