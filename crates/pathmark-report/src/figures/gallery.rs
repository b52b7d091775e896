//! The gallery: an image of every scene, with the effects that the scene needs.

use crate::image_io::Image;
use crate::prelude::*;
use crate::scene::{Scene, effect_names, load};

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
    let mut scenes: Vec<(&Row, Image)> = scenes.into_values().collect();
    scenes.sort_by_key(|(record, _)| by_numbers(&record.scene));
    let cells = scenes.iter().map(|(record, image)| {
        let samples = format!("{}, {} spp", record.estimator, record.spp);
        Cell::of(image, vec![record.scene.clone(), samples])
    });
    let cells = cells.collect::<Result<Vec<Cell>>>()?;
    let title = counted(cells.len(), "scene");
    let subtitle = "Below each name the estimator and its samples per pixel. Values above 1 are white.".to_string();
    let sheet = ContactSheet::groups(title, subtitle, vec![cells], Comparison::Single);
    let table = Block::table("gallery", "Scenes", scenes.iter().map(|(record, _)| *record))
        .column("scene", |record| record.scene.clone())
        .column("shows", |record| shown(record).map_or_else(String::new, |scene| scene.about))
        .column("calls for", |record| {
            shown(record).map_or_else(String::new, |scene| effect_names(scene.effects()).replace('+', ", "))
        })
        .column("profile of its kernel", |record| record.effects.clone())
        .end();
    Ok(vec![Block::sheet("gallery", &sheet)?, table])
}

/// The scene of a row; `None` if a user's file was deleted or changed since.
fn shown(record: &Row) -> Option<Scene> {
    load(&record.scene).ok().filter(|scene| scene.hash == record.scene_hash)
}

/// A name in parts that sort its numbers by their values: `kd-ks-25` comes before `kd-ks-100`.
fn by_numbers(name: &str) -> Vec<(u64, String)> {
    let parts = name.split('-').map(|part| match part.parse() {
        Ok(number) => (number, String::new()),
        Err(_) => (0, part.to_string()),
    });
    parts.collect()
}

#[cfg(test)]
mod tests {
    use super::by_numbers;

    #[test]
    fn numbers_in_names_sort_by_their_values() {
        let mut names = ["kd-ks-100", "kd-ks-25-vndf", "kd-ks-0", "cornell", "kd-ks-50", "kd-ks-25"];
        names.sort_by_key(|name| by_numbers(name));
        assert_eq!(names, ["cornell", "kd-ks-0", "kd-ks-25", "kd-ks-25-vndf", "kd-ks-50", "kd-ks-100"]);
    }
}
