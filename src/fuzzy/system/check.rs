//! Proofs about a system, in `const` or at run time: every check is total.

use super::piece::membership;
use super::{
    Block, Defuzzifier, Flaw, Input, LIMIT, Linear, Literal, MAX_INPUTS, Merge, Number, Output,
    Rule, Samples, Set, Term,
};

const MAX_TERMS: usize = 255;
const MAX_OUTPUTS: usize = 255;
const MAX_RULES: usize = 4096;

/// Everything but what [`System::checked`](super::System::checked) stores.
pub(super) const fn check(
    inputs: &[Input<'_>],
    blocks: &[Block<'_>],
    outputs: &[Output<'_>],
) -> Result<(), Flaw> {
    let mut result = counts(inputs, blocks, outputs);
    let mut i = 0;
    while i < inputs.len() && result.is_ok() {
        result = input(inputs, i);
        i += 1;
    }
    let mut number = 0;
    let mut b = 0;
    while b < blocks.len() {
        let mut r = 0;
        while r < blocks[b].rules.len() && result.is_ok() {
            result = rule(number, &blocks[b].rules[r], inputs, outputs);
            number += 1;
            r += 1;
        }
        b += 1;
    }
    let mut o = 0;
    while o < outputs.len() && result.is_ok() {
        result = output(inputs, blocks, outputs, o);
        o += 1;
    }
    result
}

const fn counts(
    inputs: &[Input<'_>],
    blocks: &[Block<'_>],
    outputs: &[Output<'_>],
) -> Result<(), Flaw> {
    let rules = rule_count(blocks);
    if inputs.is_empty() || inputs.len() > MAX_INPUTS {
        Err(Flaw::Inputs {
            count: inputs.len(),
        })
    } else if outputs.is_empty() || outputs.len() > MAX_OUTPUTS {
        Err(Flaw::Outputs {
            count: outputs.len(),
        })
    } else if rules == 0 || rules > MAX_RULES {
        Err(Flaw::Rules { count: rules })
    } else {
        Ok(())
    }
}

pub(super) const fn rule_count(blocks: &[Block<'_>]) -> usize {
    let mut count = 0usize;
    let mut b = 0;
    while b < blocks.len() {
        count = count.saturating_add(blocks[b].rules.len());
        b += 1;
    }
    count
}

/// A range that ascends within the limits.
const fn is_range([low, high]: [i32; 2]) -> bool {
    low < high && low >= -LIMIT && high <= LIMIT
}

const fn input(inputs: &[Input<'_>], i: usize) -> Result<(), Flaw> {
    let this = &inputs[i];
    if !is_range(this.range) {
        return Err(Flaw::InputRange { input: i });
    }
    let count = this.terms.len();
    if count == 0 || count > MAX_TERMS {
        return Err(Flaw::InputTerms { input: i, count });
    }
    let mut t = 0;
    while t < count {
        if let Some(piece) = broken(this.terms[t]) {
            return Err(Flaw::Pieces {
                input: i,
                term: t,
                piece,
            });
        }
        t += 1;
    }
    if this.complete
        && let Some(at) = gap(this)
    {
        return Err(Flaw::Gap { input: i, at });
    }
    Ok(())
}

/// The first piece of a term that does not go on where the one before it ended, or that lies too far out.
const fn broken(term: Term<'_>) -> Option<usize> {
    if term.is_empty() {
        return Some(0);
    }
    let mut p = 0;
    while p < term.len() {
        let from = term[p].from();
        if from < -LIMIT - 1 || from > LIMIT + 1 {
            return Some(p);
        }
        if p + 1 < term.len() {
            let next = &term[p + 1];
            if next.from() < from {
                return Some(p + 1);
            }
            // Pieces without a width may step.
            let met = term[p].end(next.from());
            if next.from() > from && met.abs_diff(next.start().bits()) > 1 {
                return Some(p + 1);
            }
        } else if term[p].slope().0 != 0 {
            return Some(p);
        }
        p += 1;
    }
    None
}

/// A value of the range at which no term holds.
///
/// Where a term vanishes it does so from a point with degree zero on, but for rounding within a step of the degree. So gaps
/// begin or end at such points, at the range's ends, or lie between two such points.
const fn gap(input: &Input<'_>) -> Option<i32> {
    let [low, high] = input.range;
    if is_gap(input, low) {
        return Some(low);
    }
    if is_gap(input, high) {
        return Some(high);
    }
    let mut t = 0;
    while t < input.terms.len() {
        let mut p = 0;
        while p < input.terms[t].len() {
            let piece = &input.terms[t][p];
            let x = piece.from();
            if piece.start().bits() == 0 && x >= low && x <= high {
                if is_gap(input, x) {
                    return Some(x);
                }
                let middle = x + (next_foot(input, x) - x) / 2;
                if is_gap(input, middle) {
                    return Some(middle);
                }
            }
            p += 1;
        }
        t += 1;
    }
    None
}

const fn is_gap(input: &Input<'_>, x: i32) -> bool {
    let mut t = 0;
    while t < input.terms.len() {
        if membership(input.terms[t], x).bits() > 0 {
            return false;
        }
        t += 1;
    }
    true
}

/// The nearest point with degree zero right of `x`, or the range's end.
const fn next_foot(input: &Input<'_>, x: i32) -> i32 {
    let mut nearest = input.range[1];
    let mut t = 0;
    while t < input.terms.len() {
        let mut p = 0;
        while p < input.terms[t].len() {
            let piece = &input.terms[t][p];
            if piece.start().bits() == 0 && piece.from() > x && piece.from() < nearest {
                nearest = piece.from();
            }
            p += 1;
        }
        t += 1;
    }
    nearest
}

const fn rule(
    number: usize,
    rule: &Rule<'_>,
    inputs: &[Input<'_>],
    outputs: &[Output<'_>],
) -> Result<(), Flaw> {
    if rule.when.is_empty() {
        return Err(Flaw::NoAntecedent { rule: number });
    }
    let mut c = 0;
    while c < rule.when.len() {
        let conjunction = rule.when[c];
        if conjunction.is_empty() {
            return Err(Flaw::NoAntecedent { rule: number });
        }
        let mut l = 0;
        while l < conjunction.len() {
            let (Literal::Is(input, term) | Literal::IsNot(input, term)) = conjunction[l];
            let (input, term) = (input as usize, term as usize);
            if input >= inputs.len() {
                return Err(Flaw::UnknownInput {
                    rule: number,
                    input,
                });
            }
            if term >= inputs[input].terms.len() {
                return Err(Flaw::UnknownTerm {
                    rule: number,
                    input,
                    term,
                });
            }
            l += 1;
        }
        c += 1;
    }
    if rule.then.is_empty() {
        return Err(Flaw::NoConclusion { rule: number });
    }
    let mut t = 0;
    while t < rule.then.len() {
        let (output, term) = (rule.then[t].0 as usize, rule.then[t].1 as usize);
        if output >= outputs.len() {
            return Err(Flaw::UnknownOutput {
                rule: number,
                output,
            });
        }
        if term >= outputs[output].defuzzifier.term_count() {
            return Err(Flaw::UnknownConclusion {
                rule: number,
                output,
                term,
            });
        }
        let mut before = 0;
        while before < t {
            if rule.then[before].0 as usize == output {
                return Err(Flaw::TwoConclusions {
                    rule: number,
                    output,
                });
            }
            before += 1;
        }
        t += 1;
    }
    Ok(())
}

const fn output(
    inputs: &[Input<'_>],
    blocks: &[Block<'_>],
    outputs: &[Output<'_>],
    o: usize,
) -> Result<(), Flaw> {
    let this = &outputs[o];
    let [low, high] = this.range;
    if !is_range(this.range) {
        return Err(Flaw::OutputRange { output: o });
    }
    if this.default < low || this.default > high {
        return Err(Flaw::Default { output: o });
    }
    let count = this.defuzzifier.term_count();
    if count == 0 || count > MAX_TERMS {
        return Err(Flaw::OutputTerms { output: o, count });
    }
    let terms = match this.defuzzifier {
        Defuzzifier::WeightedAverage { merge, terms } => {
            numbers(inputs, blocks, this, o, merge, terms)
        }
        Defuzzifier::Centroid {
            merge,
            samples,
            terms,
        } => sets(blocks, this, o, merge, samples, terms),
    };
    if terms.is_err() || !this.complete {
        return terms;
    }
    match hole(inputs, blocks, o) {
        Some(terms) => Err(Flaw::Hole {
            output: o,
            terms,
            inputs: inputs.len(),
        }),
        None => Ok(()),
    }
}

const fn numbers(
    inputs: &[Input<'_>],
    blocks: &[Block<'_>],
    output: &Output<'_>,
    o: usize,
    merge: Merge,
    terms: &[Number<'_>],
) -> Result<(), Flaw> {
    let [low, high] = output.range;
    // Σ w · |z| in the worst case, which is that all rules fire fully.
    let mut sum = 0u128;
    let mut t = 0;
    while t < terms.len() {
        let (least, most) = match &terms[t] {
            Number::Constant(value) => (*value as i64, *value as i64),
            Number::Linear(linear) => match extremes(inputs, linear) {
                Some(extremes) => extremes,
                None => return Err(Flaw::Coefficients { output: o, term: t }),
            },
        };
        if !output.clamp && (least < low as i64 || most > high as i64) {
            return Err(Flaw::OutOfRange { output: o, term: t });
        }
        // What a linear term is limited to; a constant would have to be within.
        if let Number::Constant(value) = terms[t]
            && (value < -LIMIT || value > LIMIT)
        {
            return Err(Flaw::OutOfRange { output: o, term: t });
        }
        let magnitude = if least.unsigned_abs() > most.unsigned_abs() {
            least.unsigned_abs()
        } else {
            most.unsigned_abs()
        };
        sum += weight(blocks, o, t, merge) as u128 * magnitude as u128;
        t += 1;
    }
    // The sum takes 63 bits and its sign; half a divisor is added to it.
    if sum >= 1 << 62 {
        return Err(Flaw::Accumulator { output: o });
    }
    Ok(())
}

/// The most that rules together can weigh in for a term, in bits of a degree.
const fn weight(blocks: &[Block<'_>], output: usize, term: usize, merge: Merge) -> u64 {
    let mut weight = 0u64;
    let mut b = 0;
    while b < blocks.len() {
        let mut r = 0;
        while r < blocks[b].rules.len() {
            let rule = &blocks[b].rules[r];
            let mut t = 0;
            while t < rule.then.len() {
                if rule.then[t].0 as usize == output && rule.then[t].1 as usize == term {
                    let own = rule.weight.bits() as u64;
                    weight = match merge {
                        Merge::Sum => weight.saturating_add(own),
                        Merge::Max if own > weight => own,
                        Merge::Max => weight,
                    };
                }
                t += 1;
            }
            r += 1;
        }
        b += 1;
    }
    weight
}

/// The least and the greatest value of a linear term, as it is limited; `None` if it is none.
const fn extremes(inputs: &[Input<'_>], linear: &Linear<'_>) -> Option<(i64, i64)> {
    if linear.coefficients.len() != inputs.len()
        || linear.shift > 60
        || linear.constant < -LIMIT
        || linear.constant > LIMIT
    {
        return None;
    }
    let (mut least, mut most) = ([0; MAX_INPUTS], [0; MAX_INPUTS]);
    let mut i = 0;
    while i < inputs.len() && i < MAX_INPUTS {
        let coefficient = linear.coefficients[i];
        if coefficient.unsigned_abs() > 1 << 30 {
            return None;
        }
        let [low, high] = inputs[i].limits();
        (least[i], most[i]) = if coefficient < 0 {
            (high, low)
        } else {
            (low, high)
        };
        i += 1;
    }
    Some((linear.at(&least) as i64, linear.at(&most) as i64))
}

const fn sets(
    blocks: &[Block<'_>],
    output: &Output<'_>,
    o: usize,
    merge: Merge,
    samples: Samples,
    terms: &[Set<'_>],
) -> Result<(), Flaw> {
    let [low, high] = output.range;
    let [first, last] = samples.range();
    if !output.clamp && (first < low || last > high) {
        return Err(Flaw::SampleRange { output: o });
    }
    let mut sum = 0u64;
    let mut t = 0;
    while t < terms.len() {
        let set = terms[t];
        if set.len() != samples.count() {
            return Err(Flaw::SetLength { output: o, term: t });
        }
        let mut s = 0;
        while s < set.len() && set[s].bits() == 0 {
            s += 1;
        }
        let weight = weight(blocks, o, t, merge);
        // Where only rules fire that conclude it, nothing would be left to divide by.
        if weight > 0 && s == set.len() {
            return Err(Flaw::EmptySet { output: o, term: t });
        }
        sum = sum.saturating_add(weight);
        t += 1;
    }
    // The largest of several never has more than a degree.
    if matches!(merge, Merge::Sum) && sum >= SAMPLE_SUM && !sums_fit(blocks, o, terms) {
        return Err(Flaw::Accumulator { output: o });
    }
    Ok(())
}

/// What is added at one sample of a centroid is below this: over all samples, [`Samples::MOST`], that makes an area below the
/// 2^45 that a quotient takes.
const SAMPLE_SUM: u64 = 1 << 35;

/// Whether what rules add at any sample is below [`SAMPLE_SUM`]: no rule adds more than its weight, nor more than its set has
/// there.
const fn sums_fit(blocks: &[Block<'_>], o: usize, terms: &[Set<'_>]) -> bool {
    let (mut weights, mut rules) = ([0u64; MAX_TERMS], [0u64; MAX_TERMS]);
    let mut b = 0;
    while b < blocks.len() {
        let mut r = 0;
        while r < blocks[b].rules.len() {
            let rule = &blocks[b].rules[r];
            let mut t = 0;
            while t < rule.then.len() {
                if rule.then[t].0 as usize == o {
                    let term = rule.then[t].1 as usize;
                    weights[term] = weights[term].saturating_add(rule.weight.bits() as u64);
                    rules[term] += 1;
                }
                t += 1;
            }
            r += 1;
        }
        b += 1;
    }
    let mut s = 0;
    while s < terms[0].len() {
        let (mut sum, mut t) = (0u64, 0);
        while t < terms.len() {
            // A grade is a degree with nine bits less.
            let most = rules[t].saturating_mul((terms[t][s].bits() as u64) << 9);
            sum = sum.saturating_add(if most < weights[t] { most } else { weights[t] });
            t += 1;
        }
        if sum >= SAMPLE_SUM {
            return false;
        }
        s += 1;
    }
    true
}

/// A term of every input, for which no rule concludes anything about the output.
const fn hole(inputs: &[Input<'_>], blocks: &[Block<'_>], output: usize) -> Option<[u8; 4]> {
    let mut terms = [0u8; MAX_INPUTS];
    loop {
        if !has_rule(blocks, output, &terms) {
            return Some(terms);
        }
        // The next combination, the last input's term first.
        let mut i = inputs.len();
        loop {
            if i == 0 {
                return None;
            }
            i -= 1;
            terms[i] += 1;
            if (terms[i] as usize) < inputs[i].terms.len() {
                break;
            }
            terms[i] = 0;
        }
    }
}

/// Whether a rule with a weight holds wherever these terms hold.
const fn has_rule(blocks: &[Block<'_>], output: usize, terms: &[u8; MAX_INPUTS]) -> bool {
    let mut b = 0;
    while b < blocks.len() {
        let mut r = 0;
        while r < blocks[b].rules.len() {
            let rule = &blocks[b].rules[r];
            if rule.weight.bits() > 0 && concludes(rule, output) && holds(rule, terms) {
                return true;
            }
            r += 1;
        }
        b += 1;
    }
    false
}

const fn concludes(rule: &Rule<'_>, output: usize) -> bool {
    let mut t = 0;
    while t < rule.then.len() {
        if rule.then[t].0 as usize == output {
            return true;
        }
        t += 1;
    }
    false
}

/// Whether one of its conjunctions asks for nothing else than these terms.
const fn holds(rule: &Rule<'_>, terms: &[u8; MAX_INPUTS]) -> bool {
    let mut c = 0;
    while c < rule.when.len() {
        let conjunction = rule.when[c];
        let mut l = 0;
        while l < conjunction.len() {
            match conjunction[l] {
                Literal::Is(input, term) if terms[input as usize] == term => {}
                _ => break,
            }
            l += 1;
        }
        if l == conjunction.len() {
            return true;
        }
        c += 1;
    }
    false
}

impl Defuzzifier<'_> {
    const fn term_count(&self) -> usize {
        match self {
            Self::WeightedAverage { terms, .. } => terms.len(),
            Self::Centroid { terms, .. } => terms.len(),
        }
    }
}
