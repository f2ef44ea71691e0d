//! Complete settings to start from: change what differs on your robot, then [`Params::checked`] them.

use crate::geometry::{Point, Pose};
use crate::params::{
    Avoider, Body, Follower, Guard, Integrator, Law, Limits, Mount, Params, RingGeometry,
    Supervisor,
};
use crate::tables::coarse::{CoarseSet, SpeedInput};
use crate::tables::fine::{FineSet, SpeedAxis};
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, Seconds};
use fixed::types::{I16F16, U0F32};
use heapless::Vec;

/// Numbers that are parsed while this compiles: at run time the parser would cost 20 KiB of flash.
macro_rules! n {
    ($text:literal) => {
        const { I16F16::lit($text) }
    };
}

macro_rules! m {
    ($text:literal) => {
        const { Metres::lit($text) }
    };
}

macro_rules! v {
    ($text:literal) => {
        const { MetresPerSecond::lit($text) }
    };
}

/// 2⁻²⁰ m: what wheel travel loses by counting is below a micrometre. A real robot puts its own value here.
const MICROMETRE: U0F32 = U0F32::from_bits(1 << 12);

/// χ∞ = 1.2 rad and k = 2 /m of the vector field; bends at 3 m/s².
pub(crate) const FOLLOWER: Follower = Follower {
    law: Law::Guided,
    tables: FineSet::Tuned,
    speed_axis: SpeedAxis::Scaled,
    distance_scale: n!("10"),
    deflection_rate: n!("4.952"),
    approach_gain: PerMetre::lit("2"),
    approach_angle: Angle::from_radians(n!("1.2")),
    feed_forward_band: m!("0.3"),
    lateral_acceleration: n!("3"),
    corner_speed: v!("0.2"),
    reach: m!("0.5"),
    arrival: m!("0.02"),
    end_radius: m!("0.15"),
};

/// A small differential robot: 0.2 m across, 1 m/s, 20 Hz with 50 ms latency, `N` beams of 2 m all round.
pub const fn small_robot<const N: usize>() -> Params<N> {
    Params {
        body: Body {
            radius: m!("0.10"),
            track: m!("0.16"),
            metres_per_count: MICROMETRE,
        },
        limits: Limits {
            speed: v!("1"),
            yaw_rate: n!("4"),
            acceleration: n!("2.5"),
            yaw_acceleration: n!("8"),
            wheel_speed: v!("1.3"),
        },
        period: const { Seconds::lit("0.05") },
        latency: const { Seconds::lit("0.05") },
        integrator: Integrator::Arc,
        ring: RingGeometry {
            mounts: all_round(),
            closed: true,
            max_range: m!("2"),
            max_age: const { Seconds::lit("0.2") },
            gap: m!("0.35"),
            radius: [m!("0.05"), m!("2")],
            residual: m!("0.03"),
        },
        follower: FOLLOWER,
        avoider: Avoider {
            tables: CoarseSet::Corrected,
            speed_input: SpeedInput::Deflection,
            range: m!("2"),
            margin: m!("0.08"),
            deflection_rate: n!("2.5"),
            overshoot: const { Angle::deg("20") },
        },
        supervisor: Supervisor {
            enter: m!("0.8"),
            exit: m!("1.4"),
            dwell: 3,
            clear: const { Angle::deg("6") },
            tie: const { Angle::deg("1") },
            same: m!("0.3"),
            patience: 6,
        },
        guard: Guard {
            margin: m!("0.03"),
            braking: n!("2.5"),
        },
    }
}

/// The chapter's robot: radius 0.2 and top speed 0.3 given; one step a second, so that 0.3 is both speed and step
/// (assumed); `N` beams of D = 4 all round (the chapter's D̄); printed fine tables; equation 7.1. Yaw and acceleration
/// limits let one step do all that equation 7.1 asks for.
pub fn chapter_robot<const N: usize>() -> Params<N> {
    let small = small_robot();
    Params {
        body: Body {
            radius: m!("0.2"),
            track: m!("0.3"),
            metres_per_count: MICROMETRE,
        },
        limits: Limits {
            speed: v!("0.3"),
            yaw_rate: n!("1.6"),
            acceleration: n!("0.3"),
            yaw_acceleration: n!("3.2"),
            wheel_speed: v!("0.6"),
        },
        period: const { Seconds::lit("1") },
        latency: Seconds::ZERO,
        integrator: Integrator::Euler,
        ring: RingGeometry {
            max_range: m!("4"),
            max_age: const { Seconds::lit("3") },
            gap: m!("0.8"),
            radius: [m!("0.05"), m!("4")],
            residual: m!("0.05"),
            ..small.ring
        },
        follower: Follower {
            tables: FineSet::Printed,
            distance_scale: n!("1"),
            deflection_rate: n!("1"),
            reach: m!("4"),
            arrival: m!("0.1"),
            end_radius: m!("0.3"),
            ..FOLLOWER
        },
        avoider: Avoider {
            range: m!("4"),
            margin: m!("0.2"),
            deflection_rate: n!("1"),
            ..small.avoider
        },
        supervisor: Supervisor {
            enter: m!("2.4"),
            exit: m!("3.6"),
            same: m!("1"),
            patience: 3,
            ..small.supervisor
        },
        guard: Guard {
            margin: m!("0.05"),
            braking: n!("0.3"),
        },
    }
}

/// A beam from the robot's centre straight ahead.
const MIDDLE: Mount = Mount {
    pose: Pose::new(Point::new(Metres::ZERO, Metres::ZERO), Angle::ZERO),
    width: Angle::ZERO,
};

/// `N` beams at the robot's centre, evenly all round, the first one looking back.
const fn all_round<const N: usize>() -> Vec<Mount, N> {
    let mut mounts = [MIDDLE; N];
    let mut i = 0;
    while i < N {
        let turn = ((i as u64) << 32) / (N as u64);
        mounts[i].pose.heading =
            Angle::from_bits((turn as u32 as i32).wrapping_add(Angle::HALF.bits()));
        i += 1;
    }
    Vec::from_array(mounts)
}
