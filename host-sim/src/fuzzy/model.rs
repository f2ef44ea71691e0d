//! A fuzzy system as its designer wrote it, in `f64`: what every reader produces and every writer, check and evaluation
//! starts from. It holds only what this project supports; a reader names and refuses everything else.

use std::ops::RangeInclusive;

/// Where in a design file something was said; lines and columns from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Line.
    pub line: usize,
    /// Column, in characters.
    pub column: usize,
}

/// A complete system.
#[derive(Clone, Debug, PartialEq)]
pub struct System {
    /// Its name; may be empty.
    pub name: String,
    /// What its designer says of it, one line; may be empty. No computation depends on a description.
    pub description: String,
    /// One to four.
    pub inputs: Vec<Input>,
    /// One or more.
    pub outputs: Vec<Output>,
    /// Groups of rules that share their operators; one or more.
    pub blocks: Vec<RuleBlock>,
}

impl System {
    /// The same with no description anywhere: to compare what several files compute, for only FLL has them.
    pub fn without_descriptions(mut self) -> Self {
        self.description.clear();
        self.inputs.iter_mut().for_each(|i| i.description.clear());
        self.outputs.iter_mut().for_each(|o| o.description.clear());
        self.blocks.iter_mut().for_each(|b| b.description.clear());
        self
    }

    /// The same with no place anywhere: to compare what several files say.
    pub fn without_places(mut self) -> Self {
        let nowhere = Place::default();
        for input in &mut self.inputs {
            input.place = nowhere;
            input.terms.iter_mut().for_each(|t| t.place = nowhere);
        }
        for output in &mut self.outputs {
            output.place = nowhere;
            output.terms.iter_mut().for_each(|t| t.place = nowhere);
        }
        for block in &mut self.blocks {
            block.rules.iter_mut().for_each(|r| r.place = nowhere);
        }
        self
    }
}

/// An input variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Input {
    /// Its name, unique among all variables.
    pub name: String,
    /// See [`System::description`].
    pub description: String,
    /// The range that it is designed for: finite, the end above the start. What lies outside counts as the nearer end if
    /// `clamp`, else as it is.
    pub range: RangeInclusive<f64>,
    /// Whether values are limited to the range before they are fuzzified.
    pub clamp: bool,
    /// One or more, their names unique here.
    pub terms: Vec<Term>,
    /// Where it was declared.
    pub place: Place,
}

/// A term of an input.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Its name.
    pub name: String,
    /// Its membership function.
    pub shape: Shape,
    /// Where it was declared.
    pub place: Place,
}

/// A membership function; all have the height one.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// Zero up to `left`, one at `peak`, zero from `right`; `left ≤ peak ≤ right`, `left < right`.
    Triangle {
        /// Left foot.
        left: f64,
        /// Peak.
        peak: f64,
        /// Right foot.
        right: f64,
    },
    /// Zero up to `left`, one between the shoulders, zero from `right`; all ascending, `left < right`. A foot or a shoulder
    /// at infinity makes the term open to that side.
    Trapezoid {
        /// Left foot.
        left: f64,
        /// Left shoulder.
        rise: f64,
        /// Right shoulder.
        fall: f64,
        /// Right foot.
        right: f64,
    },
    /// A shoulder: zero at `from` and before it, one at `to` and behind it; descending when `to < from`.
    Ramp {
        /// Where it is zero.
        from: f64,
        /// Where it is one.
        to: f64,
    },
    /// One at this value, zero elsewhere.
    Singleton(f64),
    /// Straight between points `(x, degree)`, x ascending (equal ones are a step), flat before the first and behind the last;
    /// degrees from 0 to 1, two points or more.
    Points(Vec<(f64, f64)>),
    /// exp(−(x − mean)² / 2σ²).
    Gaussian {
        /// Where it is one.
        mean: f64,
        /// σ, above zero.
        deviation: f64,
    },
    /// Two Gaussian flanks, one between the means: `left.mean ≤ right.mean`.
    TwoSidedGaussian {
        /// Left flank: (mean, σ).
        left: (f64, f64),
        /// Right flank: (mean, σ).
        right: (f64, f64),
    },
    /// 1 / (1 + |(x − centre) / width|^(2 · slope)).
    Bell {
        /// Where it is one.
        centre: f64,
        /// Half its width at ½, above zero.
        width: f64,
        /// Above zero.
        slope: f64,
    },
    /// 1 / (1 + exp(−slope · (x − inflection))).
    Sigmoid {
        /// Where it is ½.
        inflection: f64,
        /// Not zero; ascending if positive.
        slope: f64,
    },
    /// A quadratic S from 0 at `from` to 1 at `to`; a Z when `to < from`.
    Spline {
        /// Where it is zero.
        from: f64,
        /// Where it is one.
        to: f64,
    },
}

/// An output variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Its name, unique among all variables.
    pub name: String,
    /// See [`System::description`].
    pub description: String,
    /// Its range: finite, the end above the start.
    pub range: RangeInclusive<f64>,
    /// Whether its value is limited to the range.
    pub clamp: bool,
    /// Its value when no rule fires; `None`: the file gives none (then `f64` says "no value", and fixed point the middle of the
    /// range).
    pub default: Option<f64>,
    /// How conclusions become a number.
    pub defuzzifier: Defuzzifier,
    /// What becomes of several rules that conclude the same: the same term, or at one place of overlapping sets.
    pub merge: Merge,
    /// One or more, their names unique here.
    pub terms: Vec<OutputTerm>,
    /// Where it was declared.
    pub place: Place,
}

/// A term of an output.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputTerm {
    /// Its name.
    pub name: String,
    /// What it concludes.
    pub conclusion: Conclusion,
    /// Where it was declared.
    pub place: Place,
}

/// What a rule concludes.
#[derive(Clone, Debug, PartialEq)]
pub enum Conclusion {
    /// A number: a singleton, or a Takagi–Sugeno term of order 0.
    Constant(f64),
    /// Takagi–Sugeno, order 1: a coefficient an input, and the constant.
    Linear {
        /// In the inputs' order.
        coefficients: Vec<f64>,
        /// Added.
        constant: f64,
    },
    /// A fuzzy set (Mamdani).
    Set(Shape),
}

/// How conclusions become a number. [`Conclusion::Set`]s need a centroid, the others a weighted average.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defuzzifier {
    /// The height method, Takagi–Sugeno: Σ w·z / Σ w.
    WeightedAverage,
    /// Centroid of the merged sets over `points` samples of the range. With [`Merge::Sum`] this is the centre of sums.
    Centroid {
        /// Number of samples, two or more.
        points: usize,
        /// Where in the range they lie.
        sampling: Sampling,
    },
}

/// Where a centroid's samples lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampling {
    /// In the middles of `points` equal pieces (fuzzylite).
    Middles,
    /// Evenly from end to end, both included (MATLAB).
    Ends,
}

/// How several conclusions are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Merge {
    /// Added.
    Sum,
    /// The largest counts.
    Max,
}

/// Rules that share their operators.
#[derive(Clone, Debug, PartialEq)]
pub struct RuleBlock {
    /// Its name; may be empty.
    pub name: String,
    /// See [`System::description`].
    pub description: String,
    /// AND.
    pub and: Conjunction,
    /// What a rule's degree does to a [`Conclusion::Set`].
    pub implication: Conjunction,
    /// In the file's order. OR is always max.
    pub rules: Vec<Rule>,
}

/// A conjunction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conjunction {
    /// The smaller degree; as an implication: the set is cut off.
    Min,
    /// The product; as an implication: the set is scaled.
    Product,
}

/// A rule.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// When it fires.
    pub antecedent: Antecedent,
    /// What it concludes: indices of an output and of a term of it; one or more, each output once.
    pub conclusions: Vec<(usize, usize)>,
    /// 0 to 1, multiplies the degree.
    pub weight: f64,
    /// Where it was written.
    pub place: Place,
}

/// When a rule fires.
#[derive(Clone, Debug, PartialEq)]
pub enum Antecedent {
    /// An input is, or is not, a term.
    Is {
        /// Index of the input.
        input: usize,
        /// Index of its term.
        term: usize,
        /// "is not": one minus the degree.
        negated: bool,
    },
    /// All of these, two or more.
    And(Vec<Antecedent>),
    /// Any of these, two or more: the largest degree.
    Or(Vec<Antecedent>),
}
