//! GPUs by CUDA: `libnvrtc` compiles programs, and the driver's library `libcuda` runs them.
#![expect(unsafe_code, reason = "calls of the driver; each has the arguments that CUDA's documentation asks for")]

use super::library::{functions, open};
use super::nvrtc::{self, ptx_of};
use super::{Compiled, Costs, Device, DeviceError, Listed, Loaded, Result};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

type Handle = *mut c_void;
/// An address on the device.
type Address = u64;

functions! { Driver;
    init = c"cuInit" (u32) -> c_int;
    count = c"cuDeviceGetCount" (*mut c_int) -> c_int;
    get = c"cuDeviceGet" (*mut c_int, c_int) -> c_int;
    name = c"cuDeviceGetName" (*mut c_char, c_int, c_int) -> c_int;
    attribute = c"cuDeviceGetAttribute" (*mut c_int, c_int, c_int) -> c_int;
    retain = c"cuDevicePrimaryCtxRetain" (*mut Handle, c_int) -> c_int;
    set_current = c"cuCtxSetCurrent" (Handle) -> c_int;
    load = c"cuModuleLoadData" (*mut Handle, *const c_void) -> c_int;
    function = c"cuModuleGetFunction" (*mut Handle, Handle, *const c_char) -> c_int;
    allocate = c"cuMemAlloc_v2" (*mut Address, usize) -> c_int;
    free = c"cuMemFree_v2" (Address) -> c_int;
    to_device = c"cuMemcpyHtoD_v2" (Address, *const c_void, usize) -> c_int;
    from_device = c"cuMemcpyDtoH_v2" (*mut c_void, Address, usize) -> c_int;
    launch = c"cuLaunchKernel" (Handle, u32, u32, u32, u32, u32, u32, u32, Handle, *mut *mut c_void, *mut *mut c_void) -> c_int;
    error_text = c"cuGetErrorString" (c_int, *mut *const c_char) -> c_int;
}

// Constants of CUDA's header.
const SUCCESS: c_int = 0;
const NO_DEVICE: c_int = 100;
const MULTIPROCESSORS: c_int = 16;
const CAPABILITY_MAJOR: c_int = 75;
const CAPABILITY_MINOR: c_int = 76;

/// Items of a group, as in the program's entry (`dialect/cuda_entry.cl`).
const GROUP: u32 = 128;
/// Items that keep a multiprocessor busy: as many as its registers allow. More would mean items of fewer samples, whose
/// results take time to copy.
const ITEMS_PER_MULTIPROCESSOR: u32 = 4 * GROUP;

/// The reason why the driver cannot be used.
struct NoDriver {
    why: String,
    /// Whether a driver exists but refuses.
    is_broken: bool,
}

static DRIVER: LazyLock<std::result::Result<Driver, NoDriver>> = LazyLock::new(|| {
    let driver = open(&["libcuda.so.1", "libcuda.so"]).and_then(Driver::of);
    let driver = driver.map_err(|why| NoDriver { why, is_broken: false })?;
    // SAFETY: the flags must be zero.
    match unsafe { (driver.init)(0) } {
        SUCCESS => Ok(driver),
        NO_DEVICE => Err(NoDriver { why: text_of(&driver, NO_DEVICE), is_broken: false }),
        code => Err(NoDriver { why: format!("cuInit: {}", text_of(&driver, code)), is_broken: true }),
    }
});

/// The driver's text for an error.
fn text_of(driver: &Driver, code: c_int) -> String {
    let mut text = null();
    // SAFETY: the driver sets the pointer to a static text, or leaves it null.
    unsafe { (driver.error_text)(code, &raw mut text) };
    if text.is_null() {
        return format!("error {code}");
    }
    // SAFETY: it ends with a zero.
    format!("{} (error {code})", unsafe { CStr::from_ptr(text) }.to_string_lossy())
}

fn attribute(driver: &Driver, device: c_int, what: c_int) -> u32 {
    let mut value = 0;
    // SAFETY: a device that the driver has shown.
    let code = unsafe { (driver.attribute)(&raw mut value, what, device) };
    if code == SUCCESS { value as u32 } else { 0 }
}

fn name_of(driver: &Driver, device: c_int) -> String {
    let mut text = [0_u8; 256];
    // SAFETY: the driver writes no more than there is room for.
    unsafe { (driver.name)(text.as_mut_ptr().cast(), text.len() as c_int, device) };
    let end = text.iter().position(|byte| *byte == 0).unwrap_or(text.len());
    String::from_utf8_lossy(&text[..end]).into_owned()
}

fn devices(driver: &Driver) -> Vec<c_int> {
    let mut count = 0;
    // SAFETY: the driver is initialised.
    let code = unsafe { (driver.count)(&raw mut count) };
    let numbers = 0..if code == SUCCESS { count } else { 0 };
    let device = |number| {
        let mut device = 0;
        // SAFETY: the number is below the count.
        let code = unsafe { (driver.get)(&raw mut device, number) };
        (code == SUCCESS).then_some(device)
    };
    numbers.filter_map(device).collect()
}

pub(crate) fn list() -> Vec<Listed> {
    let nothing = |about: &str, is_broken| {
        let (id, about) = ("cuda".to_string(), about.to_string());
        vec![Listed { id, about, is_there: false, is_broken, is_accelerator: true }]
    };
    let driver = match &*DRIVER {
        Ok(driver) => driver,
        Err(NoDriver { why, is_broken }) => return nothing(why, *is_broken),
    };
    let devices = devices(driver);
    if devices.is_empty() {
        return nothing("the driver reports no device", false);
    }
    let compiler = nvrtc::missing();
    let listed = devices.into_iter().enumerate().map(|(number, device)| Listed {
        id: format!("cuda:{number}"),
        about: match compiler {
            None => name_of(driver, device),
            Some(why) => format!("{}: no compiler (install libnvrtc): {why}", name_of(driver, device)),
        },
        is_there: compiler.is_none(),
        is_broken: false,
        is_accelerator: true,
    });
    listed.collect()
}

/// A handle that may move between threads.
#[derive(Clone, Copy)]
struct Shared(Handle);

// SAFETY: the driver's functions may be called by any thread that has made the context its own, which each call here does first.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

/// A device and its context.
struct Context {
    id: String,
    driver: &'static Driver,
    handle: Shared,
}

impl Context {
    fn checked(&self, call: &'static str, code: c_int) -> Result<()> {
        if code == SUCCESS {
            return Ok(());
        }
        Err(DeviceError::Call { call, why: text_of(self.driver, code) })
    }

    /// Makes this the calling thread's current context.
    fn enter(&self) -> Result<()> {
        // SAFETY: the context stays to the end of the process.
        self.checked("cuCtxSetCurrent", unsafe { (self.driver.set_current)(self.handle.0) })
    }
}

/// Memory of the device.
struct Buffer {
    address: Address,
    bytes: usize,
    context: Arc<Context>,
}

impl Buffer {
    fn new(context: &Arc<Context>, bytes: usize) -> Result<Self> {
        let mut address = 0;
        // SAFETY: it writes one address.
        context.checked("cuMemAlloc", unsafe { (context.driver.allocate)(&raw mut address, bytes.max(8)) })?;
        Ok(Self { address, bytes, context: Arc::clone(context) })
    }

    fn of<T>(context: &Arc<Context>, content: &[T]) -> Result<Self> {
        let buffer = Self::new(context, size_of_val(content))?;
        buffer.write(content)?;
        Ok(buffer)
    }

    fn write<T>(&self, content: &[T]) -> Result<()> {
        debug_assert!(size_of_val(content) <= self.bytes);
        // SAFETY: the buffer has at least this size.
        let code =
            unsafe { (self.context.driver.to_device)(self.address, content.as_ptr().cast(), size_of_val(content)) };
        self.context.checked("cuMemcpyHtoD", code)
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // A lost context has no memory to free.
        if self.context.enter().is_ok() {
            // SAFETY: this value owns the address.
            unsafe { (self.context.driver.free)(self.address) };
        }
    }
}

pub(crate) struct Cuda {
    about: String,
    width: u32,
    capability: u32,
    context: Arc<Context>,
    functions: Compiled<Shared>,
}

impl Cuda {
    pub(crate) fn open(number: usize) -> Result<Self> {
        let id = format!("cuda:{number}");
        let missing = |why: &str| DeviceError::Missing { id: id.clone(), why: why.to_string() };
        let driver = DRIVER.as_ref().map_err(|no_driver| missing(&no_driver.why))?;
        let all = devices(driver);
        let device = *all.get(number).ok_or_else(|| missing(&format!("the driver reports {} devices", all.len())))?;
        let mut handle = null_mut();
        // SAFETY: a device that the driver has shown; its context is never given back.
        let code = unsafe { (driver.retain)(&raw mut handle, device) };
        let context = Arc::new(Context { id, driver, handle: Shared(handle) });
        context.checked("cuDevicePrimaryCtxRetain", code)?;
        let of = |what| attribute(driver, device, what);
        Ok(Self {
            about: name_of(driver, device),
            width: of(MULTIPROCESSORS).max(1) * ITEMS_PER_MULTIPROCESSOR,
            capability: 10 * of(CAPABILITY_MAJOR) + of(CAPABILITY_MINOR),
            context,
            functions: Compiled(Mutex::default()),
        })
    }

    fn compile(&self, text: &str) -> Result<Shared> {
        let ptx = ptx_of(text, self.capability)?;
        let refused = |log: String| DeviceError::Compiler { compiler: self.context.id.clone(), log };
        let ptx = CString::new(ptx).map_err(|e| refused(e.to_string()))?;
        let (mut module, mut function) = (null_mut(), null_mut());
        // SAFETY: the text ends with a zero.
        let code = unsafe { (self.context.driver.load)(&raw mut module, ptx.as_ptr().cast()) };
        self.context.checked("cuModuleLoadData", code)?;
        // SAFETY: the module is open, and stays so; the name ends with a zero.
        let code = unsafe { (self.context.driver.function)(&raw mut function, module, c"pathmark_run".as_ptr()) };
        self.context.checked("cuModuleGetFunction", code)?;
        Ok(Shared(function))
    }
}

impl Device for Cuda {
    fn id(&self) -> &str {
        &self.context.id
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn width(&self) -> u32 {
        self.width
    }

    fn bind(&self, text: &str, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>> {
        self.context.enter()?;
        let compile = || self.functions.get(text, || self.compile(text));
        let copy = |function| Ok((function, Buffer::of(&self.context, numbers)?, Buffer::of(&self.context, words)?));
        let ((function, numbers, words), costs) = Costs::of(compile, copy)?;
        let (kept, context) = (Mutex::default(), Arc::clone(&self.context));
        Ok(Box::new(Bound { context, function, numbers, words, kept, costs }))
    }
}

/// A compiled function with its inputs.
struct Bound {
    context: Arc<Context>,
    function: Shared,
    numbers: Buffer,
    words: Buffer,
    /// Buffers for a task and its results, reused from run to run.
    kept: Mutex<[Option<Buffer>; 2]>,
    costs: Costs,
}

/// Returns a buffer of at least this size; replaces the existing one if that is smaller.
fn kept<'a>(context: &Arc<Context>, place: &'a mut Option<Buffer>, bytes: usize) -> Result<&'a Buffer> {
    if place.as_ref().is_none_or(|buffer| buffer.bytes < bytes) {
        *place = None;
        *place = Some(Buffer::new(context, bytes)?);
    }
    place.as_ref().ok_or(DeviceError::Missing { id: context.id.clone(), why: "no buffer".to_string() })
}

impl Loaded for Bound {
    fn costs(&self) -> Costs {
        self.costs
    }

    fn run(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<()> {
        // One run at a time, because runs share the buffer for results.
        let mut room = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let context = &self.context;
        context.enter()?;
        let [task_room, out_room] = &mut *room;
        let task_buffer = kept(context, task_room, size_of_val(task))?;
        let out_buffer = kept(context, out_room, size_of_val(out))?;
        task_buffer.write(task)?;
        let (numbers, words, task_address, out_address) =
            (self.numbers.address, self.words.address, task_buffer.address, out_buffer.address);
        let mut arguments = [
            (&raw const numbers).cast::<c_void>().cast_mut(),
            (&raw const words).cast::<c_void>().cast_mut(),
            (&raw const task_address).cast::<c_void>().cast_mut(),
            (&raw const items).cast::<c_void>().cast_mut(),
            (&raw const out_address).cast::<c_void>().cast_mut(),
        ];
        let groups = items.div_ceil(GROUP);
        // SAFETY: the function has these five arguments; it writes to no item beyond the last.
        let code = unsafe {
            (context.driver.launch)(
                self.function.0,
                groups,
                1,
                1,
                GROUP,
                1,
                1,
                0,
                null_mut(),
                arguments.as_mut_ptr(),
                null_mut(),
            )
        };
        context.checked("cuLaunchKernel", code)?;
        // SAFETY: `out` has this size. The copy waits for the previous launch and reports its failure.
        let code =
            unsafe { (context.driver.from_device)(out.as_mut_ptr().cast(), out_buffer.address, size_of_val(out)) };
        context.checked("cuMemcpyDtoH", code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The entry's launch bounds must match the launched groups: a launch of larger groups would fail.
    #[test]
    fn the_entry_has_the_groups_that_are_launched() {
        let bounds = format!("__launch_bounds__({GROUP}, {})", ITEMS_PER_MULTIPROCESSOR / GROUP);
        assert!(include_str!("dialect/cuda_entry.cl").contains(&bounds), "{bounds}");
    }
}
