//! Crops of the pictures of the figure `equal-time`: each picture whole, with marks around parts of it, and below it the
//! parts with enlarged pixels.

use super::block::Block;
use super::figures::Pictures;
use super::plot::{Cell, Comparison, ContactSheet};
use super::results::Results;
use crate::error::{InputError, Result};

/// The name of the file, without its ending.
pub(super) const STEM: &str = "crops";

/// Colour of the marks: it differs in lightness and in hue from most of a render.
const MARK: [u8; 3] = [255, 176, 0];

/// A square part of an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Crop {
    /// Its first column and its first row.
    left: u32,
    top: u32,
    /// Its width and height, in pixels.
    size: u32,
}

const ALLOWED: &str = "X,Y,SIZE: column and row of the top left pixel, from 0, and the width, as in 20,10,32";

impl Crop {
    /// Reads `X,Y,SIZE`.
    pub fn parse(text: &str) -> Result<Self> {
        let numbers: Option<Vec<u32>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[left, top, size]) if size > 0 => Ok(Self { left, top, size }),
            _ => Err(InputError::new("crops", text, "is not a part of an image").allowed(ALLOWED).into()),
        }
    }

    /// Refuses a crop that is not within the image.
    fn check(self, image: &Cell) -> Result<()> {
        let Self { left, top, size } = self;
        let is_within = |start: u32, length: u32| start.checked_add(size).is_some_and(|end| end <= length);
        if is_within(left, image.width) && is_within(top, image.height) {
            return Ok(());
        }
        let problem = format!("is not within an image of {}x{} pixels", image.width, image.height);
        Err(InputError::new("crops", format!("{left},{top},{size}"), problem).allowed(ALLOWED).into())
    }

    fn contains(self, x: u32, y: u32) -> bool {
        let is_within = |start: u32, place: u32| place.checked_sub(start).is_some_and(|inside| inside < self.size);
        is_within(self.left, x) && is_within(self.top, y)
    }

    /// The part, as an image of its own.
    fn of(self, image: &Cell) -> Cell {
        let Self { left, top, size } = self;
        let start = |row: u32| 3 * (row as usize * image.width as usize + left as usize);
        let rows = (top..top + size).flat_map(|row| &image.rgb[start(row)..start(row) + 3 * size as usize]);
        let caption = vec![format!("{size}x{size} pixels at {left},{top}")];
        Cell { caption, width: size, height: size, rgb: rows.copied().collect() }
    }

    /// Draws a frame around the part, as wide as the sheet needs to show it.
    fn mark(self, image: &mut Cell) {
        let (Self { left, top, size }, width) = (self, image.step());
        let range = |start: u32, length: u32| start.saturating_sub(width)..(start + size + width).min(length);
        for (x, y) in range(top, image.height).flat_map(|y| range(left, image.width).map(move |x| (x, y))) {
            if !self.contains(x, y) {
                let at = 3 * (y as usize * image.width as usize + x as usize);
                image.rgb[at..at + 3].copy_from_slice(&MARK);
            }
        }
    }
}

/// The sheet of an experiment; `None` if it kept no images to compare.
pub(super) fn block(results: &Results, crops: &[Crop]) -> Result<Option<Block>> {
    let Some(Pictures { title, subtitle, groups }) = Pictures::of(results)? else { return Ok(None) };
    let mut rows = Vec::new();
    for group in groups {
        let (mut wholes, mut parts) = (Vec::new(), vec![Vec::new(); crops.len()]);
        for picture in group {
            let mut whole = Cell::of(&picture.image, picture.caption)?;
            for (crop, row) in crops.iter().zip(&mut parts) {
                crop.check(&whole)?;
                row.push(Some(crop.of(&whole)));
            }
            for crop in crops {
                crop.mark(&mut whole);
            }
            wholes.push(Some(whole));
        }
        rows.push(wholes);
        rows.append(&mut parts);
    }
    let subtitle = subtitle.to_string();
    let sheet = ContactSheet { title, subtitle, rows, bars: Vec::new(), comparison: Comparison::Single };
    Block::sheet(STEM, &sheet).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An image whose pixels have their column, their row and 0.
    fn image(width: u32, height: u32) -> Cell {
        let places = (0..height).flat_map(|y| (0..width).map(move |x| [x as u8, y as u8, 0]));
        Cell { caption: Vec::new(), width, height, rgb: places.flatten().collect() }
    }

    fn pixel(image: &Cell, x: u32, y: u32) -> [u8; 3] {
        let at = 3 * (y * image.width + x) as usize;
        [image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]]
    }

    #[test]
    fn a_crop_has_the_pixels_of_its_place_and_a_frame_around_it() {
        let (whole, crop) = (image(10, 8), Crop::parse("7, 2,3").unwrap());
        crop.check(&whole).unwrap();
        let part = crop.of(&whole);
        assert_eq!((part.width, part.height, part.rgb.len()), (3, 3, 27));
        assert_eq!((pixel(&part, 0, 0), pixel(&part, 2, 1)), ([7, 2, 0], [9, 3, 0]));
        let mut marked = whole.clone();
        crop.mark(&mut marked);
        let is_marked = |x, y| pixel(&marked, x, y) == MARK;
        let count = (0..8).flat_map(|y| (0..10).map(move |x| (x, y))).filter(|(x, y)| is_marked(*x, *y)).count();
        // The right side of the frame would be outside of the image.
        assert!(is_marked(6, 1) && is_marked(9, 5) && !is_marked(7, 2) && !is_marked(9, 4), "{count}");
        assert_eq!(count, 4 + 4 + 3);
    }

    #[test]
    fn wrong_crops_are_refused() {
        for wrong in ["", "1,2", "1,2,3,4", "1,2,0", "-1,2,3", "a,b,c", "1,2,3.5"] {
            let error = Crop::parse(wrong).unwrap_err();
            assert!(error.exit_code() == 2 && error.to_string().contains("X,Y,SIZE"), "{wrong}: {error}");
        }
        for beyond in ["8,0,3", "0,6,3", "4294967295,0,1", "0,0,4294967295"] {
            let error = Crop::parse(beyond).unwrap().check(&image(10, 8)).unwrap_err();
            assert!(error.to_string().contains("10x8"), "{beyond}: {error}");
        }
    }
}
