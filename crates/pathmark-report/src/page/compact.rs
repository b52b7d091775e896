//! Figures as a part of the page. Their attributes of style take half of an SVG's text and are few: each combination becomes
//! a class of the page. The greys become variables, so that figures are dark on a dark page.

use std::collections::BTreeMap;
use std::fmt::Write;

/// The attributes that become classes.
const ATTRIBUTES: [&str; 7] =
    ["fill", "stroke", "stroke-width", "font-family", "font-size", "text-anchor", "pointer-events"];

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
    /// The SVG with classes instead of attributes of style.
    pub(super) fn compact(&mut self, svg: &str) -> String {
        let mut text = String::with_capacity(svg.len());
        let mut parts = svg.split('<');
        text += parts.next().unwrap_or_default();
        for part in parts {
            let (tag, rest) = part.split_once('>').unwrap_or((part, ""));
            let _ = write!(text, "<{}>{}", self.tag(tag), rest.trim_matches('\n'));
        }
        text
    }

    /// The compact SVG without the values under the pointer.
    pub(super) fn thumbnail(&mut self, svg: &str) -> String {
        let mut parts = svg.split("<circle class=\"note\"");
        let first = parts.next().unwrap_or_default().to_string();
        let rest = parts.map(|part| part.split_once("</circle>").map_or("", |(_, rest)| rest));
        self.compact(&(first + &rest.collect::<String>()))
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
    fn marks_keep_their_class_and_thumbnails_lose_them() {
        let mut styles = Styles::default();
        let note = "<circle class=\"note\" cx=\"1\" fill=\"none\" data-of=\"x\"><title>v</title></circle>";
        let svg = format!("<svg width=\"1\"><g class=\"series\" data-series=\"a\"></g>{note}\n</svg>");
        let compact = styles.compact(&svg);
        assert!(
            compact.contains("<circle cx=\"1\" data-of=\"x\" class=\"note k0\"><title>v</title></circle>"),
            "{compact}"
        );
        assert!(compact.contains("<g data-series=\"a\" class=\"series\"></g>"), "{compact}");
        assert_eq!(styles.thumbnail(&svg), "<svg width=\"1\"><g data-series=\"a\" class=\"series\"></g></svg>");
    }

    #[test]
    fn white_letters_stay_white() {
        let mut styles = Styles::default();
        styles.compact("<text fill=\"#FFFFFF\">a</text><rect fill=\"#FFFFFF\"/>");
        let sheet = styles.sheet();
        assert!(sheet.contains("{fill:#FFFFFF}") && sheet.contains("{fill:var(--f-paper)}"), "{sheet}");
    }
}
