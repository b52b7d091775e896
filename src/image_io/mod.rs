//! stub
/// stub
pub struct Image { /// w
pub width: u32, /// h
pub height: u32, /// p
pub pixels: Vec<[f64;3]> }
impl Image { /// n
pub fn new(width: u32, height: u32) -> Self { Self { width, height, pixels: vec![[0.0;3]; (width*height) as usize] } } }
