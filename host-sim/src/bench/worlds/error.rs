//! What can be wrong with worlds, said in one line.

/// Why worlds cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// A file that cannot be read at all.
    #[error("{file}: cannot be read ({why})")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason.
        why: String,
    },
    /// Something in a file, or in what was asked for.
    #[error("{place}: found {found}; allowed: {allowed}")]
    Wrong {
        /// File and line or byte, or option.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// A world that no robot gets through.
    #[error("{place}: world {number}: {why}")]
    Unusable {
        /// File or generator.
        place: String,
        /// World.
        number: u32,
        /// Reason.
        why: String,
    },
}

impl WorldError {
    /// Something in a file, or in what was asked for.
    pub fn wrong(
        place: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Wrong {
            place: place.into(),
            found: short(&found.into()),
            allowed: allowed.into(),
        }
    }
}

/// What is wrong with JSON, without the line: that stands before it.
pub fn of_json(error: &serde_json::Error) -> String {
    let text = error.to_string();
    let at = format!(" at line {} column {}", error.line(), error.column());
    match text.strip_suffix(&at) {
        Some(what) => short(&format!("{what} at column {}", error.column())),
        None => short(&text),
    }
}

/// Most digits of a number in a message.
const DIGITS: usize = 20;

/// A message whose numbers have an exponent where they would have hundreds of digits.
pub fn short(text: &str) -> String {
    let mut said = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, number) = rest.split_at(at);
        let end = number.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (number, after) = number.split_at(end.unwrap_or(number.len()));
        said += before;
        match number.parse::<f64>() {
            Ok(x) if number.len() > DIGITS => said += &format!("{x:e}"),
            _ => said += number,
        }
        rest = after;
    }
    said + rest
}

#[cfg(test)]
mod tests {
    use super::short;

    #[test]
    fn only_long_numbers_get_an_exponent() {
        assert_eq!(short("world 7: (0.25, -3)."), "world 7: (0.25, -3).");
        assert_eq!(short(&format!("`{}`, m", 1e300)), "`1e300`, m");
        assert_eq!(short(&format!("{} m", -1.5e-40)), "-1.5e-40 m");
    }
}
