//! Figures as a part of the page. Their attributes of style take half of an SVG's text and are few: each combination becomes
//! a class of the page. The greys become variables, so that figures are dark on a dark page.

use crate::error::Result;
use crate::plot::{Drawing, svg};
use std::collections::BTreeMap;
use std::fmt::Write;

/// The attributes that become classes.
const ATTRIBUTES: [&str; 9] = [
    "fill",
    "opacity",
    "stroke",
    "stroke-width",
    "stroke-dasharray",
    "shape-rendering",
    "font-family",
    "font-size",
    "text-anchor",
];

/// The greys of figures with the variables of the page; see `plot::style`.
const GREYS: [(&str, &str); 6] = [
    ("#222222", "var(--f-ink)"),
    ("#141414", "var(--f-ink)"),
    ("#595959", "var(--f-muted)"),
    ("#E1E1E1", "var(--f-grid)"),
    ("#F1F1F1", "var(--f-faint)"),
    ("#FFFFFF", "var(--f-paper)"),
];

/// The classes of a page's figures.
#[derive(Default)]
pub(super) struct Styles {
    classes: BTreeMap<String, usize>,
}

impl Styles {
    /// A drawing with classes instead of attributes of style, and with `notes` as its last elements.
    pub(super) fn figure(&mut self, drawing: &Drawing, notes: &str) -> Result<String> {
        let text = self.compact(&svg::document(drawing, "")?);
        Ok(format!("{}{notes}</svg>", text.strip_suffix("</svg>").unwrap_or(&text)))
    }

    /// The SVG with classes instead of attributes of style.
    fn compact(&mut self, svg: &str) -> String {
        let mut text = String::with_capacity(svg.len());
        let mut parts = svg.split('<');
        text += parts.next().unwrap_or_default();
        for part in parts {
            let (tag, rest) = part.split_once('>').unwrap_or((part, ""));
            let _ = write!(text, "<{}>{}", self.tag(tag), rest.trim_matches('\n'));
        }
        text
    }

    /// A tag with a class for its style.
    fn tag(&mut self, tag: &str) -> String {
        let (mut kept, mut style, mut class) = (String::new(), String::new(), None);
        let mut rest = tag;
        let is_text = tag.starts_with("text ");
        while let Some((before, more)) = rest.split_once("=\"") {
            let (value, after) = more.split_once('"').unwrap_or((more, ""));
            let name = before.trim_start().rsplit(' ').next().unwrap_or_default();
            let lead = &before[..before.len() - name.len()];
            match name {
                "class" => {
                    kept += lead.trim_end();
                    class = Some(value);
                }
                _ if ATTRIBUTES.contains(&name) => {
                    kept += lead.trim_end();
                    let _ = write!(style, "{name}:{};", shown(name, value, is_text));
                }
                _ => {
                    let _ = write!(kept, "{lead}{name}=\"{}\"", value.trim_end());
                }
            }
            rest = after;
        }
        let number = (!style.is_empty()).then(|| {
            let next = self.classes.len();
            format!("k{}", self.classes.entry(style).or_insert(next))
        });
        let classes: Vec<&str> = class.into_iter().chain(number.as_deref()).collect();
        let classes = if classes.is_empty() { String::new() } else { format!(" class=\"{}\"", classes.join(" ")) };
        let slash = if rest.trim() == "/" { "/" } else { "" };
        // A tag without attributes is all rest.
        if kept.is_empty() && classes.is_empty() { rest.to_string() } else { format!("{kept}{classes}{slash}") }
    }

    /// The style sheet of the classes, with the colours on white paper.
    pub(super) fn sheet(&self) -> String {
        let mut text = String::from(
            ":root{--f-ink:#222222;--f-muted:#595959;--f-grid:#e1e1e1;--f-faint:#f1f1f1;--f-paper:#ffffff}",
        );
        let _ = write!(text, ".note{{r:{}px;fill:none;pointer-events:all}}", svg::REACH);
        for (style, number) in &self.classes {
            let _ = write!(text, ".k{number}{{{}}}", style.trim_end_matches(';'));
        }
        text
    }
}

/// The value of an attribute in a style sheet.
fn shown(name: &str, value: &str, is_text: bool) -> String {
    let is_size = matches!(name, "font-size" | "stroke-width");
    let grey = GREYS.iter().find(|(colour, _)| *colour == value).map(|(_, variable)| *variable);
    match grey {
        // White letters stand on a coloured ground.
        Some(variable) if !(is_text && value == "#FFFFFF") => variable.to_string(),
        _ if is_size => format!("{value}px"),
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_styles_share_a_class_and_greys_become_variables() {
        let mut styles = Styles::default();
        let line = "<polyline fill=\"none\" stroke=\"#E1E1E1\" stroke-width=\"2\" points=\"1,2 3,4 \"/>";
        let text =
            "<text x=\"5\" dy=\"0.5ex\" font-size=\"23\" fill=\"#222222\">\na < b\n</text>".replace(" < ", " &lt; ");
        let svg = format!("<svg width=\"9\" role=\"img\">\n<title>T</title>\n{line}\n{line}\n{text}\n</svg>\n");
        let compact = styles.compact(&svg);
        let line = "<polyline points=\"1,2 3,4\" class=\"k0\"/>";
        assert_eq!(
            compact,
            format!(
                "<svg width=\"9\" role=\"img\"><title>T</title>{line}{line}<text x=\"5\" dy=\"0.5ex\" class=\"k1\">a &lt; b</text></svg>"
            )
        );
        let sheet = styles.sheet();
        assert!(sheet.contains(".k0{fill:none;stroke:var(--f-grid);stroke-width:2px}"), "{sheet}");
        assert!(sheet.contains(".k1{font-size:23px;fill:var(--f-ink)}"), "{sheet}");
    }

    #[test]
    fn parts_keep_their_class_and_notes_come_last() {
        let mut styles = Styles::default();
        let part =
            "<svg width=\"1\"><g class=\"series\" data-series=\"a\">\n<path fill=\"none\" d=\"M1 2h3\"/>\n</g>\n</svg>";
        let compact = styles.compact(part);
        let expected =
            "<svg width=\"1\"><g data-series=\"a\" class=\"series\"><path d=\"M1 2h3\" class=\"k0\"/></g></svg>";
        assert_eq!(compact, expected);
        let mut drawing = Drawing::new("t", 9.0, 9.0);
        drawing.path(vec![(1.0, 2.0), (3.0, 2.0)], [1; 3], 1.0);
        let figure = styles.figure(&drawing, "<g>notes</g>").unwrap();
        assert!(figure.ends_with("/><g>notes</g></svg>") && figure.contains("d=\"M2 4h4\""), "{figure}");
    }

    #[test]
    fn white_letters_stay_white() {
        let mut styles = Styles::default();
        styles.compact("<text fill=\"#FFFFFF\">a</text><rect fill=\"#FFFFFF\"/>");
        let sheet = styles.sheet();
        assert!(sheet.contains("{fill:#FFFFFF}") && sheet.contains("{fill:var(--f-paper)}"), "{sheet}");
    }
}
