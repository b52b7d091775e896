//! The building blocks of our own concurrent primitives.
//!
//! `counter`, `locked_queue`, `panics`, `ranges` and `taken` import these types only from here. So `tests/loom/main.rs`
//! can include the same files beside a module of this name with loom's types, which try every interleaving. Those five
//! files have no unit tests, because loom's types work only inside a model.

pub(super) use std::sync::Mutex;
pub(super) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

pub(super) use crossbeam::utils::{Backoff, CachePadded};
