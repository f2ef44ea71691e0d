//! A pipe for bytes that leads to a robot.

use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// A pipe for bytes. Frames go in whole, bytes come out as they may.
pub trait Wire {
    /// Sends a frame.
    ///
    /// # Errors
    ///
    /// Nothing can be sent any more.
    fn send(&mut self, frame: &[u8]) -> io::Result<()>;

    /// Takes what has come, waiting up to `patience` for it; 0 if nothing has.
    ///
    /// # Errors
    ///
    /// Nothing will come any more.
    fn receive(&mut self, room: &mut [u8], patience: Duration) -> io::Result<usize>;

    /// The time by which it waits.
    fn now(&self) -> Duration;

    /// What it leads to.
    fn name(&self) -> String;

    /// Why it ended, if somebody knows better than the system.
    fn last_words(&mut self) -> Option<String> {
        None
    }

    /// Control period `number` of the run begins.
    fn period(&mut self, _number: u64) {}

    /// Frames that were spoiled on purpose, by kind.
    fn faults(&self) -> Vec<(String, u64)> {
        Vec::new()
    }

    /// What the robot has logged so far.
    fn log(&self) -> Vec<u8> {
        Vec::new()
    }
}

/// A stream whose patience can be set.
pub trait Patient: Read + Write {
    /// Sets the longest time for the next read; not zero.
    ///
    /// # Errors
    ///
    /// The system's.
    fn set_patience(&mut self, patience: Duration) -> io::Result<()>;
}

/// A stream of the system as a wire.
pub struct Stream<S> {
    stream: S,
    start: Instant,
    name: String,
}

impl<S: Patient> Stream<S> {
    /// Over an open stream.
    pub fn new(stream: S, name: String) -> Self {
        Self {
            stream,
            start: Instant::now(),
            name,
        }
    }
}

impl<S: Patient> Wire for Stream<S> {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        self.stream.set_patience(Duration::from_secs(1))?;
        self.stream.write_all(frame)
    }

    fn receive(&mut self, room: &mut [u8], patience: Duration) -> io::Result<usize> {
        self.stream
            .set_patience(patience.max(Duration::from_millis(1)))?;
        match self.stream.read(room) {
            Ok(0) => Err(io::Error::new(ErrorKind::UnexpectedEof, "it was closed")),
            Err(error)
                if matches!(
                    error.kind(),
                    ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                ) =>
            {
                Ok(0)
            }
            done => done,
        }
    }

    fn now(&self) -> Duration {
        self.start.elapsed()
    }

    fn name(&self) -> String {
        self.name.clone()
    }
}
