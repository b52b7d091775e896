//! A custom kernel: a ray caster that shades spheres by their distance, without Pathmark's path tracer.
//!
//! `cargo run --release --example custom_kernel -- render cornell --kernel caster -o depth.png`

use pathmark::film::{Piece, SampleSum, TileBuffer};
use pathmark::kernel::{Counts, Kernel, KernelEntry, KernelPlan, Planned, RenderOptions};
use pathmark::math::{Ray, Rgb, dot};
use pathmark::scene::{AllEffects, Scene, View};
use pathmark::{Lab, error::Result};
use std::{process::ExitCode, sync::Arc};

/// Other scenes fall back to the scalar kernel, and the column `kernel_fallback` says `primitives`.
const ENTRY: KernelEntry = KernelEntry::new("caster", "spheres, shaded by their distance", |request| {
    let is_round = request.scene.primitives.spheres.len() == request.scene.owners.len();
    Ok(if is_round { Planned::Ready(Arc::new(Plan)) } else { Planned::Unsupported("primitives") })
});

struct Plan;
struct Caster(Arc<Scene>, View);

impl KernelPlan for Plan {
    fn name(&self) -> &str {
        ENTRY.name
    }
    /// Rows name it, so that nothing takes these images for path traced ones.
    fn estimator(&self) -> Option<&'static str> {
        Some("caster")
    }
    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>> {
        Ok(Box::new(Caster(Arc::clone(scene), options.view(scene))))
    }
}

/// Brightness by distance: 1 at the eye, 1/2 after 100 units, 0 where nothing is.
fn lit(scene: &Scene, ray: &Ray) -> f64 {
    let distances = scene.primitives.spheres.iter().filter_map(|sphere| {
        let from = ray.origin - sphere.center;
        let b = dot(from, ray.direction);
        let root = (b * b - dot(from, from) + sphere.radius * sphere.radius).sqrt(); // NaN without a hit
        [-b - root, -b + root].into_iter().find(|t| *t > 0.0)
    });
    100.0 / (100.0 + distances.fold(f64::INFINITY, f64::min))
}

impl Kernel for Caster {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        for y in piece.bounds.y0..piece.bounds.y1 {
            for (x, pixel) in (piece.bounds.x0..piece.bounds.x1).zip(out.row_mut(y)) {
                let mut sum = SampleSum::default();
                for sample in piece.samples.clone() {
                    sum.add(Rgb::WHITE * lit(&self.0, &self.1.ray::<AllEffects>(x, y, sample, [0.5; 2], || [0.5; 2])));
                }
                *pixel = sum.total();
            }
        }
        let paths = piece.bounds.area() as u64 * piece.samples.len() as u64;
        Counts { paths, rays: paths, ..Counts::default() }
    }
}

fn main() -> ExitCode {
    pathmark::main(Lab::new().kernel(ENTRY))
}

#[cfg(test)]
mod tests {
    use pathmark::measure::{Record, Settings};
    #[test]
    fn every_strategy_renders_the_same_image() {
        let mut settings = Settings { scene: "cornell".into(), spp: 4, threads: 2, ..Settings::default() };
        settings.spec.kernel = "caster".into();
        let images = ["serial", "rayon", "work-stealing"].map(|strategy| {
            let settings = Settings { strategy: strategy.into(), ..settings.clone() };
            let setup = pathmark::Lab::new().kernel(super::ENTRY).prepare(settings).unwrap();
            (Record::of(&setup).kernel, setup.run(None).unwrap().film.pixels().to_vec())
        });
        assert!(images.iter().all(|image| *image == images[0]) && images[0].0 == "caster");
    }
}
