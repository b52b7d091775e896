//! The GGX distribution of microfacet normals (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007, equations
//! 33 and 34) with Smith's height-correlated masking and shadowing (Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based
//! BRDFs", Journal of Computer Graphics Techniques 3(2), 2014, equation 99).
//!
//! All formulas use r(w) = sqrt(w.z² + α²(w.x² + w.y²)), with which Smith's Λ is (r - z)/2z. They need no tangent of an
//! arccosine, have no cancellation, and need no guard against division by small cosines.

use crate::input::roughness;
use crate::math::{Real, Vec3, dot, sin_cos_turns};
use serde::Deserializer;
use std::f64::consts::PI;

/// The distribution for one roughness. Directions are unit vectors in the local frame, whose z axis is the normal of
/// the macroscopic surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ggx {
    alpha: f64,
}

/// The facets of a surface: one mirror, or many small ones. The smooth surface is a separate variant and not the limit
/// of small α.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Facets {
    Mirror,
    /// Small mirrors that face many directions.
    Rough(Ggx),
}

/// Reads a roughness: 0 is a mirror.
pub(super) fn facets<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Facets, D::Error> {
    roughness(deserializer).map(Facets::of)
}

impl Facets {
    /// Returns a mirror for 0, GGX for any other α.
    pub fn of(alpha: f64) -> Self {
        if alpha == 0.0 { Self::Mirror } else { Self::Rough(Ggx { alpha }) }
    }
}

impl Ggx {
    /// Returns the distribution with this α; `None` unless α is from 1e-4 to 1.
    pub fn new(alpha: f64) -> Option<Self> {
        (1e-4..=1.0).contains(&alpha).then_some(Self { alpha })
    }

    pub fn alpha(self) -> f64 {
        self.alpha
    }

    #[inline(always)]
    fn r<T: Real>(self, w: Vec3<T>) -> T {
        let alpha = T::splat(self.alpha);
        (w.z * w.z + alpha * alpha * (w.x * w.x + w.y * w.y)).sqrt()
    }

    /// Returns D: the area of facets with normal `h`, per steradian and per area of the surface. The relative error is
    /// below 20 rounding errors.
    #[inline(always)]
    pub fn density<T: Real>(self, h: Vec3<T>) -> T {
        let (zero, one, alpha2) = (T::splat(0.0), T::splat(1.0), T::splat(self.alpha * self.alpha));
        // The equivalent form with 1 + cos²(α² - 1) cancels: for α = 1e-4 it has no correct digit in single precision.
        let a = (h.x * h.x + h.y * h.y) / alpha2 + h.z * h.z;
        T::select(h.z.le(zero), zero, one / (T::splat(PI) * alpha2 * a * a))
    }

    /// Returns G1: the share of facets facing `w` that is visible from there.
    #[inline(always)]
    pub fn masking(self, w: Vec3) -> f64 {
        if w.z > 0.0 { 2.0 * w.z / (w.z + self.r(w)) } else { 0.0 }
    }

    /// Returns G2/G1: the share of facets visible from `wo` that is also visible from `wi`.
    #[inline(always)]
    pub fn unshadowed<T: Real>(self, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let (ro, ri) = (self.r(wo), self.r(wi));
        wi.z * (wo.z + ro) / (wi.z * ro + wo.z * ri)
    }

    /// Returns D G2 / (4 cos cos): the BSDF of facets that reflect all light. It is 0 unless both directions are above
    /// the surface.
    #[inline(always)]
    pub fn reflection<T: Real>(self, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let (zero, two) = (T::splat(0.0), T::splat(2.0));
        let value = self.density((wo + wi).normalized()) / (two * (wi.z * self.r(wo) + wo.z * self.r(wi)));
        T::select(wo.z.le(zero) | wi.z.le(zero), zero, value)
    }

    /// Returns D G1 / (4 cos): the density per steradian of `wi`, the mirror direction at a normal from
    /// [`Ggx::visible_normal`]. Directions below the surface have a density, too, so it integrates to 1 over the
    /// sphere.
    #[inline(always)]
    pub fn pdf<T: Real>(self, wo: Vec3<T>, wi: Vec3<T>) -> T {
        let (zero, two, sum) = (T::splat(0.0), T::splat(2.0), wo + wi);
        let value = self.density(sum.normalized()) / (two * (wo.z + self.r(wo)));
        T::select(wo.z.lt(zero) | sum.z.le(zero), zero, value)
    }

    /// Samples a facet's normal in proportion to its area visible from `wo`: Dupuy and Benyoub, "Sampling Visible GGX
    /// Normals with Spherical Caps", Computer Graphics Forum 42(8), 2023, after Heitz, "Sampling the GGX Distribution
    /// of Visible Normals", Journal of Computer Graphics Techniques 7(4), 2018.
    #[inline(always)]
    pub fn visible_normal<T: Real>(self, wo: Vec3<T>, [u, v]: [T; 2]) -> Vec3<T> {
        let (zero, one, alpha) = (T::splat(0.0), T::splat(1.0), T::splat(self.alpha));
        // Stretched, the facets form a half sphere; mirror directions at its visible part are uniform over a cap.
        let stretched = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalized();
        let height = (one - v) * (one + stretched.z);
        let z = height - stretched.z;
        let square = one - z * z;
        let rim = T::select(zero.lt(square), square, zero).sqrt();
        let (sin, cos) = sin_cos_turns(u);
        Vec3::new(alpha * (rim * cos + stretched.x), alpha * (rim * sin + stretched.y), height).normalized()
    }

    /// Returns the normal of a facet from [`Ggx::visible_normal`], and the mirror direction of `wo` there.
    #[inline(always)]
    pub(super) fn mirrored_at_facet<T: Real>(self, wo: Vec3<T>, u: [T; 2]) -> (Vec3<T>, Vec3<T>) {
        let h = self.visible_normal(wo, u);
        (h, (h * (T::splat(2.0) * dot(wo, h)) - wo).normalized())
    }
}
