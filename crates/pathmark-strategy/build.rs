//! With the feature `openmp`, compiles the loops of the OpenMP strategies and links the runtime that comes with GCC.

fn main() {
    println!("cargo::rerun-if-changed=src/strategies/openmp/shim.c");
    #[cfg(feature = "openmp")]
    {
        cc::Build::new().file("src/strategies/openmp/shim.c").flag("-fopenmp").compile("pathmark_openmp");
        println!("cargo::rustc-link-lib=gomp");
    }
}
