use super::{COMPILE, RUN, actions};
use crate::workspace_root;

/// What is timed is what the first page of the archive tells its reader to do.
#[test]
fn the_timed_lines_are_those_of_the_archive() {
    let page = std::fs::read_to_string(workspace_root().join("conformance/ARCHIVE.md")).unwrap();
    for (program, arguments) in [COMPILE, RUN] {
        assert!(page.contains(&format!("\n{program} {arguments}\n")), "{program} {arguments}");
    }
}

/// Every adapter but the one in Rust, which the tests of the suite run, is run here, by name or in the check of the port.
#[test]
fn every_adapter_is_run() {
    let root = workspace_root();
    let check = std::fs::read_to_string(root.join("conformance/ports/c/check.sh")).unwrap();
    let run: String = actions().iter().map(|action| format!("{action}\n")).collect();
    for adapter in std::fs::read_dir(root.join("conformance/adapters")).unwrap() {
        let name = adapter.unwrap().file_name().into_string().unwrap();
        let named = format!("adapters/{name}/");
        assert!(name == "rust" || run.contains(&named) || check.contains(&named), "{name}");
    }
}
