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
}

/// The first version of the columns that had each; all others are as old as the file.
const SINCE: &[(u32, &[&str])] = &[
    (2, &["output", "pilot_s", "gap_sum_s", "tail_sum_s", "foreign_cpu_s"]),
    (3, &["accelerator", "max_depth", "build_s", "box_tests", "primitive_tests"]),
    (4, &["adaptive", "target_error", "time_limit_s", "rounds", "estimated_rmse", "variance", "roulette", "clamp"]),
    (5, &["kernel_fallback", "simd"]),
    (6, &["filter", "epsilon", "object_mse", "within_tolerance", "fireflies", "black_pixels", "image_write_s"]),
    (7, &["ranks", "rank_rule", "mpi"]),
    (8, &["device_compile_s", "device_copy_s"]),
    (9, &["camera_rays"]),
    (10, &["steal_s"]),
];

impl Column {
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

    /// The first version of the columns (column `schema`) that has it.
    pub fn since(&self) -> u32 {
        SINCE.iter().find(|(_, names)| names.contains(&self.name)).map_or(1, |(version, _)| *version)
    }
}

/// A struct with public fields, and the list of its fields as columns.
macro_rules! columns {
    (
        $(#[$meta:meta])*
        pub struct $name:ident {
            $($(#[doc = $about:literal])+ pub $field:ident: $kind:ty,)*
        }
    ) => {
        $(#[$meta])*
        pub struct $name {
            $($(#[doc = $about])+ pub $field: $kind,)*
        }

        /// The columns of a row, in their order.
        pub const COLUMNS: &[$crate::measure::Column] = &[
            $($crate::measure::Column { name: stringify!($field), about: concat!($($about),+), kind: stringify!($kind) }),*
        ];
    };
}
pub(super) use columns;

#[cfg(test)]
mod tests {
    use super::*;
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
            assert!(column.about.len() > 4, "{column:?}");
        }
        for (version, names) in SINCE {
            assert!(*version <= SCHEMA);
            for name in *names {
                assert!(COLUMNS.iter().any(|column| column.name == *name), "{name} is no column");
            }
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
        assert_eq!((column("simd").since(), column("scene").since()), (5, 1));
    }
}
