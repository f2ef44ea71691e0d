//! A search's memory: everything that was asked and judged, in a file. The optimiser cannot be stopped and restored, but
//! from the same seed it asks the same questions again; as long as their answers are known, that takes no time.

use super::Hash;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The file's form; counts up when the meaning changes.
const FORM: u32 = 1;

/// What a search depends on. Two searches that agree in it ask the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// Fingerprint of the design.
    pub design: String,
    /// What is asked of it, in words and fingerprints.
    pub objective: String,
    /// What moves.
    pub moving: String,
    /// The seed.
    pub seed: u64,
    /// The first step.
    pub sigma: f64,
}

/// A state file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State {
    form: u32,
    /// What it depends on.
    pub question: Question,
    /// Fingerprint of each vector, and the bits of its cost: decimal digits might lose the last.
    judged: BTreeMap<String, String>,
}

/// Why a state cannot be gone on from.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}: {what}")]
pub struct StateError {
    file: String,
    what: String,
}

impl State {
    /// Of what was judged so far.
    pub fn new(question: Question, judged: &BTreeMap<u64, f64>) -> Self {
        let hex = |bits: u64| format!("{bits:016x}");
        Self {
            form: FORM,
            question,
            judged: judged
                .iter()
                .map(|(&vector, cost)| (hex(vector), hex(cost.to_bits())))
                .collect(),
        }
    }

    /// As a file's contents.
    pub fn text(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    /// Reads a file, and what it knows of `question`: the costs by their vectors' fingerprints.
    ///
    /// # Errors
    ///
    /// It cannot be read, is no state, or is one of another question; then, in what they differ.
    pub fn load(path: &Path, question: &Question) -> Result<BTreeMap<u64, f64>, StateError> {
        let wrong = |what: String| StateError {
            file: path.display().to_string(),
            what,
        };
        let text = std::fs::read_to_string(path)
            .map_err(|e| wrong(format!("cannot be read ({e}); allowed is a state of tune")))?;
        let state: Self = serde_json::from_str(&text)
            .map_err(|e| wrong(format!("{e}; allowed is a state as tune writes it")))?;
        if state.form != FORM {
            let what = format!("found form {}; allowed is {FORM}", state.form);
            return Err(wrong(what));
        }
        if let Some(part) = state.question.differs(question) {
            return Err(wrong(format!(
                "the search in it has another {part}; allowed is what it was begun with"
            )));
        }
        let bits = |text: &String| {
            u64::from_str_radix(text, 16).map_err(|_| {
                wrong(format!(
                    "found `{text}`; allowed is a number of 16 hex digits"
                ))
            })
        };
        let mut judged = BTreeMap::new();
        for (vector, cost) in &state.judged {
            let value = f64::from_bits(bits(cost)?);
            if !value.is_finite() {
                return Err(wrong(format!(
                    "found the cost {value}; allowed is a finite one"
                )));
            }
            judged.insert(bits(vector)?, value);
        }
        Ok(judged)
    }
}

impl Question {
    /// The fingerprint of a text.
    pub fn fingerprint(text: &str) -> String {
        format!("{:016x}", Hash::default().and(text.as_bytes()).bits())
    }

    fn differs(&self, other: &Self) -> Option<&'static str> {
        [
            (self.design != other.design, "design"),
            (
                self.objective != other.objective,
                "objective (data or scenarios)",
            ),
            (self.moving != other.moving, "--only or --fix"),
            (self.seed != other.seed, "--seed"),
            (self.sigma != other.sigma, "--sigma"),
        ]
        .into_iter()
        .find_map(|(differs, part)| differs.then_some(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::tempdir;

    fn question() -> Question {
        Question {
            design: "a".into(),
            objective: "b".into(),
            moving: "c".into(),
            seed: 1,
            sigma: 0.1,
        }
    }

    #[test]
    fn costs_come_back_to_the_last_bit() {
        let folder = tempdir().unwrap();
        let file = folder.path().join("state.json");
        let costs = [0.1 + 0.2, f64::MIN_POSITIVE, 1.0 / 3.0];
        let judged: BTreeMap<u64, f64> = (u64::MAX - 2..=u64::MAX).zip(costs).collect();
        std::fs::write(&file, State::new(question(), &judged).text().unwrap()).unwrap();
        assert_eq!(State::load(&file, &question()).unwrap(), judged);
    }

    #[test]
    fn another_question_is_named() {
        let folder = tempdir().unwrap();
        let file = folder.path().join("state.json");
        let state = State::new(question(), &BTreeMap::new());
        std::fs::write(&file, state.text().unwrap()).unwrap();
        let mut other = question();
        other.seed = 2;
        let error = State::load(&file, &other).unwrap_err().to_string();
        assert!(error.contains("another --seed"), "{error}");
        std::fs::write(&file, "{}").unwrap();
        assert!(State::load(&file, &question()).is_err());
    }
}
