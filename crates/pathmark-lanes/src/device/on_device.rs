//! The kernel: launches of items, and the counts of what they took.

use super::items::{Items, MOST_BLOCKS, OUT_WORDS, Placing};
use super::plan::{ForDevice, missing};
use super::program;
use super::tables;
use pathmark_device::{DeviceError, Loaded};
use pathmark_tracer::error::{Error, Result};
use pathmark_tracer::film::{Piece, SAMPLE_BLOCK, TileBuffer};
use pathmark_tracer::kernel::{Counts, DeviceCosts, Kernel, RenderOptions};
use pathmark_tracer::math::Precision;
use pathmark_tracer::scene::Scene;
use std::io;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Target duration of a launch, in seconds.
const LAUNCH_S: f64 = 0.25;
/// Samples of the first launch, when the device's speed is unknown.
const FIRST_SAMPLES: u64 = 1 << 14;
/// Most items in a launch: their results take 24 MiB.
const MOST_ITEMS: u64 = 1 << 18;
pub(super) struct OnDevice {
    id: String,
    loaded: Box<dyn Loaded>,
    /// Number of items that keeps the device busy.
    width: u32,
    /// Samples per second of the last launch, as bits; 0 before the first.
    rate: AtomicU64,
    /// Number of launches so far, and their microseconds, with the copying of results.
    launches: AtomicU64,
    launches_us: AtomicU64,
    failed: OnceLock<DeviceError>,
}

/// A failure of a device as an error of the system.
fn system(id: &str, error: &DeviceError) -> Error {
    Error::system("rendering on", id, io::Error::other(error.to_string()))
}

impl OnDevice {
    pub(super) fn new(scene: &Scene, options: &RenderOptions, chosen: &ForDevice) -> Result<Self> {
        let Some(id) = chosen.id.clone() else { return Err(missing(&chosen.kernel)) };
        let failed = |error: DeviceError| system(&id, &error);
        let device = pathmark_device::open(&id).map_err(failed)?;
        let (numbers, words) = tables::of(scene, options, chosen);
        let text = program::text(options.profile.effects, &chosen.rules, chosen.precision);
        let uses_single = chosen.precision == Precision::F32;
        let loaded = device.load(&text, uses_single, &numbers, &words).map_err(failed)?;
        let width = device.width();
        let none = || AtomicU64::new(0);
        let (rate, launches, launches_us) = (none(), none(), none());
        Ok(Self { id, loaded, width, rate, launches, launches_us, failed: OnceLock::new() })
    }

    /// The samples of an item: the most blocks, by powers of two, that still leave the device enough items.
    fn part_samples(&self, pieces: &[&Piece]) -> u32 {
        let enough = |part: u32| Items::new(pieces, part).count >= u64::from(self.width);
        let samples = pieces.iter().map(|piece| piece.samples.end - piece.samples.start).max().unwrap_or_default();
        let mut sizes = (0..=MOST_BLOCKS).rev().map(|level| SAMPLE_BLOCK << level);
        // No larger than needed: a launch ends only at the end of a part.
        sizes.find(|part| *part < 2 * samples.max(SAMPLE_BLOCK) && enough(*part)).unwrap_or(SAMPLE_BLOCK)
    }

    /// Number of items in the next launch.
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

    /// Once the device has failed, it gets no more launches.
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
        let pathmark_device::Costs { compile_s, copy_s } = self.loaded.costs();
        let launches = self.launches.load(Ordering::Relaxed);
        let launches_s = self.launches_us.load(Ordering::Relaxed) as f64 * 1e-6;
        vec![format!(
            "{}: compiled in {compile_s:.3} s, scene copied in {copy_s:.6} s, {launches} launches in {launches_s:.3} s",
            self.id
        )]
    }

    fn costs(&self) -> Option<DeviceCosts> {
        let pathmark_device::Costs { compile_s, copy_s } = self.loaded.costs();
        Some(DeviceCosts { compile_s, copy_s })
    }

    fn failure(&self) -> Option<Error> {
        self.failed.get().map(|error| system(&self.id, error))
    }
}
