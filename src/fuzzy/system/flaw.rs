//! What can be wrong with a system.

use core::fmt;

/// Why a system cannot be made. Places are counted from 0: rules through all blocks, terms within their variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flaw {
    /// Not one to four inputs.
    Inputs {
        /// How many.
        count: usize,
    },
    /// Not 1 to 255 outputs.
    Outputs {
        /// How many.
        count: usize,
    },
    /// Not 1 to 4096 rules.
    Rules {
        /// How many.
        count: usize,
    },
    /// An input without a term, or with more than 255.
    InputTerms {
        /// The input.
        input: usize,
        /// How many.
        count: usize,
    },
    /// An input's range that does not ascend, or goes beyond [`LIMIT`](super::LIMIT).
    InputRange {
        /// The input.
        input: usize,
    },
    /// A term without a piece, or whose pieces do not ascend, or do not meet.
    Pieces {
        /// The input.
        input: usize,
        /// Its term.
        term: usize,
        /// The first piece that is wrong.
        piece: usize,
    },
    /// A gap in an input that claims to be complete: no term has a degree above zero there.
    Gap {
        /// The input.
        input: usize,
        /// A value in the gap.
        at: i32,
    },
    /// A rule that has no literal, in all or in one of its conjunctions.
    NoAntecedent {
        /// The rule.
        rule: usize,
    },
    /// A rule about an input that there is not.
    UnknownInput {
        /// The rule.
        rule: usize,
        /// The input.
        input: usize,
    },
    /// A rule about a term that its input does not have.
    UnknownTerm {
        /// The rule.
        rule: usize,
        /// The input.
        input: usize,
        /// The term.
        term: usize,
    },
    /// A rule that concludes nothing.
    NoConclusion {
        /// The rule.
        rule: usize,
    },
    /// A rule that concludes something of an output that there is not.
    UnknownOutput {
        /// The rule.
        rule: usize,
        /// The output.
        output: usize,
    },
    /// A rule that concludes a term that its output does not have.
    UnknownConclusion {
        /// The rule.
        rule: usize,
        /// The output.
        output: usize,
        /// The term.
        term: usize,
    },
    /// A rule that concludes two terms of one output.
    TwoConclusions {
        /// The rule.
        rule: usize,
        /// The output.
        output: usize,
    },
    /// An output without a term, or with more than 255.
    OutputTerms {
        /// The output.
        output: usize,
        /// How many.
        count: usize,
    },
    /// An output's range that does not ascend, or goes beyond [`LIMIT`](super::LIMIT).
    OutputRange {
        /// The output.
        output: usize,
    },
    /// A default outside the range.
    Default {
        /// The output.
        output: usize,
    },
    /// A conclusion outside the range of an output that is not limited to it.
    OutOfRange {
        /// The output.
        output: usize,
        /// Its term.
        term: usize,
    },
    /// A linear term without a coefficient for every input, or with one above 2³⁰, or with a shift above 60.
    Coefficients {
        /// The output.
        output: usize,
        /// Its term.
        term: usize,
    },
    /// A set without a degree for every sample.
    SetLength {
        /// The output.
        output: usize,
        /// Its term.
        term: usize,
    },
    /// A set that rules conclude and that is zero at every sample: they would say nothing.
    EmptySet {
        /// The output.
        output: usize,
        /// Its term.
        term: usize,
    },
    /// Samples beyond the range of an output that is not limited to it.
    SampleRange {
        /// The output.
        output: usize,
    },
    /// A combination of terms without a rule, for an output that claims to be complete.
    Hole {
        /// The output.
        output: usize,
        /// A term of each input.
        terms: [u8; 4],
        /// How many inputs there are.
        inputs: usize,
    },
    /// Weighted sums that could be too large: a weighted average of 2^62 or more (rules · the largest conclusion in steps · 2^24),
    /// a centroid to which more than 2047 rules could add fully at one sample.
    Accumulator {
        /// The output.
        output: usize,
    },
    /// A [`Controller`](super::Controller) of other sizes than its system's.
    Sizes,
}

impl Flaw {
    /// What is wrong, in a sentence.
    pub const fn text(self) -> Text {
        let text = Text::new();
        match self {
            Self::Inputs { count } => text
                .and("a system has one to four inputs: this one has ")
                .number(count as i64),
            Self::Outputs { count } => text
                .and("a system has 1 to 255 outputs: this one has ")
                .number(count as i64),
            Self::Rules { count } => text
                .and("a system has 1 to 4096 rules: this one has ")
                .number(count as i64),
            Self::InputTerms { input, count } => text
                .named("input", input)
                .and(" has ")
                .number(count as i64)
                .and(" terms: 1 to 255 are possible"),
            Self::InputRange { input } => text
                .named("input", input)
                .and(": its range does not ascend within ±(2^30 - 2)"),
            Self::Pieces { input, term, piece } => text
                .named("input", input)
                .named(", term", term)
                .named(": its pieces must ascend and meet, unlike piece", piece),
            Self::Gap { input, at } => text
                .named("input", input)
                .and(" has a gap: no term holds at ")
                .number(at as i64),
            Self::NoAntecedent { rule } => text
                .named("rule", rule)
                .and(" has an antecedent without a literal"),
            Self::UnknownInput { rule, input } => text
                .named("rule", rule)
                .named(" asks for input", input)
                .and(": there is none"),
            Self::UnknownTerm { rule, input, term } => text
                .named("rule", rule)
                .named(" asks for term", term)
                .named(" of input", input)
                .and(": it has none such"),
            Self::NoConclusion { rule } => text.named("rule", rule).and(" concludes nothing"),
            Self::UnknownOutput { rule, output } => text
                .named("rule", rule)
                .named(" concludes a term of output", output)
                .and(": there is none"),
            Self::UnknownConclusion { rule, output, term } => text
                .named("rule", rule)
                .named(" concludes term", term)
                .named(" of output", output)
                .and(": it has none such"),
            Self::TwoConclusions { rule, output } => text
                .named("rule", rule)
                .named(" concludes two terms of output", output),
            Self::OutputTerms { output, count } => text
                .named("output", output)
                .and(" has ")
                .number(count as i64)
                .and(" terms: 1 to 255 are possible"),
            Self::OutputRange { output } => text
                .named("output", output)
                .and(": its range does not ascend within ±(2^30 - 2)"),
            Self::Default { output } => text
                .named("output", output)
                .and(": its default lies outside its range"),
            Self::OutOfRange { output, term } => text
                .named("output", output)
                .named(", term", term)
                .and(": it can lie outside the output's range, and the output is not limited"),
            Self::Coefficients { output, term } => text
                .named("output", output)
                .named(", term", term)
                .and(": it needs a coefficient for each input, ±2^30 at most, and a shift of 0 to 60"),
            Self::SetLength { output, term } => text
                .named("output", output)
                .named(", term", term)
                .and(": a set needs a degree for each of the output's samples"),
            Self::EmptySet { output, term } => text
                .named("output", output)
                .named(", term", term)
                .and(": rules conclude this set, and it is zero at every sample"),
            Self::SampleRange { output } => text
                .named("output", output)
                .and(": its samples go beyond its range, and it is not limited"),
            Self::Hole {
                output,
                terms,
                inputs,
            } => {
                let mut text = text
                    .named("output", output)
                    .and(" has a hole: no rule for terms");
                let mut i = 0;
                while i < inputs && i < terms.len() {
                    text = text
                        .and(if i == 0 { " " } else { ", " })
                        .number(terms[i] as i64);
                    i += 1;
                }
                text.and(" of the inputs")
            }
            Self::Accumulator { output } => text.named("output", output).and(
                ": its weighted sums could overflow; take fewer rules or a coarser number format",
            ),
            Self::Sizes => text.and("a controller's sizes are its system's: inputs, terms of the inputs, rules, outputs"),
        }
    }
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text().as_str())
    }
}

impl core::error::Error for Flaw {}

/// A message that is put together while the program compiles.
#[derive(Clone, Copy, Debug)]
pub struct Text {
    bytes: [u8; Self::ROOM],
    length: usize,
}

impl Text {
    const ROOM: usize = 160;

    const fn new() -> Self {
        Self {
            bytes: [0; Self::ROOM],
            length: 0,
        }
    }

    /// The message.
    pub const fn as_str(&self) -> &str {
        let (used, _) = match self.bytes.split_at_checked(self.length) {
            Some(parts) => parts,
            None => (&[] as &[u8], &[] as &[u8]),
        };
        match core::str::from_utf8(used) {
            Ok(text) => text,
            Err(_) => "",
        }
    }

    /// With more behind it; what has no room is left out, whole.
    const fn and(mut self, more: &str) -> Self {
        let more = more.as_bytes();
        if more.len() > Self::ROOM.saturating_sub(self.length) {
            return self;
        }
        let mut i = 0;
        while i < more.len() && self.length < Self::ROOM {
            self.bytes[self.length] = more[i];
            self.length = self.length.saturating_add(1);
            i = usize::saturating_add(i, 1);
        }
        self
    }

    /// A thing and its place.
    const fn named(self, thing: &str, place: usize) -> Self {
        self.and(thing).and(" ").number(place as i64)
    }

    const fn number(self, number: i64) -> Self {
        let text = if number < 0 { self.and("-") } else { self };
        text.digits(number.unsigned_abs())
    }

    const fn digits(self, number: u64) -> Self {
        let mut power = 1u64;
        while number / power >= 10 {
            power = power.saturating_mul(10);
        }
        let mut text = self;
        while power > 0 {
            let digit = [b'0' + ((number / power) % 10) as u8];
            if let Ok(digit) = core::str::from_utf8(&digit) {
                text = text.and(digit);
            }
            power /= 10;
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::{Flaw, Text};

    #[test]
    fn numbers_are_written_in_full() {
        for (number, text) in [
            (0, "0"),
            (7, "7"),
            (10, "10"),
            (-1, "-1"),
            (99, "99"),
            (100, "100"),
            (-1_073_741_822, "-1073741822"),
            (i64::MAX, "9223372036854775807"),
            (i64::MIN, "-9223372036854775808"),
        ] {
            assert_eq!(Text::new().number(number).as_str(), text);
        }
    }

    #[test]
    fn the_longest_message_fits() {
        // The largest places that there are.
        let (output, term) = (254, 254);
        let hole = Flaw::Hole {
            output,
            terms: [254; 4],
            inputs: 4,
        };
        let pieces = Flaw::Pieces {
            input: 3,
            term,
            piece: 1_000_000,
        };
        for (flaw, end) in [
            (hole, "254, 254, 254, 254 of the inputs"),
            (pieces, "unlike piece 1000000"),
            (Flaw::Coefficients { output, term }, "a shift of 0 to 60"),
            (Flaw::OutOfRange { output, term }, "is not limited"),
            (Flaw::Accumulator { output }, "number format"),
        ] {
            let text = flaw.text();
            assert!(text.as_str().ends_with(end), "{}", text.as_str());
        }
    }
}
