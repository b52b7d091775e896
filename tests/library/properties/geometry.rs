//! Rays against primitives and hierarchies; frames and refraction.

use super::cases;
use pathmark::check::bare_scene::{intersect, scene_of};
use pathmark::math::{Frame, Ray, Vec3, dot, fresnel_dielectric, refract};
use pathmark::scene::{ACCELERATORS, Bounds, Primitive, Primitives, Sphere, Triangle};
use proptest::prelude::*;

fn vector(limit: f64) -> impl Strategy<Value = Vec3> {
    prop::array::uniform3(-limit..limit).prop_map(Vec3::from)
}

/// A unit vector; the axes, where components vanish, are frequent.
fn direction() -> impl Strategy<Value = Vec3> {
    let axis = (0..3_usize, any::<bool>()).prop_map(|(axis, negative)| {
        let mut d = [0.0; 3];
        d[axis] = if negative { -1.0 } else { 1.0 };
        Vec3::from(d)
    });
    let any = vector(1.0).prop_filter("a direction", |d| dot(*d, *d) > 1e-6).prop_map(Vec3::normalized);
    prop_oneof![4 => any, 1 => axis]
}

fn length(v: Vec3) -> f64 {
    dot(v, v).sqrt()
}

fn meet<P: Primitive>(primitive: &P, ray: &Ray) -> f64 {
    primitive.meet(ray, &P::prepare(ray))
}

/// Any size from a thousandth to a thousand.
fn size() -> impl Strategy<Value = f64> {
    (-3.0..3.0_f64).prop_map(|exponent| libm::pow(10.0, exponent))
}

fn sphere() -> impl Strategy<Value = Sphere> {
    (vector(100.0), size()).prop_map(|(center, radius)| Sphere { center, radius })
}

/// A triangle that is not a sliver.
fn triangle() -> impl Strategy<Value = Triangle> {
    let corners = (vector(10.0), vector(10.0), vector(10.0));
    corners.prop_map(|(a, b, c)| Triangle { corners: [a, b, c] }).prop_filter("an area", |triangle| {
        let [a, b, c] = triangle.corners;
        let longest = length(b - a).max(length(c - a)).max(length(c - b));
        length((b - a).cross(c - a)) > 0.05 * longest * longest
    })
}

proptest! {
    #![proptest_config(cases(8000))]

    /// A ray from inside always hits the sphere, at most a diameter away, at a point of its surface.
    #[test]
    fn a_sphere_surrounds_its_inside(sphere in sphere(), at in vector(1.0), direction in direction()) {
        let inside = at * (0.999 / length(at).max(1.0));
        let ray = Ray { origin: sphere.center + inside * sphere.radius, direction };
        let t = meet(&sphere, &ray);
        prop_assert!(t > 0.0 && t <= 2.0 * sphere.radius * (1.0 + 1e-9), "{t}");
        let from_center = length(ray.at(t) - sphere.center);
        prop_assert!((from_center - sphere.radius).abs() <= 1e-9 * sphere.radius.max(1.0), "{from_center}");
    }

    /// A ray towards a point inside hits the sphere before that point. A ray away from the sphere does not hit it.
    #[test]
    fn a_sphere_is_met_on_the_way_to_its_inside(sphere in sphere(), at in vector(1.0), out in direction(), far in 1.01..1e3_f64) {
        let target = sphere.center + at * (0.9 * sphere.radius / length(at).max(1.0));
        let origin = sphere.center + out * (far * sphere.radius);
        let distance = length(target - origin);
        let t = meet(&sphere, &Ray { origin, direction: (target - origin).normalized() });
        prop_assert!(t > 0.0 && t < distance, "{t} of {distance}");
        prop_assert!(t >= (far - 1.0) * sphere.radius * (1.0 - 1e-9), "{t}");
        let away = meet(&sphere, &Ray { origin, direction: out });
        prop_assert!(away.is_nan() || away <= 0.0, "{away}");
    }

    /// Scaling a scene by a power of two changes no bit of its hits.
    #[test]
    fn spheres_and_triangles_scale_exactly(
        sphere in sphere(), triangle in triangle(), origin in vector(100.0), direction in direction(), k in -40..40_i32,
    ) {
        let factor = libm::scalbn(1.0, k);
        let (ray, scaled) = (Ray { origin, direction }, Ray { origin: origin * factor, direction });
        let bits = |t: f64| if t > 0.0 { t.to_bits() } else { 0 };
        prop_assert_eq!(bits(meet(&sphere, &ray) * factor), bits(meet(&sphere.scaled(factor), &scaled)));
        prop_assert_eq!(bits(meet(&triangle, &ray) * factor), bits(meet(&triangle.scaled(factor), &scaled)));
    }

    /// The barycentric coordinates of the target decide between hit and miss, and the order of the corners does not
    /// matter.
    #[test]
    fn a_triangle_is_hit_inside_and_missed_outside(
        triangle in triangle(), (u, v) in (-1.0..2.0_f64, -1.0..2.0_f64), origin in vector(30.0), turn in 0..3_usize,
    ) {
        let [a, b, c] = triangle.corners;
        let w = 1.0 - u - v;
        let target = a * w + b * u + c * v;
        let direction = (target - origin).normalized();
        let cos = dot(direction, triangle.normal(a)).abs();
        let margin = u.min(v).min(w);
        prop_assume!(cos > 0.05 && margin.abs() > 1e-9);
        let mut turned = triangle.corners;
        turned.rotate_left(turn);
        let flipped = [turned[1], turned[0], turned[2]];
        for corners in [turned, flipped] {
            let t = meet(&Triangle { corners }, &Ray { origin, direction });
            if margin > 0.0 {
                let expected = length(target - origin);
                prop_assert!((t / expected - 1.0).abs() < 1e-9 || expected < 1e-6, "{t} instead of {expected}");
            } else {
                prop_assert!(t.is_nan(), "{t} beside it");
            }
        }
    }

    #[test]
    fn a_box_is_met_on_the_way_to_any_of_its_points(
        corners in prop::array::uniform3(vector(50.0)), share in prop::array::uniform3(0.0..=1.0_f64), origin in vector(100.0),
    ) {
        let bounds = Bounds::of_points(&corners);
        let [x, y, z] = [0, 1, 2].map(|axis| bounds.low[axis] + share[axis] * (bounds.high[axis] - bounds.low[axis]));
        let direction = Vec3::new(x, y, z) - origin;
        prop_assume!(length(direction) > 1e-3);
        let ray = Ray { origin, direction: direction.normalized() };
        prop_assert!(bounds.meets(&ray));
        let whole = bounds.and(&Bounds::of_points(&[origin]));
        prop_assert!(whole.half_area() >= bounds.half_area());
    }

    #[test]
    fn frames_are_orthonormal_and_there_and_back_is_the_same(n in direction(), v in vector(10.0)) {
        let frame = Frame::around(n);
        for product in [dot(frame.s, frame.t), dot(frame.s, n), dot(frame.t, n), length(frame.s) - 1.0, length(frame.t) - 1.0] {
            prop_assert!(product.abs() < 1e-14, "{product:e}");
        }
        prop_assert!(length(frame.to_world(frame.to_local(v)) - v) <= 1e-13 * length(v).max(1e-3));
    }

    /// Snell's law holds, and the reverse ray refracts back. The reflectance lies between 0 and 1 and is the same from
    /// both sides.
    #[test]
    fn refraction_obeys_snell_and_can_be_undone(cos in 0.01..1.0_f64, turns in 0.0..1.0_f64, eta in 0.2..5.0_f64) {
        let sin = (1.0 - cos * cos).sqrt();
        let (s, c) = pathmark::math::sin_cos_turns(turns);
        let wo = Vec3::new(sin * c, sin * s, cos);
        let (wt, cos2) = refract(wo, eta);
        let reflectance = fresnel_dielectric(cos, 1.0 / eta);
        prop_assert!((0.0..=1.0).contains(&reflectance), "{reflectance}");
        if cos2 > 1e-3 {
            prop_assert!((length(wt) - 1.0).abs() < 1e-12 && wt.z < 0.0);
            let beyond = (wt.x * wt.x + wt.y * wt.y).sqrt();
            prop_assert!((beyond - eta * sin).abs() < 1e-12, "{beyond}");
            let (back, _) = refract(-wt, 1.0 / eta);
            prop_assert!(length(back + wo) < 1e-9, "{back:?}");
            let other = fresnel_dielectric(-wt.z, eta);
            prop_assert!((reflectance - other).abs() < 1e-9, "{reflectance} {other}");
        } else if cos2 < 0.0 {
            prop_assert_eq!(fresnel_dielectric(cos, 1.0 / eta), 1.0);
        }
    }
}

proptest! {
    #![proptest_config(cases(60))]

    /// Every hierarchy finds the hits that testing every primitive finds, to the bit.
    #[test]
    fn hierarchies_find_the_same_hits(
        spheres in prop::collection::vec(sphere(), 0..30), triangles in prop::collection::vec(triangle(), 1..60),
        rays in prop::collection::vec((vector(200.0), direction()), 40),
    ) {
        let all = scene_of(Primitives { spheres, triangles, ..Primitives::default() });
        for entry in ACCELERATORS.iter().filter(|entry| entry.is_hierarchy()) {
            let accelerated = all.accelerated(entry.name).expect("an accelerator of the table");
            for (origin, direction) in &rays {
                let ray = Ray { origin: *origin, direction: *direction };
                let found = |scene| intersect(scene, &ray, None).map(|hit| (hit.t.to_bits(), hit.primitive, hit.inside));
                prop_assert_eq!(found(&accelerated), found(&all), "{}", entry.name);
            }
        }
    }
}
