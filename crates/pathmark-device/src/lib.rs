//! One program text for three kinds of device: a GPU by CUDA, whatever OpenCL finds, and the processor by the host's C compiler.
//!
//! A program is written in what C, OpenCL C and CUDA C have in common, with the words of the [dialects](Dialect): `real`, `u32`, `u64`, `GLOBAL`,
//! `FN`, `SQUARE_ROOT`, `MAGNITUDE`, `WITH_SIGN`, `COUNT_ONES`, `INFINITE`, and of `float` those with `SINGLE_` before them and `FUSED`. It defines
//!
//! ```c
//! FN void run_item(u32 item, GLOBAL const real *numbers, GLOBAL const u32 *words, GLOBAL const u32 *task, GLOBAL u64 *out);
//! ```
//!
//! which is called once for each item. Every operation is rounded once, by IEEE 754: compilers are told to fuse none but `FUSED`, and a device
//! shows in a table of operations that it obeys (`Device::load` refuses one that does not). So the results have the same bits on every device.
//!
//! Drivers and compilers are looked for when the program runs. Where there are none, everything builds, and [`list`] says what is missing.

mod cuda;
mod dialect;
mod error;
mod host;
mod library;
mod nvrtc;
mod opencl;
mod opencl_driver;
mod ptx;
mod self_test;

use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use std::time::Instant;

pub use dialect::Dialect;
pub use error::DeviceError;
pub use nvrtc::ptx_of;
pub use ptx::inexact_instructions;

/// The result of whatever a device can make fail.
pub type Result<T> = std::result::Result<T, DeviceError>;

/// The processor that this program runs on, by the host's C compiler.
pub const HOST: &str = "host";

/// A device that was found, or a way to reach devices that leads nowhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Listed {
    /// Its name on a command line: `cuda:0`, `opencl:1`, `host`. Of a way that leads nowhere `cuda` or `opencl`.
    pub id: String,
    /// What the driver calls it, or why there is none.
    pub about: String,
    /// Whether it can be opened.
    pub is_there: bool,
    /// Whether there is a driver that refuses, which is the system's fault, instead of none.
    pub is_broken: bool,
    /// Whether it is a processor of another kind than the one that this program runs on.
    pub is_accelerator: bool,
}

/// A device that programs are made for.
pub trait Device: Send + Sync {
    /// Its name on a command line.
    fn id(&self) -> &str;

    /// What the driver calls it.
    fn about(&self) -> &str;

    /// How many items keep all of it busy.
    fn width(&self) -> u32;

    /// Compiles the program, unless it has been before, and puts its inputs on the device.
    fn bind(&self, text: &str, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>>;
}

impl dyn Device {
    /// [`Device::bind`] on a device that has shown that it computes as it should, also in single precision if the program uses it.
    pub fn load(&self, text: &str, uses_single: bool, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>> {
        self_test::passed(self, uses_single)?;
        self.bind(text, numbers, words)
    }
}

/// Seconds that a program takes before it runs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Costs {
    /// To compile it; next to nothing if it was compiled before.
    pub compile_s: f64,
    /// To copy its inputs.
    pub copy_s: f64,
}

impl Costs {
    /// Compiles and copies, and tells how long each took.
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

/// A program on a device, with its inputs.
pub trait Loaded: Send + Sync {
    /// What it took to get there.
    fn costs(&self) -> Costs;

    /// Runs so many items. `out` has room for as many words for each as the program writes.
    fn run(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<()>;
}

impl dyn Loaded {
    /// [`Loaded::run`], and the seconds that it took, with what goes to the device and comes back.
    pub fn timed(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<f64> {
        let before = Instant::now();
        self.run(task, items, out)?;
        Ok(before.elapsed().as_secs_f64())
    }
}

/// Every device there is, and the ways that lead to none.
pub fn list() -> Vec<Listed> {
    [cuda::list(), opencl_driver::list(), host::list()].concat()
}

/// Devices that are open, each once.
static OPEN: LazyLock<Mutex<Vec<Arc<dyn Device>>>> = LazyLock::new(Mutex::default);

/// The device of that name: `cuda:N`, `opencl:N` or `host`.
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
