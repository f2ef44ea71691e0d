//! Which runs are compared, and which are counted.

use crate::synthetic;
use crate::tape::{Tape, record};
use host_sim::control::{AxisName, CoarseName, InputName, IntegratorName, LawName, TablesName};
use host_sim::robot::RING_SIZES;
use host_sim::scenario::{BUILT_IN, Scenario, load};

/// Every built-in scenario as it stands, with this seed.
pub fn plain(seed: u64) -> anyhow::Result<Vec<Tape>> {
    each(seed, |_| {})
}

/// Every built-in scenario with another ring, law, table set and noise a seed.
pub fn varied(seed: u64) -> anyhow::Result<Vec<Tape>> {
    each(seed, |scenario| {
        // Without a common divisor every ring meets every variant and every noise.
        if let Some(size) = RING_SIZES.get((seed % 5) as usize) {
            scenario.sensors.count = *size;
        }
        let control = &mut scenario.control;
        match seed % 7 {
            1 => control.law = LawName::Paper,
            2 => control.tables = Some(TablesName::Printed),
            3 => control.speed_axis = AxisName::Literal,
            4 => control.table_7_3 = CoarseName::Printed,
            5 => control.table_7_4_input = InputName::Bearing,
            6 => control.integrator = Some(IntegratorName::Euler),
            _ => {}
        }
        if seed % 3 == 1 {
            scenario.noise.range = 0.02;
            scenario.noise.dropout = 0.05;
            scenario.noise.wheel_scale = 0.001;
            scenario.noise.wheel_slip = 0.01;
        }
    })
}

/// What no robot ever sees.
pub fn invented() -> anyhow::Result<Vec<Tape>> {
    let mut tapes = synthetic::contrived()?;
    for seed in 1..=100 {
        tapes.push(synthetic::hostile(seed)?);
    }
    Ok(tapes)
}

/// Runs for the comparison: at least `ticks` in all, or the plain ones and the invented ones if those are more.
pub fn compared(ticks: usize) -> anyhow::Result<Vec<Tape>> {
    let mut tapes = plain(1)?;
    tapes.extend(invented()?);
    let mut seed = 2;
    let mut so_far: usize = tapes.iter().map(Tape::ticks).sum();
    while so_far < ticks {
        let more = varied(seed)?;
        so_far += more.iter().map(Tape::ticks).sum::<usize>();
        tapes.extend(more);
        seed += 1;
    }
    Ok(tapes)
}

/// What is counted, all with eight ranges.
#[derive(Clone, Debug)]
pub struct Counted {
    /// Every built-in scenario, a few seeds.
    pub scenarios: Vec<Tape>,
    /// Invented to cost as much as can be.
    pub contrived: Vec<Tape>,
}

/// Runs for the counts.
pub fn counted() -> anyhow::Result<Counted> {
    let mut scenarios = Vec::new();
    for seed in 1..=4 {
        scenarios.extend(each(seed, |scenario| scenario.sensors.count = 8)?);
    }
    Ok(Counted {
        scenarios,
        contrived: synthetic::contrived()?,
    })
}

fn each(seed: u64, change: impl Fn(&mut Scenario)) -> anyhow::Result<Vec<Tape>> {
    let all = BUILT_IN.iter().map(|(name, _)| {
        let mut scenario = load(name)?;
        change(&mut scenario);
        record(&scenario, seed)
    });
    all.collect()
}

/// A few ticks, to be logged instruction by instruction.
pub fn short() -> anyhow::Result<Tape> {
    let mut scenario = load("line")?;
    scenario.sensors.count = 8;
    scenario.duration = 5.0 * scenario.robot.period;
    record(&scenario, 1)
}
