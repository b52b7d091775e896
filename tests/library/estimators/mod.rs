//! Estimators that aim at light: their aims, the agreement of all estimators on every scene, and the gain.

mod agreement;
mod aims;
mod camera_rays;
mod gain;
