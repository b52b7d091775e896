//! `cargo bench --bench kernel`: samples per second of one thread, by estimator, kernel and instruction set.

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use pathmark::estimator::ESTIMATORS;
use pathmark::film::{Decomposition, TileBuffer};
use pathmark::kernel::{KERNELS, Spec, build, choose};
use pathmark::simd::LEVELS;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

const SPP: u32 = 16;

/// The kernels that there are here, by name, with their instruction sets.
fn kernels() -> impl Iterator<Item = (String, Spec)> {
    let levels = || LEVELS.iter().filter(|level| level.is_available());
    KERNELS.iter().flat_map(move |kernel| {
        let spec = Spec { width: 64, height: 48, kernel: kernel.name.to_string(), ..Spec::default() };
        let of_level =
            |name: &str| (format!("{}-{name}", kernel.name), Spec { simd: Some(name.into()), ..spec.clone() });
        let alone = (kernel.name.to_string(), spec.clone());
        if kernel.name == "scalar" { vec![alone] } else { levels().map(|level| of_level(level.name)).collect() }
    })
}

fn kernel(criterion: &mut Criterion) {
    let scene = Arc::new(pathmark::scene::load("cornell").expect("cornell is embedded"));
    let plan = Decomposition::parse("tiles:64x48").expect("tiles can be cut").plan(64, 48, &(0..SPP));
    let piece = &plan.pieces()[0];
    let mut group = criterion.benchmark_group("kernel");
    group.sample_size(20).sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(piece.bounds.area() as u64 * u64::from(SPP)));
    group.warm_up_time(Duration::from_millis(500)).measurement_time(Duration::from_secs(3));
    for estimator in ESTIMATORS {
        for (name, spec) in kernels() {
            let spec = Spec { estimator: estimator.name.to_string(), ..spec };
            let choice = choose(&scene, &spec).expect("every listed name can be chosen");
            if !choice.fallback().is_empty() {
                continue;
            }
            let built = build(&scene, &spec).expect("every listed estimator can be built");
            let mut tile = TileBuffer::new(piece.bounds);
            group.bench_function(BenchmarkId::new(name, estimator.name), |bencher| {
                bencher.iter(|| black_box(built.render(piece, &mut tile)));
            });
        }
    }
    group.finish();
}

fn main() {
    let mut criterion = Criterion::default().without_plots().nresamples(2000).configure_from_args();
    kernel(&mut criterion);
    criterion.final_summary();
}
