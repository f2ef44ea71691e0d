//! Bytes from one context to another, interrupt to program or the other way, without a lock.

use core::sync::atomic::{AtomicU8, AtomicU16, Ordering};

/// A queue of `N` − 1 bytes; `N` is a power of two up to 32 768. One context pushes, one other pops.
///
/// Like heapless's queue, whose two halves forget `N`, divide by it and so keep a panic path; and without `unsafe`.
/// More than one pusher or popper at a time mixes bytes up, but no more than that.
///
/// ```
/// use fuzzypilot::firmware::pipe::Pipe;
///
/// static PIPE: Pipe<8> = Pipe::new();
/// assert!(PIPE.push(b"abcd"));                 // an interrupt
/// assert!(!PIPE.push(b"efgh"));                // all or nothing
/// assert_eq!(PIPE.pop(), Some(b'a'));          // the program
/// ```
#[derive(Debug)]
pub struct Pipe<const N: usize> {
    bytes: [AtomicU8; N],
    /// Where the next byte goes; written by the pusher.
    end: AtomicU16,
    /// Where the next byte is; written by the popper.
    start: AtomicU16,
}

impl<const N: usize> Default for Pipe<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Pipe<N> {
    /// Keeps a place within the ring.
    const MASK: u16 = (N as u16).wrapping_sub(1);

    /// Empty.
    pub const fn new() -> Self {
        const { assert!(N.is_power_of_two() && N > 1 && N <= 1 << 15) };
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            end: AtomicU16::new(0),
            start: AtomicU16::new(0),
        }
    }

    /// Pushes all of the bytes, or, where there is no room for them, none. Whether they are in.
    pub fn push(&self, bytes: &[u8]) -> bool {
        let start = self.start.load(Ordering::Acquire);
        let mut end = self.end.load(Ordering::Relaxed);
        let used = end.wrapping_sub(start) & Self::MASK;
        if bytes.len() > usize::from(Self::MASK.wrapping_sub(used)) {
            return false;
        }
        for byte in bytes {
            if let Some(place) = self.bytes.get(usize::from(end)) {
                place.store(*byte, Ordering::Relaxed);
            }
            end = end.wrapping_add(1) & Self::MASK;
        }
        self.end.store(end, Ordering::Release);
        true
    }

    /// Pops the next byte.
    pub fn pop(&self) -> Option<u8> {
        let end = self.end.load(Ordering::Acquire);
        let start = self.start.load(Ordering::Relaxed);
        if start == end {
            return None;
        }
        let byte = self.bytes.get(usize::from(start))?.load(Ordering::Relaxed);
        let next = start.wrapping_add(1) & Self::MASK;
        self.start.store(next, Ordering::Release);
        Some(byte)
    }

    /// Whether there is anything to pop.
    pub fn is_empty(&self) -> bool {
        self.end.load(Ordering::Acquire) == self.start.load(Ordering::Relaxed)
    }

    /// Pops `M` bytes that were pushed together.
    pub fn pop_all<const M: usize>(&self) -> Option<[u8; M]> {
        let mut bytes = [0; M];
        for byte in &mut bytes {
            *byte = self.pop()?;
        }
        Some(bytes)
    }
}
