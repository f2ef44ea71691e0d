//! cone16. Written by
//! `host-sim tune --worlds generated:barn --numbers 1 --task path --sensors cone16 --speed 1 --seeds 1 --seed 1 --sigma 0.05 --evaluations 1`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.157");
    params.memory.arc = n!("0.4553");
    params.memory.disproof = m!("0.0437");
    params.memory.support = m!("0.05");
    params.memory.nearer = m!("0.02");
    params.map.look = m!("1.598");
    params.map.hard = m!("0.0156");
    params.map.soft = m!("0.0581");
    params.map.turning = m!("0.018");
    params.field.wall_distance = m!("0.1686");
    params.field.wall = n!("25.03");
    params.field.halo_distance = m!("0.18");
    params.field.halo = n!("3.18");
    params.field.ahead = m!("0.7");
    params.field.shun = 12;
    params.heading.least = m!("0.08");
    params.heading.toward = n!("0.9799");
    params.heading.ahead = n!("0.5124");
    params.heading.commitment = n!("0.1328");
    params.heading.soft = n!("0.9458");
    params.heading.hard = n!("0.7888");
    params.heading.neighbours = n!("0.1071");
    params.steer.near = m!("0.2");
    params.steer.far = m!("0.9");
    params.steer.soft_bonus = m!("0.15");
    params.steer.rate = n!("3");
    params.steer.yaw_acceleration = n!("5");
    params.steer.flank = m!("0.036");
    params.supervisor.enter = m!("0.5375");
    params.supervisor.enter_time = s!("0.3893");
    params.supervisor.path_margin = m!("0.13");
    params.supervisor.leave = m!("0.06");
    params.supervisor.escape = m!("0.3728");
    params.supervisor.stuck = 3;
    params.supervisor.still = 9;
    params.barrier.margin = m!("0.02");
    params.barrier.braking = n!("1");
    params.barrier.share = n!("0.887");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.05"), SpeedShare::lit("0.3"), SpeedShare::lit("0.6"), SpeedShare::lit("0.8"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
