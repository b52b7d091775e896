//! Sampled directions follow their density: G7, for every material, roughness and angle.

use crate::analysis::chi_square::against;
use crate::material::{Density, Material};
use crate::materials::{every_material, towards};
use crate::math::{Vec3, dot};
use crate::quadrature::integral;
use crate::sampling::{mix, unit};
use crate::scene::AllEffects;
use crate::{Trials, critical};
use std::f64::consts::TAU;

/// A grid over the hemisphere, with rings of equal height.
#[derive(Clone, Copy)]
struct Grid {
    rings: usize,
    spokes: usize,
}

impl Grid {
    fn cell(self, wi: Vec3) -> usize {
        let ring = ((wi.z * self.rings as f64) as usize).min(self.rings - 1);
        let turns = (libm::atan2(wi.y, wi.x) / TAU).rem_euclid(1.0);
        ring * self.spokes + ((turns * self.spokes as f64) as usize).min(self.spokes - 1)
    }

    /// The integral of the density over each cell.
    fn expected(self, material: &Material, wo: Vec3) -> Vec<f64> {
        let side = |index: usize, of: usize| [index as f64 / of as f64, (index + 1) as f64 / of as f64];
        let pdf = |cos: f64, turns: f64| material.pdf::<AllEffects>(wo, towards(cos, turns)) * TAU;
        let cell = |cell: usize| {
            integral(side(cell / self.spokes, self.rings), side(cell % self.spokes, self.spokes), 1e-6, &pdf)
        };
        (0..self.rings * self.spokes).map(cell).collect()
    }
}

/// Results of the samples of a material.
struct Found {
    cells: Vec<f64>,
    /// Number of samples that were absorbed or came from a delta lobe.
    without_density: f64,
    /// Number of samples that lie below the surface, or whose density or weight contradicts `pdf` or `eval`.
    contradicted: u64,
}

fn sampled(grid: Grid, material: &Material, wo: Vec3, seed: u64, samples: u64) -> Found {
    let mut found = Found { cells: vec![0.0; grid.rings * grid.spokes], without_density: 0.0, contradicted: 0 };
    for k in 0..samples {
        let key = mix(seed << 40 | k);
        let Some(sample) = material.sample::<AllEffects>(wo, false, [unit(key), unit(mix(key))]) else {
            found.without_density += 1.0;
            continue;
        };
        let Density::PerSolidAngle(density) = sample.density else {
            found.without_density += 1.0;
            continue;
        };
        found.cells[grid.cell(sample.wi)] += 1.0;
        let pdf = material.pdf::<AllEffects>(wo, sample.wi);
        let weight = material.eval::<AllEffects>(wo, sample.wi) * (sample.wi.z / pdf);
        let mut pairs = sample.weight.channels().into_iter().zip(weight.channels());
        let is_confirmed = sample.wi.z > 0.0
            && (dot(sample.wi, sample.wi) - 1.0).abs() < 1e-14
            && (density / pdf - 1.0).abs() < 1e-9
            && pairs.all(|(own, asked)| (own - asked).abs() <= 1e-9 * own);
        found.contradicted += u64::from(!is_confirmed);
    }
    found
}

/// Samples without a density form a separate cell, whose expected share is 1 minus the integral. 40 000 samples in 512
/// cells detect a density that is off by a tenth in half of the cells; thorough counts detect a hundredth.
pub(super) fn every_sampler(trials: &mut Trials) {
    let is_thorough = trials.times(0, 1) == 1;
    let cosines: &[f64] = if is_thorough {
        &[1.0, 0.99, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.25, 0.2, 0.15, 0.1, 0.07, 0.05, 0.03, 0.02, 0.01]
    } else {
        &[1.0, 0.6, 0.1]
    };
    let grid = if is_thorough { Grid { rings: 64, spokes: 128 } } else { Grid { rings: 16, spokes: 32 } };
    let samples = trials.times(20_000, 2_100_000);
    let materials = every_material();
    let limit = critical(materials.len() * cosines.len());
    let mut judged = 0;
    for (number, (name, material)) in materials.iter().enumerate() {
        for (k, cos) in cosines.iter().enumerate() {
            let wo = towards(*cos, 0.07 + 0.1 * k as f64);
            let variant = format!("{name}, cos {cos}");
            let mut found = sampled(grid, material, wo, (number * cosines.len() + k) as u64, samples);
            trials.never(&variant, "samples that pdf or eval contradicts", found.contradicted, samples);
            let mut right = grid.expected(material, wo);
            let impossible =
                found.cells.iter().zip(&right).filter(|(seen, right)| **seen > 0.0 && **right == 0.0).count();
            trials.never(&variant, "cells with samples where the density is 0", impossible as u64, right.len() as u64);
            let whole: f64 = right.iter().sum();
            trials.at_most(format!("{variant}: integral of the density"), 1.0 + 1e-4, whole);
            found.cells.push(found.without_density);
            right.push((1.0 - whole).max(0.0));
            for share in &mut right {
                *share *= samples as f64;
            }
            judged += u32::from(whole > 0.0);
            trials.deviates_below(format!("{variant}: chi-square"), limit, against(&found.cells, &right));
        }
    }
    // These have a density: diffuse, polished, five rough conductors, and six kd-ks of two kinds.
    trials.at_least("materials and angles with a density", 20.0 * cosines.len() as f64, judged.into());
}
