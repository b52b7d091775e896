//! Many paths at a time, in the lanes of SIMD registers: `--kernel lanes`. Each lane follows its own path from vertex
//! to vertex and takes the next sample when the path has ended. Sums are taken in the order of the samples (`window`).
//! So in f64 an image equals the scalar kernel's image, bit for bit, with every instruction set.

mod bvh;
mod filter;
mod kernel;
mod light;
mod nearest;
mod others;
mod packet;
mod rays;
mod render;
mod search;
mod spheres_f32;
mod supply;
mod tables;
mod targets;
#[cfg(test)]
mod tests;
mod vertex;
mod window;

pub(crate) use kernel::LANES;
pub(crate) use kernel::MOST_IN_LANES;
#[cfg(feature = "device")]
pub(crate) use spheres_f32::SpheresF32;
#[cfg(feature = "device")]
pub(crate) use tables::surfaces;
