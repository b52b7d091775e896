//! Embeds every scene of `experiments/scenes`, the target of the symbolic link `scenes`.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=scenes");
    println!("cargo::rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    embed("toml", &out.join("scenes.rs"))?;
    embed("obj", &out.join("meshes.rs"))
}

/// Writes an array of (name, text) over the scenes or their meshes, sorted by name. Scenes are named by file stem;
/// meshes keep their extension, as scenes refer to them by file name.
fn embed(extension: &str, target: &Path) -> io::Result<()> {
    let root = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default()).join("scenes");
    let mut files: Vec<PathBuf> =
        fs::read_dir(root)?.map(|entry| entry.map(|e| e.path())).collect::<io::Result<_>>()?;
    files.retain(|path| path.extension().is_some_and(|own| own == extension));
    files.sort();
    let mut code = String::from("&[");
    for file in files {
        let name = if extension == "toml" { file.file_stem() } else { file.file_name() };
        let name = name.unwrap_or_default().to_string_lossy();
        // Writing to a string cannot fail.
        let _ = write!(code, "({name:?}, include_str!({:?})),", file.display().to_string());
    }
    code.push(']');
    fs::write(target, code)
}
