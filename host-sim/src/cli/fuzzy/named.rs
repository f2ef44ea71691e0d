//! Inputs by name on the command line: `NAME=VALUE`.

use crate::cli::BadInput;
use host_sim::fuzzy::model::{Input, System};
use host_sim::scenario::shown;

/// Reads `NAME=VALUE`s: a value an input, `None` for one that was not named. `flag` is what messages call them.
pub fn values(system: &System, flag: &str, texts: &[String]) -> Result<Vec<Option<f64>>, BadInput> {
    let mut values = vec![None; system.inputs.len()];
    for text in texts {
        let bad = |what: String| BadInput(format!("{flag} {}: {what}", shown(text)));
        let (name, number) = text
            .split_once('=')
            .ok_or_else(|| bad("found no `=`; allowed is NAME=VALUE".to_owned()))?;
        let index = input(system, flag, name.trim())?;
        let value = (number.trim().parse::<f64>().ok())
            .filter(|x| x.is_finite())
            .ok_or_else(|| {
                bad(format!(
                    "found `{}`; allowed is a finite number",
                    shown(number)
                ))
            })?;
        if values[index].replace(value).is_some() {
            return Err(bad("given twice; allowed is one value an input".to_owned()));
        }
    }
    Ok(values)
}

/// The input of that name.
pub fn input(system: &System, flag: &str, name: &str) -> Result<usize, BadInput> {
    system
        .inputs
        .iter()
        .position(|input| input.name == name)
        .ok_or_else(|| {
            let names: Vec<&str> = system
                .inputs
                .iter()
                .map(|input| input.name.as_str())
                .collect();
            BadInput(format!(
                "{flag} {}: no such input; allowed: {}",
                shown(name),
                names.join(", ")
            ))
        })
}

/// The middle of an input's range.
pub fn middle(input: &Input) -> f64 {
    input.range.start() + (input.range.end() - input.range.start()) / 2.0
}
