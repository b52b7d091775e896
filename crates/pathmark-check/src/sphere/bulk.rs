//! Very many rays compared with the exact answer, and rays across the silhouette in steps of one ulp.

use super::exact::{Exact, is_first};
use super::formulas::{formula_hit, smallpt_first_root, smallpt_roots};
use crate::math::{Ray, Vec3, dot, roots};
use crate::random::Random;
use crate::scene::{Primitive, Sphere};
use crate::{Trials, U};

/// Origin relative to the centre, unit direction and radius, aimed so that hits, misses and near tangents of every
/// degree all occur. Half of the rays take radius and distance from the catalogue's grid of powers of ten.
pub(crate) fn aimed(random: &mut Random) -> (Vec3, Vec3, f64) {
    let on_grid = random.below(2) == 0;
    let r =
        if on_grid { [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6, 1e8][random.below(8)] } else { random.scale(-6.0, 8.0) };
    let distance = match random.below(8) {
        0..=3 if on_grid => r * [1e-3, 1e-2, 0.1, 1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8][random.below(12)],
        0..=3 => r * random.scale(-3.0, 8.0),
        4..=6 => r * (1.0 - random.scale(-12.0, -1.0)),
        _ => r * (1.0 + random.below(9) as f64 * 2.0 * U - 8.0 * U),
    };
    let f = random.direction() * distance;
    let aim = match random.below(4) {
        0 => random.unit(),
        1 => 1.2 * random.unit(),
        2 => 1.0 - random.scale(-16.0, -1.0),
        _ => 1.0 + random.scale(-16.0, -1.0),
    };
    let target = f.cross(random.direction()).normalized() * (aim * r);
    let towards = (target - f).normalized();
    (f, if random.below(8) == 0 { -towards } else { towards }, r)
}

/// Counts of the outcomes of many rays.
#[derive(Default)]
struct Tally {
    hits: u64,
    misses: u64,
    /// Rays with a root beyond its error bound, or with a wrong first hit.
    outside: u64,
    /// Hits mistaken for misses, or the reverse, within the band and beyond it.
    in_band: u64,
    beyond_band: u64,
    /// The largest error, as a fraction of its bound.
    worst: f64,
    /// Rays on which the primitive in a scene and its formula differ.
    differs: u64,
}

impl Tally {
    fn add(&mut self, exact: &Exact, (f, d, r): (Vec3, Vec3, f64), (near, far): (f64, f64), first: Option<f64>) {
        match exact.roots {
            Some(expected) if !near.is_nan() => {
                let bounds = expected.map(|t| exact.bound(f, d, r, t));
                let fraction = ((near - expected[0]).abs() / bounds[0]).max((far - expected[1]).abs() / bounds[1]);
                self.hits += 1;
                self.worst = self.worst.max(fraction);
                // A NaN fraction is not within the bound either.
                self.outside += u64::from(!(fraction <= 1.0 && is_first(first, expected, bounds)));
            }
            None if near.is_nan() => {
                self.misses += 1;
                self.outside += u64::from(first.is_some());
            }
            _ if (r - exact.line).abs() <= Exact::band(f, r) => self.in_band += 1,
            _ => self.beyond_band += 1,
        }
    }
}

pub(super) fn any_rays(trials: &mut Trials) {
    let rays = trials.times(200_000, 100_000_000);
    let (tally, smallpt) = compare(rays);
    let told = format!("0 outside of their bounds of {} hits", tally.hits);
    let found = format!("{}, the worst at {:.3} of its bound", tally.outside, tally.worst);
    trials.holds("f64, roots", told, found, tally.outside == 0);
    trials.never("f64, hit or miss", "mistaken beyond the band", tally.beyond_band, rays);
    trials.never("f64, primitive", "unlike its formula", tally.differs, rays);
    // The rays must include many hits and misses, and few excused mistakes; otherwise the test proves little.
    let (hits, misses, excused) = (tally.hits * 2, tally.misses * 20, tally.in_band * 100);
    let kinds = format!("{} hits, {} misses, {} mistaken in the band", tally.hits, tally.misses, tally.in_band);
    let told = "at least half are hits, 5 % misses; at most 1 % in the band";
    trials.holds("the rays", told, kinds, hits > rays && misses > rays && excused < rays);
    let found = format!(
        "{} of {} outside, the worst {:.1e} times its bound; {} hits or misses mistaken beyond the band",
        smallpt.outside, smallpt.hits, smallpt.worst, smallpt.beyond_band
    );
    let fails = smallpt.outside > 0 && smallpt.beyond_band > 0;
    trials.holds("smallpt's formula", "outside, or these rays would prove nothing", found, fails);
}

/// Tallies of so many rays: of the formula and, for directions of length 1, of smallpt's formula.
fn compare(rays: u64) -> (Tally, Tally) {
    let mut random = Random::new(0x5EED);
    let (mut tally, mut smallpt) = (Tally::default(), Tally::default());
    for k in 0..rays {
        let (f, unit, r) = aimed(&mut random);
        let stretched = k % 4 == 3;
        let d = if stretched { unit * random.scale(-3.0, 3.0) } else { unit };
        let a = if stretched { dot(d, d) } else { 1.0 };
        let exact = Exact::of(f, d, r);
        let first = formula_hit(f, d, a, r);
        tally.add(&exact, (f, d, r), roots(f, d, a, r), first);
        if !stretched {
            let sphere = Sphere { center: Vec3::new(0.0, 0.0, 0.0), radius: r };
            let met = Some(sphere.meet(&Ray { origin: f, direction: d }, &())).filter(|t| *t > 0.0);
            tally.differs += u64::from(met != first);
            let first = Some(smallpt_first_root(f, d, r, 0.0)).filter(|t| *t > 0.0);
            smallpt.add(&exact, (f, d, r), smallpt_roots(f, d, r), first);
        }
    }
    (tally, smallpt)
}

/// Rays parallel to an axis must be right at every ulp, tilted rays outside of the band.
pub(super) fn silhouette(trials: &mut Trials) {
    let ulps = trials.times(1 << 20, 1 << 24) as i64;
    let misses = |f: Vec3, d: Vec3| roots(f, d, 1.0, 1.0).0.is_nan();
    let axis = Vec3::new(1.0, 0.0, 0.0);
    let wrong = (-ulps / 2..ulps / 2).filter(|k| {
        let y = f64::from_bits((1.0_f64.to_bits() as i64 + k) as u64);
        misses(Vec3::new(-2.0, y, 0.0), axis) != (*k > 0)
    });
    trials.never("f64, along an axis", "wrong", wrong.count() as u64, ulps as u64);
    let (mut wrong, mut tried) = (0, 0);
    let mut random = Random::new(0x530);
    for _ in 0..ulps / 1024 {
        let along = random.direction();
        let across = along.cross(random.direction()).normalized();
        for step in 0..20 {
            for side in [-1.0, 1.0] {
                let y = 1.0 + side * 64.0 * U * f64::from(1 << step);
                wrong += u64::from(misses(across * y - along * 3.0, along) != (side > 0.0));
                tried += 1;
            }
        }
    }
    trials.never("f64, tilted, from 64 ulp on", "wrong", wrong, tried);
}
