//! One program text for three kinds of device: GPUs by CUDA, all devices of OpenCL, and the processor by the host's C
//! compiler.
//!
//! A program uses only the common part of C, OpenCL C and CUDA C, and the words of the [dialects](Dialect): `real`,
//! `u32`, `u64`, `GLOBAL`, `FN`, `SQUARE_ROOT`, `MAGNITUDE`, `WITH_SIGN`, `COUNT_ONES`, `INFINITE`, and for `float` the
//! same with the prefix `SINGLE_`, and `FUSED`. It defines
//!
//! ```c
//! FN void run_item(u32 item, GLOBAL const real *numbers, GLOBAL const u32 *words, GLOBAL const u32 *task, GLOBAL u64 *out);
//! ```
//!
//! and a device calls it once for each item. Every operation is rounded once, by IEEE 754. Compiler options forbid
//! fused operations other than `FUSED`, and a device must pass a table of operations (`Device::load` refuses a device
//! that fails). So the results have the same bits on every device.
//!
//! Drivers and compilers are opened at run time. Without them everything still builds, and [`list`] says which is
//! missing.

mod cuda;
mod dialect;
mod error;
mod host;
mod library;
mod nvrtc;
mod opencl;
mod self_test;

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use std::time::Instant;

pub use dialect::Dialect;
pub use error::DeviceError;
pub use nvrtc::{inexact_instructions, ptx_of};

/// The result of an operation that a device can make fail.
pub type Result<T> = std::result::Result<T, DeviceError>;

/// The processor that this program runs on, by the host's C compiler.
pub const HOST: &str = "host";

/// A device that was found, or an interface without any device.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its name on a command line: `cuda:0`, `opencl:1`, `host`. For an interface without device: `cuda` or `opencl`.
    pub id: String,
    /// The driver's name for it, or the reason why there is none.
    pub about: String,
    /// Whether it can be opened.
    pub is_there: bool,
    /// Whether a driver exists but refuses, which is the system's fault.
    pub is_broken: bool,
    /// Whether it is a processor of another kind than the host's.
    pub is_accelerator: bool,
}

/// A device that can run programs.
pub trait Device: Send + Sync {
    /// Its name on a command line.
    fn id(&self) -> &str;

    /// The driver's name for it.
    fn about(&self) -> &str;

    /// The number of items that keep the whole device busy.
    fn width(&self) -> u32;

    /// Compiles the program, unless it was compiled before, and copies its inputs to the device.
    fn bind(&self, text: &str, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>>;
}

impl dyn Device {
    /// Calls [`Device::bind`] if the device has passed the self-test, also in single precision if the program uses it.
    pub fn load(&self, text: &str, uses_single: bool, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>> {
        self_test::passed(self, uses_single)?;
        self.bind(text, numbers, words)
    }
}

/// Seconds that a program takes before its first run.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Costs {
    /// Time to compile it; nearly zero if it was compiled before.
    pub compile_s: f64,
    /// Time to copy its inputs.
    pub copy_s: f64,
}

impl Costs {
    /// Compiles and copies, and measures both times.
    pub(crate) fn of<A, B>(
        compile: impl FnOnce() -> Result<A>,
        copy: impl FnOnce(A) -> Result<B>,
    ) -> Result<(B, Self)> {
        let before = Instant::now();
        let compiled = compile()?;
        let compile_s = before.elapsed().as_secs_f64();
        let copied = copy(compiled)?;
        Ok((copied, Self { compile_s, copy_s: before.elapsed().as_secs_f64() - compile_s }))
    }
}

/// Compiled programs by their texts.
struct Compiled<T>(Mutex<HashMap<String, T>>);

impl<T: Clone> Compiled<T> {
    /// Compiles a text, unless it was compiled before.
    fn get(&self, text: &str, compile: impl FnOnce() -> Result<T>) -> Result<T> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known.get(text) {
            return Ok(found.clone());
        }
        let made = compile()?;
        known.insert(text.to_string(), made.clone());
        Ok(made)
    }
}

/// A program on a device, with its inputs.
pub trait Loaded: Send + Sync {
    /// The time that compilation and copying took.
    fn costs(&self) -> Costs;

    /// Runs the program for `items` items. `out` must have room for all words that the program writes for each item.
    fn run(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<()>;
}

impl dyn Loaded {
    /// Calls [`Loaded::run`] and returns the seconds that it took, copies to and from the device included.
    pub fn timed(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<f64> {
        let before = Instant::now();
        self.run(task, items, out)?;
        Ok(before.elapsed().as_secs_f64())
    }
}

/// Returns every available device, and the interfaces without any.
pub fn list() -> Vec<Listed> {
    [cuda::list(), opencl::list(), host::list()].concat()
}

/// The open devices; each is opened once.
static OPEN: LazyLock<Mutex<Vec<Arc<dyn Device>>>> = LazyLock::new(Mutex::default);

/// Opens the device of that name: `cuda:N`, `opencl:N` or `host`.
pub fn open(id: &str) -> Result<Arc<dyn Device>> {
    let mut open = OPEN.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(device) = open.iter().find(|device| device.id() == id) {
        return Ok(Arc::clone(device));
    }
    let number = |kind: &str| id.strip_prefix(kind).and_then(|number| number.parse::<usize>().ok());
    let device: Arc<dyn Device> = if id == HOST {
        Arc::new(host::Host::open()?)
    } else if let Some(number) = number("cuda:") {
        Arc::new(cuda::Cuda::open(number)?)
    } else if let Some(number) = number("opencl:") {
        Arc::new(opencl::OpenCl::open(number)?)
    } else {
        return Err(DeviceError::NoName { id: id.to_string() });
    };
    open.push(Arc::clone(&device));
    Ok(device)
}
