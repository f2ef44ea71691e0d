//! cone8. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal --sensors cone8 --speed 1 --seeds 1 --only memory,map,field,heading,steer,barrier,speed,supervisor --seed 4 --sigma 0.04 --evaluations 160`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("0.9341");
    params.memory.arc = n!("0.2264");
    params.memory.disproof = m!("0.0342");
    params.memory.support = m!("0.0612");
    params.memory.nearer = m!("0.0082");
    params.map.look = m!("1.744");
    params.map.hard = m!("0.0113");
    params.map.soft = m!("0.1361");
    params.map.turning = m!("0.0237");
    params.field.wall_distance = m!("0.1438");
    params.field.wall = n!("25.1505");
    params.field.halo_distance = m!("0.08");
    params.field.ahead = m!("0.8066");
    params.field.shun = 14;
    params.heading.least = m!("0.1643");
    params.heading.toward = n!("1.6097");
    params.heading.ahead = n!("0.4269");
    params.heading.commitment = n!("0.2846");
    params.heading.soft = n!("1.6051");
    params.heading.hard = n!("1.4481");
    params.heading.neighbours = n!("0.2237");
    params.steer.near = m!("0.298");
    params.steer.far = m!("0.8712");
    params.steer.soft_bonus = m!("0.15");
    params.steer.rate = n!("4.5659");
    params.steer.yaw_acceleration = n!("6.2309");
    params.steer.flank = m!("0.0482");
    params.supervisor.enter = m!("0.4734");
    params.supervisor.enter_time = s!("0.2299");
    params.supervisor.path_margin = m!("0.0994");
    params.supervisor.leave = m!("0.0464");
    params.supervisor.escape = m!("0.2233");
    params.supervisor.stuck = 4;
    params.supervisor.still = 11;
    params.barrier.margin = m!("0.0182");
    params.barrier.braking = n!("0.6671");
    params.barrier.share = n!("0.8759");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.037"), SpeedShare::lit("0.374"), SpeedShare::lit("0.601"), SpeedShare::lit("0.815"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
