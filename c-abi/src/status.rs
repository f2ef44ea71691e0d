//! What a call answers with.

use core::ffi::{CStr, c_char};

/// What came of a call.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpStatus {
    /// Done.
    Ok = 0,
    /// A pointer is null.
    NullPointer = 1,
    /// A pointer is not a multiple of its type's alignment.
    Misaligned = 2,
    /// A size or count is not the one of this library: header and library are of different versions, or the number of
    /// readings is not the number of sensors.
    WrongSize = 3,
    /// The storage was not initialised.
    NotInitialised = 4,
    /// A number stands for none of the choices.
    UnknownChoice = 5,
    /// No setting has this id, or it belongs to a sensor that is not mounted.
    UnknownSetting = 6,
    /// The setting may not have this value, alone or beside the others.
    SettingNotAllowed = 7,
    /// Settings have changed since fp_robot_restart checked them.
    NotStarted = 8,
    /// No path was set.
    NoPath = 9,
    /// A path needs at least two points or one segment.
    PathTooShort = 10,
    /// The path has more pieces than there is room for.
    PathTooLong = 11,
    /// A piece of the path has no length, no positive radius, or a sweep of none or over a turn.
    PathDegenerate = 12,
    /// A segment of the path does not start where the one before ends.
    PathGap = 13,
}

impl From<Result<(), FpStatus>> for FpStatus {
    fn from(result: Result<(), FpStatus>) -> Self {
        match result {
            Ok(()) => Self::Ok,
            Err(status) => status,
        }
    }
}

/// A status in words; never null, lives for ever.
#[unsafe(no_mangle)]
pub extern "C" fn fp_status_text(status: i32) -> *const c_char {
    let text: &CStr = match status {
        0 => c"done",
        1 => c"a pointer is null",
        2 => c"a pointer is misaligned",
        3 => c"a size or count is not the library's",
        4 => c"the storage was not initialised",
        5 => c"a number stands for none of the choices",
        6 => c"no setting has this id",
        7 => c"the setting may not have this value, alone or beside the others",
        8 => c"settings have changed: fp_robot_restart comes first",
        9 => c"no path was set",
        10 => c"a path needs at least two points or one segment",
        11 => c"the path has more pieces than there is room for",
        12 => c"a piece of the path has no length, no positive radius, or a sweep of none or over a turn",
        13 => c"a segment of the path does not start where the one before ends",
        _ => c"no status of this library",
    };
    text.as_ptr()
}
