//! What one simulated run leaves behind, in plain `f64` and names: the only thing that pictures, the replay page
//! and the metrics look at, so that none of them needs to know the controller.
//!
//! Frame: x forward/east, y left/north, counter-clockwise positive; metres, seconds, radians unless a name says
//! degrees.

use serde::Serialize;

/// A circular obstacle of the world.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Disc {
    /// Name shown beside it, for example `Obs4`.
    pub name: String,
    /// Centre, metres.
    pub x: f64,
    /// Centre, metres.
    pub y: f64,
    /// Radius, metres, positive.
    pub radius: f64,
}

/// Mounting pose and reach of one range sensor, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BeamView {
    /// Metres forward of the robot's centre.
    pub x: f64,
    /// Metres left of the robot's centre.
    pub y: f64,
    /// Direction of the axis, radians, counter-clockwise from forward.
    pub heading: f64,
    /// Full opening angle, radians; 0 for a beam.
    pub width: f64,
    /// Largest range it reports, metres.
    pub max_range: f64,
}

/// A rule table with names, as shown in the replay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TableView {
    /// Heading, for example `Table 7.2: deflection`.
    pub title: String,
    /// Name of the input along the rows.
    pub row_input: String,
    /// Name of the input along the columns.
    pub col_input: String,
    /// Row terms in order.
    pub row_terms: Vec<String>,
    /// Column terms in order.
    pub col_terms: Vec<String>,
    /// `cells[row][col]`: the consequent's term.
    pub cells: Vec<Vec<String>>,
}

/// One rule that fired.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FiredView {
    /// Index into [`Recording::tables`].
    pub table: usize,
    /// Row of the rule.
    pub row: usize,
    /// Column of the rule.
    pub col: usize,
    /// Activation degree, 0 to 1.
    pub degree: f64,
}

/// What a navigator thinks in a tick.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NavigatorView {
    /// Points that it remembers, in the frame of the robot as it believes it, metres.
    pub points: Vec<[f64; 2]>,
    /// Heading that it chose, radians from straight ahead; none if none is free.
    pub heading: Option<f64>,
    /// Direction that it wants, radians from straight ahead.
    pub direction: f64,
    /// Twist that it wants, before its barrier: metres per second, radians per second.
    pub wanted: [f64; 2],
    /// Whether the barrier slowed that.
    pub slowed: bool,
    /// Whether the brake gate changed it.
    pub gated: bool,
    /// Whether no twist was found that stays clear.
    pub trapped: bool,
    /// Sensors that it takes for dead.
    pub dead: Vec<usize>,
}

/// One tick of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Frame {
    /// Time at the tick, seconds.
    pub t: f64,
    /// True pose: x, y, heading (radians).
    pub truth: [f64; 3],
    /// Pose as the robot believes it.
    pub believed: [f64; 3],
    /// `follow`, `avoid` or `stop`; of a navigator also `escape`, `blocked` or `arrived`.
    pub mode: &'static str,
    /// Why, in a word or two (`path end`, `side left`, …); may be empty.
    pub note: &'static str,
    /// Signed cross-track error of the true pose against the path, metres, left positive; NaN where there is none.
    pub cross_track: f64,
    /// Distance from the robot's rim to the nearest obstacle, metres; infinite in an empty world.
    pub clearance: f64,
    /// Commanded twist: metres per second, radians per second.
    pub twist: [f64; 2],
    /// Wheel speeds left, right, metres per second, as the plant has them.
    pub wheels: [f64; 2],
    /// One entry a sensor: the range in metres, or none when it saw nothing or was invalid.
    pub ranges: Vec<Option<f64>>,
    /// Obstacle that the avoider holds, as it estimates it in the world: x, y, radius.
    pub estimate: Option<[f64; 3]>,
    /// Fuzzy inputs and outputs of this tick, ready to print: name and value with unit.
    pub signals: Vec<(&'static str, f64)>,
    /// Rules that fired.
    pub fired: Vec<FiredView>,
    /// Centres of [`Recording::movers`], metres.
    pub movers: Vec<[f64; 2]>,
    /// What the navigator thinks, where it tells.
    pub view: Option<NavigatorView>,
}

/// Everything about one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Recording {
    /// Scenario's name.
    pub scenario: String,
    /// Guidance law and variants, one line for a title.
    pub variant: String,
    /// Seed of the run's noise.
    pub seed: u64,
    /// Control period, seconds.
    pub period: f64,
    /// Robot's radius, metres.
    pub robot_radius: f64,
    /// Corners of the robot's outline in its own frame, metres, counter-clockwise; none if it is a disc.
    pub outline: Vec<[f64; 2]>,
    /// Obstacles that stand still.
    pub obstacles: Vec<Disc>,
    /// Obstacles that stand still and that the path knows nothing of.
    pub unmapped: Vec<Disc>,
    /// Radii of the obstacles that move, metres; where they are is in the frames.
    pub movers: Vec<f64>,
    /// Path as polylines, x, y in metres, dense enough to draw (one polyline a stretch without gaps).
    pub path: Vec<Vec<[f64; 2]>>,
    /// Sensors.
    pub beams: Vec<BeamView>,
    /// Rule tables of the controllers in use.
    pub tables: Vec<TableView>,
    /// The run, a frame a tick.
    pub frames: Vec<Frame>,
    /// Whether the last frame is none of a tick but where the run ended after it: nothing was measured there.
    pub ended: bool,
    /// Place where the robot touched something at the end, m.
    pub contact: Option<[f64; 2]>,
    /// Centre and radius of the goal, m, where there is one.
    pub goal: Option<[f64; 3]>,
    /// Whether the path is but the straight line to the goal, which nobody is to keep to.
    pub straight: bool,
    /// Clearances are known up to this, m; all that are larger are said as this.
    pub clearance_cap: Option<f64>,
    /// The sensor that hears nothing.
    pub dead: Option<usize>,
    /// What else to say about the run: a name and its value each.
    pub facts: Vec<(String, String)>,
    /// Where a page that shows the run leads back to.
    pub back: Option<String>,
}
