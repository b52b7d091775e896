//! Effects that only some scenes use: fog, lenses, cut paths, metal, point lights, Whitted's estimator. Each has its
//! effect there, and none elsewhere.

mod camera;
mod depth;
mod fog;
mod metal;
mod point_lights;
mod small_stack;
mod unused;
mod whitted;
