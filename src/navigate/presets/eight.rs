//! cone8. Written by
//! `host-sim tune --worlds generated:barn --numbers dev --task goal --sensors cone8 --speed 1 --seeds 1 --only memory,map,barrier,steer,heading,speed --seed 1 --sigma 0.08 --evaluations 400`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.1168");
    params.memory.arc = n!("0.3151");
    params.memory.disproof = m!("0.0587");
    params.memory.support = m!("0.0582");
    params.memory.nearer = m!("0.0162");
    params.map.look = m!("1.6851");
    params.map.hard = m!("0.0134");
    params.map.soft = m!("0.0843");
    params.map.turning = m!("0.0269");
    params.field.wall_distance = m!("0.1686");
    params.field.wall = n!("25.03");
    params.field.halo_distance = m!("0.18");
    params.field.halo = n!("3.18");
    params.field.ahead = m!("0.7");
    params.field.shun = 12;
    params.heading.least = m!("0.0893");
    params.heading.toward = n!("0.6864");
    params.heading.ahead = n!("0.2697");
    params.heading.commitment = n!("0.2567");
    params.heading.soft = n!("0.6372");
    params.heading.hard = n!("1.168");
    params.heading.neighbours = n!("0.0398");
    params.steer.near = m!("0.2832");
    params.steer.far = m!("0.8949");
    params.steer.soft_bonus = m!("0.2037");
    params.steer.rate = n!("4.0538");
    params.steer.yaw_acceleration = n!("5.6506");
    params.steer.flank = m!("0.0324");
    params.supervisor.enter = m!("0.5375");
    params.supervisor.enter_time = s!("0.3893");
    params.supervisor.path_margin = m!("0.12");
    params.supervisor.leave = m!("0.06");
    params.supervisor.escape = m!("0.3728");
    params.supervisor.stuck = 3;
    params.supervisor.still = 9;
    params.barrier.margin = m!("0.0051");
    params.barrier.braking = n!("0.8774");
    params.barrier.share = n!("0.9611");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30"), Deflection::lit("45"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.025"), SpeedShare::lit("0.35"), SpeedShare::lit("0.584"), SpeedShare::lit("0.824"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
