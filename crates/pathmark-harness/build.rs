//! Tells the crate with which settings it was built.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = env::var("RUSTC").ok().and_then(|rustc| Command::new(rustc).arg("--version").output().ok());
    let version = rustc.filter(|output| output.status.success());
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_string());
    println!("cargo::rustc-env=PATHMARK_RUSTC={}", version.unwrap_or_else(|| "unknown".to_string()));
    println!("cargo::rustc-env=PATHMARK_PROFILE={}", env::var("PROFILE").unwrap_or_default());
    println!("cargo::rustc-env=PATHMARK_TARGET={}", env::var("TARGET").unwrap_or_default());
    let flags = env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default().replace('\x1f', " ");
    println!("cargo::rustc-env=PATHMARK_RUSTFLAGS={flags}");
}
