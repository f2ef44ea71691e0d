//! cone8. Written by
//! `host-sim tune --worlds generated:barn --numbers dev --task goal --sensors cone8 --speed 1 --seeds 1 --only memory,map,barrier,steer,heading,speed,supervisor --seed 2 --sigma 0.08 --evaluations 300`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.0222");
    params.memory.arc = n!("0.2541");
    params.memory.disproof = m!("0.0597");
    params.memory.support = m!("0.0576");
    params.memory.nearer = m!("0.0091");
    params.map.look = m!("1.689");
    params.map.hard = m!("0.0082");
    params.map.soft = m!("0.1118");
    params.map.turning = m!("0.0249");
    params.field.wall_distance = m!("0.1686");
    params.field.wall = n!("25.03");
    params.field.halo_distance = m!("0.18");
    params.field.halo = n!("3.18");
    params.field.ahead = m!("0.7");
    params.field.shun = 12;
    params.heading.least = m!("0.1084");
    params.heading.toward = n!("1.0843");
    params.heading.ahead = n!("0.2549");
    params.heading.commitment = n!("0.1211");
    params.heading.soft = n!("1.7715");
    params.heading.hard = n!("1.4844");
    params.heading.neighbours = n!("0.1662");
    params.steer.near = m!("0.2622");
    params.steer.far = m!("0.7552");
    params.steer.soft_bonus = m!("0.2179");
    params.steer.rate = n!("4.5774");
    params.steer.yaw_acceleration = n!("5.4848");
    params.steer.flank = m!("0.0517");
    params.supervisor.enter = m!("0.5945");
    params.supervisor.enter_time = s!("0.3379");
    params.supervisor.path_margin = m!("0.1189");
    params.supervisor.leave = m!("0.0663");
    params.supervisor.escape = m!("0.3269");
    params.supervisor.stuck = 4;
    params.supervisor.still = 11;
    params.barrier.margin = m!("0.0163");
    params.barrier.braking = n!("0.73");
    params.barrier.share = n!("0.9752");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.044"), SpeedShare::lit("0.383"), SpeedShare::lit("0.568"), SpeedShare::lit("0.807"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
