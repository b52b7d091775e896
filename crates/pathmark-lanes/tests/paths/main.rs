//! Tests of whole paths. They are in this crate because all its code is optimised in every build; estimators are slow
//! otherwise.

mod coincident;
mod extremes;
mod rays;
mod scales;

#[path = "../../../../tests/support/watchdog.rs"]
mod watchdog;
