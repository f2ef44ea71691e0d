//! Statics that can be changed.

use core::cell::UnsafeCell;

/// Memory that an image's single thread has for itself.
pub struct Owned<T>(UnsafeCell<T>);

// SAFETY: no interrupt is ever enabled, so there is one thread.
unsafe impl<T> Sync for Owned<T> {}

impl<T> Owned<T> {
    /// With `value` in it.
    pub const fn new(value: T) -> Self {
        Self(UnsafeCell::new(value))
    }

    /// The memory.
    ///
    /// # Safety
    ///
    /// To be called once.
    #[allow(clippy::mut_from_ref)]
    pub unsafe fn take(&self) -> &mut T {
        unsafe { &mut *self.0.get() }
    }
}
