//! Film files: sums in full precision, for references. The layout is [`SumFile`], with the [`FilmKey`] as its JSON.

mod sum_file;

use crate::error::Result;
use crate::film::Film;
use crate::kernel;
use crate::settings::{Asked, ImageKey, settings_list};
use crate::simd::Precision;
use serde::{Deserialize, Serialize};
use std::path::Path;
pub use sum_file::SumFile;

const FILE: SumFile = SumFile { magic: "pathmark film 1", field: "film" };

macro_rules! film_key {
    ({} image { $(
        $(#[doc = $about:literal])+ $place:ident $field:ident: $kind:ty $(= $default:expr)?, $setting:expr
        $(, when $when:meta)? $(, read $read:meta)?;
    )* } schedule $schedule:tt) => {
        /// The identity of a film: two films with the same key hold the same bits. Older files lack what `None` says.
        #[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct FilmKey {
            $($(#[doc = $about])+ $(#[$when])? $(#[$read])? pub $field: $kind,)*
            /// Revision of the arithmetic: films of another revision are rendered again.
            pub revision: u32,
        }

        impl FilmKey {
            pub fn of(image: ImageKey) -> Self {
                Self { $($(#[$when])? $field: Asked::of(image.$field),)* revision: kernel::REVISION }
            }
        }
    };
}

settings_list!(film_key {});

/// The format of films that were written before there was a choice.
fn double() -> String {
    Precision::F64.name().to_string()
}

pub fn write_film(path: &Path, key: &FilmKey, film: &Film) -> Result<()> {
    FILE.write(path, key, &[film])
}

pub fn read_film(path: &Path) -> Result<(FilmKey, Film)> {
    let (key, films) = FILE.read(path, |key: &FilmKey| (key.width, key.height, 1))?;
    let film = films.into_iter().next().unwrap_or_else(|| Film::new(key.width, key.height));
    Ok((key, film))
}
