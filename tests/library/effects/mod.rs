//! Effects that only some scenes call for: fog, lenses, cut paths, metal, point lights, Whitted's estimator; what they do, and that they do nothing
//! elsewhere.

mod camera;
mod depth;
mod fog;
mod metal;
mod point_lights;
mod small_stack;
mod unused;
mod whitted;
