//! Where a heading planner heads for: some way ahead on a planned route, or the goal.

use super::route::{Route, distance};
use crate::bench::navigator::Mission;

/// Who is this near to the goal stops there, m.
const THERE: f64 = 0.15;

/// The route of a mission and how far along it the robot is.
#[derive(Clone, Debug)]
pub struct Destination {
    route: Option<Route>,
    goal: [f64; 2],
    /// Distance of the carrot on a planned route, m.
    carrot: f64,
}

/// What there is to head for.
#[derive(Clone, Copy, Debug)]
pub struct Target {
    /// The place, m.
    pub at: [f64; 2],
    /// Bearing to it, rad in odometry's frame.
    pub bearing: f64,
    /// Distance that is left to the goal as the crow flies, m.
    pub left: f64,
}

impl Destination {
    /// Of a mission, with the carrot that far ahead on its route, m.
    pub fn new(mission: &Mission, carrot: f64) -> Self {
        Self {
            route: mission.planned.then(|| Route::new(&mission.route)),
            goal: mission.goal,
            carrot,
        }
    }

    /// From a place; none at the goal.
    pub fn from(&mut self, [x, y]: [f64; 2]) -> Option<Target> {
        let left = distance([x, y], self.goal);
        if left < THERE {
            return None;
        }
        let carrot = self.carrot;
        let at = match &mut self.route {
            Some(route) => {
                let reached = route.locate([x, y]);
                route.point(reached + carrot)
            }
            None => self.goal,
        };
        Some(Target {
            at,
            bearing: libm::atan2(at[1] - y, at[0] - x),
            left,
        })
    }
}
