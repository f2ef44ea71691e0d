//! Ascending numbers between two walls that keep a least distance to each other and to the walls.

/// The walls and the least distances.
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    low: f64,
    high: f64,
    /// Before the first number, between neighbours, behind the last: one more than numbers.
    least: Vec<f64>,
}

impl Ladder {
    /// Walls, and least distances that fit between them.
    pub fn new(low: f64, high: f64, least: Vec<f64>) -> Self {
        Self { low, high, least }
    }

    /// The numbers nearest to these (by the sum of squared distances) that the ladder allows. NaN counts as the lower wall.
    ///
    /// Without the least distances this is a regression to ascending numbers, solved by pooling neighbours that violate the
    /// order, limited to the walls; so those are taken out first and put back in the end.
    pub fn nearest(&self, wanted: &[f64]) -> Vec<f64> {
        let mut offset = 0.0;
        let offsets: Vec<f64> = self
            .least
            .iter()
            .map(|least| {
                offset += least;
                offset
            })
            .collect();
        let top = self.high - offset;
        // Pools: their mean and how many numbers they hold.
        let mut pools: Vec<(f64, usize)> = Vec::new();
        for (x, offset) in wanted.iter().zip(&offsets) {
            let x = if x.is_nan() { self.low } else { x - offset };
            let mut pool = (x, 1);
            while let Some(before) = pools.pop_if(|before| before.0 > pool.0) {
                let count = before.1 + pool.1;
                let sum = before.0 * before.1 as f64 + pool.0 * pool.1 as f64;
                pool = (sum / count as f64, count);
            }
            pools.push(pool);
        }
        let levels = pools
            .iter()
            .flat_map(|&(mean, count)| std::iter::repeat_n(mean, count));
        levels
            .zip(&offsets)
            .map(|(level, offset)| level.max(self.low).min(top) + offset)
            .collect()
    }

    /// Whether these numbers keep the order, the walls and more than half of every least distance.
    pub fn holds(&self, numbers: &[f64]) -> bool {
        let mut last = self.low;
        let ends = std::iter::once(&self.high);
        let mut keeps = numbers.iter().chain(ends).zip(&self.least);
        keeps.all(|(&x, least)| {
            let keeps = x - last >= 0.5 * least && x >= last;
            last = x;
            keeps
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn ladder() -> Ladder {
        Ladder::new(0.0, 10.0, vec![1.0, 2.0, 0.0])
    }

    #[test]
    fn what_is_allowed_stays() {
        assert_eq!(ladder().nearest(&[3.0, 6.0]), [3.0, 6.0]);
        assert_eq!(ladder().nearest(&[1.0, 10.0]), [1.0, 10.0]);
    }

    #[test]
    fn walls_and_distances_are_kept() {
        assert_eq!(ladder().nearest(&[-5.0, 6.0]), [1.0, 6.0]);
        assert_eq!(ladder().nearest(&[9.5, 20.0]), [8.0, 10.0]);
        // The two meet halfway: 6 and 4 are 2 apart the wrong way.
        assert_eq!(ladder().nearest(&[6.0, 4.0]), [4.0, 6.0]);
        assert!(!ladder().holds(&[4.0, 4.5]) && !ladder().holds(&[0.0, 5.0]));
        assert!(!ladder().holds(&[5.0, 11.0]) && ladder().holds(&[5.0, 10.0]));
    }

    proptest! {
        /// Nearer than anything else allowed, whatever is wanted.
        #[test]
        fn nothing_allowed_is_nearer(
            wanted in prop::collection::vec(-20.0..30.0, 4),
            other in prop::collection::vec(0.0..10.0, 4),
        ) {
            let ladder = Ladder::new(0.0, 10.0, vec![0.5, 1.0, 0.0, 2.0, 0.25]);
            let found = ladder.nearest(&wanted);
            prop_assert!(ladder.holds(&found), "{:?}", found);
            let far = |x: &[f64]| -> f64 { x.iter().zip(&wanted).map(|(a, b)| (a - b).powi(2)).sum() };
            let allowed = ladder.nearest(&other);
            prop_assert!(far(&found) <= far(&allowed) + 1e-9);
        }
    }
}
