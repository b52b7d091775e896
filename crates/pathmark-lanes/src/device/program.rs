//! The text of the program: the constants that it shares with the processor's kernels, then the files in `program/`.

use super::items::{MOST_BLOCKS, OUT_WORDS, PIECE, TASK};
use super::tables::{KINDS, LIGHT_NUMBERS, MATERIALS, NUMBERS, OBJECT_NUMBERS, POINT_LIGHT_NUMBERS, SAMPLERS, WORDS};
use pathmark_tracer::effect::Effects;
use pathmark_tracer::estimator::{HIDING, PathRules};
use pathmark_tracer::film::SAMPLE_BLOCK;
use pathmark_tracer::math::Precision;
use pathmark_tracer::math::{COS, SIN};
use pathmark_tracer::sampling::{Purpose, SUBPIXEL, UNIFORM_SPHERE_DENSITY, each_third};
use pathmark_tracer::scene::{DEEPEST, FEATURES, PRIMITIVES, nearness, padding};
use std::collections::BTreeSet;
use std::f64::consts::{FRAC_1_PI, PI, TAU};
use std::fmt::{Display, Write};

/// The double-precision part of every program. Single precision uses it for uncertain hits and for rough materials.
const DOUBLE: &[&str] = &[
    include_str!("program/double.cl"),
    MATH,
    include_str!("program/sampler.cl"),
    include_str!("program/shape.cl"),
    TREE,
    include_str!("program/search.cl"),
    include_str!("program/material.cl"),
];

/// Formulas, the traversal of a tree, and the path with the rest of its code, in the precision of the path.
const MATH: &str = include_str!("program/math.cl");
const TREE: &str = include_str!("program/tree.cl");
const PATH: &[&str] = &[
    include_str!("program/numbers.cl"),
    include_str!("program/light.cl"),
    include_str!("program/camera.cl"),
    include_str!("program/path.cl"),
    include_str!("program/film.cl"),
];

/// Code for single precision alone: before its formulas, between formulas and tree, and after the tree.
const SINGLE: &str = include_str!("program/single.cl");
const SINGLE_SHAPE: &str = include_str!("program/single_shape.cl");
const SINGLE_SEARCH: &[&str] = &[include_str!("program/single_search.cl"), include_str!("program/single_material.cl")];

/// The entry point that devices call, for the single-precision program.
const ENTRY: &str = "
FN void run_item(u32 item, GLOBAL const stored *numbers, GLOBAL const u32 *words, GLOBAL const u32 *task, GLOBAL u64 *out) {
    run_item_s(item, numbers, words, task, out);
}
";

/// Names of the dialects and of `double.cl` that also exist in single precision.
const WORDS_OF_BOTH: &[&str] = &[
    "INFINITE",
    "MAGNITUDE",
    "SQUARE_ROOT",
    "TIMES_PLUS",
    "UNIT",
    "WITH_SIGN",
    "SINE_COEFFICIENTS",
    "COSINE_COEFFICIENTS",
];

/// Number of sine and cosine coefficients in single precision.
const SINGLE_COEFFICIENTS: usize = 5;

/// Preprocessor definitions.
struct Definitions(String);

impl Definitions {
    fn add(&mut self, name: &str, value: impl Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.0, "#define {name} {value}");
    }

    /// Defines a number with enough digits to be read back exactly.
    fn add_number(&mut self, name: &str, value: f64) {
        self.add(name, format_args!("({value:e})"));
    }

    /// Defines names as numbers from 0.
    fn add_numbered<'a>(&mut self, names: impl Iterator<Item = &'a str>) {
        for (number, name) in names.enumerate() {
            self.add(name, format_args!("{number}U"));
        }
    }

    /// Defines names as the offsets of consecutive fields.
    fn add_places(&mut self, layout: &[(&str, usize)]) {
        let mut first = 0;
        for (name, length) in layout {
            self.add(name, first);
            first += length;
        }
    }
}

/// A name in the form of a constant: `fresnel-mirror` becomes `FRESNEL_MIRROR`.
fn constant(name: &str) -> String {
    name.to_uppercase().replace('-', "_")
}

/// Constants that both precisions define.
fn numbers(precision: Precision) -> Vec<(&'static str, f64)> {
    let digits = match precision {
        Precision::F64 => f64::MANTISSA_DIGITS,
        Precision::F32 => f32::MANTISSA_DIGITS,
    };
    vec![
        ("PI", PI),
        ("INVERSE_PI", FRAC_1_PI),
        ("TAU", TAU),
        ("UNIT_STEP", 1.0 / (1_u64 << digits) as f64),
        ("TURN_SHIFT", 1.5 * (1_u64 << (digits - 1)) as f64),
        ("UNIFORM_SPHERE_DENSITY", UNIFORM_SPHERE_DENSITY),
        ("HIDING", HIDING),
        (
            "SMALLEST_NORMAL",
            match precision {
                Precision::F64 => f64::MIN_POSITIVE,
                Precision::F32 => f32::MIN_POSITIVE.into(),
            },
        ),
    ]
}

fn definitions(effects: Effects, rules: &PathRules, precision: Precision) -> String {
    let mut all = Definitions(String::new());
    for entry in PRIMITIVES.iter().chain(pathmark_tracer::material::MATERIALS).chain(FEATURES) {
        all.add(&format!("HAS_{}", constant(entry.name)), u8::from(effects.cover(entry.effect)));
    }
    all.add("SPLITS", rules.splits);
    all.add("AIMS", u8::from(rules.nee.is_some()));
    all.add("HAS_CAMERA_RAYS", u8::from(rules.camera_rays > 1));
    all.add_numbered(SAMPLERS.iter().map(|(_, name)| *name));
    all.add_numbered(MATERIALS.iter().copied());
    for names in KINDS {
        all.add_numbered(names.iter().copied());
    }
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
    all.add_places(TASK);
    all.add_places(PIECE);
    all.add("PIECE_WORDS", PIECE.iter().map(|(_, words)| words).sum::<usize>());
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
    for (name, value) in numbers(Precision::F64) {
        all.add_number(name, value);
    }
    for (name, coefficients) in [("SINE_COEFFICIENTS", SIN), ("COSINE_COEFFICIENTS", COS)] {
        all.add(name, coefficients.map(|c| format!("({c:e})")).join(", "));
        let single = coefficients[..SINGLE_COEFFICIENTS].iter().map(|c| format!("({:e}f)", *c as f32));
        all.add(&format!("{name}_S"), single.collect::<Vec<_>>().join(", "));
    }
    for (name, value) in numbers(Precision::F32) {
        all.add(&format!("{name}_S"), format_args!("({:e}f)", value as f32));
    }
    // If paths are in single precision, double precision judges rays that are only exact to single precision.
    let digits = match precision {
        Precision::F64 => f64::MANTISSA_DIGITS,
        Precision::F32 => f32::MANTISSA_DIGITS,
    };
    all.add_number("NEARNESS", nearness(digits));
    all.add("NEARNESS_S", format_args!("({:e}f)", nearness(digits) as f32));
    all.add_number("PADDING", padding(digits));
    all.add_number("HALF_PADDING", 0.5 * padding(f64::MANTISSA_DIGITS));
    all.0
}

/// Splits a text into words and the text between them. A dot continues a word, so a number is one word, and a field's
/// name is part of a longer one.
fn tokens(text: &str) -> impl Iterator<Item = &str> {
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'.';
    text.as_bytes().chunk_by(move |a, b| is_word(*a) == is_word(*b)).map(|chunk| {
        // Cuts between ASCII bytes leave valid UTF-8.
        std::str::from_utf8(chunk).unwrap_or_default()
    })
}

/// The functions and types that a text declares. Each declaration begins a line; the declaration of a type may end on a
/// later line.
fn declared(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| {
        let line = line.split("//").next().unwrap_or_default().trim_end();
        let head = if line.starts_with("FN ") {
            line.split('(').next()?
        } else if (line.starts_with("typedef ") || line.starts_with('}')) && line.ends_with(';') {
            line.trim_end_matches(';')
        } else {
            return None;
        };
        head.rsplit(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).next().filter(|name| !name.is_empty())
    })
}

/// Translates a text from double to single precision: the type and the suffix of numbers change, and names in both
/// precisions end in `_s` or `_S`.
fn in_single(text: &str, names: &BTreeSet<&str>) -> String {
    let mut single = String::with_capacity(text.len() + text.len() / 8);
    for line in text.split_inclusive('\n') {
        let (code, comment) = line.split_at(line.find("//").unwrap_or(line.len()));
        for token in tokens(code) {
            single.push_str(if token == "real" { "single" } else { token });
            if names.contains(token) {
                single.push_str(if token.starts_with(|c: char| c.is_ascii_uppercase()) { "_S" } else { "_s" });
            } else if token.starts_with(|c: char| c.is_ascii_digit()) && token.contains('.') {
                single.push('f');
            }
        }
        single.push_str(comment);
    }
    single
}

/// The program's text for scenes with these effects and paths with these rules.
pub(super) fn text(effects: Effects, rules: &PathRules, precision: Precision) -> String {
    let definitions = definitions(effects, rules, precision);
    let double = [&[definitions.as_str()], DOUBLE].concat().concat();
    if precision == Precision::F64 {
        return [&[double.as_str()], PATH].concat().concat();
    }
    let own = [&[SINGLE, SINGLE_SHAPE], SINGLE_SEARCH].concat().concat();
    let both = [&[MATH, TREE], PATH].concat();
    let mut names: BTreeSet<&str> = both.iter().flat_map(|text| declared(text)).collect();
    names.extend(declared(&own).filter_map(|name| name.strip_suffix("_s")));
    names.extend(WORDS_OF_BOTH);
    names.extend(numbers(precision).iter().map(|(name, _)| *name));
    let [math, tree, path] = [MATH, TREE, &PATH.concat()].map(|text| in_single(text, &names));
    [&[double.as_str(), SINGLE, &math, SINGLE_SHAPE, &tree], SINGLE_SEARCH, &[&path, ENTRY]].concat().concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pathmark_device::{DeviceError, inexact_instructions, ptx_of};
    use pathmark_tracer::estimator::{LightSampling, Roulette};
    use pathmark_tracer::scene::PROFILES;

    /// Types, declared names, shared names and numbers change; fields, comments and other names do not.
    #[test]
    fn a_text_is_put_into_single_precision() {
        let text = "FN real plus(real a, vec b) { return TAU * a + 0.5 * plus(b.plus, -1.0); }  // plus 1.0\n} vec;\n";
        let mut names: BTreeSet<&str> = declared(text).collect();
        assert_eq!(names.iter().copied().collect::<Vec<_>>(), ["plus", "vec"]);
        names.insert("TAU");
        let single = "FN single plus_s(single a, vec_s b) { return TAU_S * a + 0.5f * plus_s(b.plus, -1.0f); }  // plus 1.0\n} vec_s;\n";
        assert_eq!(in_single(text, &names), single);
    }

    /// Every program as CUDA's compiler translates it: no operation is fused, approximated, or rounded by the
    /// assembler's choice.
    #[test]
    fn no_code_for_gpus_fuses_or_estimates() {
        let (max_depth, roulette) = (u16::MAX, Roulette::SMALLPT);
        let rules = |splits, nee, camera_rays| PathRules { splits, nee, max_depth, roulette, camera_rays };
        for profile in PROFILES {
            let rules = [rules(0, None, 1), rules(2, None, 1), rules(0, Some(LightSampling::Mis), 4)];
            for (rules, precision) in
                rules.into_iter().flat_map(|rules| Precision::ALL.map(|precision| (rules, precision)))
            {
                let ptx = match ptx_of(&text(profile.effects, &rules, precision), u32::MAX) {
                    Ok(ptx) => ptx,
                    Err(DeviceError::Missing { id, why }) => return println!("SKIPPED: there is no {id}: {why}"),
                    Err(error) => panic!("{}: {error}", profile.name),
                };
                let root = if precision == Precision::F64 { "sqrt.rn.f64" } else { "sqrt.rn.f32" };
                assert!(ptx.contains("mul.rn.f64") && ptx.contains(root), "{}: no arithmetic", profile.name);
                let inexact = inexact_instructions(&ptx);
                assert!(inexact.is_empty(), "{}: {inexact:?}", profile.name);
            }
        }
    }
}
