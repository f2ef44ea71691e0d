//! What a crash leaves in a word of memory that a reset does not clear, for the next start to tell.

use crate::link::message::Cause;

/// No memory comes up with this by chance, one time in 2^24 aside.
const MAGIC: u32 = 0xFA17_ED00;

/// The word for a cause; of causes that no crash has, that of [`Cause::Boot`].
pub const fn word(cause: Cause) -> u32 {
    MAGIC
        | match cause {
            Cause::Panic => 1,
            Cause::HardFault => 2,
            _ => 0,
        }
}

/// The cause that was left, if one was.
pub const fn cause(word: u32) -> Option<Cause> {
    match word ^ MAGIC {
        1 => Some(Cause::Panic),
        2 => Some(Cause::HardFault),
        _ => None,
    }
}
