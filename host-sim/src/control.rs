//! Which law and which variant of the tables a run uses: every erratum by name.

use crate::robot::Preset;
use clap::ValueEnum;
use fuzzypilot::params as lib;
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::FineSet;
use serde::{Deserialize, Serialize};

/// Guidance law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum LawName {
    /// Vector field with curvature feed-forward.
    #[default]
    Guided,
    /// As printed.
    Paper,
}

/// Fine tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TablesName {
    /// Tables 7.1 and 7.2.
    Printed,
    /// The tuned set.
    Tuned,
}

/// Cell (d = N, phi = N) of Table 7.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FineNn {
    /// N, as the table and the printed peak have it.
    #[default]
    Table,
    /// B, as the worked example's prose has it.
    Prose,
}

/// Reading of the speed axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum AxisName {
    /// Its top, 3.0, is the robot's top speed.
    #[default]
    Scaled,
    /// Metres per second as it stands.
    Literal,
}

/// Cell (s = N, theta = R) of Table 7.3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum CoarseName {
    /// R, as text and symmetry demand.
    #[default]
    Corrected,
    /// L, as printed.
    Printed,
}

/// What Table 7.4 reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum InputName {
    /// The deflection, equation 7.5.
    #[default]
    Deflection,
    /// The bearing theta, the table's heading.
    Bearing,
}

/// Integration rule of plant and odometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum IntegratorName {
    /// Exact arcs, wheel dynamics.
    Arc,
    /// Equation 7.1.
    Euler,
}

/// Law and variants; what is not given follows the preset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Control {
    /// Guidance law.
    #[serde(default)]
    pub law: LawName,
    /// Fine tables.
    pub tables: Option<TablesName>,
    /// Erratum of the worked example.
    #[serde(default)]
    pub fine_nn: FineNn,
    /// Erratum of the speed axis.
    #[serde(default)]
    pub speed_axis: AxisName,
    /// Erratum of Table 7.3.
    #[serde(default, rename = "table-7-3")]
    pub table_7_3: CoarseName,
    /// Erratum of Table 7.4.
    #[serde(default, rename = "table-7-4-input")]
    pub table_7_4_input: InputName,
    /// Integration rule.
    pub integrator: Option<IntegratorName>,
}

impl Control {
    /// The fine tables in force.
    pub fn fine_set(&self, preset: Preset) -> FineSet {
        let tables = self.tables.unwrap_or(match preset {
            Preset::Chapter => TablesName::Printed,
            Preset::Small => TablesName::Tuned,
        });
        match (tables, self.fine_nn) {
            (TablesName::Tuned, _) => FineSet::Tuned,
            (TablesName::Printed, FineNn::Table) => FineSet::Printed,
            (TablesName::Printed, FineNn::Prose) => FineSet::PrintedProse,
        }
    }

    /// The Table 7.3 in force.
    pub fn coarse_set(&self) -> CoarseSet {
        match self.table_7_3 {
            CoarseName::Corrected => CoarseSet::Corrected,
            CoarseName::Printed => CoarseSet::Printed,
        }
    }

    /// What Table 7.4 reads.
    pub fn speed_input(&self) -> SpeedInput {
        match self.table_7_4_input {
            InputName::Deflection => SpeedInput::Deflection,
            InputName::Bearing => SpeedInput::Bearing,
        }
    }

    /// The integration rule in force: equation 7.1 in the chapter's world.
    pub fn integrator(&self, preset: Preset) -> lib::Integrator {
        match (self.integrator, preset) {
            (Some(IntegratorName::Euler), _) | (None, Preset::Chapter) => lib::Integrator::Euler,
            (Some(IntegratorName::Arc), _) | (None, Preset::Small) => lib::Integrator::Arc,
        }
    }

    /// One line for titles and tables.
    pub fn describe(&self, preset: Preset) -> String {
        let law = match self.law {
            LawName::Guided => "guided",
            LawName::Paper => "paper",
        };
        let tables = match self.fine_set(preset) {
            FineSet::Printed => "printed tables",
            FineSet::PrintedProse => "printed tables (7.2 by prose)",
            FineSet::Tuned => "tuned tables",
        };
        let mut line = format!("law {law}, {tables}");
        if self.speed_axis == AxisName::Literal {
            line += ", literal speed axis";
        }
        if self.table_7_3 == CoarseName::Printed {
            line += ", Table 7.3 as printed";
        }
        if self.table_7_4_input == InputName::Bearing {
            line += ", Table 7.4 reads the bearing";
        }
        line
    }
}
