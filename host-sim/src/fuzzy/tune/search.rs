//! The search for a design: vectors are designs, what the library's checks refuse is not judged.

use super::{Movable, Objective};
use crate::fuzzy::lower::lower;
use crate::fuzzy::model::System;
use crate::search::{self, Problem, Progress, REFUSED, SearchError, Settings, Stop};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;

/// A candidate and its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    /// Least of all that were judged.
    pub cost: f64,
    /// The design that has it.
    pub system: System,
}

/// What came of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The best candidate, or the start if none was better.
    pub best: Best,
    /// The start's cost.
    pub start: f64,
    /// Candidates asked for.
    pub evaluations: usize,
    /// Those among them that were known already.
    pub known: usize,
    /// Those that the library's checks refused.
    pub refused: usize,
    /// Why it ended.
    pub stop: Stop,
}

/// A search that is set up.
pub struct Search<'a> {
    /// What moves.
    pub movable: &'a Movable,
    /// What is wanted.
    pub objective: &'a dyn Objective,
    /// How to search.
    pub settings: Settings,
    /// What is known already.
    pub known: BTreeMap<u64, f64>,
    /// Whether to stop, looked at before each candidate.
    pub stop: &'a AtomicBool,
}

impl Problem for Search<'_> {
    fn dimensions(&self) -> usize {
        self.movable.len()
    }

    fn cost(&self, vector: &[f64]) -> Option<f64> {
        let (system, excess) = self.movable.decode(vector);
        let lowered = lower(&system).ok()?;
        let cost = self.objective.cost(&system, &lowered)?;
        // What was meant lies beyond the walls: the farther, the worse, so that the search comes back.
        Some(cost * (1.0 + excess))
    }
}

impl Search<'_> {
    /// Searches as [`search::Search::run`] does.
    ///
    /// # Errors
    ///
    /// See [`SearchError`].
    pub fn run(
        &self,
        observe: &mut dyn FnMut(Progress<'_>) -> anyhow::Result<()>,
    ) -> Result<Outcome, SearchError> {
        let start = self.start()?;
        let found = search::Search {
            problem: self,
            settings: self.settings,
            known: &self.known,
            stop: self.stop,
        }
        .run(start, observe)?;
        Ok(Outcome {
            best: self.better(start, found.best),
            start,
            evaluations: found.evaluations,
            known: found.known,
            refused: found.refused,
            stop: found.stop,
        })
    }

    /// The design's own cost.
    fn start(&self) -> Result<f64, SearchError> {
        if self.movable.is_empty() {
            return Err(SearchError::NothingMoves);
        }
        let system = self.movable.start();
        let lowered = lower(system).map_err(|e| SearchError::Start(e.to_string()))?;
        let cost = self.objective.cost(system, &lowered);
        cost.filter(|cost| *cost < REFUSED)
            .ok_or_else(|| SearchError::Start("its cost is no number".to_owned()))
    }

    /// The candidate, judged as it is and not by what was meant, or the start.
    fn better(&self, start: f64, found: Option<Vec<f64>>) -> Best {
        let candidate = found.and_then(|vector| {
            let (system, _) = self.movable.decode(&vector);
            let lowered = lower(&system).ok()?;
            let cost = self.objective.cost(&system, &lowered)?;
            Some(Best { cost, system })
        });
        candidate.filter(|best| best.cost < start).unwrap_or(Best {
            cost: start,
            system: self.movable.start().clone(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::model::{Conclusion, Shape};
    use crate::fuzzy::sample::fan;
    use crate::fuzzy::tune::data::{Data, Row};
    use crate::fuzzy::tune::{Fit, Selection};
    use std::sync::atomic::Ordering;

    /// What a fan answers, on a grid.
    fn answers(fan: &System) -> Data {
        let exact = Exact::new(fan);
        let points = (0..=20).flat_map(|t| (0..=10).map(move |h| [t, h].map(f64::from)));
        let row = |[t, h]: [f64; 2]| {
            let inputs = vec![2.0 * t, 10.0 * h];
            let targets = exact.evaluate(&inputs).outputs.into_iter().flatten();
            Row {
                targets: targets.collect(),
                inputs,
            }
        };
        Data {
            outputs: vec![0],
            rows: points.map(row).collect(),
        }
    }

    /// The fan with its middle temperature and half speed elsewhere.
    fn detuned() -> System {
        let mut system = fan();
        let middle = 28.5;
        let terms = &mut system.inputs[0].terms;
        terms[0].shape = Shape::Ramp {
            from: middle,
            to: 18.0,
        };
        terms[1].shape = Shape::Triangle {
            left: 18.0,
            peak: middle,
            right: 32.0,
        };
        terms[2].shape = Shape::Ramp {
            from: middle,
            to: 32.0,
        };
        system.outputs[0].terms[1].conclusion = Conclusion::Constant(65.0);
        system
    }

    fn settings(evaluations: usize) -> Settings {
        Settings {
            seed: 3,
            sigma: 0.1,
            evaluations,
        }
    }

    static GO: AtomicBool = AtomicBool::new(false);

    fn run(evaluations: usize, known: BTreeMap<u64, f64>) -> (Outcome, BTreeMap<u64, f64>) {
        let data = answers(&fan());
        let movable = Movable::new(&detuned(), &Selection::default());
        let search = Search {
            movable: &movable,
            objective: &Fit(&data),
            settings: settings(evaluations),
            known,
            stop: &GO,
        };
        let mut judged = BTreeMap::new();
        let outcome = search.run(&mut |progress| {
            judged = progress.judged.clone();
            Ok(())
        });
        (outcome.unwrap(), judged)
    }

    #[test]
    fn known_peaks_and_consequents_are_found_again() {
        let (outcome, _) = run(3000, BTreeMap::new());
        let best = &outcome.best;
        assert!(outcome.start > 0.05, "{}", outcome.start);
        assert!(best.cost < 2e-5, "{} by {:?}", best.cost, outcome.stop);
        assert_eq!(outcome.refused, 0);
        let wanted = fan();
        for (found, wanted) in best.system.inputs.iter().zip(&wanted.inputs) {
            let width = wanted.range.end() - wanted.range.start();
            for (found, wanted) in found.terms.iter().zip(&wanted.terms) {
                for (found, wanted) in found.shape.knots().iter().zip(wanted.shape.knots()) {
                    let off = (found - wanted).abs() / width;
                    assert!(off < 5e-4, "{found}, not {wanted}");
                }
            }
        }
        for (found, wanted) in best.system.outputs[0].terms.iter().zip([0.0, 40.0, 100.0]) {
            let Conclusion::Constant(found) = found.conclusion else {
                panic!("a constant stays one");
            };
            assert!((found - wanted).abs() < 0.05, "{found}, not {wanted}");
        }
    }

    #[test]
    fn one_thread_finds_what_two_find() {
        let by = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            pool.build().unwrap().install(|| run(300, BTreeMap::new()))
        };
        assert_eq!(by(1), by(2));
    }

    #[test]
    fn going_on_gives_what_one_run_gives() {
        let whole = run(400, BTreeMap::new());
        let half = run(170, BTreeMap::new()).1;
        assert!(half.len() < whole.1.len());
        let (mut rest, judged) = run(400, half.clone());
        assert_eq!(
            (rest.known, rest.evaluations),
            (half.len(), whole.0.evaluations)
        );
        rest.known = 0;
        assert_eq!((rest, judged), whole);
    }

    #[test]
    fn answers_to_other_questions_are_refused() {
        let data = answers(&fan());
        let movable = Movable::new(&detuned(), &Selection::default());
        let search = Search {
            movable: &movable,
            objective: &Fit(&data),
            settings: settings(100),
            known: (0..20).map(|key| (key, 0.0)).collect(),
            stop: &GO,
        };
        let error = search.run(&mut |_| Ok(())).unwrap_err();
        assert!(matches!(error, SearchError::OtherState), "{error}");
    }

    #[test]
    fn a_stop_keeps_what_was_judged() {
        let stop = AtomicBool::new(false);
        let data = answers(&fan());
        let movable = Movable::new(&detuned(), &Selection::default());
        let search = Search {
            movable: &movable,
            objective: &Fit(&data),
            settings: settings(1000),
            known: BTreeMap::new(),
            stop: &stop,
        };
        let mut judged = 0;
        let outcome = search.run(&mut |progress| {
            judged = progress.judged.len();
            stop.store(judged >= 50, Ordering::Relaxed);
            Ok(())
        });
        let outcome = outcome.unwrap();
        assert_eq!(outcome.stop, Stop::Interrupted);
        assert!((50..=60).contains(&judged), "{judged}");
        assert!(outcome.best.cost < outcome.start);
    }

    #[test]
    fn a_good_start_stays() {
        let fan = fan();
        let data = answers(&fan);
        let movable = Movable::new(&fan, &Selection::default());
        let search = Search {
            movable: &movable,
            objective: &Fit(&data),
            settings: settings(60),
            known: BTreeMap::new(),
            stop: &GO,
        };
        let outcome = search.run(&mut |_| Ok(())).unwrap();
        assert_eq!(outcome.best.system, fan);
    }
}
