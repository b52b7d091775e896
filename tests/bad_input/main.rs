//! Wrong input is refused with a helpful message: the field, the value, its place, the allowed values. The exit code
//! says who must act (2 the user, 3 the system), nothing panics or hangs, and no file is added, removed or changed.

mod arguments;
mod bases;
mod before_work;
mod damaged;
#[path = "../support/experiment.rs"]
mod experiment;
mod experiments;
mod meshes;
mod outputs;
mod paths;
#[path = "../support/program.rs"]
mod program;
mod same_file;
mod scenes;
#[path = "../support/snapshot.rs"]
mod snapshot;
mod traces;

use nix::sys::resource::{UsageWho, getrusage};
use program::{finish, pathmark};
use snapshot::{assert_untouched, snapshot};
use std::ffi::OsStr;
use std::path::Path;

/// Limit of the peak memory of all refusals so far: a refusal must be cheap.
const MOST_MEMORY_KIB: i64 = 256 << 10;

/// Runs a command that must be refused and returns its message. `folder` is its working directory, which must not
/// change.
fn refused(folder: &Path, arguments: &[impl AsRef<OsStr>], code: i32, said: &[&str]) -> String {
    let before = snapshot(folder);
    let finished = finish(pathmark(folder, arguments)).with_code(code);
    for text in said {
        assert!(finished.err.contains(text), "the message does not say {text:?}:\n{}", finished.err);
    }
    assert_eq!(finished.out, "", "a refusal belongs on stderr");
    assert_untouched(&before, &snapshot(folder));
    let peak_kib = getrusage(UsageWho::RUSAGE_CHILDREN).expect("a count of resources").max_rss();
    assert!(peak_kib < MOST_MEMORY_KIB, "a refusal took {peak_kib} KiB");
    finished.err
}

/// Line and column that a message gives for a file.
fn place(message: &str, file: &str) -> Option<(usize, usize)> {
    let rest = message.split_once(&format!("{file}:"))?.1;
    let mut numbers = rest.split(':').map_while(|text| text.parse().ok());
    numbers.next().zip(numbers.next())
}

/// The line, from 1, on which `part` first occurs.
fn line_of(text: &str, part: &str) -> usize {
    let at = text.find(part).unwrap_or_else(|| panic!("{part:?} is not in the text"));
    text[..at].matches('\n').count() + 1
}
