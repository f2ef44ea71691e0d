//! ultrasonic5. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal --sensors ultrasonic5 --speed 1 --seeds 1 --only memory,map,field,heading,steer,barrier,speed,supervisor --seed 6 --sigma 0.06 --evaluations 200`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.0719");
    params.memory.arc = n!("0.3599");
    params.memory.disproof = m!("0.0515");
    params.memory.support = m!("0.0571");
    params.memory.nearer = m!("0.0149");
    params.map.look = m!("1.6716");
    params.map.hard = m!("0.0123");
    params.map.soft = m!("0.0757");
    params.map.turning = m!("0.0127");
    params.field.wall_distance = m!("0.1587");
    params.field.wall = n!("26.8306");
    params.field.halo_distance = m!("0.1994");
    params.field.halo = n!("4.3148");
    params.field.ahead = m!("0.598");
    params.field.shun = 12;
    params.heading.least = m!("0.1201");
    params.heading.toward = n!("0.424");
    params.heading.ahead = n!("0.2667");
    params.heading.commitment = n!("0.0398");
    params.heading.soft = n!("1.4091");
    params.heading.hard = n!("0.7319");
    params.heading.neighbours = n!("0.2047");
    params.steer.near = m!("0.2573");
    params.steer.far = m!("0.8929");
    params.steer.soft_bonus = m!("0.0745");
    params.steer.rate = n!("2.8423");
    params.steer.yaw_acceleration = n!("5.4479");
    params.steer.flank = m!("0.0481");
    params.supervisor.enter = m!("0.4547");
    params.supervisor.enter_time = s!("0.539");
    params.supervisor.path_margin = m!("0.1439");
    params.supervisor.leave = m!("0.069");
    params.supervisor.escape = m!("0.3095");
    params.supervisor.stuck = 2;
    params.supervisor.still = 9;
    params.barrier.margin = m!("0.0205");
    params.barrier.braking = n!("1.3571");
    params.barrier.share = n!("0.8511");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.042"), SpeedShare::lit("0.308"), SpeedShare::lit("0.58"), SpeedShare::lit("0.775"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
