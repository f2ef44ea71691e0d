//! Values that live in the caller's memory, behind a word that says that they do.

use crate::pointer;
use crate::status::FpStatus;
use core::mem::MaybeUninit;

/// Memory that the caller has set aside for one [`Storage::Tenant`].
///
/// # Safety
///
/// Any bits are a value of the implementer, and [`fits`] is asserted for it while this compiles.
pub(crate) unsafe trait Storage: Sized {
    /// What lives there. It is never dropped, and may be moved by copying its bytes.
    type Tenant;
    /// Stands in front of the tenant.
    const MARK: u32;
}

/// What stands in a storage.
#[repr(C)]
struct House<T> {
    mark: u32,
    tenant: MaybeUninit<T>,
}

/// Whether a storage is large enough.
pub(crate) const fn fits<S: Storage>() -> bool {
    size_of::<House<S::Tenant>>() <= size_of::<S>()
        && align_of::<House<S::Tenant>>() <= align_of::<S>()
}

/// Puts a tenant there, written by `make`. `size` is what the caller takes the storage's size to be.
///
/// # Safety
///
/// That of [`mod@pointer`], and `make` writes all of the tenant.
pub(crate) unsafe fn move_in<S: Storage>(
    at: *mut S,
    size: usize,
    make: impl FnOnce(&mut MaybeUninit<S::Tenant>),
) -> Result<(), FpStatus> {
    if size != size_of::<S>() {
        return Err(FpStatus::WrongSize);
    }
    pointer::check(at)?;
    let house = at.cast::<House<S::Tenant>>();
    // SAFETY: the storage fits the house, and is neither null nor misaligned.
    unsafe {
        make(&mut (*house).tenant);
        (*house).mark = S::MARK;
    }
    Ok(())
}

/// Where the tenant is, if there is one.
///
/// # Safety
///
/// That of [`mod@pointer`]; and what has the mark was written by [`move_in`], or is a copy of such.
unsafe fn find<S: Storage>(at: *mut S) -> Result<*mut S::Tenant, FpStatus> {
    pointer::check(at)?;
    let house = at.cast::<House<S::Tenant>>();
    // SAFETY: the storage fits the house, and is neither null nor misaligned.
    unsafe {
        match (*house).mark == S::MARK {
            true => Ok((*house).tenant.as_mut_ptr()),
            false => Err(FpStatus::NotInitialised),
        }
    }
}

/// The tenant, to look at.
///
/// # Safety
///
/// That of [`find`].
pub(crate) unsafe fn tenant<'a, S: Storage>(at: *const S) -> Result<&'a S::Tenant, FpStatus> {
    // SAFETY: the contract; nothing is written.
    unsafe { find(at.cast_mut()).map(|tenant| &*tenant) }
}

/// The tenant, to work with.
///
/// # Safety
///
/// That of [`find`].
pub(crate) unsafe fn tenant_mut<'a, S: Storage>(at: *mut S) -> Result<&'a mut S::Tenant, FpStatus> {
    // SAFETY: the contract.
    unsafe { find(at).map(|tenant| &mut *tenant) }
}
