//! A check on a thread of its own, watched from outside: a run that never ends must not take the author's tests with it.

use std::sync::Arc;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;

use super::case::{Case, Check};
use crate::library::message;

/// How a check went.
pub(super) enum Outcome {
    Kept,
    Broken(String),
    Hangs(String),
}

/// Runs `check`. As long as something happens, it is given time; the thread of one that hangs is left behind.
pub(super) fn run(case: &Arc<Case>, check: Check) -> Outcome {
    let (tell, told) = channel();
    let theirs = Arc::clone(case);
    // A meeting of jobs may take all the patience that there is.
    let patience = 2 * case.contract.patience;
    let checker = thread::spawn(move || {
        let verdict = check(&theirs);
        // It is listened for until it hangs, and then nobody cares.
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
                    "nothing has happened for {patience:?} (on a machine where that is no proof, ask with more patience); nothing else was tried"
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
