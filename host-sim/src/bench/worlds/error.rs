//! What can be wrong with worlds, said in one line.

/// Why worlds cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// A file that cannot be read at all.
    #[error("{file}: cannot be read ({why})")]
    Unreadable {
        /// The file.
        file: String,
        /// The system's reason.
        why: String,
    },
    /// Something in a file, or in what was asked for.
    #[error("{place}: found {found}; allowed: {allowed}")]
    Wrong {
        /// File and line or byte, or option.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        allowed: String,
    },
    /// A world that no robot gets through.
    #[error("{place}: world {number}: {why}")]
    Unusable {
        /// File or generator.
        place: String,
        /// World.
        number: u32,
        /// Reason.
        why: String,
    },
}

impl WorldError {
    /// Something in a file, or in what was asked for.
    pub fn wrong(
        place: impl Into<String>,
        found: impl Into<String>,
        allowed: impl Into<String>,
    ) -> Self {
        Self::Wrong {
            place: place.into(),
            found: found.into(),
            allowed: allowed.into(),
        }
    }
}
