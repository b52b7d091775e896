//! `pathmark image convert FILE -o FILE`: a film or an image in another format.

use super::picture;
use crate::console::output::print;
use crate::error::Result;
use crate::files::Files;
use crate::image_io;
use clap::Args;
use std::path::PathBuf;

/// `pathmark image convert out/references/cornell.film -o cornell.exr`
#[derive(Args)]
pub(crate) struct Arguments {
    /// A film file or an image
    input: PathBuf,
    /// The image: .png, .ppm and .bmp for viewing, .exr, .pfm and .hdr for linear radiance
    #[arg(short = 'o', long, value_name = "FILE")]
    output: PathBuf,
    /// Scale .png, .ppm and .bmp files so that the brightest channel of the image is 1
    #[arg(long)]
    auto_exposure: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let Arguments { input, output, auto_exposure } = arguments;
    let format = image_io::check_format(output)?;
    let mut files = Files::default();
    files.reads("the input", input);
    files.writes("output", output)?;
    let (image, film) = picture::read(input)?;
    let shown = if *auto_exposure && !format.linear { image_io::auto_exposed(&image) } else { image };
    let notes = film.map_or_else(Vec::new, |film| film.notes());
    image_io::write_with_notes(output, &shown, &notes)?;
    print(&format!("{}: {}x{}", output.display(), shown.width, shown.height))
}
