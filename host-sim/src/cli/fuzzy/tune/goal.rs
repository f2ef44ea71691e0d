//! What is tuned for: data, or driving.

use super::TuneArguments;
use crate::cli::{BadInput, Variants, load};
use host_sim::driving::{Driving, SCALED, tables};
use host_sim::fuzzy::lower::Lowered;
use host_sim::fuzzy::model::System;
use host_sim::fuzzy::tune::data::Data;
use host_sim::fuzzy::tune::{Fit, Objective, Selection, Variable};
use host_sim::scenario::Scenario;
use host_sim::search::Hash;
use host_sim::search::state::Question;

/// A goal, read and checked.
pub enum Goal {
    /// Rows to fit, and rows to be judged by.
    Data {
        /// Fitted to.
        train: Data,
        /// Only judged by; may have no row.
        validation: Data,
        /// Of the file and of how it was split.
        fingerprint: String,
    },
    /// Scenarios to drive.
    Drive {
        /// Which.
        scenarios: Vec<Scenario>,
        /// Seeds 1 to this.
        seeds: u64,
    },
}

impl Goal {
    /// Reads what the arguments name.
    pub fn load(arguments: &TuneArguments, system: &System) -> anyhow::Result<Self> {
        let Some(file) = &arguments.data else {
            let scenarios = arguments.scenario.iter();
            let scenarios = scenarios.map(|name| load(name, &Variants::default()));
            let file = arguments.design.file.display();
            tables(system).map_err(|why| BadInput(format!("{file}: {why}")))?;
            return Ok(Self::Drive {
                scenarios: scenarios.collect::<Result<_, _>>()?,
                seeds: arguments.seeds,
            });
        };
        let (data, hash) = Data::load(file, system, &arguments.ignore)
            .map_err(|error| BadInput(error.to_string()))?;
        let outside = data.outside(system);
        if outside > 0 {
            let file = file.display();
            eprintln!(
                "note: {file}: {outside} of {} rows lie outside the inputs' ranges",
                data.rows.len()
            );
        }
        let (train, validation) = data.split(arguments.validate, arguments.seed);
        if train.rows.is_empty() {
            return Err(BadInput(format!(
                "--validate {}: no row is left to fit to; allowed is a smaller share",
                arguments.validate
            ))
            .into());
        }
        let how = format!("{} {:?}", arguments.validate, arguments.ignore);
        Ok(Self::Data {
            train,
            validation,
            fingerprint: format!("{:016x}", hash_of(hash, &how)),
        })
    }

    /// What the goal itself holds: the robot's angle has no scale, so φ's terms stay, and d's terms stay evenly divided.
    pub fn hold(&self, system: &System, selection: &mut Selection) {
        if matches!(self, Self::Data { .. }) {
            return;
        }
        for (index, input) in system.inputs.iter().enumerate() {
            match &input.name[..] {
                SCALED => selection.even.push(index),
                _ => selection.fix.push((Variable::Input(index), None)),
            }
        }
    }

    /// Of everything that the cost depends on.
    pub fn fingerprint(&self) -> String {
        match self {
            Self::Data { fingerprint, .. } => format!("data {fingerprint}"),
            Self::Drive { scenarios, seeds } => {
                let text = Question::fingerprint(&format!("{scenarios:?} {seeds}"));
                format!("scenarios {text}")
            }
        }
    }

    /// As the search wants it.
    pub fn objective(&self) -> &dyn Objective {
        self
    }
}

fn hash_of(file: Hash, how: &str) -> u64 {
    file.and(how.as_bytes()).bits()
}

impl Objective for Goal {
    fn cost(&self, system: &System, lowered: &Lowered) -> Option<f64> {
        match self {
            Self::Data { train, .. } => Fit(train).cost(system, lowered),
            Self::Drive { scenarios, seeds } => Driving {
                scenarios,
                seeds: *seeds,
            }
            .cost(system, lowered),
        }
    }
}
