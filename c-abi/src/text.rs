//! Text into the caller's memory.

use crate::pointer;
use crate::status::FpStatus;
use core::ffi::c_char;
use core::mem::MaybeUninit;

/// Writes `parts` one behind the other, and a zero; what has no room is cut off.
///
/// # Safety
///
/// That of [`mod@pointer`], for `room` characters.
pub(crate) unsafe fn write(to: *mut c_char, room: usize, parts: &[&str]) -> Result<(), FpStatus> {
    if room == 0 {
        return Err(FpStatus::WrongSize);
    }
    // SAFETY: the contract; what is not yet written may lie there as `MaybeUninit`.
    let places = unsafe { pointer::slice_mut(to.cast::<MaybeUninit<u8>>(), room) }?;
    let bytes = parts.iter().flat_map(|part| part.bytes());
    let zeros = core::iter::once(0);
    let most = room.saturating_sub(1);
    for (place, byte) in places.iter_mut().zip(bytes.take(most).chain(zeros)) {
        place.write(byte);
    }
    Ok(())
}
