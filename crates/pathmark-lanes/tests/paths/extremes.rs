//! Scenes of extreme lengths: every kernel ends and returns the same bits, with every accelerator.

use crate::watchdog::Watchdog;
use pathmark_lanes::kernel::{Counts, Spec, build, choose};
use pathmark_lanes::simd::{Level, levels};
use pathmark_tracer::film::{Bounds, Piece, TileBuffer};
use pathmark_tracer::sampling::mix;
use pathmark_tracer::scene::Scene;
use std::fmt::Write;
use std::sync::Arc;
use std::time::Duration;

/// Random numbers for scenes.
struct Random(u64);

impl Random {
    fn below(&mut self, count: u64) -> u64 {
        self.0 += 1;
        mix(self.0) % count
    }

    /// A number from -1 to 1.
    fn signed(&mut self) -> f64 {
        self.below(1 << 53) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// A length around `scale`, in the range of scene files: mostly of that size, at times many orders of magnitude
    /// larger or smaller.
    fn length(&mut self, scale: f64) -> f64 {
        let exponent = [0.0, 1.0, 4.0, 15.0, 40.0, 100.0][self.below(6) as usize] * self.signed();
        (scale * libm::exp10(exponent)).clamp(1e-100, 1e100)
    }

    /// A point whose coordinates have such lengths; some are zero.
    fn point(&mut self, scale: f64) -> [f64; 3] {
        let away = self.length(scale);
        [(); 3].map(|()| match self.below(4) {
            0 => 0.0,
            1 => (self.length(away) * self.signed()).clamp(-1e100, 1e100),
            _ => away * self.signed(),
        })
    }

    fn shape(&mut self, scale: f64) -> String {
        let point = self.point(scale);
        match self.below(5) {
            0 | 1 => format!("sphere = {{ center = {point:?}, radius = {:?} }}", self.length(scale)),
            // A sphere through the scene's middle.
            2 => {
                let radius = self.length(scale);
                format!("sphere = {{ center = [0.0, {:?}, 0.0], radius = {radius:?} }}", -radius)
            }
            3 => format!("plane = {{ point = {point:?}, normal = [{:?}, 1.0, {:?}] }}", self.signed(), self.signed()),
            _ => {
                let edge = self.length(scale);
                let corners = [(); 3].map(|()| point.map(|x| (x + edge * self.signed()).clamp(-1e100, 1e100)));
                format!("triangle = {{ corners = {corners:?} }}")
            }
        }
    }

    /// A scene with up to 60 objects. Some of the shapes are refused as degenerate; these scenes are `None`.
    fn scene(&mut self) -> Option<Scene> {
        let scale = libm::exp10(90.0 * self.signed() * [0.0, 0.3, 1.0][self.below(3) as usize]);
        let background = if self.below(2) == 0 { "background = [0.4, 0.5, 0.6]\n" } else { "" };
        let angle = 90.0 + 85.0 * self.signed();
        let mut text = format!(
            "about = 'extreme'\n{background}[camera.pinhole]\nposition = {:?}\nlook-at = {:?}\nfield-of-view = {angle}\n",
            self.point(scale),
            self.point(scale),
        );
        let most = [4, 12, 60][self.below(3) as usize];
        for number in 0..=self.below(most) {
            let material = match self.below(4) {
                0 | 1 => "diffuse = { albedo = [0.5, 0.6, 0.7] }",
                2 => "mirror = { albedo = [0.9, 0.9, 0.9] }",
                _ => "dielectric = { eta = 1.5 }",
            };
            let light = ["[0.0, 0.0, 0.0]", "[1.0, 2.0, 3.0]"][self.below(2) as usize];
            let shape = self.shape(scale);
            let object = format!("name = '{number}'\nshape = {{ {shape} }}\nmaterial = {{ {material} }}\n");
            write!(text, "[[objects]]\n{object}emission = {light}\n").unwrap();
        }
        Scene::from_toml(&text).ok()
    }
}

fn render(scene: &Arc<Scene>, spec: &Spec, piece: &Piece) -> (TileBuffer, Counts) {
    let mut buffer = TileBuffer::new(piece.bounds);
    let counts = build(scene, spec).unwrap().render(piece, &mut buffer);
    (buffer, Counts { box_tests: 0, primitive_tests: 0, ..counts })
}

/// Asserts that all searches give the same bits. In double precision the scalar kernel without an accelerator is the
/// oracle. In single precision every instruction set has the same bits with and without a tree. Returns whether single
/// precision holds the scene's lengths.
fn assert_same(scene: &Arc<Scene>, what: &str, spec: &Spec, piece: &Piece) -> bool {
    let on = |kernel: &str, simd: Option<Level>, precision: &str, accelerator: &str| Spec {
        kernel: kernel.into(),
        simd: simd.map(|level| level.name().into()),
        precision: precision.into(),
        accelerator: Some(accelerator.into()),
        ..spec.clone()
    };
    let expected = render(scene, &on("scalar", None, "f64", "none"), piece);
    let mut single = None;
    for accelerator in ["none", "median", "sah"] {
        let what = format!("{what}, {}, {accelerator}", spec.estimator);
        assert!(render(scene, &on("scalar", None, "f64", accelerator), piece) == expected, "{what}, scalar");
        for level in levels() {
            let name = level.name();
            assert!(render(scene, &on("lanes", Some(level), "f64", accelerator), piece) == expected, "{what}, {name}");
            let in_single = on("lanes", Some(level), "f32", accelerator);
            if choose(scene, &in_single).is_ok() {
                let found = render(scene, &in_single, piece);
                assert!(*single.get_or_insert_with(|| found.clone()) == found, "{what}, {name}, f32");
            }
        }
    }
    single.is_some()
}

fn spec(estimator: &str) -> Spec {
    Spec { width: 5, height: 4, estimator: estimator.into(), max_depth: Some(12), ..Spec::default() }
}

const ALL: Piece = Piece { bounds: Bounds { x0: 0, y0: 0, x1: 5, y1: 4 }, samples: 0..4 };

#[test]
fn extreme_scenes_have_the_same_bits_with_every_search() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    let count = if std::env::var_os("PATHMARK_THOROUGH").is_some() { 20_000 } else { 150 };
    let (mut random, mut rendered, mut in_single) = (Random(7), 0, 0);
    while rendered < count {
        let what = format!("scene {}", random.0);
        watchdog.now(what.clone());
        let Some(scene) = random.scene().map(Arc::new) else { continue };
        rendered += 1;
        for estimator in ["bsdf", "mis"] {
            in_single += usize::from(assert_same(&scene, &what, &spec(estimator), &ALL));
        }
    }
    assert!((rendered / 4..rendered).contains(&in_single), "{in_single} of {rendered} in single precision");
}

/// The start of the scenes below.
const CAMERA: &str = "about = 'extreme'\nbackground = [0.4, 0.5, 0.6]\n[camera.pinhole]\nposition = [0.0, 0.3, 4.0]\n\
                      look-at = [0.0, 0.0, 0.0]\nfield-of-view = ";

/// Rays that are reflected beyond the range of single precision, in sizes of the boxes: a test of boxes in single
/// precision would let all of them in, also those of missing children.
#[test]
fn rays_from_beyond_single_precision_end() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    for far in ["1e39", "1e45", "1e60", "1e100"] {
        watchdog.now(far);
        let text = format!(
            "{CAMERA}20.0\n[[objects]]\nname = 'mirror'\nshape = {{ plane = {{ point = [-1.0, -0.7, -1e8], normal = [-0.223, \
             0.791, -0.337] }} }}\nmaterial = {{ mirror = {{ albedo = [0.9, 0.9, 0.9] }} }}\n[[objects]]\nname = 'ball'\n\
             shape = {{ sphere = {{ center = [-2.0, -1.0, 0.0], radius = 0.1 }} }}\nmaterial = {{ mirror = {{ albedo = [0.9, \
             0.9, 0.9] }} }}\n[[objects]]\nname = 'far'\nshape = {{ plane = {{ point = [{far}, 0.0, 0.0], normal = [-1.0, \
             0.0, 0.0] }} }}\nmaterial = {{ diffuse = {{ albedo = [0.5, 0.5, 0.5] }} }}\n"
        );
        let scene = Arc::new(Scene::from_toml(&text).unwrap());
        assert!(!assert_same(&scene, far, &spec("bsdf"), &ALL));
    }
}

/// From 1e15 away, rounding lets rays meet a small ball that they pass, at points beside it, whose other root is
/// outside the ball's box; or at its centre, where it has no normal.
#[test]
fn hits_beside_small_spheres_are_the_same_in_hierarchies() {
    let watchdog = Watchdog::new(Duration::from_mins(5));
    watchdog.now("a ball in a mirror");
    let text = format!(
        "{CAMERA}170.0\n[[objects]]\nname = 'ball'\nshape = {{ sphere = {{ center = [1.0, -1.0, -3.0], radius = 1e-3 }} }}\n\
         material = {{ diffuse = {{ albedo = [0.5, 0.5, 0.5] }} }}\nemission = [1.0, 1.0, 1.0]\n[[objects]]\nname = 'mirror'\n\
         shape = {{ sphere = {{ center = [0.0, 0.0, 0.0], radius = 1e15 }} }}\n\
         material = {{ mirror = {{ albedo = [0.8, 0.8, 0.8] }} }}\n"
    );
    let scene = Arc::new(Scene::from_toml(&text).unwrap());
    let spec = Spec { width: 64, height: 48, seed: 5, ..spec("bsdf") };
    let piece = Piece { bounds: Bounds { x0: 29, y0: 21, x1: 39, y1: 33 }, samples: 0..64 };
    assert!(!assert_same(&scene, "a mirror", &spec, &piece));
}
