//! Errors of devices.

use thiserror::Error;

/// The reason why there is no device, or why it failed.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum DeviceError {
    /// No device can have this name.
    #[error("{id} is not a device name (allowed: cuda:N or opencl:N with a number N from 0, or host)")]
    NoName {
        /// The name as it was written.
        id: String,
    },
    /// This machine has no such device.
    #[error("{id} is not available: {why}")]
    Missing {
        id: String,
        /// The attempts that failed.
        why: String,
    },
    /// The compiler refused the program.
    #[error("{compiler} refused the program:\n{log}")]
    Compiler {
        compiler: String,
        /// The compiler's messages.
        log: String,
    },
    /// A call of the device's driver failed.
    #[error("{call} failed: {why}")]
    Call {
        /// The driver's function.
        call: &'static str,
        /// The driver's text for the error.
        why: String,
    },
    /// The device does not round as IEEE 754 demands.
    #[error("it does not compute according to IEEE 754: {operation}")]
    Inexact { operation: String },
}
