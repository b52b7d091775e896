//! Every material, as scene file text.

use crate::material::Material;
use crate::math::{Vec3, sin_cos_turns};
use crate::refusals::material;

/// The roughnesses at which rough materials are tried.
pub const ROUGHNESSES: [f64; 5] = [0.05, 0.1, 0.25, 0.5, 1.0];

/// The unit direction with this cosine to the normal, at this angle around it in turns.
pub fn towards(cos: f64, turns: f64) -> Vec3 {
    let rim = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = sin_cos_turns(turns);
    Vec3::new(rim * c, rim * s, cos)
}

/// Instances of every material in the table, each with its text. Rough materials come at every roughness and smooth.
pub fn every_material() -> Vec<(String, Material)> {
    let texts = Material::examples().into_iter().flat_map(|example| {
        let is_rough = example.contains("ROUGHNESS");
        let roughnesses = ROUGHNESSES.into_iter().chain([0.0]).take(if is_rough { usize::MAX } else { 1 });
        roughnesses.map(move |roughness| example.replace("ROUGHNESS", &format!("{roughness:?}")))
    });
    texts.map(|text| (text.clone(), material(&text))).collect()
}
