//! `report.html`: one file with everything in it, readable without a network.

use super::block::{Block, Table};
use super::results::Results;
use crate::error::Result;
use crate::experiment::{Definition, RunFile};
use crate::measure::Record;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::fs::File;
use std::io::Read;
use std::path::Path;

const STYLE: &str = "
body { font: 16px/1.55 system-ui, sans-serif; color: #222; background: #fff; max-width: 68rem; margin: 2rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.9rem; margin-bottom: .2rem; } h2 { margin-top: 3.2rem; border-top: 2px solid #222; padding-top: 1rem; }
p { max-width: 46rem; } figure { margin: 1.6rem 0; overflow-x: auto; } svg, img { max-width: 100%; height: auto; }
table { border-collapse: collapse; font-size: .82rem; font-variant-numeric: tabular-nums; } summary { font-weight: 600; padding: .4rem 0; cursor: pointer; }
.wide { overflow-x: auto; margin: 1.4rem 0; } th, td { padding: .22rem .7rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap; }
th { border-bottom: 2px solid #222; white-space: normal; vertical-align: bottom; } th:first-child, td:first-child { text-align: left; }
.finding { border-left: 4px solid #0072b2; padding: .1rem 0 .1rem 1rem; } .failed { border-left: 4px solid #d55e00; padding-left: 1rem; }
code, pre { background: #f3f3f3; padding: .1rem .3rem; } pre { padding: .7rem 1rem; overflow-x: auto; } nav a { margin-right: 1.2rem; }
details { margin: 1rem 0; } td.text { text-align: left; white-space: normal; }
";

const TITLE: &str = "Pathmark: report";

/// The title stands among the first bytes of a page.
const HEAD_BYTES: u64 = 1024;

/// Whether a file is such a page, and may be replaced by a new one.
pub(super) fn is_page(path: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(path).and_then(|file| file.take(HEAD_BYTES).read_to_end(&mut head));
    read.is_ok() && String::from_utf8_lossy(&head).contains(&format!("<title>{TITLE}</title>"))
}

/// Longer tables start closed.
const OPEN_ROWS: usize = 12;

/// A chapter of the page.
pub(super) struct Section {
    /// What links point at.
    pub(super) name: String,
    pub(super) title: String,
    pub(super) question: String,
    pub(super) analysis: String,
    /// Rows that failed.
    pub(super) failed: Vec<Record>,
    /// How many rows did not.
    pub(super) rows: usize,
    /// Command and machine.
    pub(super) run: RunFile,
    pub(super) blocks: Vec<Block>,
}

impl Section {
    /// An experiment's.
    pub(super) fn of(results: Results, blocks: Vec<Block>) -> Self {
        let rows = results.len();
        let Definition { name, title, question, analysis, .. } = results.definition;
        Self { name, title, question, analysis, failed: results.failed, rows, run: results.run, blocks }
    }
}

/// Longer cells are prose and may be broken.
const LONGEST_CELL: usize = 56;

/// The page.
pub(super) fn html(sections: &[Section]) -> Result<String> {
    let body = sections.iter().map(section).collect::<Result<Vec<Markup>>>()?;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (TITLE) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { (TITLE) }
                p { "How should unequal pieces of work be scheduled on many cores, and what does accuracy cost in time? "
                    "Every number below comes from the rows in " code { "records.csv" } " beside this page; " code { "METHODOLOGY.md" } " says how." }
                nav { @for section in sections { a href={ "#" (section.name) } { (section.title) } } }
                @for part in &body { (part) }
            }
        }
    };
    Ok(page.into_string())
}

fn section(section: &Section) -> Result<Markup> {
    let parts = section.blocks.iter().map(part).collect::<Result<Vec<Markup>>>()?;
    Ok(html! {
        section id=(section.name) {
            h2 { (section.title) }
            p { strong { "Question. " } (prose(&section.question)) }
            @if !section.failed.is_empty() {
                div.failed {
                    p { strong { (section.failed.len()) " rows failed." } " They are left out of figures and tables." }
                    ul { @for record in section.failed.iter().take(10) { li { code { (record.cell) } ": " (record.error) } } }
                }
            }
            @for part in &parts { (part) }
            @for paragraph in section.analysis.split("\n\n") { p { (prose(paragraph)) } }
            (provenance(section))
        }
    })
}

fn part(block: &Block) -> Result<Markup> {
    Ok(match block {
        Block::Finding(text) => html! { p.finding { (prose(text)) } },
        Block::Figure { figure, .. } => html! { figure { (PreEscaped(figure.svg()?)) } },
        Block::Picture { title, png, .. } => html! {
            figure { img alt=(title) src={ "data:image/png;base64," (STANDARD.encode(png)) }; }
        },
        Block::Table { table, .. } => table_markup(table),
    })
}

fn table_markup(table: &Table) -> Markup {
    html! {
        details.wide open[table.rows.len() <= OPEN_ROWS] {
            summary { (table.title) }
            table {
                thead { tr { @for column in &table.columns { th { (column) } } } }
                tbody { @for row in &table.rows { tr { @for cell in row { td.text[cell.len() > LONGEST_CELL] { (cell) } } } } }
            }
        }
    }
}

fn provenance(section: &Section) -> Markup {
    let RunFile { command, profile, machine, .. } = &section.run;
    let memory_gib = machine.memory_bytes as f64 / f64::from(1 << 30);
    let facts = [
        ("processor", machine.cpu.clone()),
        ("processors", format!("{} ({} physical cores)", machine.processors, machine.physical_cores)),
        ("governor", machine.governor.clone()),
        ("memory", format!("{memory_gib:.1} GiB")),
        ("system", machine.system.clone()),
        ("load when the sweep began", machine.load_average.clone()),
        ("compiler", format!("{}, profile {}, flags {}", machine.rustc, machine.profile, or_none(&machine.rustflags))),
        ("sources", format!("{}{}", machine.commit, if machine.dirty { " with uncommitted changes" } else { "" })),
        ("rows", format!("{} done, {} failed", section.rows, section.failed.len())),
    ];
    html! {
        details open[false] {
            summary { "Command and machine" }
            pre { (command) }
            p { "Profile " (profile) "." }
            table { @for (name, value) in facts { tr { th { (name) } td.text { (value) } } } }
        }
    }
}

/// What definitions write between backticks is code.
fn prose(text: &str) -> Markup {
    html! {
        @for (index, part) in text.split('`').enumerate() {
            @if index % 2 == 1 { code { (part) } } @else { (part) }
        }
    }
}

fn or_none(text: &str) -> &str {
    if text.is_empty() { "none" } else { text }
}
