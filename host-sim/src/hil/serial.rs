//! A serial port: a board's USB or debugger port, or a pseudo-terminal.

use super::wire::{Patient, Stream};
use serialport::{SerialPort, SerialPortBuilder};
use std::io;
use std::time::Duration;

/// What the firmware's port runs at.
pub const BAUD: u32 = 460_800;

impl Patient for Box<dyn SerialPort> {
    fn set_patience(&mut self, patience: Duration) -> io::Result<()> {
        self.as_mut().set_timeout(patience).map_err(io::Error::from)
    }
}

/// Opens it, 8N1.
///
/// # Errors
///
/// There is no such port, it may not be opened, or it is in use.
pub fn open(port: &str, baud: u32) -> io::Result<Stream<Box<dyn SerialPort>>> {
    let builder: SerialPortBuilder = serialport::new(port, baud);
    let open = builder.open().map_err(|error| {
        let error = io::Error::from(error);
        // What the system calls a file or device of another kind.
        match error.to_string().contains("typewriter") {
            true => io::Error::new(error.kind(), "it is no serial port"),
            false => error,
        }
    })?;
    Ok(Stream::new(open, port.to_owned()))
}
