//! ultrasonic5. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal --sensors ultrasonic5 --speed 1 --seeds 1 --only memory,map,field,heading,steer,barrier,speed,supervisor --seed 8 --sigma 0.04 --evaluations 160`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("0.9941");
    params.memory.arc = n!("0.3998");
    params.memory.disproof = m!("0.0528");
    params.memory.support = m!("0.0574");
    params.memory.nearer = m!("0.016");
    params.map.look = m!("1.7092");
    params.map.hard = m!("0.0132");
    params.map.soft = m!("0.0889");
    params.map.turning = m!("0.0079");
    params.field.wall_distance = m!("0.1681");
    params.field.wall = n!("28.4592");
    params.field.halo_distance = m!("0.08");
    params.field.ahead = m!("0.6098");
    params.field.shun = 8;
    params.heading.least = m!("0.1218");
    params.heading.toward = n!("0.4666");
    params.heading.ahead = n!("0.2747");
    params.heading.commitment = n!("0.0456");
    params.heading.soft = n!("1.3867");
    params.heading.hard = n!("0.8557");
    params.heading.neighbours = n!("0.2393");
    params.steer.near = m!("0.2327");
    params.steer.far = m!("0.9115");
    params.steer.soft_bonus = m!("0.0966");
    params.steer.rate = n!("2.5405");
    params.steer.yaw_acceleration = n!("5.7344");
    params.steer.flank = m!("0.0497");
    params.supervisor.enter = m!("0.4366");
    params.supervisor.enter_time = s!("0.5474");
    params.supervisor.path_margin = m!("0.147");
    params.supervisor.leave = m!("0.062");
    params.supervisor.escape = m!("0.3533");
    params.supervisor.stuck = 2;
    params.supervisor.still = 10;
    params.barrier.margin = m!("0.021");
    params.barrier.braking = n!("1.3369");
    params.barrier.share = n!("0.8466");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.042"), SpeedShare::lit("0.285"), SpeedShare::lit("0.598"), SpeedShare::lit("0.768"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
