//! The program `pathmark` as a user runs it: one test program for all verbs.

mod again;
mod artifact;
mod bursts;
mod changed_inputs;
mod claims;
mod command_line;
mod commands;
mod device_rows;
mod diff;
mod equal_time;
#[path = "../support/experiment.rs"]
mod experiment;
mod external;
mod faults;
mod inspection;
// It finds the processes of a launcher in /proc.
#[cfg(target_os = "linux")]
mod killed_ranks;
mod ledgers;
mod lost_cells;
mod merged_sweeps;
mod page;
mod pairs;
mod plan;
mod price;
#[path = "../support/program.rs"]
mod program;
mod published;
mod rank;
mod ranks;
mod replicate;
mod resume;
#[path = "../support/scene_text.rs"]
mod scene_text;
mod shared_seeds;
#[path = "../support/snapshot.rs"]
mod snapshot;
mod time_limits;
mod until;
mod verdicts;
#[path = "../support/watchdog.rs"]
mod watchdog;
mod why;
mod with_values;
