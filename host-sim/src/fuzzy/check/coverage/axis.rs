//! An input's range in pieces: in each, every one of its terms is there or not, and full or not.

use super::Stretch;
use crate::fuzzy::model::{Input, Shape};
use std::ops::Range;

/// The pieces of one input, and which terms hold in them.
pub struct Axis {
    stretches: Vec<Stretch>,
    terms: Vec<Counted>,
}

/// Of a term: in how many of the pieces before each it is there, and full; one more entry than pieces.
#[derive(Clone)]
struct Counted {
    reached: Vec<usize>,
    filled: Vec<usize>,
}

impl Axis {
    /// Cuts an input's range where terms begin, end, or are full.
    pub fn new(input: &Input) -> Self {
        let (start, end) = (*input.range.start(), *input.range.end());
        let shapes = || input.terms.iter().map(|term| &term.shape);
        let mut knots: Vec<f64> = shapes().flat_map(Shape::knots).collect();
        knots.retain(|x| (start..=end).contains(x));
        knots.extend([start, end]);
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        let mut stretches = Vec::new();
        for pair in knots.windows(2) {
            stretches.push(Stretch::point(pair[0]));
            let between = Stretch::between(pair[0], pair[1]);
            if between.example() > pair[0] && between.example() < pair[1] {
                stretches.push(between);
            }
        }
        stretches.push(Stretch::point(end));
        // Neighbours in which the same terms hold are one piece: (where, there, full).
        let mut pieces: Vec<(Stretch, Vec<bool>, Vec<bool>)> = Vec::new();
        for stretch in stretches {
            let x = stretch.example();
            let reached: Vec<bool> = shapes().map(|shape| shape.reaches(x)).collect();
            let filled: Vec<bool> = shapes().map(|shape| shape.fills(x)).collect();
            match pieces.last_mut() {
                Some(last) if (&last.1, &last.2) == (&reached, &filled) => {
                    last.0 = last.0.joined(stretch);
                }
                _ => pieces.push((stretch, reached, filled)),
            }
        }
        let counted = |holds: &dyn Fn(usize) -> bool| -> Vec<usize> {
            let sums = (0..pieces.len()).scan(0, |sum, piece| {
                *sum += usize::from(holds(piece));
                Some(*sum)
            });
            std::iter::once(0).chain(sums).collect()
        };
        let terms = (0..input.terms.len()).map(|term| Counted {
            reached: counted(&|piece| pieces[piece].1[term]),
            filled: counted(&|piece| pieces[piece].2[term]),
        });
        Self {
            terms: terms.collect(),
            stretches: pieces.into_iter().map(|piece| piece.0).collect(),
        }
    }

    /// How many pieces there are.
    pub fn len(&self) -> usize {
        self.stretches.len()
    }

    /// In how many of these pieces the input is, or is not, the term.
    pub fn holding(&self, term: usize, negated: bool, pieces: &Range<usize>) -> usize {
        let counted = &self.terms[term];
        let among = |of: &[usize]| of[pieces.end] - of[pieces.start];
        match negated {
            true => pieces.len() - among(&counted.filled),
            false => among(&counted.reached),
        }
    }

    /// Whether no term holds in a piece.
    pub fn is_bare(&self, piece: usize) -> bool {
        (0..self.terms.len()).all(|term| self.holding(term, false, &(piece..piece + 1)) == 0)
    }

    /// Pieces that follow each other as one stretch.
    pub fn stretch(&self, pieces: &Range<usize>) -> Stretch {
        let first = self.stretches[pieces.start];
        first.joined(self.stretches[pieces.end - 1])
    }
}
