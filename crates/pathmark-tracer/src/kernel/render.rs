//! The interface of a kernel: pieces in, sums and counts out.

use crate::error::Error;
use crate::film::{Bounds, Piece, TileBuffer};
use serde::{Deserialize, Serialize};

/// Counts of the events while a piece was rendered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Counts {
    /// Samples.
    pub paths: u64,
    pub rays: u64,
    /// Samples that were NaN, infinite or negative; they contribute nothing.
    pub invalid: u64,
    /// Rays of paths that met no primitive.
    pub escaped: u64,
    /// Paths cut at the bounce limit.
    pub truncated: u64,
    /// Tests of a ray against a bounding box.
    pub box_tests: u64,
    /// Tests of a ray against a primitive of a hierarchy. Without one, every ray is tested against all primitives.
    pub primitive_tests: u64,
}

impl Counts {
    /// Adds the counts of another piece.
    pub fn add(&mut self, other: &Self) {
        self.paths += other.paths;
        self.rays += other.rays;
        self.invalid += other.invalid;
        self.escaped += other.escaped;
        self.truncated += other.truncated;
        self.box_tests += other.box_tests;
        self.primitive_tests += other.primitive_tests;
    }
}

/// Renders pieces. With a deterministic sampler, the same piece has the same bits for every caller.
pub trait Kernel: Send + Sync {
    /// Renders the samples of the piece into the buffer, which has the piece's columns and at least its rows.
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts;

    fn render_all(&self, pieces: &[&Piece], out: &mut [TileBuffer]) -> Vec<Counts> {
        pieces.iter().zip(out).map(|(piece, out)| self.render(piece, out)).collect()
    }

    /// Devices that render pieces while the callers of this kernel render others.
    fn beside(&self) -> Vec<&dyn Kernel> {
        Vec::new()
    }

    /// Remarks for the user on the rendering, besides counts.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Time spent on programs for devices, if the kernel has any.
    fn costs(&self) -> Option<DeviceCosts> {
        None
    }

    /// The system error that prevented the rendering of pieces, if any. Their buffers are then invalid.
    fn failure(&self) -> Option<Error> {
        None
    }
}

/// Seconds that a kernel spent before its first launch on a device.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DeviceCosts {
    /// Compilation of the program.
    pub compile_s: f64,
    /// Copying of the scene.
    pub copy_s: f64,
}

/// Renders a single sample. Returns its contribution to the image's sum, and its counts. Its bits are the same as in a
/// whole image.
pub fn one_sample(kernel: &dyn Kernel, [x, y]: [u32; 2], sample: u32) -> ([f64; 3], Counts) {
    let bounds = Bounds { x0: x, y0: y, x1: x + 1, y1: y + 1 };
    let mut buffer = TileBuffer::new(bounds);
    let counts = kernel.render(&Piece { bounds, samples: sample..sample + 1 }, &mut buffer);
    (buffer.row_mut(y)[0].sum, counts)
}
