//! The search: CMA-ES asks, the objective answers, everything answered is kept.

use super::{Hash, Movable, Objective};
use crate::fuzzy::lower::lower;
use crate::fuzzy::model::System;
use cmaes::objective_function::ParallelObjectiveFunction;
use cmaes::{CMAESOptions, DVector, TerminationReason};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The seed of everything random.
    pub seed: u64,
    /// The first step, as a share of each variable's range.
    pub sigma: f64,
    /// Most candidates to judge.
    pub evaluations: usize,
}

/// What is known after a generation.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Candidates asked for.
    pub evaluations: usize,
    /// The least cost.
    pub best: f64,
    /// The step now, as a share of each variable's range.
    pub sigma: f64,
    /// Everything judged: costs by the fingerprints of their vectors.
    pub judged: &'a BTreeMap<u64, f64>,
}

/// A candidate and its cost.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    /// Least of all that were judged.
    pub cost: f64,
    /// The design that has it.
    pub system: System,
}

/// Why the search ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// So many candidates were allowed.
    Evaluations,
    /// The optimiser sees nothing more to gain; why, in its words.
    Converged(String),
    /// It was told to.
    Interrupted,
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

/// Why there was no search, or none to its end.
#[derive(Debug, thiserror::Error)]
pub enum SearchError {
    /// Nothing moves.
    #[error("no number can move: --only and --fix leave none")]
    NothingMoves,
    /// The design itself cannot be judged.
    #[error("the design cannot be judged as it is: {0}")]
    Start(String),
    /// What is known already answers other questions.
    #[error("the state answers other questions: it is from another version of this program")]
    OtherState,
    /// The observer could not go on.
    #[error(transparent)]
    Observer(#[from] anyhow::Error),
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

/// The cost of what the checks refuse or the objective cannot judge: worse than anything, and finite.
const REFUSED: f64 = 1e12;
/// Costs that differ by less do not differ.
const TOLERANCE: f64 = 1e-9;

/// What all threads write into.
struct Record<'a> {
    search: &'a Search<'a>,
    judged: Mutex<BTreeMap<u64, f64>>,
    best: Mutex<Option<(f64, u64, Vec<f64>)>>,
    known: AtomicUsize,
    refused: AtomicUsize,
}

/// Nothing is left half-done while these are locked, so a panic elsewhere does not spoil them.
fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Record<'_> {
    fn judge(&self, vector: &[f64]) -> Option<f64> {
        let (system, excess) = self.search.movable.decode(vector);
        let lowered = lower(&system).ok()?;
        let cost = self.search.objective.cost(&system, &lowered)?;
        // What was meant lies beyond the walls: the farther, the worse, so that the search comes back.
        Some(cost * (1.0 + excess)).filter(|cost| *cost < REFUSED)
    }
}

impl ParallelObjectiveFunction for &Record<'_> {
    /// NaN ends the search.
    fn evaluate_parallel(&self, vector: &DVector<f64>) -> f64 {
        let vector = vector.as_slice();
        let key = Hash::of_vector(vector).bits();
        let known = self.search.known.get(&key).copied();
        let cost = match known {
            Some(cost) => {
                self.known.fetch_add(1, Ordering::Relaxed);
                cost
            }
            None if self.search.stop.load(Ordering::Relaxed) => return f64::NAN,
            None => self.judge(vector).unwrap_or(REFUSED),
        };
        if cost >= REFUSED {
            self.refused.fetch_add(1, Ordering::Relaxed);
        }
        locked(&self.judged).insert(key, cost);
        let mut best = locked(&self.best);
        // Of equals the one with the lower fingerprint, so that the order in which threads end does not show.
        if best.as_ref().is_none_or(|b| (cost, key) < (b.0, b.1)) {
            *best = Some((cost, key, vector.to_vec()));
        }
        cost
    }
}

impl Search<'_> {
    /// Searches, and shows what is known after every generation, and once more when it is interrupted.
    ///
    /// The same for the same settings and objective, whatever the number of threads, and whatever was known of it before.
    ///
    /// # Errors
    ///
    /// See [`SearchError`].
    pub fn run(
        &self,
        observe: &mut dyn FnMut(Progress<'_>) -> anyhow::Result<()>,
    ) -> Result<Outcome, SearchError> {
        let start = self.start()?;
        let record = Record {
            search: self,
            judged: Mutex::new(self.known.clone()),
            best: Mutex::new(None),
            known: AtomicUsize::new(0),
            refused: AtomicUsize::new(0),
        };
        let dimensions = self.movable.len();
        let mut optimiser = CMAESOptions::new(vec![0.0; dimensions], self.settings.sigma)
            .seed(self.settings.seed)
            .tol_fun(TOLERANCE)
            .tol_fun_hist(TOLERANCE)
            .build(&record)
            .map_err(|_| SearchError::NothingMoves)?;
        let each = optimiser.parameters().lambda();
        let stop = loop {
            if optimiser.function_evals() + each > self.settings.evaluations {
                break Stop::Evaluations;
            }
            let before = record.known.load(Ordering::Relaxed);
            let ended = optimiser.next_parallel();
            let answered = record.known.load(Ordering::Relaxed) - before;
            let first = optimiser.function_evals() <= each;
            if first && answered < each.min(self.known.len()) {
                return Err(SearchError::OtherState);
            }
            observe(Progress {
                evaluations: optimiser.function_evals(),
                best: locked(&record.best)
                    .as_ref()
                    .map_or(start, |b| b.0.min(start)),
                sigma: optimiser.sigma(),
                judged: &locked(&record.judged),
            })?;
            if let Some(ended) = ended {
                break match ended.reasons.as_slice() {
                    [TerminationReason::InvalidFunctionValue, ..] => Stop::Interrupted,
                    reasons => {
                        let words: Vec<String> = reasons.iter().map(|r| format!("{r:?}")).collect();
                        Stop::Converged(words.join(", "))
                    }
                };
            }
        };
        let found = locked(&record.best).take();
        Ok(Outcome {
            best: self.better(start, found),
            start,
            evaluations: optimiser.function_evals(),
            known: record.known.into_inner(),
            refused: record.refused.into_inner(),
            stop,
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
    fn better(&self, start: f64, found: Option<(f64, u64, Vec<f64>)>) -> Best {
        let candidate = found.and_then(|(_, _, vector)| {
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
