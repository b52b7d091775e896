//! Tests of random numbers: scores that are standard normal for random numbers, and far from 0 on either side for
//! others.

pub mod battery;
pub mod correlation;
pub mod fourier;
pub mod repeats;
