//! Who is told how far a check has got.

/// Told from many threads at once.
pub trait Watch: Sync {
    /// A part of the check begins: what it does, and in how many steps if that is known.
    fn begin(&self, what: &'static str, steps: Option<usize>);

    /// So many steps more are done.
    fn done(&self, steps: usize);
}

/// Nobody.
impl Watch for () {
    fn begin(&self, _: &'static str, _: Option<usize>) {}

    fn done(&self, _: usize) {}
}
