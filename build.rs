//! Stamps the binary with its commit, and embeds every experiment in `experiments/`.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs, io};

/// Sources that a render depends on: an uncommitted change elsewhere does not mark a measurement as dirty.
const SOURCES: [&str; 6] = ["src", "crates", "experiments", "Cargo.toml", "Cargo.lock", "build.rs"];

fn main() -> io::Result<()> {
    for source in SOURCES {
        println!("cargo::rerun-if-changed={source}");
    }
    // Naming a missing file would make every build run this script again.
    if Path::new(".git/logs/HEAD").exists() {
        println!("cargo::rerun-if-changed=.git/logs/HEAD");
    }
    let commit = output("git", &["rev-parse", "--short=12", "HEAD"]).unwrap_or_else(|| "unknown".to_string());
    let mut status = vec!["status", "--porcelain", "--"];
    status.extend(SOURCES);
    let dirty = output("git", &status).is_none_or(|changes| !changes.is_empty());
    println!("cargo::rustc-env=PATHMARK_COMMIT={commit}");
    println!("cargo::rustc-env=PATHMARK_DIRTY={dirty}");

    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    embed("experiments", &out.join("experiments.rs"))?;
    embed("experiments/claims", &out.join("claims.rs"))
}

fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8_lossy(&output.stdout).trim().to_string())
}

/// Writes an array of (name, text) over the definitions in a folder, sorted by name.
fn embed(folder: &str, target: &Path) -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join(folder);
    let mut files: Vec<PathBuf> =
        fs::read_dir(root)?.map(|entry| entry.map(|e| e.path())).collect::<io::Result<_>>()?;
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    let mut code = String::from("&[");
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        // Writing to a string cannot fail.
        let _ = write!(code, "({name:?}, include_str!({:?})),", file.display().to_string());
    }
    code.push(']');
    fs::write(target, code)
}
