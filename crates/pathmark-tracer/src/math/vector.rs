//! Three numbers: a point, a direction or a normal; and half lines.

use super::Real;
use std::ops::{Add, Mul, Neg, Sub};

/// A vector with its components in scene units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vec3<T = f64> {
    pub x: T,
    pub y: T,
    pub z: T,
}

/// The scalar product.
#[inline(always)]
pub fn dot<T: Real>(a: Vec3<T>, b: Vec3<T>) -> T {
    a.z.times_plus(b.z, a.y.times_plus(b.y, a.x * b.x))
}

impl<T> Vec3<T> {
    /// The vector with these components.
    #[inline(always)]
    pub const fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z }
    }
}

impl<T: Real> Vec3<T> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(v: Vec3) -> Self {
        Self::new(T::splat(v.x), T::splat(v.y), T::splat(v.z))
    }

    /// Component by component: `yes` where the mask holds, `no` elsewhere.
    #[inline(always)]
    #[must_use]
    pub fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Self::new(T::select(mask, yes.x, no.x), T::select(mask, yes.y, no.y), T::select(mask, yes.z, no.z))
    }

    /// The vector product, right-handed.
    #[inline(always)]
    #[must_use]
    pub fn cross(self, b: Self) -> Self {
        Self::new(self.y * b.z - self.z * b.y, self.z * b.x - self.x * b.z, self.x * b.y - self.y * b.x)
    }

    #[inline(always)]
    #[must_use]
    pub fn times_plus(self, factor: T, addend: Self) -> Self {
        Self::new(
            self.x.times_plus(factor, addend.x),
            self.y.times_plus(factor, addend.y),
            self.z.times_plus(factor, addend.z),
        )
    }

    /// The direction of `self` with length 1; NaN for the zero vector.
    #[inline(always)]
    #[must_use]
    pub fn normalized(self) -> Self {
        self * (T::splat(1.0) / dot(self, self).sqrt())
    }
}

impl Vec3 {
    /// The largest absolute component.
    #[inline(always)]
    pub fn largest(self) -> f64 {
        self.x.abs().max(self.y.abs()).max(self.z.abs())
    }
}

impl From<[f64; 3]> for Vec3 {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<T: Real> Add for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<T: Real> Sub for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<T: Real> Mul<T> for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: T) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<T: Real> Neg for Vec3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// Origin and direction. The integrator keeps directions at length 1; the intersection formulas that take a squared length do not need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray<T = f64> {
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
