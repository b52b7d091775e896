//! Identity of images and schedules: one key for each, whether they are requested or measured.
//!
//! Cells, rows, references and figures compare by these keys.

use super::list::settings_list;
use super::value::Asked;
use super::{Setting, Settings};
use std::fmt;
use std::iter::once;

pub(super) struct KeyColumn {
    pub(super) name: &'static str,
    /// Its value; `None` if nothing was chosen.
    pub(super) text: Option<String>,
    setting: Setting,
}

impl KeyColumn {
    fn word(&self) -> Option<String> {
        Some(self.setting.word_of(self.name, self.text.as_ref()?))
    }
}

macro_rules! asked_for {
    ($settings:ident own $field:ident) => {
        Asked::column(&$settings.$field)
    };
    ($settings:ident spec $field:ident) => {
        Asked::column(&$settings.spec.$field)
    };
    ($settings:ident found $field:ident) => {
        Default::default()
    };
}

macro_rules! keys {
    ({} image $image:tt schedule $schedule:tt) => {
        keys! {
            /// The identity of an image: rows with equal keys have equal checksums, unless the sampler draws other
            /// random numbers in each run.
            ImageKey $image
        }
        keys! {
            /// The identity of a schedule among those of one image: who renders which pieces, and how. It must not
            /// change a bit of the image.
            ScheduleKey $schedule
        }
    };
    ($(#[$meta:meta])* $name:ident { $(
        $(#[doc = $about:literal])+ $place:ident $field:ident: $kind:ty $(= $default:expr)?, $setting:expr
        $(, when $when:meta)? $(, read $read:meta)?;
    )* }) => {
        $(#[$meta])*
        #[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        pub struct $name {
            $($(#[doc = $about])+ $(#[$when])? pub $field: <$kind as Asked>::Column,)*
        }

        impl $name {
            /// The key of these settings, without what only a setup finds out.
            pub(crate) fn of(settings: &Settings) -> Self {
                Self { $($(#[$when])? $field: asked_for!(settings $place $field),)* }
            }

            pub(super) fn columns(&self) -> Vec<KeyColumn> {
                vec![$(
                    $(#[$when])?
                    KeyColumn {
                        name: stringify!($field),
                        text: <$kind as Asked>::text(&self.$field),
                        setting: $setting,
                    },
                )*]
            }
        }

        /// One word without spaces, equal only for equal keys.
        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.columns().iter().filter_map(KeyColumn::word).try_for_each(|word| f.write_str(&word))
            }
        }
    };
}

settings_list!(keys {});

impl ImageKey {
    /// The key that the images of all seeds share.
    #[must_use]
    pub fn without_seed(&self) -> Self {
        Self { seed: 0, ..self.clone() }
    }

    /// Clears the scene and the choices that fit it.
    pub fn forget_scene(&mut self) {
        [&mut self.scene, &mut self.scene_hash, &mut self.roulette].into_iter().for_each(String::clear);
        self.max_depth = None;
    }

    /// Whether a setting changes what the image converges to.
    pub(crate) fn is_biased(&self) -> bool {
        self.max_depth.is_some() || [&self.clamp, &self.filter, &self.epsilon].iter().any(|part| !part.is_empty())
    }
}

impl ScheduleKey {
    /// The schedule's part of a cell's id: the pieces, who renders them, and other settings that differ from the
    /// default.
    pub(crate) fn id_of(settings: &Settings) -> String {
        let decomposition = settings.decomposition.clone();
        let base = Settings { decomposition, strategy: String::new(), threads: 0, ..Settings::default() };
        let (own, base) = (Self::of(settings).columns(), Self::of(&base).columns());
        let words = own.iter().zip(&base).filter(|(own, base)| own.text != base.text).filter_map(|(own, _)| own.word());
        once(settings.decomposition.clone()).chain(words).collect()
    }

    /// Clears who renders, but keeps the pieces.
    pub fn forget_workers(&mut self) {
        self.strategy.clear();
        self.rank_rule.clear();
        (self.threads, self.ranks) = (0, None);
    }

    /// Clears the kernel and the options that are chosen to fit it.
    pub fn forget_kernel(&mut self) {
        let parts =
            [&mut self.kernel, &mut self.kernel_fallback, &mut self.simd, &mut self.effects, &mut self.accelerator];
        parts.into_iter().for_each(String::clear);
    }
}
