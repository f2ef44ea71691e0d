//! cone16. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --worlds generated:barn --numbers dev --numbers 301-899/6,305-899/6 --task goal,unmapped,path --sensors cone16 --speed 1 --seeds 4 --only memory.disproof,barrier.margin --seed 72 --sigma 0.08 --evaluations 24`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.2638");
    params.memory.arc = n!("0.2121");
    params.memory.disproof = m!("0.0237");
    params.memory.support = m!("0.0402");
    params.memory.nearer = m!("0.0077");
    params.map.look = m!("1.3905");
    params.map.hard = m!("0.019");
    params.map.soft = m!("0.0479");
    params.map.turning = m!("0.0214");
    params.field.wall_distance = m!("0.1936");
    params.field.wall = n!("34.3055");
    params.field.halo_distance = m!("0.074");
    params.field.ahead = m!("0.756");
    params.field.shun = 3;
    params.heading.least = m!("0.1135");
    params.heading.toward = n!("1.0035");
    params.heading.ahead = n!("0.7574");
    params.heading.commitment = n!("0.0594");
    params.heading.soft = n!("0.3914");
    params.heading.hard = n!("1.2158");
    params.heading.neighbours = n!("0.2788");
    params.steer.near = m!("0.3403");
    params.steer.far = m!("1.0736");
    params.steer.soft_bonus = m!("0.1453");
    params.steer.rate = n!("3.4109");
    params.steer.yaw_acceleration = n!("5.0582");
    params.steer.flank = m!("0.0195");
    params.supervisor.enter = m!("0.5074");
    params.supervisor.enter_time = s!("0.4559");
    params.supervisor.path_margin = m!("0.175");
    params.supervisor.leave = m!("0.0573");
    params.supervisor.escape = m!("0.2326");
    params.supervisor.stuck = 3;
    params.supervisor.still = 11;
    params.barrier.margin = m!("0.0179");
    params.barrier.braking = n!("0.6462");
    params.barrier.share = n!("0.9768");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("31.5"), Deflection::lit("43.8984"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.059"), SpeedShare::lit("0.288"), SpeedShare::lit("0.696"), SpeedShare::lit("0.805"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
