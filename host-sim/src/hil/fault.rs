//! Faults on the wire, on purpose: a wrapper around any other wire that spoils frames both ways.

use super::wire::Wire;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::ops::Range;
use std::str::FromStr;
use std::time::Duration;

/// What is done to a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Bytes are cut off its end, and with them, half the time, what ends it.
    Truncate,
    /// One to three bits are changed.
    Corrupt,
    /// It comes twice.
    Duplicate,
    /// It comes after the next one.
    Reorder,
    /// It does not come.
    Drop,
    /// Up to 100 random bytes come in front of it.
    Noise,
    /// For whole control periods nothing comes.
    Silence,
}

const KINDS: [(&str, Kind); 7] = [
    ("truncate", Kind::Truncate),
    ("corrupt", Kind::Corrupt),
    ("duplicate", Kind::Duplicate),
    ("reorder", Kind::Reorder),
    ("drop", Kind::Drop),
    ("noise", Kind::Noise),
    ("silence", Kind::Silence),
];

impl Kind {
    fn name(self) -> &'static str {
        let named = KINDS.iter().find(|(_, kind)| *kind == self);
        named.map_or("?", |(name, _)| name)
    }
}

/// A direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// To the robot.
    To,
    /// From the robot.
    From,
}

/// Which frames are spoiled.
#[derive(Clone, Debug, PartialEq)]
pub enum When {
    /// This share of them (of silences: of the control periods), by chance.
    Rate(f64),
    /// All in these control periods of the run.
    Periods(Range<u64>),
}

/// A fault, as the command line names it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// What happens.
    pub kind: Kind,
    /// To which frames.
    pub when: When,
    /// In one direction; both if none is given.
    pub way: Option<Way>,
}

/// What [`Fault`]'s text may be.
const FORM: &str = "allowed: [to-|from-]KIND[:RATE|@PERIOD[+COUNT]] with KIND one of truncate, corrupt, duplicate, \
     reorder, drop, noise, silence; RATE above 0, up to 1 (0.01 when left out)";

impl FromStr for Fault {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || FORM.to_owned();
        let (way, rest) = if let Some(rest) = text.strip_prefix("to-") {
            (Some(Way::To), rest)
        } else if let Some(rest) = text.strip_prefix("from-") {
            (Some(Way::From), rest)
        } else {
            (None, text)
        };
        let end = rest.find([':', '@']).unwrap_or(rest.len());
        let (name, condition) = rest.split_at(end);
        let named = KINDS.iter().find(|(known, _)| *known == name);
        let kind = named.ok_or_else(wrong)?.1;
        let when = if let Some(rate) = condition.strip_prefix(':') {
            let rate: f64 = rate.parse().map_err(|_| wrong())?;
            if !(rate > 0.0 && rate <= 1.0) {
                return Err(wrong());
            }
            When::Rate(rate)
        } else if let Some(periods) = condition.strip_prefix('@') {
            let (first, count) = periods.split_once('+').unwrap_or((periods, "1"));
            let first: u64 = first.parse().map_err(|_| wrong())?;
            let count: u64 = count.parse().map_err(|_| wrong())?;
            if count == 0 {
                return Err(wrong());
            }
            When::Periods(first..first.saturating_add(count))
        } else {
            When::Rate(0.01)
        };
        Ok(Self { kind, when, way })
    }
}

/// One direction of the wire.
#[derive(Debug, Default)]
struct Lane {
    /// A frame that is overtaken by the next one.
    held: Option<Vec<u8>>,
    /// Nothing comes in this period.
    silent: bool,
}

/// A wire with faults.
pub struct Faulty {
    wire: Box<dyn Wire>,
    faults: Vec<Fault>,
    dice: Pcg64Mcg,
    /// The run's control period; none before it begins: then faults of a rate happen only.
    period: Option<u64>,
    to: Lane,
    from: Lane,
    /// The beginning of a frame from the robot.
    partial: Vec<u8>,
    ready: VecDeque<u8>,
    counts: BTreeMap<Kind, u64>,
}

impl Faulty {
    /// The same `seed` gives the same faults to the same frames.
    pub fn new(wire: Box<dyn Wire>, faults: Vec<Fault>, seed: u64) -> Self {
        Self {
            wire,
            faults,
            dice: Pcg64Mcg::seed_from_u64(seed ^ 0x0066_6175_6c74_7300),
            period: None,
            to: Lane::default(),
            from: Lane::default(),
            partial: Vec::new(),
            ready: VecDeque::new(),
            counts: BTreeMap::new(),
        }
    }

    fn lane(&mut self, way: Way) -> &mut Lane {
        match way {
            Way::To => &mut self.to,
            Way::From => &mut self.from,
        }
    }

    /// Whether a fault other than silence happens to the next frame.
    fn happens(&mut self, fault: &Fault, way: Way) -> bool {
        if fault.kind == Kind::Silence || fault.way.is_some_and(|only| only != way) {
            return false;
        }
        match &fault.when {
            When::Rate(rate) => self.dice.random::<f64>() < *rate,
            When::Periods(periods) => self.period.is_some_and(|now| periods.contains(&now)),
        }
    }

    fn below(&mut self, most: usize) -> usize {
        self.dice.random_range(0..most.max(1))
    }

    /// What of a frame gets through, in this order.
    fn spoil(&mut self, mut frame: Vec<u8>, way: Way) -> Vec<Vec<u8>> {
        if self.lane(way).silent {
            *self.counts.entry(Kind::Silence).or_default() += 1;
            return Vec::new();
        }
        let mut through = 1;
        let mut late = false;
        for i in 0..self.faults.len() {
            let fault = self.faults[i].clone();
            if !self.happens(&fault, way) {
                continue;
            }
            *self.counts.entry(fault.kind).or_default() += 1;
            match fault.kind {
                Kind::Truncate => {
                    let length = self.below(frame.len());
                    frame.truncate(length);
                    if self.below(2) == 0 {
                        frame.push(0);
                    }
                }
                Kind::Corrupt => {
                    for _ in 0..=self.below(3) {
                        let (at, bit) = (self.below(frame.len()), self.below(8));
                        if let Some(byte) = frame.get_mut(at) {
                            *byte ^= 1 << bit;
                        }
                    }
                }
                Kind::Duplicate => through *= 2,
                Kind::Reorder => late = true,
                Kind::Drop => through = 0,
                Kind::Noise => {
                    let count = 1 + self.below(100);
                    let noise = std::iter::repeat_with(|| self.dice.random::<u8>()).take(count);
                    frame = noise.chain(frame).collect();
                }
                Kind::Silence => {}
            }
        }
        let mut frames = vec![frame; through];
        let lane = self.lane(way);
        if let Some(held) = lane.held.take() {
            frames.push(held);
        } else if late {
            lane.held = frames.pop();
        }
        frames
    }
}

impl Wire for Faulty {
    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        for frame in self.spoil(frame.to_vec(), Way::To) {
            self.wire.send(&frame)?;
        }
        Ok(())
    }

    fn receive(&mut self, room: &mut [u8], patience: Duration) -> io::Result<usize> {
        let until = self.wire.now() + patience;
        while self.ready.is_empty() {
            let mut bytes = [0; 256];
            let left = until.saturating_sub(self.wire.now());
            let count = self.wire.receive(&mut bytes, left)?;
            for byte in bytes.iter().take(count) {
                self.partial.push(*byte);
                if *byte == 0 {
                    let frame = std::mem::take(&mut self.partial);
                    for frame in self.spoil(frame, Way::From) {
                        self.ready.extend(frame);
                    }
                }
            }
            if self.wire.now() >= until {
                break;
            }
        }
        let count = room.len().min(self.ready.len());
        for (place, byte) in room.iter_mut().zip(self.ready.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn now(&self) -> Duration {
        self.wire.now()
    }

    fn name(&self) -> String {
        self.wire.name()
    }

    fn last_words(&mut self) -> Option<String> {
        self.wire.last_words()
    }

    fn period(&mut self, number: u64) {
        self.wire.period(number);
        self.period = Some(number);
        for way in [Way::To, Way::From] {
            let mut silent = false;
            for i in 0..self.faults.len() {
                let fault = self.faults[i].clone();
                if fault.kind != Kind::Silence || fault.way.is_some_and(|only| only != way) {
                    continue;
                }
                silent |= match fault.when {
                    When::Rate(rate) => self.dice.random::<f64>() < rate,
                    When::Periods(periods) => periods.contains(&number),
                };
            }
            self.lane(way).silent = silent;
        }
    }

    fn faults(&self) -> Vec<(String, u64)> {
        let named = |(kind, count): (&Kind, &u64)| (kind.name().to_owned(), *count);
        self.counts.iter().map(named).collect()
    }

    fn log(&self) -> Vec<u8> {
        self.wire.log()
    }
}
