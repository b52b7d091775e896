//! What the system does to files: disks that are full at any write, kills at any instant, second processes on the same files. Whatever
//! happens, a file is the old one or the new one, and what goes on from it comes to the same end.

mod devices;
mod disk;
mod kills;
mod limits;
mod locks;
mod sweep;
mod threads;

/// Whether the full counts are asked for.
pub(crate) fn is_thorough() -> bool {
    std::env::var_os("PATHMARK_THOROUGH").is_some()
}

/// Says on the test's output why something was not tried.
fn skip(reason: &str) {
    println!("SKIPPED: {reason}");
}
