//! The TOML form of a scenario: reads and checks it, and names file, line, field and what is allowed when it is wrong.

use super::{PathForm, PathSpec, Scenario, ScenarioError};
use crate::control::{Control, FineNn};
use crate::recording::Disc;
use crate::robot::{Preset, RING_SIZES, RobotSpec, SensorSpec};
use crate::sensors::Noise;
use crate::track::{Piece, Track};
use crate::world::World;
use fuzzypilot::tables::fine::FineSet;
use serde::Deserialize;
use toml::Spanned;

/// Parses and checks a scenario's text; `file` is what messages call it.
pub fn parse(name: &str, file: &str, text: &str) -> Result<Scenario, ScenarioError> {
    let source = Source { file, text };
    let raw: Raw = toml::from_str(text).map_err(|e| source.syntax(&e))?;
    raw.check(&source, name)
}

type Num = Spanned<f64>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    #[serde(default)]
    about: String,
    #[serde(default)]
    robot: RawRobot,
    #[serde(default)]
    sensors: RawSensors,
    #[serde(default)]
    noise: RawNoise,
    start: Spanned<RawStart>,
    path: Spanned<RawPath>,
    #[serde(default)]
    obstacle: Vec<Spanned<RawDisc>>,
    #[serde(default)]
    run: RawRun,
    control: Option<Spanned<Control>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawRobot {
    #[serde(default)]
    preset: Preset,
    radius: Option<Num>,
    track: Option<Num>,
    speed: Option<Num>,
    yaw_rate: Option<Num>,
    acceleration: Option<Num>,
    yaw_acceleration: Option<Num>,
    wheel_speed: Option<Num>,
    period: Option<Num>,
    latency: Option<Num>,
    lag: Option<Num>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawSensors {
    count: Option<Spanned<i64>>,
    field_of_view: Option<Num>,
    range: Option<Num>,
    width: Option<Num>,
    mount_radius: Option<Num>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawNoise {
    range: Option<Num>,
    dropout: Option<Num>,
    wheel_scale: Option<Num>,
    wheel_slip: Option<Num>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStart {
    x: Num,
    y: Num,
    heading: Num,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPath {
    #[serde(default)]
    closed: bool,
    #[serde(default)]
    gaps: bool,
    points: Option<Spanned<Vec<Spanned<[f64; 3]>>>>,
    piece: Option<Vec<Spanned<RawPiece>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields, rename_all = "lowercase")]
enum RawPiece {
    Line {
        from: Spanned<[f64; 2]>,
        to: Spanned<[f64; 2]>,
    },
    Arc {
        centre: Spanned<[f64; 2]>,
        radius: Num,
        from: Num,
        sweep: Num,
    },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDisc {
    name: Option<Spanned<String>>,
    x: Option<Num>,
    y: Option<Num>,
    along: Option<Num>,
    offset: Option<Num>,
    radius: Num,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields)]
struct RawRun {
    duration: Option<Num>,
    laps: Option<Spanned<i64>>,
}

/// What a number may be.
#[derive(Clone, Copy)]
enum Allowed {
    /// At least and at most.
    Within(f64, f64),
    /// Above the first, at most the second.
    Above(f64, f64),
}

impl Allowed {
    fn admits(self, x: f64) -> bool {
        match self {
            Self::Within(least, most) => x >= least && x <= most,
            Self::Above(least, most) => x > least && x <= most,
        }
    }
}

impl std::fmt::Display for Allowed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Within(least, most) => write!(f, "a number from {least} to {most}"),
            Self::Above(least, most) => write!(f, "a number above {least}, at most {most}"),
        }
    }
}

/// Coordinates: well inside what the library's metres hold.
const PLACE: Allowed = Allowed::Within(-10_000.0, 10_000.0);
/// Lengths, and whatever else must be above zero: still above it in the library's steps of 1/65536.
const LENGTH: Allowed = Allowed::Within(LEAST, 1_000.0);
const LEAST: f64 = 0.001;
const DEGREES: Allowed = Allowed::Within(-36_000.0, 36_000.0);

/// Longest path, m: within what the library's metres hold.
const MAX_LENGTH: f64 = 30_000.0;
/// Most ticks of one run, so that what it records fits into memory.
const MAX_TICKS: f64 = 200_000.0;
/// Most obstacles: every sensor looks at each of them in every tick.
const MAX_OBSTACLES: usize = 1_000;

/// What a message quotes: one line, and not a long one.
pub fn shown(text: &str) -> String {
    const LONGEST: usize = 120;
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    let mut short: String = text.chars().take(LONGEST).map(plain).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}

/// Whether the prose's cell is asked for in tables that have none.
pub fn contradicts(control: &Control, preset: Preset) -> bool {
    control.fine_nn == FineNn::Prose && control.fine_set(preset) == FineSet::Tuned
}

/// A bare key, as every name in a scenario is one.
fn is_key(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic())
        && text
            .chars()
            .all(|c| c.is_ascii_alphanumeric() || "_-.".contains(c))
        && text.len() <= 64
}

struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl Source<'_> {
    fn line(&self, at: usize) -> usize {
        let upto = self.text.get(..at.min(self.text.len())).unwrap_or("");
        upto.matches('\n').count() + 1
    }

    fn wrong(
        &self,
        at: usize,
        field: &str,
        found: impl ToString,
        allowed: impl ToString,
    ) -> ScenarioError {
        ScenarioError::Field {
            file: self.file.to_owned(),
            line: self.line(at),
            field: field.to_owned(),
            found: shown(&found.to_string()),
            allowed: allowed.to_string(),
        }
    }

    /// A message of the TOML reader, made to name the field.
    fn syntax(&self, error: &toml::de::Error) -> ScenarioError {
        let at = error.span().map_or(0, |s| s.start);
        // The key may stand above: an array goes over several lines.
        let (mut table, mut key) = (None, None);
        for line in self.text.lines().take(self.line(at)).map(str::trim) {
            let header = line.trim_start_matches('[');
            let name = header.split(']').next().unwrap_or("").trim();
            if header.len() < line.len() && is_key(name) {
                (table, key) = (Some(name), None);
            } else if let Some((name, _)) = line.split_once('=') {
                let name = name.trim();
                if is_key(name) {
                    key = Some(name);
                } else if name.starts_with(['"', '\'']) {
                    key = None;
                }
            }
        }
        if let Some(name) = error.message().strip_prefix("missing field `") {
            let name = name.trim_end_matches('`');
            // Only these are wanted outside of every table.
            let above = [table, key];
            let above = if matches!(name, "start" | "path") {
                &[]
            } else {
                &above[..]
            };
            let mut field: Vec<&str> = above.iter().copied().flatten().collect();
            field.push(name);
            return self.wrong(
                at,
                &field.join("."),
                "nothing",
                "a value; it has no default",
            );
        }
        let field = match (table, key) {
            (Some(table), Some(key)) => format!("{table}.{key}"),
            (Some(one), None) | (None, Some(one)) => one.to_owned(),
            (None, None) => "file".to_owned(),
        };
        let message = error.message().replace('\n', " ");
        let (found, allowed) = match message.split_once(", expected ") {
            Some((found, allowed)) => (
                found.trim_start_matches("invalid type: ").to_owned(),
                match allowed {
                    "f64" => "a number".to_owned(),
                    "i64" => "a whole number".to_owned(),
                    other => other.to_owned(),
                },
            ),
            None => (
                message,
                "a scenario as `host-sim list --show line` prints one".to_owned(),
            ),
        };
        self.wrong(at, &field, found, allowed)
    }

    fn number(&self, value: &Num, field: &str, allowed: Allowed) -> Result<f64, ScenarioError> {
        let x = *value.get_ref();
        if allowed.admits(x) {
            Ok(x)
        } else {
            Err(self.wrong(value.span().start, field, format!("{x:?}"), allowed))
        }
    }

    fn numbers<const K: usize>(
        &self,
        values: &Spanned<[f64; K]>,
        field: &str,
        allowed: Allowed,
    ) -> Result<[f64; K], ScenarioError> {
        match values.get_ref().iter().find(|x| !allowed.admits(**x)) {
            None => Ok(*values.get_ref()),
            Some(x) => Err(self.wrong(values.span().start, field, format!("{x:?}"), allowed)),
        }
    }

    fn or(
        &self,
        value: Option<&Num>,
        default: f64,
        field: &str,
        allowed: Allowed,
    ) -> Result<f64, ScenarioError> {
        value.map_or(Ok(default), |v| self.number(v, field, allowed))
    }
}

impl Raw {
    fn check(&self, src: &Source<'_>, name: &str) -> Result<Scenario, ScenarioError> {
        let robot = self.robot.check(src)?;
        let sensors = self.sensors.check(src, robot.preset)?;
        let noise = self.noise.check(src)?;
        let path = check_path(src, &self.path)?;
        let track = path.track();
        let start = self.start.get_ref();
        let start_at = self.start.span().start;
        let start = [
            src.number(&start.x, "start.x", PLACE)?,
            src.number(&start.y, "start.y", PLACE)?,
            src.number(&start.heading, "start.heading", DEGREES)?
                .to_radians(),
        ];
        let mut world = World::default();
        if let Some(disc) = self.obstacle.get(MAX_OBSTACLES) {
            return Err(src.wrong(
                disc.span().start,
                "obstacle",
                format!("{} obstacles", self.obstacle.len()),
                format!("at most {MAX_OBSTACLES}"),
            ));
        }
        for (i, disc) in self.obstacle.iter().enumerate() {
            world.discs.push(check_disc(src, i, disc, &track)?);
        }
        if let (clearance, Some(i)) = world.clearance([start[0], start[1]], robot.radius)
            && clearance <= 0.0
        {
            return Err(src.wrong(
                start_at,
                "start",
                format!(
                    "a robot of radius {} inside obstacle `{}`",
                    robot.radius, world.discs[i].name
                ),
                "a start where the robot touches nothing",
            ));
        }
        let duration = src.or(
            self.run.duration.as_ref(),
            600.0,
            "run.duration",
            Allowed::Above(0.0, 100_000.0),
        )?;
        let ticks = (duration / robot.period).ceil();
        if ticks > MAX_TICKS {
            let at = [&self.run.duration, &self.robot.period]
                .into_iter()
                .flatten()
                .next()
                .map_or(0, |value| value.span().start);
            return Err(src.wrong(
                at,
                "run.duration / robot.period",
                format!("{ticks} ticks"),
                format!("at most {MAX_TICKS} ticks"),
            ));
        }
        let laps = match &self.run.laps {
            None => 1,
            Some(laps) => u16::try_from(*laps.get_ref())
                .ok()
                .filter(|laps| (1..=1000).contains(laps))
                .ok_or_else(|| {
                    src.wrong(
                        laps.span().start,
                        "run.laps",
                        laps.get_ref(),
                        "a whole number from 1 to 1000",
                    )
                })?,
        };
        let control = self
            .control
            .as_ref()
            .map_or(Control::default(), |c| *c.get_ref());
        if contradicts(&control, robot.preset) {
            return Err(src.wrong(
                self.control.as_ref().map_or(0, |c| c.span().start),
                "control.fine-nn",
                "`prose` with the tuned tables, which have no such erratum",
                "`table`, or the printed tables",
            ));
        }
        Ok(Scenario {
            name: name.to_owned(),
            about: self.about.clone(),
            robot,
            sensors,
            noise,
            start,
            path,
            world,
            duration,
            laps,
            control,
        })
    }
}

impl RawRobot {
    fn check(&self, src: &Source<'_>) -> Result<RobotSpec, ScenarioError> {
        let base = self.preset.robot();
        let rate = Allowed::Within(LEAST, 100.0);
        let time = Allowed::Within(0.0, 2.0);
        Ok(RobotSpec {
            preset: self.preset,
            radius: src.or(self.radius.as_ref(), base.radius, "robot.radius", LENGTH)?,
            track: src.or(self.track.as_ref(), base.track, "robot.track", LENGTH)?,
            speed: src.or(self.speed.as_ref(), base.speed, "robot.speed", rate)?,
            yaw_rate: src.or(
                self.yaw_rate.as_ref(),
                base.yaw_rate,
                "robot.yaw_rate",
                rate,
            )?,
            acceleration: src.or(
                self.acceleration.as_ref(),
                base.acceleration,
                "robot.acceleration",
                rate,
            )?,
            yaw_acceleration: src.or(
                self.yaw_acceleration.as_ref(),
                base.yaw_acceleration,
                "robot.yaw_acceleration",
                rate,
            )?,
            wheel_speed: src.or(
                self.wheel_speed.as_ref(),
                base.wheel_speed,
                "robot.wheel_speed",
                rate,
            )?,
            period: src.or(
                self.period.as_ref(),
                base.period,
                "robot.period",
                Allowed::Within(0.001, 2.0),
            )?,
            latency: src.or(self.latency.as_ref(), base.latency, "robot.latency", time)?,
            lag: src.or(self.lag.as_ref(), base.lag, "robot.lag", time)?,
        })
    }
}

impl RawSensors {
    fn check(&self, src: &Source<'_>, preset: Preset) -> Result<SensorSpec, ScenarioError> {
        let base = preset.sensors();
        let turn = Allowed::Above(0.0, 360.0);
        let count = match &self.count {
            None => base.count,
            Some(count) => usize::try_from(*count.get_ref())
                .ok()
                .filter(|c| RING_SIZES.contains(c))
                .ok_or_else(|| {
                    src.wrong(
                        count.span().start,
                        "sensors.count",
                        count.get_ref(),
                        "8, 16, 32 or 64",
                    )
                })?,
        };
        let degrees = |value: Option<&Num>, default: f64, field: &str, allowed: Allowed| {
            src.or(value, default.to_degrees(), field, allowed)
                .map(f64::to_radians)
        };
        Ok(SensorSpec {
            count,
            field_of_view: degrees(
                self.field_of_view.as_ref(),
                base.field_of_view,
                "sensors.field_of_view",
                turn,
            )?,
            range: src.or(
                self.range.as_ref(),
                base.range,
                "sensors.range",
                Allowed::Within(0.01, 100.0),
            )?,
            width: degrees(
                self.width.as_ref(),
                base.width,
                "sensors.width",
                Allowed::Within(0.0, 90.0),
            )?,
            mount_radius: src.or(
                self.mount_radius.as_ref(),
                base.mount_radius,
                "sensors.mount_radius",
                Allowed::Within(0.0, 10.0),
            )?,
        })
    }
}

impl RawNoise {
    fn check(&self, src: &Source<'_>) -> Result<Noise, ScenarioError> {
        let share = Allowed::Within(0.0, 1.0);
        Ok(Noise {
            range: src.or(self.range.as_ref(), 0.0, "noise.range", share)?,
            dropout: src.or(self.dropout.as_ref(), 0.0, "noise.dropout", share)?,
            wheel_scale: src.or(self.wheel_scale.as_ref(), 0.0, "noise.wheel_scale", share)?,
            wheel_slip: src.or(self.wheel_slip.as_ref(), 0.0, "noise.wheel_slip", share)?,
        })
    }
}

fn check_path(src: &Source<'_>, raw: &Spanned<RawPath>) -> Result<PathSpec, ScenarioError> {
    let at = raw.span().start;
    let raw = raw.get_ref();
    let form = match (&raw.points, &raw.piece) {
        (Some(points), None) => {
            let list = points.get_ref();
            if !(2..=4096).contains(&list.len()) {
                let found = match list.len() {
                    1 => "1 point".to_owned(),
                    n => format!("{n} points"),
                };
                return Err(src.wrong(
                    points.span().start,
                    "path.points",
                    found,
                    "2 to 4096 points [x, y, degrees]",
                ));
            }
            let mut checked: Vec<[f64; 3]> = Vec::with_capacity(list.len());
            for (i, point) in list.iter().enumerate() {
                let field = format!("path.points[{i}]");
                let [x, y, degrees] = src.numbers(point, &field, DEGREES)?;
                if let Some(far) = [x, y].iter().find(|x| !PLACE.admits(**x)) {
                    let found = format!("{far:?}");
                    return Err(src.wrong(point.span().start, &field, found, PLACE));
                }
                if let Some(last) = checked.last()
                    && (last[0] - x).hypot(last[1] - y) < 1e-3
                {
                    return Err(src.wrong(
                        point.span().start,
                        &field,
                        "the same place as the point before",
                        "points at least 1 mm apart",
                    ));
                }
                checked.push([x, y, degrees.to_radians()]);
            }
            PathForm::Points(checked)
        }
        (None, Some(pieces)) if !pieces.is_empty() && pieces.len() <= 4096 => {
            let mut checked: Vec<Piece> = Vec::with_capacity(pieces.len());
            for (i, piece) in pieces.iter().enumerate() {
                let field = format!("path.piece[{i}]");
                let new = check_piece(src, &field, piece.get_ref())?;
                if new.length() < 1e-3 {
                    return Err(src.wrong(
                        piece.span().start,
                        &field,
                        "a piece without length",
                        "pieces of at least 1 mm",
                    ));
                }
                if let Some(last) = checked.last()
                    && !raw.gaps
                {
                    let (end, start) = (last.at(last.length()), new.at(0.0));
                    let gap = (end[0] - start[0]).hypot(end[1] - start[1]);
                    if gap > 0.04 {
                        return Err(src.wrong(
                            piece.span().start,
                            &field,
                            format!("a gap of {gap:.3} m to the piece before"),
                            "a start where the piece before ends, or `gaps = true`",
                        ));
                    }
                }
                checked.push(new);
            }
            PathForm::Pieces(checked)
        }
        (points, pieces) => {
            let found = match (points, pieces) {
                (Some(_), Some(_)) => "both `points` and `[[path.piece]]`".to_owned(),
                (_, Some(pieces)) => format!("{} pieces", pieces.len()),
                _ => "neither `points` nor `[[path.piece]]`".to_owned(),
            };
            return Err(src.wrong(
                at,
                "path",
                found,
                "either `points` or 1 to 4096 `[[path.piece]]`",
            ));
        }
    };
    let path = PathSpec {
        form,
        closed: raw.closed,
        gaps: raw.gaps,
    };
    check_whole(src, at, &path)?;
    Ok(path)
}

/// What shows only in the whole path: its length, and that a closed one meets itself.
fn check_whole(src: &Source<'_>, at: usize, path: &PathSpec) -> Result<(), ScenarioError> {
    let track = path.track();
    let length = track.length();
    if length > MAX_LENGTH {
        return Err(src.wrong(
            at,
            "path",
            format!("a length of {length:.0} m"),
            format!("at most {MAX_LENGTH} m"),
        ));
    }
    let (Some(first), Some(last)) = (track.pieces().first(), track.pieces().last()) else {
        return Ok(());
    };
    let (end, start) = (last.at(last.length()), first.at(0.0));
    let gap = (end[0] - start[0]).hypot(end[1] - start[1]);
    match path.form {
        _ if !path.closed => Ok(()),
        PathForm::Points(_) if last.length() < 1e-3 => Err(src.wrong(
            at,
            "path.points",
            "a closed path with its last point on the first",
            "a last point at least 1 mm from the first, which `closed` joins to it",
        )),
        PathForm::Pieces(_) if gap > 0.04 && !path.gaps => Err(src.wrong(
            at,
            "path.closed",
            format!("a gap of {gap:.3} m from the last piece's end to the first one's start"),
            "a last piece that ends where the first starts, or `gaps = true`",
        )),
        _ => Ok(()),
    }
}

fn check_piece(src: &Source<'_>, field: &str, raw: &RawPiece) -> Result<Piece, ScenarioError> {
    let sub = |name: &str| format!("{field}.{name}");
    Ok(match raw {
        RawPiece::Line { from, to } => Piece::Line {
            from: src.numbers(from, &sub("line.from"), PLACE)?,
            to: src.numbers(to, &sub("line.to"), PLACE)?,
        },
        RawPiece::Arc {
            centre,
            radius,
            from,
            sweep,
        } => Piece::Arc {
            centre: src.numbers(centre, &sub("arc.centre"), PLACE)?,
            radius: src.number(radius, &sub("arc.radius"), LENGTH)?,
            from: src.number(from, &sub("arc.from"), DEGREES)?.to_radians(),
            sweep: src
                .number(sweep, &sub("arc.sweep"), Allowed::Within(-360.0, 360.0))?
                .to_radians(),
        },
    })
}

fn check_disc(
    src: &Source<'_>,
    i: usize,
    raw: &Spanned<RawDisc>,
    track: &Track,
) -> Result<Disc, ScenarioError> {
    let at = raw.span().start;
    let raw = raw.get_ref();
    let field = |name: &str| format!("obstacle[{i}].{name}");
    let radius = src.number(&raw.radius, &field("radius"), LENGTH)?;
    let [x, y] = match (&raw.x, &raw.y, &raw.along, &raw.offset) {
        (Some(x), Some(y), None, None) => [
            src.number(x, &field("x"), PLACE)?,
            src.number(y, &field("y"), PLACE)?,
        ],
        (None, None, Some(along), offset) => {
            let along = src.number(along, &field("along"), Allowed::Within(0.0, 1.0))?;
            let offset = src.or(offset.as_ref(), 0.0, &field("offset"), PLACE)?;
            track.beside(along, offset)
        }
        _ => {
            return Err(src.wrong(
                at,
                &format!("obstacle[{i}]"),
                "an unclear place",
                "either `x` and `y`, or `along` (share of the path, 0 to 1) and `offset` (m, left positive)",
            ));
        }
    };
    let name = match &raw.name {
        None => format!("Obs{}", i + 1),
        Some(name) => {
            let text = name.get_ref();
            if !(1..=40).contains(&text.chars().count()) || text.contains(char::is_control) {
                return Err(src.wrong(
                    name.span().start,
                    &field("name"),
                    format!("`{text}`"),
                    "1 to 40 characters on one line",
                ));
            }
            text.clone()
        }
    };
    Ok(Disc { name, x, y, radius })
}
