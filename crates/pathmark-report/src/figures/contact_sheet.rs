//! Renders at growing spp beside their reference, with maps of their error and of its visibility.

use crate::image_io::Image;
use crate::metric::{Heatmap, flip_map, heatmap};
use crate::plot::ColourBar;
use crate::plot::number::short;
use crate::prelude::*;

pub(super) fn blocks(results: &Results) -> Result<Vec<Block>> {
    let Some(reference) = results.reference_image(None)? else {
        let text =
            "There is no contact sheet: the films of the references are not in the folder beside this experiment.";
        return Ok(vec![Block::notice(text)]);
    };
    let images = renders(results)?;
    let Some((_, noisiest)) = images.first() else { return Ok(Vec::new()) };
    // All maps share one scale, at which almost no pixel of the noisiest one is saturated.
    let scale = heatmap(noisiest, &reference, None)?.scale;
    let (mut pictures, mut errors, mut flips) = (Vec::new(), Vec::new(), Vec::new());
    for (record, image) in &images {
        let seconds = record.makespan_s.map_or_else(String::new, |s| format!("time {} s", short(s, 3)));
        pictures.push(Cell::of(image, vec![format!("{} spp", record.spp), seconds])?);
        let rmse = record.rmse.map_or_else(String::new, |rmse| format!("RMSE {}", short(rmse, 3)));
        errors.push(Some(map(&heatmap(image, &reference, Some(scale))?, &["error".to_string(), rmse])));
        let (flip, flips_map) = flip_map(image, &reference)?;
        flips.push(Some(map(&flips_map, &["FLIP".to_string(), format!("mean {flip:.3}")])));
    }
    pictures.push(Cell::of(&reference, vec!["reference".to_string(), "mean of two halves".to_string()])?);
    let crops: Vec<Option<Cell>> = pictures.iter().map(Cell::crop).collect();
    let step = pictures[0].step();
    let reduced = format!("; the whole images show 1 of {step}x{step} pixels");
    errors.push(None);
    flips.push(None);
    let (estimator, schedule) = (&images[0].0.estimator, images[0].0.schedule.label());
    let has_crops = crops.iter().any(Option::is_some);
    let pictures: Vec<Option<Cell>> = pictures.into_iter().map(Some).collect();
    let rows = std::iter::once(pictures).chain(has_crops.then_some(crops)).chain([errors, flips]).collect();
    let sheet = ContactSheet {
        title: format!("Renders at growing samples per pixel ({estimator}; seconds by {schedule})"),
        subtitle: results.workload() + if step > 1 { &reduced } else { "" },
        rows,
        bars: vec![
            ColourBar { label: "error of a pixel, linear radiance".to_string(), full: scale, is_largest: false },
            ColourBar { label: "FLIP: how large the difference looks".to_string(), full: 1.0, is_largest: true },
        ],
        comparison: Comparison::Steps,
    };
    Ok(vec![Block::sheet("contact-sheet", &sheet)?])
}

fn map(map: &Heatmap, caption: &[String; 2]) -> Cell {
    Cell { caption: caption.to_vec(), width: map.width, height: map.height, rgb: map.pixels.concat() }
}

/// The kept image of each spp, of the first estimator and the lowest seed, with its record. All are by the schedule
/// that rendered most of them, because the sheet compares their seconds.
fn renders(results: &Results) -> Result<Vec<(&Row, Image)>> {
    let first = results.definition.first_estimator();
    let of_first = results.rows().filter(|row| row.estimator == first && row.repetition == 0);
    let spp_of = |rows: &[&Row]| rows.iter().map(|row| row.spp).collect::<BTreeSet<_>>().len();
    let schedules = group(of_first, |row| &row.schedule).into_iter().rev();
    let Some((schedule, _)) = schedules.max_by_key(|(_, rows)| spp_of(rows)) else { return Ok(Vec::new()) };
    let mut by_spp: BTreeMap<u32, (&Row, Image)> = BTreeMap::new();
    for (record, image) in results.kept_images(|row| row.estimator == first && row.schedule == *schedule)? {
        if by_spp.get(&record.spp).is_none_or(|(known, _)| record.seed < known.seed) {
            by_spp.insert(record.spp, (record, image));
        }
    }
    Ok(by_spp.into_values().collect())
}
