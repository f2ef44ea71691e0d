//! A path of lines and arcs, or of points, kept in the caller's memory.

use crate::pointer;
use crate::robot::FpPose;
use crate::status::FpStatus;
use crate::storage::{self, Storage};
use core::mem::MaybeUninit;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{PathError, Segment, StoredPath};
use fuzzypilot::units::{Angle, Metres};

/// The most segments of a path.
pub const FP_SEGMENTS_MAX: usize = 64;
/// The most points of a path.
pub const FP_POINTS_MAX: usize = 128;
/// Words of an fp_path.
pub const FP_PATH_WORDS: usize = 200;

/// Flag of a path: its end joins its start.
pub const FP_PATH_CLOSED: u32 = 1;
/// Flag of a path: segments may start away from where the ones before end; the robot makes its own way across.
pub const FP_PATH_GAPS: u32 = 2;

/// Memory for a path: FP_SEGMENTS_MAX segments or FP_POINTS_MAX points. What is in it is the library's; it may be
/// copied, and needs no end.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FpPath {
    /// Not for use.
    pub opaque: [u64; FP_PATH_WORDS],
}

pub(crate) type Path = StoredPath<FP_SEGMENTS_MAX, FP_POINTS_MAX>;

// SAFETY: integers; fits.
unsafe impl Storage for FpPath {
    type Tenant = Path;
    const MARK: u32 = u32::from_le_bytes(*b"fpP1");
}
const _: () = assert!(storage::fits::<FpPath>(), "FP_PATH_WORDS is too small");

/// What a segment is.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpSegmentKind {
    /// A straight line.
    Line = 0,
    /// A circular arc.
    Arc = 1,
}

/// A line or a circular arc. fp_line and fp_arc fill it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpSegment {
    /// One of fp_segment_kind.
    pub kind: i32,
    /// Start of a line, centre of an arc: world, m / 2^16.
    pub x: i32,
    /// Likewise.
    pub y: i32,
    /// Of a line its heading, of an arc the direction from its centre to its first point: turn / 2^32.
    pub direction: i32,
    /// Length of a line, radius of an arc: m / 2^16, above 0.
    pub extent: i32,
    /// Angle that an arc sweeps, turn / 2^24, counter-clockwise positive, at most one turn either way. Not read of a
    /// line.
    pub sweep: i32,
}

fn segment(from: &FpSegment) -> Result<Segment, FpStatus> {
    let at = Point::new(Metres::from_bits(from.x), Metres::from_bits(from.y));
    let direction = Angle::from_bits(from.direction);
    let extent = Metres::from_bits(from.extent);
    match from.kind {
        0 => Ok(Segment::line(Pose::new(at, direction), extent)),
        1 => Ok(Segment::Arc {
            centre: at,
            radius: extent,
            from: direction,
            sweep: from.sweep,
        }),
        _ => Err(FpStatus::UnknownChoice),
    }
}

/// Which flags are set: closed, gaps.
fn read_flags(flags: u32) -> Result<(bool, bool), FpStatus> {
    match flags & !(FP_PATH_CLOSED | FP_PATH_GAPS) {
        0 => Ok((flags & FP_PATH_CLOSED != 0, flags & FP_PATH_GAPS != 0)),
        _ => Err(FpStatus::UnknownChoice),
    }
}

/// Why there is no path, and which piece is to blame.
fn refused(error: PathError) -> (FpStatus, usize) {
    match error {
        PathError::TooShort => (FpStatus::PathTooShort, 0),
        PathError::TooMany => (FpStatus::PathTooLong, 0),
        PathError::Degenerate(piece) => (FpStatus::PathDegenerate, piece),
        PathError::Gap(piece) => (FpStatus::PathGap, piece),
    }
}

/// Checks what was stored.
fn commit(
    path: &mut Path,
    gaps: bool,
    piece: Option<&mut MaybeUninit<usize>>,
) -> Result<(), FpStatus> {
    path.commit(gaps).map_err(|error| {
        let (status, index) = refused(error);
        if let Some(piece) = piece {
            piece.write(index);
        }
        status
    })
}

/// Prepares memory for a path, without one; `size` is sizeof(fp_path).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_path_init(path: *mut FpPath, size: usize) -> FpStatus {
    // SAFETY: the contract of `pointer`; the tenant is written.
    let init = unsafe {
        storage::move_in(path, size, |place| {
            place.write(Path::new());
        })
    };
    init.into()
}

/// Sets a path of `count` segments that follow each other, copied and checked; flags are FP_PATH_CLOSED and
/// FP_PATH_GAPS, or 0. After an error in the segments themselves there is no path; `piece`, if not null, then tells which
/// segment is to blame, from 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_path_set_segments(
    path: *mut FpPath,
    segments: *const FpSegment,
    count: usize,
    flags: u32,
    piece: *mut usize,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let set = || unsafe {
        let (closed, gaps) = read_flags(flags)?;
        let segments = pointer::slice(segments, count)?;
        let piece = pointer::optional_room(piece)?;
        let path = storage::tenant_mut(path)?;
        if segments.len() > FP_SEGMENTS_MAX {
            return Err(FpStatus::PathTooLong);
        }
        path.begin_segments(closed);
        for (index, from) in segments.iter().enumerate() {
            match segment(from) {
                Ok(segment) => path
                    .push_segment(segment)
                    .map_err(|_| FpStatus::PathTooLong)?,
                Err(status) => {
                    if let Some(piece) = piece {
                        piece.write(index);
                    }
                    return Err(status);
                }
            }
        }
        commit(path, gaps, piece)
    };
    set().into()
}

/// Sets a path through `count` points, each with the tangent's direction as heading, copied and checked; flags are
/// FP_PATH_CLOSED or 0. After an error in the points themselves there is no path; `piece`, if not null, then tells
/// which gap between points is to blame, from 0.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_path_set_points(
    path: *mut FpPath,
    points: *const FpPose,
    count: usize,
    flags: u32,
    piece: *mut usize,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let set = || unsafe {
        let (closed, gaps) = read_flags(flags)?;
        if gaps {
            return Err(FpStatus::UnknownChoice);
        }
        let points = pointer::slice(points, count)?;
        let piece = pointer::optional_room(piece)?;
        let path = storage::tenant_mut(path)?;
        if points.len() > FP_POINTS_MAX {
            return Err(FpStatus::PathTooLong);
        }
        path.begin_points(closed);
        for &point in points {
            path.push_point(point.into())
                .map_err(|_| FpStatus::PathTooLong)?;
        }
        commit(path, false, piece)
    };
    set().into()
}

/// Length of the path, m / 2^16; of a closed one, of a lap.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_path_length(path: *const FpPath, length: *mut i32) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let get = || unsafe {
        let (path, place) = (storage::tenant(path)?, pointer::room(length)?);
        let path = path.path().ok_or(FpStatus::NoPath)?;
        place.write(path.length().bits());
        Ok(())
    };
    get().into()
}

/// sizeof(fp_path), as the library has it.
#[unsafe(no_mangle)]
pub extern "C" fn fp_path_size() -> usize {
    size_of::<FpPath>()
}
