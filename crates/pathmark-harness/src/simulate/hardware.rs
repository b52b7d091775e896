//! The processors of a replay, by their speeds.
//!
//! Speeds are relative: 1 is the processor on which the job costs were measured. Each worker has its own processor:
//! worker w has the speed of processor w.

/// The speed of each processor, relative to the one on which the costs were measured.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Hardware {
    #[default]
    Identical,
    OneSlow(f64),
    /// Performance and efficient cores. The system fills the fast ones first.
    Mixed {
        performance: usize,
        efficient: f64,
    },
}

impl Hardware {
    pub fn speed(&self, processor: usize) -> f64 {
        match *self {
            Self::OneSlow(speed) if processor == 0 => speed,
            Self::Mixed { performance, efficient } if processor >= performance => efficient,
            _ => 1.0,
        }
    }

    /// The speeds of the first `processors` processors, fastest first.
    pub(super) fn fastest_first(&self, processors: usize) -> Vec<f64> {
        let mut speeds: Vec<f64> = (0..processors).map(|processor| self.speed(processor)).collect();
        speeds.sort_by(|a, b| b.total_cmp(a));
        speeds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn speeds_of_each_kind() {
        let slow = Hardware::OneSlow(0.5);
        assert_eq!((slow.speed(0), slow.speed(1)), (0.5, 1.0));
        let mixed = Hardware::Mixed { performance: 2, efficient: 0.25 };
        assert_eq!(mixed.fastest_first(4), [1.0, 1.0, 0.25, 0.25]);
    }
}
