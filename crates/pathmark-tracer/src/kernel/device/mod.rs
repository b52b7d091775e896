//! `--kernel device`: pieces are rendered by a GPU, by CUDA or OpenCL, or by whatever else compiles the program in `program/`.
//!
//! The program is the scalar kernel's path in the common subset of C, OpenCL C and CUDA C, one operation for one operation, so an image has the same
//! bits on every device and on the processor; in single precision the path is that of lanes. It is compiled for an effect profile, as scalar kernels
//! are, when a kernel is made. Numbers that the scalar kernel has in tables are written into it from those ([`program`]); the scene goes to the device
//! as arrays ([`tables`]). A launch is so many items ([`items`]) as take a quarter of a second, because drivers of displays end longer ones.

mod choice;
mod items;
mod program;
mod tables;

use super::{Choice, Counts, Kernel};
use crate::error::{Error, Result};
use crate::film::{Piece, SAMPLE_BLOCK, TileBuffer};
use crate::scene::Scene;
use crate::simd::Precision;
pub(super) use choice::{ForDevice, device_for, missing};
use items::{Items, OUT_WORDS, Placing};
use pathmark_device::{Costs, DeviceError, Loaded};
use std::io;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Seconds that a launch is to take.
const LAUNCH_S: f64 = 0.25;
/// Samples of the first launch, of which nobody knows how long they take.
const FIRST_SAMPLES: u64 = 1 << 14;
/// Items of a launch at most: their results take 24 MiB.
const MOST_ITEMS: u64 = 1 << 18;
/// Blocks of samples in an item at most, as a power of two.
const MOST_BLOCKS: u32 = 8;

/// The kernel.
pub(super) struct OnDevice {
    id: String,
    loaded: Box<dyn Loaded>,
    /// Items that keep the device busy.
    width: u32,
    /// Samples a second of the last launch, as bits; 0 before it.
    rate: AtomicU64,
    /// Launches so far, and microseconds that they took, with copies of their results.
    launches: AtomicU64,
    launches_us: AtomicU64,
    failed: OnceLock<DeviceError>,
}

/// A failure of a device, which is the system's.
fn system(id: &str, error: &DeviceError) -> Error {
    Error::system("rendering on", id, io::Error::other(error.to_string()))
}

impl OnDevice {
    pub(super) fn new(scene: &Scene, choice: &Choice, chosen: &ForDevice) -> Result<Self> {
        let Some(id) = chosen.id.clone() else { return Err(missing(&chosen.kernel)) };
        let failed = |error: DeviceError| system(&id, &error);
        let device = pathmark_device::open(&id).map_err(failed)?;
        let (numbers, words) = tables::of(scene, choice, chosen);
        let text = program::text(choice.profile.effects, &chosen.rules, chosen.precision);
        let uses_single = chosen.precision == Precision::F32;
        let loaded = device.load(&text, uses_single, &numbers, &words).map_err(failed)?;
        let width = device.width();
        let none = || AtomicU64::new(0);
        let (rate, launches, launches_us) = (none(), none(), none());
        Ok(Self { id, loaded, width, rate, launches, launches_us, failed: OnceLock::new() })
    }

    /// The samples of an item: as many blocks, a power of two, as leave the device enough items.
    fn part_samples(&self, pieces: &[&Piece]) -> u32 {
        let enough = |part: u32| Items::new(pieces, part).count >= u64::from(self.width);
        let samples = pieces.iter().map(|piece| piece.samples.end - piece.samples.start).max().unwrap_or_default();
        let mut sizes = (0..=MOST_BLOCKS).rev().map(|level| SAMPLE_BLOCK << level);
        // No larger than it needs to be: parts are what a launch ends at.
        sizes.find(|part| *part < 2 * samples.max(SAMPLE_BLOCK) && enough(*part)).unwrap_or(SAMPLE_BLOCK)
    }

    /// Items of the next launch.
    fn items(&self, part: u32) -> u64 {
        let rate = f64::from_bits(self.rate.load(Ordering::Relaxed));
        let samples = if rate > 0.0 { (rate * LAUNCH_S) as u64 } else { FIRST_SAMPLES };
        (samples / u64::from(part)).clamp(1, MOST_ITEMS)
    }

    fn launch_all(&self, pieces: &[&Piece], out: &mut [TileBuffer]) -> std::result::Result<Vec<Counts>, DeviceError> {
        let items = Items::new(pieces, self.part_samples(pieces));
        let mut placing = Placing::new(&items, out);
        let (mut done, mut results) = (0, Vec::new());
        while done < items.count {
            let of_launch = self.items(items.part).min(items.count - done);
            results.resize(of_launch as usize * OUT_WORDS, 0);
            let seconds = self.loaded.timed(&items.task(done), of_launch as u32, &mut results)?;
            let rate = (of_launch * u64::from(items.part)) as f64 / seconds.max(1e-6);
            self.rate.store(rate.to_bits(), Ordering::Relaxed);
            self.launches.fetch_add(1, Ordering::Relaxed);
            self.launches_us.fetch_add((seconds * 1e6) as u64, Ordering::Relaxed);
            results.chunks_exact(OUT_WORDS).for_each(|words| placing.put(words));
            done += of_launch;
        }
        Ok(placing.counts)
    }
}

impl Kernel for OnDevice {
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        if piece.samples.is_empty() || piece.bounds.area() == 0 {
            return Counts::default();
        }
        self.render_all(&[piece], std::slice::from_mut(out)).first().copied().unwrap_or_default()
    }

    /// Once the device has failed, nothing more is asked of it.
    fn render_all(&self, pieces: &[&Piece], out: &mut [TileBuffer]) -> Vec<Counts> {
        let nothing = || vec![Counts::default(); pieces.len()];
        if self.failed.get().is_some() {
            return nothing();
        }
        self.launch_all(pieces, out).unwrap_or_else(|error| {
            self.failed.get_or_init(|| error);
            nothing()
        })
    }

    fn remarks(&self) -> Vec<String> {
        let Costs { compile_s, copy_s } = self.loaded.costs();
        let launches = self.launches.load(Ordering::Relaxed);
        let launches_s = self.launches_us.load(Ordering::Relaxed) as f64 * 1e-6;
        vec![format!(
            "{}: compiled in {compile_s:.3} s, scene copied in {copy_s:.6} s, {launches} launches in {launches_s:.3} s",
            self.id
        )]
    }

    fn costs(&self) -> Option<Costs> {
        Some(self.loaded.costs())
    }

    fn failure(&self) -> Option<Error> {
        self.failed.get().map(|error| system(&self.id, error))
    }
}
