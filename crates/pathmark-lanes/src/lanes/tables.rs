//! Tables in which lanes look up primitives and objects: rows of four numbers.

use crate::simd::{Column, Float, Table};
use pathmark_tracer::material::{Fresnel, Material};
use pathmark_tracer::math::{Precision, Rgb, SphereByCurvature, Vec3};
use pathmark_tracer::scene::{AllEffects, Bounds, Object, Scene};

/// Surfaces by the code with which lanes shade them, as a number in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Diffuse = 0,
    Mirror = 1,
    Dielectric = 2,
    /// Shaded one lane after the other, by the material's own code.
    Other = 3,
}

impl Kind {
    fn of(material: &Material) -> Self {
        match material {
            Material::Diffuse(_) => Self::Diffuse,
            Material::Mirror(_) => Self::Mirror,
            Material::Dielectric(_) => Self::Dielectric,
            _ => Self::Other,
        }
    }

    pub(super) fn number(self) -> f64 {
        f64::from(self as u8)
    }
}

/// Added to the number of a [`Kind`] if the surface emits light.
pub(super) const GIVES_OFF: f64 = 8.0;

/// Rows of [`Tables::surfaces`].
pub(crate) fn surfaces(scene: &Scene, precision: Precision) -> impl Iterator<Item = [f64; 4]> {
    let primitives = &scene.primitives;
    let round = primitives.spheres.iter().map(move |sphere| {
        let (Vec3 { x, y, z }, number) = match precision {
            Precision::F64 => (sphere.center, sphere.radius),
            Precision::F32 => {
                let curved = SphereByCurvature::of(sphere.center, sphere.radius);
                (curved.normal, curved.curvature)
            }
        };
        [x, y, z, number]
    });
    let first_flat = primitives.spheres.len() as u32;
    let nowhere = Vec3::new(0.0, 0.0, 0.0);
    let flats = (first_flat..scene.owners.len() as u32).zip(primitives.bounds().skip(first_flat as usize));
    round.chain(flats.map(move |(primitive, bounds)| {
        let Vec3 { x, y, z } = primitives.normal::<AllEffects>(primitive, nowhere);
        [x, y, z, bounds.map_or(0.0, |bounds| -bounds.largest())]
    }))
}

/// Up to this many primitives, each has its own rows for its object, its corners and its light, which takes less time.
pub(super) const MOST_ROWS: usize = 1 << 14;

pub(super) struct Tables {
    /// A sphere's centre and radius, in single precision its normal and its curvature of [`SphereByCurvature`]; a plane's normal
    /// and 0; a triangle's normal and its largest coordinate, negated.
    pub(super) surfaces: Table,
    /// The lowest and highest coordinates of triangles, in double precision and up to [`MOST_ROWS`] primitives.
    pub(super) boxes: Option<[Table; 2]>,
    /// The object of each primitive, if there are too many primitives for rows of their own. The tables below then have
    /// a row for each object.
    owners: Option<Column>,
    /// The emitted radiance.
    pub(super) emissions: Table,
    /// The albedo and the [`Kind`], plus [`GIVES_OFF`] if the surface emits light.
    pub(super) materials: Table,
    /// For dielectrics: index of refraction, its inverse, Schlick's reflectance at normal incidence, 1 for the exact
    /// formula.
    pub(super) interfaces: Table,
    /// Whether any surface is of [`Kind::Other`].
    pub(super) has_others: bool,
    pub(super) is_round: bool,
}

impl Tables {
    pub(super) fn of(scene: &Scene, precision: Precision) -> Self {
        let primitives = &scene.primitives;
        let first_flat = primitives.spheres.len() as u32;
        let everywhere = Bounds { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3] };
        let surfaces = Table::new(surfaces(scene, precision), precision);
        let are_many = scene.owners.len() > MOST_ROWS;
        let boxes = (precision == Precision::F64 && !primitives.triangles.is_empty() && !are_many).then(|| {
            let of_triangles = || {
                primitives.bounds().enumerate().map(|(primitive, bounds)| match bounds {
                    Some(bounds) if primitive >= first_flat as usize => bounds,
                    _ => everywhere,
                })
            };
            let side = |side: fn(&Bounds) -> [f64; 3]| {
                let rows = of_triangles().map(|bounds| side(&bounds)).map(|[x, y, z]| [x, y, z, 0.0]);
                Table::new(rows, precision)
            };
            [side(|bounds| bounds.low), side(|bounds| bounds.high)]
        });

        let owners = (are_many && scene.objects.len() < scene.owners.len())
            .then(|| Column::new(scene.owners.iter().map(|owner| *owner as f32)));
        let of_objects = |row: fn(&Object) -> [f64; 4]| match &owners {
            Some(_) => Table::new(scene.objects.iter().map(row), precision),
            None => Table::new(scene.owners.iter().map(|owner| row(&scene.objects[*owner as usize])), precision),
        };
        let emissions = of_objects(|object| {
            let Rgb { r, g, b } = object.emission;
            [r, g, b, 0.0]
        });
        let materials = of_objects(|object| {
            let Rgb { r, g, b } = object.material.albedo::<AllEffects>();
            let light = if object.emission.is_black() { 0.0 } else { GIVES_OFF };
            [r, g, b, Kind::of(&object.material).number() + light]
        });
        let interfaces = of_objects(|object| match &object.material {
            Material::Dielectric(glass) => {
                let root = (glass.eta - 1.0) / (glass.eta + 1.0);
                [glass.eta, 1.0 / glass.eta, root * root, f64::from(u8::from(glass.fresnel == Fresnel::Exact))]
            }
            _ => [1.0, 1.0, 0.0, 0.0],
        });
        let has_others = scene.objects.iter().any(|object| Kind::of(&object.material) == Kind::Other);
        Self { surfaces, boxes, owners, emissions, materials, interfaces, has_others, is_round: scene.is_round() }
    }

    /// The rows of primitives in the tables of emissions, materials and interfaces.
    #[inline(always)]
    pub(super) fn rows<V: Float>(&self, primitives: V) -> V {
        self.owners.as_ref().map_or(primitives, |owners| owners.at(primitives))
    }
}
