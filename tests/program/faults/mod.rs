//! System faults: disks that are full at any write, kills at any instant, second processes on the same files. In every
//! case a file is the old one or the new one, and a resumed run gives the same result.

mod devices;
mod disk;
mod kills;
mod limits;
mod locks;
#[cfg(target_os = "linux")]
mod pins;
mod sweep;
mod threads;

/// Whether the tests run with their full counts.
pub(crate) fn is_thorough() -> bool {
    std::env::var_os("PATHMARK_THOROUGH").is_some()
}

/// Prints why a check was skipped.
fn skip(reason: &str) {
    println!("SKIPPED: {reason}");
}
