//! What our own concurrent primitives are made of.
//!
//! `counter`, `locked_queue`, `panics`, `ranges` and `taken` take these types from here and from nowhere else. So `tests/loom/main.rs` can
//! include the same files beside a module of this name that has loom's types, which try every interleaving. Those five files hold no
//! unit tests: outside a model loom's types don't work.

pub(super) use std::sync::Mutex;
pub(super) use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

pub(super) use crossbeam::utils::{Backoff, CachePadded};
