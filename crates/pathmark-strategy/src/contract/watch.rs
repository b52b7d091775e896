//! A check on its own thread, watched from outside: a run that never ends must not block the author's other tests.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;

use super::case::{Case, Check};
use crate::library::message;

/// The outcome of a check.
pub(super) enum Outcome {
    Kept,
    Broken(String),
    Hangs(String),
}

/// Runs `check` for as long as it makes progress. The thread of a check that hangs is left behind.
pub(super) fn run(case: &Arc<Case>, check: Check) -> Outcome {
    let (tell, told) = channel();
    let theirs = Arc::clone(case);
    // A meeting of jobs may use up the whole patience.
    let patience = 2 * case.contract.patience;
    let checker = thread::spawn(move || {
        let verdict = check(&theirs);
        // If the check counted as hanging, nobody receives its verdict, and nobody needs it.
        let _ = tell.send(verdict);
    });
    loop {
        let before = case.pulse();
        match told.recv_timeout(patience) {
            Ok(Ok(())) => return Outcome::Kept,
            Ok(Err(found)) => return Outcome::Broken(found),
            Err(RecvTimeoutError::Timeout) if case.pulse() != before => {}
            Err(RecvTimeoutError::Timeout) => {
                return Outcome::Hangs(format!(
                    "no progress for {patience:?} (on a slow machine, set a longer patience); the remaining checks were skipped"
                ));
            }
            Err(RecvTimeoutError::Disconnected) => {
                let message =
                    checker.join().err().map_or_else(|| "no message".to_owned(), |payload| message(&*payload));
                return Outcome::Broken(format!("the strategy itself panicked: {message}"));
            }
        }
    }
}
