//! Ray against triangle, and against plane.
//!
//! Watertight after Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013: corners are
//! sheared so that the ray is the z axis, and the signs of three edge functions decide. Two triangles that share an
//! edge compute the same product with opposite signs, so no ray passes between them; a ray through the edge itself
//! meets both. The paper's second test in a higher precision is left out: a point that is on an edge to the last digit
//! counts as inside.

use super::{Real, Vec3, dot};

/// The ray's own axes: z is the direction's longest component, and the shear maps the direction onto it.
#[derive(Debug, Clone, Copy)]
pub struct Shear<T = f64> {
    /// Indices of the coordinates that become x, y and z.
    pub axes: [usize; 3],
    /// For each unit of z: the terms subtracted from x and from y, and the new z.
    pub by: [T; 3],
}

#[inline(always)]
fn component(v: Vec3, axis: usize) -> f64 {
    match axis {
        0 => v.x,
        1 => v.y,
        _ => v.z,
    }
}

impl Shear {
    /// The axes of rays in that direction.
    #[inline(always)]
    pub fn of(direction: Vec3) -> Self {
        let (x, y, z) = (direction.x.abs(), direction.y.abs(), direction.z.abs());
        let axes = if x > y && x > z {
            [1, 2, 0]
        } else if y > z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let inverse = 1.0 / component(direction, axes[2]);
        Self { axes, by: [component(direction, axes[0]) * inverse, component(direction, axes[1]) * inverse, inverse] }
    }

    /// A vector in the ray's axes.
    #[inline(always)]
    pub fn turned(&self, v: Vec3) -> [f64; 3] {
        let [x, y, z] = self.axes;
        [component(v, x), component(v, y), component(v, z)]
    }
}

/// A corner relative to the ray's origin and in its axes, sheared so that the ray is the z axis. A corner has the same
/// bits in all its triangles.
#[inline(always)]
pub fn sheared<T: Real>([x, y, z]: [T; 3], [sx, sy, sz]: [T; 3]) -> [T; 3] {
    [x - sx * z, y - sy * z, sz * z]
}

/// The edge function of two corners: twice the area that they span with the ray.
///
/// In double precision its error is the rounding error of its products, which exceeds its value if a triangle is seen
/// as a sliver. Where product and sum are rounded at once, it is right to the last digit but one, whatever cancels
/// (Jeannerod, Louvet and Muller, "Further Analysis of Kahan's Algorithm for the Accurate Computation of 2 x 2
/// Determinants", 2013).
#[inline(always)]
fn across<T: Real>([px, py, _]: [T; 3], [qx, qy, _]: [T; 3]) -> T {
    let product = py * qx;
    if T::IS_DOUBLE {
        return px * qy - product;
    }
    let lost = (-py).times_plus(qx, product);
    px.times_plus(qy, -product) + lost
}

/// The point where the z axis crosses the plane of a triangle.
#[derive(Debug, Clone, Copy)]
pub struct Crossing<T: Real> {
    /// Whether the point is within the triangle, seen from either side. Only valid if the triangle has an area.
    pub is_met: T::Mask,
    /// Weights of the corners.
    weights: [T; 3],
    heights: [T; 3],
}

impl<T: Real> Crossing<T> {
    /// The crossing with the triangle of these corners.
    #[inline(always)]
    pub fn of([a, b, c]: [[T; 3]; 3]) -> Self {
        let weights @ [u, v, w] = [across(c, b), across(a, c), across(b, a)];
        let zero = T::splat(0.0);
        let front = zero.le(u) & zero.le(v) & zero.le(w);
        let back = u.le(zero) & v.le(zero) & w.le(zero);
        Self { is_met: front | back, weights, heights: [a[2], b[2], c[2]] }
    }

    /// Distance from the origin; NaN if the triangle is not met.
    #[inline(always)]
    pub fn root(&self) -> T {
        let ([u, v, w], [a, b, c], zero) = (self.weights, self.heights, T::splat(0.0));
        let determinant = u + v + w;
        let t = (u * a + v * b + w * c) / determinant;
        // Seen edge on, the determinant is zero and the quotient infinite or NaN.
        let has_area = determinant.lt(zero) | zero.lt(determinant);
        T::select(self.is_met & has_area, t, T::splat(f64::NAN))
    }
}

/// Distance from the origin along the z axis to the triangle with these corners, seen from either side; NaN if it misses.
#[inline(always)]
pub fn triangle_root<T: Real>(a: [T; 3], b: [T; 3], c: [T; 3]) -> T {
    Crossing::of([a, b, c]).root()
}

/// Distance at which a ray in that direction meets a plane with that normal; NaN or not above zero if it does not.
/// `to_plane` leads from the ray's origin to any point of the plane.
///
/// Along the plane the quotient is infinite or NaN, and neither is a hit. There is no threshold for other angles.
#[inline(always)]
pub fn plane_root<T: Real>(to_plane: Vec3<T>, direction: Vec3<T>, normal: Vec3<T>) -> T {
    let t = dot(to_plane, normal) / dot(direction, normal);
    T::select(t.lt(T::splat(f64::INFINITY)), t, T::splat(f64::NAN))
}
