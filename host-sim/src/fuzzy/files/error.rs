//! What is wrong with a design file: where, what was found, what is allowed, and the line itself with a mark under it.

use crate::fuzzy::model::Place;
use std::fmt::{self, Display, Formatter};

/// Why a design file was not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadError(Box<Details>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Details {
    file: String,
    place: Option<Place>,
    found: String,
    allowed: String,
    excerpt: Option<Excerpt>,
}

/// A line of the file, cut to what is around the mark.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Excerpt {
    text: String,
    /// Characters before the mark.
    indent: usize,
    /// Characters marked.
    width: usize,
}

impl ReadError {
    /// About the file as a whole.
    pub fn of_file(file: &str, found: impl Into<String>, allowed: impl Into<String>) -> Self {
        Self(Box::new(Details {
            file: file.to_owned(),
            place: None,
            found: found.into(),
            allowed: allowed.into(),
            excerpt: None,
        }))
    }

    /// Where it is, if it is anywhere.
    pub fn place(&self) -> Option<Place> {
        self.0.place
    }
}

impl std::error::Error for ReadError {}

impl Display for ReadError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Details {
            file,
            place,
            found,
            allowed,
            excerpt,
        } = &*self.0;
        write!(f, "{file}")?;
        if let Some(Place { line, column }) = place {
            write!(f, ":{line}:{column}")?;
        }
        write!(f, ": {found}")?;
        if !allowed.is_empty() {
            write!(f, "; allowed is {allowed}")?;
        }
        if let (Some(excerpt), Some(place)) = (excerpt, place) {
            let number = place.line.to_string();
            let margin = " ".repeat(number.len());
            let indent = " ".repeat(excerpt.indent);
            let mark = "^".repeat(excerpt.width);
            write!(f, "\n {number} | {}", excerpt.text)?;
            write!(f, "\n {margin} | {indent}{mark}")?;
        }
        Ok(())
    }
}

/// A design file's text and what messages call it.
#[derive(Clone, Copy, Debug)]
pub struct Source<'s> {
    /// What messages call it.
    pub file: &'s str,
    /// What it says.
    pub text: &'s str,
}

impl Source<'_> {
    /// An error at a place of it.
    pub fn error(
        &self,
        place: Place,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> ReadError {
        ReadError(Box::new(Details {
            file: self.file.to_owned(),
            place: Some(place),
            found: found.into(),
            allowed: allowed.into(),
            excerpt: self.excerpt(place),
        }))
    }

    /// The place behind the last character.
    pub fn end(&self) -> Place {
        let mut place = Place { line: 1, column: 1 };
        advance(&mut place, self.text);
        place
    }

    fn excerpt(&self, place: Place) -> Option<Excerpt> {
        /// As much of a long line as a terminal shows.
        const WIDTH: usize = 90;
        /// What is kept before the mark.
        const LEAD: usize = 60;
        let line = lines(self.text).nth(place.line.checked_sub(1)?)?;
        if line.trim().is_empty() {
            return None;
        }
        let before = place.column.saturating_sub(1);
        let skipped = before.saturating_sub(LEAD);
        let mut text = String::new();
        if skipped > 0 {
            text.push('…');
        }
        let mut rest = line.chars().skip(skipped);
        text.extend(rest.by_ref().take(WIDTH).map(printable));
        if rest.next().is_some() {
            text.push('…');
        }
        // A mark is as wide as the word that it is under.
        let marked = line.chars().skip(before).take(WIDTH - LEAD);
        let width = match marked.clone().next() {
            // A text up to its closing quote.
            Some('\'') => marked
                .clone()
                .skip(1)
                .position(|c| c == '\'')
                .map_or(1, |n| n + 2),
            _ => marked
                .take_while(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '-' | '+'))
                .count()
                .max(1),
        };
        Some(Excerpt {
            text: text.trim_end().to_owned(),
            indent: before - skipped + usize::from(skipped > 0),
            width,
        })
    }
}

/// A character as it may be shown: one column wide and without power over a terminal.
fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        c if c.is_control() => '\u{fffd}',
        c => c,
    }
}

/// A text of the file between back quotes, shortened.
pub fn quoted(text: &str) -> String {
    const MOST: usize = 40;
    let mut short: String = text.chars().take(MOST).map(printable).collect();
    if text.chars().nth(MOST).is_some() {
        short.push('…');
    }
    format!("`{short}`")
}

/// "one of a, b, c", shortened.
pub fn one_of<T: AsRef<str>>(names: impl IntoIterator<Item = T>) -> String {
    const MOST: usize = 24;
    let mut names = names.into_iter();
    let mut shown: Vec<String> = names
        .by_ref()
        .take(MOST)
        .map(|n| n.as_ref().to_owned())
        .collect();
    if names.next().is_some() {
        shown.push("…".to_owned());
    }
    match shown.as_slice() {
        [] => "nothing".to_owned(),
        [only] => only.clone(),
        [first, second] => format!("{first} or {second}"),
        _ => format!("one of {}", shown.join(", ")),
    }
}

/// "1 rule", "2 rules".
pub fn counted(count: usize, what: &str) -> String {
    match count {
        1 => format!("1 {what}"),
        _ => format!("{count} {what}s"),
    }
}

/// The lines of a text, however it ends them.
pub fn lines(text: &str) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let all = rest?;
        let Some(end) = all.find(['\n', '\r']) else {
            rest = None;
            return Some(all);
        };
        let (line, tail) = all.split_at(end);
        rest = Some(tail.strip_prefix("\r\n").unwrap_or(&tail[1..]));
        Some(line)
    })
}

/// Moves a place behind a text that begins there.
pub fn advance(place: &mut Place, text: &str) {
    for (i, c) in text.char_indices() {
        if c == '\n' || (c == '\r' && !text[i + 1..].starts_with('\n')) {
            *place = Place {
                line: place.line + 1,
                column: 1,
            };
        } else {
            place.column += 1;
        }
    }
}
