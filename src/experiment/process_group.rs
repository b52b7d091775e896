//! Process groups: a child leads a group that contains all processes it starts. The group is killed when the child has
//! ended, or when the child finds that its parent has ended.

use nix::errno::Errno;
use nix::sys::signal::{Signal, killpg};
use nix::sys::wait::{Id, WaitPidFlag, waitid};
use nix::unistd::{Pid, getpgrp, getpid};
use std::io::{self, Read, Write};
use std::os::unix::process::CommandExt;
use std::process::{Child, Command, Output, Stdio};
use std::thread;

/// Starts the command as the leader of a group, writes a line to its standard input, which stays open, and waits for
/// its end.
pub(super) fn answer(mut command: Command, line: &str) -> io::Result<Output> {
    let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = streams.process_group(0).spawn()?;
    let (out, err) = (child.stdout.take(), child.stderr.take());
    // Both streams are read concurrently: a full one would block the child.
    let said = thread::Builder::new().spawn(move || read(err));
    let heard = said.and_then(|said| {
        // If the child has died early, this write fails; its exit status tells more.
        child.stdin.as_mut().map_or(Ok(()), |stdin| writeln!(stdin, "{line}")).ok();
        let out = read(out)?;
        let err = said.join().unwrap_or_else(|_| Ok(Vec::new()))?;
        let ended = WaitPidFlag::WEXITED | WaitPidFlag::WNOWAIT;
        while waitid(Id::Pid(pid(&child)), ended) == Err(Errno::EINTR) {}
        Ok((out, err))
    });
    // Until the child has been waited for, its process id is not reused, so no other group can be killed.
    killpg(pid(&child), Signal::SIGKILL).ok();
    let status = child.wait()?;
    heard.map(|(stdout, stderr)| Output { status, stdout, stderr })
}

fn read(stream: Option<impl Read>) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream.map_or(Ok(0), |mut stream| stream.read_to_end(&mut bytes))?;
    Ok(bytes)
}

fn pid(child: &Child) -> Pid {
    Pid::from_raw(child.id().cast_signed())
}

/// Ends this process, and its group if it leads one.
pub(super) fn end_own_group() -> ! {
    if getpgrp() == getpid() {
        killpg(getpgrp(), Signal::SIGKILL).ok();
    }
    std::process::exit(3)
}
