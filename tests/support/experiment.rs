//! A small experiment as a user would write it.

use std::fs;
use std::path::{Path, PathBuf};

/// Five cells (`serial` ignores threads) of one image, with three repetitions.
pub(crate) const TINY: &str = r#"title = "Tiny"
question = "Does it run?"
analysis = "It did."
figures = ["speedup", "schedules"]

[matrix]
scene = ["cornell"]
estimator = ["smallpt"]
spp = [4]
seed = [1]
strategy = ["serial", "static-blocks", "work-stealing"]
threads = [1, 2]
decomposition = ["tiles:8x8"]

[quick]
size = [24, 16]
repetitions = 3

[full]
size = [32, 16]
repetitions = 10
"#;

/// Writes `tiny.toml` into a folder.
pub(crate) fn write_tiny(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("tiny.toml");
    fs::write(&path, text).expect("a definition is written");
    path
}
