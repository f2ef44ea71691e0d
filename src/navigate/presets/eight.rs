//! cone8. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal --sensors cone8 --speed 1 --seeds 1 --only memory,map,barrier,steer,heading,speed,supervisor,field --seed 3 --sigma 0.05 --evaluations 160`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("0.9969");
    params.memory.arc = n!("0.2");
    params.memory.disproof = m!("0.0435");
    params.memory.support = m!("0.0656");
    params.memory.nearer = m!("0.0051");
    params.map.look = m!("1.6782");
    params.map.hard = m!("0.0122");
    params.map.soft = m!("0.1253");
    params.map.turning = m!("0.0217");
    params.field.wall_distance = m!("0.1371");
    params.field.wall = n!("19.3629");
    params.field.halo_distance = m!("0.1678");
    params.field.halo = n!("3.6316");
    params.field.ahead = m!("0.8218");
    params.field.shun = 15;
    params.heading.least = m!("0.1469");
    params.heading.toward = n!("1.6353");
    params.heading.ahead = n!("0.5054");
    params.heading.commitment = n!("0.1653");
    params.heading.soft = n!("1.7082");
    params.heading.hard = n!("1.2788");
    params.heading.neighbours = n!("0.2528");
    params.steer.near = m!("0.3018");
    params.steer.far = m!("0.8229");
    params.steer.soft_bonus = m!("0.1774");
    params.steer.rate = n!("5.0283");
    params.steer.yaw_acceleration = n!("5.7908");
    params.steer.flank = m!("0.0516");
    params.supervisor.enter = m!("0.4573");
    params.supervisor.enter_time = s!("0.1975");
    params.supervisor.path_margin = m!("0.1105");
    params.supervisor.leave = m!("0.0617");
    params.supervisor.escape = m!("0.2975");
    params.supervisor.stuck = 4;
    params.supervisor.still = 11;
    params.barrier.margin = m!("0.0178");
    params.barrier.braking = n!("0.6942");
    params.barrier.share = n!("0.902");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.039"), SpeedShare::lit("0.38"), SpeedShare::lit("0.585"), SpeedShare::lit("0.814"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
