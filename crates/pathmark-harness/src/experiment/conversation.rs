//! Conversations with a child process: it answers lines with lines until it is told no more. Runs that are compared side by
//! side need such children, because starting a process between two runs would take longer than a run.

use super::process_group::{killed, pid, wait_for_end};
use std::io::{self, BufRead, BufReader, Read, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Most bytes of an answer, far above any: an endless line must not fill the memory.
const MOST_BYTES: u64 = 64 << 20;

/// A child that leads a process group; dropping it kills the group.
pub(super) struct Conversation {
    /// `None` once it has ended.
    child: Option<Child>,
    input: Option<ChildStdin>,
    answers: Receiver<String>,
    errors: Option<JoinHandle<String>>,
}

/// The outcome of a line for a child.
pub(super) enum Answer {
    Line(String),
    /// It ended without an answer; with what it wrote to its standard error.
    Ended(ExitStatus, String),
    /// It did not answer in time.
    Late,
}

impl Conversation {
    pub(super) fn begin(mut command: Command) -> io::Result<Self> {
        let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = streams.process_group(0).spawn()?;
        let (tell, answers) = channel();
        let output = child.stdout.take();
        let listen = move || {
            let Some(output) = output else { return };
            let mut lines = BufReader::new(output);
            let mut line = String::new();
            while lines.by_ref().take(MOST_BYTES).read_line(&mut line).is_ok_and(|length| length > 0) {
                if tell.send(std::mem::take(&mut line)).is_err() {
                    break;
                }
            }
        };
        let errors = child.stderr.take();
        let hear = move || {
            let mut text = Vec::new();
            errors.map(|errors| errors.take(MOST_BYTES).read_to_end(&mut text));
            String::from_utf8_lossy(&text).trim().to_string()
        };
        let input = child.stdin.take();
        let mut own = Self { child: Some(child), input, answers, errors: None };
        thread::Builder::new().spawn(listen)?;
        own.errors = Some(thread::Builder::new().spawn(hear)?);
        Ok(own)
    }

    /// Sends a line, and waits for the answer for no longer than the limit.
    pub(super) fn ask(&mut self, line: &str, limit: Option<Duration>) -> io::Result<Answer> {
        // If the child has ended, this write fails; its exit status tells more.
        self.input.as_mut().map_or(Ok(()), |input| writeln!(input, "{line}")).ok();
        let answer = match limit {
            Some(limit) => self.answers.recv_timeout(limit),
            None => self.answers.recv().map_err(RecvTimeoutError::from),
        };
        match answer {
            Ok(line) => Ok(Answer::Line(line)),
            Err(RecvTimeoutError::Timeout) => Ok(Answer::Late),
            Err(RecvTimeoutError::Disconnected) => {
                let Some(child) = self.child.take() else { return Err(io::Error::other("it has ended before")) };
                wait_for_end(pid(&child))?;
                let status = killed(child)?;
                let said = self.errors.take().and_then(|errors| errors.join().ok()).unwrap_or_default();
                Ok(Answer::Ended(status, said))
            }
        }
    }
}

impl Drop for Conversation {
    fn drop(&mut self) {
        self.child.take().map(killed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shell(script: &str) -> Conversation {
        let mut command = Command::new("/bin/sh");
        command.args(["-c", script]);
        Conversation::begin(command).unwrap()
    }

    #[test]
    fn a_child_answers_lines_until_it_ends() {
        let mut child = shell("read a; echo 1 $a; read b; echo 2 $b; echo why >&2; exit 7");
        for (line, expected) in [("x", "1 x\n"), ("y", "2 y\n")] {
            assert!(matches!(child.ask(line, None).unwrap(), Answer::Line(answer) if answer == expected));
        }
        let Answer::Ended(status, said) = child.ask("z", None).unwrap() else { panic!("it has ended") };
        assert_eq!((status.code(), said.as_str()), (Some(7), "why"));
    }

    #[test]
    fn a_child_without_an_answer_is_late() {
        let mut child = shell("read a; sleep 600");
        assert!(matches!(child.ask("x", Some(Duration::from_millis(20))).unwrap(), Answer::Late));
    }
}
