//! Device rows of a sweep: a GPU that is missing, and the times of a device that is there.

use crate::experiment::{TINY, write_tiny};
use crate::program::{finish, in_memory, pathmark};
use std::collections::BTreeMap;
use std::path::Path;

type Row = BTreeMap<String, String>;

/// Runs a sweep of serial rows with these kernels, where no GPU is visible, and returns its rows.
fn run(folder: &Path, kernels: &str) -> Vec<Row> {
    let text = TINY.replace("estimator = [\"smallpt\"]", &format!("estimator = [\"bsdf\"]\nkernel = [{kernels}]"));
    let text = text.replace("[\"speedup\", \"schedules\"]", "[\"kernels\"]");
    write_tiny(folder, &text.replace(", \"static-blocks\", \"work-stealing\"", ""));
    let mut command = pathmark(folder, &["run", "tiny.toml", "--out", "out"]);
    // These variables make the drivers show no device.
    command.env("OCL_ICD_VENDORS", folder.join("none")).env("CUDA_VISIBLE_DEVICES", "");
    finish(command).with_code(0);
    let mut reader = csv::Reader::from_path(folder.join("out/tiny/records.csv")).unwrap();
    reader.deserialize().map(Result::unwrap).collect()
}

/// A missing GPU is no failure: the other kernels are measured, the command succeeds, and the page reports the missing
/// GPU.
#[test]
fn a_gpu_that_is_not_there_is_a_row() {
    let folder = in_memory();
    let rows = run(folder.path(), "\"scalar\", \"lanes\", \"device\"");
    assert_eq!(rows.len(), 9);
    for row in rows {
        println!("{row:?}");
        let is_device = row["kernel"] == "device";
        assert_eq!(row["warnings"].contains("no-device"), is_device);
        assert_eq!((row["makespan_s"].is_empty(), row["checksum"].is_empty()), (is_device, is_device));
        assert_eq!(row["error"], "");
    }
    finish(pathmark(folder.path(), &["report", "out"])).with_code(0);
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("Left out: 3 rows.") && page.contains("neither CUDA nor OpenCL finds a GPU"), "{page}");
}

/// Compilation and copying are reported separately; both are part of the build time.
#[test]
fn rows_of_a_device_tell_how_long_it_took_to_compile_and_to_copy() {
    let folder = in_memory();
    let rows = run(folder.path(), "\"scalar\", \"device:host\"");
    assert_eq!(rows.len(), 6);
    for row in rows {
        println!("{row:?}");
        let seconds = |column: &str| row[column].parse::<f64>().ok();
        let parts = seconds("device_compile_s").zip(seconds("device_copy_s"));
        assert_eq!(parts.is_some(), row["kernel"] == "device:host");
        if let Some((compile_s, copy_s)) = parts {
            assert!(compile_s > 0.0 && copy_s >= 0.0 && compile_s + copy_s <= seconds("kernel_build_s").unwrap());
        }
    }
}
