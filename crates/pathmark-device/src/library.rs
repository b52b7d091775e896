//! A driver's library that is opened at run time, and the functions in it.

use libloading::Library;
use std::error::Error;
use std::path::Path;

/// Opens the first of several libraries that can be opened; otherwise returns the system's error for each.
pub(crate) fn open(names: &[&str]) -> Result<Library, String> {
    let mut tried = Vec::new();
    for name in names {
        #[expect(unsafe_code, reason = "a library may run code of its own when it is loaded; drivers expect that")]
        // SAFETY: the libraries that are named here are drivers and compilers of GPUs, made to be opened by any program.
        match unsafe { Library::new(Path::new(name)) } {
            Ok(library) => return Ok(library),
            Err(error) => tried.push(in_full(&error)),
        }
    }
    Err(tried.join("; "))
}

/// The text of an error, with the system's message.
pub(crate) fn in_full(error: &libloading::Error) -> String {
    error.source().map_or_else(|| error.to_string(), ToString::to_string)
}

/// Declares functions of a library with their C types, and looks all of them up when it is opened.
macro_rules! functions {
    ($Functions:ident; $($field:ident = $symbol:literal ($($argument:ty),*) -> $result:ty;)*) => {
        pub(crate) struct $Functions {
            $(pub(crate) $field: unsafe extern "C" fn($($argument),*) -> $result,)*
            /// The library that contains them.
            _library: libloading::Library,
        }

        impl $Functions {
            pub(crate) fn of(library: libloading::Library) -> std::result::Result<Self, String> {
                Ok(Self {
                    $($field: {
                        #[expect(unsafe_code, reason = "functions that are found at run time have the types that their interface documents")]
                        // SAFETY: the interface gives the function of that name this type, and the library stays open as long as it.
                        let found = unsafe { library.get::<unsafe extern "C" fn($($argument),*) -> $result>($symbol) };
                        *found.map_err(|e| $crate::library::in_full(&e))?
                    },)*
                    _library: library,
                })
            }
        }
    };
}
pub(crate) use functions;
