//! `cargo bench --bench kernel`: samples per second of one thread, by estimator, kernel, precision and instruction set, on cornell and, for one
//! estimator, on other scenes.

mod bench;

use criterion::{BenchmarkId, Criterion, SamplingMode, Throughput};
use pathmark::estimator::ESTIMATORS;
use pathmark::film::{Decomposition, TileBuffer};
use pathmark::kernel::{KERNELS, Spec, build, choose};
use pathmark::simd::{Precision, levels};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

const SPP: u32 = 16;

/// Returns the kernels of this machine by name, for each of their instruction sets and precisions.
fn kernels() -> impl Iterator<Item = (String, Spec)> {
    KERNELS.iter().flat_map(move |kernel| {
        let spec = Spec { width: 64, height: 48, kernel: kernel.name.to_string(), ..Spec::default() };
        if kernel.name == "scalar" {
            return vec![(kernel.name.to_string(), spec)];
        }
        let formats = levels().flat_map(|level| Precision::ALL.map(|precision| (level.name(), precision.name())));
        formats
            .map(|(level, precision)| {
                let name = format!("{}-{precision}-{level}", kernel.name);
                (name, Spec { simd: Some(level.into()), precision: precision.into(), ..spec.clone() })
            })
            .collect()
    })
}

fn kernel(criterion: &mut Criterion, scene: &str, estimators: &[&str]) {
    let loaded = Arc::new(pathmark::scene::load(scene).expect("the scene is embedded"));
    let plan = Decomposition::parse("tiles:64x48").expect("tiles can be cut").plan(64, 48, &(0..SPP));
    let piece = &plan.pieces()[0];
    let mut group = criterion.benchmark_group(format!("kernel/{scene}"));
    group.sample_size(20).sampling_mode(SamplingMode::Flat);
    group.throughput(Throughput::Elements(piece.bounds.area() as u64 * u64::from(SPP)));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    for estimator in estimators {
        for (name, spec) in kernels() {
            let spec = Spec { estimator: (*estimator).to_string(), ..spec };
            let choice = choose(&loaded, &spec).expect("every listed name can be chosen");
            if !choice.fallback.is_empty() {
                continue;
            }
            let built = build(&loaded, &spec).expect("every listed estimator can be built");
            let mut tile = TileBuffer::new(piece.bounds);
            group.bench_function(BenchmarkId::new(name, estimator), |bencher| {
                bencher.iter(|| black_box(built.render(piece, &mut tile)));
            });
        }
    }
    group.finish();
}

fn main() {
    let all: Vec<&str> = ESTIMATORS.iter().map(|entry| entry.name).collect();
    bench::run(&[("kernel/", "sample")], |criterion| {
        kernel(criterion, "cornell", &all);
        for scene in ["sky", "wada", "imbalance", "cornell-mesh"] {
            kernel(criterion, scene, &["bsdf"]);
        }
    });
}
