//! The columns of `records.csv`, derived from the type of a row.

/// One column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    /// Its heading.
    pub name: &'static str,
    /// Its description, with the unit.
    pub about: &'static str,
    /// The type of its values in this program.
    pub(super) kind: &'static str,
    /// The first version of the columns (column `schema`) that has it.
    pub since: u32,
}

impl Column {
    pub(super) const fn new(name: &'static str, about: &'static str, kind: &'static str, since: u32) -> Self {
        Self { name, about, kind, since }
    }

    /// The kind of its values, in words.
    pub fn values(&self) -> &'static str {
        let kind = self.kind;
        if kind.contains("f64") {
            "number"
        } else if kind.contains("String") {
            "text"
        } else if kind.contains("bool") {
            "true or false"
        } else {
            "whole number"
        }
    }

    /// Whether it may be empty: if nothing was measured.
    pub fn may_be_empty(&self) -> bool {
        self.kind.starts_with("Option")
    }

    /// The unit of its values, if its name shows it.
    pub fn unit(&self) -> Option<&'static str> {
        let units = [("_s", "seconds"), ("_bytes", "bytes")];
        units.iter().find(|(ending, _)| self.name.ends_with(ending)).map(|(_, unit)| *unit)
    }
}

/// A struct with the columns of the settings between its own public fields, and the list of its fields as columns.
macro_rules! columns {
    (since) => { 1 };
    (since $since:literal) => { $since };
    (
        { $(#[$meta:meta])* pub struct $name:ident { $($first:tt)* } settings { $($last:tt)* } }
        image { $($image:tt)* } schedule { $($schedule:tt)* }
    ) => {
        columns! { $(#[$meta])* $name { $($first)* } { $($image)* } { $($schedule)* } { $($last)* } }
    };
    (
        $(#[$meta:meta])* $name:ident
        { $($(#[doc = $first_about:literal])+ pub $first:ident: $first_kind:ty,)* }
        { $(
            $(#[doc = $image_about:literal])+
            $image_place:ident $image:ident: $image_kind:ty $(= $image_default:expr)?, $image_setting:expr
            $(, when $image_when:meta)? $(, read $image_read:meta)?;
        )* }
        { $(
            $(#[doc = $schedule_about:literal])+
            $schedule_place:ident $schedule:ident: $schedule_kind:ty $(= $schedule_default:expr)?, $schedule_setting:expr
            $(, when $schedule_when:meta)? $(, read $schedule_read:meta)?;
        )* }
        { $($(#[doc = $about:literal])+ $(#[since($since:literal)])? pub $field:ident: $kind:ty,)* }
    ) => {
        $(#[$meta])*
        pub struct $name {
            $($(#[doc = $first_about])+ pub $first: $first_kind,)*
            $($(#[doc = $image_about])+ $(#[$image_when])? pub $image: <$image_kind as Value>::Column,)*
            $($(#[doc = $schedule_about])+ $(#[$schedule_when])? pub $schedule: <$schedule_kind as Value>::Column,)*
            $($(#[doc = $about])+ pub $field: $kind,)*
        }

        impl $name {
            fn of_keys(image: ImageKey, schedule: ScheduleKey) -> Self {
                Self {
                    $($(#[$image_when])? $image: image.$image,)*
                    $($(#[$schedule_when])? $schedule: schedule.$schedule,)*
                    ..Self::default()
                }
            }

            /// The identity of its image.
            pub fn image_key(&self) -> ImageKey {
                ImageKey { $($(#[$image_when])? $image: self.$image.clone(),)* }
            }

            /// The identity of its schedule among those of the same image.
            pub fn schedule_key(&self) -> ScheduleKey {
                ScheduleKey { $($(#[$schedule_when])? $schedule: self.$schedule.clone(),)* }
            }
        }

        /// The columns of a row, in their order.
        pub const COLUMNS: &[Column] = &[
            $(Column::new(stringify!($first), concat!($($first_about),+), stringify!($first_kind), 1),)*
            $(
                $(#[$image_when])?
                Column::new(
                    stringify!($image),
                    concat!($($image_about),+),
                    <$image_kind as Value>::COLUMN,
                    $image_setting.since,
                ),
            )*
            $(
                $(#[$schedule_when])?
                Column::new(
                    stringify!($schedule),
                    concat!($($schedule_about),+),
                    <$schedule_kind as Value>::COLUMN,
                    $schedule_setting.since,
                ),
            )*
            $(Column::new(stringify!($field), concat!($($about),+), stringify!($kind), columns!(since $($since)?)),)*
        ];
    };
}
pub(super) use columns;

#[cfg(test)]
mod tests {
    use crate::measure::{COLUMNS, Record, SCHEMA};

    /// The headings of a real file, from the CSV writer.
    fn heads() -> Vec<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.serialize(Record::default()).unwrap();
        let text = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        text.lines().next().unwrap().split(',').map(str::to_string).collect()
    }

    #[test]
    fn columns_are_those_of_a_file() {
        let named: Vec<&str> = COLUMNS.iter().map(|column| column.name).collect();
        assert_eq!(named, heads());
    }

    #[test]
    fn every_column_is_explained() {
        for column in COLUMNS {
            assert!(column.about.len() > 4 && column.since <= SCHEMA, "{column:?}");
        }
    }

    #[test]
    fn types_and_units_are_told() {
        let column = |name: &str| *COLUMNS.iter().find(|column| column.name == name).unwrap();
        assert_eq!((column("makespan_s").values(), column("makespan_s").unit()), ("number", Some("seconds")));
        assert_eq!(
            (column("peak_rss_bytes").values(), column("peak_rss_bytes").unit()),
            ("whole number", Some("bytes"))
        );
        assert_eq!((column("scene").values(), column("dirty").values()), ("text", "true or false"));
        assert!(column("mse").may_be_empty() && !column("seed").may_be_empty());
        assert_eq!((column("simd").since, column("scene").since), (5, 1));
    }
}
