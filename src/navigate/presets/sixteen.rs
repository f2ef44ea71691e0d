//! cone16. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal,unmapped,path --sensors cone16 --speed 1 --seeds 1 --seed 22 --sigma 0.035 --evaluations 330`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.3104");
    params.memory.arc = n!("0.2323");
    params.memory.disproof = m!("0.0304");
    params.memory.support = m!("0.035");
    params.memory.nearer = m!("0.0135");
    params.map.look = m!("1.4835");
    params.map.hard = m!("0.0229");
    params.map.soft = m!("0.043");
    params.map.turning = m!("0.021");
    params.field.wall_distance = m!("0.1913");
    params.field.wall = n!("30.0762");
    params.field.halo_distance = m!("0.1923");
    params.field.halo = n!("2.2556");
    params.field.ahead = m!("0.7577");
    params.field.shun = 8;
    params.heading.least = m!("0.1324");
    params.heading.toward = n!("1.0974");
    params.heading.ahead = n!("0.8035");
    params.heading.commitment = n!("0.1552");
    params.heading.soft = n!("0.5246");
    params.heading.hard = n!("1.409");
    params.heading.neighbours = n!("0.0934");
    params.steer.near = m!("0.3123");
    params.steer.far = m!("1.0584");
    params.steer.soft_bonus = m!("0.1154");
    params.steer.rate = n!("3.322");
    params.steer.yaw_acceleration = n!("4.7406");
    params.steer.flank = m!("0.0221");
    params.supervisor.enter = m!("0.4406");
    params.supervisor.enter_time = s!("0.4314");
    params.supervisor.path_margin = m!("0.2");
    params.supervisor.leave = m!("0.0513");
    params.supervisor.escape = m!("0.2652");
    params.supervisor.stuck = 3;
    params.supervisor.still = 9;
    params.barrier.margin = m!("0.02");
    params.barrier.braking = n!("0.7312");
    params.barrier.share = n!("0.997");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("31.8984"), Deflection::lit("43"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.052"), SpeedShare::lit("0.311"), SpeedShare::lit("0.704"), SpeedShare::lit("0.81"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
