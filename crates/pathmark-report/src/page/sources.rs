//! The end of the page: where the rows are, and which program and machine measured them.

use super::{SOURCES, SOURCES_TITLE, Section};
use crate::experiment::RunFile;
use maud::{Markup, html};

/// The folder of each section's rows, with the program and the machine that measured them.
pub(super) fn markup(sections: &[Section]) -> Markup {
    let mut runs: Vec<(&Section, &RunFile)> =
        sections.iter().filter_map(|section| Some((section, section.run.as_ref()?))).collect();
    runs.sort_by(|a, b| a.0.name.cmp(&b.0.name));
    html! {
        section id=(SOURCES) {
            h2 { (SOURCES_TITLE) }
            p { "Each folder holds the raw rows, one for each repetition, the machine and the figures as files. "
                "Times of different machines, or of different hours of a machine that others use too, do not compare; "
                "ratios within a folder do, because each repetition visits every cell once." }
            details.wide open {
                summary { "Folders" }
                table {
                    thead { tr { th { "folder" } th { "rows" } th { "failed" } th { "left out" } th { "in doubt" } th { "profile" } th { "processors" } th { "processor" } th { "sources" } } }
                    tbody {
                        @for (section, run) in runs {
                            @let machine = &run.machine;
                            tr {
                                td { a href={ "#" (section.anchor()) } { (section.name) } }
                                td { (section.rows) }
                                td { (section.failed.len()) }
                                td { (section.left_out.count()) }
                                td { (section.doubts.count()) }
                                td { (run.profile) }
                                td { (machine.processors) }
                                td { (machine.cpu) }
                                td { @if !run.program.is_empty() { (run.program) ", " } (machine.commit) @if machine.dirty { " with changes" } }
                            }
                        }
                    }
                }
            }
        }
    }
}
