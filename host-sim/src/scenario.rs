//! Scenarios: what is driven where. Built-in ones are TOML files of the same form that a user writes.

mod file;

pub use file::{contradicts, parse, shown};

use crate::control::Control;
use crate::robot::{RobotSpec, SensorSpec};
use crate::sensors::Noise;
use crate::track::{Piece, Track};
use crate::world::World;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A scenario that has passed every check.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// Its name: the built-in's or the file's stem.
    pub name: String,
    /// One line about it.
    pub about: String,
    /// Body, limits and timing.
    pub robot: RobotSpec,
    /// Range sensors.
    pub sensors: SensorSpec,
    /// Their errors.
    pub noise: Noise,
    /// Start: x, y, heading in radians.
    pub start: [f64; 3],
    /// The path.
    pub path: PathSpec,
    /// The obstacles.
    pub world: World,
    /// Longest simulated time, s.
    pub duration: f64,
    /// Laps of a closed path.
    pub laps: u16,
    /// Law and table variants.
    pub control: Control,
}

/// The path's form.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSpec {
    /// Its pieces or points.
    pub form: PathForm,
    /// The end joins the start.
    pub closed: bool,
    /// Pieces need not meet.
    pub gaps: bool,
}

/// Discrete points or lines and arcs.
#[derive(Clone, Debug, PartialEq)]
pub enum PathForm {
    /// P_d(i) = [x, y, ζ], ζ in radians.
    Points(Vec<[f64; 3]>),
    /// Lines and arcs.
    Pieces(Vec<Piece>),
}

impl PathSpec {
    /// The same path for judging.
    pub fn track(&self) -> Track {
        match &self.form {
            PathForm::Pieces(pieces) => Track::new(pieces.clone()),
            PathForm::Points(points) => {
                let xy = |p: &[f64; 3]| [p[0], p[1]];
                let mut pieces: Vec<Piece> = points
                    .windows(2)
                    .map(|w| Piece::Line {
                        from: xy(&w[0]),
                        to: xy(&w[1]),
                    })
                    .collect();
                if let (true, Some(first), Some(last)) =
                    (self.closed, points.first(), points.last())
                {
                    pieces.push(Piece::Line {
                        from: xy(last),
                        to: xy(first),
                    });
                }
                Track::new(pieces)
            }
        }
    }
}

/// Why a scenario cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum ScenarioError {
    /// Something in a file.
    #[error("{file}:{line}: {field}: found {found}; allowed: {allowed}")]
    Field {
        /// The file, or the built-in's name.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Field with its table.
        field: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// Neither a built-in nor a file.
    #[error("unknown scenario `{name}`; allowed: a TOML file, or one of {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The built-in names.
        known: String,
    },
    /// A file that cannot be read.
    #[error(
        "{file}: cannot be read ({why}); allowed: a readable TOML file, or a built-in name (see `host-sim list`)"
    )]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason.
        why: String,
    },
}

macro_rules! built_in {
    ($($name:literal),* $(,)?) => {
        /// Names and texts of the built-in scenarios, in the order of `host-sim list`.
        pub const BUILT_IN: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../scenarios/", $name, ".toml")))),*];
    };
}

built_in!(
    "experiment-1",
    "worked-example",
    "line",
    "line-offset",
    "arc-5",
    "arc-2",
    "arc-1",
    "dual-semicircle",
    "circle",
    "figure-eight",
    "square",
    "points",
    "facing-away",
    "one-obstacle",
    "cones",
    "inside-arc",
    "slalom",
    "narrow-gap",
);

/// Finds a built-in scenario by its name, or reads a TOML file.
pub fn load(name: &str) -> Result<Scenario, ScenarioError> {
    if let Some((name, text)) = BUILT_IN.iter().find(|(known, _)| *known == name) {
        return parse(name, name, text);
    }
    let path = Path::new(name);
    let looks_like_a_file = path.extension().is_some() || path.components().count() > 1;
    if !path.exists() && !looks_like_a_file {
        return Err(ScenarioError::Unknown {
            name: name.to_owned(),
            known: BUILT_IN
                .iter()
                .map(|(known, _)| *known)
                .collect::<Vec<_>>()
                .join(", "),
        });
    }
    let text = read(path, name)?;
    let stem = path
        .file_stem()
        .map_or_else(|| "scenario".into(), |s| s.to_string_lossy().into_owned());
    parse(&stem, name, &text)
}

/// Longest file that is read, bytes: several times the longest scenario there can be.
const MAX_FILE: u64 = 4 << 20;

/// A file's text, if it is text and not endless.
fn read(path: &Path, name: &str) -> Result<String, ScenarioError> {
    let unreadable = |why: String| ScenarioError::Unreadable {
        file: name.to_owned(),
        why,
    };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MAX_FILE + 1).read_to_end(&mut bytes))
        .map_err(|e| unreadable(e.to_string()))?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(unreadable("it is longer than 4 MiB".to_owned()));
    }
    String::from_utf8(bytes).map_err(|e| ScenarioError::Field {
        file: name.to_owned(),
        line: e.as_bytes()[..e.utf8_error().valid_up_to()]
            .iter()
            .filter(|b| **b == b'\n')
            .count()
            + 1,
        field: "file".to_owned(),
        found: "a byte that is not UTF-8".to_owned(),
        allowed: "UTF-8 text".to_owned(),
    })
}
