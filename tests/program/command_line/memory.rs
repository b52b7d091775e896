//! How much memory a render takes.

use super::{json, run};

/// The pieces of a large film are let go as they are put together, whatever the order in which they were rendered.
#[test]
fn a_large_film_and_its_pieces_are_not_there_together() {
    let folder = tempfile::tempdir().unwrap();
    let [width, height] = [2112, 2016];
    let film = 56.0 * f64::from(width) * f64::from(height);
    let size = format!("{width}x{height}");
    let mut checksums = Vec::new();
    for options in [
        ["--decomposition", "tiles:32x32"],
        ["--decomposition", "tiles:32x32:hilbert"],
        ["--decomposition", "bands:3"],
        ["--output", "locked"],
    ] {
        let base = ["render", "cornell-mesh", "--size", &size, "--spp", "1", "--max-depth", "0", "--threads", "2"];
        let record = json(&run(folder.path(), &[&base[..], &options, &["--json", "-o", "image.pfm"]].concat()).out);
        let peak = record["peak_rss_bytes"].as_f64().unwrap();
        // The program itself takes some tens of megabytes.
        let [least, most] = [film, 1.4 * film + 64e6];
        assert!((least..most).contains(&peak), "{options:?}: {peak} bytes for a film of {film}");
        checksums.push(record["checksum"].clone());
    }
    assert!(checksums.iter().all(|checksum| *checksum == checksums[0]), "{checksums:?}");
}
