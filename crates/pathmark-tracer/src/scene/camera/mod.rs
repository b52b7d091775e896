//! Cameras, each with its pixel filter. Each kind has its own file; this file is their table and their common part:
//! image rows are level, and sample k of a pixel is one ray.
//!
//! To add one: write its file with a type that implements `Into<Camera>` and `Deserialize` and has an `EXAMPLE`, and give it its `mod` and a
//! line in `cameras!` below.

mod pinhole;
mod smallpt;
mod thin_lens;

use crate::effect::{EffectSet, Effects};
use crate::math::{Ray, Real, Vec3};
use crate::sampling::{concentric_disk, tent};
use crate::scene::LENS;
use serde::Deserialize;

/// Any camera, after it has been read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The pinhole, or the middle of the lens.
    pub position: Vec3,
    /// The direction to the centre of the view, of length 1.
    pub direction: Vec3,
    /// The approximate upward direction.
    pub up: Vec3,
    /// Height of the image plane at distance 1.
    pub field: f64,
    /// The distance along its direction at which a ray starts, so that it can start inside a closed box.
    pub advance: f64,
    /// The distribution of samples over a pixel.
    pub filter: Filter,
    /// The lens; a pinhole if `None`.
    pub lens: Option<Lens>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    pub radius: f64,
    /// Distance of the plane in focus, along the view direction.
    pub focus: f64,
}

/// The distribution of samples over a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Filter {
    /// smallpt's: a tent over each of 2x2 subpixels; sample k is in subpixel k mod 4.
    Tent,
    /// Uniform over the pixel.
    Box,
    /// Every sample at the pixel's centre.
    Center,
}

/// One line of the table of filters.
pub struct FilterEntry {
    /// Its name on the command line and in records.
    pub name: &'static str,
    /// Its distribution of samples, in one line.
    pub about: &'static str,
    pub filter: Filter,
}

/// The pixel filters, in the order in which they are listed.
pub const FILTERS: &[FilterEntry] = &[
    FilterEntry { name: "tent", about: "smallpt's filter: a tent over each of 2x2 subpixels", filter: Filter::Tent },
    FilterEntry { name: "box", about: "uniform over the pixel", filter: Filter::Box },
    FilterEntry {
        name: "center",
        about: "every ray through the centre of the pixel (report B)",
        filter: Filter::Center,
    },
];

impl Filter {
    pub fn name(self) -> &'static str {
        FILTERS.iter().find(|entry| entry.filter == self).map_or("", |entry| entry.name)
    }
}

/// Subpixels in a pixel: 2 by 2.
pub const SUBPIXELS: u32 = 4;

macro_rules! cameras {
    ($($module:ident :: $Type:ident, $name:literal, $about:literal;)*) => {
        /// Name and description of the cameras, in the order in which they are listed.
        pub const CAMERAS: &[(&str, &str)] = &[$(($name, $about)),*];

        /// An example of each kind, as scene files write it, for the checks of hard cases.
        pub const CAMERA_EXAMPLES: &[&str] = &[$($module::$Type::EXAMPLE),*];

        /// A camera as scene files name it.
        #[derive(Deserialize)]
        #[serde(deny_unknown_fields, rename_all = "kebab-case")]
        pub(super) enum CameraFile {
            $($Type($module::$Type)),*
        }

        impl From<CameraFile> for Camera {
            fn from(file: CameraFile) -> Self {
                match file { $(CameraFile::$Type(camera) => camera.into()),* }
            }
        }
    };
}

cameras! {
    smallpt::Smallpt, "smallpt", "smallpt's camera: rays start in front of the pinhole, with a tent filter on 2x2 subpixels";
    pinhole::Pinhole, "pinhole", "a pinhole that looks at a point";
    thin_lens::ThinLens, "thin-lens", "a lens that is in focus at one distance only";
}

/// A camera set up for an image size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    pub camera: Camera,
    pub filter: Filter,
    /// Across the image plane, from left to right.
    pub right: Vec3,
    /// Across the image plane, from bottom to top.
    pub up: Vec3,
    width: f64,
    height: f64,
    rows: u32,
}

impl Camera {
    pub fn effects(&self) -> Effects {
        if self.lens.is_some() { LENS } else { Effects::NONE }
    }

    /// Sets up the image plane for `width` x `height` pixels.
    pub fn view(&self, width: u32, height: u32) -> View {
        let (w, h) = (f64::from(width), f64::from(height));
        let side = match self.filter {
            // The rows of smallpt's camera lie along the x axis, exactly.
            Filter::Tent => Vec3::new(1.0, 0.0, 0.0),
            Filter::Box | Filter::Center => self.direction.cross(self.up).normalized(),
        };
        let right = side * (w * self.field / h);
        let up = right.cross(self.direction).normalized() * self.field;
        View { camera: *self, filter: self.filter, right, up, width: w, height: h, rows: height }
    }

    /// Returns the camera with every length multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let lens = self.lens.map(|lens| Lens { radius: lens.radius * factor, focus: lens.focus * factor });
        Self { position: self.position * factor, advance: self.advance * factor, lens, ..*self }
    }
}

/// Returns column and row of the subpixel that a sample belongs to; filters without subpixels ignore them.
#[inline(always)]
fn subpixel(sample: u32) -> [f64; 2] {
    let number = sample % SUBPIXELS;
    [number % 2, number / 2].map(f64::from)
}

impl View {
    /// Returns the view with another filter, if one is given.
    #[must_use]
    pub fn filtered(self, filter: Option<Filter>) -> Self {
        Self { filter: filter.unwrap_or(self.filter), ..self }
    }

    /// Returns the starts of nine rays from the centre of the lens: through the corners of the image, the midpoints of
    /// its edges and its centre.
    pub fn origins(&self) -> [Vec3; 9] {
        std::array::from_fn(|k| {
            let (across, upward) = ((k % 3) as f64 / 2.0 - 0.5, (k / 3) as f64 / 2.0 - 0.5);
            let towards = self.right * across + self.up * upward + self.camera.direction;
            self.camera.position + towards.normalized() * self.camera.advance
        })
    }

    /// Returns the starts of many rays: all over the image and as far beyond its edges as the filter reaches, a quarter
    /// of a pixel.
    pub fn starts(&self) -> Vec<Vec3> {
        const STEPS: u32 = 32;
        let place = |k: u32, pixels: f64| (f64::from(k) / f64::from(STEPS) - 0.5) * (1.0 + 0.5 / pixels);
        let places = (0..=STEPS).flat_map(|row| (0..=STEPS).map(move |column| (column, row)));
        let starts = places.map(|(column, row)| {
            let (across, upward) = (place(column, self.width), place(row, self.height));
            let towards = self.right * across + self.up * upward + self.camera.direction;
            self.camera.position + towards.normalized() * self.camera.advance
        });
        starts.collect()
    }

    /// Returns the ray of sample `sample` through pixel (`x`, `y`), row 0 at the top. The random numbers `film` place
    /// it in the pixel, and `lens` places it on the lens. `lens` is called only if there is one.
    ///
    /// The direction is normalised before the ray is advanced. g++ happens to evaluate smallpt's expression in that order; the other
    /// order starts rays above the ceiling and lights the top rows.
    #[inline(always)]
    pub fn ray<X: EffectSet>(
        &self,
        x: u32,
        y: u32,
        sample: u32,
        film: [f64; 2],
        lens: impl FnOnce() -> [f64; 2],
    ) -> Ray {
        let towards = self.towards([x, y].map(f64::from), subpixel(sample), film);
        if X::EFFECTS.cover(LENS)
            && let Some(Lens { radius, focus }) = self.camera.lens
        {
            let [u, v] = concentric_disk(lens());
            let (right, up) = (self.right.normalized(), self.up.normalized());
            let offset = right * (u * radius) + up * (v * radius);
            let direction = (towards * focus - offset).normalized();
            return Ray { origin: self.camera.position + offset + direction * self.camera.advance, direction };
        }
        self.pinhole_ray(towards)
    }

    /// Returns the direction, of any length, through a place in pixel (`x`, `y`).
    #[inline(always)]
    fn towards<T: Real>(&self, [x, y]: [T; 2], subpixel: [T; 2], film: [T; 2]) -> Vec3<T> {
        let (half, two) = (T::splat(0.5), T::splat(2.0));
        let [dx, dy] = match self.filter {
            Filter::Tent => [(subpixel[0] + half + tent(film[0])) / two, (subpixel[1] + half + tent(film[1])) / two],
            Filter::Box => film,
            Filter::Center => [half, half],
        };
        let row = T::splat(f64::from(self.rows - 1)) - y;
        let across = (dx + x) / T::splat(self.width) - half;
        let upward = (dy + row) / T::splat(self.height) - half;
        Vec3::splat(self.right) * across + Vec3::splat(self.up) * upward + Vec3::splat(self.camera.direction)
    }

    #[inline(always)]
    fn pinhole_ray<T: Real>(&self, towards: Vec3<T>) -> Ray<T> {
        let direction = towards.normalized();
        let start = direction * T::splat(self.camera.advance);
        Ray { origin: Vec3::splat(self.camera.position) + start, direction }
    }

    /// [`View::ray`] without a lens, in lanes. `subpixel` is the sample's number modulo [`SUBPIXELS`].
    #[inline(always)]
    pub fn rays<T: Real>(&self, pixel: [T; 2], subpixel: T, film: [T; 2]) -> Ray<T> {
        let (one, two) = (T::splat(1.0), T::splat(2.0));
        let upper = two.le(subpixel);
        let column = T::select(upper, subpixel - two, subpixel);
        let row = T::select(upper, one, T::splat(0.0));
        self.pinhole_ray(self.towards(pixel, [column, row], film))
    }
}
