//! A custom kernel: a ray caster that shades spheres by their angle to the viewer. It shares the scenes, the film and
//! the schedules with Pathmark, but none of the code that renders.
//!
//! `cargo run --release --example custom_kernel -- render cornell --kernel caster -o shapes.png`

use pathmark::Lab;
use pathmark::error::Result;
use pathmark::film::{Piece, SampleSum, TileBuffer};
use pathmark::kernel::{Counts, Kernel, KernelEntry, KernelPlan, Planned, RenderOptions, Request};
use pathmark::math::{Ray, Rgb, dot};
use pathmark::scene::{AllEffects, Scene, View};
use std::process::ExitCode;
use std::sync::Arc;

const CASTER: KernelEntry = KernelEntry::new("caster", "spheres, shaded by their angle to the viewer", plan);

fn plan(request: &Request<'_>) -> Result<Planned> {
    let is_round = request.scene.primitives.spheres.len() == request.scene.owners.len();
    Ok(if is_round { Planned::Ready(Arc::new(Plan)) } else { Planned::Unsupported("primitives") })
}

struct Plan;

impl KernelPlan for Plan {
    fn name(&self) -> &str {
        CASTER.name
    }

    /// Rows name this estimator, so that nobody compares the image with a path traced one.
    fn estimator(&self) -> Option<&'static str> {
        Some("caster")
    }

    fn build(&self, scene: &Arc<Scene>, options: &RenderOptions) -> Result<Box<dyn Kernel>> {
        Ok(Box::new(Caster { scene: Arc::clone(scene), view: options.view(scene) }))
    }
}

struct Caster {
    scene: Arc<Scene>,
    view: View,
}

impl Caster {
    /// The cosine between the ray and the normal of the first sphere that it meets; 0 if it meets none.
    fn shade(&self, ray: &Ray) -> f64 {
        let (mut nearest, mut cosine) = (f64::INFINITY, 0.0);
        for sphere in &self.scene.primitives.spheres {
            let from = ray.origin - sphere.center;
            let b = dot(from, ray.direction);
            let root = (b * b - dot(from, from) + sphere.radius * sphere.radius).sqrt();
            // Without a hit `root` is NaN, which is greater than nothing.
            if let Some(t) = [-b - root, -b + root].into_iter().find(|t| *t > 1e-3 && *t < nearest) {
                (nearest, cosine) = (t, dot(from + ray.direction * t, ray.direction).abs() / sphere.radius);
            }
        }
        cosine
    }
}

impl Kernel for Caster {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        let (mut counts, mut sum) = (Counts::default(), SampleSum::default());
        for y in piece.bounds.y0..piece.bounds.y1 {
            for (x, pixel) in (piece.bounds.x0..piece.bounds.x1).zip(out.row_mut(y)) {
                sum.clear();
                for sample in piece.samples.clone() {
                    // The middle of the pixel, or of its subpixel.
                    let ray = self.view.ray::<AllEffects>(x, y, sample, [0.5; 2], || [0.5; 2]);
                    sum.add(Rgb::WHITE * self.shade(&ray));
                    (counts.paths, counts.rays) = (counts.paths + 1, counts.rays + 1);
                }
                *pixel = sum.total();
            }
        }
        counts
    }
}

fn main() -> ExitCode {
    Lab::new().kernel(CASTER).main()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pathmark::kernel::Spec;
    use pathmark::measure::{Record, Settings};

    fn row(lab: &Lab, scene: &str, strategy: &str) -> (Record, Vec<f64>) {
        let spec = Spec { width: 12, height: 8, kernel: CASTER.name.into(), ..Spec::default() };
        let (scene, strategy) = (scene.into(), strategy.into());
        let settings = Settings {
            scene,
            strategy,
            spp: 4,
            threads: 2,
            decomposition: "tiles:5x3".into(),
            spec,
            ..Settings::default()
        };
        let setup = lab.prepare(settings).unwrap();
        let film = setup.run(None).unwrap().film;
        (Record::of(&setup), film.pixels().iter().map(|pixel| pixel.mean()[0]).collect())
    }

    #[test]
    fn every_strategy_renders_the_same_image() {
        let lab = Lab::new().kernel(CASTER);
        let images = ["serial", "work-stealing", "rayon"].map(|strategy| row(&lab, "cornell", strategy));
        assert!(images.iter().all(|(row, image)| row.kernel == "caster" && *image == images[0].1));
        // The camera stands in the room, so every ray meets a wall, and few at a right angle.
        assert!(images[0].1.iter().all(|shade| (0.0..=1.0).contains(shade)) && images[0].1[0] > 0.0);
        let (fallback, _) = row(&lab, "cornell-mesh", "serial");
        assert_eq!((fallback.kernel.as_str(), fallback.kernel_fallback.as_str()), ("scalar", "primitives"));
    }
}
