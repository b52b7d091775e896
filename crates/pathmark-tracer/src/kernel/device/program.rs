//! The text of the program: the files in `program/` behind the numbers that they have in common with the processor's kernels.

use super::tables::{KINDS, LIGHT_NUMBERS, MATERIALS, NUMBERS, OBJECT_NUMBERS, POINT_LIGHT_NUMBERS, SAMPLERS, WORDS};
use super::{MOST_BLOCKS, OUT_WORDS, Task};
use crate::effect::Effects;
use crate::estimator::{HIDING, PathRules};
use crate::film::SAMPLE_BLOCK;
use crate::math::{COS, SIN};
use crate::sampling::{Purpose, SUBPIXEL, UNIFORM_SPHERE_DENSITY, each_third};
use crate::scene::{DEEPEST, FEATURES, PRIMITIVES, nearness, padding};
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::fmt::{Display, Write};

/// The files, in the order in which they follow each other.
const FILES: &[&str] = &[
    include_str!("program/math.cl"),
    include_str!("program/sampler.cl"),
    include_str!("program/shape.cl"),
    include_str!("program/material.cl"),
    include_str!("program/light.cl"),
    include_str!("program/camera.cl"),
    include_str!("program/path.cl"),
    include_str!("program/film.cl"),
];

/// Names with their values.
struct Definitions(String);

impl Definitions {
    fn add(&mut self, name: &str, value: impl Display) {
        // Writing to a text cannot fail.
        let _ = writeln!(self.0, "#define {name} {value}");
    }

    /// A number, with as many digits as it takes to read the same one.
    fn add_number(&mut self, name: &str, value: f64) {
        self.add(name, format_args!("({value:e})"));
    }

    /// Names that are numbered from 0.
    fn add_numbered<'a>(&mut self, names: impl Iterator<Item = &'a str>) {
        for (number, name) in names.enumerate() {
            self.add(name, format_args!("{number}U"));
        }
    }

    /// Places of what lies behind each other.
    fn add_places(&mut self, layout: &[(&str, usize)]) {
        let mut first = 0;
        for (name, length) in layout {
            self.add(name, first);
            first += length;
        }
    }
}

/// The words of a name as constants have them: `fresnel-mirror` is `FRESNEL_MIRROR`.
fn constant(name: &str) -> String {
    name.to_uppercase().replace('-', "_")
}

fn definitions(effects: Effects, course: &PathRules) -> String {
    let mut all = Definitions(String::new());
    for entry in PRIMITIVES.iter().chain(crate::material::MATERIALS).chain(FEATURES) {
        all.add(&format!("HAS_{}", constant(entry.name)), u8::from(effects.cover(entry.effect)));
    }
    all.add("SPLITS", course.splits);
    all.add("AIMS", u8::from(course.aims.is_some()));
    all.add_numbered(SAMPLERS.iter().map(|(_, name)| *name));
    all.add_numbered(MATERIALS.iter().copied());
    KINDS.iter().for_each(|names| all.add_numbered(names.iter().copied()));
    all.add_places(WORDS);
    all.add_places(NUMBERS);
    for (name, purpose) in [
        ("PURPOSE_FILM", Purpose::Film),
        ("PURPOSE_BSDF", Purpose::Bsdf),
        ("PURPOSE_ROULETTE", Purpose::Roulette),
        ("PURPOSE_LENS", Purpose::Lens),
        ("PURPOSE_LIGHT", Purpose::Light),
        ("PURPOSE_LIGHT_CHOICE", Purpose::LightChoice),
    ] {
        all.add(name, format_args!("{}U", purpose as u32));
    }
    for (name, task) in [
        ("TASK_X", Task::X),
        ("TASK_Y", Task::Y),
        ("TASK_COLUMNS", Task::Columns),
        ("TASK_FIRST_PIXEL", Task::FirstPixel),
        ("TASK_FIRST_PART", Task::FirstPart),
        ("TASK_PARTS", Task::Parts),
        ("TASK_PART_SAMPLES", Task::PartSamples),
        ("TASK_FIRST_SAMPLE", Task::FirstSample),
        ("TASK_END_SAMPLE", Task::EndSample),
    ] {
        all.add(name, task as usize);
    }
    for (name, value) in [
        ("OBJECT_NUMBERS", OBJECT_NUMBERS),
        ("LIGHT_NUMBERS", LIGHT_NUMBERS),
        ("POINT_LIGHT_NUMBERS", POINT_LIGHT_NUMBERS),
        ("OUT_WORDS", OUT_WORDS),
        ("DEEPEST", DEEPEST),
        ("LEVELS", MOST_BLOCKS as usize + 1),
        ("SAMPLE_BLOCK", SAMPLE_BLOCK as usize),
    ] {
        all.add(name, value);
    }
    let [lower, higher] = SUBPIXEL;
    let thirds = [0, 1, 2].map(each_third);
    let masks = ["EACH_THIRD_0", "EACH_THIRD_1", "EACH_THIRD_2", "SUBPIXEL_LOWER", "SUBPIXEL_HIGHER"];
    for (name, mask) in masks.into_iter().zip(thirds.into_iter().chain([lower, higher])) {
        all.add(name, format_args!("{mask:#x}U"));
    }
    for (name, value) in [
        ("PI", PI),
        ("INVERSE_PI", FRAC_1_PI),
        ("TAU", TAU),
        ("UNIT_STEP", 1.0 / (1_u64 << f64::MANTISSA_DIGITS) as f64),
        ("TURN_SHIFT", 1.5 * (1_u64 << (f64::MANTISSA_DIGITS - 1)) as f64),
        ("UNIFORM_SPHERE_DENSITY", UNIFORM_SPHERE_DENSITY),
        ("SMALLEST_NORMAL", f64::MIN_POSITIVE),
        ("HIDING", HIDING),
        ("PADDING", padding(f64::MANTISSA_DIGITS)),
        ("HALF_PADDING", 0.5 * padding(f64::MANTISSA_DIGITS)),
        ("NEARNESS", nearness(f64::MANTISSA_DIGITS)),
    ] {
        all.add_number(name, value);
    }
    for (name, coefficients) in [("SINE_COEFFICIENTS", SIN), ("COSINE_COEFFICIENTS", COS)] {
        all.add(name, coefficients.map(|c| format!("({c:e})")).join(", "));
    }
    all.0
}

/// The program for scenes with these effects and paths by these rules.
pub(super) fn text(effects: Effects, course: &PathRules) -> String {
    let mut text = definitions(effects, course);
    FILES.iter().for_each(|file| text.push_str(file));
    text
}
