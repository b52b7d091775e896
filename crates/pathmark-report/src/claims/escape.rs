//! Words of a paper in Markdown: none of their signs changes the text around them.

/// A text of several lines as a quotation.
pub(super) fn quotation(text: &str) -> String {
    let line = |line: &str| {
        let line = escaped(line.trim());
        // A heading, a list, a quotation, or the rule below a heading.
        let digits = line.trim_start_matches(|own: char| own.is_ascii_digit());
        let is_numbered = digits.len() < line.len() && digits.starts_with(['.', ')']);
        if line.starts_with(['#', '-', '+', '=', '>']) {
            format!("> \\{line}")
        } else if is_numbered {
            let (number, rest) = line.split_at(line.len() - digits.len());
            format!("> {number}\\{rest}")
        } else {
            format!("> {line}").trim_end().to_string()
        }
    };
    text.trim().lines().map(line).collect::<Vec<String>>().join("\n")
}

/// A text with its white space as single spaces.
pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<&str>>().join(" ")
}

/// A text of one line, with backslashes before the signs of Markdown and HTML.
pub(super) fn escaped(text: &str) -> String {
    let mut shown = String::new();
    let mut signs = text.chars().peekable();
    while let Some(sign) = signs.next() {
        let next = signs.peek().copied().unwrap_or(' ');
        let is_markup = match sign {
            '\\' | '`' | '*' | '_' | '[' | ']' | '~' | '|' | '$' => true,
            '<' => next.is_ascii_alphabetic() || "/!?".contains(next),
            '&' => next.is_ascii_alphabetic() || next == '#',
            _ => false,
        };
        if is_markup {
            shown.push('\\');
        }
        shown.push(sign);
    }
    shown
}

/// A text of a cell: a bar would end it, and a line end the row.
pub(super) fn cell(text: &str) -> String {
    one_line(text).replace('|', "\\|")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_sign_of_a_quotation_is_markup() {
        let text =
            "a *bold* <b>claim</b> &amp; [link](x)\r\n\r\n# 1 < 2 & 3\n- item_a\n12. twelve\n12 monkeys\n    code";
        let shown = "> a \\*bold\\* \\<b>claim\\</b> \\&amp; \\[link\\](x)\n>\n> \\# 1 < 2 & 3\n> \\- item\\_a\n> 12\\. twelve\n\
                     > 12 monkeys\n> code";
        assert_eq!(quotation(text), shown);
        assert_eq!((cell(" a|b\n c "), one_line("a\r\n b")), ("a\\|b c".to_string(), "a b".to_string()));
    }
}
