//! `cargo bench --bench intersection`: rays per second against one primitive or box, against spheres in SIMD lanes in
//! both of their forms, and against whole scenes by accelerator.

mod bench;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use pathmark::math::{Ray, SphereByCurvature, Vec3, curved_quadratic, dot, first_root, first_root_curved};
use pathmark::scene::{ACCELERATORS, AllEffects, Bounds, Plane, Primitive, Sphere, Tests, Triangle, load};
use pathmark::simd::{Float, Precision, Work, levels, on_level};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;
use std::hint::black_box;
use std::time::Duration;

const RAYS: usize = 1024;

/// Returns rays from points of the cube from -2 to 2 towards points of the cube from -1 to 1.
fn rays() -> Vec<Ray> {
    let mut numbers = Pcg64Mcg::new(1);
    let mut unit = || (numbers.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let mut point = |size: f64| {
        let mut coordinate = || size * (2.0 * unit() - 1.0);
        Vec3::new(coordinate(), coordinate(), coordinate())
    };
    let ray = |_| {
        let origin = point(2.0);
        Ray { origin, direction: (point(1.0) - origin).normalized() }
    };
    (0..RAYS).map(ray).collect()
}

/// Tests all rays against one primitive, as a scene without a hierarchy does.
fn meet<P: Primitive>(primitive: &P, rays: &[Ray]) -> f64 {
    rays.iter().map(|ray| primitive.meet(ray, &P::prepare(ray)).max(0.0)).sum()
}

fn primitives(criterion: &mut Criterion) {
    let rays = rays();
    let origin = Vec3::new(0.0, 0.0, 0.0);
    let sphere = Sphere { center: origin, radius: 0.7 };
    let triangle = Triangle { corners: [[-0.9, -0.8, 0.1], [0.9, -0.7, 0.0], [0.1, 0.9, -0.2]].map(Vec3::from) };
    let plane = Plane { point: origin, normal: Vec3::new(0.6, 0.8, 0.0) };
    let bounds = Bounds { low: [-0.6; 3], high: [0.6; 3] };
    let mut group = criterion.benchmark_group("primitive");
    group.throughput(Throughput::Elements(RAYS as u64));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(700));
    group.bench_function("sphere", |bencher| bencher.iter(|| meet(black_box(&sphere), &rays)));
    group.bench_function("triangle", |bencher| bencher.iter(|| meet(black_box(&triangle), &rays)));
    group.bench_function("plane", |bencher| bencher.iter(|| meet(black_box(&plane), &rays)));
    group.bench_function("box", |bencher| {
        bencher.iter(|| rays.iter().filter(|ray| black_box(&bounds).meets(ray)).count());
    });
    group.finish();
}

/// A test of rays in lanes against spheres, given by centre and radius or by curvature.
struct InEachLane<'a> {
    rays: &'a [Ray],
    spheres: u32,
    is_curved: bool,
}

impl Work for InEachLane<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<V: Float>(self) -> f64 {
        let mut sum = V::splat(0.0);
        for packet in self.rays.chunks_exact(V::LANES) {
            let zero = Vec3::splat(Vec3::new(0.0, 0.0, 0.0));
            let mut ray = Ray::<V> { origin: zero, direction: zero };
            for (lane, Ray { origin, direction }) in packet.iter().enumerate() {
                for (lanes, one) in [(&mut ray.origin, origin), (&mut ray.direction, direction)] {
                    lanes.x.set_lane(lane, one.x);
                    lanes.y.set_lane(lane, one.y);
                    lanes.z.set_lane(lane, one.z);
                }
            }
            let (square, along) = (dot(ray.origin, ray.origin), dot(ray.origin, ray.direction));
            for sphere in 0..self.spheres {
                let radius = 0.5 + 0.01 * f64::from(sphere);
                let root = if self.is_curved {
                    let SphereByCurvature { normal, curvature, offset } =
                        SphereByCurvature::of(Vec3::new(0.1, 0.2, 0.3), radius);
                    let sphere = SphereByCurvature {
                        normal: Vec3::splat(normal),
                        curvature: V::splat(curvature),
                        offset: V::splat(offset),
                    };
                    let (b, c) = curved_quadratic(&sphere, ray.origin, ray.direction, square, along);
                    first_root_curved(sphere.curvature, b, c)
                } else {
                    let offset = ray.origin - Vec3::splat(Vec3::new(0.1, 0.2, 0.3));
                    first_root(offset, ray.direction, V::splat(1.0), V::splat(radius))
                };
                let is_met = V::splat(0.0).lt(root);
                sum = sum + V::select(is_met, root, V::splat(0.0));
            }
        }
        sum.lane(0)
    }
}

fn lanes(criterion: &mut Criterion) {
    const SPHERES: u32 = 64;
    let rays = rays();
    let mut group = criterion.benchmark_group("lanes");
    group.throughput(Throughput::Elements(RAYS as u64 * u64::from(SPHERES)));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(700));
    for level in levels() {
        for precision in Precision::ALL {
            for (form, is_curved) in [("centre", false), ("curvature", true)] {
                let name = format!("{form}-{}", precision.name());
                group.bench_function(BenchmarkId::new(name, level.name()), |bencher| {
                    bencher.iter(|| {
                        let work = InEachLane { rays: black_box(&rays), spheres: SPHERES, is_curved };
                        black_box(on_level(level, precision, work))
                    });
                });
            }
        }
    }
    group.finish();
}

fn scenes(criterion: &mut Criterion) {
    let rays = rays();
    let mut group = criterion.benchmark_group("scene");
    group.sample_size(20).sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(RAYS as u64));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(700));
    for count in [10, 100, 1000, 10_000] {
        let scene = load(&format!("spheres:{count}")).expect("a shipped scene");
        for accelerator in ACCELERATORS {
            let scene = scene.accelerated(accelerator.name).unwrap_or_else(|| scene.clone());
            group.bench_function(BenchmarkId::new(accelerator.name, count), |bencher| {
                bencher.iter(|| {
                    let mut tests = Tests::default();
                    let hits = rays.iter().filter_map(|ray| scene.intersect::<AllEffects>(ray, None, &mut tests));
                    black_box(hits.map(|hit| hit.t).sum::<f64>())
                });
            });
        }
    }
    group.finish();
}

fn main() {
    let units = [("primitive", "ray"), ("lanes", "ray and sphere"), ("scene", "ray")];
    bench::run(&units, |criterion| {
        primitives(criterion);
        lanes(criterion);
        scenes(criterion);
    });
}
