//! Metrics of the difference between a picture and a reference. [`METRICS`] lists the single values; [`cross_mse`] uses
//! two references, to exclude their noise; [`heatmap`] and [`flip_map`] return pictures.
//!
//! The error of a Monte Carlo estimate is the error of linear radiance: `linear` metrics fall with growing spp as
//! theory predicts. The others compare display values (clamp and gamma, [`crate::image_io::tone_map`]), which bend the
//! curve where pixels saturate. They are there for comparison with reports that measured pictures.
//!
//! A NaN in either picture makes every metric that uses it NaN. Pictures of different sizes are an [`InputError`].

mod cross;
mod flip;
mod heatmap;
mod pointwise;
mod separable;
mod ssim;

pub use cross::{
    bias_squared, brighter_pixels, cross_mse, cross_mse_display, cross_products, cross_rel_mse, root, share_within,
};
pub use flip::flip_map;
pub use heatmap::{Heatmap, heat_colour, heatmap};
pub use pointwise::REL_MSE_EPSILON;
use pointwise::percentile;

use crate::error::{InputError, Result};
use crate::image_io::Image;

/// A metric: one value that compares two pictures.
#[derive(Debug)]
pub struct Entry {
    /// Its name on the command line and in tables.
    pub name: &'static str,
    pub about: &'static str,
    /// Whether it measures linear radiance; otherwise display values.
    pub linear: bool,
    /// Its value for equal pictures.
    pub best: f64,
    formula: Formula,
}

impl Entry {
    pub fn compute(&self, test: &Image, reference: &Image) -> Result<f64> {
        check_sizes(test, reference)?;
        Ok((self.formula)(test, reference))
    }
}

type Formula = fn(&Image, &Image) -> f64;

/// An error of linear radiance, 0 for equal pictures.
const fn error(name: &'static str, about: &'static str, formula: Formula) -> Entry {
    Entry { name, about, linear: true, best: 0.0, formula }
}

const fn displayed(name: &'static str, about: &'static str, best: f64, formula: Formula) -> Entry {
    Entry { name, about, linear: false, best, formula }
}

pub const METRICS: &[Entry] = &[
    error("mse", "mean squared error over pixels and channels", pointwise::mse),
    error("rmse", "root of the mean squared error over pixels and channels", |t, r| pointwise::mse(t, r).sqrt()),
    error("rel-mse", "mean of the squared error over (squared reference + 0.01)", pointwise::rel_mse),
    error("mae", "mean absolute error over pixels and channels", pointwise::mae),
    error("error-50", "half of the pixels have at most this error (root of its mean square over channels)", |t, r| {
        percentile(0.5, t, r)
    }),
    error("error-90", "90 % of the pixels have at most this error", |t, r| percentile(0.9, t, r)),
    error("error-99", "99 % of the pixels have at most this error", |t, r| percentile(0.99, t, r)),
    error("error-100", "the largest error of a pixel", |t, r| percentile(1.0, t, r)),
    displayed("rmse-display", "rmse of display values in [0, 1]", 0.0, |t, r| pointwise::mse_display(t, r).sqrt()),
    displayed("psnr", "peak signal-to-noise ratio of display values, in dB", f64::INFINITY, pointwise::psnr),
    displayed(
        "flip",
        "visible difference, 0 to 1, when flipping between both on a display (Andersson and others 2020)",
        0.0,
        flip::flip,
    ),
    displayed("ssim", "structural similarity of display luma; 1 is equal, NaN below 11 x 11 pixels", 1.0, ssim::ssim),
];

pub fn find(name: &str) -> Result<&'static Entry> {
    METRICS.iter().find(|entry| entry.name == name).ok_or_else(|| {
        let names: Vec<_> = METRICS.iter().map(|entry| entry.name).collect();
        InputError::new("metric", name, "there is no such metric").allowed(names.join(", ")).into()
    })
}

/// Refuses pictures of different sizes, since pictures are compared pixel by pixel.
fn check_sizes(test: &Image, reference: &Image) -> Result<()> {
    let size = |image: &Image| format!("{}x{}", image.width, image.height);
    if size(test) != size(reference) {
        let problem = format!("is not the size of the reference, {}", size(reference));
        return Err(InputError::new("size", size(test), problem).allowed("pictures of the same size").into());
    }
    Ok(())
}
