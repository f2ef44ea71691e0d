//! Which range sensors are dead: silent while those beside them keep hearing something near.
//!
//! A dead sensor costs the memory nothing, because silence neither adds nor disproves, but what stands in its cone is seen
//! only when another cone sweeps over it. So a robot that does not know what stands ahead drives slowly.

use super::sensors::{Echo, Eyes};
use super::steps::Steps;
use crate::units::{Angle, Metres, MetresPerSecond};

/// When a sensor counts as dead, and what follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HealthParams {
    /// Both neighbours' echoes must be nearer than this for silence to be doubtful. As long as the sensor has never been
    /// heard, any echoes of both do, or one of half this.
    pub near: Metres,
    /// Doubtful ticks after which it is dead; 1 to 255. A tick that is not doubtful takes one back, an echo of its own all.
    pub doubts: u8,
    /// So many fewer it takes as long as it has never been heard.
    pub unproven: u8,
    /// Dead sensors whose axis is within this of straight ahead cap the speed…
    pub ahead: Angle,
    /// …to this.
    pub speed: MetresPerSecond,
    /// What a neighbour hears nearer than this may stand in the dead cone as well, and is remembered there, too.
    pub lend: Metres,
}

/// What is known of `N` sensors. Sets of sensors have a bit for each.
#[derive(Clone, Debug)]
pub struct Health<const N: usize> {
    doubts: [u8; N],
    /// Those whose doubts are not 0.
    doubted: u32,
    /// Those that have been heard.
    proven: u32,
    dead: u32,
}

impl<const N: usize> Default for Health<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> Health<N> {
    /// All are trusted.
    pub const fn new() -> Self {
        Self {
            doubts: [0; N],
            doubted: 0,
            proven: 0,
            dead: 0,
        }
    }

    /// Takes over a tick's echoes. Neighbours are those next in the order of the mounts; the first and the last sensor have
    /// one only: they are doubted until they are first heard.
    pub(super) fn update(&mut self, params: &HealthParams, echoes: &[Echo]) {
        let near = Steps::of(params.near);
        let half = near.half();
        let (mut heard, mut close, mut closer) = (0u32, 0u32, 0u32);
        let mut bit = 1u32;
        for echo in echoes {
            if let Some(range) = echo.range() {
                heard |= bit;
                close |= if range < near { bit } else { 0 };
                closer |= if range < half { bit } else { 0 };
            }
            bit = bit.wrapping_shl(1);
        }
        let both = |of: u32| of << 1 & of >> 1;
        let either = |of: u32| of << 1 | of >> 1;
        let proven = both(close);
        let unproven = both(heard) | either(closer);
        let all = u32::MAX.wrapping_shr(32u32.wrapping_sub(echoes.len() as u32));
        let doubtful = (self.proven & proven | !self.proven & unproven) & !heard & all;
        self.proven |= heard;
        // Most are heard, or silent for good reason.
        let mut changed = doubtful | self.doubted;
        while changed != 0 {
            let index = changed.trailing_zeros();
            let bit = changed & changed.wrapping_neg();
            changed ^= bit;
            let Some(doubts) = self.doubts.get_mut(index as usize) else {
                break;
            };
            *doubts = if heard & bit != 0 {
                0
            } else if doubtful & bit != 0 {
                doubts.saturating_add(1).min(params.doubts)
            } else {
                doubts.saturating_sub(1)
            };
            let fewer = if self.proven & bit == 0 {
                params.unproven
            } else {
                0
            };
            let dead = *doubts >= params.doubts.saturating_sub(fewer).max(1);
            let set = |of: u32, is: bool| of & !bit | if is { bit } else { 0 };
            self.doubted = set(self.doubted, *doubts > 0);
            self.dead = set(self.dead, dead);
        }
    }

    /// What a dead sensor's nearer neighbour hears, if that is near enough to be assumed in its cone, too.
    pub(super) fn lent(params: &HealthParams, echoes: &[Echo], index: usize) -> Option<Steps> {
        let beside = [index.wrapping_sub(1), index.wrapping_add(1)];
        let ranges = beside.map(|i| echoes.get(i).and_then(|echo| echo.range()));
        let nearest = ranges.into_iter().flatten().min()?;
        (nearest < Steps::of(params.lend)).then_some(nearest)
    }

    /// The dead sensors, a bit each.
    pub fn dead(&self) -> u32 {
        self.dead
    }

    /// The speed that is sensible with what still hears.
    pub(super) fn cap(&self, params: &HealthParams, eyes: &Eyes<N>) -> MetresPerSecond {
        let dead = self.dead;
        if dead == 0 {
            return MetresPerSecond::MAX;
        }
        let ahead = |heading: Angle| heading.abs().bits() <= params.ahead.bits();
        let blind = (0..32u32)
            .zip(eyes.as_slice())
            .any(|(bit, eye)| dead >> bit & 1 == 1 && ahead(eye.heading));
        if blind {
            params.speed
        } else {
            MetresPerSecond::MAX
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Health, HealthParams};
    use crate::navigate::presets;
    use crate::navigate::sensors::Echo;
    use crate::navigate::steps::Steps;

    /// The rule, sensor by sensor.
    struct Plain {
        doubts: [u8; 7],
        heard: [bool; 7],
    }

    impl Plain {
        fn update(&mut self, params: &HealthParams, echoes: &[Echo; 7]) {
            let near = Steps::of(params.near);
            let range = |index: usize| echoes.get(index).and_then(|echo| echo.range());
            for index in 0..7usize {
                let beside = [range(index.wrapping_sub(1)), range(index + 1)];
                let closer_than =
                    |most: Steps| move |range: &Option<Steps>| range.is_some_and(|r| r < most);
                let doubtful = if self.heard[index] {
                    beside.iter().all(closer_than(near))
                } else {
                    beside.iter().all(Option::is_some)
                        || beside.iter().any(closer_than(near.half()))
                };
                let doubts = &mut self.doubts[index];
                if range(index).is_some() {
                    *doubts = 0;
                    self.heard[index] = true;
                } else if doubtful {
                    *doubts = (*doubts + 1).min(params.doubts);
                } else {
                    *doubts = doubts.saturating_sub(1);
                }
            }
        }

        fn dead(&self, params: &HealthParams) -> u32 {
            (0..7).fold(0, |dead, index| {
                let fewer = if self.heard[index] {
                    0
                } else {
                    params.unproven
                };
                let most = params.doubts.saturating_sub(fewer).max(1);
                dead | u32::from(self.doubts[index] >= most) << index
            })
        }
    }

    #[test]
    fn sets_of_bits_say_what_the_rule_says_of_every_sensor() {
        let params = presets::jackal::<7>().health;
        let mut health = Health::<7>::new();
        let mut plain = Plain {
            doubts: [0; 7],
            heard: [false; 7],
        };
        let mut state = 7u64;
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as i32
        };
        let mut found = 0;
        for tick in 0..20_000 {
            // One of them is silent for a while, others now and then.
            let silent = tick / 400 % 8;
            let echoes = core::array::from_fn(|index| match random() % 8 {
                0 => Echo::Silent,
                _ if index == silent => Echo::Silent,
                _ => Echo::Across(Steps::from_bits(1000 + random() % 6000)),
            });
            health.update(&params, &echoes);
            plain.update(&params, &echoes);
            assert_eq!(health.doubts, plain.doubts, "{tick}");
            assert_eq!(health.dead(), plain.dead(&params), "{tick}");
            found += u32::from(health.dead() != 0);
            if tick % 5000 == 4999 {
                health = Health::new();
                plain = Plain {
                    doubts: [0; 7],
                    heard: [false; 7],
                };
            }
        }
        assert!(found > 1000, "{found}");
    }
}
