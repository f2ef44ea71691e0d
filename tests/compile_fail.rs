//! Wrong rule bases and distance tables do not compile: every file of `compile_fail/` is one mistake, its message
//! beside it.

#[test]
fn wrong_tables_do_not_compile() {
    let cases = trybuild::TestCases::new();
    cases.pass("tests/compile_fail/pass/*.rs");
    cases.compile_fail("tests/compile_fail/*.rs");
}
