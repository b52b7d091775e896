//! Progress of long work: a bar with the time left on a terminal, plain lines elsewhere, nothing with `--quiet`.

use super::output::safe;
use crate::error::Error;
use crate::experiment::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Bars whose time left follows from their pace, or comes from the work itself.
const BY_PACE: &str = "{msg:<40!} {wide_bar} {percent:>3} %  {elapsed}, {eta} left";
const BY_WORK: &str = "{msg:<40!} {wide_bar} {percent:>3} %  {elapsed}, {prefix} left";

/// A bar for work without a known end.
const BUSY: &str = "{spinner} {msg}  {elapsed}";
const TICK: Duration = Duration::from_millis(100);

/// The messages of the program on standard error.
pub(crate) struct Console {
    quiet: bool,
    terminal: bool,
    work: Mutex<Work>,
}

#[derive(Default)]
struct Work {
    title: String,
    total: u64,
    bar: Option<ProgressBar>,
    /// Tenths that have been reported.
    told: u64,
}

impl Console {
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, terminal: std::io::stderr().is_terminal(), work: Mutex::new(Work::default()) }
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn line(text: &str) {
        // Standard error may be closed; that is no reason to stop.
        let _ = writeln!(std::io::stderr().lock(), "{}", safe(text));
    }

    /// Prints the error with which the program ends.
    pub(crate) fn error(&self, error: &Error) {
        self.end();
        Self::line(&format!("pathmark: {error}"));
    }
}

impl Console {
    /// Runs work of unknown length; a terminal shows its title and the elapsed time meanwhile.
    pub(crate) fn busy<T>(&self, title: &str, work: impl FnOnce() -> T) -> T {
        if self.quiet || !self.terminal {
            return work();
        }
        let style = ProgressStyle::with_template(BUSY).unwrap_or_else(|_| ProgressStyle::default_spinner());
        let bar = ProgressBar::new_spinner().with_message(safe(title)).with_style(style);
        bar.enable_steady_tick(TICK);
        let done = work();
        bar.finish_and_clear();
        done
    }

    fn start(&self, title: &str, total: u64, template: &str) {
        if self.quiet {
            return;
        }
        let bar = self.terminal.then(|| {
            let style = ProgressStyle::with_template(template);
            let bar = ProgressBar::new(total);
            bar.with_message(safe(title)).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
        });
        if bar.is_none() {
            Self::line(&format!("{title} ..."));
        }
        *self.work() = Work { title: title.to_string(), total, bar, told: 0 };
    }

    /// Begins work that consists of steps and gives the time left itself.
    pub(crate) fn begin_steps(&self, title: &str, total: u64) {
        self.start(title, total, BY_WORK);
    }

    /// Begins a step: the bar shows its title; without a bar, a line shows title and time left.
    pub(crate) fn step(&self, title: &str, left: &str) {
        if self.quiet {
            return;
        }
        match &self.work().bar {
            Some(bar) => bar.set_message(safe(title)),
            None => Self::line(&format!("{title} ..., {left} left in all")),
        }
    }

    /// Shows the time left in the bar.
    pub(crate) fn left(&self, left: &str) {
        if let Some(bar) = &self.work().bar {
            bar.set_prefix(left.to_string());
        }
    }
}

impl Progress for Console {
    fn begin(&self, title: &str, total: u64) {
        self.start(title, total, BY_PACE);
    }

    fn advance(&self, done: u64) {
        let mut work = self.work();
        if let Some(bar) = &work.bar {
            bar.set_position(done);
            return;
        }
        let tenths = (done * 10).checked_div(work.total).unwrap_or(0).min(10);
        if tenths > work.told && !self.quiet {
            work.told = tenths;
            Self::line(&format!("{} {tenths}0 %", work.title));
        }
    }

    fn note(&self, text: &str) {
        if self.quiet {
            return;
        }
        match &self.work().bar {
            Some(bar) => bar.println(safe(text)),
            None => Self::line(text),
        }
    }

    fn end(&self) {
        if let Some(bar) = self.work().bar.take() {
            bar.finish_and_clear();
        }
    }
}
