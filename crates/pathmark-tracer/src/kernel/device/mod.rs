//! `--kernel device`: pieces are rendered by a GPU, by CUDA or OpenCL, or by whatever else compiles the program in `program/`.
//!
//! The program is the scalar kernel's path in the common subset of C, OpenCL C and CUDA C, one operation for one operation, so an image has the same
//! bits on every device and on the processor. It is compiled for an effect profile, as scalar kernels are, when a kernel is made. Numbers that the
//! scalar kernel has in tables are written into it from those ([`program`]); the scene goes to the device as arrays ([`tables`]).
//!
//! An *item* is a pixel and a run of its samples that is a subtree of the film's sum. A launch is so many items as take a quarter of a second, because
//! drivers of displays end longer ones.

mod choice;
mod program;
mod tables;

use super::{Choice, Counts, Kernel};
use crate::error::{Error, Result};
use crate::film::{Piece, PixelSum, SAMPLE_BLOCK, SampleSum, TileBuffer};
use crate::scene::Scene;
pub(super) use choice::{ForDevice, device_for};
use pathmark_device::{DeviceError, Loaded};
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

/// Numbers that tell the program which items a launch is of, in the order in which `program/film.cl` reads them.
#[derive(Clone, Copy)]
#[repr(usize)]
enum Task {
    X,
    Y,
    Columns,
    FirstPixel,
    FirstPart,
    Parts,
    PartSamples,
    FirstSample,
    EndSample,
    Count,
}

/// Words that an item writes: three sums, three sums of squares, and six counts.
const OUT_WORDS: usize = 12;

/// The kernel.
pub(super) struct OnDevice {
    id: String,
    loaded: Box<dyn Loaded>,
    /// Items that keep the device busy.
    width: u32,
    /// Samples a second of the last launch, as bits; 0 before it.
    rate: AtomicU64,
    failed: OnceLock<DeviceError>,
}

/// A failure of a device, which is the system's.
fn system(id: &str, error: &DeviceError) -> Error {
    Error::system("rendering on", id, io::Error::other(error.to_string()))
}

impl OnDevice {
    pub(super) fn new(scene: &Scene, choice: &Choice, chosen: &ForDevice) -> Result<Self> {
        let failed = |error: DeviceError| system(&chosen.id, &error);
        let device = pathmark_device::open(&chosen.id).map_err(failed)?;
        let (numbers, words) = tables::of(scene, choice, chosen);
        let text = program::text(choice.profile.effects, &chosen.course, chosen.precision);
        let loaded = device.load(&text, &numbers, &words).map_err(failed)?;
        let width = device.width();
        Ok(Self { id: chosen.id.clone(), loaded, width, rate: AtomicU64::new(0), failed: OnceLock::new() })
    }

    /// The samples of an item of this piece: as many blocks, a power of two, as leave the device enough items.
    fn part_samples(&self, pixels: u64, samples: u32) -> u32 {
        let enough = |part: u32| pixels * u64::from(samples.div_ceil(part)) >= u64::from(self.width);
        let sizes = (0..=MOST_BLOCKS).rev().map(|level| SAMPLE_BLOCK << level);
        // No larger than it needs to be: parts are what a launch ends at.
        let fitting = sizes.filter(|part| *part < 2 * samples.max(SAMPLE_BLOCK));
        fitting.into_iter().find(|part| enough(*part)).unwrap_or(SAMPLE_BLOCK)
    }

    /// Items of the next launch.
    fn items(&self, part: u32) -> u64 {
        let rate = f64::from_bits(self.rate.load(Ordering::Relaxed));
        let samples = if rate > 0.0 { (rate * LAUNCH_S) as u64 } else { FIRST_SAMPLES };
        (samples / u64::from(part)).clamp(1, MOST_ITEMS)
    }

    fn render_all(&self, piece: &Piece, out: &mut TileBuffer) -> std::result::Result<Counts, DeviceError> {
        let mut counts = Counts::default();
        let (bounds, samples) = (piece.bounds, piece.samples.end - piece.samples.start);
        let pixels = bounds.area() as u64;
        if samples == 0 || pixels == 0 {
            return Ok(counts);
        }
        let part = self.part_samples(pixels, samples);
        let parts = u64::from(samples.div_ceil(part));
        let mut task = [0; Task::Count as usize];
        for (number, value) in [
            (Task::X, bounds.x0),
            (Task::Y, bounds.y0),
            (Task::Columns, bounds.width()),
            (Task::Parts, parts as u32),
            (Task::PartSamples, part),
            (Task::FirstSample, piece.samples.start),
            (Task::EndSample, piece.samples.end),
        ] {
            task[number as usize] = value;
        }
        let (mut done, all) = (0_u64, pixels * parts);
        let (mut results, mut sum) = (Vec::new(), SampleSum::default());
        while done < all {
            let items = self.items(part).min(all - done);
            task[Task::FirstPixel as usize] = (done / parts) as u32;
            task[Task::FirstPart as usize] = (done % parts) as u32;
            results.resize(items as usize * OUT_WORDS, 0);
            let seconds = self.loaded.timed(&task, items as u32, &mut results)?;
            let rate = (items * u64::from(part)) as f64 / seconds.max(1e-6);
            self.rate.store(rate.to_bits(), Ordering::Relaxed);
            for (item, words) in (done..).zip(results.chunks_exact(OUT_WORDS)) {
                let number = (item % parts) as u32;
                let is_last = u64::from(number) + 1 == parts;
                let count = if is_last { samples - number * part } else { part };
                sum.add_part(pixel_sum(words, count), is_last);
                counts.add(&item_counts(words, count));
                if is_last {
                    let pixel = item / parts;
                    let (column, row) = (pixel % u64::from(bounds.width()), pixel / u64::from(bounds.width()));
                    out.row_mut(bounds.y0 + row as u32)[column as usize] = sum.total();
                    sum.clear();
                }
            }
            done += items;
        }
        Ok(counts)
    }
}

fn pixel_sum(words: &[u64], count: u32) -> PixelSum {
    let channels = |first: usize| [0, 1, 2].map(|channel| f64::from_bits(words[first + channel]));
    PixelSum { sum: channels(0), square: channels(3), count }
}

fn item_counts(words: &[u64], paths: u32) -> Counts {
    Counts {
        paths: u64::from(paths),
        rays: words[6],
        invalid: words[7],
        escaped: words[8],
        truncated: words[9],
        box_tests: words[10],
        primitive_tests: words[11],
    }
}

impl Kernel for OnDevice {
    /// Once the device has failed, nothing more is asked of it.
    fn render(&self, piece: &Piece, out: &mut TileBuffer) -> Counts {
        if self.failed.get().is_some() {
            return Counts::default();
        }
        self.render_all(piece, out).unwrap_or_else(|error| {
            self.failed.get_or_init(|| error);
            Counts::default()
        })
    }

    fn failure(&self) -> Option<Error> {
        self.failed.get().map(|error| system(&self.id, error))
    }
}
