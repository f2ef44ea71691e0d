//! What a run is worth, as a loss.

use crate::bench::attempt::{Ending, Outcome};

/// Yaw acceleration that costs nothing, rad/s².
const SMOOTH: f64 = 2.0;
/// What a rad/s² more costs.
const ROUGH: f64 = 0.01;
/// Least clearance that costs nothing, m.
const ROOMY: f64 = 0.15;
/// What a metre less costs.
const CLOSE: f64 = 0.3;
/// Time without progress that costs nothing, s.
const PATIENT: f64 = 4.8;
/// What a second more costs.
const STALLED: f64 = 0.02;

/// Score lost, 0 to 0.5; 1 more if the goal was not reached, 2 more after a collision; and a little for rough steering, for
/// passing close and for standing about.
pub fn loss(run: &Outcome) -> f64 {
    let ending = match run.ending {
        Ending::Reached => 0.0,
        Ending::Timeout | Ending::Blocked => 1.0,
        Ending::Collision => 2.0,
    };
    let above = |value: f64, limit: f64| (value - limit).max(0.0);
    0.5 - run.score
        + ending
        + ROUGH * above(run.omega_rate_rms, SMOOTH)
        + CLOSE * above(ROOMY, run.min_clearance_m)
        + STALLED * above(run.longest_stall_s, PATIENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(ending: Ending, score: f64) -> Outcome {
        Outcome {
            ending,
            time_s: 10.0,
            score,
            min_clearance_m: 0.2,
            cross_track_rms_m: 0.0,
            cross_track_max_m: 0.0,
            omega_rate_rms: 1.0,
            longest_stall_s: 1.0,
            stalls: 0,
        }
    }

    #[test]
    fn a_collision_is_worse_than_standing_and_that_worse_than_slow() {
        let slow = loss(&run(Ending::Reached, 0.125));
        let stood = loss(&run(Ending::Blocked, 0.0));
        let touched = loss(&run(Ending::Collision, 0.0));
        assert_eq!(loss(&run(Ending::Reached, 0.5)), 0.0);
        assert!(slow < stood && stood < touched);
    }

    #[test]
    fn rough_steering_close_passes_and_stalls_cost() {
        let calm = run(Ending::Reached, 0.4);
        for worse in [
            Outcome {
                omega_rate_rms: 4.0,
                ..calm
            },
            Outcome {
                min_clearance_m: 0.05,
                ..calm
            },
            Outcome {
                longest_stall_s: 9.0,
                ..calm
            },
        ] {
            assert!(loss(&worse) > loss(&calm));
        }
    }
}
