//! The processors of a replay: their speeds, and the time that the operating system takes from them.
//!
//! Speeds are relative: 1 is the processor on which the job costs were measured. Each worker has its own processor:
//! worker w has the speed of processor w.

use rand::Rng;
use rand_pcg::Pcg32;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hardware {
    pub speeds: Speeds,
    pub noise: Option<Noise>,
}

/// The speed of each processor, relative to the one on which the costs were measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Speeds {
    #[default]
    Identical,
    OneSlow(f64),
    /// Performance and efficient cores. The system fills the fast ones first.
    Mixed {
        performance: usize,
        efficient: f64,
    },
}

/// Interruptions by the operating system: they hit each processor at random times (a Poisson process of its working
/// time) and all last equally long.
///
/// Petrini, Kerbyson and Pakin, "The case of the missing supercomputer performance", SC 2003, describe the effect of
/// such noise on a machine whose processors wait for each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    fraction: f64,
    length_s: f64,
    seed: u64,
}

impl Noise {
    /// Interruptions of `length_s` seconds that take `fraction` of the time. `None` unless 0 <= fraction < 1 and length > 0.
    pub fn new(fraction: f64, length_s: f64, seed: u64) -> Option<Self> {
        let sensible = (0.0..1.0).contains(&fraction) && length_s > 0.0 && length_s.is_finite();
        sensible.then_some(Self { fraction, length_s, seed })
    }

    /// The mean number of interruptions of `work_s` seconds of work. At r of them per second, each of L seconds, the
    /// fraction r L / (1 + r L) of the time is lost.
    pub fn interruptions(&self, work_s: f64) -> f64 {
        work_s * self.fraction / ((1.0 - self.fraction) * self.length_s)
    }
}

impl Hardware {
    pub fn speed(&self, processor: usize) -> f64 {
        match self.speeds {
            Speeds::OneSlow(speed) if processor == 0 => speed,
            Speeds::Mixed { performance, efficient } if processor >= performance => efficient,
            _ => 1.0,
        }
    }

    /// The speeds of the first `processors` processors, fastest first, reduced by the average loss to noise.
    pub(super) fn average_speeds(&self, processors: usize) -> Vec<f64> {
        let share = 1.0 - self.noise.map_or(0.0, |noise| noise.fraction);
        let mut speeds: Vec<f64> = (0..processors).map(|processor| share * self.speed(processor)).collect();
        speeds.sort_by(|a, b| b.total_cmp(a));
        speeds
    }
}

pub(super) struct Processor {
    speed: f64,
    interruptions: Option<Interruptions>,
}

struct Interruptions {
    length_s: f64,
    /// Mean working time between two of them, in seconds.
    mean_s: f64,
    next_s: f64,
    random: Pcg32,
}

impl Processor {
    pub(super) fn new(hardware: &Hardware, processor: usize) -> Self {
        let interruptions = hardware.noise.filter(|noise| noise.fraction > 0.0).map(|noise| {
            let mean_s = 1.0 / noise.interruptions(1.0);
            let mut random = Pcg32::new(noise.seed, processor as u64);
            let next_s = exponential(&mut random, mean_s);
            Interruptions { length_s: noise.length_s, mean_s, next_s, random }
        });
        Self { speed: hardware.speed(processor), interruptions }
    }

    /// Returns the seconds that it needs for work that takes a processor of speed 1 `work_s` seconds.
    pub(super) fn elapsed_s(&mut self, work_s: f64) -> f64 {
        let own_s = work_s / self.speed;
        self.interruptions.as_mut().map_or(own_s, |interruptions| own_s + interruptions.lost_s(own_s))
    }
}

impl Interruptions {
    fn lost_s(&mut self, mut work_s: f64) -> f64 {
        let mut lost_s = 0.0;
        while self.next_s < work_s {
            work_s -= self.next_s;
            lost_s += self.length_s;
            self.next_s = exponential(&mut self.random, self.mean_s);
        }
        self.next_s -= work_s;
        lost_s
    }
}

/// Draws a time from the exponential distribution, by inversion; the uniform random number is in (0, 1].
fn exponential(random: &mut Pcg32, mean_s: f64) -> f64 {
    let uniform = (f64::from(random.next_u32()) + 1.0) / 4_294_967_296.0;
    -mean_s * libm::log(uniform)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_of_each_kind() {
        let slow = Hardware { speeds: Speeds::OneSlow(0.5), ..Hardware::default() };
        assert_eq!((slow.speed(0), slow.speed(1)), (0.5, 1.0));
        let mixed = Hardware { speeds: Speeds::Mixed { performance: 2, efficient: 0.25 }, ..Hardware::default() };
        assert_eq!(mixed.average_speeds(4), [1.0, 1.0, 0.25, 0.25]);
        assert_eq!(Processor::new(&mixed, 3).elapsed_s(2.0), 8.0);
    }

    /// 10 000 pieces of 1 s of work: 100 000 interruptions, and so a statistical error of 0.4 % in the lost time.
    #[test]
    fn noise_takes_its_fraction() {
        for fraction in [0.05, 0.2, 0.5] {
            let length_s = 0.1 * fraction / (1.0 - fraction);
            let hardware = Hardware { noise: Noise::new(fraction, length_s, 1), ..Hardware::default() };
            let mut processor = Processor::new(&hardware, 0);
            let elapsed: f64 = (0..10_000).map(|_| processor.elapsed_s(1.0)).sum();
            let expected = 10_000.0 / (1.0 - fraction);
            assert!((elapsed / expected - 1.0).abs() < 0.02 * fraction, "{fraction}: {elapsed} instead of {expected}");
        }
    }

    #[test]
    fn senseless_noise_is_refused() {
        let refused = [(1.0, 1.0), (-0.1, 1.0), (0.1, 0.0), (f64::NAN, 1.0), (0.1, f64::INFINITY)];
        assert!(refused.iter().all(|&(fraction, length_s)| Noise::new(fraction, length_s, 1).is_none()));
    }
}
