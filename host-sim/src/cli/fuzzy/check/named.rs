//! Findings under the design's own names.

use super::findings::{
    BeyondRange, Cells, Class, DeadRule, Gap, NonMonotone, OutputError, Point, Ripple, Search,
    Side, UnreachableTerm,
};
use host_sim::fuzzy::check::{
    Errors, NoTable, Report, Ripples, STRENGTHS, Sampled, Stretch, Turn, Turns,
};
use host_sim::fuzzy::describe;
use host_sim::fuzzy::evaluate::{concluded, rules};
use host_sim::fuzzy::model::{Place, System};
use std::ops::RangeInclusive;

/// A system that lends its names.
pub struct Named<'a>(pub &'a System);

impl Named<'_> {
    fn output(&self, output: usize) -> String {
        self.0.outputs[output].name.clone()
    }

    fn point(&self, values: &[f64]) -> Point {
        let names = self.0.inputs.iter().map(|input| input.name.clone());
        names.zip(values.iter().copied()).collect()
    }

    pub fn side(&self, input: usize, stretch: &Stretch) -> Side {
        let of = &self.0.inputs[input];
        Side {
            input: of.name.clone(),
            from: stretch.from,
            to: stretch.to,
            with_from: stretch.with_from,
            with_to: stretch.with_to,
            text: describe::stretch(stretch),
            is_part: stretch.share(of) < 1.0,
        }
    }

    pub fn gap(&self, gap: &host_sim::fuzzy::check::Gap) -> Gap {
        let sides = gap.region.iter().enumerate();
        Gap {
            outputs: gap.outputs.iter().map(|&o| self.output(o)).collect(),
            region: sides.map(|(i, stretch)| self.side(i, stretch)).collect(),
            share: gap.share,
            example: self.point(&gap.example()),
            example_text: describe::given_point(self.0, &gap.example()),
        }
    }

    pub fn sampled_gaps(&self, sampled: &Sampled, points: usize) -> Vec<Gap> {
        let gaps = sampled.gaps.iter().enumerate();
        gaps.filter_map(|(output, (count, example))| {
            let example = example.as_ref()?;
            Some(Gap {
                outputs: vec![self.output(output)],
                region: Vec::new(),
                share: *count as f64 / points as f64,
                example: self.point(example),
                example_text: describe::given_point(self.0, example),
            })
        })
        .collect()
    }

    pub fn dead_rules(&self, report: &Report) -> Vec<DeadRule> {
        let (fires, where_) = match &report.coverage {
            Ok(coverage) => (&coverage.fires, "never fires in the ranges"),
            Err(sampled) => (&sampled.fires, "fires at no point of the grid"),
        };
        let all: Vec<_> = rules(self.0).map(|(_, rule)| rule).collect();
        let dead = |rule: usize, why: String| DeadRule {
            rule: rule + 1,
            why,
            line: all[rule].place.line,
            reads: describe::rule(self.0, all[rule]),
        };
        let never = (0..all.len()).filter(|&rule| !fires[rule]).map(|rule| {
            let why = match all[rule].weight <= 0.0 {
                true => "its weight is zero",
                false => where_,
            };
            dead(rule, why.to_owned())
        });
        let outdone = report.dominated.iter().map(|&(rule, by)| {
            let by = by + 1;
            let why = format!("on the grid never above rule {by}, which concludes the same");
            dead(rule, why)
        });
        let mut found: Vec<DeadRule> = never.chain(outdone).collect();
        found.sort();
        found
    }

    pub fn unreachable_terms(&self, report: &Report) -> Vec<UnreachableTerm> {
        let input = |&(input, term): &(usize, usize), why| UnreachableTerm {
            term: describe::input_term(self.0, input, term),
            line: self.0.inputs[input].terms[term].place.line,
            why,
        };
        let output = |&(output, term): &(usize, usize), why| UnreachableTerm {
            term: describe::output_term(self.0, output, term),
            line: self.output_place(output, term).line,
            why,
        };
        let outside = report.outside.iter();
        let outside = outside.map(|term| input(term, "reaches nothing of its input's range"));
        let unasked = report.unasked.iter();
        let unasked = unasked.map(|term| input(term, "no rule asks about it"));
        let unmet = report.unmet.iter();
        let unmet = unmet.map(|term| output(term, "no sample meets it: its set is zero at all"));
        let unconcluded = report.unconcluded.iter();
        let unconcluded = unconcluded.filter(|term| !report.unmet.contains(term));
        let unconcluded =
            unconcluded.map(|term| output(term, "no rule that can fire concludes it"));
        let all = outside.chain(unasked).chain(unmet).chain(unconcluded);
        all.collect()
    }

    fn output_place(&self, output: usize, term: usize) -> Place {
        self.0.outputs[output].terms[term].place
    }

    pub fn beyond_range(&self, report: &Report) -> Vec<BeyondRange> {
        let found = report.beyond.iter().map(|beyond| {
            let output = &self.0.outputs[beyond.output];
            BeyondRange {
                term: describe::output_term(self.0, beyond.output, beyond.term),
                line: self.output_place(beyond.output, beyond.term).line,
                least: beyond.least,
                most: beyond.most,
                range: [*output.range.start(), *output.range.end()],
                limited: output.clamp,
            }
        });
        found.collect()
    }

    pub fn non_monotone(&self, output: usize, turns: &Turns) -> NonMonotone {
        let cells = turns.table.iter().flatten();
        let ripples = turns.sampled.iter().flatten();
        NonMonotone {
            output: self.output(output),
            search: match (&turns.table, &turns.sampled) {
                (Ok(_), _) => Search::Table,
                (Err(_), Some(_)) => Search::Sampled,
                (Err(_), None) => Search::None,
            },
            sampled: turns.sampled.is_some(),
            why: turns
                .table
                .as_ref()
                .err()
                .map(|why| self.no_table(output, *why)),
            cells: cells.map(|turn| self.cells(turn)).collect(),
            ripples: ripples.map(|ripples| self.ripple(ripples)).collect(),
        }
    }

    fn cells(&self, turn: &Turn) -> Cells {
        let along = &self.0.inputs[turn.along];
        let held = turn.held;
        Cells {
            along: along.name.clone(),
            held: held.map(|(input, term)| describe::input_term(self.0, input, term)),
            conclusions: (turn.cells).map(|(term, value)| {
                let range = &self.0.outputs[turn.output].range;
                (along.terms[term].name.clone(), settled(value, range))
            }),
        }
    }

    fn ripple(&self, ripples: &Ripples) -> Ripple {
        let greatest = &ripples.greatest;
        Ripple {
            along: self.0.inputs[ripples.along].name.clone(),
            lines: ripples.lines,
            turning: ripples.turning,
            at: self.point(&greatest.at),
            at_text: describe::point(self.0, &greatest.at),
            values: greatest.values.map(|(x, y)| {
                let output = &self.0.outputs[ripples.output].range;
                let along = &self.0.inputs[ripples.along].range;
                (settled(x, along), settled(y, output))
            }),
        }
    }

    fn no_table(&self, output: usize, why: NoTable) -> String {
        let rule = |index: usize| {
            let line = rules(self.0).nth(index).map_or(0, |(_, r)| r.place.line);
            match line {
                0 => format!("rule {}", index + 1),
                line => format!("rule {} (line {line})", index + 1),
            }
        };
        let term = |term: usize| describe::output_term(self.0, output, term);
        match why {
            NoTable::NoRule => "no rule concludes it".to_owned(),
            NoTable::Inputs => format!("{} inputs make no table", self.0.inputs.len()),
            NoTable::Or(index) => format!("{} has an OR", rule(index)),
            NoTable::Not(index) => format!("{} has a NOT", rule(index)),
            NoTable::Asks(index) => format!("{} does not ask about each input once", rule(index)),
            NoTable::Cell(first, second) => {
                format!("{} and {} ask the same", rule(first), rule(second))
            }
            NoTable::Linear(index) => format!("{} is linear", term(index)),
            NoTable::Unmet(index) => format!("{} meets no sample", term(index)),
        }
    }

    pub fn errors(&self, output: usize, errors: &Errors) -> OutputError {
        let classes = errors.measured.classes.iter();
        let classes = classes.zip(errors.bounds).zip(STRENGTHS);
        let range = &self.0.outputs[output].range;
        OutputError {
            output: self.output(output),
            concluded: concluded(self.0, output, None),
            range: [*range.start(), *range.end()],
            classes: classes
                .map(|((class, bound), strength)| Class {
                    strongest_rule: strength,
                    points: class.points,
                    rms: class.rms(),
                    greatest: class.worst,
                    at: self.point(&class.at),
                    at_text: describe::given_point(self.0, &class.at),
                    nowhere_above: bound,
                })
                .collect(),
            fast_route: None,
        }
    }
}

/// A value of a range, without what `f64` leaves of a zero.
fn settled(x: f64, range: &RangeInclusive<f64>) -> f64 {
    match x.abs() < 1e-9 * (range.end() - range.start()) {
        true => 0.0,
        false => x,
    }
}
