//! The terms of an entry that can be checked without running jobs.

use super::case::Case;
use super::spawner::CountedThreads;
use crate::StrategyError;

/// The name must be lower-case words with `-` between them, and the description one line.
pub(super) fn name(case: &Case) -> Result<(), String> {
    let (name, about) = (case.entry.name, case.entry.about);
    case.at(format!("the name {name:?}"));
    let of_a_word =
        |word: &str| !word.is_empty() && word.bytes().all(|byte| byte.is_ascii_lowercase() || byte.is_ascii_digit());
    if !name.split('-').all(of_a_word) {
        return Err("expected lower-case letters and digits, in words with - between them".to_owned());
    }
    if about.is_empty() || about.contains('\n') {
        return Err(format!("expected an explanation of one line, not {about:?}"));
    }
    Ok(())
}

pub(super) fn parameter(case: &Case) -> Result<(), String> {
    const NONSENSE: &str = "no-such-parameter";
    case.at(format!("{}:{NONSENSE}", case.entry.name));
    match case.entry.discipline(Some(NONSENSE)) {
        Ok(discipline) => return Err(format!("it is accepted as {discipline:?}")),
        Err(StrategyError::Parameter { .. }) => {}
        Err(other) => return Err(format!("a different error is returned: {other}")),
    }
    let given = case.contract.parameter.as_deref().unwrap_or("");
    case.at(format!("{}:{given}, 1 thread", case.entry.name));
    case.build(1, &CountedThreads::unlimited()).map(drop)
}
