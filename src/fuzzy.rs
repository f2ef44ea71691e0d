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

mod even;
mod inference;
mod partition;
mod product;
mod reciprocal;
mod rules;
mod scale;
mod twin;

pub use even::Position;
pub use inference::{Activation, ActiveRules, Antecedents, FiredRule};
pub use partition::{Grade, Membership, Partition};
pub use rules::{Consequents, FixedOutput, MAX_TERMS, RuleTable, Term};
pub use scale::{InputScale, OutputScale};
pub use twin::{Twin, TwinTable};
