//! `cargo bench --bench intersection`: rays per second against one primitive or box, and against whole scenes by accelerator.

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use pathmark::math::{Ray, Vec3};
use pathmark::scene::{ACCELERATORS, AllEffects, Bounds, Plane, Primitive, Sphere, Tests, Triangle, load};
use rand_pcg::Pcg64Mcg;
use rand_pcg::rand_core::Rng;
use std::hint::black_box;
use std::time::Duration;

const RAYS: usize = 1024;

/// Rays from a cube of twice the size towards points of the cube from -1 to 1.
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

/// One primitive, tested as a scene without a hierarchy tests it.
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
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
    group.bench_function("sphere", |bencher| bencher.iter(|| meet(black_box(&sphere), &rays)));
    group.bench_function("triangle", |bencher| bencher.iter(|| meet(black_box(&triangle), &rays)));
    group.bench_function("plane", |bencher| bencher.iter(|| meet(black_box(&plane), &rays)));
    group.bench_function("box", |bencher| {
        bencher.iter(|| rays.iter().filter(|ray| black_box(&bounds).meets(ray)).count());
    });
    group.finish();
}

fn scenes(criterion: &mut Criterion) {
    let rays = rays();
    let mut group = criterion.benchmark_group("scene");
    group.sample_size(20).sampling_mode(SamplingMode::Flat).throughput(Throughput::Elements(RAYS as u64));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(2));
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
    let mut criterion = Criterion::default().without_plots().nresamples(2000).configure_from_args();
    primitives(&mut criterion);
    scenes(&mut criterion);
    criterion.final_summary();
}
