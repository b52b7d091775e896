//! Every material, in the words of a scene file.

use pathmark::material::{MATERIALS, Material};
use serde::Deserialize;

/// The roughnesses at which what has one is tested.
pub(crate) const ROUGHNESSES: [f64; 5] = [0.05, 0.1, 0.25, 0.5, 1.0];

#[derive(Deserialize)]
struct Line {
    material: Material,
}

/// Reads what a scene file says behind `material = `.
pub(crate) fn material(text: &str) -> Material {
    toml::from_str::<Line>(&format!("material = {text}")).unwrap().material
}

/// Instances of every material in the table, each with its text: rough ones at every roughness and smooth.
pub(crate) fn every_material() -> Vec<(String, Material)> {
    let texts = MATERIALS.iter().flat_map(|entry| texts(entry.name));
    texts.map(|text| (text.clone(), material(&text))).collect()
}

fn texts(name: &str) -> Vec<String> {
    let rough = || ROUGHNESSES.into_iter().chain([0.0]);
    match name {
        "diffuse" => vec!["{ diffuse = { albedo = [0.75, 0.5, 0.25] } }".to_string()],
        "mirror" => vec!["{ mirror = { albedo = [0.75, 0.5, 0.25] } }".to_string()],
        "dielectric" => ["schlick", "exact"]
            .map(|kind| format!("{{ dielectric = {{ eta = 1.5, tint = [0.9, 0.8, 0.7], fresnel = '{kind}' }} }}"))
            .to_vec(),
        "polished" => [0.0, 0.3, 0.8]
            .map(|share| format!("{{ polished = {{ albedo = [0.75, 0.5, 0.25], reflectivity = {share:?} }} }}"))
            .to_vec(),
        "fresnel-mirror" => vec!["{ fresnel-mirror = { eta = 12.85 } }".to_string()],
        "conductor" => rough()
            .map(|alpha| format!("{{ conductor = {{ alpha = {alpha:?}, f0 = [1.0, 0.77, 0.34] }} }}"))
            .collect(),
        "kd-ks" => ["cosine", "vndf"]
            .into_iter()
            .flat_map(|kind| {
                rough().map(move |roughness| {
                    format!(
                        "{{ kd-ks = {{ kd = [0.3, 0.3, 0.25], eta = 1.5, roughness = {roughness:?}, sampling = '{kind}' }} }}"
                    )
                })
            })
            .collect(),
        _ => panic!("`{name}` has no line here: tests of materials loop over this table"),
    }
}
