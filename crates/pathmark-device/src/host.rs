//! The host's C compiler as a device: `cc`, or the compiler that `CC` names. The thread that calls `run` computes the
//! items.
#![expect(unsafe_code, reason = "a function that was compiled a moment ago is called; its text is in this crate")]

use super::library::in_full;
use super::{Compiled, Costs, Device, DeviceError, Dialect, HOST, Listed, Loaded, Result};
use libloading::Library;
use std::env;
use std::ffi::{OsString, c_void};
use std::fs;
use std::process::Command;
use std::sync::{Arc, Mutex};

/// `pathmark_run` of `dialect/c_entry.cl`.
type Run = unsafe extern "C" fn(*const *const c_void, *const u32, u32, *mut u64);

/// Operations are neither fused nor reordered; nothing reads `errno`.
const OPTIONS: &[&str] = &[
    "-x",
    "c",
    "-std=gnu99",
    "-O2",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-strict-aliasing",
    "-fPIC",
    "-shared",
    "-w",
];

fn compiler() -> OsString {
    env::var_os("CC").filter(|name| !name.is_empty()).unwrap_or_else(|| "cc".into())
}

/// The first line of the compiler's version text.
fn version() -> Result<String> {
    let missing = |why: String| DeviceError::Missing { id: HOST.to_string(), why };
    let name = compiler();
    let asked = Command::new(&name).arg("--version").output();
    let said = asked.map_err(|e| missing(format!("the C compiler {}: {e}", name.display())))?;
    let text = String::from_utf8_lossy(&said.stdout);
    let line = text.lines().next().filter(|_| said.status.success());
    line.map(str::to_string).ok_or_else(|| missing(format!("{} --version failed", name.display())))
}

pub(crate) fn list() -> Vec<Listed> {
    let found = version();
    let is_there = found.is_ok();
    let about = found.unwrap_or_else(|error| error.to_string());
    vec![Listed { id: HOST.to_string(), about, is_there, is_broken: false, is_accelerator: false }]
}

/// The host processor, programmed with the C compiler.
pub(crate) struct Host {
    about: String,
    compiled: Compiled<Arc<Library>>,
}

impl Host {
    pub(crate) fn open() -> Result<Self> {
        Ok(Self { about: version()?, compiled: Compiled(Mutex::default()) })
    }

    fn compile(&self, text: &str) -> Result<Library> {
        let refused = |log: String| DeviceError::Compiler { compiler: self.about.clone(), log };
        let failed = |e: std::io::Error| refused(e.to_string());
        let folder = tempfile::Builder::new().prefix("pathmark-device-").tempdir().map_err(failed)?;
        let [source, library] = ["program.c", "program.so"].map(|name| folder.path().join(name));
        fs::write(&source, Dialect::C.whole(text)).map_err(failed)?;
        let said = Command::new(compiler())
            .args(OPTIONS)
            .arg("-o")
            .arg(&library)
            .arg(&source)
            .arg("-lm")
            .output()
            .map_err(failed)?;
        if !said.status.success() {
            return Err(refused(String::from_utf8_lossy(&said.stderr).into_owned()));
        }
        // SAFETY: the library runs no code when it is loaded. Its file may be deleted, because it is mapped.
        unsafe { Library::new(&library) }.map_err(|e| refused(in_full(&e)))
    }
}

impl Device for Host {
    fn id(&self) -> &str {
        HOST
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn width(&self) -> u32 {
        1
    }

    fn bind(&self, text: &str, numbers: &[f64], words: &[u32]) -> Result<Box<dyn Loaded>> {
        let compile = || self.compiled.get(text, || self.compile(text).map(Arc::new));
        let copy = |library| Ok((library, numbers.to_vec(), words.to_vec()));
        let ((library, numbers, words), costs) = Costs::of(compile, copy)?;
        // SAFETY: the text defines this function with this type.
        let found = unsafe { library.get::<Run>(c"pathmark_run") };
        let run = *found.map_err(|e| DeviceError::Compiler { compiler: self.about.clone(), log: in_full(&e) })?;
        Ok(Box::new(Bound { run, numbers, words, costs, _library: library }))
    }
}

/// A compiled function with its inputs.
struct Bound {
    run: Run,
    numbers: Vec<f64>,
    words: Vec<u32>,
    costs: Costs,
    /// The library that contains the function.
    _library: Arc<Library>,
}

impl Loaded for Bound {
    fn costs(&self) -> Costs {
        self.costs
    }

    fn run(&self, task: &[u32], items: u32, out: &mut [u64]) -> Result<()> {
        let inputs = [self.numbers.as_ptr().cast::<c_void>(), self.words.as_ptr().cast()];
        // SAFETY: the function reads its inputs, and writes only the words of each item for which the caller made room.
        unsafe { (self.run)(inputs.as_ptr(), task.as_ptr(), items, out.as_mut_ptr()) };
        Ok(())
    }
}
