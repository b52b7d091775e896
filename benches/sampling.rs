//! `cargo bench --bench sampling`: pairs of random numbers per second by sampler, one at a time and in SIMD lanes.

mod bench;

use criterion::{BenchmarkId, Criterion, Throughput};
use pathmark::math::Bits;
use pathmark::sampler::{InLanes, PathWords};
use pathmark::sampling::{Address, Purpose, SAMPLERS, SampleKey, Sampler, keyed_sampler};
use pathmark::simd::{Float, Precision, Work, levels, on_level};
use std::hint::black_box;
use std::time::Duration;

/// Pairs in one iteration: vertices times samples.
const PAIRS: u64 = 16 * 64;
const VERTICES: u16 = 16;

/// The drawing of pairs at each vertex, for as many samples at a time as there are lanes.
struct InEachLane {
    sampler: InLanes,
}

impl Work for InEachLane {
    type Output = f64;

    #[inline(always)]
    fn run<V: Float>(self) -> f64 {
        let mut sum = V::splat(0.0);
        let none = V::Bits::splat(0);
        let mut first = 0;
        while first < PAIRS / u64::from(VERTICES) {
            let [_, words]: [PathWords<V::Bits>; 2] = self.sampler.words(1, V::Bits::splat(black_box(first)), none);
            for vertex in 1..=VERTICES {
                let [u, v] = self.sampler.pair::<V>(&words, V::Bits::splat(vertex.into()), none, Purpose::Bsdf);
                sum = sum + u + v;
            }
            first += V::LANES as u64;
        }
        sum.lane(0)
    }
}

fn one_by_one(sampler: &dyn Sampler) -> f64 {
    let mut sum = 0.0;
    for pixel in 0..(PAIRS / u64::from(VERTICES)) as u32 {
        let key = SampleKey { seed: 1, pixel: black_box(pixel), sample: 0 };
        for bounce in 1..=VERTICES {
            let [u, v] = sampler.pair(Address { key, bounce, branch: 0, purpose: Purpose::Bsdf });
            sum += u + v;
        }
    }
    sum
}

/// Measures every sampler, one pair at a time and in lanes.
fn pairs(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("sampling");
    group.throughput(Throughput::Elements(PAIRS));
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_millis(700));
    for entry in SAMPLERS {
        let Some(sampler) = keyed_sampler(entry.name) else { continue };
        group.bench_function(BenchmarkId::new("one", entry.name), |bencher| {
            bencher.iter(|| black_box(one_by_one(&*sampler)));
        });
        let Some(sampler) = InLanes::find(entry.name) else { continue };
        for level in levels() {
            for precision in Precision::ALL {
                let name = format!("{}-{}", precision.name(), level.name());
                group.bench_function(BenchmarkId::new(name, entry.name), |bencher| {
                    bencher.iter(|| black_box(on_level(level, precision, InEachLane { sampler })));
                });
            }
        }
    }
    group.finish();
}

fn main() {
    bench::run(&[("sampling", "pair")], pairs);
}
