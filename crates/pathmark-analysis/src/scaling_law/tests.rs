//! Tests: a fit recovers a law from speedups made with it, and refuses points that identify no law.

use rand::Rng;
use rand_pcg::Pcg64Dxsm;

use super::{Check, Fit, Fitted, Law, Point, Reason, estimator, fit};

const WORKERS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Synthetic repetitions of a law's speedups, each with a relative error of up to `noise`.
fn made(speedup: impl Fn(f64) -> f64, workers: &[usize], repetitions: usize, noise: f64, seed: u128) -> Vec<Point> {
    // Multiplied to spread the seeds, since generators with neighbouring states start with similar output.
    let mut generator = Pcg64Dxsm::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835), 3);
    let mut off = || 1.0 + noise * ((generator.next_u64() >> 11) as f64 / 4_503_599_627_370_496.0 - 1.0);
    workers.iter().map(|&p| (p, (0..repetitions).map(|_| speedup(p as f64) * off()).collect())).collect()
}

fn universal(sigma: f64, kappa: f64) -> impl Fn(f64) -> f64 {
    move |p| p / (1.0 + sigma * (p - 1.0) + kappa * p * (p - 1.0))
}

fn found(law: Law, points: &[Point]) -> Fitted {
    match fit(law, points, 0.95) {
        Fit::Found(fitted) => fitted,
        Fit::Unidentifiable(reason) => panic!("{reason}"),
    }
}

fn refused(law: Law, points: &[Point]) -> Reason {
    match fit(law, points, 0.95) {
        Fit::Found(fitted) => panic!("{fitted:?}"),
        Fit::Unidentifiable(reason) => reason,
    }
}

/// The fitted speedup at `workers`.
fn at(fitted: &Fitted, workers: f64) -> f64 {
    let value = |index: usize| fitted.parameters.get(index).map_or(0.0, |parameter| parameter.estimate.value);
    let lost = value(0) * (workers - 1.0);
    match fitted.law {
        Law::Gustafson => workers - lost,
        Law::Amdahl | Law::Universal => workers / (1.0 + lost + value(1) * workers * (workers - 1.0)),
    }
}

#[test]
fn each_law_is_found_in_its_own_speedups() {
    type Speedup = Box<dyn Fn(f64) -> f64>;
    let cases: [(Law, Speedup, Vec<f64>); 3] = [
        (Law::Amdahl, Box::new(|p| 1.0 / (0.08 + 0.92 / p)), vec![0.08]),
        (Law::Gustafson, Box::new(|p| p - 0.2 * (p - 1.0)), vec![0.2]),
        (Law::Universal, Box::new(universal(0.03, 0.0006)), vec![0.03, 0.0006]),
    ];
    for (law, speedup, truth) in cases {
        let fitted = found(law, &made(&speedup, &WORKERS, 9, 0.02, 5));
        assert_eq!((fitted.parameters.len(), fitted.worker_counts), (truth.len(), 6));
        for (parameter, truth) in fitted.parameters.iter().zip(truth) {
            assert!((parameter.estimate.value / truth - 1.0).abs() < 0.1, "{law} {parameter:?}");
            assert!(parameter.estimate.interval.contains(truth), "{law} {parameter:?}");
        }
        assert!(matches!(fitted.check, Check::Passed { .. }), "{law} {:?}", fitted.check);
        assert!((at(&fitted, 16.0) / speedup(16.0) - 1.0).abs() < 0.02 && (at(&fitted, 1.0) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn exact_speedups_give_exact_parameters() {
    let workers = [2.0, 3.0, 10.0];
    let groups = workers.map(|p| vec![universal(0.1, 0.01)(p)]);
    let [sigma, kappa] = estimator::parameters(Law::Universal, &workers, &groups).unwrap();
    assert!((sigma - 0.1).abs() < 1e-12 && (kappa - 0.01).abs() < 1e-12, "{sigma} {kappa}");
}

#[test]
fn peak_of_the_universal_law() {
    let fitted = found(Law::Universal, &made(universal(0.04, 0.0006), &WORKERS, 9, 0.01, 8));
    let peak = fitted.peak.unwrap();
    // sqrt(0.96 / 0.0006) = 40.
    assert!(peak.interval.contains(40.0) && (peak.value - 40.0).abs() < 2.0, "{peak:?}");
    assert!(
        at(&fitted, peak.value) > at(&fitted, peak.value * 1.2)
            && at(&fitted, peak.value) > at(&fitted, peak.value / 1.2)
    );
    assert_eq!(found(Law::Amdahl, &made(|p| 1.0 / (0.08 + 0.92 / p), &WORKERS, 5, 0.01, 8)).peak, None);
}

#[test]
fn the_wrong_law_is_rejected() {
    let points = made(universal(0.03, 0.0006), &WORKERS, 9, 0.02, 6);
    let Check::Rejected { p_value } = found(Law::Amdahl, &points).check else { panic!() };
    assert!(p_value < 1e-6);
}

#[test]
fn a_true_law_is_rejected_as_often_as_stated() {
    let rejected = |seed| {
        let points = made(|p| 1.0 / (0.1 + 0.9 / p), &[2, 4, 8, 16], 5, 0.02, seed);
        let (workers, groups): (Vec<f64>, Vec<Vec<f64>>) = points.into_iter().map(|(p, s)| (p as f64, s)).unzip();
        let parameters = estimator::parameters(Law::Amdahl, &workers, &groups).unwrap();
        matches!(super::check::lack_of_fit(Law::Amdahl, parameters, &workers, &groups), Check::Rejected { .. })
    };
    let count = (0..1000).filter(|&seed| rejected(seed)).count();
    // 5 % of 1000, standard deviation 6.9.
    assert!((30..=70).contains(&count), "{count} of 1000");
}

#[test]
fn one_worker_count_gives_karp_flatt_unchecked() {
    let points = vec![(1, vec![1.0, 1.0, 1.0]), (2, vec![1.8, 1.7, 1.9, 1.75, 1.85])];
    let fitted = found(Law::Amdahl, &points);
    let karp_flatt = crate::speedup::serial_fraction(1.8, 2).unwrap();
    assert!((fitted.parameters[0].estimate.value - karp_flatt).abs() < 0.005);
    assert_eq!((fitted.check, fitted.worker_counts), (Check::NotPossible, 1));
}

#[test]
fn two_cores_do_not_identify_the_universal_law() {
    let reason = refused(Law::Universal, &[(1, vec![1.0, 1.01]), (2, vec![1.8, 1.7])]);
    assert_eq!(reason, Reason::TooFewWorkerCounts { found: 1, needed: 3 });
    assert_eq!(reason.to_string(), "there is 1 worker count above 1, and the law needs at least 3");
    assert_eq!(refused(Law::Amdahl, &[(1, vec![1.0, 1.01])]), Reason::TooFewWorkerCounts { found: 0, needed: 1 });
}

#[test]
fn superlinear_speedups_have_no_serial_fraction() {
    let reason = refused(Law::Amdahl, &made(|p| 1.1 * p, &[2, 4, 8], 7, 0.01, 2));
    assert!(matches!(reason, Reason::OutOfRange { parameter, .. } if parameter.estimate.value < 0.0));
    assert!(reason.to_string().ends_with("outside 0 to 1: the speedups are higher than the law allows"), "{reason}");
    // A speedup slightly above ideal is compatible with s = 0, and the message says so.
    let near = refused(Law::Amdahl, &[(2, vec![2.01, 1.99, 2.02, 1.98, 2.01])]);
    assert!(near.to_string().ends_with("and the data can't tell it from 0"), "{near}");
    let slow = refused(Law::Gustafson, &made(|_| 0.5, &[2, 4, 8], 7, 0.01, 2));
    assert!(slow.to_string().ends_with("lower than the law allows"), "{slow}");
    let kappa = refused(Law::Universal, &made(universal(0.3, -0.002), &[2, 4, 8, 16], 7, 0.001, 2));
    assert!(kappa.to_string().contains("is below 0"), "{kappa}");
}

#[test]
fn points_that_decide_nothing_are_refused() {
    let open = refused(Law::Amdahl, &[(2, vec![0.7, 2.4, 1.4, 0.8, 2.6])]);
    assert!(
        matches!(open, Reason::Open { .. }) && open.to_string().contains("covers everything that s can be"),
        "{open}"
    );
    assert_eq!(refused(Law::Amdahl, &[(2, vec![1.5; 4]), (4, vec![2.0; 4])]), Reason::NoSpread);
    assert_eq!(refused(Law::Amdahl, &[(2, vec![1.5, 1.6]), (4, vec![2.0])]), Reason::TooFewRepetitions);
    assert_eq!(refused(Law::Amdahl, &[(2, vec![1.5, 0.0])]), Reason::NotASpeedup);
    assert_eq!(refused(Law::Amdahl, &[(0, vec![1.5, 1.4])]), Reason::NotASpeedup);
    assert_eq!(refused(Law::Gustafson, &[]), Reason::TooFewWorkerCounts { found: 0, needed: 1 });
}
