//! The dependencies between our crates are those that the table in `ARCHITECTURE.md` allows, and no others; and the heavy
//! crates of other people stay where they belong.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, PackageId};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::process::Command;

/// For each crate, those that it depends on.
type Arrows = BTreeMap<String, BTreeSet<String>>;

/// Somebody else's crate, ours that it is for, and ours above it that may name it too. No crate may reach it, through however
/// many others, that may not depend on its owner.
const FOREIGN: [(&str, &str, &[&str]); 4] = [
    ("wgpu", "ivg-render", &[]),
    ("obvhs", "ivg-bake", &[]),
    ("hyper", "ivg-stream", &[]),
    ("tokio", "ivg-stream", &["ivg-cli"]),
];

/// What the crates below everything else may use of other people's, beside tests: they must build without std, and in other
/// people's programs.
const FEW_DEPENDENCIES: [(&str, &[&str]); 3] = [
    ("ivg-wire", &["crc32fast", "zerocopy"]),
    ("ivg-format", &["half", "libm", "zerocopy"]),
    ("pmesh-format", &["safe_arch", "zerocopy"]),
];

fn root() -> PathBuf {
    xtask::workspace_root()
}

fn allowed() -> Arrows {
    let path = root().join("ARCHITECTURE.md");
    parse_table(&std::fs::read_to_string(&path).unwrap()).unwrap()
}

/// Reads the table of the section "Who may depend on whom": names separated by commas on both sides, `none of ours` for
/// nothing. Every row names only crates of rows above it, so that no arrow can point back up.
fn parse_table(markdown: &str) -> Result<Arrows, String> {
    let section = markdown.split("\n## ").find(|section| section.starts_with("Who may depend on whom\n"));
    let section = section.ok_or("no section \"Who may depend on whom\"")?;
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2);
    let mut table = Arrows::new();
    for row in rows {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [crates, on] = cells[..] else { return Err(format!("not two cells: {row}")) };
        let on: BTreeSet<String> = match on {
            "none of ours" => BTreeSet::new(),
            names => names.split(", ").map(str::to_owned).collect(),
        };
        if let Some(name) = on.iter().find(|name| !table.contains_key(*name)) {
            return Err(format!("{crates}: {name} is not a crate of a row above"));
        }
        for name in crates.split(", ") {
            if table.insert(name.to_owned(), on.clone()).is_some() {
                return Err(format!("{name} has two rows"));
            }
        }
    }
    if table.is_empty() { Err("the table is empty".to_owned()) } else { Ok(table) }
}

/// Direct dependencies of the packages of the workspace on crates of ours, of every kind: tests count too.
fn arrows_between(metadata: &Metadata, ours: &BTreeSet<String>) -> Arrows {
    let packages = metadata.workspace_packages();
    let on_ours = |package: &cargo_metadata::Package| {
        package
            .dependencies
            .iter()
            .map(|dependency| dependency.name.clone())
            .filter(|name| ours.contains(name))
            .collect()
    };
    packages.into_iter().map(|package| (package.name.to_string(), on_ours(package))).collect()
}

/// What the table does not allow, or does not know.
fn violations(actual: &Arrows, allowed: &Arrows) -> Vec<String> {
    let mut found = Vec::new();
    for (name, dependencies) in actual {
        let Some(may) = allowed.get(name) else {
            found.push(format!("{name} has no row in ARCHITECTURE.md"));
            continue;
        };
        let forbidden = dependencies.difference(may);
        found.extend(
            forbidden.map(|other| format!("{name} depends on {other}: the table does not have that arrow")),
        );
    }
    let gone = allowed.keys().filter(|name| !actual.contains_key(*name));
    found.extend(
        gone.map(|name| format!("{name} has a row in ARCHITECTURE.md and is no crate of the workspace")),
    );
    found
}

/// The crate and all below it.
fn closure(name: &str, arrows: &Arrows) -> BTreeSet<String> {
    let mut reached = BTreeSet::from([name.to_owned()]);
    let mut open = vec![name.to_owned()];
    while let Some(next) = open.pop() {
        for below in arrows.get(&next).into_iter().flatten() {
            if reached.insert(below.clone()) {
                open.push(below.clone());
            }
        }
    }
    reached
}

/// Manifests only: needs no lock file and no network.
fn metadata_of(manifest: &str) -> Metadata {
    MetadataCommand::new().manifest_path(root().join(manifest)).no_deps().exec().unwrap()
}

/// With everybody's dependencies, all features on, for this machine's platform: all that a build here has downloaded.
fn resolved() -> Metadata {
    let version = Command::new("rustc").arg("-vV").output().unwrap().stdout;
    let version = String::from_utf8(version).unwrap();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let options = ["--locked", "--offline", "--all-features", "--filter-platform", host].map(str::to_owned);
    MetadataCommand::new().manifest_path(root().join("Cargo.toml")).other_options(options).exec().unwrap()
}

/// For each package of the workspace, the names of all packages that it is built or tested with.
fn reachable(metadata: &Metadata) -> Arrows {
    let names: HashMap<&PackageId, String> =
        metadata.packages.iter().map(|package| (&package.id, package.name.to_string())).collect();
    let nodes: HashMap<&PackageId, &cargo_metadata::Node> =
        metadata.resolve.as_ref().unwrap().nodes.iter().map(|node| (&node.id, node)).collect();
    let mut all = Arrows::new();
    for start in &metadata.workspace_members {
        let mut reached = BTreeSet::new();
        let mut open = vec![(start, true)];
        while let Some((id, is_start)) = open.pop() {
            for dependency in &nodes[id].deps {
                // The tests of a dependency are not built for us.
                let built = dependency
                    .dep_kinds
                    .iter()
                    .any(|kind| is_start || kind.kind != DependencyKind::Development);
                if built && reached.insert(&dependency.pkg) {
                    open.push((&dependency.pkg, false));
                }
            }
        }
        all.insert(names[start].clone(), reached.into_iter().map(|id| names[id].clone()).collect());
    }
    all
}

#[test]
fn the_workspace_has_no_arrow_that_the_table_does_not_have() {
    let allowed = allowed();
    let ours = allowed.keys().cloned().collect();
    let actual = arrows_between(&metadata_of("Cargo.toml"), &ours);
    assert_eq!(violations(&actual, &allowed), Vec::<String>::new());
}

#[test]
fn a_forged_arrow_is_found() {
    let allowed = allowed();
    let ours = allowed.keys().cloned().collect();
    let mut actual = arrows_between(&metadata_of("Cargo.toml"), &ours);
    actual.get_mut("ivg-format").unwrap().insert("ivg-grid".to_owned());
    assert_eq!(
        violations(&actual, &allowed),
        ["ivg-format depends on ivg-grid: the table does not have that arrow"]
    );
    actual.get_mut("ivg-format").unwrap().remove("ivg-grid");
    actual.insert("ivg-new".to_owned(), BTreeSet::new());
    actual.remove("xtask");
    assert_eq!(violations(&actual, &allowed).len(), 2);
}

#[test]
fn a_dependency_for_tests_only_is_an_arrow() {
    // conformance is above the format crates: a test of theirs that used it would be an arrow back up.
    let folder = tempfile::tempdir().unwrap();
    let package = "[package]\nname = \"ivg-wire\"\nversion = \"0.1.0\"\nedition = \"2024\"\n";
    let dependency = "[dev-dependencies]\nconformance = { path = \"elsewhere\" }\n";
    std::fs::create_dir(folder.path().join("src")).unwrap();
    std::fs::write(folder.path().join("src/lib.rs"), "").unwrap();
    std::fs::write(folder.path().join("Cargo.toml"), format!("{package}{dependency}")).unwrap();
    let metadata =
        MetadataCommand::new().manifest_path(folder.path().join("Cargo.toml")).no_deps().exec().unwrap();
    let ours = allowed().keys().cloned().collect();
    let found = violations(&arrows_between(&metadata, &ours), &allowed());
    assert!(found.iter().any(|line| line.contains("ivg-wire depends on conformance")), "{found:?}");
}

#[test]
fn a_table_with_an_arrow_back_up_is_refused() {
    let table = |rows: &str| {
        format!("# A\n\n## Who may depend on whom\n\n| crate | on |\n|---|---|\n{rows}\n\n## B\n")
    };
    let good = parse_table(&table("| a, b | none of ours |\n| c | a, b |")).unwrap();
    assert_eq!(good["c"], BTreeSet::from(["a".to_owned(), "b".to_owned()]));
    assert!(good["a"].is_empty());
    for bad in [
        "| a | b |\n| b | none of ours |",
        "| a | a |",
        "| a | none of ours |\n| a | none of ours |",
        "| a |",
        "",
    ] {
        assert!(parse_table(&table(bad)).is_err(), "{bad}");
    }
    assert!(parse_table("# A\n").is_err());
}

#[test]
fn fuzz_targets_use_libraries_only() {
    let libraries: BTreeSet<String> =
        allowed().into_keys().filter(|name| name != "xtask" && name != "ivg-cli").collect();
    let arrows = dependencies_in_other_workspace("fuzz/Cargo.toml");
    assert!(!arrows.is_empty() && arrows.is_subset(&libraries), "{arrows:?}");
}

#[test]
fn the_comparison_with_peers_sees_us_as_a_user_does() {
    let arrows = dependencies_in_other_workspace("tools/peers/Cargo.toml");
    assert_eq!(arrows, BTreeSet::from(["pmesh-format".to_owned()]));
}

#[test]
fn the_link_test_uses_the_crates_that_are_meant_to_need_no_std() {
    let expected = ["ivg-format", "ivg-wire", "pmesh-format"].map(str::to_owned);
    assert_eq!(
        dependencies_in_other_workspace("conformance/nostd-link/Cargo.toml"),
        BTreeSet::from(expected)
    );
}

/// Names of the dependencies with a path: our crates.
fn dependencies_in_other_workspace(manifest: &str) -> BTreeSet<String> {
    let metadata = metadata_of(manifest);
    let dependencies = metadata.workspace_packages().into_iter().flat_map(|package| &package.dependencies);
    dependencies
        .filter(|dependency| dependency.path.is_some())
        .map(|dependency| dependency.name.clone())
        .collect()
}

#[test]
fn heavy_crates_stay_with_their_owners() {
    let allowed = allowed();
    let direct: Arrows = metadata_of("Cargo.toml")
        .workspace_packages()
        .into_iter()
        .map(|package| {
            let names = package.dependencies.iter().map(|dependency| dependency.name.clone()).collect();
            (package.name.to_string(), names)
        })
        .collect();
    let reachable = reachable(&resolved());
    for (foreign, owner, also) in FOREIGN {
        assert!(
            direct[owner].contains(foreign),
            "{foreign} is no longer used by {owner}: the list here is stale"
        );
        for (name, reached) in &reachable {
            let may_name = name == owner || also.contains(&name.as_str());
            assert!(
                may_name || !direct[name].contains(foreign),
                "{name} names {foreign}, which is {owner}'s"
            );
            let may_reach = closure(name, &allowed).contains(owner);
            assert!(
                may_reach || !reached.contains(foreign),
                "{name} is built with {foreign}, which is {owner}'s"
            );
        }
    }
}

#[test]
fn format_crates_have_few_dependencies() {
    let metadata = metadata_of("Cargo.toml");
    let ours: BTreeSet<String> = allowed().into_keys().collect();
    for (name, few) in FEW_DEPENDENCIES {
        let packages = metadata.workspace_packages();
        let package = packages.into_iter().find(|package| package.name.as_str() == name).unwrap();
        for dependency in &package.dependencies {
            let listed = ours.contains(&dependency.name) || few.contains(&dependency.name.as_str());
            assert!(
                listed || dependency.kind == DependencyKind::Development,
                "{name} depends on {}: add it to the list only with a reason in docs/dependencies.md",
                dependency.name
            );
        }
    }
}

#[test]
fn one_file_names_the_bvh_crate() {
    let crate_folder = root().join("ivg-bake");
    let naming: Vec<String> = rust_files(&crate_folder)
        .into_iter()
        .filter(|path| std::fs::read_to_string(path).unwrap().contains("obvhs"))
        .map(|path| path.strip_prefix(&crate_folder).unwrap().to_string_lossy().into_owned())
        // The tests of that file may compare with what it wraps.
        .filter(|path| path != "src/accel/tests.rs")
        .collect();
    assert_eq!(naming, ["src/accel.rs"]);
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}
