//! A workload outside Pathmark: counts primes by trial division.

use pathmark::kernel::workload::{Item, Workload};

pub struct Primes;

impl Workload for Primes {
    fn about(&self) -> &'static str {
        "counts primes by trial division"
    }

    fn run(&self, item: &Item) -> [f64; 3] {
        let first = 64 * item.index();
        let count = (first..first + 64).filter(|number| is_prime(*number)).count();
        [count as f64 / 64.0; 3]
    }
}

fn is_prime(number: u64) -> bool {
    number > 1 && (2..).take_while(|divisor| divisor * divisor <= number).all(|divisor| !number.is_multiple_of(divisor))
}
