//! Wrong options on the command line.

use super::refused;
use crate::program::in_memory;

/// Wrong options of `render cornell`, and the words that the message must contain: field, value, allowed values.
const WRONG: &[(&[&str], &[&str])] = &[
    (&["--strategy", "stealth"], &["strategy", "stealth", "work-stealing", "thread-per-row"]),
    #[cfg(not(feature = "more-pools"))]
    (
        &["--strategy", "orx-parallel"],
        &["strategy = orx-parallel", "is missing from this build", "--features more-pools"],
    ),
    (&["--strategy", "dynamic:0"], &["strategy", "dynamic:0", "from 1"]),
    (&["--strategy", "rayon:3"], &["strategy", "rayon:3", "none"]),
    (&["--strategy", "steal-half:poorest"], &["strategy", "steal-half:poorest", "richest"]),
    (&["--strategy", "wrok-stealing"], &["strategy", "wrok-stealing", "did you mean work-stealing?"]),
    (&["--estimator", "bdsf"], &["did you mean bsdf?"]),
    (&["--output", "pigeon"], &["output", "pigeon", "slots"]),
    (&["--strategy", ""], &["strategy", "work-stealing"]),
    (&["--pin", "everywhere"], &["pin", "everywhere", "one-per-core", "0-3,8"]),
    (&["--pin", ""], &["pin", "compact"]),
    (&["--pin", "3-1"], &["pin", "3-1", "scatter"]),
    // Other systems list no processors.
    #[cfg(target_os = "linux")]
    (&["--pin", "60000"], &["pin", "60000", "may not run on processor 60000"]),
    #[cfg(target_os = "linux")]
    (&["--pin", "compact", "--threads", "9999"], &["pin", "compact", "of 9999 workers", "up to"]),
    (&["--counters=perhaps"], &["--counters", "perhaps"]),
    (&["--decomposition", "hexagons"], &["decomposition", "hexagons", "tiles:32x32"]),
    (&["--decomposition", "tiles:0x8"], &["decomposition", "tiles:0x8", "at least 1"]),
    (&["--decomposition", "tiles:8x8:zigzag"], &["decomposition", "zigzag", "hilbert"]),
    (&["--decomposition", "bands:-1"], &["decomposition", "bands:-1"]),
    (&["--decomposition", "grid:99999999999999999999"], &["decomposition", "grid:9999", "grid:16"]),
    (&["--estimator", "magic"], &["estimator", "magic", "smallpt", "bsdf"]),
    (&["--sampler", "dice"], &["sampler", "dice", "independent"]),
    (&["--kernel", "quantum"], &["kernel", "quantum", "scalar"]),
    (&["--kernel", "device:abacus:0"], &["kernel", "device:abacus:0", "there is no device abacus:0 here"]),
    (&["--kernel", "lanes+scalar"], &["kernel", "scalar", "is not a device", "device:ID"]),
    (&["--kernel", "lanes", "--device", "host"], &["--device host", "--kernel is lanes"]),
    (&["--kernel", "scalar", "--precision", "f32"], &["precision", "f32", "scalar kernel", "f64"]),
    (&["--kernel", "device:host", "--simd", "avx2"], &["simd", "avx2", "a device has none"]),
    (&["--effects", "smoke"], &["effects", "smoke", "diffuse", "all"]),
    (&["--accelerator", "octree"], &["accelerator", "octree", "median", "sah"]),
    (&["--max-depth", "70000"], &["--max-depth", "70000"]),
    // An existing profile, but too small for glass and a mirror.
    (&["--effects", "diffuse"], &["effects", "diffuse", "all"]),
    (&["--spp", "0"], &["spp", "0", "1 to"]),
    (&["--spp", "6"], &["spp", "6", "multiple of 4", "4 or 8"]),
    (&["--spp", "99999999999"], &["spp", "99999999999"]),
    (&["--spp", "4294967292"], &["spp", "4294967292", "1 to"]),
    (&["--spp=-4"], &["spp", "-4"]),
    (&["--spp", "1e3"], &["spp", "1e3"]),
    (&["--size", "0x0"], &["size", "0x0", "1x1 to"]),
    (&["--size", "0x5"], &["size", "0x5", "1x1 to"]),
    (&["--size", "1000000000x1000000000"], &["size", "1000000000x1000000000", "1x1 to"]),
    (&["--size", "65536x65536"], &["size", "65536x65536", "pixels"]),
    (&["--size", "99999999999x1"], &["size", "99999999999x1", "WxH"]),
    (&["--size=-1x5"], &["size", "-1x5", "WxH"]),
    (&["--size", "abc"], &["size", "abc", "WxH"]),
    (&["--size", "8x8x8"], &["size", "8x8x8", "WxH"]),
    (&["--size", ""], &["size", "WxH"]),
    (&["--threads", "0"], &["threads", "0", "1 to"]),
    (&["--threads", "1000000"], &["threads", "1000000", "1 to"]),
    (&["--threads=-1"], &["threads", "-1"]),
    (&["--threads", "18446744073709551616"], &["threads", "18446744073709551616"]),
    (&["--seed", "9223372036854775808"], &["seed", "9223372036854775808", "0 to 9223372036854775807"]),
    (&["--seed", "18446744073709551616"], &["seed", "18446744073709551616"]),
    (&["--estimator", "whitted", "--max-depth", "33"], &["max-depth", "33", "whitted", "0 to 32"]),
    (&["--camera-rays", "0"], &["camera-rays", "0", "1 to 65535"]),
    (&["--camera-rays", "65536"], &["camera-rays", "65536"]),
    (&["--estimator", "whitted", "--camera-rays", "2"], &["camera-rays", "2", "whitted"]),
    (&["--estimator", "bsdf", "--clamp", "recursion", "--camera-rays", "2"], &["camera-rays", "2", "recursion"]),
    (&["--roulette", "luck:3"], &["roulette", "luck:3", "throughput:N"]),
    (&["--estimator", "whitted", "--roulette", "albedo:5"], &["roulette", "albedo:5", "whitted"]),
    (&["--roulette", "constant:1.5"], &["roulette", "constant:1.5", "0 < P < 1"]),
    (&["--clamp", "recursion"], &["recursion", "smallpt", "bsdf, nee, mis"]),
    (&["--clamp", "pixel"], &["clamp", "pixel", "subpixel or recursion"]),
    (&["--clamp", "subpixel:0"], &["clamp", "subpixel:0", "above 0"]),
    (&["--filter", "gauss"], &["filter", "gauss", "tent, box, center"]),
    (&["--epsilon=-1e-4"], &["epsilon", "-1e-4", "at least 0"]),
    (&["--epsilon", "-1"], &["epsilon", "-1", "at least 0"]),
    (&["--spp", "-4"], &["spp", "-4"]),
    (&["--seed", "-1"], &["seed", "-1"]),
    (&["--time-limit", "soon"], &["--time-limit", "soon", "2min"]),
    (&["--epsilon", "small"], &["epsilon", "small", "at least 0"]),
    // An existing profile that covers the scene, but not with this sampler.
    (&["--sampler", "sobol", "--effects", "surfaces"], &["effects", "surfaces", "sobol", "smallpt"]),
    (&["--max-depth", "65536"], &["max-depth", "65536"]),
    (&["--max-depth=-1"], &["max-depth", "-1"]),
    (&["--colour", "red"], &["--colour"]),
    // 2^42 jobs would fill any memory.
    (
        &["--size", "2048x2048", "--spp", "16777216", "--decomposition", "samples:16:1x1"],
        &["decomposition", "samples:16:1x1", "4398046511104 jobs of 440 bytes", "at most 39045157", "larger tiles"],
    ),
    (
        &["--size", "2048x2048", "--spp", "16777216", "--decomposition", "samples:16:1x1", "--shard", "1/2"],
        &["decomposition", "4398046511104 jobs"],
    ),
    (
        &["--size", "64x64", "--spp", "16777216", "--decomposition", "samples:16:1x1", "--adaptive"],
        &["decomposition", "4294967296 jobs"],
    ),
    // Few jobs, but each with a buffer for many pixels.
    (
        &["--size", "8192x8192", "--spp", "1024", "--decomposition", "samples:16:8192x8192"],
        &["decomposition", "64 jobs", "at most 4 such jobs"],
    ),
    // A thread for each of 90 000 jobs would end the process on many systems.
    (
        &["--size", "300x300", "--strategy", "thread-per-job", "--decomposition", "tiles:1x1"],
        &["decomposition", "tiles:1x1", "90000 jobs", "at most 16384"],
    ),
    (
        &["--strategy", "thread-per-row", "--decomposition", "tiles:8x8"],
        &["decomposition", "tiles:8x8", "thread-per-row"],
    ),
];

#[test]
fn each_wrong_option_of_render_is_refused() {
    let folder = in_memory();
    for (options, said) in WRONG {
        println!("{options:?}");
        let small = ["render", "cornell", "-o", "image.png"];
        refused(folder.path(), &[small.as_slice(), options].concat(), 2, said);
    }
}

#[test]
fn names_that_there_are_not_are_answered_with_those_that_there_are() {
    let folder = in_memory();
    let cases: &[(&[&str], &[&str])] = &[
        (&["render", "bathroom"], &["scene", "bathroom", "cornell", ".toml"]),
        (&["image", "reference", "bathroom", "--spp", "4"], &["scene", "bathroom", "cornell"]),
        (&["image", "reference", "cornell", "--spp", "0"], &["spp", "0", "1 to"]),
        (&["image", "reference", "cornell", "--spp", "4", "--size", "0x5"], &["size", "0x5"]),
        (&["image", "reference", "cornell", "--spp", "4", "--estimator", "magic"], &["estimator", "magic", "bsdf"]),
        (&["run", "cold-fusion"], &["experiment", "cold-fusion", "thread-scaling", ".toml"]),
        (&["run", "thread-scaling", "--repetitions", "0"], &["repetitions", "0"]),
        (&["run", "thread-scaling", "--repetitions", "4294967295"], &["repetitions", "4294967295", "10000"]),
        (&["run", "thread-scaling", "--timeout", "10"], &["timeout = 10", "10min, or none"]),
        (&["reproduce", "--timeout", "-1s"], &["timeout = -1s", "above 0"]),
        (&["run", "thread-scaling", "--filter", "no-such-cell"], &["filter", "no-such-cell"]),
        (&["run", "thread-scaling", "--filter", "strategy=warp"], &["filter", "strategy=warp"]),
        (
            &["inspect", "rays", "cornell", "--estimator", "bsdf", "--repetitions", "4294967295"],
            &["repetitions", "4294967295"],
        ),
        (
            &["inspect", "rays", "cornell", "--estimator", "bsdf", "--size", "8192x8192", "--spp", "64"],
            &["spp = 64", "4294967296 paths", "at most 16777216"],
        ),
        (
            &["price", "cornell", "--size", "8192x8192", "--rmse", "0.1", "--pilot-seeds", "100"],
            &["pilot-seeds = 100", "150 GiB", "at most 16 GiB"],
        ),
        (&["list", "planets"], &["planets", "scenes", "strategies"]),
        (&["report", "nowhere"], &["folder", "nowhere"]),
        (&["report", "."], &["folder", "records.csv"]),
        (&["image", "compare", "a.png", "b.png"], &["image", "a.png", "no such file"]),
        (&["image", "compare", "a.tga", "b.png"], &["image", "a.tga", "png", "pfm"]),
        (&["teleport"], &["teleport"]),
    ];
    for (arguments, said) in cases {
        println!("{arguments:?}");
        refused(folder.path(), arguments, 2, said);
    }
}

/// The hidden verb that runs a cell: its input comes from another process, which may be another version.
#[test]
fn a_cell_that_is_no_cell_is_refused() {
    let folder = in_memory();
    refused(folder.path(), &["cell"], 2, &["standard input", "description of a cell"]);
}

/// Options that a workload would not read are refused, not ignored.
#[test]
fn a_workload_takes_no_options_of_light() {
    let folder = in_memory();
    for (option, value) in [
        ("estimator", "mis"),
        ("sampler", "sobol"),
        ("kernel", "scalar"),
        ("simd", "baseline"),
        ("precision", "f32"),
        ("effects", "all"),
        ("accelerator", "sah"),
        ("max-depth", "3"),
        ("camera-rays", "2"),
        ("roulette", "never"),
        ("clamp", "subpixel"),
        ("clamp", "recursion"),
        ("filter", "box"),
        ("epsilon", "1e-4"),
    ] {
        let arguments = ["render", "mandelbrot", &format!("--{option}"), value, "--size", "8x8"];
        refused(folder.path(), &arguments, 2, &[option, value, "workload"]);
    }
}

#[test]
fn a_warning_that_there_is_not_is_refused() {
    let folder = in_memory();
    refused(folder.path(), &["list", "warnings", "drizzle(25 %)"], 2, &["warning", "drizzle", "drift", "too-short"]);
}
