//! Search for numbers that do better: CMA-ES asks, a [`Problem`] answers, everything answered is kept.
//!
//! [`crate::fuzzy::tune`] moves a design's numbers with it, [`crate::bench::tuning`] the navigator's settings.

mod hash;
pub mod state;

pub use hash::Hash;

use cmaes::objective_function::ParallelObjectiveFunction;
use cmaes::{CMAESOptions, DVector, TerminationReason};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is searched: a vector of shares, zeros at the start.
pub trait Problem: Sync {
    /// Numbers in a vector.
    fn dimensions(&self) -> usize;

    /// How badly a vector does: zero or more, less is better; `None` if it cannot be judged. The same for the same vector
    /// on whichever thread.
    fn cost(&self, vector: &[f64]) -> Option<f64>;
}

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
pub struct Found {
    /// The vector with the least cost, if one could be judged.
    pub best: Option<Vec<f64>>,
    /// Candidates asked for.
    pub evaluations: usize,
    /// Those among them that were known already.
    pub known: usize,
    /// Those that could not be judged.
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
    /// Not even one generation is allowed.
    #[error(
        "--evaluations {found}: less than one generation; allowed is {least} or more where {dimensions} numbers move"
    )]
    TooFew {
        /// Candidates that are allowed.
        found: usize,
        /// Those of a generation.
        least: usize,
        /// Numbers that move.
        dimensions: usize,
    },
    /// The start itself cannot be judged.
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
    /// What is searched.
    pub problem: &'a dyn Problem,
    /// How to search.
    pub settings: Settings,
    /// What is known already.
    pub known: &'a BTreeMap<u64, f64>,
    /// Whether to stop, looked at before each candidate.
    pub stop: &'a AtomicBool,
}

/// Candidates of a generation: fewer cannot be judged.
fn generation(dimensions: usize) -> usize {
    let nothing = |_: &DVector<f64>| 0.0;
    let optimiser = CMAESOptions::new(vec![0.0; dimensions], 1.0).build(nothing);
    optimiser.map_or(0, |optimiser| optimiser.parameters().lambda())
}

/// The cost of what cannot be judged: worse than anything, and finite.
pub const REFUSED: f64 = 1e12;
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
            None => self
                .search
                .problem
                .cost(vector)
                .filter(|cost| *cost < REFUSED)
                .unwrap_or(REFUSED),
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

impl Settings {
    /// Refuses a search that would end before it has begun.
    ///
    /// # Errors
    ///
    /// [`SearchError::TooFew`].
    pub fn check(&self, dimensions: usize) -> Result<(), SearchError> {
        let (found, least) = (self.evaluations, generation(dimensions));
        if found >= least {
            return Ok(());
        }
        Err(SearchError::TooFew {
            found,
            least,
            dimensions,
        })
    }
}

impl Search<'_> {
    /// Searches from a start of known cost, and shows what is known after every generation, and once more when it is
    /// interrupted.
    ///
    /// The same for the same settings and problem, whatever the number of threads, and whatever was known of it before.
    ///
    /// # Errors
    ///
    /// See [`SearchError`].
    pub fn run(
        &self,
        start: f64,
        observe: &mut dyn FnMut(Progress<'_>) -> anyhow::Result<()>,
    ) -> Result<Found, SearchError> {
        let record = Record {
            search: self,
            judged: Mutex::new(self.known.clone()),
            best: Mutex::new(None),
            known: AtomicUsize::new(0),
            refused: AtomicUsize::new(0),
        };
        let dimensions = self.problem.dimensions();
        self.settings.check(dimensions)?;
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
        let best = locked(&record.best).take();
        Ok(Found {
            best: best.map(|(_, _, vector)| vector),
            evaluations: optimiser.function_evals(),
            known: record.known.into_inner(),
            refused: record.refused.into_inner(),
            stop,
        })
    }
}
