//! Layers of modules: each module imports only modules above it (CONTRIBUTING, Layers), so that a part can be
//! understood, tested and replaced without its users. The compiler accepts cycles among modules; this test does not.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// An exception to the layers: more modules besides those above, or only the named modules.
enum Exception {
    Besides(&'static [&'static str]),
    Only(&'static [&'static str]),
}

use Exception::{Besides, Only};

/// The layers are the table in CONTRIBUTING.md. Each exception to them has a line here, with its reason.
const EXCEPTIONS: &[(&str, Exception)] = &[
    ("input", Besides(&["error", "math"])), // errors with a place; numbers that become vectors and colours
    ("lock", Besides(&["error", "digest", "file_id"])),
    ("temporary", Besides(&["disk", "lock"])),
    ("atomic_file", Besides(&["error", "disk", "file_id", "temporary"])),
    ("csv_file", Besides(&["error", "atomic_file"])),
    ("files", Besides(&["error", "file_id", "atomic_file"])),
    ("metric", Besides(&["image_io"])),        // metrics compare images
    ("analysis", Only(&[])),                   // statistics on plain numbers, whatever was measured
    ("lab", Besides(&["kernel", "strategy"])), // the kernels and strategies that a lab offers
    // A strategy schedules integers: in a separate crate it cannot access pixels. It shares the kernel's layer, so
    // that only `measure` and its users can combine the two.
    ("strategy", Only(&[])),
    ("simulate", Only(&["analysis", "lab", "measure", "strategy"])), // numbers in, numbers out: no pixel, no thread, no clock
    ("check", Besides(&["experiment"])),                             // tests all parts of the renderer
    ("plot", Only(&["error", "atomic_file", "metric", "image_io"])), // draws numbers, whatever they were measured on
    ("report", Besides(&["plot"])),
];

/// The modules, each with its row in the table of CONTRIBUTING.md.
fn layers() -> BTreeMap<String, usize> {
    let text = fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let (_, section) = text.split_once("\n## Layers\n").unwrap();
    let section = section.split_once("\n## ").map_or(section, |(section, _)| section);
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2);
    let cells = rows.filter_map(|row| row.split('|').nth(1));
    let modules = |cell: &str| cell.split('`').skip(1).step_by(2).map(str::to_string).collect::<Vec<_>>();
    cells.enumerate().flat_map(|(row, cell)| modules(cell).into_iter().map(move |module| (module, row))).collect()
}

fn may_import(layers: &BTreeMap<String, usize>, module: &str, target: &str) -> bool {
    let is_above = layers.get(target).is_some_and(|layer| *layer < layers[module]);
    let exception = EXCEPTIONS.iter().find(|(name, _)| *name == module).map(|(_, exception)| exception);
    target == module
        || match exception {
            Some(Only(only)) => only.contains(&target),
            Some(Besides(besides)) => is_above || besides.contains(&target),
            None => is_above,
        }
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders of the project's own code, to which the limits on lints and lines apply.
const FOLDERS: [&str; 6] = ["src", "tests", "benches", "crates", "examples", "exercises"];

/// The crates of several layers, whose modules refer to each other by `crate`.
const SOURCES: [&str; 3] = ["crates/pathmark-harness/src", "crates/pathmark-tracer/src", "crates/pathmark-lanes/src"];

/// The crates that are a layer as a whole. They import the modules of the others as if they were their own.
const WHOLE: [(&str, &str); 4] = [
    ("crates/pathmark-check/src", "check"),
    ("crates/pathmark-report/src/plot", "plot"),
    ("crates/pathmark-report/src", "report"),
    ("crates/pathmark-cli/src", "cli"),
];

/// The location of a module's files: a separate crate that the package re-exports, a folder or a file.
fn home(module: &str) -> Option<PathBuf> {
    let inside = SOURCES.iter().flat_map(|source| [format!("{source}/{module}"), format!("{source}/{module}.rs")]);
    let places = [format!("crates/pathmark-{module}")].into_iter().chain(inside);
    places.into_iter().map(|place| root().join(place)).find(|place| place.exists())
}

/// The Rust files below a folder of the package; empty if there is no such folder.
fn rust_files(folder: &str) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![root().join(folder)]);
    while let Some(entries) = folders.pop().map(fs::read_dir) {
        for path in entries.into_iter().flatten().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

/// The code without the text behind `//`, so that documentation may mention any module.
fn code(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n")
}

/// The names that follow a path's prefix: one, or the heads of a group in braces.
fn heads(rest: &str) -> Vec<String> {
    let word = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let rest = rest.trim_start();
    let Some(group) = rest.strip_prefix('{') else { return vec![word(rest)] };
    let (mut heads, mut depth, mut start) = (Vec::new(), 0, 0);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            ',' | '}' if depth == 0 => {
                heads.push(word(group[start..at].trim_start()));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    heads
}

/// The top-level modules that a file at this depth names, by `crate::x` or by as many `super::` as lead to the root.
fn imports(text: &str, depth: usize) -> BTreeSet<String> {
    let code = code(text);
    let mut found = BTreeSet::new();
    for prefix in ["crate::".to_string(), "super::".repeat(depth)] {
        for (at, _) in code.match_indices(&prefix) {
            found.extend(heads(&code[at + prefix.len()..]));
        }
    }
    found.retain(|name| !name.is_empty() && home(name).is_some());
    found
}

#[test]
fn imports_are_found_wherever_they_stand() {
    // `strategy` is a crate, but its users import it like a module.
    assert_eq!(Vec::from_iter(imports("use crate::strategy::{Config, find};", 1)), ["strategy"]);
    let text = "use crate::{error::{Error, Result}, film::Film};\nuse crate::math::Vec3; // crate::cli\nfn f() { crate::scene::load() }";
    assert_eq!(Vec::from_iter(imports(text, 1)), ["error", "film", "math", "scene"]);
    assert_eq!(Vec::from_iter(imports("use super::super::cli; use super::plan;", 2)), ["cli"]);
    assert_eq!(Vec::from_iter(imports("use super::cli;", 1)), ["cli"]);
}

#[test]
fn modules_import_only_those_above() {
    let layers = layers();
    let (mut wrong, mut seen) = (Vec::new(), BTreeSet::new());
    let whole = WHOLE.map(|(source, _)| source);
    for (source, file) in
        SOURCES.iter().chain(&whole).flat_map(|source| rust_files(source).into_iter().map(move |file| (source, file)))
    {
        let is_within = |(folder, _): &&(&str, &str)| file.starts_with(root().join(folder));
        let layer = WHOLE.iter().find(is_within).map(|(_, module)| *module);
        let inner = file.strip_prefix(root().join(source)).unwrap();
        let shown = file.strip_prefix(root()).unwrap().display();
        let first = inner.components().next().unwrap().as_os_str().to_str().unwrap().trim_end_matches(".rs");
        let module = layer.unwrap_or(first);
        // The crate's roots name every module, in its declaration or by calling `cli`.
        if ["lib", "main"].contains(&module) {
            continue;
        }
        if !layers.contains_key(module) {
            wrong.push(format!("{shown}: module {module} has no place in CONTRIBUTING.md's table of layers"));
            continue;
        }
        seen.insert(module.to_string());
        let parts = inner.components().count();
        let depth = if inner.ends_with("mod.rs") { parts - 1 } else { parts };
        let mut targets = imports(&fs::read_to_string(&file).unwrap(), depth);
        if layer.is_some() {
            // Its own modules may have the names of others.
            targets.retain(|target| layers.get(target).is_none_or(|row| *row <= layers[module]));
            let crate_root = root().join(source);
            targets.retain(|target| {
                !crate_root.join(target).exists() && !crate_root.join(format!("{target}.rs")).exists()
            });
        }
        let refused = targets.iter().filter(|target| !may_import(&layers, module, target));
        wrong.extend(refused.map(|target| format!("{shown}: {module} imports {target}")));
    }
    for module in layers.keys().filter(|module| !seen.contains(*module)) {
        if home(module).is_none_or(|home| !home.join("src/lib.rs").exists()) {
            wrong.push(format!("CONTRIBUTING.md has the layer of {module}, which src/ has not"));
        }
    }
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

/// One of our crates: the folders of its `src`, and the crates that it uses by its manifest.
struct OwnCrate {
    folders: BTreeSet<String>,
    uses: BTreeSet<String>,
}

/// Our crates by name, without `pathmark-`.
fn own_crates() -> BTreeMap<String, OwnCrate> {
    let members = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path());
    let homes = members.filter(|home| home.join("Cargo.toml").is_file()).chain([root().to_path_buf()]);
    let read = |home: PathBuf| {
        let manifest: toml::Table = fs::read_to_string(home.join("Cargo.toml")).unwrap().parse().unwrap();
        let used = manifest["dependencies"].as_table().unwrap().keys();
        let uses = used.filter_map(|name| name.strip_prefix("pathmark-")).map(str::to_string).collect();
        let inner = fs::read_dir(home.join("src")).unwrap().map(|entry| entry.unwrap().path());
        let folders = inner.filter(|path| path.is_dir());
        let folders = folders.map(|path| path.file_name().unwrap().to_str().unwrap().to_string()).collect();
        let name = manifest["package"]["name"].as_str().unwrap().trim_start_matches("pathmark-").to_string();
        (name, OwnCrate { folders, uses })
    };
    homes.map(read).collect()
}

/// Whether a crate uses another one, perhaps by way of others.
fn reaches(crates: &BTreeMap<String, OwnCrate>, from: &str, to: &str) -> bool {
    crates[from].uses.iter().any(|next| next == to || reaches(crates, next, to))
}

/// The picture in ARCHITECTURE.md has a box for each crate, with the folders of its `src`, and an arrow for each use that
/// does not follow from other arrows.
#[test]
fn the_picture_is_of_the_code() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let (_, picture) = text.split_once("```mermaid\nflowchart TD\n").unwrap();
    let (picture, _) = picture.split_once("```").unwrap();
    let (mut boxes, mut arrows) = (BTreeMap::new(), BTreeSet::new());
    for line in picture.lines().map(str::trim) {
        if let Some((from, to)) = line.split_once(" --> ") {
            arrows.insert((from.to_string(), to.to_string()));
        } else {
            let (name, label) = line.trim_end_matches("\"]").split_once("[\"").unwrap();
            let (title, folders) = label.split_once(": ").unwrap_or((label, ""));
            assert_eq!(title, name);
            boxes.insert(name.to_string(), folders.to_string());
        }
    }
    let crates = own_crates();
    let lists = |own: &OwnCrate| own.folders.iter().cloned().collect::<Vec<_>>().join(", ");
    let mut expected: BTreeMap<_, _> = crates.iter().map(|(name, own)| (name.clone(), lists(own))).collect();
    expected.insert("pathmark".to_string(), "program and library".to_string());
    assert_eq!(boxes, expected);
    let uses = crates.iter().flat_map(|(from, own)| own.uses.iter().map(move |to| (from.clone(), to.clone())));
    let follows = |from: &str, to: &str| crates[from].uses.iter().any(|next| next != to && reaches(&crates, next, to));
    assert_eq!(arrows, uses.filter(|(from, to)| !follows(from, to)).collect());
}

/// The page names files that exist: Rust files below the `src` of some crate, other files below the package.
#[test]
fn the_page_names_files_that_exist() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    assert!(text.lines().count() <= 100, "one page");
    let crates = fs::read_dir(root().join("crates")).unwrap().map(|entry| entry.unwrap().path().join("src"));
    let sources: Vec<PathBuf> = crates.collect();
    // Every second part between backquotes is code; the picture's fence adds an even number.
    let ending = |part: &str| Path::new(part).extension().is_some_and(|ending| ending == "rs" || ending == "toml");
    let names = text.split('`').filter(|part| ending(part) && !part.contains(char::is_whitespace));
    let names: Vec<&str> = names.collect();
    assert!(names.len() > 15, "{names:?}");
    let exists = |name: &&str| root().join(name).is_file() || sources.iter().any(|source| source.join(name).is_file());
    let missing: Vec<&&str> = names.iter().filter(|name| !exists(name)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The front page of `cargo doc` has a row for each public module, and for no other.
#[test]
fn the_front_page_lists_the_public_modules() {
    let text = fs::read_to_string(root().join("src/lib.rs")).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("//! | [`")?.split_once("`]"));
    let listed: Vec<&str> = rows.map(|(module, _)| module).collect();
    let (_, code) = text.split_once("\n#![").unwrap();
    let mut shown = BTreeSet::new();
    // Each re-export that is not hidden: of several modules, or of a crate under another name.
    for (attributes, rest) in code.split("\npub use ").zip(code.split("\npub use ").skip(1)) {
        if attributes.ends_with("#[doc(inline)]") {
            let (export, _) = rest.split_once(';').unwrap();
            let name = export.split_once(" as ").map_or(export, |(_, name)| name);
            let names = name.split_once("::{").map_or(name, |(_, names)| names.trim_end().trim_end_matches('}'));
            shown.extend(names.split(',').map(str::trim).filter(|name| !name.is_empty()));
        }
    }
    assert_eq!(listed.iter().copied().collect::<BTreeSet<_>>(), shown);
    assert_eq!(listed.len(), shown.len(), "a module is listed twice");
}

/// A lint is satisfied, or relaxed in Cargo.toml, where readers see it.
#[test]
fn no_file_silences_a_lint() {
    // Split in two, so that this file does not match itself.
    let silenced = [concat!("#[al", "low("), concat!("#![al", "low("), concat!(", al", "low(")];
    let mut wrong = Vec::new();
    for file in FOLDERS.into_iter().flat_map(rust_files) {
        let code = code(&fs::read_to_string(&file).unwrap());
        let attributes = code.lines().filter(|line| line.trim_start().starts_with('#'));
        if attributes.into_iter().any(|line| silenced.iter().any(|text| line.contains(text))) {
            wrong.push(file);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// Unsafe code stands only in the files that CONTRIBUTING.md names, and each of these has some.
#[test]
fn unsafe_blocks_stand_in_the_listed_files() {
    let text = fs::read_to_string(root().join("CONTRIBUTING.md")).unwrap();
    let (_, listed) = text.split_once("* **`unsafe`.**").unwrap();
    let (listed, _) = listed.split_once("* **Tests.**").unwrap();
    let names: Vec<&str> = listed.split('`').skip(1).step_by(2).filter(|name| name.contains(".rs")).collect();
    let allows = |file: &PathBuf| code(&fs::read_to_string(file).unwrap()).contains(concat!("unsafe", "_code"));
    let (in_lanes, others): (Vec<_>, Vec<_>) = FOLDERS
        .into_iter()
        .flat_map(rust_files)
        .filter(allows)
        .partition(|file| file.starts_with(root().join("crates/pathmark-lanes/src/simd")));
    let unlisted: Vec<_> = others.iter().filter(|file| !names.iter().any(|name| file.ends_with(name))).collect();
    let without: Vec<_> = names.iter().filter(|name| !others.iter().any(|file| file.ends_with(name))).collect();
    assert!(unlisted.is_empty() && without.is_empty() && !in_lanes.is_empty(), "{unlisted:?} {without:?}");
}

#[test]
fn files_hold_one_idea() {
    let lines = |file: &PathBuf| fs::read_to_string(file).unwrap().lines().count();
    let files = FOLDERS.into_iter().flat_map(rust_files);
    let long: Vec<_> = files.filter(|file| lines(file) > 600).collect();
    assert!(long.is_empty(), "more than 600 lines: {long:?}");
}

/// `rustfmt` does not see modules that a macro declares.
#[test]
fn modules_are_declared_openly() {
    let declares = |file: &PathBuf| code(&fs::read_to_string(file).unwrap()).contains(concat!("mod ", "$"));
    let hidden: Vec<_> = FOLDERS.into_iter().flat_map(rust_files).filter(declares).collect();
    assert!(hidden.is_empty(), "a macro declares modules: {hidden:?}");
}
