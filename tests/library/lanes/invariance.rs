//! Invariance to the program's own choices: accelerator, instruction set and number of lanes change no bit. The
//! numbers of primitives lie on both sides of each threshold of such a choice. The test asks the program for these
//! thresholds.

use super::{render, without_tests};
use crate::watchdog::Watchdog;
use pathmark::film::{Bounds, Piece, TileBuffer};
use pathmark::kernel::{Counts, Spec, build, choose};
use pathmark::material::{Diffuse, Material};
use pathmark::math::{Rgb, Vec3};
use pathmark::scene::{ACCELERATORS, Object, Scene, Sphere, Triangle, load};
use pathmark::simd::levels;
use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};
use std::time::Duration;

/// Numbers of primitives at which a choice changed in the past, and around which tables fit registers of some width.
const OFTEN: [usize; 13] = [11, 12, 15, 16, 17, 31, 32, 33, 35, 36, 63, 64, 80];
/// No choice changes above this number.
const MOST: usize = 300;

/// Random numbers in [0, 1) of sufficient quality.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f64 / (1_u64 << 24) as f64
    }

    /// A random point of a box.
    fn point(&mut self, low: Vec3, high: Vec3) -> Vec3 {
        let share = Vec3::new(self.unit(), self.unit(), self.unit());
        let size = high - low;
        low + Vec3::new(size.x * share.x, size.y * share.y, size.z * share.z)
    }

    fn object(&mut self) -> Object {
        let albedo = Rgb { r: self.unit(), g: self.unit(), b: self.unit() };
        let emission = if self.unit() < 0.2 { albedo } else { Rgb::BLACK };
        let material = Material::Diffuse(Diffuse { albedo });
        Object { name: String::new(), material, emission, angular_emission: None }
    }
}

/// The contents of a scene besides its walls.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Content {
    Spheres,
    /// Spheres in pairs at the same place: each hit of a pair is a tie.
    Twins,
    Triangles,
    Both,
}

/// A scene with so many primitives. Spheres lie in smallpt's box of large spheres, triangles under an open sky.
fn scene(content: Content, primitives: usize) -> Arc<Scene> {
    static BOX: LazyLock<Scene> = LazyLock::new(|| load("cornell").unwrap());
    let mut random = Random(primitives as u64);
    let mut scene = BOX.clone();
    let (low, high) = (Vec3::new(10.0, 5.0, 30.0), Vec3::new(90.0, 60.0, 110.0));
    if content == Content::Triangles || primitives < scene.owners.len() {
        scene.primitives.spheres.clear();
        scene.objects.clear();
        scene.background = Some(Rgb::WHITE);
    }
    while scene.objects.len() < primitives {
        let is_sphere = match content {
            Content::Spheres | Content::Twins => true,
            Content::Triangles => false,
            Content::Both => scene.objects.len().is_multiple_of(2),
        };
        let center = random.point(low, high);
        if is_sphere {
            let last = scene.primitives.spheres.last().copied();
            let radius = 2.0 + 6.0 * random.unit();
            let twin = last.filter(|last| content == Content::Twins && last.radius < 8.0 && random.unit() < 0.5);
            let at = scene.primitives.spheres.len();
            scene.primitives.spheres.push(twin.unwrap_or(Sphere { center, radius }));
            scene.objects.insert(at, random.object());
        } else {
            let mut corner = || center + random.point(Vec3::new(-20.0, -20.0, -20.0), Vec3::new(20.0, 20.0, 20.0));
            scene.primitives.triangles.push(Triangle { corners: [corner(), corner(), corner()] });
            scene.objects.push(random.object());
        }
    }
    scene.owners = (0..scene.objects.len() as u32).collect();
    scene.name = format!("{content:?} {primitives}");
    Arc::new(scene)
}

const ALL: [Content; 4] = [Content::Spheres, Content::Twins, Content::Triangles, Content::Both];

/// The kernels that render in a precision: lanes with each instruction set and, in double precision, one path at a
/// time.
fn kernels(precision: &str) -> Vec<Spec> {
    let spec = Spec { width: 8, height: 6, estimator: "mis".into(), precision: precision.into(), ..Spec::default() };
    let on_level = |name: &str| Spec { simd: Some(name.into()), ..spec.clone() };
    let lanes = levels().map(|level| on_level(level.name()));
    let scalar = Spec { kernel: "scalar".into(), ..spec.clone() };
    lanes.chain((precision == "f64").then_some(scalar)).collect()
}

/// The numbers of primitives on both sides of each threshold at which a kernel chooses another accelerator.
fn thresholds(content: Content) -> BTreeSet<usize> {
    let kernels: Vec<Spec> = ["f64", "f32"].into_iter().flat_map(kernels).collect();
    let choices = |primitives: usize| {
        let scene = scene(content, primitives);
        kernels.iter().map(|spec| choose(&scene, spec).unwrap().accelerator.name).collect::<Vec<_>>()
    };
    let (mut numbers, mut last, mut changes) = (BTreeSet::from(OFTEN), choices(1), vec![0; kernels.len()]);
    for primitives in 2..=MOST {
        let now = choices(primitives);
        for (count, _) in changes.iter_mut().zip(last.iter().zip(&now)).filter(|(_, (last, now))| last != now) {
            numbers.extend([primitives - 1, primitives]);
            *count += 1;
        }
        last = now;
    }
    for (changes, spec) in changes.into_iter().zip(&kernels) {
        assert!(changes > 0, "{content:?} {spec:?}: no threshold up to {MOST}");
    }
    numbers
}

#[test]
fn no_choice_of_the_program_changes_a_bit() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 8, y1: 6 }, samples: 0..4 };
    let scenes = ALL.into_iter().flat_map(|content| thresholds(content).into_iter().map(move |n| scene(content, n)));
    for scene in scenes {
        watchdog.now(&*scene.name);
        for precision in ["f64", "f32"] {
            let mut expected: Option<(TileBuffer, Counts)> = None;
            for spec in kernels(precision) {
                for entry in ACCELERATORS {
                    let spec = Spec { accelerator: Some(entry.name.to_string()), ..spec.clone() };
                    let (sums, counts) = render(&*build(&scene, &spec).unwrap(), &piece);
                    let found = (sums, without_tests(counts));
                    let Some(expected) = &expected else {
                        expected = Some(found);
                        continue;
                    };
                    let Spec { kernel, simd, accelerator, .. } = &spec;
                    assert!(found == *expected, "{}: {precision} {kernel} {simd:?} {accelerator:?}", scene.name);
                }
            }
        }
    }
}
