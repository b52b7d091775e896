//! Readable documents: short pages of short lines, links with existing targets, and a map that lists every page.

use std::fs;
use std::path::{Path, PathBuf};

/// The folders of the pages, and the most lines of a page: manuals are short, and notes take a reader five minutes.
const SHELVES: [(&str, usize); 3] = [("docs", 150), ("docs/course", 150), ("docs/notes", 200)];
const MOST_MANUALS: usize = 12;
const LONGEST_LINE: usize = 120;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages of a shelf, in the order of their names.
fn shelf(folder: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let mut pages: Vec<PathBuf> = entries.filter(|path| path.extension().is_some_and(|end| end == "md")).collect();
    pages.sort();
    assert!(!pages.is_empty(), "{folder}");
    pages
}

fn pages() -> Vec<PathBuf> {
    SHELVES.iter().flat_map(|(folder, _)| shelf(folder)).collect()
}

#[test]
fn pages_and_lines_are_short() {
    assert!(shelf("docs").len() <= MOST_MANUALS);
    for (folder, most_lines) in SHELVES {
        for page in shelf(folder) {
            let text = fs::read_to_string(&page).unwrap();
            assert!(text.lines().count() <= most_lines, "{}: more than {most_lines} lines", page.display());
            for (line, text) in text.lines().enumerate() {
                let length = text.chars().count();
                assert!(length <= LONGEST_LINE, "{}:{}: {length} characters", page.display(), line + 1);
            }
        }
    }
}

/// A release has its number in the manifests, in the changelog and in the citation.
#[test]
fn the_version_is_everywhere_the_same() {
    let version = env!("CARGO_PKG_VERSION");
    let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    let first = read("CHANGELOG.md").lines().find_map(|line| line.strip_prefix("## ").map(str::to_string)).unwrap();
    let (number, date) = first.split_once(' ').unwrap();
    assert_eq!(number, version);
    let cited = read("CITATION.cff");
    assert!(cited.contains(&format!("\nversion: {version}\n")), "{cited}");
    assert!(cited.contains(&format!("\ndate-released: {}\n", date.trim_matches(['(', ')']))), "{cited}");
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    let own = manifest["workspace"]["dependencies"].as_table().unwrap().iter();
    let others: Vec<_> =
        own.filter(|(name, of)| name.starts_with("pathmark-") && of["version"].as_str() != Some(version)).collect();
    assert!(others.is_empty(), "{others:?}");
}

/// The heading as an anchor in a link.
fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || *c == ' ' || *c == '-');
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

/// The targets of a document's links within the repository.
fn links(text: &str) -> Vec<&str> {
    let inline = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let named =
        text.lines().filter(|line| line.starts_with('[')).filter_map(|line| line.split_once("]: ")).map(|(_, to)| to);
    inline.chain(named).filter(|link| !link.contains("://")).collect()
}

#[test]
fn links_lead_somewhere() {
    let more = ["README.md", "METHODOLOGY.md", "ARCHITECTURE.md", "CONTRIBUTING.md", "results/README.md"]
        .map(|name| root().join(name));
    for page in pages().into_iter().chain(more) {
        let text = fs::read_to_string(&page).unwrap();
        for link in links(&text) {
            let (file, section) = link.split_once('#').map_or((link, None), |(file, section)| (file, Some(section)));
            let target = if file.is_empty() { page.clone() } else { page.parent().unwrap().join(file) };
            assert!(target.exists(), "{}: {link}", page.display());
            if let Some(section) = section {
                let text = fs::read_to_string(&target).unwrap();
                let mut headings = text.lines().filter_map(|line| line.trim_start_matches('#').strip_prefix(' '));
                assert!(headings.any(|heading| anchor(heading) == section), "{}: {link}", page.display());
            }
        }
    }
}

#[test]
fn the_map_has_every_page() {
    let map = fs::read_to_string(root().join("METHODOLOGY.md")).unwrap();
    assert!(map.lines().count() <= 60);
    for page in pages() {
        let name = page.strip_prefix(root()).unwrap().display().to_string();
        assert!(map.contains(&format!("({name})")), "METHODOLOGY.md leaves out {name}");
    }
}

/// The figures below a folder, without those of earlier versions.
fn figures(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<PathBuf>, Vec<PathBuf>) = entries.partition(|path| path.is_dir());
    let is_figure = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "svg");
    let below = folders.into_iter().filter(|folder| !folder.ends_with("earlier")).flat_map(|folder| figures(&folder));
    files.into_iter().filter(is_figure).chain(below).collect()
}

#[test]
fn no_committed_figure_is_empty() {
    let figures = figures(&root().join("results"));
    assert!(figures.len() > 80, "{}", figures.len());
    for figure in figures {
        assert!(!fs::read_to_string(&figure).unwrap().contains("\nno data\n"), "{}", figure.display());
    }
}

/// In the lines that say that there is no address.
const WITHOUT: &str = "no public address yet";

/// Every file has the address of the manifest, so one command writes another one into all of them.
#[test]
fn one_command_fills_in_the_address() {
    let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
    let manifest: toml::Table = read("Cargo.toml").parse().unwrap();
    let address = manifest["workspace"]["package"]["repository"].as_str().unwrap().to_string();
    assert!(read("README.md").contains(&format!("git clone {address} ")), "{address}");
    for name in ["README.md", "examples/pool-template/Cargo.toml"] {
        let text = read(name);
        let sources: Vec<&str> = text.lines().filter(|line| line.contains("{ git = ")).collect();
        assert!(!sources.is_empty(), "{name}");
        assert!(sources.iter().all(|line| line.contains(&format!("git = \"{address}\""))), "{name}: {sources:?}");
    }
    assert!(read("CONTRIBUTING.md").contains("address-to-be-chosen.invalid|"));
    // The command removes the lines that say that there is no address, so each is a whole sentence.
    assert!(read("CONTRIBUTING.md").contains(&format!("/{WITHOUT}/d")));
    for name in ["README.md", "Cargo.toml", "examples/pool-template/README.md"] {
        let text = read(name);
        let lines: Vec<&str> = text.lines().filter(|line| line.contains(WITHOUT)).collect();
        let is_whole =
            |line: &&str| line.trim_start_matches("# ").starts_with("Pathmark has no ") && line.ends_with('.');
        assert!(lines.len() == 1 && lines.iter().all(is_whole), "{name}: {lines:?}");
    }
}
