//! How far a run was from a route of known shape.

use super::arena::{Course, Stretch};
use super::attempt::Step;
use serde::{Deserialize, Serialize};

/// Who is this near to the route is on it again after a pass, m.
const REGAINED: f64 = 0.05;

/// A stretch of a route and how far the body's centre was from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tracked {
    /// Its name.
    pub stretch: String,
    /// RMS distance over the ticks whose nearest place of the route lies in it, m.
    pub rms_m: f64,
    /// Largest distance in these, m.
    pub max_m: f64,
    /// Of a route with an obstacle on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pass: Option<Pass>,
}

/// How a robot came back to its route behind an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// Way along the route from the obstacle's far edge to where the robot is within 0.05 m for good, m; none if it never
    /// was.
    pub regained_after_m: Option<f64>,
}

/// Sums along a run.
pub struct Tracking<'a> {
    course: &'a Course,
    sums: Vec<Sum>,
    /// Where the robot was last too far away, m along the route, and whether it still is.
    away: Option<(f64, bool)>,
}

#[derive(Clone, Copy, Default)]
struct Sum {
    squares: f64,
    ticks: u64,
    most: f64,
}

impl<'a> Tracking<'a> {
    /// Of a run along a course.
    pub fn new(course: &'a Course) -> Self {
        Self {
            sums: vec![Sum::default(); course.stretches.len()],
            course,
            away: None,
        }
    }

    /// Takes a tick over.
    pub fn see(&mut self, step: &Step<'_>) {
        let error = step.cross_track.abs();
        let holds = |stretch: &Stretch| stretch.along.contains(&step.way);
        if let Some(k) = self.course.stretches.iter().position(holds) {
            let sum = &mut self.sums[k];
            sum.squares += error * error;
            sum.ticks += 1;
            sum.most = sum.most.max(error);
        }
        if let Some(passed) = self.course.passed.filter(|passed| step.way >= *passed) {
            self.away = Some(match self.away {
                _ if error > REGAINED => (step.way, true),
                Some((way, true)) => (way.max(step.way), false),
                Some(near) => near,
                None => (passed, false),
            });
        }
    }

    /// What came out.
    pub fn finish(self) -> Vec<Tracked> {
        let pass = self.course.passed.map(|passed| Pass {
            regained_after_m: match self.away {
                Some((way, false)) => Some((way - passed).max(0.0)),
                _ => None,
            },
        });
        let stretches = self.course.stretches.iter().zip(&self.sums);
        stretches
            .map(|(stretch, sum)| Tracked {
                stretch: stretch.name.clone(),
                rms_m: (sum.squares / sum.ticks.max(1) as f64).sqrt(),
                max_m: sum.most,
                pass,
            })
            .collect()
    }
}

/// The runs of a route together: RMS over them, the largest distance and the latest return of any.
pub fn pooled(runs: &[&[Tracked]]) -> Vec<Tracked> {
    let Some(first) = runs.first() else {
        return Vec::new();
    };
    let pool = |(k, of): (usize, &Tracked)| {
        let all: Vec<&Tracked> = runs.iter().filter_map(|run| run.get(k)).collect();
        let squares: f64 = all.iter().map(|t| t.rms_m * t.rms_m).sum();
        let returns = all.iter().map(|t| t.pass?.regained_after_m);
        Tracked {
            stretch: of.stretch.clone(),
            rms_m: (squares / all.len() as f64).sqrt(),
            max_m: all.iter().map(|t| t.max_m).fold(0.0, f64::max),
            pass: of.pass.map(|_| Pass {
                regained_after_m: returns
                    .collect::<Option<Vec<f64>>>()
                    .map(|all| all.into_iter().fold(0.0, f64::max)),
            }),
        }
    };
    first.iter().enumerate().map(pool).collect()
}
