//! The program as a user runs it, with a time limit: a hang is a failure like any other.

use std::ffi::OsStr;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Far above the time of any run on a loaded machine; only a hang reaches it.
const LIMIT: Duration = Duration::from_mins(10);

/// The output streams and the exit code of a run.
pub(crate) struct Finished {
    /// `None` if a signal ended it.
    pub(crate) code: Option<i32>,
    pub(crate) out: String,
    pub(crate) err: String,
}

/// A temporary folder in memory, if there is such a place: a sweep waits for a disk as long as it computes. It is no
/// place for programs, which may be too large for it, or may not be run there.
pub(crate) fn in_memory() -> TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).expect("a temporary folder")
}

/// `pathmark ARGUMENTS`, run in this folder and with an empty input.
pub(crate) fn pathmark(folder: &Path, arguments: &[impl AsRef<OsStr>]) -> Command {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("pathmark"));
    command.args(arguments).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Starts the command and waits for its end.
pub(crate) fn finish(mut command: Command) -> Finished {
    wait(command.spawn().expect("the program starts"))
}

/// Waits for the end of a program and collects its output from the piped streams.
pub(crate) fn wait(mut child: Child) -> Finished {
    let (out, err) = (reader(child.stdout.take()), reader(child.stderr.take()));
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child can be waited for") {
            break status;
        }
        if start.elapsed() > LIMIT {
            child.kill().expect("a child can be killed");
            child.wait().expect("a killed child ends");
            panic!("still running after {LIMIT:?}");
        }
        thread::sleep(Duration::from_millis(2));
    };
    let text = |reader: JoinHandle<String>| reader.join().expect("a stream is read");
    Finished { code: status.code(), out: text(out), err: text(err) }
}

/// Reads a pipe while the program runs; otherwise a long output would block it.
fn reader(stream: Option<impl Read + Send + 'static>) -> JoinHandle<String> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        if let Some(mut stream) = stream {
            stream.read_to_end(&mut bytes).expect("a pipe can be read");
        }
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

impl Finished {
    /// Asserts the exit code, and that nothing panicked.
    pub(crate) fn with_code(self, code: i32) -> Self {
        let Self { out, err, .. } = &self;
        assert_eq!(self.code, Some(code), "exit code\n--- stdout\n{out}\n--- stderr\n{err}");
        assert!(!err.contains("panicked"), "a panic\n--- stderr\n{err}");
        self
    }
}
