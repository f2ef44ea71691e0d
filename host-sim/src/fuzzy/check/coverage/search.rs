//! Boxes of pieces, halved until every rule holds everywhere in them or nowhere.

use super::axis::Axis;
use crate::fuzzy::model::{Antecedent, Rule};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// What looking at a box costs beside the rules in it, and keeping one.
const BOX: usize = 8;
const KEPT: usize = 1000;
/// Rules that say where a box is halved.
const ASKED: usize = 16;

/// Pieces of each input.
pub type Region = Vec<Range<usize>>;

/// A rule as far as it matters here.
#[derive(Clone, Copy)]
pub struct Candidate<'a> {
    /// When it fires.
    pub antecedent: &'a Antecedent,
    /// The outputs that it concludes something about, a bit each.
    pub about: u64,
}

/// A box without a conclusion.
#[derive(Clone, Debug, PartialEq)]
pub struct Bare {
    /// Where.
    pub region: Region,
    /// For which outputs, a bit each.
    pub outputs: u64,
}

/// In how much of a box something holds. Of an antecedent, `Partly` may also be nowhere; not of a box of one piece an input.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Extent {
    Nowhere,
    Partly,
    Everywhere,
}

/// A search that is given up when it takes too much. Whether it is does not depend on the number of cores.
pub struct Search<'a> {
    axes: &'a [Axis],
    left: AtomicUsize,
}

impl<'a> Search<'a> {
    /// Over these axes, with so much work.
    pub fn new(axes: &'a [Axis], work: usize) -> Self {
        let left = AtomicUsize::new(work);
        Self { axes, left }
    }

    /// Which rules with a weight fire somewhere.
    pub fn fire(&self, rules: &[&Rule]) -> Option<Vec<bool>> {
        let everywhere = self.everywhere();
        let fires = |rule: &&Rule| {
            Some(rule.weight > 0.0 && self.holds_somewhere(&rule.antecedent, &everywhere)?)
        };
        rules.par_iter().map(fires).collect()
    }

    /// All boxes where an output of `outputs` has no conclusion.
    pub fn bare(&self, rules: &[Candidate<'_>], outputs: u64) -> Option<Vec<Bare>> {
        self.bare_in(self.everywhere(), rules, outputs, 0)
    }

    fn everywhere(&self) -> Region {
        self.axes.iter().map(|axis| 0..axis.len()).collect()
    }

    fn holds_somewhere(&self, antecedent: &Antecedent, region: &Region) -> Option<bool> {
        self.spend(BOX)?;
        match self.extent(antecedent, region) {
            Extent::Nowhere => Some(false),
            Extent::Everywhere => Some(true),
            Extent::Partly => {
                let [first, second] = self.halves(region, &[antecedent]);
                Some(
                    self.holds_somewhere(antecedent, &first)?
                        || self.holds_somewhere(antecedent, &second)?,
                )
            }
        }
    }

    /// `open`: outputs that may have a conclusion somewhere in the box; `bare`: those that have none anywhere in it.
    fn bare_in(
        &self,
        region: Region,
        rules: &[Candidate<'_>],
        mut open: u64,
        mut bare: u64,
    ) -> Option<Vec<Bare>> {
        self.spend(BOX + rules.len())?;
        let mut partly = Vec::new();
        for rule in rules {
            if rule.about & open == 0 {
                continue;
            }
            match self.extent(rule.antecedent, &region) {
                Extent::Nowhere => {}
                Extent::Partly => partly.push(*rule),
                Extent::Everywhere => open &= !rule.about,
            }
        }
        let touched = partly.iter().fold(0, |bits, rule| bits | rule.about);
        bare |= open & !touched;
        open &= touched;
        if open == 0 {
            let kept = (bare != 0).then_some(Bare {
                region,
                outputs: bare,
            });
            self.spend(if kept.is_some() { KEPT } else { 0 })?;
            return Some(kept.into_iter().collect());
        }
        partly.retain(|rule| rule.about & open != 0);
        let asked: Vec<&Antecedent> = (partly.iter().take(ASKED))
            .map(|rule| rule.antecedent)
            .collect();
        let [first, second] = self.halves(&region, &asked);
        let (first, second) = rayon::join(
            || self.bare_in(first, &partly, open, bare),
            || self.bare_in(second, &partly, open, bare),
        );
        let mut all = first?;
        all.extend(second?);
        Some(all)
    }

    fn spend(&self, work: usize) -> Option<()> {
        let less = |left: usize| left.checked_sub(work);
        let order = Ordering::Relaxed;
        let spent = self.left.fetch_update(order, order, less);
        if spent.is_err() {
            // The others stop, too.
            self.left.store(0, order);
        }
        spent.ok().map(|_| ())
    }

    fn extent(&self, antecedent: &Antecedent, region: &Region) -> Extent {
        match antecedent {
            Antecedent::Is {
                input,
                term,
                negated,
            } => {
                let pieces = &region[*input];
                match self.axes[*input].holding(*term, *negated, pieces) {
                    0 => Extent::Nowhere,
                    some if some == pieces.len() => Extent::Everywhere,
                    _ => Extent::Partly,
                }
            }
            Antecedent::And(parts) => {
                let mut all = Extent::Everywhere;
                for part in parts {
                    all = all.min(self.extent(part, region));
                    if all == Extent::Nowhere {
                        break;
                    }
                }
                all
            }
            Antecedent::Or(parts) => {
                let mut any = Extent::Nowhere;
                for part in parts {
                    any = any.max(self.extent(part, region));
                    if any == Extent::Everywhere {
                        break;
                    }
                }
                any
            }
        }
    }

    /// Across the input about which most of what is asked is open in the box.
    fn halves(&self, region: &Region, antecedents: &[&Antecedent]) -> [Region; 2] {
        let mut open = vec![0_usize; region.len()];
        for antecedent in antecedents {
            self.count_open(antecedent, region, &mut open);
        }
        // Of equals the one with the most pieces. What holds partly asks about an input with more than one.
        let across = (0..region.len())
            .filter(|&input| region[input].len() > 1)
            .max_by_key(|&input| (open[input], region[input].len()))
            .unwrap_or(0);
        let (start, end) = (region[across].start, region[across].end);
        let middle = start + (end - start) / 2;
        [start..middle, middle..end].map(|half| {
            let mut region = region.clone();
            region[across] = half;
            region
        })
    }

    fn count_open(&self, antecedent: &Antecedent, region: &Region, open: &mut [usize]) {
        match antecedent {
            Antecedent::Is { input, .. } => {
                open[*input] += usize::from(self.extent(antecedent, region) == Extent::Partly);
            }
            Antecedent::And(parts) | Antecedent::Or(parts) => {
                for part in parts {
                    self.count_open(part, region, open);
                }
            }
        }
    }
}

/// Boxes that meet with a whole side become one, until none do: along the first input before the second, and so on.
pub fn joined(mut boxes: Vec<Bare>, inputs: usize) -> Vec<Bare> {
    loop {
        let before = boxes.len();
        for along in 0..inputs {
            boxes = joined_along(boxes, along);
        }
        if boxes.len() == before {
            return boxes;
        }
    }
}

fn joined_along(mut boxes: Vec<Bare>, along: usize) -> Vec<Bare> {
    let others = |bare: &Bare| {
        let ends = |(input, pieces): (usize, &Range<usize>)| match input == along {
            true => (0, 0),
            false => (pieces.start, pieces.end),
        };
        bare.region.iter().enumerate().map(ends).collect::<Vec<_>>()
    };
    boxes.sort_by_cached_key(|bare| (bare.outputs, others(bare), bare.region[along].start));
    let mut all: Vec<Bare> = Vec::with_capacity(boxes.len());
    for next in boxes {
        let meets = |last: &Bare| {
            let sides = last.region.iter().zip(&next.region).enumerate();
            last.outputs == next.outputs && last.region[along].end == next.region[along].start && {
                sides
            }
            .all(|(input, (a, b))| input == along || a == b)
        };
        match all.last_mut() {
            Some(last) if meets(last) => last.region[along].end = next.region[along].end,
            _ => all.push(next),
        }
    }
    all
}
