//! `pathmark machine`: processors, cores, sockets, memory and caches of this machine, and what this process may use.

use crate::console::output::{print, print_json};
use crate::error::Result;
use crate::measure::Machine;
use clap::Args;

/// `pathmark machine --json`
#[derive(Args)]
pub(crate) struct Arguments {
    /// Print the object that `machine.toml` keeps
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let machine = Machine::look();
    if arguments.json {
        return print_json(&machine);
    }
    let memory = if machine.memory_bytes == 0 {
        "unknown".to_string()
    } else {
        format!("{:.1} GiB", machine.memory_bytes as f64 / f64::from(1 << 30))
    };
    let mut facts = vec![
        ("processor", machine.cpu),
        ("model", machine.cpu_model),
        ("system", machine.system),
        ("governor", machine.governor),
        ("memory", memory),
    ];
    facts.extend(machine.layout.facts());
    let width = facts.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    let lines: Vec<String> = facts.iter().map(|(name, value)| format!("{name:width$}  {value}")).collect();
    print(&lines.join("\n"))
}
