//! What stands before and after a program, so that a compiler takes it for its own language.

/// A language of the three.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// C of 1999, as GCC and Clang know it.
    C,
    /// OpenCL C 1.2 with double precision.
    OpenCl,
    /// CUDA C++ without headers.
    Cuda,
}

impl Dialect {
    /// The whole text for the compiler.
    pub fn whole(self, program: &str) -> String {
        let (words, entry) = match self {
            Self::C => (include_str!("dialect/c.cl"), include_str!("dialect/c_entry.cl")),
            Self::OpenCl => (include_str!("dialect/opencl.cl"), include_str!("dialect/opencl_entry.cl")),
            Self::Cuda => (include_str!("dialect/cuda.cl"), include_str!("dialect/cuda_entry.cl")),
        };
        [words, program, entry].concat()
    }
}
