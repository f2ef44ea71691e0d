//! IEC 61131-7's fuzzy control language, `.fcl`, as jFuzzyLogic and FuzzyLite speak it: beside the norm's points and
//! singletons jFuzzyLogic's shapes (`TRIAN`, `GAUSS`…), and FuzzyLite's names for them, ranges of inputs, `LOCK : RANGE`
//! and rules without a semicolon.
//!
//! What the language leaves unsaid:
//!
//! * A variable without a `RANGE` spans its terms; curves have no end, so they need one.
//! * `METHOD : COG` is a centroid over 1000 samples in the middles of equal pieces; a comment on the same line says
//!   otherwise: `// samples: 101 ends`, or `middles`. Other tools pass over it.
//! * AND binds tighter than OR, as the norm has it. jFuzzyLogic takes them as they come: the writer puts parentheses.
//! * OR is what AND pairs with: without an `OR`, MAX if AND is MIN. With `AND : PROD` it must be said.
//! * Without an `ACT`, MIN. Without an `ACCU`, MAX for `COG`; for `COGS` tools disagree, so it must be said where a term
//!   is concluded twice.

mod assemble;
mod blocks;
mod write;

use super::conditions::{Grammar, WrittenRule};
use super::cursor::Cursor;
use super::error::{ReadError, Source};
use super::lexer::{Dialect, Note, Token, lex};
use super::norms::Norm;
use super::shapes::Family;
use crate::fuzzy::model::{Conclusion, Conjunction, Defuzzifier, Merge, Place, System};
use std::ops::RangeInclusive;
pub use write::write;

const DIALECT: Dialect = Dialect {
    signs: &[":=", "..", "(", ")", ",", ":", ";"],
    line_comments: &["//"],
    block_comments: &[("(*", "*)"), ("/*", "*/")],
    quotes: &[],
};

const GRAMMAR: Grammar = Grammar {
    reserved: RESERVED,
    hedges: &[],
    leading_not: true,
    comma: true,
};

/// Words that no name may be.
const RESERVED: &[&str] = &[
    "if",
    "is",
    "and",
    "or",
    "then",
    "with",
    "not",
    "end_function_block",
    "end_fuzzify",
    "end_defuzzify",
    "end_ruleblock",
    "end_var",
    "rule",
    "term",
];

/// jFuzzyLogic's other words, which it takes for no name. Only the writer minds.
const WORDS: &[&str] = &[
    "abs",
    "accu",
    "act",
    "asum",
    "bdif",
    "bsum",
    "coa",
    "cog",
    "cogf",
    "cogs",
    "cos",
    "cosine",
    "default",
    "defuzzify",
    "dmax",
    "dmin",
    "dsigm",
    "einstein",
    "exp",
    "function",
    "function_block",
    "fuzzify",
    "gauss",
    "gauss2",
    "gbell",
    "hamacher",
    "lm",
    "ln",
    "lock",
    "log",
    "max",
    "method",
    "min",
    "mm",
    "nc",
    "nipmax",
    "nipmin",
    "nsum",
    "probor",
    "prod",
    "range",
    "real",
    "rm",
    "ruleblock",
    "sigm",
    "sin",
    "singletons",
    "sum",
    "tan",
    "trape",
    "trian",
    "var_input",
    "var_output",
];

/// What no name may be in a file that is written.
pub const RESERVED_NAMES: &[&[&str]] = &[RESERVED, WORDS];

/// Samples of a centroid of which nothing else is said.
pub const DEFAULT_SAMPLES: usize = 1000;
/// Begins the comment that says it.
const SAMPLES_NOTE: &str = "samples:";

/// Shapes, and where each of a [`Family`]'s numbers stands among theirs.
const SHAPES: &[(&str, Family, &[usize])] = &[
    ("TRIAN", Family::Triangle, &[]),
    ("TRAPE", Family::Trapezoid, &[]),
    ("GAUSS", Family::Gaussian, &[]),
    ("GAUSS2", Family::TwoSidedGaussian, &[]),
    ("GBELL", Family::Bell, &[2, 0, 1]),
    ("SIGM", Family::Sigmoid, &[1, 0]),
    // FuzzyLite's.
    ("Bell", Family::Bell, &[]),
    ("Gaussian", Family::Gaussian, &[]),
    ("GaussianProduct", Family::TwoSidedGaussian, &[]),
    ("Ramp", Family::Ramp, &[]),
    ("Rectangle", Family::Rectangle, &[]),
    ("SShape", Family::S, &[]),
    ("Sigmoid", Family::Sigmoid, &[]),
    ("Trapezoid", Family::Trapezoid, &[]),
    ("Triangle", Family::Triangle, &[]),
    ("ZShape", Family::Z, &[]),
];

/// Shapes that tools have and this project does not.
const OTHER_SHAPES: &[&str] = &[
    "COSINE",
    "DSIGM",
    "FUNCTION",
    "SINGLETONS",
    "Linear",
    "Concave",
    "PiShape",
    "SigmoidDifference",
    "SigmoidProduct",
    "Spike",
];

/// Reads a system.
pub fn read(source: Source<'_>) -> Result<System, ReadError> {
    let (tokens, notes) = lex(source.text, Place { line: 1, column: 1 }, &DIALECT);
    let cursor = Cursor::new(source, &tokens, "the file");
    let mut reader = Reader {
        source,
        cursor,
        notes: &notes,
        name: String::new(),
        declared: Vec::new(),
        fuzzified: Vec::new(),
        defuzzified: Vec::new(),
        blocks: Vec::new(),
    };
    reader.function_block()?;
    let end = reader.cursor.peek().place;
    reader.system(end)
}

/// A range that may be given.
type Range = Option<RangeInclusive<f64>>;

struct Declared<'s> {
    name: Token<'s>,
    output: bool,
    range: Range,
}

struct Fuzzified<'s> {
    name: Token<'s>,
    range: Range,
    clamp: bool,
    terms: Vec<(Token<'s>, Conclusion)>,
}

struct Defuzzified<'s> {
    variable: Fuzzified<'s>,
    method: Option<Defuzzifier>,
    merge: Option<Merge>,
    default: Option<f64>,
}

struct WrittenBlock<'s> {
    name: &'s str,
    enabled: bool,
    and: Norm<'s, Conjunction>,
    or: Norm<'s, ()>,
    implication: Conjunction,
    merge: Option<(Merge, Place)>,
    rules: Vec<WrittenRule<'s>>,
}

struct Reader<'s, 't> {
    source: Source<'s>,
    cursor: Cursor<'s, 't>,
    notes: &'t [Note<'s>],
    name: String,
    declared: Vec<Declared<'s>>,
    fuzzified: Vec<Fuzzified<'s>>,
    defuzzified: Vec<Defuzzified<'s>>,
    blocks: Vec<WrittenBlock<'s>>,
}
