//! Tests of the library without the program, in one test program, because each one that links the library takes
//! seconds to build.

mod approximations;
mod atomic_file;
mod convergence;
mod determinism;
mod documents;
mod effects;
mod energy;
#[path = "../support/estimate.rs"]
mod estimate;
mod estimators;
mod every_scene;
mod features;
mod hard_cases;
mod image_io;
mod image_notes;
mod lanes;
mod layering;
mod metric;
mod mistakes;
mod pairing;
mod peer;
// Other systems list no processors.
#[cfg(target_os = "linux")]
mod pinning;
mod png_chunks;
mod properties;
mod prose;
mod rounds;
mod samplers;
mod scene_identity;
mod scene_keys;
#[path = "../support/scene_text.rs"]
mod scene_text;
mod schedule_invariance;
mod shards;
mod slopes;
#[path = "../support/watchdog.rs"]
mod watchdog;
mod workflows;
mod workloads;
