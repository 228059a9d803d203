use quickcheck::quickcheck;

use super::*;
use crate::http::path::is_safe_uri;

fn files(names: &[&str]) -> Vec<String> {
    mesh_files(names.iter().copied())
}

#[test]
fn names_stay_recognisable() {
    assert_eq!(
        files(&["dragon", "Tall Box", "Größe", "", "..", "a/../b", "nul", "COM1", "x.y"]),
        [
            "dragon.pmesh",
            "Tall-Box.pmesh",
            "Gr--e.pmesh",
            "mesh.pmesh",
            "mesh-2.pmesh",
            "a----b.pmesh",
            "mesh-nul.pmesh",
            "mesh-COM1.pmesh",
            "x-y.pmesh"
        ]
    );
}

#[test]
fn equal_names_are_numbered_even_where_case_does_not_count() {
    assert_eq!(files(&["a", "A", "a", "a-2"]), ["a.pmesh", "A-2.pmesh", "a-3.pmesh", "a-2-2.pmesh"]);
}

quickcheck! {
    fn every_name_is_safe_and_no_two_are_alike(names: Vec<String>) -> bool {
        let files = mesh_files(names.iter().map(String::as_str));
        let distinct: HashSet<String> = files.iter().map(|file| file.to_ascii_lowercase()).collect();
        distinct.len() == names.len() && files.iter().all(|file| is_safe_uri(file) && file.len() < 100)
    }
}
