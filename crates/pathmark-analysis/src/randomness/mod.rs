//! Whether numbers are as random as they should be: scores that are standard normal if they are, and far from 0 on either side if not.

pub mod battery;
pub mod correlation;
pub mod fourier;
pub mod repeats;
