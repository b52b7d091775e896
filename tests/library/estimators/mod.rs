//! Estimators that aim at light: what they aim at, that all estimators agree on every scene, and what they gain.

mod agreement;
mod aims;
mod camera_rays;
mod gain;
