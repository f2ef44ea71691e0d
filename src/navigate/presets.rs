//! Complete settings to start from: change what differs on your robot, then make them ready with
//! [`NavigatorParams::setup`].

use super::{
    BarrierParams, DoubtParams, FieldParams, Footprint, HeadingParams, HealthParams, MapParams,
    MemoryParams, NavigatorParams, RangeSet, SteerParams, SupervisorParams,
};
use crate::geometry::Point;
use crate::params::{Follower, Limits};
use crate::presets::FOLLOWER;
use crate::tables::clutter::CLUTTER;
use crate::units::{Angle, MetresPerSecond, PerMetre};

/// Numbers that are parsed while this compiles: at run time the parser would cost 20 KiB of flash.
macro_rules! n {
    ($text:literal) => {
        const { fixed::types::I16F16::lit($text) }
    };
}

macro_rules! m {
    ($text:literal) => {
        const { crate::units::Metres::lit($text) }
    };
}

macro_rules! s {
    ($text:literal) => {
        const { crate::units::Seconds::lit($text) }
    };
}

// What tuning found for each kind of sensors.
pub mod eight;
pub mod five;
pub mod lidar;
pub mod sixteen;

/// The robot of the BARN benchmark (a Clearpath Jackal, 0.508 × 0.430 m), 1 m/s, 20 Hz with 50 ms latency, `N` cones or
/// lidar sectors over 270°.
pub fn jackal<const N: usize>() -> NavigatorParams<N> {
    sixteen::tuned(base())
}

/// [`jackal`] with a lidar that is reduced to `N` sectors: its echoes have a direction.
pub fn jackal_lidar<const N: usize>() -> NavigatorParams<N> {
    let mut params = lidar::tuned(base());
    // Twice as many points: a tick costs more, and the field must not starve.
    params.field.tick = 900;
    params
}

/// [`jackal`] with 8 cones side by side over 270°.
pub fn jackal_eight<const N: usize>() -> NavigatorParams<N> {
    eight::tuned(base())
}

/// [`jackal`] with 5 ultrasonic sensors of 30°, 45° apart: between them and behind nothing is seen.
pub fn ultrasonic_five<const N: usize>() -> NavigatorParams<N> {
    const FIELD: Angle = Angle::from_bits(-0x6000_0000);
    let mut params = base();
    params.sensors = RangeSet::sectors(Point::default(), FIELD, m!("4"), s!("0.2"));
    for mount in &mut params.sensors.mounts {
        mount.width = const { Angle::deg("30") };
    }
    five::tuned(params)
}

/// What tuning leaves alone.
fn base<const N: usize>() -> NavigatorParams<N> {
    NavigatorParams {
        footprint: Footprint::Rectangle {
            front: m!("0.254"),
            rear: m!("0.254"),
            half_width: m!("0.215"),
        },
        limits: Limits {
            speed: const { MetresPerSecond::lit("1") },
            yaw_rate: n!("3"),
            acceleration: n!("2.5"),
            yaw_acceleration: n!("8"),
            wheel_speed: const { MetresPerSecond::lit("2.5") },
        },
        reverse: const { MetresPerSecond::lit("0.3") },
        period: s!("0.05"),
        latency: s!("0.05"),
        sensors: RangeSet::sectors(
            Point::default(),
            const { Angle::from_bits(-0x4000_0000) },
            m!("4"),
            s!("0.2"),
        ),
        health: HealthParams {
            near: m!("2.5"),
            doubts: 80,
            unproven: 72,
            ahead: const { Angle::deg("30") },
            speed: const { MetresPerSecond::lit("0.5") },
            lend: m!("0.5"),
        },
        doubt: DoubtParams {
            careful: const { MetresPerSecond::lit("1") },
            braking: n!("2"),
        },
        memory: MemoryParams {
            insert: m!("1.157"),
            arc: n!("0.4553"),
            disproof: m!("0.0437"),
            support: m!("0.05"),
            nearer: m!("0.02"),
            snap: false,
            keep: m!("2.6"),
            lifetime: 1260,
        },
        map: MapParams {
            look: m!("1.598"),
            hard: m!("0.01564"),
            soft: m!("0.05806"),
            turning: m!("0.018"),
        },
        field: FieldParams {
            wall_distance: m!("0.1686"),
            wall: n!("25.03"),
            halo_distance: m!("0.07"),
            ahead: m!("0.7"),
            straight: const { Angle::deg("25") },
            shun: 12,
            budget: 180,
            tick: 440,
            refresh: 6,
        },
        heading: HeadingParams {
            least: m!("0.08"),
            toward: n!("0.9799"),
            ahead: n!("0.5124"),
            commitment: n!("0.1328"),
            soft: n!("0.9458"),
            hard: n!("0.7888"),
            neighbours: n!("0.1071"),
        },
        steer: SteerParams {
            tables: &CLUTTER,
            near: m!("0.2"),
            far: m!("0.9"),
            soft_bonus: m!("0.15"),
            rate: n!("3"),
            yaw_acceleration: n!("5"),
            flank: m!("0.036"),
        },
        // Back on a path a third sooner than where nothing stands.
        follower: Follower {
            approach_gain: const { PerMetre::lit("2.7") },
            ..FOLLOWER
        },
        supervisor: SupervisorParams {
            enter: m!("0.5375"),
            enter_time: s!("0.3893"),
            path_margin: m!("0.12"),
            leave: m!("0.06"),
            dwell: 5,
            stuck: 3,
            still: 9,
            escape: m!("0.3728"),
            escape_ticks: 51,
            progress: m!("0.5"),
            patience: 81,
            pause: 20,
            strikes: 12,
            give_up: 820,
            arrival: m!("0.12"),
        },
        barrier: BarrierParams {
            margin: m!("0.02"),
            behind: m!("0.03"),
            braking: n!("1"),
            share: n!("0.887"),
            gate: m!("0.015"),
        },
    }
}
