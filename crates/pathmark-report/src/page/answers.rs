//! The first screen: what the rows say about the five questions of the study, each with a figure and with what the reader
//! may rely on.

use super::compact::Styles;
use super::{Section, prose};
use crate::block::Block;
use crate::error::Result;
use maud::{Markup, PreEscaped, html};

/// The sections that answer a question of the study, in the order of the page.
const QUESTIONS: [(&str, &str); 5] = [
    ("accuracy-cost", "What does accuracy cost in time?"),
    ("thread-scaling", "Which schedules tie, and what do the others lose?"),
    ("effects", "What does an effect cost that is not used?"),
    ("guards", "What stays right on hard inputs?"),
    ("scaling-forecast", "What would more cores do?"),
];

/// The anchor of the answers.
pub(super) const ANCHOR: &str = "answers";

/// Most answers of a page without a question of the study.
const MOST: usize = 5;

struct Answer<'a> {
    section: &'a Section,
    heading: &'a str,
    text: &'a str,
    /// The name of its figure.
    stem: &'a str,
    trust: Trust,
}

/// How far a reader may rely on an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Trust {
    Sure,
    /// The intervals leave the answer open.
    Untold,
    /// Half of the rows or more are in doubt.
    Disturbed,
}

impl Trust {
    fn class(self) -> &'static str {
        match self {
            Self::Sure => "sure",
            Self::Untold => "untold",
            Self::Disturbed => "disturbed",
        }
    }

    fn badge(self) -> &'static str {
        match self {
            Self::Sure => "sure",
            Self::Untold => "this machine cannot tell",
            Self::Disturbed => "disturbed",
        }
    }
}

/// The answers of a page: to the questions of the study, or else those of its first sections.
fn answers(sections: &[Section]) -> Vec<Answer<'_>> {
    let asked = QUESTIONS.iter().filter_map(|(name, heading)| {
        sections.iter().filter(|section| section.name == *name).find_map(|section| answer(section, heading))
    });
    let found: Vec<Answer<'_>> = asked.collect();
    if !found.is_empty() {
        return found;
    }
    sections.iter().filter_map(|section| answer(section, &section.title)).take(MOST).collect()
}

fn answer<'a>(section: &'a Section, heading: &'a str) -> Option<Answer<'a>> {
    section.blocks.iter().find_map(|block| match block {
        Block::Answer { text, stem, is_told } => {
            let trust = match is_told {
                _ if section.is_disturbed() => Trust::Disturbed,
                true => Trust::Sure,
                false => Trust::Untold,
            };
            Some(Answer { section, heading, text, stem, trust })
        }
        _ => None,
    })
}

/// Whether the page begins with answers.
pub(super) fn is_any(sections: &[Section]) -> bool {
    !answers(sections).is_empty()
}

/// The figure of an answer, if its section has it.
fn figure(answer: &Answer<'_>, styles: &mut Styles) -> Result<Option<String>> {
    let own = answer.section.blocks.iter().find_map(|block| match block {
        Block::Figure { stem, figure } if *stem == answer.stem => Some(figure),
        _ => None,
    });
    let Some(own) = own else { return Ok(None) };
    Ok(Some(styles.figure(&own.drawing(), "")?))
}

/// Whether a section is among the answers of a page.
pub(super) fn has(sections: &[Section], section: &Section) -> bool {
    answers(sections).iter().any(|answer| std::ptr::eq(answer.section, section))
}

pub(super) fn markup(sections: &[Section], styles: &mut Styles) -> Result<Markup> {
    let answers = answers(sections);
    let figures = answers.iter().map(|answer| figure(answer, styles)).collect::<Result<Vec<Option<String>>>>()?;
    Ok(html! {
        @if !answers.is_empty() {
            section.answers id=(ANCHOR) {
                @for (answer, figure) in answers.iter().zip(&figures) {
                    article {
                        h2 { (answer.heading) " " span class={ "badge " (answer.trust.class()) } { (answer.trust.badge()) } }
                        p { (prose(answer.text)) " " a href={ "#" (answer.section.anchor()) } { "More" } }
                        @if let Some(figure) = figure {
                            a.thumbnail.disturbed[answer.trust == Trust::Disturbed] href={ "#" (answer.section.anchor()) "-" (answer.stem) } aria-label={ "The figure of: " (answer.heading) } { (PreEscaped(figure)) }
                        }
                    }
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::TimingConcerns;

    fn section(name: &str, is_told: bool, [rows, doubted]: [usize; 2]) -> Section {
        let warnings = (0..rows).map(|row| if row < doubted { "drift(+40 %)" } else { "" });
        let text = format!("The answer of {name}.");
        Section {
            name: name.to_string(),
            title: format!("Title of {name}"),
            rows,
            doubts: TimingConcerns::of(warnings),
            blocks: vec![Block::Answer { text, stem: "speedup", is_told }],
            ..Section::default()
        }
    }

    fn page(sections: &[Section]) -> String {
        markup(sections, &mut Styles::default()).unwrap().into_string()
    }

    #[test]
    fn the_questions_of_the_study_are_in_order_and_have_badges() {
        let sections = [
            section("others", true, [9, 0]),
            section("effects", false, [9, 0]),
            section("thread-scaling", true, [10, 5]),
            section("accuracy-cost", true, [10, 4]),
        ];
        let html = page(&sections);
        let place = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text}: {html}"));
        let order = ["What does accuracy cost", "sure", "Which schedules tie", "disturbed", "not used?", "cannot tell"];
        assert!(order.map(place).is_sorted(), "{html}");
        assert!(!html.contains("The answer of others"));
    }

    #[test]
    fn other_pages_begin_with_their_own_sections() {
        let html = page(&[section("mine", true, [3, 0])]);
        assert!(html.contains("Title of mine") && html.contains("The answer of mine.") && html.contains("#mine"));
        assert_eq!(page(&[Section::default()]), "");
    }
}
