//! OpenCL 1.2: its loader, `libOpenCL.so.1`, the devices that it shows, and programs on them.
#![expect(unsafe_code, reason = "calls of the driver; each has the arguments that OpenCL's specification asks for")]

use super::library::{functions, open};
use super::{Compiled, Costs, Device, DeviceError, Dialect, Listed, Loaded, Result};
use std::ffi::{c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, PoisonError};

/// A handle of the driver.
type Handle = *mut c_void;

functions! { Functions;
    platforms = c"clGetPlatformIDs" (u32, *mut Handle, *mut u32) -> i32;
    devices = c"clGetDeviceIDs" (Handle, u64, u32, *mut Handle, *mut u32) -> i32;
    device_info = c"clGetDeviceInfo" (Handle, u32, usize, *mut c_void, *mut usize) -> i32;
    create_context = c"clCreateContext" (*const isize, u32, *const Handle, *const c_void, *mut c_void, *mut i32) -> Handle;
    create_queue = c"clCreateCommandQueue" (Handle, Handle, u64, *mut i32) -> Handle;
    create_program = c"clCreateProgramWithSource" (Handle, u32, *const *const c_char, *const usize, *mut i32) -> Handle;
    build = c"clBuildProgram" (Handle, u32, *const Handle, *const c_char, *const c_void, *mut c_void) -> i32;
    build_info = c"clGetProgramBuildInfo" (Handle, Handle, u32, usize, *mut c_void, *mut usize) -> i32;
    create_kernel = c"clCreateKernel" (Handle, *const c_char, *mut i32) -> Handle;
    create_buffer = c"clCreateBuffer" (Handle, u64, usize, *mut c_void, *mut i32) -> Handle;
    set_argument = c"clSetKernelArg" (Handle, u32, usize, *const c_void) -> i32;
    launch = c"clEnqueueNDRangeKernel" (Handle, Handle, u32, *const usize, *const usize, *const usize, u32, *const Handle, *mut Handle) -> i32;
    write = c"clEnqueueWriteBuffer" (Handle, Handle, u32, usize, usize, *const c_void, u32, *const Handle, *mut Handle) -> i32;
    read = c"clEnqueueReadBuffer" (Handle, Handle, u32, usize, usize, *mut c_void, u32, *const Handle, *mut Handle) -> i32;
    release_buffer = c"clReleaseMemObject" (Handle) -> i32;
    release_kernel = c"clReleaseKernel" (Handle) -> i32;
}

// Constants of OpenCL's header.
const SUCCESS: i32 = 0;
const NO_DRIVER: i32 = -1001;
const ALL_DEVICES: u64 = 0xFFFF_FFFF;
const DEVICE_TYPE: u32 = 0x1000;
const COMPUTE_UNITS: u32 = 0x1002;
const DEVICE_NAME: u32 = 0x102B;
const DOUBLE_CONFIG: u32 = 0x1032;
const TYPE_CPU: u64 = 2;
/// Subnormal numbers are kept, infinities and NaN exist, and results are rounded to the nearest.
const EXACT_ENOUGH: u64 = 1 | 2 | 4;

/// The loader's functions, or the reason why there are none. The library stays open.
static LOADER: LazyLock<std::result::Result<Functions, String>> = LazyLock::new(|| open(NAMES).and_then(Functions::of));

/// Apple's systems have it as a framework.
const NAMES: &[&str] = if cfg!(target_vendor = "apple") {
    &["/System/Library/Frameworks/OpenCL.framework/OpenCL"]
} else {
    &["libOpenCL.so.1", "libOpenCL.so"]
};

/// Held while looking for devices, compiling, or launching a kernel for the first time, which is when `PoCL` compiles
/// it: version 3.1 crashes if two threads do so at the same time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

fn turn() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The text for a code of OpenCL's header, if users may meet it; otherwise its number.
fn meaning(code: i32) -> String {
    let name = match code {
        -1 => "device not found",
        -2 => "device not available",
        -4 => "no memory for an object on the device",
        -5 => "out of resources",
        -6 => "out of memory on the host",
        -11 => "the program was not built",
        -36 => "the queue is gone: the device may be lost",
        -54 => "the group of items is too large",
        -61 => "a buffer is too large",
        NO_DRIVER => "no driver is installed",
        _ => return format!("error {code}"),
    };
    format!("{name} (error {code})")
}

/// A device of a platform.
struct Found {
    handle: Handle,
    name: String,
    is_processor: bool,
    units: u32,
    is_exact: bool,
}

/// A numeric property of a device; 0 if the query fails.
fn number_of(functions: &Functions, device: Handle, what: u32) -> u64 {
    let mut number = 0_u64;
    // SAFETY: every property queried here has at most eight bytes.
    let code = unsafe { (functions.device_info)(device, what, 8, (&raw mut number).cast(), null_mut()) };
    if code == SUCCESS { number } else { 0 }
}

fn name_of(functions: &Functions, device: Handle) -> String {
    let mut text = [0_u8; 256];
    // SAFETY: the driver writes no more than there is room for.
    unsafe { (functions.device_info)(device, DEVICE_NAME, text.len(), text.as_mut_ptr().cast(), null_mut()) };
    let end = text.iter().position(|byte| *byte == 0).unwrap_or(text.len());
    String::from_utf8_lossy(&text[..end]).trim().to_string()
}

/// Every device of every platform, in the driver's order. Returns the driver's error, except for a missing driver.
fn found(functions: &Functions) -> std::result::Result<Vec<Found>, String> {
    const MOST: usize = 64;
    let _turn = turn();
    let (mut platforms, mut count) = ([null_mut(); MOST], 0);
    // SAFETY: there is room for `MOST` handles.
    let code = unsafe { (functions.platforms)(MOST as u32, platforms.as_mut_ptr(), &raw mut count) };
    if code != SUCCESS && code != NO_DRIVER {
        return Err(format!("clGetPlatformIDs: {}", meaning(code)));
    }
    let mut all = Vec::new();
    for platform in platforms.into_iter().take(if code == SUCCESS { count as usize } else { 0 }) {
        let (mut devices, mut count) = ([null_mut(); MOST], 0);
        // SAFETY: as above.
        let code =
            unsafe { (functions.devices)(platform, ALL_DEVICES, MOST as u32, devices.as_mut_ptr(), &raw mut count) };
        for handle in devices.into_iter().take(if code == SUCCESS { count as usize } else { 0 }) {
            all.push(Found {
                handle,
                name: name_of(functions, handle),
                is_processor: number_of(functions, handle, DEVICE_TYPE) & TYPE_CPU != 0,
                units: number_of(functions, handle, COMPUTE_UNITS) as u32,
                is_exact: number_of(functions, handle, DOUBLE_CONFIG) & EXACT_ENOUGH == EXACT_ENOUGH,
            });
        }
    }
    Ok(all)
}

const INEXACT: &str = "it has no IEEE 754 double precision";

pub(crate) fn list() -> Vec<Listed> {
    let nothing = |why: &str, is_broken| Listed {
        id: "opencl".to_string(),
        about: why.to_string(),
        is_there: false,
        is_broken,
        is_accelerator: false,
    };
    let all = match LOADER.as_ref().map(found) {
        Err(why) => return vec![nothing(why, false)],
        Ok(Err(why)) => return vec![nothing(&why, true)],
        Ok(Ok(all)) if all.is_empty() => return vec![nothing("no driver reports a device", false)],
        Ok(Ok(all)) => all,
    };
    let listed = all.into_iter().enumerate().map(|(number, device)| Listed {
        id: format!("opencl:{number}"),
        about: if device.is_exact { device.name } else { format!("{}: {INEXACT}", device.name) },
        is_there: device.is_exact,
        is_broken: false,
        is_accelerator: !device.is_processor,
    });
    listed.collect()
}

const SINGLE_CONFIG: u32 = 0x101B;
const BUILD_LOG: u32 = 0x1183;
/// Divisions and roots in single precision can be rounded to the nearest, if a compiler option demands it.
const ROUNDS_SINGLES: u64 = 1 << 7;
const READ_WRITE: u64 = 1;
const READ_ONLY_COPY: u64 = 4 | 32;

/// Items that keep a compute unit busy; below, the same for a core of a processor.
const ITEMS_PER_UNIT: u32 = 1024;
const ITEMS_PER_CORE: u32 = 16;
/// Items of a group, the same for all launches, because a driver may recompile the program for each size. On a
/// processor an item is a loop.
const GROUP: usize = 64;
const GROUP_OF_CORE: usize = 1;

/// A handle that may move between threads. Any thread may call the driver's functions, but only one at a time may set a
/// kernel's arguments.
#[derive(Clone, Copy)]
struct Shared(Handle);

// SAFETY: OpenCL 1.2, appendix A.2: all calls are safe from any thread but those that set a kernel's arguments, which are made under a lock.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

/// Turns the code that a driver's function returned into a result.
fn checked(call: &'static str, code: i32) -> Result<()> {
    if code == SUCCESS { Ok(()) } else { Err(DeviceError::Call { call, why: meaning(code) }) }
}

/// A device with its context and queue.
struct Queue {
    id: String,
    functions: &'static Functions,
    device: Shared,
    context: Shared,
    handle: Shared,
}

impl Queue {
    /// Allocates `bytes` bytes of device memory, but at least 8.
    fn buffer<T>(&self, flags: u64, content: *const T, bytes: usize) -> Result<Buffer> {
        let mut code = SUCCESS;
        // SAFETY: with the flag to copy, `content` has `bytes` bytes; without it, `content` is null.
        let handle = unsafe {
            (self.functions.create_buffer)(
                self.context.0,
                flags,
                bytes.max(8),
                content.cast_mut().cast(),
                &raw mut code,
            )
        };
        checked("clCreateBuffer", code)?;
        Ok(Buffer { handle: Shared(handle), functions: self.functions })
    }

    fn log(&self, program: Handle) -> String {
        let mut text = vec![0_u8; 16 << 10];
        let mut length = 0;
        // SAFETY: the driver writes no more than there is room for.
        unsafe {
            (self.functions.build_info)(
                program,
                self.device.0,
                BUILD_LOG,
                text.len(),
                text.as_mut_ptr().cast(),
                &raw mut length,
            )
        };
        text.truncate(length.min(text.len()));
        String::from_utf8_lossy(&text).trim_matches(['\0', '\n', ' ']).to_string()
    }

    fn compile(&self, text: &str) -> Result<Shared> {
        let whole = Dialect::OpenCl.whole(text);
        let (pointer, length, mut code) = (whole.as_ptr().cast::<c_char>(), whole.len(), SUCCESS);
        // SAFETY: one text of that length.
        let program = unsafe {
            (self.functions.create_program)(self.context.0, 1, &raw const pointer, &raw const length, &raw mut code)
        };
        checked("clCreateProgramWithSource", code)?;
        let rounds = number_of(self.functions, self.device.0, SINGLE_CONFIG) & ROUNDS_SINGLES != 0;
        let options = if rounds { c"-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt" } else { c"-cl-std=CL1.2" };
        // SAFETY: the options end with a zero.
        let code = unsafe {
            (self.functions.build)(program, 1, &raw const self.device.0, options.as_ptr(), null(), null_mut())
        };
        if code != SUCCESS {
            let log = format!("{}\n{}", meaning(code), self.log(program));
            return Err(DeviceError::Compiler { compiler: self.id.clone(), log });
        }
        Ok(Shared(program))
    }

    fn kernel(&self, program: Shared) -> Result<Shared> {
        let mut code = SUCCESS;
        // SAFETY: the name ends with a zero.
        let kernel = unsafe { (self.functions.create_kernel)(program.0, c"pathmark_run".as_ptr(), &raw mut code) };
        checked("clCreateKernel", code)?;
        Ok(Shared(kernel))
    }
}

/// Memory of the device.
struct Buffer {
    handle: Shared,
    functions: &'static Functions,
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: this value owns the handle.
        unsafe { (self.functions.release_buffer)(self.handle.0) };
    }
}

pub(crate) struct OpenCl {
    about: String,
    width: u32,
    group: usize,
    queue: Arc<Queue>,
    programs: Compiled<Shared>,
}

impl OpenCl {
    pub(crate) fn open(number: usize) -> Result<Self> {
        let id = format!("opencl:{number}");
        let missing = |why: &str| DeviceError::Missing { id: id.clone(), why: why.to_string() };
        let functions = LOADER.as_ref().map_err(|why| missing(why))?;
        let all = found(functions).map_err(|why| missing(&why))?;
        let count = format!("the drivers report {} devices", all.len());
        let Found { handle, name, is_processor, units, is_exact } =
            all.into_iter().nth(number).ok_or_else(|| missing(&count))?;
        if !is_exact {
            return Err(missing(INEXACT));
        }
        let _turn = turn();
        let mut code = SUCCESS;
        // SAFETY: one device, no properties, no callback for errors.
        let context =
            unsafe { (functions.create_context)(null(), 1, &raw const handle, null(), null_mut(), &raw mut code) };
        checked("clCreateContext", code)?;
        // SAFETY: context and device belong together.
        let queue = unsafe { (functions.create_queue)(context, handle, 0, &raw mut code) };
        checked("clCreateCommandQueue", code)?;
        let (device, context, handle) = (Shared(handle), Shared(context), Shared(queue));
        let width = units.max(1) * if is_processor { ITEMS_PER_CORE } else { ITEMS_PER_UNIT };
        let queue = Arc::new(Queue { id, functions, device, context, handle });
        let group = if is_processor { GROUP_OF_CORE } else { GROUP };
        Ok(Self { about: name, width, group, queue, programs: Compiled(Mutex::default()) })
    }
}

impl Device for OpenCl {
    fn id(&self) -> &str {
        &self.queue.id
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn width(&self) -> u32 {
        self.width
    }

    fn bind(&self, text: &str, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>> {
        let _turn = turn();
        let queue = &self.queue;
        let compile = || queue.kernel(self.programs.get(text, || queue.compile(text))?);
        let copy = |handle| {
            let numbers = queue.buffer(READ_ONLY_COPY, numbers.as_ptr(), size_of_val(numbers))?;
            let words = queue.buffer(READ_ONLY_COPY, words.as_ptr(), size_of_val(words))?;
            Ok((handle, [numbers, words]))
        };
        let ((handle, inputs), costs) = Costs::of(compile, copy)?;
        let kernel = Mutex::new(Kernel { handle, is_compiled: false, task: None, out: None });
        Ok(Box::new(Bound { queue: Arc::clone(queue), group: self.group, inputs, kernel, costs }))
    }
}

/// A kernel, and the buffers that are reused from run to run, with their sizes.
struct Kernel {
    handle: Shared,
    is_compiled: bool,
    task: Option<(Buffer, usize)>,
    out: Option<(Buffer, usize)>,
}

/// A kernel with its inputs.
struct Bound {
    queue: Arc<Queue>,
    group: usize,
    inputs: [Buffer; 2],
    kernel: Mutex<Kernel>,
    costs: Costs,
}

/// Returns a buffer of at least this size; replaces the existing one if that is smaller.
fn kept(queue: &Queue, place: &mut Option<(Buffer, usize)>, bytes: usize) -> Result<Handle> {
    match place {
        Some((buffer, size)) if *size >= bytes => Ok(buffer.handle.0),
        _ => {
            *place = None;
            let (buffer, _) = place.insert((queue.buffer::<u8>(READ_WRITE, null(), bytes)?, bytes));
            Ok(buffer.handle.0)
        }
    }
}

impl Loaded for Bound {
    fn costs(&self) -> Costs {
        self.costs
    }

    fn run(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<()> {
        let Queue { functions, handle: Shared(queue), .. } = *self.queue;
        let mut guard: MutexGuard<'_, Kernel> = self.kernel.lock().unwrap_or_else(PoisonError::into_inner);
        let _turn = (!guard.is_compiled).then(turn);
        guard.is_compiled = true;
        let Kernel { handle: Shared(kernel), task: task_buffer, out: out_buffer, .. } = &mut *guard;
        let task_handle = kept(&self.queue, task_buffer, size_of_val(task))?;
        let out_handle = kept(&self.queue, out_buffer, size_of_val(out))?;
        // SAFETY: the buffer has this size, and the call returns when it has been read.
        let code = unsafe {
            (functions.write)(queue, task_handle, 1, 0, size_of_val(task), task.as_ptr().cast(), 0, null(), null_mut())
        };
        checked("clEnqueueWriteBuffer", code)?;
        let handles = [self.inputs[0].handle.0, self.inputs[1].handle.0, task_handle, null_mut(), out_handle];
        for (number, handle) in (0_u32..).zip(&handles) {
            // SAFETY: the kernel's fourth argument is a word of 32 bits, the others are buffers.
            let code = unsafe {
                if handle.is_null() {
                    (functions.set_argument)(*kernel, number, size_of::<u32>(), (&raw const items).cast())
                } else {
                    (functions.set_argument)(*kernel, number, size_of::<Handle>(), (&raw const *handle).cast())
                }
            };
            checked("clSetKernelArg", code)?;
        }
        let (group, global) = (self.group, (items as usize).next_multiple_of(self.group));
        // SAFETY: one dimension; the program asks for no item beyond the last.
        let code = unsafe {
            (functions.launch)(queue, *kernel, 1, null(), &raw const global, &raw const group, 0, null(), null_mut())
        };
        checked("clEnqueueNDRangeKernel", code)?;
        // SAFETY: `out` has this size, and the call returns when it has been written.
        let code = unsafe {
            (functions.read)(queue, out_handle, 1, 0, size_of_val(out), out.as_mut_ptr().cast(), 0, null(), null_mut())
        };
        checked("clEnqueueReadBuffer", code)
    }
}

impl Drop for Bound {
    fn drop(&mut self) {
        let kernel = self.kernel.get_mut().unwrap_or_else(PoisonError::into_inner).handle;
        // SAFETY: this value owns the handle.
        unsafe { (self.queue.functions.release_kernel)(kernel.0) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_told_in_words() {
        assert_eq!(meaning(-4), "no memory for an object on the device (error -4)");
        assert_eq!(meaning(-77), "error -77");
    }
}
