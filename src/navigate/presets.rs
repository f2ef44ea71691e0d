//! Complete settings to start from: change what differs on your robot, then make them ready with
//! [`NavigatorParams::setup`].

use super::{
    BarrierParams, FieldParams, Footprint, HeadingParams, MapParams, MemoryParams, NavigatorParams,
    RangeSet, SteerParams, SupervisorParams,
};
use crate::geometry::Point;
use crate::params::Limits;
use crate::presets::FOLLOWER;
use crate::tables::clutter::CLUTTER;
use crate::units::{Angle, Metres, MetresPerSecond, Seconds};
use fixed::types::I16F16;

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

/// The robot of the BARN benchmark (a Clearpath Jackal, 0.508 × 0.430 m), 1 m/s, 20 Hz with 50 ms latency, `N` cones or
/// lidar sectors over 270°.
pub fn jackal<const N: usize>() -> NavigatorParams<N> {
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
        period: const { Seconds::lit("0.05") },
        latency: const { Seconds::lit("0.05") },
        sensors: RangeSet::sectors(
            Point::default(),
            const { Angle::from_bits(-0x4000_0000) },
            m!("4"),
            const { Seconds::lit("0.2") },
        ),
        memory: MemoryParams {
            insert: m!("1.157"),
            arc: n!("0.4553"),
            disproof: m!("0.0437"),
            support: m!("0.05"),
            nearer: m!("0.02"),
            snap: false,
            keep: m!("3"),
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
            halo_distance: m!("0.18"),
            halo: n!("3.18"),
            ahead: m!("0.7"),
            straight: const { Angle::deg("25") },
            shun: 12,
            budget: 150,
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
        follower: FOLLOWER,
        supervisor: SupervisorParams {
            enter: m!("0.5375"),
            enter_time: const { Seconds::lit("0.3893") },
            path_margin: m!("0.12"),
            leave: m!("0.06"),
            dwell: 5,
            stuck: 3,
            still: 9,
            escape: m!("0.3728"),
            escape_ticks: 51,
            progress: m!("0.4"),
            patience: 90,
            pause: 20,
            strikes: 8,
            give_up: 1200,
            arrival: m!("0.12"),
        },
        barrier: BarrierParams {
            margin: m!("0.02"),
            braking: n!("1"),
            share: n!("0.887"),
            gate: m!("0.015"),
        },
    }
}

/// [`jackal`] with a lidar: its echoes have a direction, so that points are worth keeping from farther away.
pub fn jackal_lidar<const N: usize>() -> NavigatorParams<N> {
    let jackal = jackal();
    NavigatorParams {
        memory: MemoryParams {
            insert: m!("2"),
            ..jackal.memory
        },
        ..jackal
    }
}
