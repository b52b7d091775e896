//! Different scenes stay different, even if their files have the same name.

use pathmark::experiment::{Definition, Profile};
use pathmark::scene::SCENES;

const EXPERIMENT: &str = r#"
title = "Twins"
question = "?"
analysis = "."
figures = []
[matrix]
scene = ["a/box.toml", "b/box.toml"]
estimator = ["bsdf"]
spp = [4]
seed = [1]
strategy = ["serial"]
threads = [1]
decomposition = ["rows"]
[quick]
size = [8, 6]
repetitions = 1
[full]
size = [8, 6]
repetitions = 1
"#;

/// Cells are identified by their word, and rows with one word must have one checksum. So the word must distinguish the
/// two scenes.
#[test]
fn scene_files_of_the_same_name_are_different_cells() {
    let folder = tempfile::tempdir().unwrap();
    let (_, cornell) = SCENES.iter().find(|(name, _)| *name == "cornell").unwrap();
    for (place, radius) in [("a", "16.5"), ("b", "12.5")] {
        std::fs::create_dir(folder.path().join(place)).unwrap();
        std::fs::write(folder.path().join(place).join("box.toml"), cornell.replace("16.5 }", &format!("{radius} }}")))
            .unwrap();
    }
    let file = folder.path().join("twins.toml").display().to_string();
    let cells = Definition::from_text(&pathmark::Lab::built_in(), "twins", &file, EXPERIMENT)
        .unwrap()
        .cells(Profile::Quick)
        .unwrap();
    assert_eq!(cells.len(), 2);
    assert_ne!(cells[0].points[0].image, cells[1].points[0].image);
    assert_ne!(cells[0].points[0].image_file(), cells[1].points[0].image_file());
}
