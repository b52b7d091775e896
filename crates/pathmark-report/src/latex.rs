//! Text and tables for LaTeX.

/// Most columns of a table at its natural size; more are scaled to the width of the text.
const MOST_COLUMNS: usize = 6;

/// The text with every character that LaTeX would read as a command in a form that it prints.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '\\' => out.push_str("\\textbackslash{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '^' => out.push_str("\\textasciicircum{}"),
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => out.extend(['\\', letter]),
            '≈' => out.push_str("$\\approx$"),
            '×' => out.push_str("$\\times$"),
            '±' => out.push_str("$\\pm$"),
            '≤' => out.push_str("$\\leq$"),
            '≥' => out.push_str("$\\geq$"),
            letter if letter.is_control() => out.push(' '),
            letter => out.push(letter),
        }
    }
    out
}

/// A text in which backquotes enclose code.
pub(crate) fn prose(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return escaped(text);
    }
    let part = |(index, part): (usize, &&str)| {
        let part = escaped(part);
        if index % 2 == 1 { format!("\\texttt{{{part}}}") } else { part }
    };
    parts.iter().enumerate().map(part).collect()
}

/// A table of plain text: its first column is aligned to the left, the others to the right if they are numbers.
pub fn tabular(heads: &[String], rows: &[Vec<String>]) -> String {
    let is_number = |text: &str| text.starts_with(|first: char| first.is_ascii_digit() || "-+.≈±".contains(first));
    let align = |column: usize| {
        let is_right = column > 0 && rows.iter().all(|row| row.get(column).is_some_and(|text| is_number(text)));
        if is_right { 'r' } else { 'l' }
    };
    let aligned: String = (0..heads.len()).map(align).collect();
    let line = |cells: &[String]| {
        let cells: Vec<String> = cells.iter().map(|cell| escaped(cell)).collect();
        format!("{} \\\\\n", cells.join(" & "))
    };
    let body: String = rows.iter().map(|row| line(row)).collect();
    let heads = line(heads);
    let table =
        format!("\\begin{{tabular}}{{{aligned}}}\n\\toprule\n{heads}\\midrule\n{body}\\bottomrule\n\\end{{tabular}}\n");
    if aligned.len() > MOST_COLUMNS { format!("\\resizebox{{\\textwidth}}{{!}}{{%\n{table}}}\n") } else { table }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// Asserts what LaTeX needs to read a text at all: braces that match, and environments that end in their order.
    pub(crate) fn assert_balanced(text: &str) {
        let code: String = text.lines().filter(|line| !line.starts_with('%')).collect::<Vec<_>>().join("\n");
        let plain = code.replace("\\\\", "").replace("\\{", "").replace("\\}", "");
        let mut depth = 0;
        for letter in plain.chars() {
            depth += i32::from(letter == '{') - i32::from(letter == '}');
            assert!(depth >= 0, "{text}");
        }
        assert_eq!(depth, 0, "{text}");
        let mut open = Vec::new();
        for word in plain.split('\\') {
            let name = |word: &str| word.split(['{', '}']).nth(1).map(str::to_string);
            if word.starts_with("begin{") {
                open.push(name(word));
            } else if word.starts_with("end{") {
                assert_eq!(open.pop(), Some(name(word)), "{text}");
            }
        }
        assert!(open.is_empty(), "{open:?}: {text}");
    }

    #[test]
    fn special_characters_are_printed() {
        let all = escaped("50 % of {a_b} & $c #1 \\d ~e ^f ≈ 2\n");
        let expected = "50 \\% of \\{a\\_b\\} \\& \\$c \\#1 \\textbackslash{}d \\textasciitilde{}e \\textasciicircum{}f $\\approx$ 2 ";
        assert_eq!(all, expected);
        assert_balanced(&all);
        assert_eq!(prose("run `a_b` now"), "run \\texttt{a\\_b} now");
        assert_eq!(prose("one ` alone_"), "one ` alone\\_");
    }

    #[test]
    fn numbers_stand_at_the_right_and_wide_tables_are_scaled() {
        let words = |words: &[&str]| words.iter().map(ToString::to_string).collect::<Vec<String>>();
        let table = tabular(&words(&["name", "of", "s"]), &[words(&["1", "a & b", "0.5"]), words(&["2", "3", "-1"])]);
        let expected = "\\begin{tabular}{llr}\n\\toprule\nname & of & s \\\\\n\\midrule\n1 & a \\& b & 0.5 \\\\\n2 & 3 & -1 \\\\\n\
            \\bottomrule\n\\end{tabular}\n";
        assert_eq!(table, expected);
        let wide = tabular(&vec!["{".to_string(); 7], &[vec!["}".to_string(); 7]]);
        assert!(wide.starts_with("\\resizebox"), "{wide}");
        assert_balanced(&wide);
    }
}
