//! Images of each estimator and sampler after about the same time.

use crate::experiment::EXTERNAL;
use crate::image_io::Image;
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Some(scene) = results.first().map(|row| row.scene.clone()) else { return Ok(Vec::new()) };
    let order = results.definition.estimator_names();
    let place = |record: &Row| order.iter().position(|name| *name == record.estimator).unwrap_or(order.len());
    let mut kept: BTreeMap<(usize, String), Vec<(&Row, Image)>> = BTreeMap::new();
    for (record, image) in results.kept_images(|record| record.scene == scene && record.makespan_s.is_some())? {
        let sampler = if record.sampler == EXTERNAL { String::new() } else { format!(" + {}", record.sampler) };
        let name = format!("{}{sampler}", record.estimator);
        kept.entry((place(record), name)).or_default().push((record, image));
    }
    let seconds = |record: &Row| record.makespan_s.unwrap_or(0.0);
    let longest = |images: &Vec<(&Row, Image)>| images.iter().map(|(record, _)| seconds(record)).reduce(f64::max);
    let Some(time) = kept.values().filter_map(longest).reduce(f64::min) else {
        return Ok(vec![Block::notice("There are no images side by side: this experiment kept none.")]);
    };
    let distance = |record: &Row| (libm::log(seconds(record) / time)).abs();
    let mut cells = Vec::new();
    for ((_, name), images) in &kept {
        let Some((record, image)) = images.iter().min_by(|a, b| distance(a.0).total_cmp(&distance(b.0))) else {
            continue;
        };
        let error = record.rmse.map_or_else(String::new, |rmse| format!("RMSE {rmse:.4}, "));
        let caption = vec![name.clone(), format!("{error}{} spp, {:.2} s", record.spp, seconds(record))];
        cells.push(Cell::of(image, caption)?);
    }
    if let Some(reference) = results.reference_image(Some(&scene))? {
        cells.push(Cell::of(&reference, vec!["reference".to_string(), "mean of two halves".to_string()])?);
    }
    let title = format!("{scene} after about {time:.2} s");
    let subtitle = "Of each curve the point that is nearest in time; neighbouring points differ by a factor of two. Values above 1 are white.";
    let sheet = ContactSheet::grid(title, subtitle.to_string(), cells, Comparison::Wipe);
    Ok(vec![Block::sheet("equal-time", &sheet)?])
}
