//! A watchdog for tests: aborts the whole test program, and names the test, if a test runs longer than anything but a
//! hang could. A thread that never answers cannot be ended alone, and a hang in a `drop` would stop the report of the
//! failed test.

use std::process;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Allowance for busy machines, which are so much slower than the machines for which the limits were chosen.
const SLACK: u32 = 10;

/// Watches a test until it is dropped.
pub(crate) struct Watchdog {
    tell: Sender<String>,
}

impl Watchdog {
    /// Watches the test of the calling thread. `limit` is far above its usual time: the watchdog checks whether the
    /// test ends, not how fast it is. A machine so busy that a test takes ten times the limit cannot be told from a
    /// hang.
    pub(crate) fn new(limit: Duration) -> Self {
        let test = thread::current().name().unwrap_or("a test without a name").to_owned();
        let (tell, told) = channel();
        thread::spawn(move || watch(&test, SLACK * limit, &told));
        Self { tell }
    }

    /// Names the next step, which has the whole limit for itself.
    pub(crate) fn now(&self, what: impl Into<String>) {
        self.tell.send(what.into()).expect("the watchdog lives as long as what it watches");
    }
}

fn watch(test: &str, limit: Duration, told: &Receiver<String>) {
    let (mut what, mut start) = (String::new(), Instant::now());
    loop {
        match told.recv_timeout(limit.saturating_sub(start.elapsed())) {
            Ok(next) => (what, start) = (next, Instant::now()),
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) => {
                eprintln!("WATCHDOG: {test} hangs: no end after {limit:?} {what}");
                process::abort();
            }
        }
    }
}
