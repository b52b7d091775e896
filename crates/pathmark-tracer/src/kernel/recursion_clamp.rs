//! Report B's clamp: the radiance that each recursion returns is cut at a limit, 1 in the report, so that no sample is
//! brighter than white. The clamp is biased, and more samples do not remove the bias.
//!
//! This code does without the recursion. A ray with throughput T contributes at most T times the limit to the sample.
//! So each vertex gives the sample an upper bound: the radiance collected before the vertex plus that contribution. The
//! sample is the least of these bounds and of all collected radiance.

use super::inspect::Inspector;
use super::render::Counts;
use super::scalar::Samples;
use crate::estimator::Probe;
use crate::math::{Ray, Rgb};
use crate::scene::{Hit, Tests};

/// Clamped samples. It inspects samples, which is slow but fast enough for a demonstration.
pub(super) struct RecursionClamp {
    pub(super) inspector: Inspector,
    /// See [`Clamp::limit`](super::Clamp::limit).
    pub(super) limit: f64,
}

/// The state of the clamp within a sample.
struct Clamped<'a> {
    counts: &'a mut Counts,
    limit: f64,
    collected: Rgb,
    least: Rgb,
}

fn lesser(a: Rgb, b: Rgb) -> Rgb {
    Rgb { r: a.r.min(b.r), g: a.g.min(b.g), b: a.b.min(b.b) }
}

impl Probe for Clamped<'_> {
    fn ray(&mut self, tests: Tests) {
        self.counts.ray(tests);
    }
    fn escaped(&mut self) {
        self.counts.escaped();
    }
    fn truncated(&mut self) {
        self.counts.truncated();
    }
    fn vertex(&mut self, _bounces: u16, _ray: &Ray, _hit: &Hit, throughput: Rgb) {
        self.least = lesser(self.least, self.collected + throughput * self.limit);
    }
    fn light(&mut self, _bounces: u16, contribution: Rgb) {
        self.collected += contribution;
    }
}

impl Samples for RecursionClamp {
    fn radiance(&self, x: u32, y: u32, sample: u32, counts: &mut Counts) -> Rgb {
        let least = Rgb::WHITE * f64::INFINITY;
        let mut clamp = Clamped { counts, limit: self.limit, collected: Rgb::BLACK, least };
        let whole = self.inspector.estimate(x, y, sample, &mut clamp);
        // The clamp may hide that a sample is invalid.
        if whole.is_valid_radiance() { lesser(clamp.collected, clamp.least) } else { whole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Vec3;
    use crate::sampling::{Address, Independent, Purpose, SampleKey, Sampler};

    /// Compares with the recursion as report B writes it, cut at every level, on paths of up to eight vertices with dim
    /// and bright light.
    #[test]
    fn is_the_clamp_of_every_recursion() {
        [1.0, 0.25, 3.0].into_iter().for_each(is_the_clamp_at);
    }

    fn is_the_clamp_at(limit: f64) {
        let at = Vec3::new(0.0, 0.0, 1.0);
        let ray = Ray { origin: at, direction: at };
        let hit = Hit { t: 1.0, primitive: 0, object: 0, point: at, normal: at, inside: false };
        let grey = |value: f64| Rgb { r: value, g: value, b: value };
        let mut cut = 0;
        for path in 0..1000 {
            let vertices: Vec<[f64; 2]> = (0..=path as u16 % 8)
                .map(|bounce| {
                    let key = SampleKey { seed: 3, pixel: 0, sample: path };
                    let [emission, weight] =
                        Independent.pair(Address { key, bounce, branch: 0, purpose: Purpose::Bsdf });
                    [0.6 * emission, 2.0 * weight]
                })
                .collect();
            let recursion =
                vertices.iter().rev().fold(0.0, |behind, [emission, weight]| (emission + weight * behind).min(limit));

            let mut counts = Counts::default();
            let least = Rgb::WHITE * f64::INFINITY;
            let mut clamp = Clamped { counts: &mut counts, limit, collected: Rgb::BLACK, least };
            let mut throughput = 1.0;
            for [emission, weight] in vertices {
                clamp.vertex(0, &ray, &hit, grey(throughput));
                clamp.light(0, grey(throughput * emission));
                throughput *= weight;
            }
            let found = lesser(clamp.collected, clamp.least).r;
            assert!((found - recursion).abs() < 1e-13, "path {path}: {found} instead of {recursion}");
            cut += u32::from(found < clamp.collected.r - 1e-9);
        }
        assert!((10..1000).contains(&cut), "{cut} of 1000 paths were cut at {limit}");
    }
}
