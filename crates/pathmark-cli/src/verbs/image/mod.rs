//! `pathmark image WHAT`: files of images and films.
//!
//! Pictures are image files, and film files of references and checkpoints.

mod compare;
mod reference;

use crate::film_file::read_film;
use crate::image_io;
use crate::measure::Provenance;
use crate::verbs::prelude::*;

#[derive(Subcommand)]
pub(crate) enum Image {
    /// Measure the error of an image against one reference, or against two to exclude their noise.
    Compare(compare::Arguments),
    /// Write an image, or a film file with its sums, in another format.
    Convert(Convert),
    /// Render a reference for measuring errors: two images of many samples that share none of them.
    Reference(reference::Arguments),
}

/// `pathmark image convert out/references/cornell.film -o cornell.exr`
#[derive(Args)]
pub(crate) struct Convert {
    /// A film file or an image
    input: PathBuf,
    /// The image: .png, .ppm and .bmp for viewing, .exr, .pfm and .hdr for linear radiance
    #[arg(short = 'o', long, value_name = "FILE")]
    output: PathBuf,
    /// Scale .png, .ppm and .bmp files so that the brightest channel of the image is 1
    #[arg(long)]
    auto_exposure: bool,
}

impl Image {
    pub(super) fn run(self, lab: &Arc<Lab>, console: &Console) -> Result<()> {
        match self {
            Self::Compare(arguments) => compare::run(&arguments),
            Self::Convert(arguments) => convert(&arguments),
            Self::Reference(arguments) => reference::run(&arguments, lab, console),
        }
    }
}

fn convert(arguments: &Convert) -> Result<()> {
    let Convert { input, output, auto_exposure } = arguments;
    let format = image_io::check_format(output)?;
    let mut files = Files::default();
    files.reads("the input", input);
    files.writes("output", output)?;
    let (image, film) = read_picture(input)?;
    let shown =
        if *auto_exposure && !format.linear { image_io::auto_exposed(&image, image.brightest()) } else { image };
    let notes = film.map_or_else(Vec::new, |film| film.notes());
    image_io::write_with_notes(output, &shown, &notes)?;
    print(&format!("{}: {}x{}", output.display(), shown.width, shown.height))
}

/// Whether the file is named as a film, which keeps sums in full precision.
pub(super) fn is_film(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "film")
}

/// Reads a picture, and its provenance if the file has it.
fn read_picture(path: &Path) -> Result<(image_io::Image, Option<Provenance>)> {
    let is_film = is_film(path);
    if is_film && !path.exists() {
        return Err(InputError::new("image", path.display().to_string(), "there is no such file").into());
    }
    if is_film && path.is_file() {
        let (key, film) = read_film(path)?;
        let checksum = Some(film.checksum());
        return Ok((film.image(), Some(Provenance { key, checksum })));
    }
    let (image, notes) = image_io::read_with_notes(path)?;
    Ok((image, Provenance::of_notes(&notes)))
}
