//! Tests of whole paths. They are in this crate because all its code is optimised in every build; estimators are slow
//! otherwise.

mod equilibrium;
mod rays;
