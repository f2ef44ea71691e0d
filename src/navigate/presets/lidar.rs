//! lidar720. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal,unmapped --sensors lidar720 --speed 1 --seeds 1 --seed 32 --sigma 0.05 --evaluations 140`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.6999");
    params.memory.arc = n!("0.4393");
    params.memory.disproof = m!("0.0226");
    params.memory.support = m!("0.0459");
    params.memory.nearer = m!("0.0258");
    params.map.look = m!("1.6984");
    params.map.hard = m!("0.0158");
    params.map.soft = m!("0.0692");
    params.map.turning = m!("0.0197");
    params.field.wall_distance = m!("0.1998");
    params.field.wall = n!("31.426");
    params.field.halo_distance = m!("0.0727");
    params.field.ahead = m!("0.6003");
    params.field.shun = 9;
    params.heading.least = m!("0.0787");
    params.heading.toward = n!("0.8889");
    params.heading.ahead = n!("0.3821");
    params.heading.commitment = n!("0.0644");
    params.heading.soft = n!("0.8868");
    params.heading.hard = n!("0.7956");
    params.heading.neighbours = n!("0.1852");
    params.steer.near = m!("0.271");
    params.steer.far = m!("0.9388");
    params.steer.soft_bonus = m!("0.1623");
    params.steer.rate = n!("3.6012");
    params.steer.yaw_acceleration = n!("5.2113");
    params.steer.flank = m!("0.0131");
    params.supervisor.enter = m!("0.4212");
    params.supervisor.enter_time = s!("0.4716");
    params.supervisor.path_margin = m!("0.1478");
    params.supervisor.leave = m!("0.0677");
    params.supervisor.escape = m!("0.2828");
    params.supervisor.stuck = 4;
    params.supervisor.still = 9;
    params.barrier.margin = m!("0.0205");
    params.barrier.braking = n!("0.9587");
    params.barrier.share = n!("0.9226");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("32.8008"), Deflection::lit("45.6992"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.045"), SpeedShare::lit("0.27"), SpeedShare::lit("0.561"), SpeedShare::lit("0.796"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
