//! `pathmark inspect rays SCENE`: rays per second of the search for the first hit, along the rays of paths.

use crate::analysis::quantile::{median, median_interval};
use crate::atomic_file;
use crate::experiment::LARGEST_REPETITIONS;
use crate::kernel::{FoundRays, RaySearch, Start, path_rays};
use crate::math::Vec3;
use crate::plot::number::short;
use crate::scene::Scene;
use crate::verbs::prelude::*;
use crate::verbs::setting_options::{Samples, no_paths};
use clap::value_parser;
use std::io::{self, Write};
use std::time::Instant;

/// `pathmark inspect rays bumpy-ball:20000 --precision f32`
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    samples: Samples,
    /// Number of searches along all rays, on one thread
    #[arg(long, value_name = "N", default_value_t = 9, value_parser = value_parser!(u32).range(1..=i64::from(LARGEST_REPETITIONS)))]
    repetitions: u32,
    /// Write the triangles and the rays for another program: a line of text, then 64-bit numbers
    #[arg(long, value_name = "FILE")]
    export: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Confidence of the interval around the median, if there are enough repetitions.
const LEVEL: f64 = 0.95;

pub(super) fn run(arguments: &Arguments, lab: &Arc<Lab>, console: &Console) -> Result<()> {
    let setup = arguments.samples.prepare(lab, console)?;
    let Some((scene, choice)) = setup.scene() else { return Err(no_paths(&arguments.samples.scene)) };
    check_paths(&setup)?;
    let mut files = Files::default();
    files.reads_scene(setup.files());
    if let Some(path) = &arguments.export {
        files.writes("export", path)?;
        if scene.primitives.triangles.len() != scene.owners.len() {
            let problem = "has spheres or planes, which the exported file cannot hold";
            return Err(InputError::new("scene", &scene.name, problem).allowed("a scene of triangles").into());
        }
    }
    console.begin(&format!("paths of {}", scene.name), 1);
    let rays = path_rays(scene, choice, &(0..arguments.samples.spp))?;
    console.end();
    if let Some(path) = &arguments.export {
        atomic_file::write(path, |file| export(scene, &rays, file))?;
    }
    let search = RaySearch::new(scene, choice, rays)?;
    let found = search.run();
    let rates: Vec<f64> = (0..arguments.repetitions)
        .map(|_| {
            let begin = Instant::now();
            let again = search.run();
            let seconds = begin.elapsed().as_secs_f64();
            assert_eq!(again, found, "a search finds what it found before");
            search.count() as f64 / seconds
        })
        .collect();
    let rate = median(&rates).unwrap_or(f64::NAN);
    let interval = median_interval(&rates, LEVEL);
    let FoundRays { met, distance, counts } = found;
    let each = |count: u64| count as f64 / (search.count() as f64).max(1.0);
    let (boxes, primitives) = (each(counts.box_tests), each(counts.primitive_tests));
    let (kernel, simd, precision) = (choice.plan.name(), choice.plan.simd(), choice.plan.precision().name());
    if arguments.json {
        return print_json(&json!({
            "scene": scene.name, "primitives": scene.owners.len(), "rays": search.count(), "met": met, "distance": number(distance),
            "kernel": kernel, "simd": simd, "precision": precision, "accelerator": choice.accelerator.name,
            "box_tests": counts.box_tests, "primitive_tests": counts.primitive_tests,
            "rays_per_s": rates, "median_rays_per_s": number(rate),
        }));
    }
    let spread = interval.map_or_else(String::new, |interval| {
        let [low, high] = [interval.low, interval.high].map(|rate| short(1e-6 * rate, 3));
        format!(", {} % interval {low} to {high}", interval.percent())
    });
    print(&format!(
        "{}, {} primitives: {} rays from vertex to vertex of {} paths\n\
         kernel {kernel}{}{simd}, {precision}, accelerator {}: {boxes:.1} box tests and {primitives:.1} primitive tests per ray\n\
         {} million rays per second on one thread (median of {}{spread})\n\
         {met} rays hit something, at a mean distance of {}",
        scene.name,
        scene.owners.len(),
        search.count(),
        choice.estimator.name,
        if simd.is_empty() { "" } else { " " },
        choice.accelerator.name,
        short(1e-6 * rate, 3),
        rates.len(),
        short(distance / (met as f64).max(1.0), 6),
    ))
}

/// Most paths: each has some seven rays, whose 1000 bytes stay in memory.
const MOST_PATHS: u64 = 1 << 24;

/// Refuses more paths than fit into memory.
fn check_paths(setup: &Setup) -> Result<()> {
    let Settings { spec, spp, .. } = setup.settings();
    let paths = u64::from(spec.width) * u64::from(spec.height) * u64::from(*spp);
    if paths <= MOST_PATHS {
        return Ok(());
    }
    let problem =
        format!("makes {paths} paths of {}x{} pixels, whose rays are kept in memory", spec.width, spec.height);
    let error = InputError::new("spp", spp.to_string(), problem);
    Err(error.allowed(format!("at most {MOST_PATHS} paths; a smaller --size makes fewer")).into())
}

/// Writes `pathmark-rays 1 TRIANGLES RAYS`, a line end, then little-endian doubles: the corners of each triangle; then
/// for each ray its origin, its direction and the number of the triangle on which it starts, or -1 for none.
fn export(scene: &Scene, rays: &[Start], file: &mut dyn Write) -> io::Result<()> {
    let triangles = &scene.primitives.triangles;
    writeln!(file, "pathmark-rays 1 {} {}", triangles.len(), rays.len())?;
    let vector = |Vec3 { x, y, z }: Vec3| [x, y, z];
    let corners = triangles.iter().flat_map(|triangle| triangle.corners).flat_map(vector);
    let rays = rays.iter().flat_map(|(ray, from)| {
        let from = from.map_or(-1.0, |from| f64::from(from.primitive));
        vector(ray.origin).into_iter().chain(vector(ray.direction)).chain([from])
    });
    corners.chain(rays).try_for_each(|number| file.write_all(&number.to_le_bytes()))
}
