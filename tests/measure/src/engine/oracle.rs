//! How far the fine controller's tables are off others that evaluate the same rules: fuzzylite's grid, where the data folder
//! is, and always the `f64` of `host_sim::fuzzy` with `host-sim/designs/fine.fll`. Both share no code with the library's
//! fixed point. Every core computes the same bits as this machine, so that this is measured here.

use crate::page::grouped;
use crate::repository;
use anyhow::{Context, ensure};
use fixed::types::I16F16;
use fuzzypilot::tables::fine::PRINTED;
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::files::load;
use std::fmt::{self, Display, Formatter};

#[path = "../../../oracle/grid.rs"]
mod grid;

/// The most that is allowed: units of the speed's axis, and degrees.
const ALLOWED: [f64; 2] = [0.0005, 0.01];

/// Steps of the grid from end to end: of the distance's axis, 0 to 4, and of the angle's, 0° to 180°. No multiples of the
/// terms' widths, so that all of their flanks are met.
const STEPS: [u32; 2] = [307, 311];

/// What was found over a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Agreement {
    against: &'static str,
    points: u32,
    /// Of the speed, in units of its axis, and of the deflection, in degrees.
    worst: [f64; 2],
}

impl Agreement {
    /// # Errors
    ///
    /// More than is allowed.
    pub fn held(&self) -> anyhow::Result<()> {
        let within = |(worst, allowed): (&f64, f64)| *worst <= allowed;
        ensure!(
            self.points > 0 && self.worst.iter().zip(ALLOWED).all(within),
            "the fine controller is too far off {}",
            self.against
        );
        Ok(())
    }

    fn new(against: &'static str) -> Self {
        Self {
            against,
            points: 0,
            worst: [0.0; 2],
        }
    }

    /// One point of the grid and the other's outputs there.
    fn see(&mut self, [d, phi]: [f64; 2], theirs: [f64; 2]) {
        let ours = PRINTED.evaluate(I16F16::from_num(d), I16F16::from_num(phi));
        let ours = [ours.speed.to_num::<f64>(), ours.deflection.to_num()];
        for ((worst, ours), theirs) in self.worst.iter_mut().zip(ours).zip(theirs) {
            // Not a number counts as the worst.
            let off = (ours - theirs).abs();
            *worst = if off <= *worst { *worst } else { off };
        }
        self.points += 1;
    }
}

impl Display for Agreement {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let [speed, deflection] = self.worst;
        let [allowed_speed, allowed_deflection] = ALLOWED;
        write!(
            f,
            "against {}, {} points: speed off by {speed:.6} axis units at most (allowed {allowed_speed}), deflection by \
             {deflection:.5}° (allowed {allowed_deflection}°)",
            self.against,
            grouped(self.points)
        )
    }
}

/// Against fuzzylite, if its grid is here, and against `f64`.
///
/// # Errors
///
/// A grid or a design that cannot be read.
pub fn agreements() -> anyhow::Result<Vec<Agreement>> {
    let mut all = Vec::new();
    match fuzzylite()? {
        Some(agreement) => all.push(agreement),
        None => println!("fuzzylite's grid is not here: set FUZZYPILOT_DATA"),
    }
    all.push(exact()?);
    Ok(all)
}

fn fuzzylite() -> anyhow::Result<Option<Agreement>> {
    let rows = grid::rows(repository("../shared/data")).map_err(anyhow::Error::msg)?;
    let Some(rows) = rows else {
        return Ok(None);
    };
    let mut agreement = Agreement::new("fuzzylite's grid");
    for [d, phi, speed, deflection] in rows {
        agreement.see([d, phi], [speed, deflection]);
    }
    Ok(Some(agreement))
}

fn exact() -> anyhow::Result<Agreement> {
    let system = load(&repository("host-sim/designs/fine.fll"), None)?;
    let place = |name: &str| {
        let mut inputs = system.inputs.iter();
        let at = inputs.position(|input| input.name == name);
        at.with_context(|| format!("designs/fine.fll has no input {name}"))
    };
    let (d_at, phi_at) = (place("d")?, place("phi")?);
    let exact = Exact::new(&system);
    let mut agreement = Agreement::new("f64");
    let [d_steps, phi_steps] = STEPS;
    for (i, j) in (0..=d_steps).flat_map(|i| (0..=phi_steps).map(move |j| (i, j))) {
        let d = 4.0 * f64::from(i) / f64::from(d_steps);
        let phi = 180.0 * f64::from(j) / f64::from(phi_steps);
        let mut point = [0.0; 2];
        (point[d_at], point[phi_at]) = (d, phi);
        let outputs = exact.evaluate(&point).outputs;
        let [Some(speed), Some(deflection)] = outputs[..] else {
            anyhow::bail!("designs/fine.fll: not two outputs everywhere");
        };
        agreement.see([d, phi], [speed, deflection]);
    }
    Ok(agreement)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bars_hold_and_can_fail() {
        for agreement in agreements().unwrap() {
            agreement.held().unwrap();
            // Not better than fixed point can be: something was compared.
            assert!(
                agreement.worst.iter().all(|worst| *worst > 1e-5),
                "{agreement}"
            );
        }
        let mut off = Agreement::new("another");
        assert!(off.held().is_err(), "nothing was compared");
        off.see([1.0, 45.0], [f64::NAN, 0.0]);
        assert!(off.held().is_err(), "{off}");
    }
}
