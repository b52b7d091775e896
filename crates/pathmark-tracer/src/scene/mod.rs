//! Scenes: shapes with materials and emission, lights, a camera, and the effects that they use.

mod angular_emission;
mod camera;
mod coincident;
mod extent;
mod faults;
mod fog;
mod generator;
mod hierarchy;
mod keys;
mod library;
mod light;
mod point_light;
mod profile;
mod reader;
mod remark;
mod shape;

pub use angular_emission::AngularEmission;
pub use camera::{CAMERA_EXAMPLES, CAMERAS, Camera, FILTERS, Filter, FilterEntry, Lens, SUBPIXELS, View};
pub use faults::Faults;
pub use fog::Fog;
pub use generator::GENERATORS;
pub use hierarchy::{
    ACCELERATORS, Bounds, DEEPEST, Entry as Accelerator, Faces, Hierarchy, Node, Scan, Slabs, Tests, accelerator,
    padding,
};
pub use keys::{SCENE_KEYS, SceneKey};
pub use library::{CustomScene, Library, SCENES, load};
pub use light::{Aim, Lights, one_minus_cos};
pub use light::{AnyTarget, NO_LIGHT, TriangleTarget, per_steradian, point_of, towards_cap};
pub use point_light::PointLight;
pub use profile::{
    ANGULAR_EMISSION, AllEffects, BACKGROUND, COMPOUND, DiffuseOnly, EPSILON, FAULTS, FEATURES, FOG, FogEffects,
    HIERARCHY, LENS, LensEffects, POINT_LIGHT, PROFILES, ProfileEntry, ProfileVisitor, REACH, SceneryEffects,
    SmallptEffects, SurfaceEffects, effect_names, with_profile,
};
pub use shape::{Nearest, PRIMITIVES, Plane, Primitive, Primitives, SHAPES, Sphere, Triangle, nearness};

use crate::effect::{EffectSet, Effects};
use crate::material::Material;
use crate::math::{Frame, Ray, Rgb, Vec3, dot};
use std::path::PathBuf;

/// The properties of an object in the scene, apart from its surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its name in the scene file.
    pub name: String,
    pub material: Material,
    /// The radiance that it emits in every direction, on both sides.
    pub emission: Rgb,
    /// The radiance that it emits instead, by the angle. Scene files have none; [`Scene::in_equilibrium`] may need it.
    pub angular_emission: Option<AngularEmission>,
}

impl Object {
    /// Returns the radiance that it emits at that cosine to its normal, on either side.
    #[inline(always)]
    pub fn emitted<X: EffectSet>(&self, cos: f64) -> Rgb {
        match &self.angular_emission {
            Some(emission) if X::EFFECTS.cover(ANGULAR_EMISSION) => emission.at(cos),
            _ => self.emission,
        }
    }
}

/// The primitive on which a ray starts, and the side. Such a ray needs no epsilon to miss its own start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SurfaceOrigin {
    pub primitive: u32,
    /// Whether the ray leaves to its inside.
    pub inside: bool,
}

/// The first intersection of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance, in multiples of the direction's length.
    pub t: f64,
    pub primitive: u32,
    /// Index of the object that it belongs to.
    pub object: u32,
    pub point: Vec3,
    /// The outward unit normal.
    pub normal: Vec3,
    /// Whether the ray arrives from the object's inside.
    pub inside: bool,
}

impl Hit {
    /// Returns the local frame, with its normal on the side from which the ray came.
    #[inline(always)]
    pub fn frame(&self) -> Frame {
        Frame::around(if self.inside { -self.normal } else { self.normal })
    }
}

/// The estimator of a scene that names none: on a scene with small lights, others take up to a hundred times as long
/// for the same error.
pub const USUAL_ESTIMATOR: &str = "mis";

/// A scene: everything that a kernel needs for rendering.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Its name: the file's stem, and a generator's number.
    pub name: String,
    pub about: String,
    /// SHA-256 of everything that defines it, shortened to 16 hexadecimal digits.
    pub hash: String,
    /// The files on disk that it was read from: its own, its bases' and its meshes'.
    pub files: Vec<PathBuf>,
    /// Remarks for its author on how it was read.
    pub remarks: Vec<String>,
    /// Two objects of which single precision cannot tell which one is in front, if the scene's definition has two.
    pub(in crate::scene) near: Option<[String; 2]>,
    /// The estimator that the scene names. [`Scene::estimator`] also covers scenes that name none.
    pub default_estimator: Option<String>,
    pub camera: Camera,
    /// The surfaces, stored apart from the objects, so that the search for the nearest one reads nothing else.
    pub primitives: Primitives,
    pub objects: Vec<Object>,
    /// The object's index for each primitive.
    pub owners: Vec<u32>,
    /// The indices of the objects that are meshes from files.
    pub meshes: Vec<u32>,
    /// Lights without a size.
    pub point_lights: Vec<PointLight>,
    /// The radiance of rays that hit nothing; `None` if the scene is closed, so that there should be no such rays.
    pub background: Option<Rgb>,
    /// The medium between the surfaces.
    pub fog: Option<Fog>,
    /// The hierarchy that speeds up the search for the nearest primitive; every primitive is tested if `None`.
    pub hierarchy: Option<Hierarchy>,
    /// The lights for estimators with next-event estimation.
    pub lights: Option<Lights>,
    /// The least distance of a hit. If `None`, the ray's exact start prevents self-intersection. Scene files have none,
    /// because the epsilon belongs to the render.
    pub epsilon: Option<f64>,
    /// Wrong tests of spheres and planes, on purpose.
    pub faults: Option<Faults>,
}

impl Scene {
    /// Returns the estimator that is used unless the user names another.
    pub fn estimator(&self) -> &str {
        self.default_estimator.as_deref().unwrap_or(USUAL_ESTIMATOR)
    }

    pub fn effects(&self) -> Effects {
        let called = |is_there: bool, effect: Effects| if is_there { effect } else { Effects::NONE };
        let materials = self.objects.iter().fold(Effects::NONE, |all, object| all.and(object.material.effect()));
        materials
            .and(self.primitives.effects())
            .and(self.camera.effects())
            .and(called(self.background.is_some_and(|radiance| !radiance.is_black()), BACKGROUND))
            .and(called(!self.point_lights.is_empty(), POINT_LIGHT))
            .and(called(self.point_lights.iter().any(|light| light.reach.is_some()), REACH))
            .and(called(self.epsilon.is_some(), EPSILON))
            .and(called(self.faults.is_some(), FAULTS))
            .and(called(self.fog.is_some(), FOG))
            .and(called((0..).zip(&self.owners).any(|(primitive, owner)| primitive != *owner), COMPOUND))
            .and(called(self.objects.iter().any(|object| object.angular_emission.is_some()), ANGULAR_EMISSION))
            .and(called(self.hierarchy.is_some(), HIERARCHY))
    }

    /// Returns the first primitive of the kinds in `X` along the ray; among equally near ones, the one with the lowest
    /// number. `from` is the ray's start, if it is on a primitive.
    #[inline(always)]
    pub fn intersect<X: EffectSet>(&self, ray: &Ray, from: Option<SurfaceOrigin>, tests: &mut Tests) -> Option<Hit> {
        self.first::<X>(ray, from, f64::INFINITY, tests)
    }

    /// Returns the first primitive of any kind along the ray. This crate compiles it, so it is equally fast when an
    /// unoptimised crate calls it.
    pub fn first_of_any(&self, ray: &Ray, from: Option<SurfaceOrigin>) -> Option<Hit> {
        self.intersect::<AllEffects>(ray, from, &mut Tests::default())
    }

    /// Like [`Self::intersect`], for hits nearer than `limit`. With an epsilon, the search starts that far along the
    /// ray and without `from`. It then finds the same hit as a program that drops hits nearer than epsilon.
    #[inline(always)]
    fn first<X: EffectSet>(
        &self,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        limit: f64,
        tests: &mut Tests,
    ) -> Option<Hit> {
        let (mut ray, mut from, mut limit) = (*ray, from, limit);
        let epsilon = self.epsilon.filter(|_| X::EFFECTS.cover(EPSILON));
        if let Some(epsilon) = epsilon {
            (ray.origin, from, limit) = (ray.at(epsilon), None, limit - epsilon);
        }
        let hit = self.first_exactly::<X>(&ray, from, limit, tests)?;
        Some(Hit { t: epsilon.map_or(hit.t, |epsilon| hit.t + epsilon), ..hit })
    }

    /// The same search without an epsilon.
    #[inline(always)]
    fn first_exactly<X: EffectSet>(
        &self,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        limit: f64,
        tests: &mut Tests,
    ) -> Option<Hit> {
        if X::EFFECTS.cover(FAULTS)
            && let Some(faults) = &self.faults
        {
            return self.hit::<X>(ray, faults.nearest(&self.primitives, ray, from, limit, tests));
        }
        let hierarchy = self.hierarchy.as_ref();
        let hit = self.hit::<X>(ray, self.primitives.nearest::<X>(hierarchy, ray, from, limit, tests))?;
        if X::EFFECTS.cover(Triangle::EFFECT) && self.primitives.is_doubtful(ray, &hit) {
            return self.hit::<X>(
                ray,
                self.primitives.surely_nearest(hierarchy, ray, from, (limit, f64::MANTISSA_DIGITS), tests),
            );
        }
        Some(hit)
    }

    #[inline(always)]
    fn hit<X: EffectSet>(&self, ray: &Ray, Nearest { t, primitive }: Nearest) -> Option<Hit> {
        if primitive == u32::MAX {
            return None;
        }
        let object = self.owner::<X>(primitive);
        let point = ray.at(t);
        let normal = self.primitives.normal::<X>(primitive, point);
        Some(Hit { t, primitive, object, point, normal, inside: dot(normal, ray.direction) > 0.0 })
    }

    /// Returns the distance and the number of the first primitive along a ray whose coordinates have `digits` binary
    /// digits. [`Scene::intersect`] finds the same for double precision, faster.
    pub fn nearest(&self, ray: &Ray, from: Option<SurfaceOrigin>, digits: u32, tests: &mut Tests) -> Nearest {
        let hierarchy = self.hierarchy.as_ref();
        if self.primitives.triangles.is_empty() {
            return self.primitives.nearest::<AllEffects>(hierarchy, ray, from, f64::INFINITY, tests);
        }
        self.primitives.surely_nearest(hierarchy, ray, from, (f64::INFINITY, digits), tests)
    }

    pub fn is_round(&self) -> bool {
        self.primitives.spheres.len() == self.owners.len()
    }

    /// Returns the opaque spheres that no path leaves, because all camera rays start well inside them; none if the
    /// camera has a lens.
    pub fn enclosing(&self, view: &View) -> Vec<u32> {
        let starts = view.starts();
        // A margin for the ray starts between the tested ones, which may lie farther out.
        let clear = 1e-4 * self.size();
        let spheres = self.primitives.spheres.iter().zip(0_u32..).filter(|(sphere, number)| {
            let material = &self.objects[self.owners[*number as usize] as usize].material;
            let is_inside = |start: &Vec3| {
                let offset = *start - sphere.center;
                dot(offset, offset).sqrt() + clear < sphere.radius
            };
            !material.transmits() && starts.iter().all(is_inside)
        });
        if self.camera.lens.is_some() { Vec::new() } else { spheres.map(|(_, number)| number).collect() }
    }

    /// Returns the index of the object that a primitive belongs to.
    #[inline(always)]
    pub fn owner<X: EffectSet>(&self, primitive: u32) -> u32 {
        if X::EFFECTS.cover(COMPOUND) { self.owners[primitive as usize] } else { primitive }
    }

    /// Whether a primitive of the kinds in `X` is on the ray nearer than `limit`.
    #[inline(always)]
    pub fn is_blocked<X: EffectSet>(
        &self,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        limit: f64,
        tests: &mut Tests,
    ) -> bool {
        self.first::<X>(ray, from, limit, tests).is_some()
    }

    /// Whether any primitive is on the ray nearer than `limit`; this crate compiles it, like [`Self::first_of_any`].
    pub fn is_blocked_by_any(&self, ray: &Ray, from: Option<SurfaceOrigin>, limit: f64) -> bool {
        self.is_blocked::<AllEffects>(ray, from, limit, &mut Tests::default())
    }

    /// Returns the scene in thermal equilibrium. Every surface emits exactly the light that it does not reflect: 1 -
    /// albedo, by the angle where that matters. Fog glows, a background is white, and there are no point lights. The
    /// radiance is then 1 everywhere, in every direction: an exact expectation for every pixel.
    #[must_use]
    pub fn in_equilibrium(&self) -> Self {
        let rest = |share: Rgb| Rgb { r: 1.0 - share.r, g: 1.0 - share.g, b: 1.0 - share.b };
        let mut scene = self.clone();
        for object in &mut scene.objects {
            object.emission = rest(object.material.albedo::<AllEffects>());
            object.angular_emission = AngularEmission::tabulate(|cos| object.material.albedo_at(cos).map(rest));
        }
        scene.background = scene.background.map(|_| Rgb::WHITE);
        scene.fog = scene.fog.map(|fog| Fog { emission: Rgb::WHITE, ..fog });
        scene.point_lights.clear();
        scene.lights = None;
        scene
    }

    /// Returns the scene with every length multiplied by `factor`. A power of two must give the same bits.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let mut scene = self.clone();
        scene.camera = scene.camera.scaled(factor);
        scene.primitives = scene.primitives.scaled(factor);
        scene.point_lights = scene.point_lights.iter().map(|light| light.scaled(factor)).collect();
        scene.fog = scene.fog.map(|fog| fog.scaled(factor));
        scene.faults = scene.faults.map(|faults| faults.scaled(factor));
        scene.hierarchy = scene.hierarchy.map(|hierarchy| hierarchy.scaled(factor));
        scene.lights = None;
        scene
    }

    /// Returns the scene with its lights for next-event estimation, as paths from that view can reach them.
    #[must_use]
    pub fn lit(&self, view: &View) -> Self {
        Self { lights: Some(self.lights_for(view)), ..self.clone() }
    }

    /// Returns the lights for next-event estimation, as paths from that view can reach them.
    pub fn lights_for(&self, view: &View) -> Lights {
        Lights::of(self, &view.origins())
    }

    /// Returns the scene with the accelerator of that name; `None` if that builds no hierarchy.
    pub fn accelerated(&self, name: &str) -> Option<Self> {
        let hierarchy = self.hierarchy_by(name)?;
        Some(Self { hierarchy: Some(hierarchy), ..self.clone() })
    }

    /// Returns the hierarchy of that accelerator over its primitives; `None` if the accelerator builds none.
    pub fn hierarchy_by(&self, name: &str) -> Option<Hierarchy> {
        accelerator(Some(name), 0, Scan::OneByOne)?.build(self.primitives.bounds())
    }
}
