//! F12: devices that fail: no compiler, a compiler that refuses, a driver without memory, a device lost during a
//! render. The program gives the reason, with exit code 3 (2 if the compiler is missing). It keeps a checkpoint, from
//! which a processor resumes to the same image.

use super::skip;
use crate::program::{Finished, finish, pathmark};
use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::Command;

const RENDER: [&str; 10] =
    ["render", "cornell", "--size", "40x30", "--spp", "720", "--estimator", "bsdf", "--sampler", "hash"];

/// The OpenCL loader of this machine; `None` if it has none, or none that shows a device.
fn loader() -> Option<PathBuf> {
    let folder = tempfile::tempdir().unwrap();
    let listed = finish(pathmark(folder.path(), &["list", "devices"])).with_code(0);
    let folders = ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu", "/usr/lib64", "/usr/lib"];
    let mut files = folders.iter().map(|folder| Path::new(folder).join("libOpenCL.so.1"));
    files.find(|file| file.exists()).filter(|_| listed.out.contains("opencl:0"))
}

/// Compiles a library that takes the place of a driver's or the system's functions.
pub(super) fn make_library(folder: &Path, source: &str, name: &str) {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(source);
    let library = folder.join(name);
    if !library.exists() {
        let options = ["-shared", "-fPIC", "-o"];
        let made = Command::new("cc").args(options).arg(&library).arg(source).arg("-ldl").status().unwrap();
        assert!(made.success());
    }
}

/// Runs `pathmark ARGUMENTS` with a loader that fails on purpose.
fn with_failing_loader(folder: &Path, loader: &Path, failure: (&str, u64), arguments: &[&str]) -> Finished {
    make_library(folder, "failing-opencl.c", "libOpenCL.so.1");
    let mut command = pathmark(folder, arguments);
    command.env("LD_LIBRARY_PATH", folder).env("PATHMARK_TEST_OPENCL", loader).env(failure.0, failure.1.to_string());
    finish(command)
}

fn says(refused: &Finished, words: &[&str]) {
    assert!(words.iter().all(|word| refused.err.contains(word)), "{words:?} are not all in {}", refused.err);
}

fn checksum(finished: &Finished) -> String {
    let row: serde_json::Value = serde_json::from_str(&finished.out).unwrap();
    row["checksum"].as_str().unwrap().to_string()
}

#[test]
fn a_device_lost_in_the_middle_leaves_a_checkpoint_that_a_processor_goes_on_from() {
    let Some(loader) = loader() else { return skip("there is no OpenCL device") };
    let folder = tempfile::tempdir().unwrap();
    let whole = finish(pathmark(folder.path(), &[&RENDER[..], &["--json"]].concat())).with_code(0);
    let checkpoint = folder.path().join("lost.checkpoint");
    let on_device = ["--kernel", "device:opencl:0", "--decomposition", "bands:2", "--checkpoint", "lost.checkpoint"];
    let lost = [&RENDER[..], &on_device, &["-o", "lost.pfm"]].concat();
    // The first launches belong to the self-test. Each try loses the device later, until a checkpoint exists.
    for launches in 14.. {
        assert!(launches < 1000, "the render ends before the device is lost");
        let refused = with_failing_loader(folder.path(), &loader, ("PATHMARK_TEST_LAUNCHES", launches), &lost);
        says(&refused.with_code(3), &["opencl:0", "clEnqueueNDRangeKernel", "the device may be lost"]);
        assert!(!folder.path().join("lost.pfm").exists());
        if checkpoint.exists() {
            break;
        }
    }
    let resumed = ["--kernel", "lanes", "--checkpoint", "lost.checkpoint", "--json"];
    let resumed = finish(pathmark(folder.path(), &[&RENDER[..], &resumed].concat())).with_code(0);
    assert_eq!(checksum(&resumed), checksum(&whole));
}

/// Two devices and two workers make one image. Losing one device ends the program, unless the others left it no piece.
#[test]
fn two_devices_in_one_run_render_the_same_image_or_none() {
    let Some(loader) = loader() else { return skip("there is no OpenCL device") };
    let folder = tempfile::tempdir().unwrap();
    let whole = finish(pathmark(folder.path(), &[&RENDER[..], &["--json"]].concat())).with_code(0);
    let devices = ["--kernel", "lanes+device:host+device:opencl:0", "--decomposition", "tiles:4x4", "--threads", "2"];
    let together = [&RENDER[..], &devices, &["--json"]].concat();
    let image = finish(pathmark(folder.path(), &together)).with_code(0);
    assert_eq!(checksum(&image), checksum(&whole));
    let with_image = [&RENDER[..], &devices, &["--json", "-o", "lost.pfm"]].concat();
    let finished = with_failing_loader(folder.path(), &loader, ("PATHMARK_TEST_LAUNCHES", 14), &with_image);
    if finished.code == Some(0) {
        assert_eq!(checksum(&finished), checksum(&whole));
    } else {
        says(&finished.with_code(3), &["opencl:0", "clEnqueueNDRangeKernel", "the device may be lost"]);
        assert!(!folder.path().join("lost.pfm").exists());
    }
}

#[test]
fn a_device_without_memory_is_the_systems_fault() {
    let Some(loader) = loader() else { return skip("there is no OpenCL device") };
    let folder = tempfile::tempdir().unwrap();
    // Enough memory for the self-test, too little for a mesh.
    let mut arguments = [&RENDER[..], &["--kernel", "device:opencl:0", "-o", "none.pfm"]].concat();
    arguments[1] = "bumpy-ball";
    let refused = with_failing_loader(folder.path(), &loader, ("PATHMARK_TEST_BYTES", 200_000), &arguments);
    says(&refused.with_code(3), &["opencl:0", "clCreateBuffer", "no memory for an object on the device"]);
    assert!(!folder.path().join("none.pfm").exists());
}

/// A driver that may not reach its device is the system's fault; a missing driver counts as a missing device.
#[test]
fn a_driver_that_refuses_is_told() {
    let folder = tempfile::tempdir().unwrap();
    make_library(folder.path(), "refusing-cuda.c", "libcuda.so.1");
    let with = |kernel: &str| {
        let mut command = pathmark(folder.path(), &[&RENDER[..], &["--kernel", kernel, "-o", "none.pfm"]].concat());
        command.env("LD_LIBRARY_PATH", folder.path());
        finish(command)
    };
    for kernel in ["device:cuda:0", "lanes+device:cuda:0"] {
        says(&with(kernel).with_code(3), &["opening cuda:0", "cuInit", "OS call failed", "error 304"]);
    }
    assert!(!folder.path().join("none.pfm").exists());
    let mut listed = pathmark(folder.path(), &["list", "devices"]);
    listed.env("LD_LIBRARY_PATH", folder.path());
    let listed = finish(listed).with_code(0);
    assert!(listed.out.contains("none: cuInit: OS call failed"), "{}", listed.out);
}

/// A missing compiler counts as a missing device, which the user has named; a compiler that refuses the program is the
/// system's fault.
#[test]
fn a_compiler_that_fails_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let compiler = folder.path().join("compiler");
    let refuses = "#!/bin/sh\n[ \"$1\" = --version ] && echo 'a compiler 1.0' && exit 0\necho 'no room for libraries' >&2\nexit 1\n";
    fs::write(&compiler, refuses).unwrap();
    fs::set_permissions(&compiler, Permissions::from_mode(0o755)).unwrap();
    let arguments = [&RENDER[..], &["--kernel", "device", "--device", "host", "-o", "none.pfm"]].concat();
    let with = |compiler: &Path| {
        let mut command = pathmark(folder.path(), &arguments);
        command.env("CC", compiler);
        finish(command)
    };
    let refused = with(&compiler).with_code(3);
    says(&refused, &["rendering on host", "a compiler 1.0 refused the program", "no room for libraries"]);
    let missing = with(Path::new("no-such-compiler")).with_code(2);
    says(&missing, &["there is no device host here", "no-such-compiler"]);
    assert!(!folder.path().join("none.pfm").exists());
}
