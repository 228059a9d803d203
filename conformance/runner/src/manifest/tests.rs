use super::{Edit, Recipe, expand};

#[test]
fn a_recipe_is_made_from_its_end_to_its_beginning() {
    let edit = |at, delete, insert: &str, repeat| Edit {
        at,
        delete,
        insert: insert.to_owned(),
        repeat,
        field: String::new(),
    };
    let recipe = |edits| Recipe { from: String::new(), edits, checksums: Vec::new() };
    let two = recipe(vec![edit(1, 1, "ff", None), edit(3, 0, "0a0b", Some(2))]);
    assert_eq!(two.apply(&[1, 2, 3, 4]), Some(vec![1, 255, 3, 10, 11, 10, 11, 4]));
    assert_eq!(recipe(vec![edit(3, 2, "", None)]).apply(&[1, 2, 3, 4]), None);
    assert_eq!(recipe(vec![edit(0, 0, "0", None)]).apply(&[]), None);
}

#[test]
fn runs_are_rows_of_a_status_and_a_number() {
    let text = "from\tto\tverdict\trecords\n0\t1\tneed-more\t0\n2\t2\tok\t3\n";
    let numbers: Vec<u8> = [40u32, 0, 40, 0, 0, 3].into_iter().flat_map(u32::to_le_bytes).collect();
    assert_eq!(expand(text), Some(numbers));
    assert_eq!(expand("x\n1\t2\n"), None);
}
