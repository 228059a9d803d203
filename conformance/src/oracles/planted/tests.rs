use super::*;
use crate::vectors::generated_files;

#[test]
fn the_corpus_alone_finds_no_planted_bug() {
    let files = generated_files();
    for (name, oracle) in PLANTED {
        let target = if name == "wrong-level" { "pmesh_lod" } else { "ivg_decode" };
        let mut seeds =
            files.iter().filter(|(path, _)| path.starts_with(format!("fuzz/corpus/{target}"))).peekable();
        assert!(seeds.peek().is_some(), "{target} has no seeds");
        for (path, bytes) in seeds {
            println!("{name}: {}", path.display());
            oracle(bytes);
        }
    }
}
