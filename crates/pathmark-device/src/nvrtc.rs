//! CUDA's compiler, `libnvrtc`, which needs no GPU; and the instructions that its code must not have: fused operations,
//! which are rounded once instead of twice, and operations without a stated rounding.
#![expect(unsafe_code, reason = "calls of the compiler; each has the arguments that NVRTC's documentation asks for")]

use super::library::{functions, open};
use super::{DeviceError, Dialect, Result};
use std::env;
use std::ffi::{CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::LazyLock;

type Handle = *mut c_void;

functions! { Compiler;
    create = c"nvrtcCreateProgram" (*mut Handle, *const c_char, *const c_char, c_int, *const *const c_char, *const *const c_char) -> c_int;
    compile = c"nvrtcCompileProgram" (Handle, c_int, *const *const c_char) -> c_int;
    ptx_size = c"nvrtcGetPTXSize" (Handle, *mut usize) -> c_int;
    ptx = c"nvrtcGetPTX" (Handle, *mut c_char) -> c_int;
    log_size = c"nvrtcGetProgramLogSize" (Handle, *mut usize) -> c_int;
    log = c"nvrtcGetProgramLog" (Handle, *mut c_char) -> c_int;
    destroy = c"nvrtcDestroyProgram" (*mut Handle) -> c_int;
    architecture_count = c"nvrtcGetNumSupportedArchs" (*mut c_int) -> c_int;
    architectures = c"nvrtcGetSupportedArchs" (*mut c_int) -> c_int;
}

const SUCCESS: c_int = 0;

/// The compiler from the library that `PATHMARK_NVRTC` names, or from the first usual library that can be opened.
static COMPILER: LazyLock<std::result::Result<Compiler, String>> = LazyLock::new(|| {
    let named = env::var("PATHMARK_NVRTC").unwrap_or_default();
    let usual = ["libnvrtc.so", "libnvrtc.so.13", "libnvrtc.so.12", "libnvrtc.so.11.2"];
    let names: &[&str] = if named.is_empty() { &usual } else { &[&named] };
    open(names).and_then(Compiler::of)
});

/// The reason why there is no compiler; `None` if there is one.
pub(crate) fn missing() -> Option<&'static String> {
    COMPILER.as_ref().err()
}

/// The newest architecture that the compiler knows and a device of this compute capability can run.
fn architecture(compiler: &Compiler, capability: u32) -> u32 {
    let mut count = 0;
    // SAFETY: it writes one number.
    unsafe { (compiler.architecture_count)(&raw mut count) };
    let mut known = vec![0; count.max(0) as usize];
    // SAFETY: there is room for the reported count.
    unsafe { (compiler.architectures)(known.as_mut_ptr()) };
    known.into_iter().map(|known| known as u32).filter(|known| *known <= capability).max().unwrap_or(capability)
}

/// Compiles a program with `libnvrtc` for GPUs of at least this compute capability (80 for 8.0). Returns PTX code;
/// needs no GPU.
pub fn ptx_of(program: &str, capability: u32) -> Result<String> {
    let missing = |why: &String| DeviceError::Missing { id: "libnvrtc".to_string(), why: why.clone() };
    let compiler = COMPILER.as_ref().map_err(missing)?;
    let refused = |log: String| DeviceError::Compiler { compiler: "libnvrtc".to_string(), log };
    let text = CString::new(Dialect::Cuda.whole(program)).map_err(|e| refused(e.to_string()))?;
    let mut handle = null_mut();
    // SAFETY: texts end with zeros; there are no headers.
    let code = unsafe { (compiler.create)(&raw mut handle, text.as_ptr(), c"pathmark.cu".as_ptr(), 0, null(), null()) };
    if code != SUCCESS {
        return Err(refused(format!("nvrtcCreateProgram: error {code}")));
    }
    let target = format!("--gpu-architecture=compute_{}", architecture(compiler, capability));
    let target = CString::new(target).map_err(|e| refused(e.to_string()))?;
    let options = [
        target.as_ptr(),
        c"--fmad=false".as_ptr(),
        c"--ftz=false".as_ptr(),
        c"--prec-div=true".as_ptr(),
        c"--prec-sqrt=true".as_ptr(),
    ];
    // SAFETY: the array has `options.len()` options, each of which ends with a zero.
    let code = unsafe { (compiler.compile)(handle, options.len() as c_int, options.as_ptr()) };
    let made = if code == SUCCESS {
        Ok(text_by(compiler.ptx_size, compiler.ptx, handle))
    } else {
        Err(refused(text_by(compiler.log_size, compiler.log, handle)))
    };
    // SAFETY: this function owns the handle.
    unsafe { (compiler.destroy)(&raw mut handle) };
    made
}

/// A text: one function returns its length, and another one writes it.
fn text_by(
    size: unsafe extern "C" fn(Handle, *mut usize) -> c_int,
    write: unsafe extern "C" fn(Handle, *mut c_char) -> c_int,
    program: Handle,
) -> String {
    let mut length = 0;
    // SAFETY: it writes one number.
    unsafe { size(program, &raw mut length) };
    let mut text = vec![0_u8; length];
    // SAFETY: there is room for the reported length.
    unsafe { write(program, text.as_mut_ptr().cast()) };
    String::from_utf8_lossy(&text).trim_end_matches('\0').to_string()
}

/// Returns the floating-point instructions of a PTX text that fuse a multiplication and an addition, approximate, flush
/// subnormal numbers to zero, or state no rounding. Fused ones in single precision are allowed, because a program asks
/// for them by name. (The assembler may fuse `add`, `sub` and `mul` without a suffix.)
pub fn inexact_instructions(ptx: &str) -> Vec<&str> {
    let instructions = ptx.lines().map(str::trim).filter(|line| line.ends_with(';'));
    let is_inexact = |line: &&str| {
        // A predicate may stand before the instruction.
        let instruction = line.split_whitespace().find(|word| !word.starts_with('@')).unwrap_or_default();
        let parts: Vec<&str> = instruction.split('.').collect();
        let is_real = parts.iter().any(|part| matches!(part.trim_end_matches(';'), "f64" | "f32" | "f16" | "bf16"));
        let has = |wanted: &str| parts.contains(&wanted);
        is_real
            && match parts[0] {
                "add" | "sub" | "mul" | "div" | "sqrt" | "rcp" => !has("rn") || has("ftz"),
                "fma" => !(has("rn") && has("f32")) || has("ftz"),
                "mad" | "rsqrt" | "sin" | "cos" | "ex2" | "lg2" | "tanh" => true,
                _ => has("approx") || has("ftz"),
            }
    };
    instructions.filter(is_inexact).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_fused_operations_and_undeclared_functions() {
        let ptx = "\tadd.rn.f64 %fd1, %fd2, %fd3;\n\tadd.f64 \t%fd1, %fd2, %fd3;\n\t@%p1 fma.rn.f64 %fd1, %fd2, %fd3, %fd4;\n\
                   \tadd.s64 %rd1, %rd2, %rd3;\n\tmad.lo.s32 %r1, %r2, %r3, %r4;\n\tsqrt.rn.f64 %fd1, %fd2;\n\
                   \tmul.rn.ftz.f32 %f1, %f2, %f3;\n\tld.global.f64 %fd1, [%rd1];\n\trsqrt.approx.ftz.f64 %fd1, %fd2;\n\
                   // add.f64 in a comment\n\tcvt.rn.f64.u64 %fd1, %rd1;\n\tdiv.rn.f64 %fd1, %fd2, %fd3;";
        let found = inexact_instructions(ptx);
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found[0].starts_with("add.f64") && found[1].contains("fma") && found[2].contains("ftz"), "{found:?}");
        assert!(found[3].starts_with("rsqrt"), "{found:?}");
    }
}
