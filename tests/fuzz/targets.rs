//! The fuzz targets: kinds of files with their readers.

use pathmark::Lab;
use pathmark::error::Result;
use pathmark::experiment::{
    Definition, Profile, RecordsFile, Replication, experiments, read_calibration, read_records, read_run_file,
};
use pathmark::film_file::read_film;
use pathmark::image_io::{self, Image};
use pathmark::kernel::Spec;
use pathmark::measure::{Checkpoint, Position, Record, Rounds, Settings, Setup, TraceFile};
use pathmark::report::artifact::{Citation, listed};
use pathmark::scene::{self, SCENES};
use sha2::{Digest, Sha256};
use std::fs;
use std::path::{Path, PathBuf};

/// A kind of file and its reader.
pub(crate) struct Target {
    /// The name of the target and of its corpus folder.
    pub(crate) name: &'static str,
    /// The file's name, which its reader depends on.
    pub(crate) file: &'static str,
    /// Writes the files that the reader expects beside it.
    pub(crate) prepare: fn(&Path),
    /// Reads the file and returns whether it was accepted. An accepted file must be usable.
    pub(crate) read: fn(&Path) -> bool,
    /// Makes a damaged file pass its checks against damage, so that the code behind them is reached.
    pub(crate) repair: fn(Vec<u8>) -> Vec<u8>,
    /// Seeds besides the corpus that the program carries or makes, so that they never become outdated.
    pub(crate) more: fn() -> Vec<Vec<u8>>,
    /// Words of the format.
    pub(crate) words: &'static [&'static str],
    /// Whether prefixes of seeds are tried.
    pub(crate) cut: bool,
    /// Mutations in a round.
    pub(crate) mutations: u64,
}

const TARGET: Target = Target {
    name: "",
    file: "",
    prepare: |_| {},
    read: |_| false,
    repair: |bytes| bytes,
    more: Vec::new,
    words: &[],
    cut: true,
    mutations: 1000,
};

/// All targets.
pub(crate) const TARGETS: &[Target] = &[
    Target {
        name: "scene",
        file: "scene.toml",
        read: scene,
        more: || texts(SCENES, 4000, "[generator.spheres]"),
        words: SCENE_WORDS,
        ..TARGET
    },
    Target {
        name: "mesh",
        file: "thing.obj",
        prepare: scene_with_a_mesh,
        read: mesh,
        words: MESH_WORDS,
        // These take ten times as long as most.
        mutations: 600,
        ..TARGET
    },
    Target { name: "ply", file: "thing.ply", prepare: scene_with_a_ply_mesh, read: mesh, words: PLY_WORDS, ..TARGET },
    Target {
        name: "experiment",
        file: "tiny.toml",
        read: experiment,
        // A large matrix has many cells, so it is known to take long.
        more: || texts(experiments(), 1300, "spheres"),
        words: EXPERIMENT_WORDS,
        mutations: 600,
        ..TARGET
    },
    Target {
        name: "records",
        file: "records.csv",
        read: |path| ok(read_records(path)),
        more: rows,
        words: CSV_WORDS,
        ..TARGET
    },
    Target { name: "machine", file: "machine.toml", read: |path| ok(read_run_file(path)), ..TARGET },
    Target {
        name: "replication",
        file: "replication.json",
        read: |path| ok(Replication::read(path)),
        words: JSON_WORDS,
        ..TARGET
    },
    Target {
        name: "calibration",
        file: "calibration.csv",
        read: |path| ok(read_calibration(path)),
        words: CSV_WORDS,
        ..TARGET
    },
    Target { name: "trace", file: "trace.csv", read: |path| ok(TraceFile::read(path)), words: CSV_WORDS, ..TARGET },
    Target { name: "film", file: "half.film", read: film, repair: with_checksum, words: JSON_WORDS, ..TARGET },
    Target {
        name: "checkpoint",
        file: "a.checkpoint",
        read: checkpoint,
        more: checkpoints,
        repair: with_checksum,
        words: JSON_WORDS,
        ..TARGET
    },
    Target { name: "ppm", file: "image.ppm", read: image, words: &["P6", "P3", "#", " 255 ", "65535"], ..TARGET },
    Target { name: "pfm", file: "image.pfm", read: image, words: &["PF", "Pf", "-1.0", "1e38", "nan"], ..TARGET },
    Target { name: "exr", file: "image.exr", read: image, words: EXR_WORDS, ..TARGET },
    Target { name: "hdr", file: "image.hdr", read: image, words: HDR_WORDS, ..TARGET },
    Target {
        name: "png",
        file: "image.png",
        read: image,
        words: &["IHDR", "IDAT", "IEND", "tRNS", "zTXt", "PLTE", "gAMA", "cHRM", "sRGB", "cICP"],
        ..TARGET
    },
    Target { name: "bmp", file: "image.bmp", read: image, ..TARGET },
    Target {
        name: "crate",
        file: "ro-crate-metadata.json",
        read: |path| ok(listed(path)),
        words: CRATE_WORDS,
        ..TARGET
    },
    Target {
        name: "citation",
        file: "CITATION.cff",
        read: |path| ok(Citation::read(path)),
        words: CITATION_WORDS,
        ..TARGET
    },
    Target {
        name: "report",
        file: "out/tiny/records.csv",
        prepare: beside_the_records,
        read: report,
        more: rows,
        words: CSV_WORDS,
        cut: false,
        mutations: 120,
        ..TARGET
    },
    Target {
        name: "bursts",
        file: "out/bursts/bursts.csv",
        prepare: beside_the_bursts,
        read: report,
        words: CSV_WORDS,
        cut: false,
        mutations: 120,
        ..TARGET
    },
];

const SCENE_WORDS: &[&str] = &[
    "base = 'cornell'\n",
    "without = ['light']\n",
    "background = [1, 1, 1]\n",
    "estimator = 'nee'\n",
    "[fog]\n",
    "[camera.pinhole]\n",
    "[camera.thin-lens]\n",
    "[camera.smallpt]\n",
    "[[objects]]\n",
    "[[point-lights]]\n",
    "[generator.furnace]\nalbedo = 0.5\n",
    "sphere",
    "plane",
    "triangle",
    "quad",
    "mesh",
    "diffuse",
    "mirror",
    "dielectric",
    "polished",
    "conductor",
    "kd-ks",
    "fresnel-mirror",
    "albedo",
    "emission",
    "radius",
    "corners",
    "normal",
    "point",
    "file = '/dev/zero'",
    "scale = 2.0",
    "rotate = [0.0, 90.0, 0.0]",
    "'''",
    "\\u0000",
    "{",
    "}",
    "\u{feff}",
];
const MESH_WORDS: &[&str] = &[
    "v ", "f ", "o ", "vn ", "vt ", "/", "//", "-1", "\\\n", "g ", "usemtl ", "mtllib ", "s off\n", " # ", "\u{feff}",
];
const PLY_WORDS: &[&str] = &[
    "format ascii 1.0\n",
    "format binary_big_endian 1.0\n",
    "element vertex 9999999999\n",
    "element face 3\n",
    "property list uint char vertex_index\n",
    "property double x\n",
    "end_header\n",
    "property float x\n",
    "format ascii 2.0\n",
    " nan ",
    " .5 ",
    "\u{feff}",
    "\0\0\0\0",
];
const EXPERIMENT_WORDS: &[&str] = &[
    "\"all\"",
    "\"default\"",
    "curve = true\n",
    "weak = true\n",
    "clamp = 'subpixel'\n",
    "[[matrix]]\n",
    "[reference]\n",
    "size = [0, 0]\n",
    "max-depth = [0]\n",
    "roulette = ['none']\n",
    "keep = ['images']\n",
    "reference-spp = 40\n",
    "[[external]]\n",
    "dynamic:0",
    "samples:16",
    "tiles:1x1",
    "repetitions = 0\n",
];
const CSV_WORDS: &[&str] = &[",", "\"", "\"\"", "\r\n", "\n", ",,", "true", "false", "serial", "nan", "\0"];
const JSON_WORDS: &[&str] =
    &["{", "}", "\"width\":", "\"height\":", "\"spp\":", "null", "true", ":", "pathmark film 1\n", "\\ud800"];
const CRATE_WORDS: &[&str] =
    &["\"@graph\":", "\"@id\":", "\"File\"", "[", "]", "%2e%2e/", "%", "\"contentSize\":", "1e99", "null", "\\ud800"];
const CITATION_WORDS: &[&str] =
    &["title:", "authors:\n", "  - name: ", "license:\n", "  - ", "orcid: ", "\"", "'", ": ", " #", "---\n", "\\ud800"];
const EXR_WORDS: &[&str] = &[
    "dataWindow\0box2i\0",
    "channels\0chlist\0",
    "compression\0compression\0",
    "tiles\0tiledesc\0",
    "R\0",
    "lineOrder\0",
];
const HDR_WORDS: &[&str] = &[
    "EXPOSURE=",
    "FORMAT=32-bit_rle_rgbe\n",
    "-Y ",
    "+X ",
    "COLORCORR=1 1 1\n",
    "#?RADIANCE\n",
    "#?RGBE\n",
    "\u{2}\u{2}",
];

fn ok<T>(result: Result<T>) -> bool {
    match result {
        Ok(_) => true,
        Err(error) => {
            // Users read the message.
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Definitions that the program carries, except long ones and those that contain `heavy`.
fn texts<T: AsRef<str>>(table: &[(T, T)], most: usize, heavy: &str) -> Vec<Vec<u8>> {
    let texts = table.iter().map(|(_, text)| text.as_ref()).filter(|text| text.len() < most && !text.contains(heavy));
    texts.map(|text| text.as_bytes().to_vec()).collect()
}

/// Whitted's rays branch at every glass surface, so the test limits their depth.
const DEEPEST: u16 = 6;

/// Every estimator can render every accepted scene.
fn scene(path: &Path) -> bool {
    let Ok(scene) = scene::load(path.to_str().unwrap()) else { return false };
    let scene = std::sync::Arc::new(scene);
    for entry in pathmark::estimator::ESTIMATORS {
        // The test is not about fog that scatters again and again, or glass in a mirror.
        let spec =
            Spec { width: 2, height: 1, estimator: entry.name.into(), max_depth: Some(DEEPEST), ..Spec::default() };
        let settings = Settings { spp: 4, spec, strategy: "serial".into(), ..Settings::default() };
        let setup = Setup::for_scene(std::sync::Arc::clone(&scene), settings).unwrap();
        let outcome = setup.run(None).unwrap();
        assert_eq!(outcome.film.pixels().len(), 2);
        assert!(!outcome.film.checksum().is_empty());
    }
    true
}

fn scene_with_a_mesh(folder: &Path) {
    write_scene_of(folder, "thing.obj");
}

fn scene_with_a_ply_mesh(folder: &Path) {
    write_scene_of(folder, "thing.ply");
}

fn write_scene_of(folder: &Path, mesh: &str) {
    let scene = "about = 'a mesh'\nbackground = [1.0, 1.0, 1.0]\n\n[camera.pinhole]\nposition = [0.0, 0.0, 5.0]\nlook-at = [0.0, 0.0, 0.0]\n\
                 field-of-view = 40.0\n\n[[objects]]\nname = 'thing'\nshape = { mesh = { file = 'thing.obj' } }\n\
                 material = { diffuse = { albedo = [0.5, 0.5, 0.5] } }\n";
    fs::write(folder.join("mesh.toml"), scene.replace("thing.obj", mesh)).unwrap();
}

fn mesh(path: &Path) -> bool {
    scene(&path.with_file_name("mesh.toml"))
}

fn experiment(path: &Path) -> bool {
    let Ok(definition) = Definition::load(&Lab::built_in(), path.to_str().unwrap()) else { return false };
    Profile::ALL.into_iter().filter(|profile| ok(definition.cells(*profile))).count() > 0
}

/// Replaces the checksum at the end by the right one. Prefixes of seeds keep their wrong checksum.
fn with_checksum(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some(end) = bytes.len().checked_sub(32) {
        let digest = Sha256::digest(&bytes[..end]);
        bytes[end..].copy_from_slice(&digest);
    }
    bytes
}

fn film(path: &Path) -> bool {
    let Ok((key, film)) = read_film(path) else { return false };
    assert_eq!((film.width(), film.height()), (key.width, key.height));
    assert_eq!(film.pixels().len(), key.width as usize * key.height as usize);
    assert!(!film.checksum().is_empty());
    true
}

fn setup(strategy: &str) -> Setup {
    let spec = Spec { width: 3, height: 2, ..Spec::default() };
    Setup::prepare(Settings { spp: 16, spec, strategy: strategy.into(), ..Settings::default() }).unwrap()
}

fn checkpoints() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let made = [16, 24, 40].map(|spp| {
        let path = folder.path().join(spp.to_string());
        let mut rounds = Rounds::new(setup("serial")).unwrap();
        rounds.extend_to(spp, None).unwrap();
        let (checkpoint, _) = Checkpoint::open(&path, &rounds, None).unwrap();
        checkpoint.save(&rounds, Position { rendering_s: 1.5, look: spp }).unwrap();
        fs::read(path).unwrap()
    });
    made.to_vec()
}

/// Records of two strategies, three repetitions each.
fn rows() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("records.csv");
    let mut file = RecordsFile::create(&path).unwrap();
    for (repetition, strategy) in (0..3).flat_map(|repetition| [(repetition, "serial"), (repetition, "static-blocks")])
    {
        let setup = setup(strategy);
        let outcome = setup.run(None).unwrap();
        let (experiment, cell) = ("tiny".to_string(), format!("cornell/{strategy}"));
        let record = Record::new(&setup, &outcome);
        file.append(&Record { experiment, cell, repetition, ..record }).unwrap();
    }
    let whole = fs::read(path).unwrap();
    let short = whole.split_inclusive(|byte| *byte == b'\n').take(2).collect::<Vec<_>>().concat();
    vec![whole, short]
}

fn checkpoint(path: &Path) -> bool {
    thread_local! { static ROUNDS: Rounds = Rounds::new(setup("serial")).unwrap(); }
    let Ok((_, saved)) = ROUNDS.with(|rounds| Checkpoint::open(path, rounds, None)) else { return false };
    saved.is_none_or(|saved| saved.film.film().pixels().len() == 6)
}

/// An accepted image has as many pixels as its size says. If PFM holds its values exactly, a small image can be written
/// and read back.
fn image(path: &Path) -> bool {
    let Ok(image) = image_io::read(path) else { return false };
    assert_eq!(image.pixels.len(), image.width as usize * image.height as usize);
    let bits = |image: &Image| image.pixels.iter().map(|pixel| pixel.map(f64::to_bits)).collect::<Vec<_>>();
    let copy = path.with_file_name("copy.pfm");
    let is_exact =
        image.pixels.as_flattened().iter().all(|value| f64::from(*value as f32).to_bits() == value.to_bits());
    if image.pixels.len() < 100 && is_exact && image_io::write(&copy, &image).is_ok() {
        assert_eq!(bits(&image_io::read(&copy).unwrap()), bits(&image));
    }
    true
}

fn beside_the_records(folder: &Path) {
    let to = with_a_machine(folder, "out/tiny");
    fs::copy(corpus("experiment/tiny.toml"), to.join("experiment.toml")).unwrap();
}

fn beside_the_bursts(folder: &Path) {
    with_a_machine(folder, "out/bursts");
}

fn with_a_machine(folder: &Path, name: &str) -> PathBuf {
    let to = folder.join(name);
    fs::create_dir_all(&to).unwrap();
    fs::copy(corpus("machine/machine.toml"), to.join("machine.toml")).unwrap();
    to
}

fn corpus(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus").join(file)
}

/// Draws the whole page from rows that may have been edited.
fn report(path: &Path) -> bool {
    ok(pathmark::report::write(&Lab::built_in(), path.parent().and_then(Path::parent).unwrap()))
}
