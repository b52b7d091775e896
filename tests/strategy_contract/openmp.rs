//! What OpenMP would do differently from everyone else, if it were left alone.

use std::process::Command;

/// A limit in the environment would quietly leave a smaller team, and a record with a false number of threads.
#[test]
fn a_team_that_is_too_small_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    for strategy in ["openmp-static", "openmp-dynamic", "openmp-guided"] {
        let render = |threads: &str| {
            let image = ["render", "cornell", "--size", "8x8", "--spp", "4", "--decomposition", "tiles:1x1"];
            let mut command = Command::new(env!("CARGO_BIN_EXE_pathmark"));
            command.args(image).args(["--strategy", strategy, "--threads", threads]);
            command.current_dir(folder.path()).env("OMP_THREAD_LIMIT", "2").output().unwrap()
        };
        let (within, beyond) = (render("2"), render("3"));
        assert!(within.status.success(), "{strategy}: {}", String::from_utf8_lossy(&within.stderr));
        let message = String::from_utf8_lossy(&beyond.stderr);
        assert_eq!(beyond.status.code(), Some(3), "{strategy}: {message}");
        assert!(message.contains("3 threads are too many (allowed: 1 to 2)"), "{message}");
    }
}
