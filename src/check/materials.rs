//! Every material, in the words of a scene file.

use crate::check::refusals::material;
use crate::material::{MATERIALS, Material};
use crate::math::{Vec3, sin_cos_turns};

/// The roughnesses at which what has one is tried.
pub const ROUGHNESSES: [f64; 5] = [0.05, 0.1, 0.25, 0.5, 1.0];

/// The unit direction with that cosine to the normal, so many turns around it.
pub fn towards(cos: f64, turns: f64) -> Vec3 {
    let rim = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = sin_cos_turns(turns);
    Vec3::new(rim * c, rim * s, cos)
}

/// Instances of every material in the table, each with its text: rough ones at every roughness and smooth.
pub fn every_material() -> Vec<(String, Material)> {
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
                let line = move |roughness: f64| {
                    format!(
                        "{{ kd-ks = {{ kd = [0.3, 0.3, 0.25], eta = 1.5, roughness = {roughness:?}, sampling = '{kind}' }} }}"
                    )
                };
                rough().map(line)
            })
            .collect(),
        _ => panic!("`{name}` has no line here: the cases of materials loop over this table"),
    }
}
