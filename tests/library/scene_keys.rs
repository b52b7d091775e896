//! The references of scene files: `docs/scene-file.md` names every key that a scene file may have, and the list of keys
//! has its type, its range and whether it is required.

use pathmark::material::MATERIALS;
use pathmark::scene::{CAMERAS, GENERATORS, SCENE_KEYS, SHAPES, Scene, SceneKey};
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

/// A scene in which one table has these fields, as in `name = 'x'`.
fn scene_of(table: &str, fields: &[String]) -> String {
    let (lines, inline) = (fields.join("\n"), fields.join(", "));
    let object = "about = ''\n[[objects]]\nname = 'a'\n";
    match table.split('.').collect::<Vec<_>>().as_slice() {
        [""] => format!("{lines}\n"),
        ["objects" | "point-lights"] => format!("about = ''\n[[{table}]]\n{lines}\n"),
        ["objects", field, name] => format!("{object}{field} = {{ {name} = {{ {inline} }} }}\n"),
        _ => format!("about = ''\n[{table}]\n{lines}\n"),
    }
}

/// Table and field of a key.
fn parts(key: &SceneKey) -> (&'static str, &'static str) {
    key.path.rsplit_once('.').unwrap_or(("", key.path))
}

/// A value of the key's kind: a right one, or one out of every range.
fn value(key: &SceneKey, is_right: bool) -> String {
    let number = if is_right { "0.5" } else { "-1e200" };
    let points = |count: usize| {
        let corners = ["[0.0, 0.0, 0.0]", "[1.0, 0.0, 0.0]", "[1.0, 1.0, 0.0]", "[0.0, 1.0, 0.0]"];
        let own: Vec<&str> = corners.into_iter().take(count).collect();
        if is_right {
            format!("[{}]", own.join(", "))
        } else {
            format!("[{}]", vec!["[-1e200, 0.0, 0.0]"; count].join(", "))
        }
    };
    match key.kind {
        "text" => "'x'".to_string(),
        "list of texts" => "['x']".to_string(),
        "number" if key.path.starts_with("generator.imbalance") && is_right => "9.0".to_string(),
        "number" => number.to_string(),
        "whole number" => (if is_right { "9" } else { "0" }).to_string(),
        "true or false" => "true".to_string(),
        "three numbers" if is_right => "[0.1, 0.5, 0.9]".to_string(),
        "three numbers" => format!("[{number}, {number}, {number}]"),
        "three points" => points(3),
        "four points" => points(4),
        other => panic!("{}: no value of the kind {other}", key.path),
    }
}

/// The fields of a table that are required, with right values, except for one of them.
fn required(table: &str, except: &str) -> Vec<String> {
    let own = SCENE_KEYS.iter().filter(|key| key.default == "required").filter(|key| parts(key).0 == table);
    own.filter(|key| parts(key).1 != except).map(|key| format!("{} = {}", parts(key).1, value(key, true))).collect()
}

fn refusal(table: &str, fields: &[String]) -> String {
    Scene::from_toml(&scene_of(table, fields)).map_or_else(|error| error.to_string(), |_| String::new())
}

/// The list of keys has those that the reader knows, and no others.
#[test]
fn the_list_of_keys_is_what_is_read() {
    let mut tables: BTreeSet<&str> = SCENE_KEYS.iter().map(|key| parts(key).0).collect();
    let names = |kinds: &[(&str, &str)], above: &str| -> Vec<String> {
        kinds.iter().map(|(name, _)| format!("{above}.{name}")).collect()
    };
    let kinds = [names(CAMERAS, "camera"), names(GENERATORS, "generator"), names(SHAPES, "objects.shape")].concat();
    let materials = MATERIALS.iter().map(|entry| format!("objects.material.{}", entry.name));
    let all: Vec<String> = kinds.into_iter().chain(materials).collect();
    tables.extend(all.iter().map(String::as_str));
    for table in tables {
        let read = keys(&scene_of(table, &["nonsense = 1".to_string()]));
        let listed = SCENE_KEYS.iter().filter(|key| parts(key).0 == table).map(|key| parts(key).1.to_string());
        assert_eq!(listed.collect::<BTreeSet<String>>(), read, "[{table}]");
    }
}

#[test]
fn required_keys_and_ranges_are_those_of_the_reader() {
    let mut ranges = 0;
    for key in SCENE_KEYS {
        let (table, field) = parts(key);
        let without = refusal(table, &required(table, field));
        let is_missing = without.contains(&format!("missing field `{field}`"));
        assert_eq!(is_missing, key.default == "required", "{}: {without}", key.path);
        if !key.range.is_empty() {
            let wrong = [required(table, field), vec![format!("{field} = {}", value(key, false))]].concat();
            let told = refusal(table, &wrong);
            assert!(told.contains(&format!("(allowed: {})", key.range)), "{}: {told}", key.path);
            ranges += 1;
        }
    }
    assert!(ranges > 40, "{ranges} ranges");
}
