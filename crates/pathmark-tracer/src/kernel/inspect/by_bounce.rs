//! The light of an image by the bounces that it made, and where paths end: the terms of the Neumann series L = E + KE + K²E + ... that
//! report B writes down, where E is what surfaces give off and K is one bounce.

use super::Inspector;
use crate::estimator::Probe;
use crate::math::Rgb;
use crate::scene::Tests;
use std::ops::Range;

/// What arrives over exactly so many bounces.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BounceRow {
    /// The sum of that light over all samples.
    pub light: [f64; 3],
    /// Parts of paths that ended after so many bounces.
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
    /// The row of each number of bounces, from 0.
    pub rows: Vec<BounceRow>,
    /// Samples.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Samples that were no valid radiance; nothing of them is in the rows.
    pub invalid: u64,
}

impl LightByBounce {
    /// The samples of some rows of an image of that width, added up row by row.
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

    /// Adds other samples'.
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

    /// Mean radiance over exactly so many bounces, per channel.
    pub fn mean(&self, bounces: usize) -> [f64; 3] {
        let light = self.rows.get(bounces).map_or([0.0; 3], |row| row.light);
        light.map(|sum| sum / self.samples.max(1) as f64)
    }

    /// Parts of paths: one for each sample, and one more for each split.
    pub fn parts(&self) -> u64 {
        self.rows.iter().map(|row| row.ended).sum()
    }

    /// Bounces of a part in the mean; `None` if nothing ended.
    pub fn mean_length(&self) -> Option<f64> {
        let bounces: f64 = (0u64..).zip(&self.rows).map(|(bounces, row)| (bounces * row.ended) as f64).sum();
        (self.parts() > 0).then(|| bounces / self.parts() as f64)
    }

    /// Bounces of the longest part.
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
