//! The columns of `records.csv`, derived from the type of a row.

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    pub name: &'static str,
    /// Its description, with the unit.
    pub about: &'static str,
    /// The type of its values in this program.
    pub(super) kind: &'static str,
}

const RENAMED: &[(&str, &str)] = &[
    ("gap_sum_s", "idle_between_jobs_s"),
    ("tail_sum_s", "idle_tail_s"),
    ("setup_s", "strategy_setup_s"),
    ("build_s", "kernel_build_s"),
    ("order", "run_order"),
    ("paths", "samples"),
    ("escaped", "escaped_rays"),
    ("foreign_cpu_s", "other_cpu_s"),
];

impl Column {
    /// Today's name of a column; names of the version before are read for one release.
    pub fn new_name(name: &str) -> &str {
        RENAMED.iter().find(|(old, _)| *old == name).map_or(name, |(_, new)| new)
    }

    pub(super) const fn new(name: &'static str, about: &'static str, kind: &'static str) -> Self {
        Self { name, about, kind }
    }

    pub fn values(&self) -> &'static str {
        let kind = self.kind;
        if kind.contains("f64") || kind.contains("Seconds") {
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
        let units = [("_s", "seconds"), ("_bytes", "bytes"), ("_mhz", "megahertz")];
        units.iter().find(|(ending, _)| self.name.ends_with(ending)).map(|(_, unit)| *unit)
    }
}

/// A struct with the columns of the settings between its own public fields, and the list of its fields as columns.
macro_rules! columns {
    ({
        $(#[$meta:meta])*
        pub struct $name:ident { $($(#[doc = $f_about:literal])+ pub $f:ident: $f_kind:ty,)* }
        settings { $($(#[doc = $l_about:literal])+ pub $l:ident: $l_kind:ty,)* }
    } image { $(
        $(#[doc = $i_about:literal])+ $i_place:ident $i:ident: $i_kind:ty $(= $i_default:expr)?, $i_setting:expr
        $(, when $i_when:meta)? $(, read $i_read:meta)?;
    )* } schedule { $(
        $(#[doc = $s_about:literal])+ $s_place:ident $s:ident: $s_kind:ty $(= $s_default:expr)?, $s_setting:expr
        $(, when $s_when:meta)? $(, read $s_read:meta)?;
    )* }) => {
        $(#[$meta])*
        pub struct $name {
            $($(#[doc = $f_about])+ pub $f: $f_kind,)*
            $($(#[doc = $i_about])+ $(#[$i_when])? pub $i: <$i_kind as Asked>::Column,)*
            $($(#[doc = $s_about])+ $(#[$s_when])? $(#[$s_read])? pub $s: <$s_kind as Asked>::Column,)*
            $($(#[doc = $l_about])+ pub $l: $l_kind,)*
        }

        impl $name {
            fn of_keys(image: ImageKey, schedule: ScheduleKey) -> Self {
                Self { $($(#[$i_when])? $i: image.$i,)* $($(#[$s_when])? $s: schedule.$s,)* ..Self::default() }
            }

            /// The identity of its image.
            pub fn image_key(&self) -> ImageKey {
                ImageKey { $($(#[$i_when])? $i: self.$i.clone(),)* }
            }

            /// The identity of its schedule among those of the same image.
            pub fn schedule_key(&self) -> ScheduleKey {
                ScheduleKey { $($(#[$s_when])? $s: self.$s.clone(),)* }
            }
        }

        pub const COLUMNS: &[Column] = &[
            $(Column::new(stringify!($f), concat!($($f_about),+), stringify!($f_kind)),)*
            $($(#[$i_when])?
            Column::new(stringify!($i), concat!($($i_about),+), <$i_kind as Asked>::COLUMN),)*
            $($(#[$s_when])?
            Column::new(stringify!($s), concat!($($s_about),+), <$s_kind as Asked>::COLUMN),)*
            $(Column::new(stringify!($l), concat!($($l_about),+), stringify!($l_kind)),)*
        ];
    };
}
pub(super) use columns;

#[cfg(test)]
mod tests {
    use super::{Column, RENAMED};
    use crate::measure::{COLUMNS, Record};

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
            assert!(column.about.len() > 4, "{column:?}");
        }
    }

    #[test]
    fn renamed_columns_are_known_by_their_new_names() {
        let is_column = |name: &str| COLUMNS.iter().any(|column| column.name == name);
        for (old, new) in RENAMED {
            assert!(is_column(new) && !is_column(old) && Column::new_name(old) == *new, "{old}, {new}");
        }
        assert_eq!(Column::new_name("makespan_s"), "makespan_s");
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
    }
}
