//! Words, numbers and signs of a design file, each with its place. The three formats differ in their signs, comments and
//! quotes only.

use super::error::advance;
use crate::fuzzy::model::Place;
use winnow::combinator::{alt, delimited, fail};
use winnow::error::EmptyError;
use winnow::prelude::*;
use winnow::token::{literal, take_till, take_until, take_while};

/// What a format's text is made of.
#[derive(Debug)]
pub struct Dialect {
    /// Signs, longer ones before their beginnings.
    pub signs: &'static [&'static str],
    /// Opens a comment that reaches to the end of the line.
    pub line_comments: &'static [&'static str],
    /// Open and close a comment.
    pub block_comments: &'static [(&'static str, &'static str)],
    /// What stands on both sides of a text.
    pub quotes: &'static [char],
}

/// A piece of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Token<'s> {
    /// What it is.
    pub kind: Kind,
    /// As it stands there; of a quoted text, what it holds.
    pub text: &'s str,
    /// Where it begins.
    pub place: Place,
}

/// What a [`Token`] is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Letters, digits and underscores, no digit first.
    Word,
    /// A number, perhaps infinite or none at all.
    Number(f64),
    /// A text between quotes.
    Text,
    /// One of the dialect's signs.
    Sign,
    /// Anything else.
    Junk,
    /// What opens a comment or a text that never ends.
    Open,
    /// Nothing more follows.
    End,
}

/// The text of a line comment and where it begins.
pub type Note<'s> = (&'s str, Place);

enum Piece<'s> {
    Token(Kind, &'s str),
    Note(&'s str),
    Nothing,
}

/// Cuts a text that begins at `origin` into tokens, the last one [`Kind::End`]. Line comments are given apart.
pub fn lex<'s>(text: &'s str, origin: Place, dialect: &Dialect) -> (Vec<Token<'s>>, Vec<Note<'s>>) {
    let (mut tokens, mut notes) = (Vec::new(), Vec::new());
    let mut place = origin;
    let mut input = text;
    loop {
        let before = input;
        let piece = alt((
            blanks,
            comment(dialect),
            quoted(dialect),
            sign(dialect),
            run(dialect),
        ))
        .parse_next(&mut input);
        match piece {
            Ok(Piece::Token(kind, text)) => tokens.push(Token { kind, text, place }),
            Ok(Piece::Note(text)) => notes.push((text, place)),
            Ok(Piece::Nothing) => {}
            Err(EmptyError) => break,
        }
        advance(&mut place, &before[..before.len() - input.len()]);
    }
    tokens.push(Token {
        kind: Kind::End,
        text: "",
        place,
    });
    (tokens, notes)
}

fn blanks<'s>(input: &mut &'s str) -> Result<Piece<'s>, EmptyError> {
    take_while(1.., char::is_whitespace)
        .value(())
        .map(|()| Piece::Nothing)
        .parse_next(input)
}

fn comment<'s>(dialect: &Dialect) -> impl Parser<&'s str, Piece<'s>, EmptyError> {
    move |input: &mut &'s str| {
        for &opening in dialect.line_comments {
            if input.starts_with(opening) {
                return take_till(0.., ['\n', '\r'])
                    .map(Piece::Note)
                    .parse_next(input);
            }
        }
        for &(opening, closing) in dialect.block_comments {
            if input.starts_with(opening) {
                return alt((
                    delimited(literal(opening), take_until(0.., closing), literal(closing))
                        .map(|_| Piece::Nothing),
                    unclosed,
                ))
                .parse_next(input);
            }
        }
        fail.parse_next(input)
    }
}

fn quoted<'s>(dialect: &Dialect) -> impl Parser<&'s str, Piece<'s>, EmptyError> {
    move |input: &mut &'s str| {
        let Some(&quote) = dialect
            .quotes
            .iter()
            .find(|&&quote| input.starts_with(quote))
        else {
            return fail.parse_next(input);
        };
        alt((
            delimited(quote, take_till(0.., [quote, '\n', '\r']), quote)
                .map(|text| Piece::Token(Kind::Text, text)),
            unclosed,
        ))
        .parse_next(input)
    }
}

/// All the rest, which belongs to what was never closed.
fn unclosed<'s>(input: &mut &'s str) -> Result<Piece<'s>, EmptyError> {
    let text = std::mem::take(input);
    Ok(Piece::Token(Kind::Open, text))
}

fn sign<'s>(dialect: &Dialect) -> impl Parser<&'s str, Piece<'s>, EmptyError> {
    move |input: &mut &'s str| match dialect.signs.iter().find(|&&s| input.starts_with(s)) {
        Some(&sign) => literal(sign)
            .map(|text| Piece::Token(Kind::Sign, text))
            .parse_next(input),
        None => fail.parse_next(input),
    }
}

/// What stands together up to a blank, a sign, a quote or a comment.
fn run<'s>(dialect: &Dialect) -> impl Parser<&'s str, Piece<'s>, EmptyError> {
    move |input: &mut &'s str| {
        let end = input
            .char_indices()
            .skip(1)
            .find(|&(at, c)| dialect.breaks(c, &input[at..]))
            .map_or(input.len(), |(at, _)| at);
        if end == 0 {
            return fail.parse_next(input);
        }
        let (text, tail) = input.split_at(end);
        *input = tail;
        Ok(Piece::Token(kind(text), text))
    }
}

impl Dialect {
    fn breaks(&self, c: char, rest: &str) -> bool {
        c.is_whitespace()
            || self.quotes.contains(&c)
            || self.signs.iter().any(|s| rest.starts_with(s))
            || self.line_comments.iter().any(|s| rest.starts_with(s))
            || self.block_comments.iter().any(|(s, _)| rest.starts_with(s))
    }
}

fn kind(text: &str) -> Kind {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let begins = text.chars().next().unwrap_or_default();
    if text.chars().all(word) && !begins.is_numeric() {
        return Kind::Word;
    }
    // Rust's own syntax of numbers, but no words in it other than an infinity or NaN with a sign before it.
    match text.parse() {
        Ok(number) => Kind::Number(number),
        Err(_) => Kind::Junk,
    }
}
