//! The fuzzy engine: const rule tables in, one crisp number out, in fixed point and without a branch on the data.
//! It knows no robot word and can be used alone.
//!
//! ```text
//! crisp inputs ──Partition──▶ memberships ──min──▶ Activation ──RuleTable──▶ crisp output (one a table)
//! ```
//!
//! * Input terms form a **Ruspini partition**: triangles between neighbouring peaks that cross at ½, shoulders at both
//!   ends; the two memberships of any input sum to exactly 1. Peaks may be unequally spaced.
//! * AND is **min**; defuzzification is the **height method**, Σ w·peak / Σ w over every rule that fires. Rules that
//!   share a consequent term are summed, not max-merged.
//! * With two inputs exactly four rules carry weight, so an inference costs four products and one division, whatever
//!   the table's size and whatever the input. Σ w lies in [1, 2]: division by zero cannot happen.
//! * Several outputs share one [`Activation`]: the antecedents are evaluated once.
//! * Everything that can be wrong with a table is checked while it compiles: see [`Partition::new`],
//!   [`Consequents::new`] and [`RuleTable::new`].
//!
//! That is the fast route. Where the peaks of both inputs are evenly spaced and there are two outputs, [`TwinTable`] says
//! the same in a fraction of the instructions. [`system`] takes every other kind of rule base.
//!
//! # Which route for what
//!
//! | | two even inputs, two tables | two inputs, whole tables | [`system`]: anything else |
//! |---|---|---|---|
//! | inputs, outputs | 2, 2 | 2, any number | 1 to 4, 1 to 255 |
//! | terms | evenly spaced triangles, shoulders | a Ruspini partition: triangles, shoulders | triangles, trapezoids, shoulders, singletons, points; Gaussians, bells, sigmoids, splines in pieces |
//! | AND, OR, NOT | min, –, – | min, –, – | min or product, max, one minus the degree |
//! | rule weights | – | – | yes |
//! | conclusions | singletons | singletons | singletons, Takagi–Sugeno of order 1, sampled sets |
//! | defuzzification | height | height | height, centroid, centre of sums |
//! | rules that share a conclusion | summed | summed | summed or max-merged |
//! | inputs come as | [`Position`], by an [`InputScale`] | `I16F16` | `i32` |
//! | work | four rules; divides once, or by products alone | four rules, one division an output | every rule, every sample |
//! | chosen by the type | [`TwinTable`] | [`Antecedents`] and [`RuleTable`] | [`system::System`] |
//!
//! With physical units in and out, two outputs of 5 × 5 rules cost a [`MirroredTwin`], which is a [`TwinTable`] and its scales,
//! at most 45 instructions on a Cortex-M4F, 160 on a Cortex-M0 and 105 on a RISC-V rv32imc, the same for every input, and
//! at most 512 bytes of flash: `cargo engine` counts them, and fails where it is more.
//!
//! All three do the same work for every input, give the same bits on every machine, cannot panic and are checked while they
//! compile. **Not supported**: type-2 and intuitionistic sets, hedges (very, somewhat), other norms than these (bounded,
//! drastic, Einstein, Hamacher), terms higher or lower than one, Takagi–Sugeno of a higher order, Tsukamoto, mean, smallest
//! or largest of maximum, bisector, chained rule blocks, and more than four inputs.
//!
//! # Example: a fan
//!
//! ```
//! use fixed::types::{I16F16, I8F8};
//! use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term};
//!
//! const LOW: Term = Term(0);
//! const MID: Term = Term(1);
//! const HIGH: Term = Term(2);
//! static INPUTS: Antecedents<3, 2> = Antecedents {
//!     rows: Partition::new([I16F16::lit("18"), I16F16::lit("24"), I16F16::lit("32")]), // °C
//!     cols: Partition::new([I16F16::lit("30"), I16F16::lit("80")]),                    // % humidity
//! };
//! static FAN: RuleTable<3, 2, I8F8> = RuleTable::new(
//!     [[LOW, LOW ],
//!      [LOW, MID ],
//!      [MID, HIGH]],
//!     Consequents::new([I8F8::lit("0"), I8F8::lit("100")], [I8F8::lit("0"), I8F8::lit("40"), I8F8::lit("100")]),
//! );
//! let activation = INPUTS.activate(I16F16::lit("28"), I16F16::lit("55"));
//! assert_eq!(FAN.defuzzify(&activation), I8F8::lit("45"));
//! ```

#[cfg(dsp)]
mod dsp;
mod even;
mod inference;
mod mirrored;
mod partition;
mod product;
mod reciprocal;
mod rules;
mod scale;
pub mod system;
mod twin;
mod weigh;

pub use even::Position;
pub use inference::{Activation, ActiveRules, Antecedents, FiredRule};
pub use mirrored::{Mirrored, MirroredTwin};
pub use partition::{Grade, Membership, Partition};
pub use rules::{Consequents, FixedOutput, MAX_TERMS, RuleTable, Term};
pub use scale::{InputScale, OutputScale};
pub use twin::{Twin, TwinTable};

/// The chapter's Rust compiles and runs.
#[cfg(doctest)]
#[doc = include_str!("../docs/fuzzy.md")]
struct Chapter;
