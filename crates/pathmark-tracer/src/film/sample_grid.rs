//! Sample counts that vary over the image: one per cell of a grid that is independent of the film's decomposition into
//! jobs.

use super::{Bounds, Decomposition, Film, Piece, Plan, PlanSize};

/// Side of a cell, in pixels.
const SIDE: u32 = 16;

/// The number of samples per pixel in each cell.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SampleGrid {
    width: u32,
    height: u32,
    /// Stored row by row.
    counts: Vec<u32>,
}

/// The cells of a grid over a film, row by row; those at the right and lower edge may be smaller.
fn cells(width: u32, height: u32) -> impl Iterator<Item = Bounds> {
    let starts = |length: u32| (0..length).step_by(SIDE as usize);
    starts(height).flat_map(move |y0| {
        starts(width).map(move |x0| Bounds { x0, y0, x1: width.min(x0 + SIDE), y1: height.min(y0 + SIDE) })
    })
}

impl SampleGrid {
    /// Distributes `spp` samples a pixel on average. Every pixel gets `least`. The rest goes to cells in proportion to
    /// the square root of a sample's mean variance in `pilot`: for a fixed total that minimises the mean variance of
    /// the pixels (Neyman, "On the Two Different Aspects of the Representative Method", 1934). Counts are multiples of
    /// `step`; `spp` and `least` must be, too. The total is at most `spp` a pixel on average, and less than one step in
    /// one cell below it.
    pub fn neyman(pilot: &Film, spp: u32, least: u32, step: u32) -> Self {
        let (width, height) = (pilot.width(), pilot.height());
        let bounds: Vec<Bounds> = cells(width, height).collect();
        let deviations: Vec<f64> = bounds.iter().map(|cell| deviation(pilot, cell)).collect();
        let areas = || bounds.iter().map(|cell| cell.area() as f64);
        let pixels = f64::from(width) * f64::from(height);
        let mean = areas().zip(&deviations).map(|(area, deviation)| area * deviation).sum::<f64>() / pixels;
        let steps = f64::from((spp - least) / step);
        // Without any noise all cells get the same count.
        let wanted = |deviation: f64| if mean > 0.0 { steps * deviation / mean } else { steps };
        let wanted: Vec<f64> = deviations.into_iter().map(wanted).collect();
        let mut given: Vec<u32> = wanted.iter().map(|wanted| wanted.floor() as u32).collect();
        let spent: f64 = areas().zip(&given).map(|(area, steps)| area * f64::from(*steps)).sum();
        let mut left = pixels * steps - spent;
        // Largest remainders first; of equal ones the earlier cell.
        let mut order: Vec<usize> = (0..wanted.len()).collect();
        order.sort_by(|&a, &b| wanted[b].fract().total_cmp(&wanted[a].fract()));
        for cell in order {
            let area = bounds[cell].area() as f64;
            if area <= left {
                given[cell] += 1;
                left -= area;
            }
        }
        Self { width, height, counts: given.into_iter().map(|steps| least + step * steps).collect() }
    }

    /// The largest number of samples of a pixel.
    pub fn largest(&self) -> u32 {
        self.counts.iter().copied().max().unwrap_or(0)
    }

    /// The number of samples of the whole image.
    pub fn total(&self) -> u64 {
        cells(self.width, self.height)
            .zip(&self.counts)
            .map(|(cell, count)| cell.area() as u64 * u64::from(*count))
            .sum()
    }

    pub fn plan_size(&self, decomposition: &Decomposition) -> PlanSize {
        let whole = decomposition.plan(self.width, self.height, &(0..1));
        let size = |Piece { bounds, samples }: Piece| {
            let parts = decomposition.parts(&samples);
            PlanSize { pieces: parts, pixels: parts * bounds.area() as u64 }
        };
        self.pieces(&whole).map(size).fold(PlanSize::default(), PlanSize::plus)
    }

    /// Returns the decomposition's pieces, cut along cell boundaries, each with its cell's number of samples.
    pub fn plan(&self, decomposition: &Decomposition) -> Plan {
        let whole = decomposition.plan(self.width, self.height, &(0..1));
        let plan = Plan::from_pieces(self.pieces(&whole).collect());
        match decomposition.sample_block() {
            Some(block) => plan.split_samples(block),
            None => plan,
        }
    }

    /// The pieces of a plan of whole pixels, cut along cell boundaries.
    fn pieces<'a>(&'a self, whole: &'a Plan) -> impl Iterator<Item = Piece> + 'a {
        let columns = self.width.div_ceil(SIDE);
        whole.pieces().iter().flat_map(move |piece| {
            let Bounds { x0, y0, x1, y1 } = piece.bounds;
            let cells_of_row = move |row: u32| (x0 / SIDE..x1.div_ceil(SIDE)).map(move |column| (row, column));
            (y0 / SIDE..y1.div_ceil(SIDE)).flat_map(cells_of_row).map(move |(row, column)| {
                let (left, top) = (column * SIDE, row * SIDE);
                let bounds =
                    Bounds { x0: x0.max(left), y0: y0.max(top), x1: x1.min(left + SIDE), y1: y1.min(top + SIDE) };
                Piece { bounds, samples: 0..self.counts[(row * columns + column) as usize] }
            })
        })
    }
}

/// The square root of the mean, over a cell's pixels and channels, of a sample's variance.
fn deviation(film: &Film, cell: &Bounds) -> f64 {
    let rows = (cell.y0..cell.y1).map(|y| (y * film.width()) as usize);
    let pixels = rows.flat_map(|start| &film.pixels()[start + cell.x0 as usize..start + cell.x1 as usize]);
    let total: f64 = pixels.map(|pixel| pixel.variance() * f64::from(pixel.count)).sum();
    (total / cell.area() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Assembly, SAMPLE_BLOCK, SampleSum, TileBuffer};
    use crate::math::Rgb;

    /// A film whose pixels have samples 0 and twice `mean`, so that a sample's standard deviation is proportional to
    /// `mean`.
    fn pilot(width: u32, height: u32, mean: impl Fn(u32, u32) -> f64) -> Film {
        let mut tile = TileBuffer::new(Bounds { x0: 0, y0: 0, x1: width, y1: height });
        for y in 0..height {
            for (x, pixel) in (0..width).zip(tile.row_mut(y)) {
                let mut sum = SampleSum::default();
                (0..SAMPLE_BLOCK).for_each(|k| sum.add(Rgb::WHITE * (mean(x, y) * f64::from(k % 2 * 2))));
                *pixel = sum.total();
            }
        }
        let mut assembly = Assembly::new(width, height, 0..SAMPLE_BLOCK).unwrap();
        assembly.add(&(0..SAMPLE_BLOCK), tile);
        assembly.finish()
    }

    /// Deviations of 1 and 3: the samples above `least` are shared in that ratio.
    #[test]
    fn shares_follow_the_deviation() {
        let film = pilot(32, 16, |x, _| if x < 16 { 1.0 } else { 3.0 });
        let grid = SampleGrid::neyman(&film, 104, 8, 4);
        assert_eq!((grid.counts.as_slice(), grid.total()), ([56, 152].as_slice(), 104 * 512));
    }

    #[test]
    fn a_film_without_noise_is_shared_evenly() {
        let grid = SampleGrid::neyman(&pilot(40, 20, |_, _| 0.0), 64, 8, 4);
        assert!(grid.counts.len() == 6 && grid.counts.iter().all(|count| *count == 64));
    }

    /// Cells of different sizes: the total never exceeds `spp` and is as close to it as a step allows.
    #[test]
    fn the_total_is_kept() {
        for (width, height) in [(16, 16), (33, 17), (100, 60), (250, 3)] {
            let film = pilot(width, height, |x, y| f64::from(x % 23) + 0.1 * f64::from(y));
            let grid = SampleGrid::neyman(&film, 64, 8, 4);
            let (asked, found) = (u64::from(width * height) * 64, grid.total());
            assert!(
                found <= asked && asked - found < u64::from(4 * SIDE * SIDE),
                "{width}x{height}: {found} of {asked}"
            );
            assert!(grid.counts.iter().all(|count| *count >= 8 && count.is_multiple_of(4)));
        }
    }

    /// For every decomposition, each pixel has its cell's samples exactly once.
    #[test]
    fn every_cut_gives_the_same_samples() {
        let grid = SampleGrid::neyman(&pilot(50, 40, |x, _| f64::from(x)), 64, 8, 4);
        for text in ["rows", "bands:7", "grid:6", "tiles:32x32", "tiles:5x3:hilbert", "samples:16:24x24"] {
            let mut found = vec![0; 50 * 40];
            let cut = Decomposition::parse(text).unwrap();
            let (plan, size) = (grid.plan(&cut), grid.plan_size(&cut));
            let pixels: usize = plan.pieces().iter().map(|piece| piece.bounds.area()).sum();
            assert_eq!(size, PlanSize { pieces: plan.len() as u64, pixels: pixels as u64 }, "{text}");
            for Piece { bounds, samples } in plan.pieces() {
                for y in bounds.y0..bounds.y1 {
                    (bounds.x0..bounds.x1).for_each(|x| found[(y * 50 + x) as usize] += samples.end - samples.start);
                }
            }
            let expected = (0..2000).map(|at| grid.counts[(at / 50 / SIDE * 4 + at % 50 / SIDE) as usize]);
            assert!(found.iter().copied().eq(expected), "{text}");
        }
    }
}
