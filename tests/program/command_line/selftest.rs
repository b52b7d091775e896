//! Hard cases from the command line, and `--strict`.

use super::{TINY, json, run, write_tiny};
use crate::program::{finish, in_memory, pathmark};

/// Named cases are printed with all their trials; an unknown name is refused with the known ones.
#[test]
fn cases_can_be_chosen() {
    let folder = in_memory();
    let shown = run(folder.path(), &["selftest", "P10"]).out;
    assert!(shown.contains("P10  pass") && shown.contains("bsdf, NaN: counted: expected"), "{shown}");
    assert!(
        run(folder.path(), &["selftest", "P010"]).out.contains("P10  pass"),
        "zeros before a number change nothing"
    );
    let found = json(&run(folder.path(), &["selftest", "P10", "--json"]).out);
    let case = &found["cases"][0];
    assert!(case["id"] == "P10" && case["pass"] == true && case["trials"].as_array().is_some_and(|all| all.len() > 9));
    let refused = finish(pathmark(folder.path(), &["selftest", "P10", "Z9"])).with_code(2);
    assert!(refused.err.contains("case = Z9") && refused.err.contains("P10"), "{}", refused.err);
}

/// Good images pass `--strict`. As far as its reader can tell, no scene can cause a fault; faults are tested where they
/// can be injected.
#[test]
fn strict_lets_good_images_pass() {
    let folder = in_memory();
    run(folder.path(), &["render", "cornell", "--size", "8x6", "--spp", "4", "--strict"]);
    write_tiny(folder.path(), TINY);
    run(folder.path(), &["run", "tiny.toml", "--strict"]);
}
