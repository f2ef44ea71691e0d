//! Pointers from C. What can be seen of a wrong one is answered with a status; the rest is the caller's part: a pointer
//! that is neither null nor misaligned leads to a whole value of its type (or to room for one, if it is only written),
//! which nobody else uses during the call.

use crate::status::FpStatus;
use core::mem::MaybeUninit;

/// Whether a pointer is neither null nor misaligned.
pub(crate) fn check<T>(at: *const T) -> Result<(), FpStatus> {
    match (at.is_null(), at.is_aligned()) {
        (true, _) => Err(FpStatus::NullPointer),
        (_, false) => Err(FpStatus::Misaligned),
        _ => Ok(()),
    }
}

/// What `at` leads to.
///
/// # Safety
///
/// The module's contract.
pub(crate) unsafe fn read<'a, T>(at: *const T) -> Result<&'a T, FpStatus> {
    check(at)?;
    // SAFETY: neither null nor misaligned; the rest is the contract.
    Ok(unsafe { &*at })
}

/// Room for one value.
///
/// # Safety
///
/// The module's contract.
pub(crate) unsafe fn room<'a, T>(at: *mut T) -> Result<&'a mut MaybeUninit<T>, FpStatus> {
    check(at)?;
    // SAFETY: neither null nor misaligned; the rest is the contract.
    Ok(unsafe { &mut *at.cast() })
}

/// Room that the caller may leave away.
///
/// # Safety
///
/// The module's contract, or null.
pub(crate) unsafe fn optional_room<'a, T>(
    at: *mut T,
) -> Result<Option<&'a mut MaybeUninit<T>>, FpStatus> {
    if at.is_null() {
        return Ok(None);
    }
    // SAFETY: the contract.
    unsafe { room(at) }.map(Some)
}

/// `count` values; `at` may be null if that is 0.
///
/// # Safety
///
/// The module's contract, for all of them; none is written during the call.
pub(crate) unsafe fn slice<'a, T>(at: *const T, count: usize) -> Result<&'a [T], FpStatus> {
    if count == 0 {
        return Ok(&[]);
    }
    check(at)?;
    check_length::<T>(count)?;
    // SAFETY: neither null nor misaligned, and no longer than a slice may be; the rest is the contract.
    Ok(unsafe { core::slice::from_raw_parts(at, count) })
}

/// Room for `count` values.
///
/// # Safety
///
/// The module's contract, for all of them.
pub(crate) unsafe fn slice_mut<'a, T>(
    at: *mut MaybeUninit<T>,
    count: usize,
) -> Result<&'a mut [MaybeUninit<T>], FpStatus> {
    check(at)?;
    check_length::<T>(count)?;
    // SAFETY: neither null nor misaligned, and no longer than a slice may be; the rest is the contract.
    Ok(unsafe { core::slice::from_raw_parts_mut(at, count) })
}

/// No slice is longer.
fn check_length<T>(count: usize) -> Result<(), FpStatus> {
    match count.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(FpStatus::WrongSize),
    }
}
