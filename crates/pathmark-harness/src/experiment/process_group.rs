//! Process groups: a child leads a group that contains all processes it starts. The group is killed when the child has
//! ended or has reached its time limit, or when the child finds that its parent has ended.

#![expect(unsafe_code, reason = "waitid belongs to the C library; nix does not offer it on macOS")]

use nix::sys::signal::{Signal, killpg};
use nix::unistd::{Pid, getpgrp, getpid};
use std::io::{self, ErrorKind, Read, Write};
use std::mem::MaybeUninit;
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Most bytes of a stream that are kept, far above any answer: an endless stream must not fill the memory.
const MOST_BYTES: u64 = 64 << 20;

/// Starts the command as the leader of a group, writes a line to its standard input, which stays open, and waits for
/// its end. `Ok(None)` if it was killed because it ran longer than `limit`.
pub(super) fn answer(mut command: Command, line: &str, limit: Option<Duration>) -> io::Result<Option<Output>> {
    let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = streams.process_group(0).spawn()?;
    let (own, line) = (pid(&child), line.to_string());
    let (mut input, output, errors) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
    let heard = move || -> io::Result<[Vec<u8>; 2]> {
        // Both streams are read concurrently: a full one would block the child.
        let said = thread::Builder::new().spawn(move || read(errors))?;
        // If the child has died early, this write fails; its exit status tells more.
        input.as_mut().map_or(Ok(()), |input| writeln!(input, "{line}")).ok();
        let output = read(output)?;
        let errors = said.join().unwrap_or_else(|_| Ok(Vec::new()))?;
        wait_for_end(own)?;
        Ok([output, errors])
    };
    let (tell, told) = channel();
    // Another thread hears the child, so that this one can wait for no longer than the limit. It ends with the streams,
    // which processes outside the group may still hold.
    let listener = thread::Builder::new().spawn(move || _ = tell.send(heard()));
    let wait = || limit.map_or_else(|| told.recv().map_err(Into::into), |limit| told.recv_timeout(limit));
    let heard = listener.and_then(|_| match wait() {
        Ok(heard) => heard.map(Some),
        Err(RecvTimeoutError::Timeout) => Ok(None),
        Err(RecvTimeoutError::Disconnected) => Err(io::Error::other("the thread that listens to it has ended")),
    });
    let status = killed(child)?;
    Ok(heard?.map(|[stdout, stderr]| Output { status, stdout, stderr }))
}

/// Kills the group of a child and waits for the child.
pub(super) fn killed(mut child: Child) -> io::Result<ExitStatus> {
    // Until the child has been waited for, its process id is not reused, so no other group can be killed.
    killpg(pid(&child), Signal::SIGKILL).ok();
    child.wait()
}

fn read(stream: Option<impl Read>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if let Some(mut stream) = stream {
        stream.by_ref().take(MOST_BYTES).read_to_end(&mut bytes)?;
        io::copy(&mut stream, &mut io::sink())?;
    }
    Ok(bytes)
}

/// Waits until the child has ended, and leaves its exit status to a later wait.
pub(super) fn wait_for_end(child: Pid) -> io::Result<()> {
    loop {
        let mut about = MaybeUninit::<libc::siginfo_t>::uninit();
        // SAFETY: `about` has room for what the call writes, and nothing reads it.
        let failed = unsafe {
            let options = libc::WEXITED | libc::WNOWAIT;
            libc::waitid(libc::P_PID, child.as_raw().cast_unsigned(), about.as_mut_ptr(), options) != 0
        };
        match io::Error::last_os_error() {
            _ if !failed => return Ok(()),
            error if error.kind() == ErrorKind::Interrupted => {}
            error => return Err(error),
        }
    }
}

pub(super) fn pid(child: &Child) -> Pid {
    Pid::from_raw(child.id().cast_signed())
}

/// Ends this process, and its group if it leads one.
pub(super) fn end_own_group() -> ! {
    if getpgrp() == getpid() {
        killpg(getpgrp(), Signal::SIGKILL).ok();
    }
    std::process::exit(3)
}
