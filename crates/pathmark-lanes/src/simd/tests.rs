//! Compares every operation of every instruction set with the same operation on one number, lane by lane: bit for bit,
//! NaN for NaN.

use super::{Float, MOST_LANES, Mask, Precision, Table, Words, Work, levels, on_level};
use pathmark_tracer::math::{Bits, single_unit, unit};

/// Numbers of all kinds, and words with all their bits in use.
fn numbers(from: usize) -> [f64; MOST_LANES] {
    const SPECIAL: [f64; 16] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::MIN_POSITIVE,
        5e-324,
        -5e-324,
        f64::MAX,
        f64::EPSILON,
        1.0 / 3.0,
        -2.5,
        1e200,
        -1e-200,
    ];
    std::array::from_fn(|k| SPECIAL[(k + from) % SPECIAL.len()])
}

fn words(from: u64) -> [u64; MOST_LANES] {
    std::array::from_fn(|k| match (k as u64 + from) % 8 {
        0 => 0,
        1 => u64::MAX,
        2 => 1 << 63,
        3 => 0xFFFF_FFFF,
        k => (k ^ from << 7).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(k as u32),
    })
}

struct Operations;

fn same(found: f64, expected: f64) -> bool {
    found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan())
}

fn times_plus<V: Float>(x: f64, y: f64, z: f64) -> f64 {
    if V::IS_DOUBLE { x * y + z } else { f64::from(libm::fmaf(x as f32, y as f32, z as f32)) }
}

impl Work for Operations {
    type Output = ();

    #[inline(always)]
    fn run<V: Float>(self) {
        // Every pair of numbers: few lanes hold only a few of them at a time.
        for (first, second) in (0..16).flat_map(|first| (0..16).map(move |second| (first, second))) {
            let (v, w) = (of::<V>(numbers(first)), of::<V>(numbers(second)));
            let mask = v.lt(w);
            // Of two zeros either may be the least.
            let all = V::select(v.equal(v), v, V::splat(1.0));
            let least = (0..V::LANES).map(|lane| all.lane(lane)).fold(f64::INFINITY, f64::min);
            assert!(all.least() == least, "the least is {}, not {least}", all.least());
            for lane in 0..V::LANES {
                let (x, y) = (v.lane(lane), w.lane(lane));
                // A double-precision result, rounded once more, equals the single-precision result, because it has more
                // than twice the digits (Figueroa, "When is double rounding innocuous?", 1995).
                let rounded = |exact: f64| if V::IS_DOUBLE { exact } else { f64::from(exact as f32) };
                let numbers = [
                    ("sum", (v + w).lane(lane), rounded(x + y)),
                    ("difference", (v - w).lane(lane), rounded(x - y)),
                    ("product", (v * w).lane(lane), rounded(x * y)),
                    ("quotient", (v / w).lane(lane), rounded(x / y)),
                    ("opposite", (-v).lane(lane), -x),
                    ("product and sum", v.times_plus(w, v).lane(lane), times_plus::<V>(x, y, x)),
                    // The rounding error of the product, if it is not rounded before the sum.
                    (
                        "product less itself",
                        v.times_plus(w, -(v * w)).lane(lane),
                        times_plus::<V>(x, y, -rounded(x * y)),
                    ),
                    // This sum is the same, rounded once or twice.
                    ("tripled", v.about_times_plus(V::splat(2.0), v).lane(lane), rounded(3.0 * x)),
                    ("root", v.sqrt().lane(lane), rounded(x.sqrt())),
                    ("magnitude", v.abs().lane(lane), x.abs()),
                    ("sign", v.copysign(w).lane(lane), x.copysign(y)),
                    ("choice", V::select(mask, v, w).lane(lane), if x < y { x } else { y }),
                    ("larger", v.larger(w).lane(lane), if x > y { x } else { y }),
                    ("smaller", v.smaller(w).lane(lane), if x < y { x } else { y }),
                ];
                for (what, found, expected) in numbers {
                    assert!(same(found, expected), "{what} of {x} and {y}: {found}, not {expected}");
                }
                // Of two zeros it may be either.
                if !y.is_nan() && x != y {
                    let (at_least, at_most) = (v.at_least(w).lane(lane), v.at_most(w).lane(lane));
                    assert!(same(at_least, if x > y { x } else { y }), "{x}, at least {y}: {at_least}");
                    assert!(same(at_most, if x < y { x } else { y }), "{x}, at most {y}: {at_most}");
                }
                let answers = [
                    ("<", v.lt(w), x < y),
                    ("<=", v.le(w), x <= y),
                    ("=", v.equal(w), x == y),
                    ("not =", !v.equal(w), x != y),
                    ("and", v.le(w) & v.equal(w), x == y),
                    ("or", mask | v.equal(w), x <= y),
                ];
                for (what, found, expected) in answers {
                    assert_eq!(found.bits() >> lane & 1 == 1, expected, "{x} {what} {y}");
                }
            }
        }
        distances::<V>();
        for shift in 0..8 {
            let (a, b) = (words(0), words(shift));
            let (v, w) = (V::Bits::load(&a), V::Bits::load(&b));
            for lane in 0..V::LANES {
                let (x, y) = (a[lane], b[lane]);
                let count = V::Bits::splat(63) & w;
                for (what, found, expected) in [
                    ("sum", v.plus(w), x.wrapping_add(y)),
                    ("product", v.times(w), x.wrapping_mul(y)),
                    ("product of lower halves", v.times_low(w), (x & 0xFFFF_FFFF) * (y & 0xFFFF_FFFF)),
                    ("and", v & w, x & y),
                    ("or", v | w, x | y),
                    ("exclusive or", v ^ w, x ^ y),
                    ("up", v.up::<17>(), x << 17),
                    ("down", v.down::<41>(), x >> 41),
                    ("down by", v.down_by(count), x >> (y & 63)),
                    ("reversed", v.reversed(), x.reverse_bits()),
                    ("mirrored", v.mirrored(), (x as u32).reverse_bits().into()),
                    ("choice", V::Bits::choose(v.equal(w), v, w), if x == y { x } else { y }),
                ] {
                    assert_eq!(found.word(lane), expected, "{what} of {x:x} and {y:x}");
                }
                let fraction = if V::IS_DOUBLE { unit(x) } else { single_unit(x).into() };
                assert!(same(V::unit(v).lane(lane), fraction), "{x:x}");
                let number = if V::IS_DOUBLE { (x >> 11) as f64 } else { f64::from((x >> 11) as f32) };
                assert!(same(V::number(v.down::<11>()).lane(lane), number), "{x:x}");
                let less = v.down::<1>().less(w.down::<1>()).bits() >> lane & 1 == 1;
                assert_eq!(less, x >> 1 < y >> 1, "{x:x} {y:x}");
            }
        }
        digits_are_those_of_words::<V>();
        lanes_move::<V>();
    }
}

/// Checks the operations on digits: their lower 32 bits are those of words.
#[inline(always)]
fn digits_are_those_of_words<V: Float>() {
    for shift in 0..8 {
        let (a, b) = (words(0), words(shift));
        let (v, w) = (V::Bits::load(&a), V::Bits::load(&b));
        let ([low, x], [_, y]) = (V::halves(v), V::halves(w));
        let count = y & V::Digits::splat(31);
        let choice = V::choose_digits(v.equal(w), low, y);
        for lane in 0..V::LANES {
            let [lower, first, second] = [a[lane] as u32, (a[lane] >> 32) as u32, (b[lane] >> 32) as u32];
            for (what, found, expected) in [
                ("lower half", low, lower),
                ("upper half", x, first),
                ("sum", low.plus(y), lower.wrapping_add(second)),
                ("product", low.times(y), lower.wrapping_mul(second)),
                ("product of lower halves", low.times_low(y), lower.wrapping_mul(second)),
                ("and", x & y, first & second),
                ("or", x | y, first | second),
                ("exclusive or", x ^ y, first ^ second),
                ("up", x.up::<17>(), first << 17),
                ("down", x.down::<11>(), first >> 11),
                ("down by", x.down_by(count), first >> (second & 31)),
                ("mirrored", low.mirrored(), lower.reverse_bits()),
                ("choice", choice, if a[lane] == b[lane] { lower } else { second }),
            ] {
                // Single precision has room for 24 digits.
                let found = found & V::Digits::splat(u32::MAX.into());
                for (found, expected) in [(found, expected), (found.down::<24>(), expected >> 24)] {
                    let fraction = V::fraction(found & V::Digits::splat((1 << 24) - 1)).lane(lane);
                    let expected = f64::from((expected & ((1 << 24) - 1)).reverse_bits()) / 4_294_967_296.0;
                    assert!(same(fraction, expected), "{what} of {first:x}, {lower:x} and {second:x}: {fraction}");
                }
            }
        }
    }
}

/// Checks the order of distances ahead on a ray.
#[inline(always)]
fn distances<V: Float>() {
    let infinity = f64::INFINITY;
    for (near, far) in (0..16).flat_map(|first| (0..16).map(move |second| (numbers(first), numbers(second)))) {
        let (v, w) = (of::<V>(near), of::<V>(far));
        let (one, two) = (V::ahead(v, w), V::ahead(w, w));
        // A missing distance has no defined value, but it is not sooner than infinity.
        let found = [one, two, one.later(two), two.sooner(one)].map(|t| t.sooner(V::splat(infinity)));
        let is_sooner = one.is_sooner(two.sooner(V::splat(infinity)));
        for lane in 0..V::LANES {
            let (x, y) = (v.lane(lane), w.lane(lane));
            // The nearer distance comes first, and whether -0 is behind the start is left open.
            let is_ahead = |t: f64| t.is_sign_positive() && !t.is_nan();
            if x > y || x == 0.0 && x.is_sign_negative() || y == 0.0 && y.is_sign_negative() {
                continue;
            }
            let second = if is_ahead(y) { y } else { infinity };
            let first = if is_ahead(x) { x } else { second };
            for (found, expected) in found.into_iter().zip([first, second, first.max(second), first.min(second)]) {
                assert!(same(found.lane(lane), expected), "{x} and {y}: {}, not {expected}", found.lane(lane));
            }
            assert_eq!(is_sooner.bits() >> lane & 1 == 1, first < second, "{x} and {y}");
        }
    }
}

/// Numbers in lanes, put there one by one.
#[inline(always)]
fn of<V: Float>(numbers: [f64; MOST_LANES]) -> V {
    let mut lanes = V::splat(0.0);
    for (lane, number) in numbers.into_iter().enumerate().take(V::LANES) {
        lanes.set_lane(lane, number);
    }
    lanes
}

/// Checks the operations that move numbers into lanes and out of them.
#[inline(always)]
fn lanes_move<V: Float>() {
    let counted = of::<V>(std::array::from_fn(|k| k as f64 + 0.5));
    let mut from = [V::One::default(); MOST_LANES];
    counted.store(&mut from);
    for (lane, number) in from.into_iter().enumerate().take(V::LANES) {
        let number: f64 = number.into();
        assert_eq!((number, V::load(&from).lane(lane)), (lane as f64 + 0.5, lane as f64 + 0.5));
    }
    let all = u32::MAX >> (MOST_LANES - V::LANES);
    let step = if V::LANES > 8 { all / 691 } else { 1 };
    for mask in (0..=all).step_by(step as usize) {
        assert_eq!(V::Mask::from_bits(mask).bits(), mask);
        let mut next = 0..;
        let expected: Vec<Option<usize>> =
            (0..V::LANES).map(|lane| (mask >> lane & 1 == 1).then(|| next.next().unwrap())).collect();
        let filled = V::splat(-1.0).fill(V::Mask::from_bits(mask), &from);
        let bits: [u64; MOST_LANES] = std::array::from_fn(|k| k as u64 + 7);
        let words = V::Bits::splat(0).fill(V::Mask::from_bits(mask), &bits);
        for (lane, place) in expected.into_iter().enumerate() {
            assert_eq!(filled.lane(lane), place.map_or(-1.0, |place| place as f64 + 0.5), "{mask:b}");
            assert_eq!(words.word(lane), place.map_or(0, |place| bits[place]), "{mask:b}");
        }
    }
    for rows in [1_usize, 5, 16, 17, 32, 33, 40] {
        let precision = if V::IS_DOUBLE { Precision::F64 } else { Precision::F32 };
        let table = Table::new((0..rows).map(|row| [0, 1, 2, 3].map(|j| (10 * row + j) as f64)), precision);
        let numbers: [f64; MOST_LANES] = std::array::from_fn(|k| (k * 7 % rows) as f64);
        for (j, column) in V::rows(&table, of::<V>(numbers)).into_iter().enumerate() {
            for (lane, number) in numbers.iter().enumerate().take(V::LANES) {
                assert_eq!(column.lane(lane), 10.0 * number + j as f64, "{rows} rows");
            }
        }
    }
    let (mut v, mut w) = (V::splat(0.0), V::Bits::splat(0));
    for lane in 0..V::LANES {
        v.set_lane(lane, lane as f64);
        w.set_word(lane, lane as u64);
    }
    assert!((0..V::LANES).all(|lane| v.lane(lane) == lane as f64 && w.word(lane) == lane as u64));
}

#[test]
fn every_level_agrees_with_scalar_arithmetic() {
    for precision in Precision::ALL {
        assert!(levels().map(|level| on_level(level, precision, Operations)).count() >= 1);
    }
}
