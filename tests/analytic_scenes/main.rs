//! Scenes whose light is known in closed form: A1 to A14 and A21 of the catalogue of hard cases, through every estimator that reaches them.
//!
//! A value must lie within its interval at the family-wise level 1e-3, two-sided, and the interval within 0.3 % of the exact value.
//! Where nothing is left to chance, rounding alone is allowed.

#[path = "../support/estimate.rs"]
mod estimate;
mod form_factors;
mod glass;
mod metal;
mod point_lights;
mod spheres;

/// Those of [`estimate::full_estimators`] without smallpt's own, whose paths differ from `bsdf`'s only at glass: costly scenes without any need not
/// be seen twice.
fn unsplit_estimators() -> impl Iterator<Item = &'static str> {
    estimate::full_estimators().filter(|name| *name != "smallpt")
}
