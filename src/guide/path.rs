//! Paths: a borrowed slice of discrete points or of lines and arcs, open or closed. The slice may be a `static`, or a
//! `heapless::Vec` that was filled at run time.

use super::local::{Local, along_arc};
use crate::geometry::{Point, Pose};
use crate::integer::{divide, quotient, saturate};
use crate::units::{Angle, Metres, PerMetre};
use fixed::types::I16F16;

/// The most pieces (segments, or gaps between points) of one path.
pub const MAX_PIECES: usize = 4096;

/// The chapter's P_d(i) = [x, y, ζ]: a place and the tangent direction there.
pub type Waypoint = Pose;

/// A line or a circular arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Segment {
    /// A straight line.
    Line {
        /// Where it starts and its direction.
        start: Pose,
        /// Its length, above zero.
        length: Metres,
    },
    /// A circular arc.
    Arc {
        /// Centre of the circle.
        centre: Point,
        /// Radius, above zero.
        radius: Metres,
        /// Direction from the centre to the first point.
        from: Angle,
        /// Angle swept, in turns with 24 fractional bits, counter-clockwise positive, at most one turn either way.
        sweep: i32,
    },
}

impl Segment {
    /// A line from `start` along its heading.
    pub const fn line(start: Pose, length: Metres) -> Self {
        Self::Line { start, length }
    }

    /// An arc about `centre`, beginning in direction `from` of it and sweeping `degrees`, counter-clockwise positive,
    /// at most 360 either way (more counts as 360).
    pub const fn arc(centre: Point, radius: Metres, from: Angle, degrees: I16F16) -> Self {
        let turns = ((degrees.to_bits() as i64) << 8) / 360;
        let turns = if turns > 1 << 24 {
            1 << 24
        } else if turns < -(1 << 24) {
            -(1 << 24)
        } else {
            turns
        };
        Self::Arc {
            centre,
            radius,
            from,
            sweep: turns as i32,
        }
    }

    /// Path length.
    pub fn length(&self) -> Metres {
        match *self {
            Self::Line { length, .. } => length,
            Self::Arc { radius, sweep, .. } => {
                along_arc(radius, i64::from(sweep.unsigned_abs()) << 8)
            }
        }
    }

    /// Place and tangent at `along` metres from the start, limited to the segment.
    pub fn at(&self, along: Metres) -> Pose {
        let local = Local::new(&Piece::Segment(*self));
        local.frame(along.max(Metres::ZERO).min(local.length)).0
    }

    /// First point and tangent.
    pub fn start(&self) -> Pose {
        self.at(Metres::ZERO)
    }

    /// Last point and tangent.
    pub fn end(&self) -> Pose {
        match *self {
            Self::Line { .. } => self.at(Metres::MAX),
            Self::Arc {
                centre,
                radius,
                from,
                sweep,
            } => {
                // From the sweep itself: exact, where the way over the length would round.
                let out = from + Angle::from_bits(sweep.wrapping_shl(8));
                Pose::new(centre + Point::polar(radius, out), tangent(out, sweep >= 0))
            }
        }
    }

    /// Signed curvature, left positive.
    pub fn curvature(&self) -> PerMetre {
        match *self {
            Self::Line { .. } => PerMetre::ZERO,
            Self::Arc { radius, sweep, .. } => {
                let magnitude = quotient(1 << 32, radius.bits()).map_or(0, saturate);
                PerMetre::from_bits(if sweep >= 0 {
                    magnitude
                } else {
                    magnitude.saturating_neg()
                })
            }
        }
    }
}

/// Tangent where the direction from the centre is `out`.
pub(super) fn tangent(out: Angle, left: bool) -> Angle {
    if left {
        out + Angle::QUARTER
    } else {
        out - Angle::QUARTER
    }
}

/// The piece after `index`, if there is one.
pub(super) fn next(path: &Path<'_>, index: usize) -> Option<usize> {
    let next = index.saturating_add(1);
    match next < path.count() {
        true => Some(next),
        false => path.is_closed().then_some(0),
    }
}

/// What the path is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pieces<'a> {
    Points(&'a [Waypoint]),
    Segments(&'a [Segment]),
}

/// A checked path over borrowed pieces: a `static` slice, or storage filled at run time.
///
/// ```
/// use fuzzypilot::{geometry::{Point, Pose}, guide::{Path, Segment}, units::{Angle, Metres}};
///
/// let mut pieces: heapless::Vec<Segment, 8> = heapless::Vec::new();
/// pieces.push(Segment::line(Pose::default(), Metres::lit("2"))).map_err(|_| "full")?;
/// pieces.push(Segment::arc(
///     Point::new(Metres::lit("2"), Metres::lit("1")),
///     Metres::lit("1"),
///     Angle::deg("-90"),
///     fixed::types::I16F16::lit("180"),
/// )).map_err(|_| "full")?;
/// let path = Path::segments(&pieces, false)?;
/// assert!((path.length() - Metres::lit("5.14159")).abs() < Metres::lit("0.0001"));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Path<'a> {
    pub(crate) pieces: Pieces<'a>,
    pub(crate) closed: bool,
    length: Metres,
}

/// A path that cannot be driven.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum PathError {
    /// Fewer than two points, or no segment.
    TooShort,
    /// More than [`MAX_PIECES`] pieces.
    TooMany,
    /// The piece with this index has no length, a radius that is not positive, or a sweep of none or over a turn.
    Degenerate(usize),
    /// The piece with this index starts more than 5 cm from the end of the one before.
    Gap(usize),
}

impl core::fmt::Display for PathError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::TooShort => f.write_str("a path needs at least two points or one segment"),
            Self::TooMany => write!(f, "a path has at most {MAX_PIECES} pieces"),
            Self::Degenerate(i) => {
                write!(
                    f,
                    "piece {i} has no length, no positive radius, or a sweep of none or over a turn"
                )
            }
            Self::Gap(i) => write!(f, "piece {i} does not start where the one before ends"),
        }
    }
}

impl core::error::Error for PathError {}

impl<'a> Path<'a> {
    /// A path through discrete points; `closed` joins the last to the first.
    pub fn points(points: &'a [Waypoint], closed: bool) -> Result<Self, PathError> {
        if points.len() < 2 {
            return Err(PathError::TooShort);
        }
        Self::build(Pieces::Points(points), closed)
    }

    /// A path of lines and arcs that follow each other without gaps; corners are allowed. `closed` joins the end of
    /// the last to the start of the first.
    pub fn segments(segments: &'a [Segment], closed: bool) -> Result<Self, PathError> {
        let path = Self::segments_with_gaps(segments, closed)?;
        const TOLERANCE: Metres = Metres::lit("0.05");
        let mut last = segments.last().filter(|_| closed).map(Segment::end);
        for (i, segment) in segments.iter().enumerate() {
            if last.is_some_and(|end| (segment.start().at - end.at).norm() > TOLERANCE) {
                return Err(PathError::Gap(i));
            }
            last = Some(segment.end());
        }
        Ok(path)
    }

    /// Like [`Path::segments`] without the check for gaps; the robot makes its own way across them.
    pub fn segments_with_gaps(segments: &'a [Segment], closed: bool) -> Result<Self, PathError> {
        if segments.is_empty() {
            return Err(PathError::TooShort);
        }
        for (i, segment) in segments.iter().enumerate() {
            let sound = match *segment {
                Segment::Line { length, .. } => length > Metres::ZERO,
                Segment::Arc { radius, sweep, .. } => {
                    radius > Metres::ZERO && sweep != 0 && sweep.unsigned_abs() <= 1 << 24
                }
            };
            if !sound || segment.length() <= Metres::ZERO {
                return Err(PathError::Degenerate(i));
            }
        }
        Self::build(Pieces::Segments(segments), closed)
    }

    fn build(pieces: Pieces<'a>, closed: bool) -> Result<Self, PathError> {
        let mut path = Self {
            pieces,
            closed,
            length: Metres::ZERO,
        };
        if path.count() > MAX_PIECES {
            return Err(PathError::TooMany);
        }
        for i in 0..path.count() {
            let length = path.piece(i).length();
            if length <= Metres::ZERO {
                return Err(PathError::Degenerate(i));
            }
            path.length = path.length + length;
        }
        Ok(path)
    }

    /// A path whose pieces were checked once and have not changed since.
    pub(crate) const fn checked_before(pieces: Pieces<'a>, closed: bool, length: Metres) -> Self {
        Self {
            pieces,
            closed,
            length,
        }
    }

    /// Number of pieces, one or more.
    pub fn count(&self) -> usize {
        match self.pieces {
            Pieces::Points(points) if self.closed => points.len(),
            Pieces::Points(points) => points.len().saturating_sub(1),
            Pieces::Segments(segments) => segments.len(),
        }
    }

    /// Total length; of a closed path, of one lap.
    pub fn length(&self) -> Metres {
        self.length
    }

    /// Whether the path closes on itself.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Where the path starts.
    pub fn start(&self) -> Pose {
        self.piece(0).start()
    }

    pub(crate) fn piece(&self, index: usize) -> Piece {
        match self.pieces {
            Pieces::Points(points) => {
                let next = if index.saturating_add(1) < points.len() {
                    index.saturating_add(1)
                } else {
                    0
                };
                let from = points.get(index).copied().unwrap_or_default();
                let to = points.get(next).copied().unwrap_or_default();
                Piece::Chord { from, to }
            }
            Pieces::Segments(segments) => Piece::Segment(
                segments
                    .get(index)
                    .copied()
                    .unwrap_or(Segment::line(Pose::default(), Metres::ZERO)),
            ),
        }
    }
}

/// One piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Piece {
    /// Between two discrete points. The tangent goes from the one's ζ to the other's, linearly along the chord.
    Chord { from: Waypoint, to: Waypoint },
    /// A line or an arc.
    Segment(Segment),
}

impl Piece {
    pub(crate) fn length(&self) -> Metres {
        match self {
            Self::Chord { from, to } => (to.at - from.at).norm(),
            Self::Segment(segment) => segment.length(),
        }
    }

    pub(crate) fn start(&self) -> Pose {
        match self {
            Self::Chord { from, .. } => *from,
            Self::Segment(segment) => segment.start(),
        }
    }

    /// Tangent at the start.
    pub(crate) fn start_heading(&self) -> Angle {
        match *self {
            Self::Chord { from, .. } => from.heading,
            Self::Segment(Segment::Line { start, .. }) => start.heading,
            Self::Segment(Segment::Arc { from, sweep, .. }) => tangent(from, sweep >= 0),
        }
    }

    /// Tangent at the end.
    pub(crate) fn end_heading(&self) -> Angle {
        match *self {
            Self::Chord { to, .. } => to.heading,
            Self::Segment(Segment::Line { start, .. }) => start.heading,
            Self::Segment(Segment::Arc { from, sweep, .. }) => {
                tangent(from + Angle::from_bits(sweep.wrapping_shl(8)), sweep >= 0)
            }
        }
    }

    /// Square of the speed at which the bend asks for `lateral` m/s², m²/s² with 32 fractional bits; the largest number
    /// on a line.
    pub(crate) fn bend_speed_squared(&self, length: Metres, lateral: I16F16) -> u64 {
        let lateral = u64::from(lateral.to_bits().unsigned_abs());
        let by = |length: Metres| lateral.wrapping_mul(length.bits().unsigned_abs().into());
        match *self {
            Self::Segment(Segment::Line { .. }) => u64::MAX,
            Self::Segment(Segment::Arc { radius, .. }) => by(radius),
            Self::Chord { from, to } => {
                let turn = (to.heading - from.heading).radians().to_bits();
                let scaled = by(length).min(u64::MAX >> 16) << 16;
                divide(scaled, turn.unsigned_abs()).unwrap_or(u64::MAX)
            }
        }
    }

    /// Curvature, constant along a piece.
    pub(crate) fn curvature(&self) -> PerMetre {
        match *self {
            Self::Segment(segment) => segment.curvature(),
            Self::Chord { from, to } => {
                let length = (to.at - from.at).norm();
                let turn = to.heading - from.heading;
                let radians = i64::from(turn.radians().to_bits()) << 16;
                PerMetre::from_bits(quotient(radians, length.bits()).map_or(0, saturate))
            }
        }
    }
}
