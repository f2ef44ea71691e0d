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
    Ok(Stream::new(builder.open()?, port.to_owned()))
}
