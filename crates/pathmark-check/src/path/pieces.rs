//! Films divided into pieces: every pixel is rendered exactly once.

use crate::Trials;
use crate::film::{DECOMPOSITIONS, Decomposition, Plan};
use std::collections::BTreeSet;

const SIDES: [u32; 9] = [1, 2, 3, 7, 17, 63, 64, 65, 1023];
/// Numbers of parts.
const PARTS: [u32; 11] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 20, 64];
/// Decompositions into more pieces than this are tried on small films only.
const MANY: u32 = 5000;

fn plan(text: &str, width: u32, height: u32) -> Plan {
    Decomposition::parse(text).expect("a decomposition").plan(width, height, &(0..4))
}

/// Pixels that are not in exactly one piece.
fn wrong(plan: &Plan, width: u32, height: u32) -> u64 {
    let mut covered = vec![0_u8; width as usize * height as usize];
    for piece in plan.pieces() {
        for y in piece.bounds.y0..piece.bounds.y1 {
            let row = y as usize * width as usize;
            for times in &mut covered[row + piece.bounds.x0 as usize..row + piece.bounds.x1 as usize] {
                *times = times.saturating_add(1);
            }
        }
    }
    covered.iter().filter(|times| **times != 1).count() as u64
}

/// Tries every decomposition of the table, and each number of parts. Report B's 784 rows on 20 threads omitted the
/// last four.
pub(super) fn cover(trials: &mut Trials) {
    let examples = DECOMPOSITIONS.iter().map(|entry| entry.example.to_string());
    let parts = PARTS.iter().flat_map(|parts| [format!("bands:{parts}"), format!("grid:{parts}")]);
    let tiles = ["tiles:5x3:hilbert", "tiles:16x16:spiral", "tiles:7x5:cost", "tiles:1x1"].map(String::from);
    for text in examples.chain(parts).chain(tiles) {
        let (mut missed, mut pixels) = (0, 0);
        for (width, height) in SIDES.into_iter().flat_map(|width| SIDES.map(|height| (width, height))) {
            if text == "tiles:1x1" && width * height > MANY {
                continue;
            }
            let plan = plan(&text, width, height);
            let is_empty = plan.pieces().iter().any(|piece| piece.bounds.area() == 0 || piece.samples != (0..4));
            missed += wrong(&plan, width, height) + u64::from(is_empty);
            pixels += u64::from(width * height);
        }
        trials.never(text, "pixels not in exactly one piece", missed, pixels);
    }
    let bands = plan("bands:20", 784, 784);
    let heights: BTreeSet<u32> = bands.pieces().iter().map(|piece| piece.bounds.height()).collect();
    trials.same("784 rows in 20 bands", (20, vec![39, 40]), (bands.len(), heights.into_iter().collect()));
    trials.never("784 rows in 20 bands", "pixels not in exactly one piece", wrong(&bands, 784, 784), 784 * 784);
}

/// 815 pixels are cut at 204, 408 and 612. The number of cells need not be a square.
pub(super) fn grids(trials: &mut Trials) {
    let starts = |plan: &Plan| -> [BTreeSet<u32>; 2] {
        let of = |start: fn(&crate::film::Piece) -> u32| plan.pieces().iter().map(start).collect();
        [of(|piece| piece.bounds.x0), of(|piece| piece.bounds.y0)]
    };
    let expected = BTreeSet::from([0, 204, 408, 612]);
    trials.same("815 in a grid of 16", [expected.clone(), expected], starts(&plan("grid:16", 815, 815)));
    for cells in [1, 2, 4, 7, 9, 12, 16, 20, 49, 64] {
        for (width, height) in [(815, 815), (1024, 768), (815, 64)] {
            let plan = plan(&format!("grid:{cells}"), width, height);
            trials.same(format!("{cells} cells on {width}x{height}: pieces"), cells, plan.len());
            let missed = wrong(&plan, width, height);
            trials.never(
                format!("{cells} cells on {width}x{height}"),
                "pixels not in exactly one piece",
                missed,
                u64::from(width * height),
            );
        }
    }
}

/// Report D starts a thread for each section of a square. With eight threads the ninth section has none, so its pixels stay black: the
/// last of three columns, 815 - 2 * 272 wide, in the last of three rows, 611 - 204 - 204 high.
pub(super) fn eight_threads(trials: &mut Trials) {
    let plan = plan("grid:9", 815, 611);
    let sections = plan.pieces().iter().take(8).map(|piece| piece.bounds.area());
    trials.same("pixels of 815x611 in no section", 271 * 203, 815 * 611 - sections.sum::<usize>());
}
