//! Scenes that add effects one by one: each beside its neighbour, by time and by image.

use super::kernels::any_kernel;
use crate::image_io::Image;
use crate::prelude::*;

/// A scene and the one before it.
struct Step<'a> {
    before: &'a str,
    scene: &'a str,
    /// The time of a sample over that of the scene before, by kernel.
    ratios: Vec<Option<Ratio>>,
    changed: Option<Changed>,
    mean: Option<f64>,
}

/// The difference of two images of each seed.
struct Changed {
    /// The share of pixels that differ in any bit for any seed: those of which a path met the effect.
    pixels: f64,
    /// Root mean square of the difference of expectations; `None` if it is lost in the noise.
    rmse: Option<f64>,
}

/// The kernels that are compared. One that falls back to another has no ratio.
const KERNELS: [&str; 2] = ["scalar", "lanes"];

pub(super) fn blocks(results: &Results, scenes: &[String]) -> Result<Vec<Block>> {
    let rows = results.rows().filter(|row| scenes.contains(&row.scene));
    let by_scene = group(rows, |row| row.scene.as_str());
    let images = images(results, scenes)?;
    let pairs: Vec<(&str, &str)> = scenes.windows(2).map(|pair| (pair[0].as_str(), pair[1].as_str())).collect();
    let times = |scene: &str, kernel: &str| {
        let own = by_scene.get(scene).into_iter().flatten().copied();
        let own = own.filter(|row| row.kernel == kernel && row.kernel_fallback.is_empty());
        Repeats::means(own, another_scene, |row| Some(row.cpu_s()? / row.samples? as f64))
    };
    let cells = pairs.iter().flat_map(|(before, scene)| {
        KERNELS.map(|kernel| ((*scene, kernel), times(scene, kernel).over(&times(before, kernel))))
    });
    let ratios: BTreeMap<(&str, &str), Ratio> = ratios_of_groups(cells, results.stopping()).into_iter().collect();
    let steps: Vec<Step<'_>> = pairs
        .into_iter()
        .map(|(before, scene)| Step {
            before,
            scene,
            ratios: KERNELS.map(|kernel| ratios.get(&(scene, kernel)).copied()).to_vec(),
            changed: changed(images.get(before), images.get(scene)),
            mean: typical(by_scene.get(scene).into_iter().flatten(), |row| row.mean_radiance),
        })
        .collect();
    if !steps.iter().any(|step| step.ratios.iter().any(Option::is_some)) {
        return Ok(Vec::new());
    }
    let dots =
        |step: &Step<'_>| step.ratios.iter().map(|ratio| ratio.map(|ratio| Estimated::from(ratio).dot())).collect();
    let axis = Axis::linear("processor time of a sample / in the scene above").including([0.95, 1.05]);
    let rows = steps.iter().map(|step| DotRow::new(step.scene, dots(step))).collect();
    let most = titles::largest_above_1(steps.iter().filter_map(|step| Some((step.scene, step.ratios[0]?))));
    let result = most.map_or_else(
        || "No added effect makes a sample take longer beyond the noise".to_string(),
        |(scene, ratio)| format!("{scene} adds the most: a sample takes {}", titles::longer(ratio.value)),
    );
    let title = Title::new("Effects added one by one").with_result(Some(result));
    let mut plot = DotPlot::new(title, axis, rows).grouped(KERNELS);
    plot.guides = vec![(1.0, "as long".to_string())];
    plot.subtitle = results.workload();
    plot.caption = format!(
        "From {}. {} A kernel without code for an effect has no dot.",
        scenes[0],
        ratio_bars(steps.iter().flat_map(|step| step.ratios.iter().flatten().copied()))
    );
    let table = Block::table("effect-steps", "Effects added one by one", &steps)
        .column("scene", |step| step.scene.to_string())
        .column("beside", |step| step.before.to_string())
        .estimated("time, scalar", Decimals(3), |step| step.ratios[0].map(Estimated::from))
        .estimated("time, lanes", Decimals(3), |step| step.ratios[1].map(Estimated::from))
        .number("processes", Decimals(0), |step| step.ratios[0].and_then(|ratio| ratio.count).map(|count| count as f64))
        .number("mean radiance", Significant(4), |step| step.mean)
        .number("pixels that differ, %", Decimals(1), |step| step.changed.as_ref().map(|found| 100.0 * found.pixels))
        .number("RMSE to the scene beside, without noise", Significant(3), |step| {
            step.changed.as_ref().and_then(|found| found.rmse)
        })
        .end();
    Ok(vec![Block::figure("effect-steps", plot), table])
}

/// Keeps seed and size, but neither the scene nor the choices that fit it.
fn another_scene(image: &mut ImageKey, schedule: &mut ScheduleKey) {
    any_kernel(image, schedule);
    image.forget_scene();
}

/// The kept images of each scene, by seed. All kernels render the same one.
fn images(results: &Results, scenes: &[String]) -> Result<BTreeMap<String, BTreeMap<u64, Image>>> {
    let mut found: BTreeMap<String, BTreeMap<u64, Image>> = BTreeMap::new();
    for (row, image) in results.kept_images(|row| scenes.contains(&row.scene))? {
        found.entry(row.scene.clone()).or_default().entry(row.seed).or_insert(image);
    }
    Ok(found)
}

/// The mean over pairs of seeds of (A - B) (A' - B'): noise of different seeds is independent, so it has no part in the mean.
fn changed(before: Option<&BTreeMap<u64, Image>>, after: Option<&BTreeMap<u64, Image>>) -> Option<Changed> {
    let (before, after) = (before?, after?);
    let pairs = before.iter().filter_map(|(seed, image)| Some((image, after.get(seed)?)));
    let differences: Vec<Vec<f64>> = pairs.filter_map(|(a, b)| difference(a, b)).collect();
    let first = differences.first()?;
    let is_changed = |at: &usize| differences.iter().any(|own| own.get(*at).is_some_and(|value| *value != 0.0));
    let pixels = (0..first.len() / 3).filter(|pixel| (3 * pixel..3 * pixel + 3).any(|at| is_changed(&at))).count();
    let mut products = Vec::new();
    for (index, own) in differences.iter().enumerate() {
        for other in &differences[index + 1..] {
            products.push(own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>() / own.len() as f64);
        }
    }
    let mean = products.iter().sum::<f64>() / products.len() as f64;
    Some(Changed { pixels: 3.0 * pixels as f64 / first.len() as f64, rmse: (mean > 0.0).then(|| mean.sqrt()) })
}

fn difference(before: &Image, after: &Image) -> Option<Vec<f64>> {
    let (before, after) = (before.pixels.as_flattened(), after.pixels.as_flattened());
    (before.len() == after.len()).then(|| before.iter().zip(after).map(|(a, b)| b - a).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(values: impl Iterator<Item = f64>) -> Image {
        let pixels: Vec<[f64; 3]> = values.map(|value| [value; 3]).collect();
        Image { width: pixels.len() as u32, height: 1, pixels }
    }

    /// One pixel of four becomes brighter by .5: an RMSE of .25. The noise of each seed, ±.1, differs between both images and
    /// cancels in the mean of products.
    #[test]
    fn noise_has_no_part_in_what_changed() {
        let noise = [[0.1, -0.1, 0.1, -0.1], [0.1, 0.1, -0.1, -0.1]];
        let of = |seed: usize, more: f64| {
            image((0..4).map(|k| 1.0 + if k == 0 { more } else { 0.0 } + noise[seed][k] * more))
        };
        let both = |more: f64| (0..2).map(|seed| (seed as u64, of(seed, more))).collect::<BTreeMap<u64, Image>>();
        let found = changed(Some(&both(0.0)), Some(&both(0.5))).unwrap();
        // Products: (.55 .55), (-.05 .05), (.05 -.05), (-.05 -.05).
        let exact = (0.3025_f64 - 0.0025 - 0.0025 + 0.0025) / 4.0;
        assert!((found.rmse.unwrap() - exact.sqrt()).abs() < 1e-12 && found.pixels == 1.0, "{:?}", found.rmse);
        let same = changed(Some(&both(0.5)), Some(&both(0.5))).unwrap();
        assert!(same.rmse.is_none() && same.pixels == 0.0);
        assert!(changed(None, Some(&both(0.5))).is_none());
    }
}
