//! Frames on the wire.
//!
//! ```text
//! raw:   version │ sequence number │ message, postcard │ CRC-32, little endian, over all before it
//! wire:  COBS of raw (one byte more, none of them zero) │ 0x00
//! ```
//!
//! A zero always ends a frame, so the receiver finds the next one whatever came before.
//!
//! COBS and CRC are written here: ten lines each, where the crates `cobs` and `crc` keep an overflow panic each in an
//! image with overflow checks. (`postcard` does, too; the workspace's release profile switches its checks off.)

use serde::{Deserialize, Serialize};

/// Version of the protocol: framing, messages, record layout and setting ids together.
pub const VERSION: u8 = 1;

/// The longest frame on the wire, with its terminator.
pub const MAX_FRAME: usize = 64;

/// The longest message in a frame.
pub const MAX_MESSAGE: usize = MAX_FRAME - ENVELOPE - 2;

/// Version, sequence number and CRC.
const ENVELOPE: usize = 6;

/// Writes `message` as a frame; what is to be sent, terminator included. `None` if it is longer than [`MAX_MESSAGE`],
/// which no message of [`message`](super::message) is.
pub fn encode<'a>(
    sequence: u8,
    message: &impl Serialize,
    wire: &'a mut [u8; MAX_FRAME],
) -> Option<&'a [u8]> {
    // Raw begins at 1: COBS needs one byte in front.
    let [_, version, number, room @ ..] = wire;
    (*version, *number) = (VERSION, sequence);
    let room = room.get_mut(..MAX_MESSAGE)?;
    let length = postcard::to_slice(message, room).ok()?.len();
    let end = length.checked_add(3)?;
    let check = crc32(wire.get(1..end)?);
    *wire.get_mut(end..)?.first_chunk_mut()? = check.to_le_bytes();
    let raw_end = end.checked_add(4)?;
    stuff(wire.get_mut(..raw_end)?);
    *wire.get_mut(raw_end)? = 0;
    wire.get(..=raw_end)
}

/// CRC-32 (ISO-HDLC), Python's `zlib.crc32`; four bits a step.
fn crc32(bytes: &[u8]) -> u32 {
    const STEP: [u32; 16] = {
        let mut table = [0; 16];
        let mut i = 0;
        while i < 16 {
            let mut rest = i as u32;
            let mut bit = 0;
            while bit < 4 {
                rest = (rest >> 1) ^ (0xedb8_8320 * (rest & 1));
                bit += 1;
            }
            table[i] = rest;
            i += 1;
        }
        table
    };
    let mut crc = !0u32;
    for byte in bytes {
        crc ^= u32::from(*byte);
        crc = (crc >> 4) ^ STEP[(crc & 15) as usize];
        crc = (crc >> 4) ^ STEP[(crc & 15) as usize];
    }
    !crc
}

/// COBS in place: the first byte is the way to the first zero after it, and every zero becomes the way to the next.
fn stuff(bytes: &mut [u8]) {
    let mut way = 1u8;
    for byte in bytes.iter_mut().skip(1).rev() {
        if *byte == 0 {
            *byte = way;
            way = 1;
        } else {
            way = way.saturating_add(1);
        }
    }
    if let Some(first) = bytes.first_mut() {
        *first = way;
    }
}

/// Undoes [`stuff`]; whether the ways lead to the end exactly.
fn unstuff(bytes: &mut [u8]) -> bool {
    // The first byte is a way that begins in front of it.
    let mut way = 1u8;
    for byte in bytes {
        way = way.saturating_sub(1);
        if way == 0 {
            way = core::mem::take(byte);
        }
    }
    way == 1
}

/// A sound frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Sequence number.
    pub sequence: u8,
    /// Its CRC: two frames with equal sequence number and CRC are the same frame.
    pub check: u32,
    /// The message's bytes.
    pub message: &'a [u8],
}

impl<'a> Frame<'a> {
    /// The message, if the bytes are one, wholly.
    pub fn parse<M: Deserialize<'a>>(&self) -> Option<M> {
        match postcard::take_from_bytes(self.message) {
            Ok((message, [])) => Some(message),
            _ => None,
        }
    }
}

/// Why what stood between two zeros is no frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum FrameError {
    /// More than [`MAX_FRAME`] bytes: a terminator was lost.
    Overlong,
    /// Too few bytes, or COBS that leads past the end: bytes were lost.
    Truncated,
    /// The CRC does not match: bytes were changed.
    Corrupt,
    /// A sound frame of another protocol version.
    Version {
        /// Its version.
        found: u8,
        /// Its sequence number.
        sequence: u8,
    },
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Overlong => write!(f, "frame of more than {MAX_FRAME} bytes"),
            Self::Truncated => f.write_str("frame with bytes missing"),
            Self::Corrupt => f.write_str("frame with a wrong CRC"),
            Self::Version { found, .. } => {
                write!(f, "frame of protocol version {found}; this is {VERSION}")
            }
        }
    }
}

impl core::error::Error for FrameError {}

/// Frames out of a stream of bytes.
#[derive(Clone, Debug)]
pub struct Decoder {
    bytes: [u8; MAX_FRAME],
    /// Bytes since the last zero; beyond [`MAX_FRAME`] they are not kept.
    length: u8,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// At the beginning of a frame.
    pub const fn new() -> Self {
        Self {
            bytes: [0; MAX_FRAME],
            length: 0,
        }
    }

    /// Takes one byte; a terminator yields what it ends. Nothing between two terminators is no frame and no error.
    pub fn push(&mut self, byte: u8) -> Option<Result<Frame<'_>, FrameError>> {
        if byte != 0 {
            if let Some(place) = self.bytes.get_mut(usize::from(self.length)) {
                *place = byte;
            }
            self.length = self.length.saturating_add(1);
            return None;
        }
        let length = usize::from(core::mem::take(&mut self.length));
        match length {
            0 => None,
            1..MAX_FRAME => Some(unpack(self.bytes.get_mut(..length).unwrap_or_default())),
            _ => Some(Err(FrameError::Overlong)),
        }
    }
}

fn unpack(wire: &mut [u8]) -> Result<Frame<'_>, FrameError> {
    if !unstuff(wire) {
        return Err(FrameError::Truncated);
    }
    let [_, raw @ ..] = wire else {
        return Err(FrameError::Truncated);
    };
    let Some((content, check)) = raw.split_last_chunk() else {
        return Err(FrameError::Truncated);
    };
    let [version, sequence, message @ ..] = content else {
        return Err(FrameError::Truncated);
    };
    let check = u32::from_le_bytes(*check);
    if crc32(content) != check {
        return Err(FrameError::Corrupt);
    }
    if *version != VERSION {
        return Err(FrameError::Version {
            found: *version,
            sequence: *sequence,
        });
    }
    Ok(Frame {
        sequence: *sequence,
        check,
        message,
    })
}

/// How many frames came in, and how they were.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Sound frames; wraps.
    pub good: u32,
    /// [`FrameError::Overlong`]; this and the next three stay at their largest value.
    pub overlong: u16,
    /// [`FrameError::Truncated`].
    pub truncated: u16,
    /// [`FrameError::Corrupt`].
    pub corrupt: u16,
    /// [`FrameError::Version`].
    pub version: u16,
}

impl Counters {
    /// All zero.
    pub const fn new() -> Self {
        Self {
            good: 0,
            overlong: 0,
            truncated: 0,
            corrupt: 0,
            version: 0,
        }
    }

    /// Counts what a [`Decoder`] yielded.
    pub fn note(&mut self, result: &Result<Frame<'_>, FrameError>) {
        let counter = match result {
            Ok(_) => {
                self.good = self.good.wrapping_add(1);
                return;
            }
            Err(FrameError::Overlong) => &mut self.overlong,
            Err(FrameError::Truncated) => &mut self.truncated,
            Err(FrameError::Corrupt) => &mut self.corrupt,
            Err(FrameError::Version { .. }) => &mut self.version,
        };
        *counter = counter.saturating_add(1);
    }
}
