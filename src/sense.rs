//! Raw readings to what the controllers understand: wheel travel, echo points, circles.
//!
//! Cost: one pass over the ring, one circle fit a segment; at most [`MAX_BEAMS`](crate::params::MAX_BEAMS) echoes and
//! [`MAX_OBSTACLES`](crate::signals::MAX_OBSTACLES) obstacles.

mod circle;
mod scan;

pub use circle::{CircleFit, fit_circle};
pub use scan::{Beams, sense_ranges};

use crate::ports::{Fault, WheelCounts};
use crate::signals::Travel;

/// Turns cumulative counts into travel. A missed reading is made good by the next one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Odometer {
    last: Option<WheelCounts>,
}

impl Odometer {
    /// Before the first reading.
    pub const fn new() -> Self {
        Self { last: None }
    }

    /// Travel since the last good reading; the first reading is the zero.
    pub fn travel(&mut self, reading: Result<WheelCounts, Fault>) -> Travel {
        match reading {
            Ok(now) => {
                let last = self.last.replace(now).unwrap_or(now);
                Travel::Counts {
                    left: now.left.wrapping_sub(last.left),
                    right: now.right.wrapping_sub(last.right),
                }
            }
            Err(fault) => Travel::Unknown(fault),
        }
    }
}
