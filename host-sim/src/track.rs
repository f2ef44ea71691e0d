//! The path in `f64`, for judging a run. It shares no arithmetic with the library's cursor.

use crate::world::wrap;
use std::f64::consts::FRAC_PI_2;

/// A piece of path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece {
    /// From a point to a point.
    Line {
        /// First point.
        from: [f64; 2],
        /// Last point.
        to: [f64; 2],
    },
    /// About `centre`, from direction `from`, over `sweep` radians, counter-clockwise positive.
    Arc {
        /// Centre.
        centre: [f64; 2],
        /// Radius.
        radius: f64,
        /// Direction of the first point from the centre, radians.
        from: f64,
        /// Angle swept, radians.
        sweep: f64,
    },
}

impl Piece {
    /// Length.
    pub fn length(&self) -> f64 {
        match *self {
            Self::Line { from, to } => libm::hypot(to[0] - from[0], to[1] - from[1]),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// Place and tangent at `along`.
    pub fn at(&self, along: f64) -> [f64; 3] {
        match *self {
            Self::Line { from, to } => {
                let heading = libm::atan2(to[1] - from[1], to[0] - from[0]);
                [
                    from[0] + along * libm::cos(heading),
                    from[1] + along * libm::sin(heading),
                    heading,
                ]
            }
            Self::Arc {
                centre,
                radius,
                from,
                sweep,
            } => {
                let out = from + along / radius * sweep.signum();
                [
                    centre[0] + radius * libm::cos(out),
                    centre[1] + radius * libm::sin(out),
                    wrap(out + FRAC_PI_2.copysign(sweep)),
                ]
            }
        }
    }

    /// Where on the piece, between its ends, (x, y) is nearest.
    fn nearest(&self, [x, y]: [f64; 2]) -> f64 {
        match *self {
            Self::Line { from, to } => {
                let length = self.length().max(1e-12);
                let (ux, uy) = ((to[0] - from[0]) / length, (to[1] - from[1]) / length);
                ((x - from[0]) * ux + (y - from[1]) * uy).clamp(0.0, length)
            }
            Self::Arc {
                centre,
                radius,
                from,
                sweep,
            } => {
                let out = (y - centre[1]).atan2(x - centre[0]);
                let turned = (wrap(out - from) * sweep.signum()).rem_euclid(std::f64::consts::TAU);
                if turned <= sweep.abs() {
                    return turned * radius;
                }
                let past = turned - sweep.abs();
                let before = std::f64::consts::TAU - turned;
                if past < before { self.length() } else { 0.0 }
            }
        }
    }
}

/// A path to judge by.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    pieces: Vec<Piece>,
    starts: Vec<f64>,
}

impl Track {
    /// From its pieces in order.
    pub fn new(pieces: Vec<Piece>) -> Self {
        let mut length = 0.0;
        let starts = pieces
            .iter()
            .map(|p| {
                let start = length;
                length += p.length();
                start
            })
            .collect();
        Self { pieces, starts }
    }

    /// The pieces.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Signed cross-track error of (x, y), left positive: its distance to the nearest place on the path not farther
    /// along it than 2 m from `progress`, or to the nearest of all where no piece has one there.
    pub fn cross_track(&self, at: [f64; 2], progress: f64) -> f64 {
        let window = 2.0;
        let (mut best, mut anywhere) = (f64::INFINITY, f64::INFINITY);
        let total = self.starts.last().copied().unwrap_or(0.0)
            + self.pieces.last().map_or(0.0, Piece::length);
        for (piece, start) in self.pieces.iter().zip(&self.starts) {
            let along = piece.nearest(at);
            let apart = (start + along - progress).abs();
            let [x, y, heading] = piece.at(along);
            let (dx, dy) = (at[0] - x, at[1] - y);
            let left = heading.cos() * dy - heading.sin() * dx;
            let error = dx.hypot(dy).copysign(left);
            // The neighbour across the seam of a closed path is near, too.
            if apart.min(total - apart) <= window && error.abs() < best.abs() {
                best = error;
            }
            if error.abs() < anywhere.abs() {
                anywhere = error;
            }
        }
        if best.is_finite() { best } else { anywhere }
    }

    /// The path as polylines, a new one after every gap.
    pub fn polylines(&self) -> Vec<Vec<[f64; 2]>> {
        let mut lines: Vec<Vec<[f64; 2]>> = Vec::new();
        for piece in &self.pieces {
            let steps = match piece {
                Piece::Line { .. } => 1,
                Piece::Arc { sweep, .. } => (sweep.abs() / 0.05).ceil().max(1.0) as usize,
            };
            let place = |i: usize| {
                let [x, y, _] = piece.at(piece.length() * i as f64 / steps as f64);
                [x, y]
            };
            let first = place(0);
            let joins = lines
                .last()
                .and_then(|line| line.last())
                .is_some_and(|end| (end[0] - first[0]).hypot(end[1] - first[1]) < 0.05);
            if !joins {
                lines.push(vec![first]);
            }
            if let Some(line) = lines.last_mut() {
                line.extend((1..=steps).map(place));
            }
        }
        lines
    }
}

impl Track {
    /// Total length.
    pub fn length(&self) -> f64 {
        self.pieces.iter().map(Piece::length).sum()
    }

    /// The place `offset` metres to the left of the path at `share` (0 to 1) of its length.
    pub fn beside(&self, share: f64, offset: f64) -> [f64; 2] {
        let along = share.clamp(0.0, 1.0) * self.length();
        let index = self
            .starts
            .iter()
            .rposition(|start| *start <= along)
            .unwrap_or(0);
        let [x, y, heading] = self
            .pieces
            .get(index)
            .map_or([0.0; 3], |p| p.at(along - self.starts[index]));
        [
            x - offset * libm::sin(heading),
            y + offset * libm::cos(heading),
        ]
    }
}
