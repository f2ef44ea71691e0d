//! The host's files, in blocks.

use crate::tape::Source;
use semihosting::fs::File;
use semihosting::io::{Read, Write};

const BLOCK: usize = 256;

/// The tapes.
pub struct Input {
    file: Option<File>,
    block: [u8; BLOCK],
    at: usize,
    end: usize,
}

impl Default for Input {
    fn default() -> Self {
        Self::new()
    }
}

impl Input {
    /// Not opened.
    pub const fn new() -> Self {
        Self {
            file: None,
            block: [0; BLOCK],
            at: 0,
            end: 0,
        }
    }

    /// Opens the file `tape`; none if it cannot be read.
    pub fn open(&mut self) -> Option<()> {
        self.file = Some(File::open(c"tape").ok()?);
        Some(())
    }
}

impl Source for Input {
    fn byte(&mut self) -> u8 {
        if self.at >= self.end {
            let file = self.file.as_mut();
            self.end = file.map_or(0, |file| file.read(&mut self.block).unwrap_or(0));
            self.at = 0;
        }
        // Zeros after the end: they end the tapes.
        let byte = self.block.get(self.at..self.end).and_then(<[u8]>::first);
        self.at = self.at.saturating_add(1);
        byte.copied().unwrap_or(0)
    }
}

/// What the image has to say.
pub struct Output {
    file: Option<File>,
    block: [u8; BLOCK],
    filled: usize,
    whole: bool,
}

impl Default for Output {
    fn default() -> Self {
        Self::new()
    }
}

impl Output {
    /// Not created.
    pub const fn new() -> Self {
        Self {
            file: None,
            block: [0; BLOCK],
            filled: 0,
            whole: true,
        }
    }

    /// Creates the file `out`; none if it cannot be written.
    pub fn create(&mut self) -> Option<()> {
        self.file = Some(File::create(c"out").ok()?);
        Some(())
    }

    /// Appends; what is lost is told by [`finish`](Self::finish).
    pub fn write(&mut self, mut bytes: &[u8]) {
        while !bytes.is_empty() {
            let room = &mut self.block[self.filled..];
            let taken = room.len().min(bytes.len());
            room[..taken].copy_from_slice(&bytes[..taken]);
            bytes = &bytes[taken..];
            self.filled += taken;
            if self.filled == BLOCK {
                self.flush();
            }
        }
    }

    /// Appends a word, its lowest byte first.
    pub fn word(&mut self, word: u32) {
        self.write(&word.to_le_bytes());
    }

    fn flush(&mut self) {
        let block = &self.block[..self.filled];
        let written = self.file.as_mut().map(|file| file.write_all(block));
        self.whole &= matches!(written, Some(Ok(())));
        self.filled = 0;
    }

    /// Writes the last block; none if anything was lost.
    pub fn finish(&mut self) -> Option<()> {
        self.flush();
        self.whole.then_some(())
    }
}
