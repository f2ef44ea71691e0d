//! The activation of a 3 × 2 rule base does not fit a 2 × 3 table.
use fixed::types::{I8F8, I16F16};
use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term};

static INPUTS: Antecedents<3, 2> = Antecedents {
    rows: Partition::new([I16F16::lit("0"), I16F16::lit("1"), I16F16::lit("2")]),
    cols: Partition::new([I16F16::lit("0"), I16F16::lit("1")]),
};
static SPEED: RuleTable<2, 3, I8F8> = RuleTable::new(
    [[Term(0); 3]; 2],
    Consequents::new([I8F8::lit("0"), I8F8::lit("3")], [I8F8::lit("1")]),
);

fn main() {
    let activation = INPUTS.activate(I16F16::lit("0.5"), I16F16::lit("0.5"));
    SPEED.defuzzify(&activation);
}
