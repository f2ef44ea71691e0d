//! The conversation with one desktop: whose turn it is, and what was answered last.

use crate::link::message::{Role, ToTarget, Why};

/// How many frames in a row may be lost: a number further ahead is taken for one of the past.
const WINDOW: u8 = 32;

/// What a question is answered by; small enough to be remembered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answer {
    /// Nothing.
    Silence,
    Welcome,
    State,
    /// The state after a stop. The very same stop once more is acted upon once more: the button may have armed the robot
    /// since.
    Stopped,
    Value {
        id: u16,
        value: i32,
    },
    Ack,
    Refused(Why),
    /// The last record.
    Record,
}

impl<E: Into<Why>> From<Result<(), E>> for Answer {
    fn from(result: Result<(), E>) -> Self {
        match result {
            Ok(()) => Self::Ack,
            Err(why) => Self::Refused(why.into()),
        }
    }
}

/// The session.
#[derive(Clone, Debug)]
pub(super) struct Session {
    /// Whether anybody has said hello.
    open: bool,
    pub role: Role,
    /// Sequence number and CRC of the last frame, and its answer.
    last: (u8, u32),
    answer: Answer,
}

impl Session {
    pub const fn new() -> Self {
        Self {
            open: false,
            role: Role::Monitor,
            last: (0, 0),
            answer: Answer::Silence,
        }
    }

    pub fn open(&mut self, role: Role) {
        self.open = true;
        self.role = role;
    }

    pub fn close(&mut self) {
        *self = Self::new();
    }

    /// The answer that was given, if this is the last frame once more and not to be acted upon again.
    pub fn again(&self, sequence: u8, check: u32) -> Option<Answer> {
        let same = self.open && self.last == (sequence, check);
        (same && self.answer != Answer::Stopped).then_some(self.answer)
    }

    /// Whether the message may be acted upon. A hello may begin with any number; a stop and a question how it is, which
    /// changes nothing, are never refused.
    pub fn admits(&self, sequence: u8, message: Option<&ToTarget<'_>>) -> Result<(), Why> {
        match message {
            Some(ToTarget::Hello { .. } | ToTarget::Stop | ToTarget::Status) => Ok(()),
            _ if !self.open => Err(Why::NoSession),
            _ if !self.expects(sequence) => Err(Why::Replayed),
            None => Err(Why::Malformed),
            Some(_) => Ok(()),
        }
    }

    /// Whether the number is one of the next.
    fn expects(&self, sequence: u8) -> bool {
        (1..=WINDOW).contains(&sequence.wrapping_sub(self.last.0))
    }

    /// Remembers an answer. Only a hello and the next numbers move on: an old stop does not make old frames new.
    pub fn note(&mut self, sequence: u8, check: u32, hello: bool, answer: Answer) {
        if hello || self.expects(sequence) {
            self.last = (sequence, check);
            self.answer = answer;
        }
    }
}
