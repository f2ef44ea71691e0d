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

/// What is known of `N` sensors.
#[derive(Clone, Debug)]
pub struct Health<const N: usize> {
    doubts: [u8; N],
    /// Those that have been heard, a bit each.
    proven: u32,
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
            proven: 0,
        }
    }

    /// Takes over a tick's echoes. Neighbours are those next in the order of the mounts; the first and the last sensor have
    /// one only and are never doubted.
    pub(super) fn update(&mut self, params: &HealthParams, echoes: &[Echo]) {
        let near = Steps::of(params.near);
        let range = |echo: &Echo| echo.range().unwrap_or(Steps::MAX);
        // Beyond either end nothing is heard.
        let mut right = Steps::MAX;
        let mut own = echoes.first().map_or(Steps::MAX, range);
        let after = echoes.iter().skip(1).map(range).chain([Steps::MAX]);
        for ((bit, left), (doubts, echo)) in (0..32u32)
            .zip(after)
            .zip(self.doubts.iter_mut().zip(echoes))
        {
            let bit = 1u32 << bit;
            let doubtful = if self.proven & bit == 0 {
                right.max(left) < Steps::MAX || right.min(left) < near.half()
            } else {
                right.max(left) < near
            };
            (right, own) = (own, left);
            if echo.range().is_some() {
                *doubts = 0;
                self.proven |= bit;
            } else if doubtful {
                *doubts = doubts.saturating_add(1).min(params.doubts);
            } else {
                *doubts = doubts.saturating_sub(1);
            }
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
    pub fn dead(&self, params: &HealthParams) -> u32 {
        let mut dead = 0;
        for (bit, doubts) in (0..32u32).zip(&self.doubts) {
            let bit = 1u32 << bit;
            let more = params.doubts.saturating_sub(if self.proven & bit == 0 {
                params.unproven
            } else {
                0
            });
            if *doubts >= more.max(1) {
                dead |= bit;
            }
        }
        dead
    }

    /// The speed that is sensible with what still hears.
    pub(super) fn cap(&self, params: &HealthParams, eyes: &Eyes<N>) -> MetresPerSecond {
        let dead = self.dead(params);
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
