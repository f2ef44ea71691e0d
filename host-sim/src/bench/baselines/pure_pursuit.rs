//! Pure pursuit: the arc through a point on the route a fixed distance ahead. It sees nothing.
//!
//! Source: R. C. Coulter, *Implementation of the Pure Pursuit Path Tracking Algorithm*, CMU-RI-TR-92-01, 1992.
//!
//! Lookahead 0.6 m: from 0.3 to 1.2 m in steps of 0.1 m the best on the development worlds' paths.

use super::route::{Route, distance};
use crate::bench::body::to_body;
use crate::bench::navigator::{Command, Inputs, Mission, Mode, Navigator};

/// Distance to the point that is pursued, m.
const LOOKAHEAD: f64 = 0.6;

/// At the route's end within this, m.
const END: f64 = 0.1;

/// See the module.
#[derive(Clone, Debug)]
pub struct PurePursuit {
    route: Route,
    goal: [f64; 2],
    speed: f64,
    yaw_rate: f64,
    braking: f64,
}

impl PurePursuit {
    /// For a mission.
    pub fn new(mission: &Mission) -> Self {
        Self {
            route: Route::new(&mission.route),
            goal: mission.goal,
            speed: mission.limits.speed,
            yaw_rate: mission.limits.yaw_rate,
            braking: mission.limits.acceleration,
        }
    }
}

impl Navigator for PurePursuit {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        let [x, y, _] = inputs.pose;
        let left = distance([x, y], self.goal);
        if left < END {
            return Command::stop(Mode::Arrived);
        }
        let at = self.route.locate([x, y]);
        let carrot = to_body(inputs.pose, self.route.point(at + LOOKAHEAD));
        let curvature = curvature_to(carrot);
        // Half the braking, for the latency.
        let speed = self.speed.min((self.braking * left).sqrt());
        // The speed that the yaw rate allows keeps the arc.
        let speed = speed.min(self.yaw_rate / curvature.abs().max(1e-9));
        Command {
            speed,
            yaw_rate: speed * curvature,
            mode: Mode::Follow,
        }
    }
}

/// Curvature of the arc from the origin, heading along x, through a point, 1/m.
pub fn curvature_to([x, y]: [f64; 2]) -> f64 {
    2.0 * y / (x * x + y * y).max(1e-6)
}
