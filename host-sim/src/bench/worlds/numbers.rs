//! Which worlds: `0-49,60,100-149/7`, `all`, and the benchmark's own split.

/// Whether a world is in the benchmark's test set, on which nothing may be tuned.
pub const fn is_test(number: u32) -> bool {
    number.is_multiple_of(6)
}

/// A choice of world numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// Every world there is.
    All,
    /// Those divisible by 6: the benchmark's test set.
    Test,
    /// Those not divisible by 6.
    Development,
    /// First, last, step.
    Ranges(Vec<(u32, u32, u32)>),
}

impl Numbers {
    /// Reads a list.
    pub fn parse(text: &str) -> Result<Self, String> {
        match text {
            "all" => return Ok(Self::All),
            "test" => return Ok(Self::Test),
            "dev" => return Ok(Self::Development),
            _ => {}
        }
        text.split(',')
            .map(range)
            .collect::<Option<_>>()
            .map(Self::Ranges)
            .ok_or_else(|| {
                "allowed are all, dev, test, or numbers and ranges such as 1,7,10-19,0-299/6"
                    .to_owned()
            })
    }

    /// Whether it holds a number.
    pub fn holds(&self, number: u32) -> bool {
        match self {
            Self::All => true,
            Self::Test => is_test(number),
            Self::Development => !is_test(number),
            Self::Ranges(ranges) => ranges.iter().any(|&(first, last, step)| {
                (first..=last).contains(&number) && (number - first).is_multiple_of(step)
            }),
        }
    }
}

fn range(text: &str) -> Option<(u32, u32, u32)> {
    let (span, step) = match text.split_once('/') {
        Some((span, step)) => (span, step.parse().ok()?),
        None => (text, 1),
    };
    let (first, last) = match span.split_once('-') {
        Some((first, last)) => (first.parse().ok()?, last.parse().ok()?),
        None => {
            let number = span.parse().ok()?;
            (number, number)
        }
    };
    (first <= last && step > 0).then_some((first, last, step))
}
