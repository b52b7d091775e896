//! The embedded font: `DejaVu` Sans, cut down to Latin, Greek, super- and subscripts, arrows and mathematical signs.
//!
//! The licence is beside it in `assets/`. Sizes are in pixels per em, as in CSS.

use std::sync::OnceLock;

use ab_glyph::{Font, FontRef, GlyphId};

use crate::error::{Error, Result};

/// The font family in an SVG. A viewer without `DejaVu` takes its own sans-serif, which is narrower.
pub(super) const FAMILY: &str = "DejaVu Sans, sans-serif";
static BYTES: &[u8] = include_bytes!("../../assets/DejaVuSans-subset.ttf");
static FACE: OnceLock<Option<FontRef<'static>>> = OnceLock::new();

pub(super) fn face() -> Result<&'static FontRef<'static>> {
    let broken = || Error::system("loading", "the embedded font", std::io::ErrorKind::InvalidData.into());
    FACE.get_or_init(|| FontRef::try_from_slice(BYTES).ok()).as_ref().ok_or_else(broken)
}

/// Each glyph of `text` with the position of its origin in ems from the start, and the width of the whole.
pub(super) fn set(face: &FontRef<'static>, text: &str) -> (Vec<(GlyphId, f64)>, f64) {
    let ems = |units: f32| f64::from(units / face.units_per_em().unwrap_or(1.0));
    let (mut glyphs, mut pen) = (Vec::new(), 0.0);
    for glyph in text.chars().map(|c| face.glyph_id(c)) {
        if let Some(&(before, _)) = glyphs.last() {
            pen += ems(face.kern_unscaled(before, glyph));
        }
        glyphs.push((glyph, pen));
        pen += ems(face.h_advance_unscaled(glyph));
    }
    (glyphs, pen)
}

/// Width of `text` in pixels at `size` pixels per em.
pub fn width(text: &str, size: f64) -> f64 {
    // Without a font, painting fails too and reports it.
    face().map_or(0.0, |face| set(face, text).1 * size)
}

/// Breaks `text` at spaces into lines of at most `limit` pixels, where possible. Keeps its line breaks.
pub fn wrap(text: &str, size: f64, limit: f64) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            let longer = if line.is_empty() { word.to_string() } else { format!("{line} {word}") };
            if !line.is_empty() && width(&longer, size) > limit {
                lines.push(std::mem::replace(&mut line, word.to_string()));
            } else {
                line = longer;
            }
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_grow_with_size_and_text() {
        // A digit of `DejaVu` Sans is 1303 of 2048 units wide.
        assert!((width("8", 16.0) - 16.0 * 1303.0 / 2048.0).abs() < 0.1);
        assert!((width("88", 10.0) - 2.0 * width("8", 10.0)).abs() < 0.1);
        assert!(width("", 10.0).abs() < 0.1);
    }

    #[test]
    fn lines_break_at_spaces_and_keep_every_word() {
        let text = "root mean squared error against samples";
        let lines = wrap(text, 12.0, 120.0);
        assert!(lines.len() > 1 && lines.iter().all(|line| width(line, 12.0) <= 120.0));
        assert_eq!(lines.join(" "), text);
        assert_eq!(wrap("one\ntwo", 12.0, 500.0), ["one", "two"]);
        assert_eq!(wrap("unbreakable", 12.0, 5.0), ["unbreakable"]);
        assert!(wrap("", 12.0, 5.0).is_empty());
    }

    #[test]
    fn glyphs_that_axes_and_notes_use_are_there() {
        let face = face().unwrap();
        for glyph in "×²µσ√≤≥≈−±⁻⁰¹²³⁴⁵⁶⁷⁸⁹→∞–·".chars() {
            assert_ne!(face.glyph_id(glyph), face.glyph_id('\u{e000}'), "{glyph}");
        }
    }
}
