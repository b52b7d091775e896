//! Dialects: the text before and after a program that makes it valid in a compiler's language.

/// One of the three languages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// C99 with the extensions of GCC and Clang.
    C,
    /// OpenCL C 1.2 with double precision.
    OpenCl,
    /// CUDA C++ without headers.
    Cuda,
}

impl Dialect {
    /// Returns the complete text for the compiler.
    pub fn whole(self, program: &str) -> String {
        let (words, entry) = match self {
            Self::C => (include_str!("dialect/c.cl"), include_str!("dialect/c_entry.cl")),
            Self::OpenCl => (include_str!("dialect/opencl.cl"), include_str!("dialect/opencl_entry.cl")),
            Self::Cuda => (include_str!("dialect/cuda.cl"), include_str!("dialect/cuda_entry.cl")),
        };
        [words, program, entry].concat()
    }
}
