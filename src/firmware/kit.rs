//! The reference robot: 0.2 m across, two gear motors with 65 mm wheels and 1440 counts a turn behind a TB6612FNG, three
//! ultrasonic and two laser sensors looking ahead. Where yours differs, change it here or over the link.

use super::{BoardPilot, RANGES};
use crate::geometry::{Point, Pose};
use crate::guide::{Path, Segment};
use crate::params::{Mount, Params};
use crate::ports::bridge::Effort;
use crate::ports::wheel_loop::{Gains, Rest, Stall, WheelLoopSettings};
use crate::presets;
use crate::units::{Angle, Metres, MetresPerSecond, Seconds};
use fixed::types::{I16F16, U0F32};
use heapless::Vec;

/// Range sensors of the reference robot.
pub const SENSORS: usize = 5;

/// Places in the ring of the ultrasonic sensors, in the order in which they are fired.
pub const ECHOES: [usize; 3] = [0, 2, 4];

/// Places in the ring of the laser sensors.
pub const LASERS: [usize; 2] = [1, 3];

/// π · 65 mm / 1440.
const METRES_PER_COUNT: U0F32 = U0F32::lit("0.00014181");

/// A wheel at top speed turns 47 counts a step; more than this is no travel.
pub const COUNTS_A_STEP: u16 = 200;

/// Where it believes to stand when it is switched on.
pub const HOME: Pose = Pose::new(Point::new(Metres::ZERO, Metres::ZERO), Angle::ZERO);

/// Top speed 0.5 m/s at 50 Hz; ultrasonic sensors to the right, ahead and to the left, a laser on either side of ahead.
pub const fn params() -> Params<RANGES> {
    let mut params = presets::small_robot();
    params.body.metres_per_count = METRES_PER_COUNT;
    params.limits.speed = const { MetresPerSecond::lit("0.5") };
    params.limits.acceleration = const { I16F16::lit("1") };
    params.limits.wheel_speed = const { MetresPerSecond::lit("0.8") };
    params.guard.braking = params.limits.acceleration;
    params.period = const { Seconds::lit("0.02") };
    params.latency = const { Seconds::lit("0.02") };
    params.ring.closed = false;
    // Three pings of 60 ms, an echo and a tick.
    params.ring.max_age = const { Seconds::lit("0.25") };
    // Forgotten, because a list cannot be dropped where constants are made.
    core::mem::forget(core::mem::replace(
        &mut params.ring.mounts,
        Vec::from_array(MOUNTS),
    ));
    params
}

/// On the rim, looking outwards, counter-clockwise from the right.
const MOUNTS: [Mount; SENSORS] = [
    mount("0.050", "-0.087", "-60", "30"),
    mount("0.091", "-0.042", "-25", "25"),
    mount("0.100", "0.000", "0", "30"),
    mount("0.091", "0.042", "25", "25"),
    mount("0.050", "0.087", "60", "30"),
];

/// Where, whither and how wide a sensor sees: metres and degrees.
const fn mount(x: &str, y: &str, heading: &str, width: &str) -> Mount {
    Mount {
        pose: Pose::new(
            Point::new(Metres::lit(x), Metres::lit(y)),
            Angle::deg(heading),
        ),
        width: Angle::deg(width),
    }
}

/// The wheel loops' settings, gentle enough for most motors; tune them as `ports::wheel_loop` says.
pub const fn wheels() -> WheelLoopSettings {
    const GAINS: Gains = Gains {
        static_effort: I16F16::lit("0.08"),
        feed_forward: I16F16::lit("1"),
        proportional: I16F16::lit("0.8"),
        integral: I16F16::lit("4"),
    };
    WheelLoopSettings {
        metres_per_count: METRES_PER_COUNT,
        gains: [GAINS; 2],
        reverse: [false, true],
        limit: const { Effort::lit("0.9") },
        deadband: const { MetresPerSecond::lit("0.02") },
        rest: Rest::Brake,
        timeout: const { Seconds::lit("0.2") },
        stall: Stall {
            effort: const { Effort::lit("0.7") },
            counts: 4,
            time: const { Seconds::lit("0.5") },
        },
    }
}

/// Gives the pilot its first path, a metre straight on: a first drive needs no desktop.
#[inline(never)]
pub fn lay_path(pilot: &mut BoardPilot) {
    let metre = [Segment::line(HOME, const { Metres::lit("1") })];
    if let Ok(path) = Path::segments(&metre, false) {
        // There is room for one line.
        let _ = pilot.set_path(&path);
    }
}
