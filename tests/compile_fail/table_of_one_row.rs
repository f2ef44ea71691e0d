//! A rule table has two rows at least.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::{Consequents, RuleTable, Term};

pub static SPEED: RuleTable<1, 2, I8F8> = RuleTable::new(
    [[Term(0), Term(0)]],
    Consequents::new([I8F8::lit("0"), I8F8::lit("3")], [I8F8::lit("1")]),
);

fn main() {}
