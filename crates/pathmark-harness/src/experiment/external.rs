//! External programs: other renderers in an experiment's tables.
//!
//! ```toml
//! [[external]]
//! name = "yardstick"                                    # stands where estimators stand
//! command = ["{folder}/yardstick", "{width}", "{height}", "{spp}", "{out}", "keyed", "{seed}"]
//! build = ["g++", "-O3", "yardstick.cpp", "-o", "{folder}/yardstick"]   # optional, once before the sweep
//! scene = "cornell"                                     # what it renders, of which there is a reference
//! spp = [64]
//! seed = [1, 2, 3]
//! ```
//!
//! `docs/external.md` explains all keys.

use super::matrix::LARGEST_CELLS;
use super::{Cell, CellPoint, Definition, Profile, Progress, SceneVersion};
use crate::error::{InputError, Result};
use crate::kernel::Spec;
use crate::measure::{ImageKey, ScheduleKey, Settings, parse_size};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::path::Path;
use std::process::{Command, Stdio};

/// The value of columns that have no meaning for other programs.
pub const EXTERNAL: &str = "external";

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct External {
    pub name: String,
    /// The program and its arguments; `{spp}`, `{seed}` and `{out}` must be among them, `{width}`, `{height}` and `{folder}` may be.
    pub command: Vec<String>,
    #[serde(default)]
    pub build: Vec<String>,
    scene: String,
    spp: Vec<u32>,
    seed: Vec<u64>,
    #[serde(default = "one")]
    threads: usize,
    #[serde(default = "pfm")]
    format: String,
    #[serde(default)]
    curve: bool,
    #[serde(default = "one")]
    fewest_spp: u32,
}

fn one<T: From<u8>>() -> T {
    1.into()
}

fn pfm() -> String {
    "pfm".to_string()
}

pub(super) fn filled(command: &[String], values: &[(&str, String)]) -> Vec<String> {
    let fill = |word: &String| {
        values.iter().fold(word.clone(), |word, (name, value)| word.replace(&format!("{{{name}}}"), value))
    };
    command.iter().map(fill).collect()
}

impl External {
    /// The extension of the image file that it writes.
    pub fn format(&self) -> &str {
        &self.format
    }

    /// Builds it. A failure is only reported: its rows will say that the program is missing.
    pub(super) fn make(&self, folder: &Path, progress: &dyn Progress) {
        let command = filled(&self.build, &[("folder", folder.display().to_string())]);
        let Some((program, arguments)) = command.split_first() else { return };
        let problem = match Command::new(program).args(arguments).stdin(Stdio::null()).output() {
            Ok(output) if output.status.success() => return,
            Ok(output) => String::from_utf8_lossy(&output.stderr).trim().to_string(),
            Err(error) => error.to_string(),
        };
        progress.note(&format!("{} is left out: {}: {problem}", self.name, command.join(" ")));
    }

    fn check(&self) -> Result<()> {
        for placeholder in ["{spp}", "{seed}", "{out}"] {
            if !self.command.iter().any(|word| word.contains(placeholder)) {
                let problem = format!("lacks the placeholder {placeholder}");
                return Err(InputError::new("command", self.command.join(" "), problem).into());
            }
        }
        if self.spp.is_empty() || self.seed.is_empty() || self.spp.contains(&0) || self.fewest_spp == 0 {
            let problem = "needs seeds, and sample counts of at least 1";
            return Err(InputError::new("external", &self.name, problem).into());
        }
        crate::image_io::check_format(Path::new(&format!("image.{}", self.format))).map(|_| ())
    }

    fn points(&self, spp: u32) -> Vec<u32> {
        if !self.curve {
            return vec![spp];
        }
        let doubled = std::iter::successors(Some(self.fewest_spp), |own| own.checked_mul(2));
        doubled.take_while(|own| *own < spp).chain([spp]).collect()
    }
}

impl Definition {
    pub(super) fn external_cells(&self, profile: Profile) -> Result<Vec<Cell>> {
        let scale = self.scale(profile)?;
        let (mut cells, mut places) = (Vec::<Cell>::new(), HashMap::new());
        for external in &self.external {
            external.check().map_err(|error| error.placed(|input| self.located(profile, input)))?;
            let scene = self.lab.load_scene(&external.scene)?;
            let spps = scale.numbers("spp").unwrap_or_else(|| external.spp.clone());
            let seeds = scale.numbers("seed").unwrap_or_else(|| external.seed.clone());
            let (width, height) = parse_size(scale.values("size").map_or("", |size| &size[0]))?;
            for (spp, seed) in spps.iter().flat_map(|spp| {
                external.points(*spp).into_iter().flat_map(|spp| seeds.iter().map(move |seed| (spp, *seed)))
            }) {
                let spec = Spec {
                    width,
                    height,
                    seed,
                    estimator: external.name.clone(),
                    sampler: EXTERNAL.to_string(),
                    kernel: EXTERNAL.to_string(),
                    ..Spec::default()
                };
                let settings = Settings {
                    scene: external.scene.clone(),
                    spp,
                    spec,
                    decomposition: EXTERNAL.to_string(),
                    strategy: EXTERNAL.to_string(),
                    threads: external.threads,
                    ..Settings::default()
                };
                let what = format!("{}-{}/{}/{EXTERNAL}", scene.name, scene.hash, external.name);
                let id = format!("{what}/{width}x{height}/{spp}spp/seed{seed}");
                let samples = u64::from(width) * u64::from(height) * u64::from(spp);
                let points = vec![CellPoint { id: id.clone(), spp, image: id.clone() }];
                let version = SceneVersion { hash: scene.hash.clone(), files: scene.files.clone() };
                let external = Some(external.clone());
                let keys = (ImageKey::of(&settings), ScheduleKey::of(&settings));
                let cell = Cell {
                    id,
                    settings,
                    keys,
                    scene: version,
                    points,
                    weight: samples.max(1),
                    at_most: None,
                    external,
                };
                match places.get(&cell.id).map(|place: &usize| &cells[*place]) {
                    None if cells.len() as u64 >= LARGEST_CELLS => {
                        let problem = "has too many combinations of spp and seed";
                        let error = InputError::new("name", &cell.settings.spec.estimator, problem);
                        return Err(self.located(profile, error.allowed(format!("at most {LARGEST_CELLS} cells"))));
                    }
                    None => {
                        places.insert(cell.id.clone(), cells.len());
                        cells.push(cell);
                    }
                    // Curves share their first points, and a list may name a value twice.
                    Some(known) if known.external == cell.external => {}
                    Some(_) => {
                        let problem = "is also the name of another program for the same images";
                        return Err(
                            self.located(profile, InputError::new("name", &cell.settings.spec.estimator, problem))
                        );
                    }
                }
            }
        }
        Ok(cells)
    }
}
