//! Numbers that lanes look up, each lane in its own row of a table, or load side by side.

use super::{Aligned, Apart, Float, MOST_LANES, Precision};

/// Rows of four numbers in one format. The other format has a row of zeros, so that a lookup in it finds something.
pub struct Table {
    pub(super) rows: Vec<[f64; 4]>,
    pub(super) singles: Vec<[f32; 4]>,
    /// The columns of a table of at most 16 rows, padded with zeros: they fit two registers of 512 bits.
    #[cfg(target_arch = "x86_64")]
    pub(super) columns: Option<[[f64; 16]; 4]>,
    /// The columns of a table of at most 32 rows, in single precision.
    #[cfg(target_arch = "x86_64")]
    pub(super) single_columns: Option<[[f32; 32]; 4]>,
}

#[cfg(target_arch = "x86_64")]
fn columns<T: Copy + Default, const N: usize>(rows: &[[T; 4]]) -> Option<[[T; N]; 4]> {
    (rows.len() <= N).then(|| {
        [0, 1, 2, 3].map(|j| {
            let mut column = [T::default(); N];
            column.iter_mut().zip(rows).for_each(|(entry, row)| *entry = row[j]);
            column
        })
    })
}

#[cfg(target_arch = "x86_64")]
#[inline(always)]
fn start<T>(rows: &[[T; 4]], number: i32) -> *const [T; 4] {
    let number = number as usize;
    rows.as_ptr().wrapping_add(number.wrapping_mul(usize::from(number < rows.len())))
}

impl Table {
    /// A table whose numbers are rounded if need be. There must be at least one row.
    pub fn new(rows: impl IntoIterator<Item = [f64; 4]>, precision: Precision) -> Self {
        let (mut doubles, mut singles) = (vec![[0.0; 4]], vec![[0.0; 4]]);
        match precision {
            Precision::F64 => doubles = rows.into_iter().collect(),
            Precision::F32 => singles = rows.into_iter().map(|row| row.map(|number| number as f32)).collect(),
        }
        assert!(!doubles.is_empty() && !singles.is_empty(), "a table needs a row");
        Self {
            #[cfg(target_arch = "x86_64")]
            columns: columns(&doubles),
            #[cfg(target_arch = "x86_64")]
            single_columns: columns(&singles),
            rows: doubles,
            singles,
        }
    }

    /// Address of the row with that number, as in [`Table::row`]: without a branch, for loads into registers.
    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn row_start(&self, number: i32) -> *const f64 {
        start(&self.rows, number).cast()
    }

    #[cfg(target_arch = "x86_64")]
    #[inline(always)]
    pub(super) fn single_row_start(&self, number: i32) -> *const f32 {
        start(&self.singles, number).cast()
    }

    /// The row with that number; the first if there is none, because a lane without a ray may hold any number.
    #[inline(always)]
    pub fn row(&self, number: i32) -> &[f64; 4] {
        self.rows.get(number as usize).unwrap_or(&self.rows[0])
    }

    #[inline(always)]
    pub(super) fn single_row(&self, number: i32) -> &[f32; 4] {
        self.singles.get(number as usize).unwrap_or(&self.singles[0])
    }
}

/// One number per row, exact in single precision.
pub struct Column(Vec<f32>);

impl Column {
    /// A column. There must be at least one row.
    pub fn new(numbers: impl IntoIterator<Item = f32>) -> Self {
        let numbers: Vec<f32> = numbers.into_iter().collect();
        assert!(!numbers.is_empty(), "a column needs a row");
        Self(numbers)
    }

    /// The numbers in these rows; the first row's number where there is no such row.
    #[inline(always)]
    pub fn at<V: Float>(&self, rows: V) -> V {
        V::apart(Rows { column: self, rows })
    }
}

/// A lookup in a column. In the caller, its loop over lanes would take registers.
struct Rows<'a, V> {
    column: &'a Column,
    rows: V,
}

impl<V: Float> Apart for Rows<'_, V> {
    type Output = V;

    #[inline(always)]
    fn run(self) -> V {
        let Self { column: Column(column), rows } = self;
        let mut numbers = [V::One::default(); MOST_LANES];
        rows.store(&mut numbers);
        for number in &mut numbers[..V::LANES] {
            let row: f64 = (*number).into();
            *number = V::one(f64::from(column.get(row as usize).copied().unwrap_or(column[0])));
        }
        V::load(&numbers)
    }
}

/// Numbers side by side, in the format in which they are loaded.
pub struct Numbers {
    precision: Precision,
    doubles: Aligned<f64>,
    singles: Aligned<f32>,
}

impl Numbers {
    /// An empty list with room for `count` numbers.
    pub fn with_capacity(count: usize, precision: Precision) -> Self {
        let (doubles, singles) = match precision {
            Precision::F64 => (count, 0),
            Precision::F32 => (0, count),
        };
        let (doubles, singles) = (Aligned::with_capacity(doubles), Aligned::with_capacity(singles));
        Self { precision, doubles, singles }
    }

    /// Appends numbers, rounded if need be.
    pub fn extend(&mut self, numbers: impl IntoIterator<Item = f64>) {
        match self.precision {
            Precision::F64 => self.doubles.extend(numbers),
            Precision::F32 => self.singles.extend(numbers.into_iter().map(|number| number as f32)),
        }
    }

    pub fn precision(&self) -> Precision {
        self.precision
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub fn len(&self) -> usize {
        self.doubles.len() + self.singles.len()
    }

    /// The number in that place, as stored.
    pub fn at(&self, place: usize) -> f64 {
        match self.precision {
            Precision::F64 => self.doubles[place],
            Precision::F32 => self.singles[place].into(),
        }
    }

    /// Their size in bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.doubles) + size_of_val(&*self.singles)
    }

    /// Numbers, rounded if need be.
    pub fn new(numbers: Vec<f64>, precision: Precision) -> Self {
        let mut all = Self::with_capacity(numbers.len(), precision);
        all.extend(numbers);
        all
    }
}

/// A number of either format. No other type is one, because memory is read as these numbers.
pub trait Number: Copy + Default + PartialOrd + Into<f64> + Send + Sync {
    /// The numbers in that format; none if they are in the other.
    fn all(numbers: &Numbers) -> &[Self];
    /// These numbers, if they are in that format.
    fn of_doubles(numbers: &mut [f64]) -> Option<&mut [Self]>;
}

impl Number for f64 {
    #[inline(always)]
    fn all(numbers: &Numbers) -> &[Self] {
        &numbers.doubles
    }

    #[inline(always)]
    fn of_doubles(numbers: &mut [f64]) -> Option<&mut [Self]> {
        Some(numbers)
    }
}

impl Number for f32 {
    #[inline(always)]
    fn all(numbers: &Numbers) -> &[Self] {
        &numbers.singles
    }

    #[inline(always)]
    fn of_doubles(_: &mut [f64]) -> Option<&mut [Self]> {
        None
    }
}
