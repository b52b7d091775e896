//! The reference of scene files (`docs/scene-file.md`): it names every key that a scene file may have.

use pathmark::material::MATERIALS;
use pathmark::scene::{CAMERAS, GENERATORS, SHAPES, Scene};
use std::collections::BTreeSet;

/// The names in backquotes.
fn quoted(text: &str) -> BTreeSet<String> {
    text.split('`').skip(1).step_by(2).map(str::to_string).collect()
}

/// The keys that are allowed where this scene has the key `nonsense`, by the message that refuses it.
fn keys(scene: &str) -> BTreeSet<String> {
    let message = Scene::from_toml(scene).unwrap_err().to_string();
    let (_, allowed) = message.split_once("unknown field `nonsense`, expected ").unwrap_or_else(|| panic!("{message}"));
    quoted(allowed)
}

fn page() -> String {
    std::fs::read_to_string(format!("{}/docs/scene-file.md", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_example_is_a_scene() {
    let page = page();
    let example = page.split("```toml\n").nth(1).unwrap().split("```").next().unwrap();
    let scene = Scene::from_toml(example).unwrap();
    assert_eq!(scene.objects.len(), 3);
    assert!(scene.remarks.is_empty(), "{:?}", scene.remarks);
}

#[test]
fn every_key_of_a_scene_file_is_documented() {
    let page = quoted(&page().replace("```", ""));
    let object = |field: &str| format!("about = ''\n[[objects]]\nname = 'a'\n{field}\n");
    let mut scenes = vec![
        "about = ''\nnonsense = 1\n".to_string(),
        object("nonsense = 1"),
        "about = ''\n[fog]\nnonsense = 1\n".to_string(),
        "about = ''\n[faults]\nnonsense = 1\n".to_string(),
        "about = ''\n[[point-lights]]\nnonsense = 1\n".to_string(),
    ];
    let mut names = BTreeSet::new();
    for (table, kinds) in [("camera", CAMERAS), ("generator", GENERATORS)] {
        scenes.extend(kinds.iter().map(|(name, _)| format!("about = ''\n[{table}.{name}]\nnonsense = 1\n")));
        names.extend(kinds.iter().map(|(name, _)| (*name).to_string()));
    }
    let shapes = SHAPES.iter().map(|(name, _)| ("shape", *name));
    for (field, name) in shapes.chain(MATERIALS.iter().map(|entry| ("material", entry.name))) {
        scenes.push(object(&format!("{field} = {{ {name} = {{ nonsense = 1 }} }}")));
        names.insert(name.to_string());
    }
    names.extend(scenes.iter().flat_map(|scene| keys(scene)));
    assert!(names.len() > 50, "{names:?}");
    let missing: Vec<&String> =
        names.iter().filter(|name| !page.contains(*name) && !page.contains(&format!("[camera.{name}]"))).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
