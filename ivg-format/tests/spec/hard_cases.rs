//! `docs/hard-cases.md` against the tests that it names.

use super::clauses::check_test;
use super::repository;

/// The rows of the tables: the case, and what the other cells name between backquotes.
fn cases(text: &str) -> Vec<(&str, Vec<Vec<&str>>)> {
    // What was measured is in tables of other columns, which name no tests.
    let before_figures = text.split("## The figures").next().unwrap_or_default();
    let rows = before_figures.lines().filter(|line| line.starts_with("| ") && !line.starts_with("| case |"));
    rows.map(|row| {
        let mut cells = row.trim_matches('|').split(" | ");
        let case = cells.next().unwrap_or_default().trim();
        (case, cells.map(|cell| cell.split('`').skip(1).step_by(2).collect()).collect())
    })
    .collect()
}

/// What is wrong with the tables.
fn faults(text: &str) -> Vec<String> {
    let mut wrong = vec![];
    for (case, cells) in cases(text) {
        // The first column of the first table says what must happen, in words.
        if cells.len() != 2 || cells[1].is_empty() {
            wrong.push(format!("{case}: names no test"));
        }
        let named = cells.iter().flatten();
        wrong.extend(named.filter_map(|name| check_test(name).err()).map(|why| format!("{case}: {why}")));
    }
    wrong
}

#[test]
fn every_hard_case_names_tests_that_exist() {
    let text = std::fs::read_to_string(repository("docs/hard-cases.md")).unwrap();
    assert!(cases(&text).len() >= 89, "rows are missing");
    for heading in ["## Shapes", "## Transport", "## Scale", "## Quantisers", "## Filling"] {
        assert!(text.contains(heading), "{heading}");
    }
    assert!(faults(&text).is_empty(), "{}", faults(&text).join("\n"));
}

#[test]
fn a_case_without_a_test_is_found() {
    for row in ["| a | words | - |", "| a | `ivg-format/tests/none.rs::f` | `ivg-format/tests/none.rs::f` |"]
    {
        assert!(!faults(row).is_empty(), "{row}");
    }
    let own = "`ivg-format/tests/spec/hard_cases.rs::a_case_without_a_test_is_found`";
    assert!(faults(&format!("| a | words | {own} |")).is_empty());
}
