//! Aims at lights: S60 of the catalogue of hard cases, and the agreement of densities with aims.

use pathmark::math::{Ray, Vec3, dot};
use pathmark::sampling::{Address, Independent, Purpose, SampleKey, Sampler};
use pathmark::scene::{AllEffects, SCENES, Scene, SurfaceOrigin, Tests, load};

fn lit(name: &str) -> Scene {
    let scene = load(name).unwrap();
    scene.lit(&scene.camera.view(64, 48))
}

/// A pair of random numbers.
fn pair(k: u32, purpose: Purpose) -> [f64; 2] {
    Independent.pair(Address { key: SampleKey { seed: 7, pixel: 0, sample: k }, bounce: 1, branch: 0, purpose })
}

/// S60: smallpt's light is a sphere of radius 600. Aims go only to its cap below the ceiling: a circle of radius
/// 17.944 and area 1011.807.
#[test]
fn only_the_cap_of_smallpts_light_is_aimed_at() {
    let scene = lit("cornell");
    let lights = scene.lights.as_ref().unwrap();
    let light = scene.objects.iter().position(|object| object.name == "light").unwrap() as u32;
    let point = Vec3::new(30.0, 10.0, 100.0);
    let (mut arrived, n) = (0, 20_000);
    for k in 0..n {
        let aim = lights.aim(point, None, || unreachable!("one light"), pair(k, Purpose::Light)).unwrap();
        let ray = Ray { origin: point, direction: aim.direction };
        assert_eq!(aim.primitive, light);
        // Intersects the light alone and ignores the walls.
        let sphere = scene.primitives.spheres[light as usize];
        let offset = sphere.center - point;
        let middle = dot(offset, aim.direction);
        let t = middle - (middle * middle - dot(offset, offset) + sphere.radius * sphere.radius).sqrt();
        let at = ray.at(t);
        let off = Vec3::new(at.x - 50.0, 0.0, at.z - 81.6);
        assert!(dot(off, off).sqrt() < 17.944_246_733_607_27 + 1e-6, "{at:?}");
        let normal = (at - sphere.center) * (1.0 / sphere.radius);
        let area = t * t / (-dot(normal, aim.direction) * aim.density);
        assert!((area / 1_011.806_538_278_449 - 1.0).abs() < 1e-6, "area {area}");
        let hit = scene.intersect::<AllEffects>(&ray, None, &mut Tests::default()).unwrap();
        arrived += u32::from(hit.primitive == light);
    }
    // From there only the balls hide a small part of it.
    assert!(arrived > n * 9 / 10, "{arrived} of {n}");
}

/// The density of an aim equals the density that is computed where it arrives, in every scene, from points in the air
/// and on surfaces.
#[test]
fn densities_are_those_of_the_aims() {
    let mut arrived = 0;
    for (name, _) in SCENES {
        let scene = lit(if *name == "spheres" { "spheres:100" } else { name });
        let lights = scene.lights.as_ref().unwrap();
        let view = scene.camera.view(64, 48);
        for k in 0..500 {
            let ray = view.ray::<AllEffects>(k * 7 % 64, k * 5 % 48, 0, [0.5, 0.5], || [0.5, 0.5]);
            let Some(hit) = scene.intersect::<AllEffects>(&ray, None, &mut Tests::default()) else { continue };
            let on = SurfaceOrigin { primitive: hit.primitive, inside: hit.inside };
            for (point, from) in [(ray.at(0.5 * hit.t), None), (hit.point, Some(on))] {
                let choice = || pair(k, Purpose::LightChoice)[0];
                let Some(aim) = lights.aim(point, from, choice, pair(k, Purpose::Light)) else { continue };
                let shadow = Ray { origin: point, direction: aim.direction };
                let found = scene.intersect::<AllEffects>(&shadow, from, &mut Tests::default());
                if let Some(found) = found.filter(|found| found.primitive == aim.primitive) {
                    let density = lights.density(&shadow, from, &found);
                    // Edge on, a rounding of the direction changes the density by more than a rounding.
                    let cos = dot(aim.direction, found.normal).abs();
                    let allowed = 1e-9 / cos.max(1e-6);
                    assert!((density / aim.density - 1.0).abs() < allowed, "{name}: {density} for {}", aim.density);
                    arrived += 1;
                }
            }
        }
    }
    assert!(arrived > 1000, "{arrived} arrived");
}
