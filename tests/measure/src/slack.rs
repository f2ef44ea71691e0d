//! When a budget fits: what is measured is not over it, and not so far below that the budget says nothing; and when a goal
//! is met.

/// A budget that does not fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    what: String,
    measured: u32,
    budget: u32,
    goal: bool,
}

impl std::fmt::Display for Misfit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            what,
            measured,
            budget,
            goal,
        } = self;
        if *goal {
            write!(f, "{what}: {measured} misses its goal of {budget}")
        } else if measured > budget {
            write!(f, "{what}: {measured} is over its budget of {budget}")
        } else {
            write!(
                f,
                "{what}: {measured} leaves its budget of {budget} slack by more than a fifth"
            )
        }
    }
}

/// A budget holds from its own value down to a fifth less.
pub fn fits(measured: u32, budget: u32) -> bool {
    measured <= budget && measured >= budget.saturating_sub(budget / 5)
}

/// What is wrong with a budget, if anything is.
pub fn see(what: &str, measured: u32, budget: u32) -> Option<Misfit> {
    (!fits(measured, budget)).then(|| Misfit {
        what: what.to_owned(),
        measured,
        budget,
        goal: false,
    })
}

/// What is wrong with a goal, if there is one and it is missed.
pub fn aim(what: &str, measured: u32, goal: Option<u32>) -> Option<Misfit> {
    let goal = goal.filter(|goal| measured > *goal)?;
    Some(Misfit {
        what: what.to_owned(),
        measured,
        budget: goal,
        goal: true,
    })
}

/// A budget for what was measured: 5 % more, in round numbers.
pub fn roomy(measured: u32) -> u32 {
    let wanted = u64::from(measured) * 105 / 100;
    let step = match wanted {
        ..1000 => 1,
        1000..10_000 => 10,
        _ => 100,
    };
    u32::try_from(wanted.next_multiple_of(step)).unwrap_or(u32::MAX)
}
