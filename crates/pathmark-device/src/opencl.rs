//! Programs on devices by OpenCL 1.2.
#![expect(unsafe_code, reason = "calls of the driver; each has the arguments that OpenCL's specification asks for")]

use super::opencl_driver::{Found, Functions, Handle, INEXACT, LOADER, SUCCESS, found, meaning, number_of, turn};
use super::{Costs, Device, DeviceError, Dialect, Loaded, Result};
use std::collections::HashMap;
use std::ffi::c_char;
use std::ptr::{null, null_mut};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

// Constants of OpenCL's header.
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

/// An OpenCL device.
pub(crate) struct OpenCl {
    about: String,
    width: u32,
    group: usize,
    queue: Arc<Queue>,
    programs: Mutex<HashMap<String, Shared>>,
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
        Ok(Self { about: name, width, group, queue, programs: Mutex::default() })
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
        let compile = || {
            let mut programs = self.programs.lock().unwrap_or_else(PoisonError::into_inner);
            if let Some(program) = programs.get(text) {
                return queue.kernel(*program);
            }
            let program = queue.compile(text)?;
            programs.insert(text.to_string(), program);
            queue.kernel(program)
        };
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
