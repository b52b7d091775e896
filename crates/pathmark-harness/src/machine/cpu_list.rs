//! Lists of processors as Linux writes them: `0-3,8,10-11`.

/// Largest number of a processor that is read: a list such as `0-4294967295` must not fill the memory.
const LARGEST: usize = 1 << 16;

/// Reads a list, in rising order and without repetition; `None` if it is not one, or names a number that no system has.
pub fn parse_cpu_list(text: &str) -> Option<Vec<usize>> {
    let text = text.trim();
    let mut cpus = Vec::new();
    for part in text.split(',').filter(|_| !text.is_empty()) {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let number = |text: &str| text.parse::<usize>().ok().filter(|number| *number <= LARGEST);
        let (first, last) = (number(first)?, number(last)?);
        if first > last {
            return None;
        }
        cpus.extend(first..=last);
    }
    cpus.sort_unstable();
    cpus.dedup();
    Some(cpus)
}

/// Writes a list of numbers in rising order.
pub fn cpu_list(cpus: &[usize]) -> String {
    let range = |run: &[usize]| match run {
        [one] => one.to_string(),
        _ => format!("{}-{}", run[0], run[run.len() - 1]),
    };
    cpus.chunk_by(|a, b| b - a == 1).map(range).collect::<Vec<_>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_read_and_written() {
        for (text, cpus) in [("0-3,8,10-11", vec![0, 1, 2, 3, 8, 10, 11]), ("5\n", vec![5]), ("", vec![])] {
            let read = parse_cpu_list(text).unwrap();
            assert_eq!((&read, cpu_list(&read)), (&cpus, text.trim().to_string()));
        }
        assert_eq!(parse_cpu_list("3,1,1-2"), Some(vec![1, 2, 3]));
        for wrong in ["a", "1-", "-1", "3-1", "1,,2", "0-4294967295", "1 2", "0x1"] {
            assert_eq!(parse_cpu_list(wrong), None, "{wrong}");
        }
    }
}
