//! cone16. Written by
//! `host-sim tune --worlds worlds-dev.jsonl.gz --numbers dev --task goal,unmapped,path --sensors cone16 --speed 1 --seeds 1 --seed 31 --sigma 0.04 --evaluations 260`

use crate::navigate::NavigatorParams;
use crate::tables::clutter::Peaks;
use crate::tables::coarse::{CoarseTwin, Deflection, SpeedShare};

/// Puts the tuned numbers into settings.
#[rustfmt::skip]
pub(super) fn tuned<const N: usize>(mut params: NavigatorParams<N>) -> NavigatorParams<N> {
    params.memory.insert = m!("1.3141");
    params.memory.arc = n!("0.2");
    params.memory.disproof = m!("0.0254");
    params.memory.support = m!("0.0345");
    params.memory.nearer = m!("0.0073");
    params.map.look = m!("1.4461");
    params.map.hard = m!("0.0221");
    params.map.soft = m!("0.0374");
    params.map.turning = m!("0.0249");
    params.field.wall_distance = m!("0.1948");
    params.field.wall = n!("32.9459");
    params.field.halo_distance = m!("0.0799");
    params.field.ahead = m!("0.796");
    params.field.shun = 8;
    params.heading.least = m!("0.1376");
    params.heading.toward = n!("1.0612");
    params.heading.ahead = n!("0.763");
    params.heading.commitment = n!("0.1087");
    params.heading.soft = n!("0.4057");
    params.heading.hard = n!("1.4992");
    params.heading.neighbours = n!("0.231");
    params.steer.near = m!("0.2971");
    params.steer.far = m!("1.0036");
    params.steer.soft_bonus = m!("0.1157");
    params.steer.rate = n!("3.1067");
    params.steer.yaw_acceleration = n!("5.0655");
    params.steer.flank = m!("0.0153");
    params.supervisor.enter = m!("0.4619");
    params.supervisor.enter_time = s!("0.3835");
    params.supervisor.path_margin = m!("0.1843");
    params.supervisor.leave = m!("0.0614");
    params.supervisor.escape = m!("0.2577");
    params.supervisor.stuck = 3;
    params.supervisor.still = 10;
    params.barrier.margin = m!("0.0205");
    params.barrier.braking = n!("0.7412");
    params.barrier.share = n!("1");
    params.steer.tables = &TABLES;
    params
}

/// Peaks of its rule tables.
#[rustfmt::skip]
pub const PEAKS: Peaks = Peaks {
    deflection: [Deflection::lit("0"), Deflection::lit("30.6016"), Deflection::lit("43"), Deflection::lit("70"), Deflection::lit("90")],
    speed: [SpeedShare::lit("0.062"), SpeedShare::lit("0.313"), SpeedShare::lit("0.707"), SpeedShare::lit("0.806"), SpeedShare::lit("1")],
};

static TABLES: CoarseTwin = PEAKS.tables();
