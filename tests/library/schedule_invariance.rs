//! Schedule invariance: workers, order, pieces and outputs change no bit (docs/notes/determinism.md).

use pathmark::kernel::Spec;
use pathmark::measure::{OUTPUTS, Outcome, Rounds, Settings, Setup};
use pathmark::sampling::SAMPLERS;
use pathmark::scene::{Scene, load};
use pathmark::strategy::{STRATEGIES, Workers};
use std::sync::{Arc, LazyLock};

const DECOMPOSITIONS: [&str; 11] = [
    "rows",
    "bands:7",
    "grid:16",
    "tiles:32x32",
    "tiles:4x4:hilbert",
    "tiles:5x3:spiral",
    "tiles:4x4:cost",
    "tiles:24x16",
    "tiles:1x1",
    "samples:16:8x8",
    "samples:32:24x16",
];

/// Not a multiple of a block of samples, so that the last part of a pixel is shorter than the others.
const SPP: u32 = 40;

static SCENE: LazyLock<Arc<Scene>> = LazyLock::new(|| Arc::new(load("cornell").unwrap()));

fn settings() -> Settings {
    let spec = Spec { width: 24, height: 16, seed: 7, ..Spec::default() };
    let (decomposition, strategy) = ("rows".into(), "serial".into());
    Settings { spp: SPP, spec, decomposition, strategy, threads: 1, ..Settings::default() }
}

fn run(settings: Settings) -> Outcome {
    Setup::for_scene(Arc::clone(&SCENE), settings).unwrap().run(None).unwrap()
}

fn assert_same(found: &Outcome, expected: &Outcome, what: &str) {
    assert!(expected.checksum.is_some());
    assert_eq!((&found.checksum, found.counts), (&expected.checksum, expected.counts), "{what}");
}

#[test]
fn strategies_threads_and_decompositions() {
    /// Pieces that are small, and pieces of a pixel's samples: every strategy renders them with every number of threads.
    const ALWAYS: [&str; 2] = ["tiles:1x1", "samples:16:8x8"];
    let expected = run(settings());
    for (turn, strategy) in STRATEGIES.iter().enumerate() {
        // One thread is enough for strategies that ignore the number of threads.
        let counts: &[usize] = if strategy.workers == Workers::Threads { &[1, 2, 5, 64] } else { &[1] };
        for (index, &threads) in counts.iter().enumerate() {
            // The others take turns.
            let is_now = |(at, decomposition): &(usize, &str)| {
                (at + turn) % counts.len() == index || ALWAYS.contains(decomposition)
            };
            for (_, decomposition) in DECOMPOSITIONS.into_iter().enumerate().filter(is_now) {
                let what = format!("{} with {threads} threads on {decomposition}", strategy.name);
                let (strategy, decomposition) = (strategy.name.into(), decomposition.into());
                assert_same(&run(Settings { strategy, threads, decomposition, ..settings() }), &expected, &what);
            }
        }
    }
}

/// A device beside the workers: the image is the same whichever of them renders a piece, in either precision.
#[test]
fn a_device_beside_any_strategy() {
    let with = |kernel: &str, precision: &str, changed: Settings| {
        let spec = Spec { kernel: kernel.into(), precision: precision.into(), ..changed.spec };
        run(Settings { spec, ..changed })
    };
    for precision in ["f64", "f32"] {
        let expected = with("lanes", precision, settings());
        for strategy in STRATEGIES {
            for (threads, decomposition) in [(1, "tiles:4x4"), (3, "samples:16:8x8")] {
                let what = format!("{} with {threads} threads on {decomposition}, {precision}", strategy.name);
                let (strategy, decomposition) = (strategy.name.into(), decomposition.into());
                let settings = Settings { strategy, threads, decomposition, ..settings() };
                let found = with("lanes+device:host", precision, settings);
                assert_eq!(found.checksum, expected.checksum, "{what}");
                assert_eq!(found.trace.jobs.len(), found.plan.len(), "{what}");
            }
        }
        for output in OUTPUTS {
            let settings =
                Settings { output: output.name.into(), strategy: "dynamic".into(), threads: 2, ..settings() };
            let found = with("lanes+device:host", precision, settings);
            assert_eq!(found.checksum, expected.checksum, "{}, {precision}", output.name);
        }
    }
}

#[test]
fn outputs() {
    let expected = run(settings());
    for output in OUTPUTS {
        for strategy in ["serial", "shared-counter", "rayon"] {
            for decomposition in DECOMPOSITIONS {
                let what = format!("{} from {strategy} on {decomposition}", output.name);
                let (output, strategy, decomposition) = (output.name.into(), strategy.into(), decomposition.into());
                let settings = Settings { output, strategy, decomposition, threads: 5, ..settings() };
                assert_same(&run(settings), &expected, &what);
            }
        }
    }
}

/// Renders in rounds that end at these numbers of samples. The last is [`SPP`], so that the expected film is the same.
fn run_in_rounds(settings: Settings, rounds: &[u32]) -> Outcome {
    let mut film = Rounds::new(Setup::for_scene(Arc::clone(&SCENE), settings).unwrap()).unwrap();
    for &spp in rounds {
        let times = film.extend_to(spp, None).unwrap();
        assert_eq!((film.spp(), times.paths > 0), (spp, true));
    }
    film.outcome()
}

/// Several rounds give the bits of a single one, with every strategy, decomposition and output, wherever they end.
#[test]
fn rounds() {
    let expected = run(settings());
    for strategy in STRATEGIES {
        for decomposition in DECOMPOSITIONS {
            let what = format!("{} on {decomposition}", strategy.name);
            let (strategy, decomposition) = (strategy.name.into(), decomposition.into());
            let found = run_in_rounds(Settings { strategy, threads: 3, decomposition, ..settings() }, &[16, SPP]);
            assert_same(&found, &expected, &what);
        }
    }
    for output in OUTPUTS {
        let settings = Settings { output: output.name.into(), threads: 3, ..settings() };
        assert_same(&run_in_rounds(settings, &[32, SPP]), &expected, output.name);
    }
    // Rounds that end inside a block render its samples again, so that only the image is the same.
    for rounds in [&[4, 8, 12, 16, 20, SPP][..], &[4, 36, SPP], &[20, 28, SPP]] {
        assert_eq!(run_in_rounds(settings(), rounds).film, expected.film, "{rounds:?}");
    }
}

/// Adaptive sampling: each pixel has the same number of samples and the same bits, with every strategy, decomposition
/// and output.
#[test]
fn adaptive() {
    let run = |settings| {
        let settings = Settings { adaptive: true, ..settings };
        Setup::for_scene(Arc::clone(&SCENE), settings).unwrap().run(None).unwrap()
    };
    let expected = run(settings());
    for strategy in STRATEGIES {
        for decomposition in DECOMPOSITIONS {
            let what = format!("{} on {decomposition}", strategy.name);
            let (strategy, decomposition) = (strategy.name.into(), decomposition.into());
            assert_same(&run(Settings { strategy, threads: 3, decomposition, ..settings() }), &expected, &what);
        }
    }
    for output in OUTPUTS {
        assert_same(&run(Settings { output: output.name.into(), threads: 3, ..settings() }), &expected, output.name);
    }
}

/// Rounds refuse settings that they cannot render, and a film never shrinks.
#[test]
fn rounds_refuse() {
    let prepared = |settings| Setup::for_scene(Arc::clone(&SCENE), settings).unwrap();
    let clamped = Settings { spec: Spec { clamp: Some("subpixel".into()), ..settings().spec }, ..settings() };
    assert!(Rounds::new(prepared(clamped)).is_err());
    let mut film = Rounds::new(prepared(settings())).unwrap();
    assert!(film.extend_to(18, None).is_err() && film.extend_to(0, None).is_err() && film.spp() == 0);
    film.extend_to(20, None).unwrap();
    let before = film.film();
    assert_eq!(film.extend_to(16, None).unwrap().paths, 0);
    assert_eq!((film.spp(), film.film()), (20, before));
}

/// A sampler that is marked as not deterministic gives no checksum, and another order of the pixels changes their
/// random numbers. A deterministic sampler gives the same in any order, and with several threads.
#[test]
fn only_deterministic_samplers_have_a_checksum() {
    for sampler in SAMPLERS {
        let render = |strategy: &str, threads, decomposition: &str| {
            let spec = Spec { sampler: sampler.name.into(), ..settings().spec };
            let (strategy, decomposition) = (strategy.into(), decomposition.into());
            run(Settings { spec, strategy, threads, decomposition, ..settings() })
        };
        let rows = render("serial", 1, "rows");
        assert_eq!(rows.checksum.is_some(), sampler.deterministic, "{}", sampler.name);
        let tiles = render("serial", 1, "tiles:8x8");
        assert_eq!(tiles.checksum, rows.checksum, "{}", sampler.name);
        assert_eq!(tiles.film == rows.film, sampler.deterministic, "{}", sampler.name);
        if sampler.deterministic {
            assert_eq!(render("shared-counter", 3, "rows").checksum, rows.checksum, "{}", sampler.name);
        }
    }
}

/// The order by cost hands out the most expensive tiles first, judged by the ray counts of the full render.
#[test]
fn the_order_by_cost_follows_the_rays() {
    let spec = Spec { width: 96, height: 72, ..settings().spec };
    let outcome = run(Settings { spec, decomposition: "tiles:16x16:cost".into(), ..settings() });
    let rays: Vec<f64> = outcome.job_counts.iter().map(|counts| counts.rays as f64).collect();
    let third = rays.len() / 3;
    let (first, last): (f64, f64) = (rays[..third].iter().sum(), rays[rays.len() - third..].iter().sum());
    // 30 tiles, some of them cut at the lower edge: sizes and contents differ by more than a pilot can be wrong.
    assert!(first > 1.3 * last, "{rays:?}");
    let largest = rays.iter().copied().fold(0.0, f64::max);
    assert!(rays[..third].contains(&largest), "{rays:?}");
}
