//! The boxes of one lane: each is thick enough to see, and there are no more boxes than pixels.

/// The thinnest box in pixels. Half a pixel could be painted, but would double the boxes of a page, which also contains
/// the times of all jobs.
const THINNEST: f64 = 1.0;

/// Left and right end in pixels, and the position on the colour bar.
pub(super) type Piece = (f64, f64, f64);

/// Returns the boxes from left to right. Merges a box into its left neighbour if they start less than `THINNEST` apart;
/// the colour is the mean by width.
pub(super) fn merged(mut pieces: Vec<Piece>) -> Vec<Piece> {
    // Jobs of no width get a small weight, or the mean of several would be 0 / 0.
    const LEAST: f64 = 1e-9;
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut done: Vec<(f64, f64, f64, f64)> = Vec::new();
    for (left, right, share) in pieces {
        let weight = (right - left).max(LEAST);
        match done.last_mut() {
            Some((from, to, sum, weights)) if left - *from < THINNEST => {
                *to = to.max(right).max(*from + THINNEST);
                *sum += weight * share;
                *weights += weight;
            }
            _ => done.push((left, right.max(left + THINNEST), weight * share, weight)),
        }
    }
    done.into_iter().map(|(left, right, sum, weights)| (left, right, sum / weights)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_boxes_stay_and_thin_ones_never_vanish() {
        let pieces = vec![(20.0, 30.0, 1.0), (0.0, 10.0, 0.0), (40.0, 40.0, 0.5)];
        assert_eq!(merged(pieces), [(0.0, 10.0, 0.0), (20.0, 30.0, 1.0), (40.0, 41.0, 0.5)]);
        assert!(merged(Vec::new()).is_empty());
    }

    #[test]
    fn crowds_become_one_with_the_mean_of_their_colours() {
        let crowd: Vec<Piece> =
            (0..10_000).map(|i| (f64::from(i) * 1e-3, f64::from(i + 1) * 1e-3, f64::from(i % 2))).collect();
        let boxes = merged(crowd);
        assert!((9..=11).contains(&boxes.len()), "{}", boxes.len());
        for (left, right, share) in boxes {
            assert!(right - left >= THINNEST - 1e-9 && right - left < 2.0 * THINNEST && (share - 0.5).abs() < 0.01);
        }
    }
}
