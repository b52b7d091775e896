//! A custom scene, from text and code, rendered by a program without the command line.
//!
//! `cargo run --release --example custom_scene`

use pathmark::error::Result;
use pathmark::kernel::Spec;
use pathmark::measure::{Settings, Setup};
use pathmark::scene::Scene;
use std::fmt::Write;
use std::sync::Arc;

/// The parts kept from smallpt's box: its walls, lamp and camera.
const ROOM: &str = "
about = 'a row of balls in a box'
base = 'cornell'
without = ['mirror ball', 'glass ball']
";

fn row_of_balls(count: u32) -> Result<Scene> {
    let mut text = ROOM.to_string();
    for ball in 0..count {
        let (x, shade) = (15.0 + 70.0 * f64::from(ball) / f64::from(count - 1), 0.1 + 0.1 * f64::from(ball));
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "[[objects]]\nname = 'ball {ball}'\n\
             shape = {{ sphere = {{ center = [{x:?}, 8.0, 80.0], radius = 5.0 }} }}\n\
             material = {{ diffuse = {{ albedo = [{shade:?}, {shade:?}, {shade:?}] }} }}\n"
        );
    }
    Scene::from_toml(&text)
}

fn main() -> Result<()> {
    let scene = Arc::new(row_of_balls(8)?);
    let spec = Spec { width: 128, height: 96, estimator: "mis".into(), ..Spec::default() };
    for strategy in ["serial", "work-stealing", "rayon"] {
        let settings = Settings { spp: 16, spec: spec.clone(), strategy: strategy.into(), ..Settings::default() };
        let outcome = Setup::for_scene(Arc::clone(&scene), settings)?.run(None)?;
        // The times differ, the image is the same.
        println!("{strategy:14} {:.3} s, checksum {}", outcome.makespan_s, outcome.checksum.unwrap_or_default());
    }
    Ok(())
}
