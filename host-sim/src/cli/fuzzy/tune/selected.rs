//! `--only` and `--fix`: variables and terms by their names, and what to say where they leave nothing.

use crate::cli::BadInput;
use host_sim::fuzzy::model::System;
use host_sim::fuzzy::tune::{Movable, Selection, Variable};
use host_sim::scenario::shown;

/// A variable and its terms by their names.
struct Names<'a> {
    variable: Variable,
    name: &'a str,
    terms: Vec<&'a str>,
}

fn names(system: &System) -> Vec<Names<'_>> {
    let inputs = system
        .inputs
        .iter()
        .enumerate()
        .map(|(index, input)| Names {
            variable: Variable::Input(index),
            name: &input.name,
            terms: input.terms.iter().map(|term| &term.name[..]).collect(),
        });
    let outputs = system.outputs.iter().enumerate();
    let outputs = outputs.map(|(index, output)| Names {
        variable: Variable::Output(index),
        name: &output.name,
        terms: output.terms.iter().map(|term| &term.name[..]).collect(),
    });
    inputs.chain(outputs).collect()
}

/// Variables and terms by their names.
pub fn named(
    system: &System,
    flag: &str,
    texts: &[String],
) -> Result<Vec<(Variable, Option<usize>)>, BadInput> {
    let known = names(system);
    let find = |text: &String| {
        // A name may hold a dot itself.
        let splits = std::iter::once((text.as_str(), None)).chain(
            text.match_indices('.')
                .map(|(at, _)| (&text[..at], Some(&text[at + 1..]))),
        );
        if text.trim().is_empty() {
            return Err(BadInput(format!(
                "{flag}: found an empty name; allowed are {}, alone or with `.` and one of their terms",
                joined(known.iter().map(|of| of.name.to_owned()))
            )));
        }
        let mut nearest = None;
        for (name, term) in splits {
            let Some(of) = known.iter().find(|of| of.name == name) else {
                continue;
            };
            let Some(term) = term else {
                return Ok((of.variable, None));
            };
            match of.terms.iter().position(|known| *known == term) {
                Some(index) => return Ok((of.variable, Some(index))),
                None => nearest = Some((of, term)),
            }
        }
        Err(BadInput(match nearest {
            Some((of, term)) => format!(
                "{flag} {}: `{}` has no term `{}`; allowed are {}",
                shown(text),
                of.name,
                shown(term),
                joined(of.terms.iter().map(|term| format!("{}.{term}", of.name)))
            ),
            None => format!(
                "{flag} {}: no such variable; allowed are {}, alone or with `.` and one of their terms",
                shown(text),
                joined(known.iter().map(|of| of.name.to_owned()))
            ),
        }))
    };
    texts.iter().map(find).collect()
}

/// Why nothing moves: what was asked for, and what could move where nothing but `free` is held.
/// `drives` if the robot is what it is judged by.
pub fn what_could(
    system: &System,
    free: &Selection,
    [only, fix]: [&[String]; 2],
    drives: bool,
) -> BadInput {
    let moves = |variable, term| {
        let selection = Selection {
            only: vec![(variable, term)],
            ..free.clone()
        };
        !Movable::new(system, &selection).is_empty()
    };
    let could = names(system).into_iter().flat_map(|of| {
        let terms = 0..of.terms.len();
        let moving: Vec<usize> = terms.filter(|t| moves(of.variable, Some(*t))).collect();
        // Together they may move where none does alone.
        if moving.len() == of.terms.len() || moving.is_empty() && moves(of.variable, None) {
            vec![of.name.to_owned()]
        } else {
            let name = |t: usize| format!("{}.{}", of.name, of.terms[t]);
            moving.into_iter().map(name).collect()
        }
    });
    let could = joined(could);
    let asked: Vec<String> = [("--only", only), ("--fix", fix)]
        .into_iter()
        .filter(|(_, texts)| !texts.is_empty())
        .map(|(flag, texts)| format!("{flag} {}", shown(&texts.join(","))))
        .collect();
    let asked = match asked.join(" and ") {
        none if none.is_empty() => "this design".to_owned(),
        asked => asked,
    };
    let could = match could.is_empty() {
        true => "nothing of this design can".to_owned(),
        false => format!("what can is {could}"),
    };
    let drives = match drives {
        true => ", and with --scenario all inputs but d",
        false => "",
    };
    BadInput(format!(
        "{asked}: no number can move (knots at the ends of a range or beyond stay{drives}); {could}"
    ))
}

fn joined(names: impl Iterator<Item = String>) -> String {
    names.collect::<Vec<_>>().join(", ")
}
