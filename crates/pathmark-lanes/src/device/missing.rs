//! The error of a missing device.

use crate::processor::DEVICE_NAME;
use pathmark_tracer::error::{Error, InputError};

/// The error of a missing device.
pub(super) fn missing(kernel: &str) -> Error {
    let (all, named) = (pathmark_device::list(), kernel.split_once(':').map(|(_, id)| id));
    let missing = all.iter().filter(|listed| !listed.is_there);
    let why: Vec<String> = missing.map(|listed| format!("{}: {}", listed.id, listed.about)).collect();
    let why = if why.is_empty() { String::new() } else { format!(" ({})", why.join("; ")) };
    let problem = match named {
        Some(id) => format!("there is no device {id} here{why}"),
        None => format!("there is no GPU here{why}"),
    };
    let ids = all.iter().filter(|listed| listed.is_there).map(|listed| format!("{DEVICE_NAME}:{}", listed.id));
    let allowed: Vec<String> = ids.collect();
    InputError::new("kernel", kernel, problem).allowed(allowed.join(", ")).into()
}
