//! Remedies for the losses of a schedule: another value of one setting, the command that tries it, and the loss that
//! is to be expected with it.

use super::results::Results;
use super::rows::{Row, gathered};
use super::why::{Cell, Measured};
use crate::analysis::parallel_overhead::{Part, Run, decompose};
use crate::error::Result;
use crate::experiment::{Profile, read_calibration};
use crate::measure::{ImageKey, ScheduleKey, Setting};
use crate::shell;
use crate::simulate::{Contender, Hardware, Order, Overheads, contenders};
use crate::strategy::{Discipline, Workers};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// The loss that is to be expected with a remedy, as a share of workers × time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outlook {
    /// The folder has rows with this setting. `work` is their share of serial work.
    Measured { loss: f64, work: f64 },
    /// Simulated from the jobs of the serial run.
    Forecast { loss: f64 },
}

/// Other settings against a loss.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Remedy {
    /// The settings, as in `decomposition=tiles:8x8`.
    pub settings: Vec<String>,
    pub outlook: Option<Outlook>,
    /// The command that measures them.
    pub command: String,
}

impl fmt::Display for Remedy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { settings, outlook, command } = self;
        let settings = settings.join(" ");
        match outlook {
            Some(Outlook::Measured { loss, work }) => {
                let [loss, work] = [loss, work].map(|share| 100.0 * share);
                write!(
                    f,
                    "With `{settings}`, runs of this folder lose {loss:.1} % there; {work:.1} % is serial work. "
                )?;
            }
            Some(Outlook::Forecast { loss }) => {
                write!(f, "A simulation forecasts {:.1} % with `{settings}`. ", 100.0 * loss)?;
            }
            None => {}
        }
        write!(f, "Test the remedy: `{command}`")
    }
}

/// The schedules of a folder with their parts, where remedies are looked up.
pub(super) struct Remedies<'a> {
    results: &'a Results,
    measured: &'a [Measured<'a>],
    /// The serial runs of each image, without its seed, and pieces.
    serial: BTreeMap<(ImageKey, &'a str), Vec<&'a Row>>,
    /// Strategies with their costs of handing out jobs, if the folder has them.
    contenders: Vec<Contender>,
}

/// A setting's name and its new value.
type Change = (&'static str, String);

impl<'a> Remedies<'a> {
    pub(super) fn of(results: &'a Results, measured: &'a [Measured<'a>]) -> Result<Self> {
        let serial = results.rows().filter(|row| row.schedule.is_serial());
        let serial = gathered(serial.map(|row| ((row.image.without_seed(), row.decomposition.as_str()), row)));
        let calibration = results.folder.join("calibration.csv");
        let rows = if calibration.is_file() { read_calibration(&calibration)? } else { Vec::new() };
        let contenders = contenders(&results.definition.lab, &rows);
        Ok(Self { results, measured, serial, contenders })
    }

    /// A remedy for a loss of a schedule; `None` if no setting is known to help.
    pub(super) fn remedy(&self, cell: &Cell<'_>, part: Part) -> Result<Option<Remedy>> {
        let Some(changes) = self.changes(cell.first, part) else { return Ok(None) };
        let outlook = match self.measured(cell, part, &changes) {
            None if part == Part::Tail => self.forecast(cell.first, &changes)?,
            measured => measured,
        };
        let settings = changes.iter().map(|(name, value)| format!("{name}={value}")).collect();
        Ok(Some(Remedy { settings, outlook, command: self.command(cell.first, &changes) }))
    }

    /// The settings that act on a loss.
    fn changes(&self, row: &Row, part: Part) -> Option<Vec<Change>> {
        // Rules of processes are no strategies, so this function knows no remedy for them.
        let (entry, parameter) = self.results.definition.lab.strategy_named(&row.strategy).ok()?;
        let discipline = entry.discipline(parameter.as_deref()).ok()?;
        let strategy = |name: &str| (row.strategy != name).then(|| vec![("strategy", name.to_string())]);
        let pieces = |is_finer| Some(vec![("decomposition", resized(&row.decomposition, is_finer)?)]);
        let machine = &self.results.run.machine;
        match part {
            Part::Work => None,
            Part::Inflation | Part::Idle if row.threads > machine.processors => {
                let threads = ("threads", machine.processors.to_string());
                let has_own_number = entry.workers == Workers::PerJob;
                Some(
                    has_own_number
                        .then(|| ("strategy", "shared-counter".to_string()))
                        .into_iter()
                        .chain([threads])
                        .collect(),
                )
            }
            // Two workers on one core slow each other.
            Part::Inflation if (1..row.threads).contains(&machine.physical_cores) => {
                Some(vec![("threads", machine.physical_cores.to_string())])
            }
            // Workers that the system moves between cores lose their caches.
            Part::Inflation if Setting::named("pin").is_some() => Some(vec![("pin", "one-per-core".to_string())]),
            // Other programs need a processor, too.
            Part::Inflation | Part::Idle => Some(vec![("threads", (row.threads - 1).to_string())]),
            // A pool starts its threads before the run.
            Part::Starting => strategy("fixed-pool").or_else(|| Some(vec![("spp", (4 * row.spp).to_string())])),
            Part::Between => match discipline {
                Discipline::Chunks(_) | Discipline::Learned(_) if row.strategy != "guided" => strategy("guided"),
                _ => pieces(false),
            },
            Part::Tail => match discipline {
                Discipline::Dealt(_) => strategy("shared-counter"),
                _ => pieces(true),
            },
            Part::Merge if row.output != "locked" => Some(vec![("output", "locked".to_string())]),
            Part::Merge => pieces(false),
        }
    }

    /// The loss of the schedule with these changes, if it was measured for the same image.
    fn measured(&self, cell: &Cell<'_>, part: Part, changes: &[Change]) -> Option<Outlook> {
        let key = changed(&cell.first.schedule.key, changes)?;
        let is_peer = |other: &Cell<'_>| other.image() == cell.image() && other.first.schedule.key == key;
        let (_, parts) = self.measured.iter().find(|(other, _)| is_peer(other))?;
        let share = |part: Part| parts.iter().find(|(own, _)| *own == part).map(|(_, told)| told.value);
        Some(Outlook::Measured { loss: share(part)?, work: share(Part::Work)? })
    }

    /// The tail with these changes, simulated from the jobs of the serial run on the changed pieces.
    fn forecast(&self, row: &Row, changes: &[Change]) -> Result<Option<Outlook>> {
        let Some(key) = changed(&row.schedule.key, changes) else { return Ok(None) };
        let on_pieces = self.serial.get(&(row.image.without_seed(), key.decomposition.as_str()));
        let Some(typical) = on_pieces.and_then(|rows| Results::typical(rows)) else { return Ok(None) };
        let (Some(trace), Some(contender)) = (self.results.trace(typical)?, self.contender(&key.strategy)) else {
            return Ok(None);
        };
        Ok(tail(&contender, &trace.costs_s(), key.threads).map(|loss| Outlook::Forecast { loss }))
    }

    /// The strategy with its costs of handing out jobs; without costs if the folder has none.
    fn contender(&self, name: &str) -> Option<Contender> {
        if let Some(known) = self.contenders.iter().find(|contender| contender.name == name) {
            return Some(known.clone());
        }
        let (entry, parameter) = self.results.definition.lab.strategy_named(name).ok()?;
        let discipline = entry.discipline(parameter.as_deref()).ok()?;
        let (name, overheads) = (name.to_string(), Overheads::default());
        Some(Contender { name, discipline, order: Order::ByIndex, overheads, calibrations: Vec::new() })
    }

    /// The command that measures the changed schedule beside its serial run.
    fn command(&self, row: &Row, changes: &[Change]) -> String {
        let (run, definition) = (&self.results.run, &self.results.definition);
        let asked = if run.experiment.is_empty() { &definition.name } else { &run.experiment };
        // A path that begins with a hyphen would be read as an option.
        let asked = if asked.starts_with('-') { format!("./{asked}") } else { asked.clone() };
        let profile = Profile::from_name(&run.profile).unwrap_or(Profile::Quick);
        let value = |name: &str, own: String| changes.iter().find(|(of, _)| *of == name).map_or(own, |of| of.1.clone());
        let own = [
            ("strategy", row.strategy.clone()),
            ("threads", row.threads.to_string()),
            ("decomposition", row.decomposition.clone()),
        ];
        let schedule = own.map(|(name, own)| (name, value(name, own)));
        let others = changes.iter().filter(|(name, _)| !schedule.iter().any(|(own, _)| own == name)).cloned();
        let tried: Vec<Change> = schedule.iter().cloned().chain(others).collect();
        // Rows are never overwritten, so each remedy has a folder of its own.
        let words = tried.iter().map(|(_, value)| value.replace(|c: char| !c.is_ascii_alphanumeric(), "-"));
        let out = format!("remedy/{}", words.collect::<Vec<_>>().join("-"));
        let is_kept = |pair: &&String| !tried.iter().any(|(name, _)| pair.split('=').next() == Some(name));
        let serial =
            |(name, value): &Change| if *name == "strategy" { format!("serial,{value}") } else { value.clone() };
        let values = tried.iter().map(|own| format!("{}={}", own.0, serial(own)));
        let values = run.set.iter().filter(is_kept).cloned().chain(values);
        let values = values.flat_map(|pair| ["--set".to_string(), pair]);
        let words = ["run".to_string(), asked, format!("--{}", profile.name())].into_iter().chain(values);
        shell::command(words.chain(["--out".to_string(), out]))
    }
}

/// The key of a schedule with these changes; `None` if they change its image or a property without a column of its own.
fn changed(key: &ScheduleKey, changes: &[Change]) -> Option<ScheduleKey> {
    let mut key = key.clone();
    for (name, value) in changes {
        match *name {
            "strategy" => key.strategy.clone_from(value),
            "threads" => key.threads = value.parse().ok()?,
            "decomposition" => key.decomposition.clone_from(value),
            "output" => key.output.clone_from(value),
            _ => return None,
        }
    }
    Some(key)
}

/// The share of a simulated tail.
fn tail(contender: &Contender, costs: &[f64], workers: usize) -> Option<f64> {
    let replayed = contender.replay(costs, workers, &Hardware::default());
    let balance = replayed.trace.balance(replayed.makespan_s, workers)?;
    let (busy_s, makespan_s) = (balance.busy_s(), replayed.makespan_s);
    let gap_s = balance.gap_s();
    let run = Run { workers, processors: workers, makespan_s, busy_s, gap_s, ..Run::default() };
    decompose(&run, busy_s)?.share(Part::Tail)
}

/// A decomposition with about a quarter or four times of the pixels in each piece; `None` if there is none.
fn resized(decomposition: &str, is_finer: bool) -> Option<String> {
    let (name, parameter) = decomposition.split_once(':').unwrap_or((decomposition, ""));
    let side = |text: &str| {
        Some(if is_finer { (text.parse::<u32>().ok()? / 2).max(1) } else { text.parse::<u32>().ok()? * 2 })
    };
    let tile = |text: &str| {
        let (width, height) = text.split_once('x')?;
        let tile = format!("{}x{}", side(width)?, side(height)?);
        (tile != text).then_some(tile)
    };
    match name {
        "rows" => Some(if is_finer { "tiles:8x8" } else { "tiles:64x64" }.to_string()),
        "bands" | "grid" => {
            let count = parameter.parse::<u32>().ok()?;
            let count = if is_finer { 4 * count } else { count / 4 };
            (count > 0).then(|| format!("{name}:{count}"))
        }
        "tiles" => {
            let (size, order) = parameter
                .split_once(':')
                .map_or((parameter, String::new()), |(size, order)| (size, format!(":{order}")));
            Some(format!("tiles:{}{order}", tile(size)?))
        }
        "samples" => {
            let (block, size) = parameter.split_once(':')?;
            Some(format!("samples:{block}:{}", tile(size)?))
        }
        _ => None,
    }
}
