//! A path in memory of its own, put together piece by piece at run time: checked once, lent every tick.

use super::path::{Path, PathError, Pieces, Segment, Waypoint};
use crate::units::Metres;
use heapless::Vec;

/// Room for a path of up to `SEGMENTS` lines and arcs or `POINTS` discrete points (not both: they share it).
///
/// ```
/// use fuzzypilot::{geometry::Pose, guide::{Segment, StoredPath}, units::Metres};
///
/// let mut store: StoredPath<4, 8> = StoredPath::new();
/// store.begin_segments(false);
/// store.push_segment(Segment::line(Pose::default(), Metres::lit("2")))?;
/// assert!(store.path().is_none());                     // not yet checked
/// store.commit(false)?;
/// assert_eq!(store.path().map(|path| path.length()), Some(Metres::lit("2")));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct StoredPath<const SEGMENTS: usize, const POINTS: usize> {
    stock: Stock<SEGMENTS, POINTS>,
    closed: bool,
    /// Length of the checked path; none, no path.
    length: Option<Metres>,
}

#[derive(Clone, Debug)]
enum Stock<const SEGMENTS: usize, const POINTS: usize> {
    Segments(Vec<Segment, SEGMENTS>),
    Points(Vec<Waypoint, POINTS>),
}

/// A piece that was not stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// No room for more of these.
    Full {
        /// The most.
        most: usize,
    },
    /// A point among segments, or a segment among points.
    OtherForm,
}

impl core::fmt::Display for StoreError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Full { most } => write!(f, "no room for more than {most} pieces"),
            Self::OtherForm => f.write_str("points and segments do not mix"),
        }
    }
}

impl core::error::Error for StoreError {}

impl<const SEGMENTS: usize, const POINTS: usize> Default for StoredPath<SEGMENTS, POINTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const SEGMENTS: usize, const POINTS: usize> StoredPath<SEGMENTS, POINTS> {
    /// Without a path.
    pub const fn new() -> Self {
        Self {
            stock: Stock::Segments(Vec::new()),
            closed: false,
            length: None,
        }
    }

    /// Forgets the path and begins one of lines and arcs.
    pub fn begin_segments(&mut self, closed: bool) {
        self.begin(Stock::Segments(Vec::new()), closed);
    }

    /// Forgets the path and begins one of discrete points.
    pub fn begin_points(&mut self, closed: bool) {
        self.begin(Stock::Points(Vec::new()), closed);
    }

    fn begin(&mut self, stock: Stock<SEGMENTS, POINTS>, closed: bool) {
        self.stock = stock;
        self.closed = closed;
        self.length = None;
    }

    /// Adds a segment; the path must be [committed](Self::commit) anew.
    pub fn push_segment(&mut self, segment: Segment) -> Result<(), StoreError> {
        let Stock::Segments(segments) = &mut self.stock else {
            return Err(StoreError::OtherForm);
        };
        self.length = None;
        let full = StoreError::Full { most: SEGMENTS };
        segments.push(segment).map_err(|_| full)
    }

    /// Adds a point; the path must be [committed](Self::commit) anew.
    pub fn push_point(&mut self, point: Waypoint) -> Result<(), StoreError> {
        let Stock::Points(points) = &mut self.stock else {
            return Err(StoreError::OtherForm);
        };
        self.length = None;
        let full = StoreError::Full { most: POINTS };
        points.push(point).map_err(|_| full)
    }

    /// Pieces stored so far, as they were pushed.
    pub fn stored(&self) -> usize {
        match &self.stock {
            Stock::Segments(segments) => segments.len(),
            Stock::Points(points) => points.len(),
        }
    }

    /// Checks what is stored, as [`Path::points`], [`Path::segments`] or, with `gaps`, [`Path::segments_with_gaps`] does;
    /// from then on it is the path.
    pub fn commit(&mut self, gaps: bool) -> Result<(), PathError> {
        let checked = match &self.stock {
            Stock::Points(points) => Path::points(points, self.closed),
            Stock::Segments(segments) if gaps => Path::segments_with_gaps(segments, self.closed),
            Stock::Segments(segments) => Path::segments(segments, self.closed),
        };
        self.length = None;
        self.length = Some(checked?.length());
        Ok(())
    }

    /// Takes over another path, which is checked already.
    pub fn copy(&mut self, path: &Path<'_>) -> Result<(), StoreError> {
        match path.pieces {
            Pieces::Points(points) => {
                self.begin_points(path.closed);
                for point in points {
                    self.push_point(*point)?;
                }
            }
            Pieces::Segments(segments) => {
                self.begin_segments(path.closed);
                for segment in segments {
                    self.push_segment(*segment)?;
                }
            }
        }
        self.length = Some(path.length());
        Ok(())
    }

    /// The path, if there is a checked one. Costs nothing: the check was made once.
    pub fn path(&self) -> Option<Path<'_>> {
        let pieces = match &self.stock {
            Stock::Segments(segments) => Pieces::Segments(segments),
            Stock::Points(points) => Pieces::Points(points),
        };
        let length = self.length?;
        Some(Path::checked_before(pieces, self.closed, length))
    }
}
