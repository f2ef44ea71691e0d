//! Paths: a borrowed slice of discrete points or of lines and arcs, open or closed. The slice may be a `static`, or a
//! `heapless::Vec` that was filled at run time.

use crate::geometry::{Point, Pose, Rotation, square};
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
        self.frame(along.max(Metres::ZERO).min(self.length())).0
    }

    /// Like [`Segment::at`] for a place on the segment, with the rotation into the tangent's direction.
    fn frame(&self, along: Metres) -> (Pose, Rotation) {
        match *self {
            Self::Line { start, .. } => {
                let forward = start.heading.rotation();
                let at = start.at + forward.ahead(along);
                (Pose::new(at, start.heading), forward)
            }
            Self::Arc {
                centre,
                radius,
                from,
                sweep,
            } => {
                let swept = angle_along(radius, along);
                let out = if sweep >= 0 {
                    from + swept
                } else {
                    from - swept
                };
                let outward = out.rotation();
                let forward = if sweep >= 0 {
                    outward.left()
                } else {
                    outward.right()
                };
                let at = centre + outward.ahead(radius);
                (Pose::new(at, tangent(out, sweep)), forward)
            }
        }
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
                Pose::new(centre + Point::polar(radius, out), tangent(out, sweep))
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

fn tangent(out: Angle, sweep: i32) -> Angle {
    if sweep >= 0 {
        out + Angle::QUARTER
    } else {
        out - Angle::QUARTER
    }
}

/// Arc length of `turns` (32 fractional bits, at most one turn either way) at `radius`.
fn along_arc(radius: Metres, turns: i64) -> Metres {
    // 2π with 20 fractional bits. The products stay below 2^62 for every radius.
    const TURN: i64 = 6_588_397;
    let turn_metres = ((turns >> 2).wrapping_mul(i64::from(radius.bits()))) >> 22;
    Metres::from_bits(saturate(turn_metres.wrapping_mul(TURN) >> 28))
}

/// Angle that an arc of length `along` subtends at `radius`; wraps.
fn angle_along(radius: Metres, along: Metres) -> Angle {
    // along / (2π · radius) turns; 2^32/2π · along / radius.
    const TURN: i64 = 683_565_276;
    let wide = i64::from(along.bits()).wrapping_mul(TURN);
    Angle::from_bits(quotient(wide, radius.bits()).unwrap_or(0) as i32)
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

/// One piece, ready to project on.
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

    /// Place and tangent at `along`, which is on the piece, with the rotation into the tangent's direction.
    pub(crate) fn frame(&self, along: Metres) -> (Pose, Rotation) {
        match *self {
            Self::Segment(segment) => segment.frame(along),
            Self::Chord { from, to } => {
                let chord = to.at - from.at;
                let length = chord.norm();
                let along = along.max(Metres::ZERO).min(length);
                let turn = to.heading - from.heading;
                // Share of the chord, 30 fractional bits.
                let share = quotient(i64::from(along.bits()) << 30, length.bits()).unwrap_or(0);
                let part = |whole: i32| saturate(i64::from(whole).wrapping_mul(share) >> 30);
                let place = from.at
                    + Point::new(
                        Metres::from_bits(part(chord.x.bits())),
                        Metres::from_bits(part(chord.y.bits())),
                    );
                let curvature = self.curvature().bits();
                // The arc through both points bulges from the chord by κ·along·(length − along)/2, to its right when
                // it turns left.
                let rest = length - along;
                let bulge = i64::from(along.bits()).wrapping_mul(i64::from(rest.bits())) >> 16;
                let bulge = bulge.saturating_mul(i64::from(curvature)) >> 17;
                let sideways = chord.direction() - Angle::QUARTER;
                let place = place + Point::polar(Metres::from_bits(saturate(bulge)), sideways);
                let heading = from.heading + Angle::from_bits(part(turn.bits()));
                (Pose::new(place, heading), heading.rotation())
            }
        }
    }

    /// Tangent at the start.
    pub(crate) fn start_heading(&self) -> Angle {
        match *self {
            Self::Chord { from, .. } => from.heading,
            Self::Segment(Segment::Line { start, .. }) => start.heading,
            Self::Segment(Segment::Arc { from, sweep, .. }) => tangent(from, sweep),
        }
    }

    /// Tangent at the end.
    pub(crate) fn end_heading(&self) -> Angle {
        match *self {
            Self::Chord { to, .. } => to.heading,
            Self::Segment(Segment::Line { start, .. }) => start.heading,
            Self::Segment(Segment::Arc { from, sweep, .. }) => {
                tangent(from + Angle::from_bits(sweep.wrapping_shl(8)), sweep)
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

    /// Path length from the piece's start to the place on its line or circle that is nearest to `place`; below zero
    /// before the start, above the length behind the end. On a circle the solution within half a turn of `hint` is
    /// meant, and nearer to the centre than a quarter of the radius it is `hint` itself.
    pub(crate) fn project(&self, place: Point, hint: Metres) -> Metres {
        match *self {
            Self::Chord { from, to } => {
                let (chord, offset) = (to.at - from.at, place - from.at);
                let product =
                    |a: Metres, b: Metres| i64::from(a.bits()).wrapping_mul(b.bits().into());
                let dot = product(chord.x, offset.x).saturating_add(product(chord.y, offset.y));
                Metres::from_bits(quotient(dot, chord.norm().bits()).map_or(0, saturate))
            }
            Self::Segment(Segment::Line { start, .. }) => start.to_body(place).x,
            Self::Segment(Segment::Arc {
                centre,
                radius,
                from,
                sweep,
            }) => {
                let offset = place - centre;
                // Near the centre the nearest place says nothing and turns about with every step: stay.
                if offset.norm_squared() < square(radius) >> 4 {
                    return hint;
                }
                let out = offset.direction();
                let swept = if sweep >= 0 { out - from } else { from - out };
                let ahead = swept - angle_along(radius, hint);
                hint + along_arc(radius, i64::from(ahead.bits()))
            }
        }
    }
}
