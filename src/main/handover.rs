//! How a value changes its owner: from `main` to an interrupt, or from step to step.

use core::cell::RefCell;
use critical_section::Mutex;

/// A place for one value: the newest that was put and not yet taken.
pub struct Handover<T>(Mutex<RefCell<Option<T>>>);

impl<T> Handover<T> {
    /// Empty.
    pub const fn new() -> Self {
        Self(Mutex::new(RefCell::new(None)))
    }

    pub fn put(&self, value: T) {
        critical_section::with(|cs| {
            // Never borrowed elsewhere: the critical section is the only way in.
            if let Ok(mut place) = self.0.borrow(cs).try_borrow_mut() {
                *place = Some(value);
            }
        });
    }

    pub fn take(&self) -> Option<T> {
        critical_section::with(|cs| self.0.borrow(cs).try_borrow_mut().ok()?.take())
    }
}
