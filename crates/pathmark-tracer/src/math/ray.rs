//! A half line.

use super::{Real, Vec3};

/// Origin and direction. The integrator keeps directions at length 1; the intersection formulas that take a squared length do not need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray<T = f64> {
    /// Its start.
    pub origin: Vec3<T>,
    pub direction: Vec3<T>,
}

impl<T: Real> Ray<T> {
    /// The point at distance `t`, in lengths of the direction.
    #[inline(always)]
    pub fn at(&self, t: T) -> Vec3<T> {
        self.direction.times_plus(t, self.origin)
    }
}
