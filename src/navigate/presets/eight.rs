//! cone8. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal --sensors cone8 --speed 1 --seeds 2 --seed 41 --sigma 0.04 --evaluations 180`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("0.7612");
    params.memory.arc = n!("0.4016");
    params.memory.disproof = m!("0.0458");
    params.memory.support = m!("0.0579");
    params.memory.nearer = m!("0.0115");
    params.map.look = m!("1.7622");
    params.map.hard = m!("0.016");
    params.map.soft = m!("0.1332");
    params.map.turning = m!("0.0238");
    params.field.wall_distance = m!("0.1394");
    params.field.wall = n!("30.6784");
    params.field.halo_distance = m!("0.0798");
    params.field.ahead = m!("0.8111");
    params.field.shun = 10;
    params.heading.least = m!("0.1916");
    params.heading.toward = n!("1.5834");
    params.heading.ahead = n!("0.3966");
    params.heading.commitment = n!("0.3044");
    params.heading.soft = n!("1.5415");
    params.heading.hard = n!("1.4942");
    params.heading.neighbours = n!("0.1797");
    params.steer.near = m!("0.307");
    params.steer.far = m!("0.8885");
    params.steer.soft_bonus = m!("0.1271");
    params.steer.rate = n!("4.3582");
    params.steer.yaw_acceleration = n!("5.828");
    params.steer.flank = m!("0.0444");
    params.supervisor.enter = m!("0.5082");
    params.supervisor.enter_time = s!("0.3012");
    params.supervisor.path_margin = m!("0.1168");
    params.supervisor.leave = m!("0.0429");
    params.supervisor.escape = m!("0.2342");
    params.supervisor.stuck = 4;
    params.supervisor.still = 11;
    params.barrier.margin = m!("0.0218");
    params.barrier.braking = n!("0.6791");
    params.barrier.share = n!("0.8802");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("29.1992"), Deflection::lit("45.5"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.034"), SpeedShare::lit("0.387"), SpeedShare::lit("0.623"), SpeedShare::lit("0.818"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
