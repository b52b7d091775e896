//! The words above a figure.

/// A figure's title: the result, where the rows have one, above a description; otherwise the description alone.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Title {
    description: String,
    result: Option<String>,
}

impl Title {
    pub fn new(description: impl Into<String>) -> Self {
        Self { description: description.into(), result: None }
    }

    /// Adds the result: a sentence that the intervals support, without a full stop. `None` leaves the description as the
    /// title.
    #[must_use]
    pub fn with_result(mut self, result: Option<String>) -> Self {
        self.result = result;
        self
    }

    /// The first line.
    pub fn head(&self) -> &str {
        self.result.as_deref().unwrap_or(&self.description)
    }

    /// The lines below it: the description, unless it is the first line, and the subtitle.
    pub(super) fn below(&self, subtitle: &str) -> String {
        match &self.result {
            Some(_) if subtitle.is_empty() => self.description.clone(),
            Some(_) => format!("{}\n{subtitle}", self.description),
            None => subtitle.to_string(),
        }
    }
}

impl From<String> for Title {
    fn from(description: String) -> Self {
        Self::new(description)
    }
}

impl From<&String> for Title {
    fn from(description: &String) -> Self {
        Self::new(description)
    }
}

impl From<&str> for Title {
    fn from(description: &str) -> Self {
        Self::new(description)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_result_stands_above_the_description() {
        let plain = Title::new("Speedup against threads");
        assert_eq!((plain.head(), plain.below("cornell").as_str()), ("Speedup against threads", "cornell"));
        assert_eq!(plain.clone().with_result(None), plain);
        let told = plain.with_result(Some("Nine schedules tie".to_string()));
        assert_eq!(told.head(), "Nine schedules tie");
        assert_eq!(told.below("cornell"), "Speedup against threads\ncornell");
        assert_eq!(told.below(""), "Speedup against threads");
    }
}
