//! Tables in Markdown, for pages of artifacts and summaries of pull requests.

/// A table with a heading; columns of numbers are flush right.
pub(crate) fn table<const N: usize>(heads: [&str; N], rows: impl IntoIterator<Item = [String; N]>) -> String {
    let line = |cells: &[String]| {
        // A bar would end the cell, and a line end the row.
        let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|").replace('\n', " ")).collect();
        format!("| {} |", cells.join(" | "))
    };
    let rows: Vec<[String; N]> = rows.into_iter().collect();
    let is_number =
        |at: usize| rows.iter().all(|row| row[at].starts_with(|first: char| first.is_ascii_digit() || first == '-'));
    let rule: Vec<&str> = (0..N).map(|at| if is_number(at) { "--:" } else { "--" }).collect();
    let heads = line(&heads.map(str::to_string));
    let rows = rows.iter().map(|row| line(row));
    [heads, format!("|{}|", rule.join("|"))].into_iter().chain(rows).collect::<Vec<String>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_and_line_ends_stay_within_their_cell() {
        let rows = [["a|b\nc", "1.5"], ["d", "-"]].map(|row| row.map(str::to_string));
        assert_eq!(table(["name", "ratio"], rows), "| name | ratio |\n|--|--:|\n| a\\|b c | 1.5 |\n| d | - |");
    }
}
