//! The renders at growing spp beside their reference, and where they are wrong.

use crate::error::Result;
use crate::image_io::Image;
use crate::image_io::tone_map::quantise_image;
use crate::measure::Record;
use crate::metric::heatmap;
use crate::plot::{Cell, ColourBar, ContactSheet};
use crate::report::block::Block;
use crate::report::reference_image::reference_image;
use crate::report::results::Results;
use std::collections::BTreeMap;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Some(reference) = reference_image(results, None)? else {
        let text =
            "There is no contact sheet: the films of the references are not in the folder beside this experiment.";
        return Ok(vec![Block::Finding(text.to_string())]);
    };
    let images = renders(results)?;
    let Some((_, noisiest)) = images.first() else { return Ok(Vec::new()) };
    // One scale for all maps: a level at which the noisiest one is not yet saturated.
    let scale = heatmap(noisiest, &reference, None)?.scale;
    let (mut pictures, mut maps) = (Vec::new(), Vec::new());
    for (record, image) in &images {
        let rmse = record.rmse.map_or_else(String::new, |rmse| format!("RMSE {rmse:.4}"));
        pictures.push(Some(cell(image, vec![format!("{} spp", record.spp), rmse])?));
        let map = heatmap(image, &reference, Some(scale))?;
        let caption = vec!["error".to_string(), record.makespan_s.map_or_else(String::new, |s| format!("{s:.2} s"))];
        let rgb = map.pixels.concat();
        maps.push(Some(Cell { caption, width: map.width, height: map.height, rgb }));
    }
    pictures.push(Some(cell(&reference, vec!["reference".to_string(), "mean of two halves".to_string()])?));
    maps.push(None);
    let estimator = images.first().map_or("", |(record, _)| record.estimator.as_str());
    let title = format!("Renders at growing samples per pixel ({estimator})");
    let sheet = ContactSheet {
        title: title.clone(),
        subtitle: results.workload(),
        rows: vec![pictures, maps],
        bar: Some(ColourBar { label: "error of a pixel, linear radiance".to_string(), full: scale }),
    };
    Ok(vec![Block::Picture { stem: "contact-sheet", title, png: sheet.png()? }])
}

fn cell(image: &Image, caption: Vec<String>) -> Result<Cell> {
    Ok(Cell { caption, width: image.width, height: image.height, rgb: quantise_image(image)? })
}

/// The kept image of each spp, of the first estimator and the lowest seed, with its record.
fn renders(results: &Results) -> Result<Vec<(&Record, Image)>> {
    let first = results.definition.first_estimator();
    let mut by_spp: BTreeMap<u32, (&Record, Image)> = BTreeMap::new();
    for (record, image) in results.kept_images(|record| record.estimator == first)? {
        if by_spp.get(&record.spp).is_none_or(|(known, _)| record.seed < known.seed) {
            by_spp.insert(record.spp, (record, image));
        }
    }
    Ok(by_spp.into_values().collect())
}
