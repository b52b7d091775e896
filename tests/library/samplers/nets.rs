//! Distribution of a few samples of one pixel over the square: exact counts.

use super::{Use, all_keyed, keyed};
use pathmark::sampling::{Purpose, Sampler};
use std::ops::Range;

/// Uses at early and late bounces, of main paths and branches.
const USES: [Use; 6] = [
    Use { bounce: 0, branch: 0, purpose: Purpose::Film },
    Use { bounce: 1, branch: 0, purpose: Purpose::Bsdf },
    Use { bounce: 5, branch: 0, purpose: Purpose::Roulette },
    Use { bounce: 2, branch: 3, purpose: Purpose::Bsdf },
    Use { bounce: 15, branch: 0, purpose: Purpose::Medium },
    Use { bounce: 4000, branch: 0, purpose: Purpose::Bsdf },
];

const KEYS: [(u64, u32); 4] = [(0, 0), (1, 0), (0x0123_4567_89AB_CDEF, 77), (u64::MAX, u32::MAX)];

fn points(sampler: &dyn Sampler, (seed, pixel): (u64, u32), used: Use, samples: Range<u32>) -> Vec<[f64; 2]> {
    samples.map(|sample| sampler.pair(used.of(seed, pixel, sample))).collect()
}

/// The sampler with each key.
fn sobols() -> impl Iterator<Item = (Box<dyn Sampler>, (u64, u32))> {
    KEYS.into_iter().map(|key| (keyed("sobol"), key))
}

/// Whether each of `columns` x `rows` equal cells contains exactly one of the points.
fn one_in_each_cell(points: &[[f64; 2]], columns: u32, rows: u32) -> bool {
    let mut seen = vec![false; points.len()];
    let place =
        |[u, v]: [f64; 2]| (u * f64::from(columns)) as usize + (v * f64::from(rows)) as usize * columns as usize;
    points.iter().all(|point| !std::mem::replace(&mut seen[place(*point)], true))
}

/// A (0, 2)-sequence in base 2: aligned blocks of 2^m samples, from the first to far beyond 2^16, on every grid of 2^m
/// cells. (Blocks of two are not nets for the first uses, because their fours are in any order.)
#[test]
fn sobol_pairs_are_nets_on_every_grid() {
    for (sampler, key) in sobols() {
        for used in USES {
            for m in [0, 2, 3, 4, 5, 6, 7, 8, 9, 10] {
                let size = 1_u32 << m;
                for start in [0, 3 * size, 1 << 16, 1 << 24, u32::MAX - (2 * size - 1)] {
                    let points = points(&*sampler, key, used, start..start + size);
                    for a in 0..=m {
                        let fine = one_in_each_cell(&points, 1 << a, 1 << (m - a));
                        assert!(fine, "{key:?} {used:?}: samples {start}.., {} x {} cells", 1 << a, 1 << (m - a));
                    }
                }
            }
        }
    }
}

/// The position in the pixel and the first direction together form (0, 4)-sequences in base 4, and the samples of each
/// subpixel form (1, m - 1, 4)-nets. So 4^m samples have one in each cell of every grid of 4^m cells, and the samples
/// of a subpixel have four in each cell of every grid of 4^(m-2) cells.
#[test]
fn the_leading_sobol_pairs_are_nets_together() {
    for (sampler, key) in sobols() {
        for (m, first) in [(1, 0), (2, 0), (2, 3), (3, 0), (4, 0), (4, 1), (5, 0), (5, 1 << 14)] {
            let (size, exponents) = (1_u32 << (2 * m), splits(m));
            let samples = first * size..(first + 1) * size;
            let [film, direction] = [USES[0], USES[1]].map(|used| points(&*sampler, key, used, samples.clone()));
            let all: Vec<[f64; 4]> = film.iter().zip(direction).map(|([a, b], [c, d])| [*a, *b, c, d]).collect();
            for grid in exponents {
                assert!(evenly(&all, grid, 1), "{key:?}: {size} from {first} times that, 4^{grid:?}");
            }
            for (subpixel, grid) in (0..4).flat_map(|subpixel| splits(m.max(2) - 2).map(move |grid| (subpixel, grid))) {
                let own: Vec<[f64; 4]> = all.iter().skip(subpixel).step_by(4).copied().collect();
                let each = own.len() as u32 >> (2 * (m.max(2) - 2));
                assert!(evenly(&own, grid, each), "{key:?} subpixel {subpixel}: {size} from {first} times, 4^{grid:?}");
            }
        }
    }
}

/// Every way to write `sum` as a sum of four.
fn splits(sum: u32) -> impl Iterator<Item = [u32; 4]> {
    let upper = move |taken: u32| 0..=sum - taken;
    let three = upper(0).flat_map(move |a| upper(a).flat_map(move |b| upper(a + b).map(move |c| [a, b, c])));
    three.map(move |[a, b, c]| [a, b, c, sum - a - b - c])
}

/// Whether each cell of the grid of 4^a x 4^b x 4^c x 4^d cells contains `each` of the points.
fn evenly(points: &[[f64; 4]], grid: [u32; 4], each: u32) -> bool {
    let mut counts = vec![0; 1 << (2 * grid.iter().sum::<u32>())];
    for point in points {
        let cell = point.iter().zip(grid).fold(0, |cell, (u, digits)| {
            let cells = 1_usize << (2 * digits);
            cell * cells + (u * cells as f64) as usize
        });
        counts[cell] += 1;
    }
    counts.iter().all(|count| *count == each)
}

/// Each 16 samples have one in each of 4x4 cells. Their order shows no pattern: every block has a different one.
#[test]
fn stratified_samples_share_out_the_cells() {
    let sampler = keyed("stratified");
    for key in KEYS {
        for used in USES {
            let mut orders = Vec::new();
            for block in [0, 1, 2, 3, 1 << 12, (1 << 28) - 2] {
                let points = points(&*sampler, key, used, 16 * block..16 * block + 16);
                assert!(one_in_each_cell(&points, 4, 4), "{key:?} {used:?}: block {block}");
                orders.push(points.iter().map(|[u, v]| (u * 4.0) as u32 + 4 * (v * 4.0) as u32).collect::<Vec<_>>());
            }
            orders.sort();
            orders.dedup();
            assert_eq!(orders.len(), 6, "{key:?} {used:?}: two blocks have one order");
        }
    }
}

/// smallpt's camera gives every fourth sample the same subpixel, so these samples alone must cover the whole square.
/// In Sobol's original order they stay in a quarter of it.
#[test]
fn every_fourth_sample_sees_the_whole_square() {
    for (name, sampler) in all_keyed() {
        for key in KEYS {
            for used in USES {
                for subpixel in 0..4 {
                    let mut cells = [0; 16];
                    for [u, v] in points(&*sampler, key, used, 0..2048).iter().skip(subpixel).step_by(4) {
                        cells[(u * 4.0) as usize + 4 * (v * 4.0) as usize] += 1;
                    }
                    // 32 in each on average; fewer than 8 are practically impossible.
                    let least = cells.iter().min().unwrap();
                    assert!(*least >= 8, "{name} {key:?} {used:?} subpixel {subpixel}: {cells:?}");
                }
            }
        }
    }
}

/// Random numbers stay in [0, 1) for extreme indices, seeds and pixels.
#[test]
fn numbers_stay_below_one() {
    for (name, sampler) in all_keyed() {
        for key in KEYS {
            for used in USES {
                for samples in [0..5000, u32::MAX - 5000..u32::MAX] {
                    let all = points(&*sampler, key, used, samples);
                    let inside = all.iter().flatten().all(|u| (0.0..1.0).contains(u));
                    assert!(inside, "{name} {key:?} {used:?}");
                }
            }
        }
    }
}
