//! Vectors, colours, rays and the leaf formulas of the path, written once over a small number trait.
//!
//! Nothing here calls the platform's elementary functions, so a path has the same bits everywhere.

mod bits;
mod frame;
mod optics;
mod real;
mod rgb;
mod sphere;
mod triangle;
mod trig;
mod vector;

pub use bits::{Bits, single_unit, unit};
pub use frame::Frame;
pub use optics::{fresnel_dielectric, fresnel_schlick, reflect, refract};
pub use real::{Precision, Real};
pub use rgb::Rgb;
pub use sphere::{
    SphereByCurvature, curved_normal, curved_quadratic, first_root, first_root_curved, last_root_curved, line_meets,
    other_root, roots,
};
pub use triangle::{Crossing, Shear, plane_root, sheared, triangle_root};
pub use trig::{COS, SIN, sin_cos_turns};
pub use vector::{Ray, Vec3, dot};
