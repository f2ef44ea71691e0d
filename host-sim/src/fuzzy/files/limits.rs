//! How large a design may be. They bound the time and the memory that any file can cost, and lie far above what a
//! controller needs.

/// Bytes of a file, one mebibyte.
pub const BYTES: usize = 1 << 20;
/// Characters of a name.
pub const NAME: usize = 64;
/// Inputs.
pub const INPUTS: usize = 4;
/// Outputs.
pub const OUTPUTS: usize = 16;
/// Terms of a variable.
pub const TERMS: usize = 64;
/// Points of a term.
pub const POINTS: usize = 256;
/// Rules of all blocks together.
pub const RULES: usize = 4096;
/// Blocks of rules.
pub const BLOCKS: usize = 64;
/// Parentheses and negations within each other in a rule's condition.
pub const DEPTH: usize = 16;
/// Propositions (`x is a`) in a rule's condition.
pub const PROPOSITIONS: usize = 64;
/// Samples of a centroid.
pub const SAMPLES: usize = 10_000;
