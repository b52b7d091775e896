//! The list of sections for a folder with a page for each of them.

use super::compact::Styles;
use super::{Section, about, banner, chapters, document, heading, href, prose, title};
use crate::prelude::counted;
use maud::{Markup, html};

/// The list's file, beside the pages.
pub(crate) const INDEX: &str = "index.html";

/// The list: of each section its result, with a link to its page.
pub(crate) fn index(sections: &[Section]) -> String {
    let (chapters, title) = (chapters(sections), title(sections));
    let claims = sections.iter().filter(|section| section.chapter.is_none());
    let entry = |section: &Section| -> Markup {
        html! {
            li {
                a href=(href(&format!("{}.html", section.name))) { (section.title) }
                @if let Some(text) = section.headline() { ": " (prose(text)) }
                @if section.is_disturbed() { " " span.badge.disturbed { "disturbed" } }
            }
        }
    };
    let nav =
        html! { p { (counted(sections.len(), "page")) } p { a href={ "../" (crate::PAGE) } { "All on one page" } } };
    let main = html! {
        h1 { (title) }
        (about(sections))
        (banner(sections))
        @for (chapter, sections) in &chapters {
            section.in-short {
                h2 { (heading(*chapter, &chapters)) }
                ul { @for section in sections { (entry(section)) } }
            }
        }
        section.in-short { ul { @for section in claims { (entry(section)) } } }
    };
    document(title, &Styles::default(), &nav, &main)
}
