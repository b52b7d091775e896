//! Shapes and primitives. Rays are tested against *primitives*; each kind has its own array. Scene files name *shapes*;
//! each becomes one or more primitives.
//!
//! To add a shape that is made of primitives: write its file with a type that implements [`Shape`] and `Deserialize`,
//! and give it a line in `shapes!` below. A new kind of primitive also implements [`Primitive`] and has a line in
//! `primitives!`.
//!
//! Primitives are numbered kind by kind, in the order of the table, and within a kind in the order of the scene. Among
//! equally near primitives, the one with the lowest number is hit, with any accelerator.

mod doubt;
mod foreign;
mod mesh;
mod obj;
mod placement;
mod plane;
mod ply;
mod polygon;
mod quad;
mod sphere;
mod triangle;

use super::hierarchy::{Bounds, Hierarchy, Tests};
use super::{HIERARCHY, SurfaceOrigin};
use crate::effect::{EffectSet, Effects, Entry};
use crate::error::Result;
use crate::math::{Ray, Vec3};
use crate::scene::library::Files;
pub use doubt::nearness;
pub(super) use mesh::Mesh;
pub(super) use quad::Quad;
use serde::Deserialize;

/// A surface that rays are tested against.
pub trait Primitive {
    /// The data of a ray that all primitives of the kind need, computed once.
    type Prepared: Copy;

    /// Computes the data of a ray.
    fn prepare(ray: &Ray) -> Self::Prepared;

    /// Returns the distance to the surface for a ray (of unit direction) that starts elsewhere; zero, negative or NaN
    /// if it misses.
    fn meet(&self, ray: &Ray, prepared: &Self::Prepared) -> f64;

    /// Returns the distance at which a ray that starts on the surface meets it again; NaN if it does not.
    fn leave(&self, ray: &Ray, inside: bool) -> f64;

    /// Returns the outward unit normal at a point of the surface.
    fn normal(&self, point: Vec3) -> Vec3;

    /// Returns its bounding box; `None` if it is infinite.
    fn bounds(&self) -> Option<Bounds>;

    /// Returns the primitive with every length multiplied by `factor`.
    #[must_use]
    fn scaled(&self, factor: f64) -> Self;
}

/// A shape as scene files name it.
pub(super) trait Shape {
    /// Adds its primitives. Files that it names are looked for in the scene's folder.
    fn add_to(self, primitives: &mut Primitives, files: &mut Files<'_>) -> Result<()>;
}

/// The nearest primitive so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest {
    /// Distance, in multiples of the direction's length.
    pub t: f64,
    /// Number of the primitive; `u32::MAX` if there is none.
    pub primitive: u32,
}

macro_rules! primitives {
    ($($module:ident :: $Type:ident, $field:ident, $name:literal, $about:literal;)*) => {
        $(pub use $module::$Type;)*

        #[derive(Clone, Copy)]
        enum Index { $($Type),* }

        $(impl $Type {
            pub const EFFECT: Effects = Effects::primitive(Index::$Type as u32);
        })*

        /// The kinds of primitives, in the order in which they are numbered.
        pub const PRIMITIVES: &[Entry] = &[$(Entry { name: $name, about: $about, effect: $Type::EFFECT }),*];

        /// Every primitive of a scene.
        #[derive(Debug, Clone, PartialEq, Default)]
        pub struct Primitives {
            $(#[doc = $about] pub $field: Vec<$Type>,)*
            /// Number of mesh triangles that were left out because they have no area.
            pub degenerate: usize,
        }

        /// The data of a ray for each kind of primitive.
        #[derive(Clone, Copy)]
        struct Prepared {
            $($field: <$Type as Primitive>::Prepared,)*
        }

        impl Primitives {
            /// Returns the number of primitives of each kind, in the order of the table.
            pub fn counts(&self) -> Vec<usize> {
                vec![$(self.$field.len()),*]
            }

            /// Returns the kinds that occur.
            pub fn effects(&self) -> Effects {
                let mut effects = Effects::NONE;
                $(if !self.$field.is_empty() { effects = effects.and($Type::EFFECT); })*
                effects
            }

            /// Returns the bounding boxes of all primitives in the order of their numbers; `None` for infinite ones.
            pub fn bounds(&self) -> impl Iterator<Item = Option<Bounds>> {
                std::iter::empty()$(.chain(self.$field.iter().map(Primitive::bounds)))*
            }

            /// Returns the primitives with every length multiplied by `factor`.
            #[must_use]
            pub fn scaled(&self, factor: f64) -> Self {
                Self { $($field: self.$field.iter().map(|primitive| primitive.scaled(factor)).collect(),)* degenerate: self.degenerate }
            }

            /// Returns the outward unit normal of a primitive, of a kind in `X`, at a point on it.
            #[inline(always)]
            pub fn normal<X: EffectSet>(&self, primitive: u32, point: Vec3) -> Vec3 {
                let mut index = primitive as usize;
                $(if X::EFFECTS.cover($Type::EFFECT) {
                    if let Some(primitive) = self.$field.get(index) {
                        return primitive.normal(point);
                    }
                    index -= self.$field.len();
                })*
                unreachable!("primitive {index} after the last")
            }

            /// Tests every primitive of the kinds in `X` that `is_wanted` selects, in the order of their numbers.
            #[inline(always)]
            fn scan<X: EffectSet>(
                &self,
                ray: &Ray,
                from: Option<SurfaceOrigin>,
                mut nearest: Nearest,
                is_wanted: impl Fn(Effects) -> bool,
            ) -> Nearest {
                let own = from.map_or(u32::MAX, |from| from.primitive);
                let inside = from.is_some_and(|from| from.inside);
                let mut first = 0_u32;
                $(if X::EFFECTS.cover($Type::EFFECT) {
                    if is_wanted($Type::EFFECT) {
                        let prepared = $Type::prepare(ray);
                        let own = own.wrapping_sub(first);
                        let leave = self.$field.get(own as usize).map_or(f64::NAN, |own| own.leave(ray, inside));
                        for (index, primitive) in (0_u32..).zip(&self.$field) {
                            let meet = primitive.meet(ray, &prepared);
                            nearest = nearest.or(if index == own { leave } else { meet }, first + index);
                        }
                    }
                    first += self.$field.len() as u32;
                })*
                // It is not read after the last kind.
                let _ = first;
                nearest
            }

            #[inline(always)]
            fn prepare(ray: &Ray) -> Prepared {
                Prepared { $($field: $Type::prepare(ray)),* }
            }

            /// Returns the distance to one primitive, of a kind in `X`, for a ray that starts on it or elsewhere.
            #[inline(always)]
            fn distance<X: EffectSet>(
                &self,
                primitive: u32,
                ray: &Ray,
                prepared: &Prepared,
                from: Option<SurfaceOrigin>,
            ) -> f64 {
                let mut index = primitive as usize;
                $(if X::EFFECTS.cover($Type::EFFECT) {
                    if let Some(found) = self.$field.get(index) {
                        return match from {
                            Some(from) if from.primitive == primitive => found.leave(ray, from.inside),
                            _ => found.meet(ray, &prepared.$field),
                        };
                    }
                    index -= self.$field.len();
                })*
                unreachable!("primitive {index} after the last")
            }
        }

        $(impl Shape for $Type {
            fn add_to(self, primitives: &mut Primitives, _files: &mut Files<'_>) -> Result<()> {
                primitives.$field.push(self);
                Ok(())
            }
        })*
    };
}

primitives! {
    sphere::Sphere, spheres, "sphere", "spheres";
    plane::Plane, planes, "plane", "infinite planes";
    triangle::Triangle, triangles, "triangle", "triangles, including those of quads and meshes";
}

macro_rules! shapes {
    ($($Type:ident, $name:literal, $about:literal;)*) => {
        /// Any shape. In a scene file: `shape = { sphere = { center = [0.0, 0.0, 0.0], radius = 1.0 } }`.
        #[derive(Debug, Clone, Deserialize)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub(super) enum AnyShape {
            $(#[doc = $about] $Type($Type)),*
        }

        impl AnyShape {
            pub(super) fn add_to(self, primitives: &mut Primitives, files: &mut Files<'_>) -> Result<()> {
                match self { $(Self::$Type(shape) => shape.add_to(primitives, files)),* }
            }
        }

        /// Name and description of the shapes that scene files can name.
        pub const SHAPES: &[(&str, &str)] = &[$(($name, $about)),*];
    };
}

shapes! {
    Sphere, "sphere", "a sphere";
    Plane, "plane", "an infinite plane";
    Triangle, "triangle", "a triangle";
    Quad, "quad", "four corners: two triangles";
    Mesh, "mesh", "the triangles of an OBJ or PLY file, or of one object of an OBJ file";
}

impl Nearest {
    /// Returns a search's initial state: no primitive, and only hits nearer than `t` count.
    #[inline(always)]
    pub fn than(t: f64) -> Self {
        Self { t, primitive: u32::MAX }
    }

    /// Returns the nearer of this one and a primitive with a higher number. NaN, zero and negative distances are no
    /// hits. It uses selections, because the processor cannot predict which is nearer: wrong predictions cost about a
    /// tenth of the kernel's time.
    #[inline(always)]
    fn or(self, distance: f64, primitive: u32) -> Self {
        let ahead = if distance > 0.0 { distance } else { f64::INFINITY };
        Self {
            primitive: if ahead < self.t { primitive } else { self.primitive },
            t: if ahead < self.t { ahead } else { self.t },
        }
    }

    /// Likewise, for primitives in any order. A hit exactly at the initial limit, where no primitive is, does not
    /// count.
    #[inline(always)]
    #[must_use]
    pub fn or_in_any_order(self, distance: f64, primitive: u32) -> Self {
        let ahead = if distance > 0.0 { distance } else { f64::INFINITY };
        let comes_first = primitive < self.primitive && self.primitive != u32::MAX;
        let wins = ahead < self.t || (ahead == self.t && comes_first);
        if wins { Self { t: ahead, primitive } } else { self }
    }

    /// Likewise, for the primitive on which a ray starts and leads inside. Its start may be rounded to outside the box
    /// of that primitive, so a search in a hierarchy begins with it.
    #[inline(always)]
    #[must_use]
    pub fn or_own(self, from: Option<SurfaceOrigin>, distance: impl FnOnce(u32) -> f64) -> Self {
        match from {
            Some(SurfaceOrigin { primitive, inside: true }) => self.or_in_any_order(distance(primitive), primitive),
            _ => self,
        }
    }
}

impl Primitives {
    /// Returns the first primitive of the kinds in `X` along the ray that is nearer than `limit`. `from` is the ray's
    /// start, if it is on a primitive.
    #[inline(always)]
    pub(super) fn nearest<X: EffectSet>(
        &self,
        hierarchy: Option<&Hierarchy>,
        ray: &Ray,
        from: Option<SurfaceOrigin>,
        limit: f64,
        tests: &mut Tests,
    ) -> Nearest {
        let none = Nearest::than(limit);
        if X::EFFECTS.cover(HIERARCHY)
            && let Some(hierarchy) = hierarchy
        {
            let prepared = Self::prepare(ray);
            let distance = |primitive| self.distance::<X>(primitive, ray, &prepared, from);
            let beside = self.endless::<X>(ray, from, none).or_own(from, distance);
            return hierarchy.nearest(ray, beside, tests, distance);
        }
        self.scan::<X>(ray, from, none, |_| true)
    }

    /// Returns the nearest infinite primitive, which is too large for a hierarchy.
    #[inline(always)]
    fn endless<X: EffectSet>(&self, ray: &Ray, from: Option<SurfaceOrigin>, none: Nearest) -> Nearest {
        self.scan::<X>(ray, from, none, |kind| kind == Plane::EFFECT)
    }
}
