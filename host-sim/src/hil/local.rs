//! The firmware's pilot in this process: the same bytes as over a wire, without a wire.

use super::wire::Wire;
use fuzzypilot::geometry::Pose;
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::pilot::Pilot;
use fuzzypilot::presets;
use fuzzypilot::units::Metres;
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// As large as the firmware's.
pub type LocalPilot = Pilot<64, 32, 64>;

/// Time that a byte takes.
const BYTE: Duration = Duration::from_micros(20);

/// A pilot behind a pipe. Its time goes on with bytes and with waiting, so that a run does not depend on the desktop's
/// speed, and waiting costs none.
pub struct Local {
    pilot: Box<LocalPilot>,
    answers: VecDeque<u8>,
    now: Duration,
}

impl Default for Local {
    fn default() -> Self {
        Self::new()
    }
}

impl Local {
    /// A robot that was just switched on.
    pub fn new() -> Self {
        Self {
            pilot: Box::new(Pilot::new(presets::small_robot(), Pose::default())),
            answers: VecDeque::new(),
            now: Duration::ZERO,
        }
    }

    /// What the firmware does after a plant: its own settings again, and a metre straight on.
    fn restore(&mut self) {
        if self.pilot.is_orphaned() {
            let own = |params: &mut _| *params = presets::small_robot();
            self.pilot.restore(Pose::default(), own);
            let metre = [Segment::line(Pose::default(), Metres::lit("1"))];
            let path = Path::segments(&metre, false).ok();
            // There is room for it.
            let _ = path.map(|path| self.pilot.set_path(&path));
        }
    }

    /// The robot.
    pub fn pilot(&self) -> &LocalPilot {
        &self.pilot
    }
}

impl Wire for Local {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        for byte in frame {
            self.now += BYTE;
            let now_us = self.now.as_micros() as u32;
            self.restore();
            self.pilot.receive(*byte, now_us, &mut |frame: &[u8]| {
                self.answers.extend(frame);
            });
        }
        Ok(())
    }

    fn receive(&mut self, room: &mut [u8], patience: Duration) -> io::Result<usize> {
        if self.answers.is_empty() {
            self.now += patience;
            return Ok(0);
        }
        let count = room.len().min(self.answers.len());
        for (place, byte) in room.iter_mut().zip(self.answers.drain(..count)) {
            *place = byte;
        }
        self.now += BYTE * count as u32;
        Ok(count)
    }

    fn now(&self) -> Duration {
        self.now
    }

    fn name(&self) -> String {
        "the pilot in this process".to_owned()
    }
}
