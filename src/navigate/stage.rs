//! The parts of a navigator's tick, for who watches one: to count what each costs.

/// A part of the tick, for a [`Probe`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Echoes into the memory.
    Remember,
    /// The points near the predicted body.
    Near,
    /// How far the robot can turn in place.
    Map,
    /// Where to head: the path and what is ahead on it, or along the way that the guide field found.
    Course,
    /// The choice of the heading, and the sectors of the polar map that it asks for.
    Heading,
    /// The higher level's decision.
    Supervise,
    /// The manoeuvre's twist.
    Behave,
    /// Barrier and brake gate.
    Guard,
    /// A slice of the guide field.
    Field,
}

/// Watches a tick from inside.
pub trait Probe {
    /// `stage` is done.
    fn mark(&mut self, stage: Stage);
}

/// Watches nothing and costs nothing.
impl Probe for () {
    fn mark(&mut self, _: Stage) {}
}
