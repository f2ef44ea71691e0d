//! cone16. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal,unmapped,path --sensors cone16 --speed 1 --seeds 2 --only barrier --seed 9 --sigma 0.04 --evaluations 36`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.2321");
    params.memory.arc = n!("0.2086");
    params.memory.disproof = m!("0.0336");
    params.memory.support = m!("0.0362");
    params.memory.nearer = m!("0.0171");
    params.map.look = m!("1.5318");
    params.map.hard = m!("0.0145");
    params.map.soft = m!("0.0504");
    params.map.turning = m!("0.0147");
    params.field.wall_distance = m!("0.1703");
    params.field.wall = n!("27.5361");
    params.field.halo_distance = m!("0.1736");
    params.field.halo = n!("2.1053");
    params.field.ahead = m!("0.6924");
    params.field.shun = 11;
    params.heading.least = m!("0.126");
    params.heading.toward = n!("1.0823");
    params.heading.ahead = n!("0.6256");
    params.heading.commitment = n!("0.1145");
    params.heading.soft = n!("0.7602");
    params.heading.hard = n!("1.3033");
    params.heading.neighbours = n!("0.0927");
    params.steer.near = m!("0.2866");
    params.steer.far = m!("0.8075");
    params.steer.soft_bonus = m!("0.1796");
    params.steer.rate = n!("3.8319");
    params.steer.yaw_acceleration = n!("4.6979");
    params.steer.flank = m!("0.0297");
    params.supervisor.enter = m!("0.4567");
    params.supervisor.enter_time = s!("0.3522");
    params.supervisor.path_margin = m!("0.1637");
    params.supervisor.leave = m!("0.0588");
    params.supervisor.escape = m!("0.2545");
    params.supervisor.stuck = 3;
    params.supervisor.still = 8;
    params.barrier.margin = m!("0.0207");
    params.barrier.braking = n!("0.6952");
    params.barrier.share = n!("0.988");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.036"), SpeedShare::lit("0.277"), SpeedShare::lit("0.69"), SpeedShare::lit("0.809"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
