//! Tests of whole paths. They are in this crate because estimators are slow unless they are optimised, as all code of this crate is.

mod equilibrium;
mod rays;
