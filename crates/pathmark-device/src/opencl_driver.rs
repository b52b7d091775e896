//! OpenCL's loader, `libOpenCL.so.1`, and the devices that it shows.
#![expect(unsafe_code, reason = "calls of the driver; each has the arguments that OpenCL's specification asks for")]

use super::Listed;
use super::library::{functions, open};
use std::ffi::{c_char, c_void};
use std::ptr::null_mut;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

/// A handle of the driver.
pub(crate) type Handle = *mut c_void;

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
pub(crate) const SUCCESS: i32 = 0;
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
pub(crate) static LOADER: LazyLock<std::result::Result<Functions, String>> =
    LazyLock::new(|| open(&["libOpenCL.so.1", "libOpenCL.so"]).and_then(Functions::of));

/// Held while looking for devices, compiling, or launching a kernel for the first time, which is when `PoCL` compiles
/// it: version 3.1 crashes if two threads do so at the same time.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

pub(crate) fn turn() -> MutexGuard<'static, ()> {
    ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The text for a code of OpenCL's header, if users may meet it; otherwise its number.
pub(crate) fn meaning(code: i32) -> String {
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
pub(crate) struct Found {
    pub(crate) handle: Handle,
    pub(crate) name: String,
    pub(crate) is_processor: bool,
    pub(crate) units: u32,
    pub(crate) is_exact: bool,
}

/// A numeric property of a device; 0 if the query fails.
pub(crate) fn number_of(functions: &Functions, device: Handle, what: u32) -> u64 {
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
pub(crate) fn found(functions: &Functions) -> std::result::Result<Vec<Found>, String> {
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

pub(crate) const INEXACT: &str = "it has no IEEE 754 double precision";

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_told_in_words() {
        assert_eq!(meaning(-4), "no memory for an object on the device (error -4)");
        assert_eq!(meaning(-77), "error -77");
    }
}
