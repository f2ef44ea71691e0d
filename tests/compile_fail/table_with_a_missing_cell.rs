//! A row that is a cell short is not a row of this table.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::{Consequents, RuleTable, Term};

const S: Term = Term(0);
const B: Term = Term(1);

pub static SPEED: RuleTable<2, 3, I8F8> = RuleTable::new(
    [[S, B, B], [S, B]],
    Consequents::new([I8F8::lit("0"), I8F8::lit("3")], [I8F8::lit("1"), I8F8::lit("2")]),
);

fn main() {}
