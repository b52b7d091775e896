//! What can go wrong with a device.

use thiserror::Error;

/// Why there is no device, or why it failed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DeviceError {
    /// Nothing is called that.
    #[error("{id} is no device (there is cuda:N, opencl:N with a number N from 0, or host)")]
    NoName {
        /// As it was written.
        id: String,
    },
    /// There is no such device here.
    #[error("there is no {id} here: {why}")]
    Missing {
        /// Its name.
        id: String,
        /// What was tried.
        why: String,
    },
    /// The compiler refused the program.
    #[error("{compiler} refused the program:\n{log}")]
    Compiler {
        /// Whose compiler.
        compiler: String,
        /// What it said.
        log: String,
    },
    /// A call of the device's driver failed.
    #[error("{call} failed: {why}")]
    Call {
        /// The function.
        call: &'static str,
        /// What the driver says of it.
        why: String,
    },
    /// It does not round as IEEE 754 demands.
    #[error("it does not compute as IEEE 754 demands: {operation}")]
    Inexact {
        /// The operation and its operands.
        operation: String,
    },
}
