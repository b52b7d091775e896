//! The MPI library, opened at run time, and its functions.
#![expect(
    unsafe_code,
    reason = "functions that are found at run time have the types that MPI's standard says; each block says why it is sound"
)]

use crate::MpiError;
use crate::abi::{Abi, Handle};
use crate::launcher::Launcher;
use libloading::os::unix::{Library as Opened, RTLD_GLOBAL, RTLD_NOW};
use std::ffi::{CStr, CString, c_char, c_int, c_void};
use std::mem::{ManuallyDrop, transmute_copy};
use std::path::{Path, PathBuf};

/// Names of libraries. The launcher's library is tried first.
#[cfg(not(target_vendor = "apple"))]
const OPEN_MPI: &[&str] = &["libmpi.so.40"];
#[cfg(not(target_vendor = "apple"))]
const MPICH: &[&str] = &["libmpich.so.12", "libmpi.so.12", "libmpi_abi.so.1", "libmpi_abi.so.0"];

// Apple's systems write the version before the extension, and do not search the folder of the package manager.
#[cfg(target_vendor = "apple")]
const OPEN_MPI: &[&str] = &["libmpi.40.dylib", "/opt/homebrew/lib/libmpi.40.dylib"];
#[cfg(target_vendor = "apple")]
const MPICH: &[&str] = &["libmpi.12.dylib", "/opt/homebrew/lib/libmpi.12.dylib", "libmpi_abi.0.dylib"];

/// An open library, which is never closed.
pub(crate) struct Symbols {
    opened: ManuallyDrop<Opened>,
    path: PathBuf,
}

impl Symbols {
    /// Opens the library that the user names, or the first usual one that can be opened.
    fn open(named: Option<&Path>) -> Result<Self, MpiError> {
        if let Some(path) = named {
            let no_library = |why| MpiError::NoLibrary { path: path.to_path_buf(), why };
            return Self::open_one(path).map_err(no_library);
        }
        let is_open_mpi = Launcher::of_environment().is_some_and(|launcher| launcher.is_open_mpi);
        let order = if is_open_mpi { [OPEN_MPI, MPICH] } else { [MPICH, OPEN_MPI] };
        let mut tried = Vec::new();
        for name in order.into_iter().flatten() {
            match Self::open_one(Path::new(name)) {
                Ok(symbols) => return Ok(symbols),
                Err(why) => tried.push(why),
            }
        }
        Err(MpiError::Missing { tried: tried.join("; ") })
    }

    fn open_one(path: &Path) -> Result<Self, String> {
        // SAFETY: the code that MPI's libraries run when they are opened needs nothing that Rust must keep. Open MPI's plugins
        // look for its functions among those of the whole process.
        let opened = unsafe { Opened::open(Some(path), RTLD_NOW | RTLD_GLOBAL) }.map_err(|e| e.to_string())?;
        Ok(Self { opened: ManuallyDrop::new(opened), path: path.to_path_buf() })
    }

    /// The last part of the library's name.
    pub(crate) fn file_name(&self) -> String {
        self.path.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The address of a function or a variable; `None` if the library lacks it.
    pub(crate) fn address(&self, name: &CStr) -> Option<Handle> {
        // SAFETY: only the address is asked for.
        unsafe { self.opened.get::<*mut c_void>(name) }.ok().map(|symbol| symbol.into_raw() as Handle)
    }
}

/// Declares the functions in use, and looks all of them up when the library is opened.
macro_rules! functions {
    ($($field:ident = $symbol:literal ($($argument:ty),*);)*) => {
        /// The MPI functions in use, with the types of the C interface. They return 0 on success.
        pub(crate) struct Functions {
            $(pub(crate) $field: unsafe extern "C" fn($($argument),*) -> c_int,)*
        }

        impl Functions {
            fn of(symbols: &Symbols) -> Result<Self, MpiError> {
                Ok(Self {
                    $($field: {
                        let no_symbol = || MpiError::NoSymbol { library: symbols.path.display().to_string(), symbol: $symbol };
                        let name = CString::new($symbol).map_err(|_| no_symbol())?;
                        let address = symbols.address(&name).ok_or_else(no_symbol)?;
                        // SAFETY: MPI's standard gives the function of that name this type, handles being as wide as `Handle` or passed
                        // in the low half of its register.
                        unsafe { transmute_copy::<Handle, unsafe extern "C" fn($($argument),*) -> c_int>(&address) }
                    },)*
                })
            }
        }
    };
}

functions! {
    init_thread = "MPI_Init_thread" (*mut c_int, *mut *mut *mut c_char, c_int, *mut c_int);
    finalize = "MPI_Finalize" ();
    rank = "MPI_Comm_rank" (Handle, *mut c_int);
    size = "MPI_Comm_size" (Handle, *mut c_int);
    version = "MPI_Get_library_version" (*mut c_char, *mut c_int);
    barrier = "MPI_Barrier" (Handle);
    send = "MPI_Send" (*const c_void, c_int, Handle, c_int, c_int, Handle);
    receive = "MPI_Recv" (*mut c_void, c_int, Handle, c_int, c_int, Handle, *mut c_void);
    probe = "MPI_Iprobe" (c_int, c_int, Handle, *mut c_int, *mut c_void);
    all_gather = "MPI_Allgather" (*const c_void, c_int, Handle, *mut c_void, c_int, Handle, Handle);
    gather_v = "MPI_Gatherv" (*const c_void, c_int, Handle, *mut c_void, *const c_int, *const c_int, Handle, c_int, Handle);
    window_allocate = "MPI_Win_allocate" (isize, c_int, Handle, Handle, *mut *mut c_void, *mut Handle);
    window_lock_all = "MPI_Win_lock_all" (c_int, Handle);
    window_unlock_all = "MPI_Win_unlock_all" (Handle);
    window_flush = "MPI_Win_flush" (c_int, Handle);
    window_free = "MPI_Win_free" (*mut Handle);
    fetch_and_op = "MPI_Fetch_and_op" (*const c_void, *mut c_void, Handle, c_int, isize, Handle, Handle);
}

/// A library with its functions and constants.
pub(crate) struct Library {
    pub(crate) functions: Functions,
    pub(crate) abi: Abi,
    pub(crate) name: String,
}

impl Library {
    pub(crate) fn open(named: Option<&Path>) -> Result<Self, MpiError> {
        let symbols = Symbols::open(named)?;
        let functions = Functions::of(&symbols)?;
        Ok(Self { functions, abi: Abi::of(&symbols), name: symbols.path.display().to_string() })
    }
}
