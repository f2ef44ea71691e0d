//! A way through a text's tokens, with the errors that can be met on it.

use super::error::{ReadError, Source, one_of, quoted};
use super::lexer::{Kind, Token};
use super::limits;

/// A place among the tokens of a text. It is cheap to copy.
#[derive(Clone, Copy, Debug)]
pub struct Cursor<'s, 't> {
    source: Source<'s>,
    tokens: &'t [Token<'s>],
    at: usize,
    /// What is at an end there: "the line", "the file".
    whole: &'static str,
}

impl<'s, 't> Cursor<'s, 't> {
    /// At the first of tokens, the last of which must be [`Kind::End`].
    pub fn new(source: Source<'s>, tokens: &'t [Token<'s>], whole: &'static str) -> Self {
        Self {
            source,
            tokens,
            at: 0,
            whole,
        }
    }

    /// The token that is next.
    pub fn peek(&self) -> Token<'s> {
        let last = self.tokens.len() - 1;
        self.tokens[self.at.min(last)]
    }

    /// The token that is next; the cursor moves behind it, but never behind the end.
    pub fn take(&mut self) -> Token<'s> {
        let token = self.peek();
        if token.kind != Kind::End {
            self.at += 1;
        }
        token
    }

    /// That the next token is none of those allowed.
    pub fn unexpected(&self, allowed: impl Into<String>) -> ReadError {
        let token = self.peek();
        let found = match token.kind {
            Kind::End => format!("{} ends here", self.whole),
            Kind::Open => {
                let (opening, closing) = closing(token.text);
                let found = format!("`{opening}` opens what is never closed");
                let allowed = match closing {
                    quote @ ("'" | "\"") => format!("`{quote}` at its end, on the same line"),
                    _ => format!("`{closing}` somewhere behind it"),
                };
                return self.source.error(token.place, found, allowed);
            }
            Kind::Text => format!("found the text {}", quoted(token.text)),
            _ => format!("found {}", quoted(token.text)),
        };
        self.source.error(token.place, found, allowed)
    }

    /// Whether the next token is this sign.
    pub fn at_sign(&self, sign: &str) -> bool {
        self.peek().kind == Kind::Sign && self.peek().text == sign
    }

    /// Whether the next token is this word, in capitals or not.
    pub fn at_word(&self, word: &str) -> bool {
        self.peek().kind == Kind::Word && self.peek().text.eq_ignore_ascii_case(word)
    }

    /// Takes the next token if it is this word, in capitals or not.
    pub fn eat_word(&mut self, word: &str) -> bool {
        let is = self.at_word(word);
        if is {
            self.at += 1;
        }
        is
    }

    /// Takes the next token if it is this sign.
    pub fn eat_sign(&mut self, sign: &str) -> bool {
        let is = self.at_sign(sign);
        if is {
            self.at += 1;
        }
        is
    }

    /// This sign.
    pub fn sign(&mut self, sign: &str) -> Result<(), ReadError> {
        match self.eat_sign(sign) {
            true => Ok(()),
            false => Err(self.unexpected(format!("`{sign}`"))),
        }
    }

    /// This word, in capitals or not.
    pub fn word(&mut self, word: &str) -> Result<Token<'s>, ReadError> {
        match self.at_word(word) {
            true => Ok(self.take()),
            false => Err(self.unexpected(format!("`{word}`"))),
        }
    }

    /// One of these words, in capitals or not.
    pub fn choice<T: Copy>(
        &mut self,
        what: &str,
        choices: &[(&str, T)],
    ) -> Result<(Token<'s>, T), ReadError> {
        match choices.iter().find(|(word, _)| self.at_word(word)) {
            Some(&(_, choice)) => Ok((self.take(), choice)),
            None => Err(self.unexpected(format!(
                "{what}{}",
                one_of(choices.iter().map(|(word, _)| word))
            ))),
        }
    }

    /// A name that is none of the reserved words.
    pub fn name(&mut self, what: &str, reserved: &[&str]) -> Result<Token<'s>, ReadError> {
        let token = self.peek();
        if token.kind != Kind::Word {
            let of = "letters, digits and `_`, no digit first";
            return Err(self.unexpected(format!("{what}: {of}")));
        }
        if reserved.iter().any(|r| r.eq_ignore_ascii_case(token.text)) {
            let found = format!("found {}, a word of the language", quoted(token.text));
            return Err(self.source.error(token.place, found, what));
        }
        if token.text.chars().count() > limits::NAME {
            let found = format!("the name {} is too long", quoted(token.text));
            let allowed = format!("at most {} characters", limits::NAME);
            return Err(self.source.error(token.place, found, allowed));
        }
        Ok(self.take())
    }

    /// Whether a number comes next.
    pub fn at_number(&self) -> bool {
        number(self.peek()).is_some()
    }

    /// A number; infinities and NaN are some.
    pub fn number(&mut self, what: &str) -> Result<Parameter, ReadError> {
        let token = self.peek();
        match number(token) {
            Some(value) => {
                self.at += 1;
                let place = token.place;
                Ok(Parameter { value, place })
            }
            None => Err(self.unexpected(what)),
        }
    }

    /// A number that is one.
    pub fn finite(&mut self, what: &str) -> Result<Parameter, ReadError> {
        let token = self.peek();
        let parameter = self.number(what)?;
        if parameter.value.is_finite() {
            return Ok(parameter);
        }
        let found = format!("{} is not finite", quoted(token.text));
        Err(self.source.error(token.place, found, what))
    }

    /// That nothing more follows.
    pub fn end(&self, allowed: &str) -> Result<(), ReadError> {
        match self.peek().kind {
            Kind::End => Ok(()),
            _ => Err(self.unexpected(allowed)),
        }
    }
}

/// A number and where it stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// It.
    pub value: f64,
    /// Where.
    pub place: crate::fuzzy::model::Place,
}

fn number(token: Token<'_>) -> Option<f64> {
    match token.kind {
        Kind::Number(value) => Some(value),
        // `inf` and `nan` look like names.
        Kind::Word
            if ["inf", "infinity", "nan"]
                .iter()
                .any(|w| w.eq_ignore_ascii_case(token.text)) =>
        {
            token.text.parse().ok()
        }
        _ => None,
    }
}

/// What opens a comment or a text, and what would close it.
fn closing(text: &str) -> (&'static str, &'static str) {
    match text.as_bytes() {
        [b'(', ..] => ("(*", "*)"),
        [b'/', ..] => ("/*", "*/"),
        [b'"', ..] => ("\"", "\""),
        _ => ("'", "'"),
    }
}
