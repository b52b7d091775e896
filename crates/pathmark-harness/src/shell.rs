//! Command lines for a POSIX shell, to be shown to a user or written into a file.

use std::path::Path;

/// The name of this program's executable, without its folder.
pub fn executable_name() -> String {
    let first = std::env::args_os().next().unwrap_or_default();
    Path::new(&first).file_name().map_or_else(|| "pathmark".to_string(), |name| name.to_string_lossy().into_owned())
}

/// The command line of this program with these arguments.
pub fn command<S: AsRef<str>>(arguments: impl IntoIterator<Item = S>) -> String {
    command_of(&executable_name(), arguments)
}

/// The command line of another program, or of this one by another name.
pub fn command_of<S: AsRef<str>>(program: &str, arguments: impl IntoIterator<Item = S>) -> String {
    let program = quoted(program);
    arguments.into_iter().fold(program, |line, argument| format!("{line} {}", quoted(argument.as_ref())))
}

/// How to get a build that has this optional feature.
pub fn build_with(feature: &str) -> String {
    format!("a program built by `cargo run --release --features {feature} -- ...`")
}

/// The word as a shell reads it back, in quotes if it needs them.
pub fn quoted(word: &str) -> String {
    let is_plain = |char: char| char.is_ascii_alphanumeric() || "-_./:=,+@%".contains(char);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_string();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn a_shell_reads_back_every_word() {
        let words = [
            "", "plain", "a b", "it's", "\"x\"", "$HOME", "`id`", "a\\b", "*", "~", "#a", "a;b", "a\nb", "é", "''",
            "!x",
        ];
        let line = words.map(quoted).join(" ");
        let script = format!("printf '%s\\0' {line}");
        let output = Command::new("sh").args(["-c", &script]).output().unwrap();
        let read = String::from_utf8(output.stdout).unwrap();
        assert_eq!(read.split_terminator('\0').collect::<Vec<_>>(), words, "{line}");
        assert_eq!(quoted("--filter=strategy=a:b,c"), "--filter=strategy=a:b,c", "no needless quotes");
    }
}
