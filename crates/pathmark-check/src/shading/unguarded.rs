//! Shading without guards: Schlick's polynomial, frames with a pole, sampling by the cosine, GGX in its usual form,
//! the second report's guards, cones by 1 - cos. It serves for timing and to show that the inputs of the cases are
//! hard. No renderer uses it.

use crate::material::Ggx;
use crate::math::{Frame, Vec3, dot, fresnel_schlick, sin_cos_turns};
use crate::sampling::{cosine_hemisphere, mix, unit};
use std::f64::consts::PI;

/// The reflectance of a dielectric by Schlick's polynomial, with the arguments of [`crate::math::fresnel_dielectric`]:
/// the cosine on the side of the light, and the far index over the near index. Like smallpt, it uses the cosine in the
/// thinner medium.
pub(crate) fn schlick(cos: f64, eta: f64) -> f64 {
    let root = (eta - 1.0) / (eta + 1.0);
    if eta >= 1.0 {
        return fresnel_schlick(cos, root * root);
    }
    let beyond = 1.0 - (1.0 - cos * cos) / (eta * eta);
    if beyond < 0.0 { 1.0 } else { fresnel_schlick(beyond.sqrt(), root * root) }
}

/// Frisvad, "Building an Orthonormal Basis from a 3D Unit Vector Without Normalization", Journal of Graphics Tools 16(3), 2012: 1 + z
/// loses its digits near z = -1.
pub(crate) fn frisvad_frame(n: Vec3) -> Frame {
    if n.z < -0.999_999_9 {
        return Frame { s: Vec3::new(0.0, -1.0, 0.0), t: Vec3::new(-1.0, 0.0, 0.0), n };
    }
    let a = 1.0 / (1.0 + n.z);
    let b = -n.x * n.y * a;
    Frame { s: Vec3::new(1.0 - n.x * n.x * a, b, -n.x), t: Vec3::new(b, 1.0 - n.y * n.y * a, -n.y), n }
}

/// The same frame in single precision.
pub(crate) fn frisvad_f32([x, y, z]: [f32; 3]) -> Frame {
    let wide = |v: [f32; 3]| Vec3::from(v.map(f64::from));
    if z < -0.999_999_9 {
        return Frame { s: Vec3::new(0.0, -1.0, 0.0), t: Vec3::new(-1.0, 0.0, 0.0), n: wide([x, y, z]) };
    }
    let a = 1.0 / (1.0 + z);
    let b = -x * y * a;
    Frame { s: wide([1.0 - x * x * a, b, -x]), t: wide([b, 1.0 - y * y * a, -y]), n: wide([x, y, z]) }
}

/// smallpt's frame: the cross product with an axis that is far enough from the normal, normalised.
pub(crate) fn smallpt_frame(n: Vec3) -> Frame {
    let axis = if n.x.abs() > 0.1 { Vec3::new(0.0, 1.0, 0.0) } else { Vec3::new(1.0, 0.0, 0.0) };
    let s = axis.cross(n).normalized();
    Frame { s, t: n.cross(s), n }
}

/// GGX's density of normals in the usual form, in which 1 + cos² (α² - 1) cancels.
pub(crate) fn cancelling_density(alpha: f64, h: Vec3) -> f64 {
    let alpha2 = alpha * alpha;
    let base = 1.0 + h.z * h.z * (alpha2 - 1.0);
    alpha2 / (PI * base * base)
}

/// The same in single precision: divides by 0 at the centre of the lobe for α = 1e-4.
pub(crate) fn cancelling_density_f32(alpha: f32, cos: f32) -> f32 {
    let alpha2 = alpha * alpha;
    let base = 1.0 + cos * cos * (alpha2 - 1.0);
    alpha2 / (std::f32::consts::PI * base * base)
}

/// The program's form in single precision, from the components of the normal.
pub(crate) fn density_f32(alpha: f32, [x, y, z]: [f32; 3]) -> f32 {
    let alpha2 = alpha * alpha;
    let a = (x * x + y * y) / alpha2 + z * z;
    1.0 / (std::f32::consts::PI * alpha2 * a * a)
}

/// tan² of the angle with this cosine, computed from the angle.
pub(crate) fn squared_tangent_of_angle(cos: f64) -> f64 {
    let tan = libm::tan(libm::acos(cos));
    tan * tan
}

/// Mean and variance of the samples of an estimate.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moments {
    pub(crate) mean: f64,
    pub(crate) variance: f64,
}

impl Moments {
    fn of(samples: u64, value: impl Fn([f64; 2]) -> f64) -> Self {
        let (mut mean, mut squares) = (0.0, 0.0);
        for k in 0..samples {
            let key = mix(k);
            let found = value([unit(key), unit(mix(key))]);
            // Welford's update: the difference of two large sums would lose a small variance.
            let off = found - mean;
            mean += off / (k + 1) as f64;
            squares += off * (found - mean);
        }
        Self { mean, variance: squares / (samples - 1) as f64 }
    }

    pub(crate) fn standard_error(self, samples: u64) -> f64 {
        (self.variance / samples as f64).sqrt()
    }
}

fn towards(cos: f64) -> Vec3 {
    Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos)
}

/// The directional albedo of GGX facets with F = 1, by cosine-distributed directions.
pub(crate) fn albedo_by_cosines(ggx: Ggx, cos: f64, samples: u64) -> Moments {
    let wo = towards(cos);
    // bsdf cos over cos/π.
    Moments::of(samples, |u| ggx.reflection(wo, cosine_hemisphere(u)) * PI)
}

/// The same albedo by visible normals.
pub(crate) fn albedo_by_visible_normals(ggx: Ggx, cos: f64, samples: u64) -> Moments {
    let wo = towards(cos);
    Moments::of(samples, |u| {
        let h = ggx.visible_normal(wo, u);
        let wi = (h * (2.0 * dot(wo, h)) - wo).normalized();
        if wi.z > 0.0 { ggx.unshadowed(wo, wi) } else { 0.0 }
    })
}

/// The same albedo by normals that follow D cos, visible or not: the weight is unbounded at grazing directions.
pub(crate) fn albedo_by_normals(ggx: Ggx, cos: f64, samples: u64) -> Moments {
    let wo = towards(cos);
    Moments::of(samples, |[u, v]| weight_by_normals(ggx, wo, [u, v]))
}

/// One weight of this estimate: G2 (wo.h)/(cos h.z).
pub(crate) fn weight_by_normals(ggx: Ggx, wo: Vec3, [u, v]: [f64; 2]) -> f64 {
    // tan² = α² v/(1 - v).
    let tan2 = ggx.alpha() * ggx.alpha() * v / (1.0 - v);
    let z = 1.0 / (1.0 + tan2).sqrt();
    let rim = tan2.sqrt() * z;
    let (sin, cos) = sin_cos_turns(u);
    let h = Vec3::new(rim * cos, rim * sin, z);
    let turned = dot(wo, h);
    let wi = h * (2.0 * turned) - wo;
    if turned > 0.0 && wi.z > 0.0 { ggx.masking(wo) * ggx.unshadowed(wo, wi) * turned / (wo.z * z) } else { 0.0 }
}

/// The second report replaces a quotient by 1 if its divisor is below this.
const REPORT_GUARD: f64 = 0.001;

/// The second report's D G/(4 cos cos) for facets with F = 1, with its two guards.
pub(crate) fn reflection_of_report_b(roughness: f64, wo: Vec3, wi: Vec3) -> f64 {
    let roughness2 = roughness * roughness;
    let lambda = |w: Vec3| 0.5 * (1.0 + roughness2 * (1.0 - w.z * w.z) / (w.z * w.z)).sqrt() - 0.5;
    let g = 1.0 / (1.0 + lambda(wo) + lambda(wi));
    let h = (wo + wi).normalized();
    let base = 1.0 + h.z * h.z * (roughness2 - 1.0);
    let divisor = PI * base * base;
    let d = if divisor < REPORT_GUARD { 1.0 } else { roughness2 / divisor };
    let divisor = 4.0 * wo.z * wi.z;
    if divisor < REPORT_GUARD { 1.0 } else { g * d / divisor }
}

/// The second report's mirror: F/cos, and 0 where the cosine is below 0.001.
pub(crate) fn mirror_of_report_b(fresnel: f64, cos: f64) -> f64 {
    if cos < REPORT_GUARD { 0.0 } else { fresnel / cos * cos }
}

/// 1 - cos of the half angle that a sphere subtends, as in smallpt's explicit version: no digit is right at 1e8 radii,
/// and the result is NaN inside.
pub(crate) fn naive_one_minus_cos(radius: f64, distance: f64) -> f64 {
    let sin = radius / distance;
    1.0 - (1.0 - sin * sin).sqrt()
}

/// The same in single precision: 0, and so an infinite density, from about 5800 radii on.
pub(crate) fn naive_one_minus_cos_f32(radius: f32, distance: f32) -> f32 {
    let sin = radius / distance;
    1.0 - (1.0 - sin * sin).sqrt()
}

/// The power heuristic computed with squares, which overflow.
pub(crate) fn power_heuristic_by_squares(a: f64, b: f64) -> f64 {
    a * a / (a * a + b * b)
}

/// A triangle warp without the square root: points crowd at one corner.
pub(crate) fn crowded_triangle([u, v]: [f64; 2]) -> [f64; 2] {
    [u * (1.0 - v), u * v]
}
