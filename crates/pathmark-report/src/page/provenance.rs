//! The end of a section: its files, the commands that draw and measure it again, and the machine of its rows.

use super::{AGAIN, Section, href};
use crate::experiment::RunFile;
use crate::shell;
use maud::{Markup, html};

pub(super) fn provenance(section: &Section, run: &RunFile) -> Markup {
    let RunFile { command, program, profile, machine, .. } = run;
    // The system may not report a number, which is then 0.
    let or_unknown = |number: u64, told: String| if number == 0 { "unknown".to_string() } else { told };
    let memory = format!("{:.1} GiB", machine.memory_bytes as f64 / f64::from(1 << 30));
    let cores = or_unknown(machine.physical_cores as u64, machine.physical_cores.to_string());
    let facts = [
        ("processor", machine.cpu.clone()),
        ("processors", format!("{} ({cores} physical cores)", machine.processors)),
        ("governor", machine.governor.clone()),
        ("memory", or_unknown(machine.memory_bytes, memory)),
        ("system", machine.system.clone()),
        (
            "load over 1, 5 and 15 minutes when the sweep began, earlier experiments included",
            machine.load_average.clone(),
        ),
        (
            "compiler",
            format!(
                "{}, profile {}, flags {}",
                machine.rustc,
                machine.profile,
                if machine.rustflags.is_empty() { "none" } else { &machine.rustflags }
            ),
        ),
        ("program", program.clone()),
        (
            "Pathmark's sources",
            format!("{}{}", machine.commit, if machine.dirty { " with uncommitted changes" } else { "" }),
        ),
        (
            "rows",
            format!("{} done, {} failed, {} left out", section.rows, section.failed.len(), section.left_out.count()),
        ),
    ];
    html! {
        @if !section.files.is_empty() {
            p.files {
            "Raw data: " @for (place, file) in section.files.iter().enumerate() { @if place > 0 { ", " } a href=(href(file)) { (file) } } "."
            }
            p.files id={ (section.anchor()) "-" (AGAIN) } {
                "To draw the figures again, in the folder of this page: " code.redraw { (shell::command(["report", "."])) } "."
                @if let Some(again) = &section.again {
                    " To measure again, in the folder where it was measured: " code.measure { (again.whole()) } "."
                }
            }
        }
        details open[false] {
            summary { "Command and machine" }
            pre { (command) }
            p { "Profile " (profile) "." }
            table { @for (name, value) in facts.into_iter().filter(|(_, value)| !value.is_empty()) { tr { th { (name) } td.text { (value) } } } }
        }
    }
}
