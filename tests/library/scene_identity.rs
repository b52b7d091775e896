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

/// `without` leaves out thousands of objects of a base, and refuses a name that is not, or no longer, there.
#[test]
fn many_objects_of_a_base_are_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let object = |index: usize| {
        let shape = format!("shape = {{ sphere = {{ center = [{index}.0, 0.0, 0.0], radius = 0.25 }} }}");
        format!(
            "[[objects]]\nname = \"ball {index}\"\n{shape}\nmaterial = {{ diffuse = {{ albedo = [0.5, 0.5, 0.5] }} }}\n"
        )
    };
    let base = (0..3000).map(object).collect::<String>();
    let camera =
        "[camera.smallpt]\nposition = [0.0, 0.0, 9.0]\ndirection = [0.0, 0.0, -1.0]\nfield = 0.5\nadvance = 0.0\n";
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("base.toml"), format!("about = \"balls\"\n{camera}{base}")).unwrap();
    let load = |names: Vec<String>| {
        std::fs::write(path("few.toml"), format!("about = \"few\"\nbase = \"base.toml\"\nwithout = {names:?}\n"))
            .unwrap();
        pathmark::scene::load(&path("few.toml").display().to_string())
    };
    let left_out: Vec<String> = (1..3000).map(|index| format!("ball {index}")).collect();
    assert_eq!(load(left_out).unwrap().objects.len(), 1);
    for names in [["ball 1", "ball 1"], ["ball 1", "ball 3000"]] {
        let told = load(names.map(str::to_string).to_vec()).unwrap_err().to_string();
        assert!(told.contains("without") && told.contains("the base has no object of that name"), "{told}");
    }
}
