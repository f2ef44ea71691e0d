//! lidar720. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal,unmapped --sensors lidar720 --speed 1 --seeds 1 --only memory,map,field,heading,steer,barrier,speed,supervisor --seed 5 --sigma 0.05 --evaluations 100`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.8349");
    params.memory.arc = n!("0.5194");
    params.memory.disproof = m!("0.037");
    params.memory.support = m!("0.0477");
    params.memory.nearer = m!("0.0279");
    params.map.look = m!("1.6726");
    params.map.hard = m!("0.0162");
    params.map.soft = m!("0.0717");
    params.map.turning = m!("0.0226");
    params.field.wall_distance = m!("0.1873");
    params.field.wall = n!("27.023");
    params.field.halo_distance = m!("0.1678");
    params.field.halo = n!("2.8875");
    params.field.ahead = m!("0.6474");
    params.field.shun = 10;
    params.heading.least = m!("0.0757");
    params.heading.toward = n!("0.7376");
    params.heading.ahead = n!("0.5265");
    params.heading.commitment = n!("0.0933");
    params.heading.soft = n!("0.8298");
    params.heading.hard = n!("0.7376");
    params.heading.neighbours = n!("0.1639");
    params.steer.near = m!("0.2347");
    params.steer.far = m!("0.9726");
    params.steer.soft_bonus = m!("0.1809");
    params.steer.rate = n!("3.1484");
    params.steer.yaw_acceleration = n!("5.0029");
    params.steer.flank = m!("0.0287");
    params.supervisor.enter = m!("0.5024");
    params.supervisor.enter_time = s!("0.4745");
    params.supervisor.path_margin = m!("0.137");
    params.supervisor.leave = m!("0.0654");
    params.supervisor.escape = m!("0.3086");
    params.supervisor.stuck = 4;
    params.supervisor.still = 9;
    params.barrier.margin = m!("0.0169");
    params.barrier.braking = n!("0.9492");
    params.barrier.share = n!("0.8798");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.054"), SpeedShare::lit("0.283"), SpeedShare::lit("0.604"), SpeedShare::lit("0.785"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
