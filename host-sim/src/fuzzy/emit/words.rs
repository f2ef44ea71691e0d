//! Words in comments: nothing that a design says may end a comment or mislead its reader.

/// A text for a comment of any kind, on one line: what does not print is spelt out, and neither a comment of C nor a code span
/// of Markdown begins or ends in it.
pub fn plain(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            '`' => plain.push('\''),
            '\\' => plain.push('/'),
            '"' | '\'' => plain.push(c),
            _ => plain.extend(c.escape_debug().map(|c| if c == '\\' { '/' } else { c })),
        }
    }
    // Twice, for `/*/`.
    for _ in 0..2 {
        plain = plain.replace("*/", "* /").replace("/*", "/ *");
    }
    plain.replace("??", "? ?")
}

/// `1 input`, `2 inputs`.
pub fn count(number: usize, what: &str) -> String {
    match number {
        1 => format!("1 {what}"),
        _ => format!("{number} {what}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::plain;

    #[test]
    fn no_comment_ends_early() {
        for (text, expected) in [
            ("fan is low", "fan is low"),
            ("a */ b /* c", "a * / b / * c"),
            ("/*/", "/ * /"),
            ("a\nb\\", "a/nb/"),
            ("`x` ??/", "'x' ? ?/"),
            ("Größe 温度", "Größe 温度"),
            ("\u{202e}", "/u{202e}"),
        ] {
            assert_eq!(plain(text), expected);
        }
    }
}
