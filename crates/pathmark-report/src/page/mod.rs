//! `report.html`: the whole report in one file, readable without a network.

mod address;
mod again;
mod answers;
pub(crate) mod block;
pub(crate) mod bursts;
mod compact;
pub(crate) mod doctor;
pub(crate) mod guards;
mod index;
mod notes;
mod photo;
mod provenance;
pub mod replication;
mod sources;
pub(crate) mod table;

use crate::error::{Error, Result};
use crate::experiment::{Chapter, Definition, RunFile};
use crate::measure::{LeftOut, Record, TimingConcerns};
use crate::plot::Figure;
use crate::prelude::joined;
use crate::results::Results;
use crate::words::counted;
pub(crate) use address::{href, way};
use again::Again;
use block::Block;
use compact::Styles;
pub(crate) use index::{INDEX, index};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use provenance::provenance;
use serde::Serialize;
use std::collections::{BTreeSet, HashMap};
use std::fs::File;
use std::io::Read;
use std::path::Path;
use table::Table;

const STYLE: &str = include_str!("../../assets/report.css");
const SCRIPTS: [&str; 4] = [
    include_str!("../../assets/report.js"),
    include_str!("../../assets/report-links.js"),
    include_str!("../../assets/report-pictures.js"),
    include_str!("../../assets/report-timelines.js"),
];

const TITLE: &str = "Pathmark: report";
/// The program that wrote a page, in its head.
const GENERATOR: &str = "<meta name=\"generator\" content=\"Pathmark\">";

/// The generator is within this many bytes from the beginning of a page.
const HEAD_BYTES: u64 = 1024;

/// Whether a file is a report page, which a new one may replace.
pub(crate) fn is_page(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    let head = String::from_utf8_lossy(&head);
    // Pages of older versions have no generator.
    read.is_ok() && (head.contains(GENERATOR) || head.contains(&format!("<title>{TITLE}</title>")))
}

/// Tables with more rows start closed.
const OPEN_ROWS: usize = 12;

/// A part of the page: an experiment, the guards, the bursts or the claims.
#[derive(Default)]
pub(crate) struct Section {
    /// Its name, from which its anchor is made.
    pub(crate) name: String,
    /// The title of a page with it; `None` if it says nothing about the whole page.
    pub(crate) page_title: Option<String>,
    pub(crate) title: String,
    pub(crate) question: String,
    pub(crate) analysis: String,
    /// Its chapter; `None` for the claims, which are a chapter by themselves.
    pub(crate) chapter: Option<Chapter>,
    /// Its place in the chapter.
    pub(crate) place: u32,
    /// Its finding at the beginning of the page.
    pub(crate) in_short: Option<String>,
    /// The commands that run a part again; `None` if there are none.
    pub(crate) again: Option<Again>,
    pub(crate) failed: Vec<Record>,
    pub(crate) left_out: LeftOut,
    /// Number of rows that were run and did not fail.
    pub(crate) rows: usize,
    /// Rows whose times are in doubt.
    pub(crate) doubts: TimingConcerns,
    /// Command and machine; `None` for the claims, which are computed anew for each page.
    pub(crate) run: Option<RunFile>,
    /// Its files of raw data, as paths from the page.
    pub(crate) files: Vec<String>,
    /// The folder of its figures, as a path from the page, if the page only links to them.
    pub(crate) linked_figures: Option<String>,
    pub(crate) blocks: Vec<Block>,
}

impl Section {
    /// Its anchor, the target of links: its name without characters that an address would read.
    fn anchor(&self) -> String {
        let kept = |letter: char| if letter.is_alphanumeric() || "-_.".contains(letter) { letter } else { '-' };
        self.name.chars().map(kept).collect()
    }

    /// Whether half of its rows or more are in doubt.
    fn is_disturbed(&self) -> bool {
        self.doubts.is_any() && 2 * self.doubts.count() >= self.rows
    }

    /// Its result: its answer, or else the finding for the beginning of the page, or its first one.
    fn headline(&self) -> Option<&str> {
        let answer = self.blocks.iter().find_map(|block| match block {
            Block::Answer { text, .. } => Some(text.as_str()),
            _ => None,
        });
        answer.or(self.in_short.as_deref()).or_else(|| self.blocks.iter().find_map(Block::as_finding))
    }

    pub(crate) fn of(results: Results, blocks: Vec<Block>) -> Self {
        let rows = results.len();
        let doubts = results.doubts();
        let again = Again::of(&results);
        let Definition { name, title, question, analysis, chapter, place, in_short, .. } = results.definition;
        let findings = || blocks.iter().filter_map(Block::as_finding);
        let in_short = in_short.and_then(|number| findings().nth(number.get() - 1)).map(ToString::to_string);
        let Results { failed, left_out, run, .. } = results;
        let words = Self { name, title, question, analysis, in_short, ..Self::default() };
        Self { chapter: Some(chapter), place, again, failed, left_out, rows, doubts, run: Some(run), blocks, ..words }
    }
}

/// Longer cells are prose and may be broken into lines.
const LONGEST_CELL: usize = 56;

/// The page of all sections.
pub(crate) fn html(sections: &[Section]) -> Result<String> {
    report(sections, &Markup::default())
}

/// The page of one section, beside a list of all.
pub(crate) fn html_of_one(section: &Section) -> Result<String> {
    report(std::slice::from_ref(section), &html! { p { a href=(INDEX) { "All experiments" } } })
}

/// The page of sections, with `above` the table of contents.
fn report(sections: &[Section], above: &Markup) -> Result<String> {
    let mut styles = Styles::default();
    let claims: Vec<&Section> = sections.iter().filter(|section| section.chapter.is_none()).collect();
    let chapters = chapters(sections);
    let answers = answers::markup(sections, &mut styles)?;
    let mut parts = Vec::new();
    for (chapter, sections) in &chapters {
        parts.push(self::chapter((*chapter, heading(*chapter, &chapters)), sections, &mut styles)?);
    }
    for claims in claims {
        parts.push(section(claims, true, &mut styles)?);
    }
    let title = title(sections);
    let nav = html! { (above) (contents(sections, &chapters)) };
    let main = html! {
        h1 { (title) }
        (about(sections))
        (banner(sections))
        (answers)
        (in_short(sections, &chapters))
        @for part in &parts { (part) }
        (sources::markup(sections))
    };
    Ok(document(title, &styles, &nav, &main))
}

/// A whole page.
fn document(title: &str, styles: &Styles, nav: &Markup, main: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                (PreEscaped(GENERATOR))
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style #figure-style { (PreEscaped(styles.sheet())) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                nav aria-label="Contents" { (nav) }
                main { (main) }
                @for script in SCRIPTS { script { (PreEscaped(script)) } }
            }
        }
    };
    page.into_string()
}

/// The chapters that have sections, with these in their order.
fn chapters(sections: &[Section]) -> Vec<(Chapter, Vec<&Section>)> {
    let all = Chapter::ALL.into_iter().map(|chapter| (chapter, of_chapter(sections, chapter)));
    all.filter(|(_, sections)| !sections.is_empty()).collect()
}

/// The title of a page: the one that a section gives it, or that of its experiment, if it is the only one.
fn title(sections: &[Section]) -> &str {
    if let Some(title) = sections.iter().find_map(|section| section.page_title.as_deref()) {
        return title;
    }
    let mut own = sections.iter().filter(|section| section.run.is_some());
    match (own.next(), own.next()) {
        (Some(only), None) => &only.title,
        _ => TITLE,
    }
}

/// When and where the rows were measured, and by which sources; several machines are in the table at the end.
fn about(sections: &[Section]) -> Markup {
    let runs = || sections.iter().filter_map(|section| section.run.as_ref());
    let started = runs().map(|run| run.started_utc.as_str()).filter(|started| !started.is_empty());
    let days: BTreeSet<&str> = started.filter_map(|started| started.split('T').next()).collect();
    let machines: BTreeSet<String> = runs().map(|run| run.machine.line()).collect();
    let commits: BTreeSet<&str> = runs().map(|run| run.machine.commit.as_str()).collect();
    let few = |found: Vec<String>, things: &str| match found.as_slice() {
        [] => String::new(),
        [only] => only.clone(),
        all => format!("{} {things}", all.len()),
    };
    let days: Vec<&str> = days.into_iter().collect();
    let when = match days.as_slice() {
        [] => String::new(),
        [day] => (*day).to_string(),
        [first, .., last] => format!("{first} to {last}"),
    };
    let commits = few(
        commits.into_iter().filter(|commit| !commit.is_empty()).map(|own| format!("commit {own}")).collect(),
        "commits",
    );
    let facts = joined([when, few(machines.into_iter().collect(), "machines"), commits]);
    html! {
        p.facts { (facts) }
        p.facts { "Intervals have 95 % confidence where they name no other. Every number comes from the rows that the section links to." }
    }
}

/// A warning if more than a tenth of all rows are in doubt.
fn banner(sections: &[Section]) -> Markup {
    let rows: usize = sections.iter().filter(|section| section.run.is_some()).map(|section| section.rows).sum();
    let doubted: usize = sections.iter().map(|section| section.doubts.count()).sum();
    let disturbed = sections.iter().filter(|section| section.is_disturbed()).count();
    html! {
        @if 10 * doubted > rows {
            div.failed.banner {
                p { strong { (doubted) " of " (rows) " rows were disturbed." } " Other programs, the clock or the host of a virtual machine changed their times. "
                    @if disturbed > 0 { "Figures of " (counted(disturbed, "section")) " with half of the rows in doubt are pale." } }
            }
        }
    }
}

/// The sections of a chapter, in their order.
fn of_chapter(sections: &[Section], chapter: Chapter) -> Vec<&Section> {
    let mut own: Vec<&Section> = sections.iter().filter(|section| section.chapter == Some(chapter)).collect();
    own.sort_by_key(|section| section.place);
    own
}

/// The heading of a chapter. Experiments that name none are no others where they are all.
fn heading(chapter: Chapter, chapters: &[(Chapter, Vec<&Section>)]) -> &'static str {
    if chapter == Chapter::Others && chapters.len() == 1 { "Experiments" } else { chapter.title() }
}

fn contents(sections: &[Section], chapters: &[(Chapter, Vec<&Section>)]) -> Markup {
    let link = |name: &str, title: &str| html! { a href={ "#" (name) } { (title) } };
    let has_answers = answers::is_any(sections);
    html! {
        details open {
            summary { "Contents" }
            ul {
                @if has_answers { li { (link(answers::ANCHOR, "The answers")) } }
                @if !findings(sections, chapters).is_empty() { li { (link(IN_SHORT, in_short_title(has_answers))) } }
                @for (chapter, sections) in chapters {
                    li {
                        (link(chapter.anchor(), heading(*chapter, chapters)))
                        ul { @for section in sections { li { (link(&section.anchor(), &section.title)) } } }
                    }
                }
                @for section in sections.iter().filter(|section| section.chapter.is_none()) {
                    li { (link(&section.anchor(), &section.title)) }
                }
                li { (link(SOURCES, SOURCES_TITLE)) }
            }
        }
    }
}

const IN_SHORT: &str = "in-short";
const SOURCES: &str = "sources";
const SOURCES_TITLE: &str = "Machine, method, raw data";

fn in_short_title(has_answers: bool) -> &'static str {
    if has_answers { "More findings" } else { "In short" }
}

/// The most important findings that are no answers, with their sections.
fn findings<'a>(sections: &'a [Section], chapters: &[(Chapter, Vec<&'a Section>)]) -> Vec<(&'a Section, &'a str)> {
    let claims = sections.iter().filter(|section| section.chapter.is_none());
    let ordered = chapters.iter().flat_map(|(_, sections)| sections.iter().copied()).chain(claims);
    let others = ordered.filter(|section| !answers::has(sections, section));
    others.filter_map(|section| Some((section, section.in_short.as_deref()?))).collect()
}

/// These findings, each with a link to its section.
fn in_short(sections: &[Section], chapters: &[(Chapter, Vec<&Section>)]) -> Markup {
    let found = findings(sections, chapters);
    html! {
        @if !found.is_empty() {
            section.in-short id=(IN_SHORT) {
                h2 { (in_short_title(answers::is_any(sections))) }
                ul { @for (section, text) in found { li { (prose(text)) " " a href={ "#" (section.anchor()) } { (section.title) } } } }
            }
        }
    }
}

fn chapter((chapter, heading): (Chapter, &str), sections: &[&Section], styles: &mut Styles) -> Result<Markup> {
    let parts = sections.iter().map(|own| section(own, false, styles)).collect::<Result<Vec<Markup>>>()?;
    Ok(html! {
        h2 id=(chapter.anchor()) { (heading) }
        @for part in &parts { (part) }
    })
}

/// A section. Its heading has the rank of a chapter's if it is a chapter itself.
fn section(section: &Section, is_chapter: bool, styles: &mut Styles) -> Result<Markup> {
    let first_table = section.blocks.iter().position(|block| matches!(block, Block::Table { .. }));
    let blocks = section.blocks.iter().enumerate();
    let parts = blocks.map(|(at, block)| part(section, block, first_table == Some(at), styles));
    let parts = parts.collect::<Result<Vec<Markup>>>()?;
    Ok(html! {
        section id=(section.anchor()) data-again=[section.again.as_ref().map(json)] {
            @if is_chapter { h2 { (section.title) } } @else { h3 { (section.title) } }
            p { strong { "Question. " } (prose(&section.question)) }
            @if !section.failed.is_empty() {
                div.failed {
                    p { strong { (counted(section.failed.len(), "row")) " failed." } " Failed rows are in no figure or table." }
                    ul { @for (error, cells) in failures(&section.failed).into_iter().take(10) { li { code { (cells[0]) } @if cells.len() > 1 { " and " (cells.len() - 1) " more" } ": " (error) } } }
                }
            }
            @if section.left_out.count() > 0 {
                div.failed {
                    p { strong { "Left out: " (counted(section.left_out.count(), "row")) "." } " Rows that were not run are in no figure or table." }
                    ul { @for line in section.left_out.lines() { li { (line) } } }
                }
            }
            @if section.doubts.is_any() { p.doubts.high[section.doubts.is_high()] { (section.doubts) "; " code { "pathmark list warnings" } " says what each means." } }
            @if let Some(goal) = section.run.as_ref().and_then(|run| run.until.as_ref()) {
                p.doubts {
                    "Repetitions went on until the goal " code { (goal) } " or a limit was reached. Intervals of medians hold nevertheless; those of fitted lines assume a fixed number of repetitions."
                }
            }
            @for part in &parts { (part) }
            @for paragraph in section.analysis.split("\n\n") { p { (prose(paragraph)) } }
            @if let Some(run) = &section.run { (provenance(section, run)) }
        }
    })
}

/// The errors of the failed rows, each with its cells: a program that fails usually fails in every row.
fn failures(failed: &[Record]) -> Vec<(&str, Vec<&str>)> {
    let (mut errors, mut places) = (Vec::<(&str, Vec<&str>)>::new(), HashMap::new());
    for record in failed {
        let place = *places.entry(record.error.as_str()).or_insert(errors.len());
        if place == errors.len() {
            errors.push((&record.error, Vec::new()));
        }
        errors[place].1.push(&record.cell);
    }
    errors
}

fn part(section: &Section, block: &Block, is_first_table: bool, styles: &mut Styles) -> Result<Markup> {
    if let Some(folder) = &section.linked_figures
        && let Some((file, title)) = block.picture_file()
    {
        return Ok(html! { p.files { "Figure: " a href=(href(&format!("{folder}/{file}"))) { (title) } } });
    }
    Ok(match block {
        Block::Answer { .. } => Markup::default(),
        Block::Finding(text) => html! { p.finding { (prose(text)) } },
        Block::Notice(text) => html! { p.notice { (prose(text)) } },
        Block::Figure { stem, figure } => figure_markup(section, stem, figure.as_ref(), styles)?,
        Block::Picture { stem, title, png, comparison, images } => html! {
            figure.sheet id={ (section.anchor()) "-" (stem) } {
                img alt=(title) src=(photo::source(png)?);
                script.images type="application/json" { (PreEscaped(in_script(&json(&(comparison, images))))) }
                figcaption { (number(section, stem)) }
            }
        },
        Block::Table { table, .. } => table_markup(table, is_first_table),
    })
}

/// A figure, which is pale if times that it may show are in doubt.
fn figure_markup(section: &Section, stem: &str, figure: &dyn Figure, styles: &mut Styles) -> Result<Markup> {
    let drawing = figure.drawing();
    let svg = styles.figure(&drawing, &notes::of(&drawing.notes))?;
    let other = figure.other_axes().map(|(name, other)| {
        let svg = styles.figure(&other, &notes::again(&other.notes, &drawing.notes))?;
        Ok::<_, Error>((name, svg))
    });
    let other = other.transpose()?;
    let is_disturbed = section.is_disturbed();
    Ok(html! {
        figure class=[is_disturbed.then_some("disturbed")] id={ (section.anchor()) "-" (stem) } {
            (PreEscaped(svg))
            @if let Some((name, svg)) = other { div.other hidden data-name=(name) { (PreEscaped(svg)) } }
            @if let Some(data) = figure.data() { script.jobs type="application/json" { (PreEscaped(in_script(&data))) } }
            figcaption {
                (number(section, stem))
                @if is_disturbed { " Pale, because the times of " (section.doubts.count()) " of " (section.rows) " rows are in doubt." }
            }
        }
    })
}

/// The number of a figure, which the style sheet counts, a link to it, and its origin.
fn number(section: &Section, stem: &str) -> Markup {
    html! { a href={ "#" (section.anchor()) "-" (stem) } {} (origin(section)) }
}

/// The rows of a figure, and the link to the commands that draw it or measure it again.
fn origin(section: &Section) -> Markup {
    html! {
        @if let Some(rows) = section.files.first() {
            span.origin { " " a href=(href(rows)) { "Rows" } ", " a href={ "#" (section.anchor()) "-" (AGAIN) } { "commands" } }
        }
    }
}

/// The end of the anchor of a section's commands.
const AGAIN: &str = "again";

/// Data for the page's script.
fn json(data: &impl Serialize) -> String {
    serde_json::to_string(data).unwrap_or_default()
}

/// JSON for a script element: a tag within a name must not end the element.
fn in_script(json: &str) -> String {
    json.replace('<', "\\u003c")
}

/// A table, without columns in which no row has a value. The first of a section is open if it is short.
fn table_markup(table: &Table, is_first: bool) -> Markup {
    // A column is set as text if one of its cells is long.
    let mut is_text = vec![false; table.heads().count()];
    for row in table.rows() {
        is_text.iter_mut().zip(&row).for_each(|(is_text, cell)| *is_text |= cell.len() > LONGEST_CELL);
    }
    let columns: Vec<(usize, &str)> =
        table.heads().enumerate().filter(|(column, _)| !table.is_blank(*column)).collect();
    let text = |at: usize| is_text[at].then_some("text");
    html! {
        details.wide open[is_first && table.len() <= OPEN_ROWS] {
            summary { (table.title) }
            table {
                thead { tr { @for (at, head) in &columns { th class=[text(*at)] { (head) } } } }
                tbody {
                    @for (number, row) in table.rows().enumerate() {
                        @let bars: Vec<Option<[f64; 2]>> = table.bars(number).collect();
                        @let claim = claim(&columns, &row);
                        tr id=[claim.map(|(id, _)| format!("claim-{id}"))] {
                            @for (at, head) in &columns {
                                @let cell = &row[*at];
                                td class=[text(*at)] data-verdict=[(*head == "verdict").then_some(cell)] {
                                    @if let Some((id, words)) = claim.filter(|_| *head == CLAIM) { a href={ "#claim-" (id) } { (id) } ". " (words) }
                                    @else { (broken(cell, is_text[*at])) }
                                    @if let Some([low, high]) = bars[*at] { i style={ "--a:" (format!("{low:.2}")) ";--b:" (format!("{high:.2}")) } {} }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The column of claims in a table of verdicts.
const CLAIM: &str = "claim";

/// The number of the claim in a row of verdicts, and its words.
fn claim<'a>(columns: &[(usize, &str)], row: &'a [String]) -> Option<(&'a str, &'a str)> {
    let column = |name: &str| columns.iter().find(|(_, head)| *head == name).map(|(at, _)| *at);
    column("verdict")?;
    row[column(CLAIM)?].split_once(". ").filter(|(id, _)| id.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The text of a cell. Lines break only between a number, its interval and its confidence, also in a narrow column.
fn broken(cell: &str, is_text: bool) -> Markup {
    let is_number = cell.starts_with(|first: char| first.is_ascii_digit() || first == '-');
    if is_text || !is_number || !cell.contains(' ') {
        return html! { (cell) };
    }
    let parts = cell.split_inclusive(", ").flat_map(|part| match part.find(" (") {
        Some(at) => vec![&part[..at], &part[at + 1..]],
        None => vec![part.trim_end()],
    });
    html! { @for part in parts { span { (part.replace(" %", "\u{a0}%")) } " " } }
}

/// Text from definitions; parts between backticks are code.
fn prose(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

#[cfg(test)]
mod tests;
