//! Light of an image by number of bounces, and the lengths of paths: the terms of report B's Neumann series
//! L = E + KE + K²E + ..., where E is the emission of surfaces and K is one bounce.

use super::Inspector;
use crate::estimator::Probe;
use crate::math::Rgb;
use crate::scene::Tests;
use std::ops::Range;

/// The light that arrives after exactly this number of bounces.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BounceRow {
    /// The sum of that light over all samples.
    pub light: [f64; 3],
    /// Parts of paths that ended after this number of bounces.
    pub ended: u64,
}

impl BounceRow {
    fn add(&mut self, other: &Self) {
        for (sum, value) in self.light.iter_mut().zip(other.light) {
            *sum += value;
        }
        self.ended += other.ended;
    }
}

/// Light and path lengths of some samples, by bounces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LightByBounce {
    /// One row for each number of bounces, from 0.
    pub rows: Vec<BounceRow>,
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Samples with an invalid radiance; the rows contain nothing of them.
    pub invalid: u64,
}

impl LightByBounce {
    /// Adds up the samples of some rows of an image of that width, row by row.
    pub fn of(inspector: &Inspector, width: u32, rows: Range<u32>, samples: &Range<u32>) -> Self {
        let mut total = Self::default();
        for y in rows {
            let mut row = Self::default();
            for x in 0..width {
                for sample in samples.clone() {
                    let mut one = Self { samples: 1, ..Self::default() };
                    let radiance = inspector.estimate(x, y, sample, &mut one);
                    if radiance.is_valid_radiance() {
                        row.add(&one);
                    } else {
                        row.add(&Self { samples: 1, rays: one.rays, invalid: 1, ..Self::default() });
                    }
                }
            }
            total.add(&row);
        }
        total
    }

    /// Adds the light of other samples.
    pub fn add(&mut self, other: &Self) {
        if self.rows.len() < other.rows.len() {
            self.rows.resize(other.rows.len(), BounceRow::default());
        }
        for (row, other) in self.rows.iter_mut().zip(&other.rows) {
            row.add(other);
        }
        self.samples += other.samples;
        self.rays += other.rays;
        self.invalid += other.invalid;
    }

    /// Mean radiance after exactly this number of bounces, per channel.
    pub fn mean(&self, bounces: usize) -> [f64; 3] {
        let light = self.rows.get(bounces).map_or([0.0; 3], |row| row.light);
        light.map(|sum| sum / self.samples.max(1) as f64)
    }

    /// Parts of paths: one for each sample, and one more for each split.
    pub fn parts(&self) -> u64 {
        self.rows.iter().map(|row| row.ended).sum()
    }

    /// Mean number of bounces of a part; `None` if no part ended.
    pub fn mean_length(&self) -> Option<f64> {
        let bounces: f64 = (0u64..).zip(&self.rows).map(|(bounces, row)| (bounces * row.ended) as f64).sum();
        (self.parts() > 0).then(|| bounces / self.parts() as f64)
    }

    /// Bounces of the longest part; `None` if no part ended.
    pub fn longest(&self) -> Option<usize> {
        self.rows.iter().rposition(|row| row.ended > 0)
    }

    fn row(&mut self, bounces: u16) -> &mut BounceRow {
        let index = usize::from(bounces);
        if index >= self.rows.len() {
            self.rows.resize(index + 1, BounceRow::default());
        }
        &mut self.rows[index]
    }
}

impl Probe for LightByBounce {
    fn ray(&mut self, _tests: Tests) {
        self.rays += 1;
    }
    fn light(&mut self, bounces: u16, contribution: Rgb) {
        self.row(bounces).add(&BounceRow { light: contribution.channels(), ended: 0 });
    }
    fn ended(&mut self, bounces: u16) {
        self.row(bounces).ended += 1;
    }
}
