use super::{Tool, cached_folders, has_loader, has_manifest, provide};
use crate::invocation::Invocation;
use crate::runner::Context;
use std::path::PathBuf;

/// Is there once the file `mark` is, which "installing" it makes.
const WITH_MARK: Tool = Tool {
    name: "the mark",
    is_there: |root| root.join("mark").exists(),
    install: |_| vec![Invocation::new("touch", "mark")],
};

#[test]
fn a_missing_tool_fails_and_names_the_line_to_run() {
    let folder = tempfile::tempdir().unwrap();
    let error = provide(&Context::new(folder.path().into()), &[WITH_MARK], false).unwrap_err();
    assert!(error.contains("the mark is missing; to install it: touch mark"), "{error}");
    assert!(error.contains("cargo xtask test --install"), "{error}");
    assert!(!folder.path().join("mark").exists());
}

#[test]
fn a_missing_tool_is_installed_when_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let context = Context::new(folder.path().into());
    provide(&context, &[WITH_MARK], true).unwrap();
    provide(&context, &[WITH_MARK], false).unwrap();
}

#[test]
fn an_installation_without_effect_fails() {
    let folder = tempfile::tempdir().unwrap();
    let tool = Tool { install: |_| vec![Invocation::new("true", "")], ..WITH_MARK };
    let error = provide(&Context::new(folder.path().into()), &[tool], true).unwrap_err();
    assert!(error.contains("still missing"), "{error}");
}

#[test]
fn loader_and_manifest_are_looked_for_as_files() {
    let folder = tempfile::tempdir().unwrap();
    let folders = [folder.path().join("absent"), folder.path().to_path_buf()];
    assert!(!has_loader(&folders) && !has_manifest(&folders));
    std::fs::write(folder.path().join("libvulkan.so.1"), "").unwrap();
    assert!(has_loader(&folders) && !has_manifest(&folders));
    std::fs::write(folder.path().join("lvp_icd.x86_64.json"), "{}").unwrap();
    assert!(has_manifest(&folders));
}

#[test]
fn reads_the_folders_of_the_linker_cache() {
    let cache = "2 libs found in cache `/etc/ld.so.cache'\n\
                 \tlibz.so.1 (libc6,x86-64) => /lib/x86_64-linux-gnu/libz.so.1\n\
                 \tlibm.so.6 (libc6,x86-64) => /lib/x86_64-linux-gnu/libm.so.6\n";
    assert_eq!(cached_folders(cache), [PathBuf::from("/lib/x86_64-linux-gnu")]);
}
