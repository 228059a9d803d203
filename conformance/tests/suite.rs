//! The suite is what it says it is: each test shows one thing, each clause for readers has its tests, two readers agree, and our
//! decoders pass.

mod support;

use conformance::reference::Reference;
use conformance::suite::{gaps, lint};
use conformance_runner::manifest::{Op, Suite, Test};
use conformance_runner::run::{LIMIT, Options, Status};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use support::{adapter, copy, vectors};

#[test]
fn every_file_to_refuse_has_one_defect() {
    let (wrong, defects) = lint(&vectors()).unwrap();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(defects > 240, "{defects}");
}

/// Damages a copy of the suite, and says what lint finds.
fn lint_of(damage: impl FnOnce(&Path)) -> String {
    let folder = tempfile::tempdir().unwrap();
    copy(&vectors(), folder.path());
    damage(folder.path());
    lint(folder.path()).unwrap().0.join("\n")
}

/// Changes the entry of a test in the manifest.
fn edit(folder: &Path, id: &str, edit: impl FnOnce(&mut Value)) {
    let path = folder.join("manifest.json");
    let mut manifest: Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
    let tests = manifest["tests"].as_array_mut().unwrap();
    edit(tests.iter_mut().find(|test| test["id"] == id).unwrap());
    fs::write(path, manifest.to_string()).unwrap();
}

#[test]
fn a_second_defect_is_found() {
    // A byte of a bundle, in a file with another mistake: the checksum of the bundle is wrong too.
    let id = "ivg/x-304-exponent-low";
    let found = lint_of(|folder| {
        let path = folder.join(format!("{id}.ivg"));
        let mut bytes = fs::read(&path).unwrap();
        bytes[200] ^= 1;
        fs::write(&path, &bytes).unwrap();
        edit(folder, id, |test| test["sha256"] = conformance_runner::sha256(&bytes).into());
    });
    assert!(found.contains(&format!("{id}: its recipe does not make it of its twin")), "{found}");
    let found = lint_of(|folder| {
        let path = folder.join(format!("{id}.ivg"));
        let mut bytes = fs::read(&path).unwrap();
        bytes[200] ^= 1;
        fs::write(&path, &bytes).unwrap();
        edit(folder, id, |test| {
            test["sha256"] = conformance_runner::sha256(&bytes).into();
            let hex = format!("{:02x}", bytes[200]);
            let more =
                serde_json::json!({"at": 200, "delete": 1, "insert": hex, "field": "corners.payload + 48"});
            test["recipe"]["edits"].as_array_mut().unwrap().push(more);
        });
    });
    assert!(found.contains(r#"checksums that do not fit: ["corners"]"#), "{found}");
}

#[test]
fn damage_of_the_suite_is_found() {
    for (expected, damage) in [
        (
            "has another hash or length",
            Box::new(|folder: &Path| {
                fs::write(folder.join("ivg/0008-small.ivg"), b"").unwrap();
            }) as Box<dyn FnOnce(&Path)>,
        ),
        ("is not in the manifest", Box::new(|folder| fs::write(folder.join("ivg/more"), b"").unwrap())),
        (
            "two tests have this id",
            Box::new(|folder| {
                edit(folder, "ivg/0008-small", |test| test["id"] = "ivg/0007-line".into());
            }),
        ),
        (
            "is no twin",
            Box::new(|folder| {
                edit(folder, "ivg/x-115-trailing", |test| test["twin"] = "ivg/x-105-record-checksum".into());
            }),
        ),
        (
            "it has no twin",
            Box::new(|folder| {
                edit(folder, "ivg/x-115-trailing", |test| {
                    test.as_object_mut().unwrap().remove("twin");
                });
            }),
        ),
        (
            "has not the changes of its two mistakes",
            Box::new(|folder| {
                edit(folder, "pmesh/x-510-wedge-target-and-519-slots-equal", |test| {
                    test["both"][1] = "pmesh/x-519-slots-more".into();
                });
            }),
        ),
        (
            "is not refused as its first mistake is",
            Box::new(|folder| {
                edit(folder, "pmesh/x-510-wedge-target-and-519-slots-equal", |test| {
                    test["both"].as_array_mut().unwrap().reverse();
                });
            }),
        ),
    ] {
        let found = lint_of(damage);
        assert!(found.contains(expected), "{expected}: {found}");
    }
}

#[test]
fn every_clause_for_readers_has_its_tests() {
    let mut manifest = Suite::open(&vectors()).unwrap().manifest;
    assert_eq!(gaps(&manifest), Vec::<String>::new());
    manifest.tests.retain(|test| test.code != Some(303));
    let without = gaps(&manifest);
    assert!(without.contains(&"IVG-LAT-03 has no negative test".to_owned()), "{without:?}");
}

/// The few words of JSON Schema that the schema uses.
fn violation(schema: &Value, root: &Value, value: &Value, place: &str) -> Option<String> {
    let schema = match schema["$ref"].as_str() {
        Some(name) => root.pointer(name.strip_prefix('#').unwrap()).unwrap(),
        None => schema,
    };
    let wrong = |what: &str| Some(format!("{place}: {what}"));
    for (word, rule) in schema.as_object().unwrap() {
        let fits = match (word.as_str(), rule) {
            ("type", rule) => match rule.as_str().unwrap() {
                "object" => value.is_object(),
                "array" => value.is_array(),
                "string" => value.is_string(),
                "integer" => value.is_u64(),
                other => panic!("the type {other}"),
            },
            ("const", rule) => value == rule,
            ("enum", rule) => rule.as_array().unwrap().contains(value),
            ("minimum", rule) => value.as_u64() >= rule.as_u64(),
            ("minItems", rule) => value.as_array().map(|items| items.len() as u64) >= rule.as_u64(),
            ("maxItems", rule) => value.as_array().map(|items| items.len() as u64) <= rule.as_u64(),
            ("pattern", rule) => {
                let text = value.as_str().unwrap_or("?");
                let length = if rule == "^[0-9a-f]{64}$" { Some(64) } else { None };
                assert!(length.is_some() || rule == "^[0-9a-f]*$", "the pattern {rule}");
                length.is_none_or(|length| text.len() == length)
                    && text.bytes().all(|byte| b"0123456789abcdef".contains(&byte))
            }
            ("required", rule) => {
                rule.as_array().unwrap().iter().all(|name| value.get(name.as_str().unwrap()).is_some())
            }
            ("additionalProperties", _) => value
                .as_object()
                .is_none_or(|map| map.keys().all(|key| schema["properties"].get(key).is_some())),
            ("properties", rule) => {
                let inner = |(key, rule): (&String, &Value)| {
                    violation(rule, root, value.get(key)?, &format!("{place}/{key}"))
                };
                if let Some(found) = rule.as_object().unwrap().iter().find_map(inner) {
                    return Some(found);
                }
                true
            }
            ("items", rule) => {
                let inner = |(n, item)| violation(rule, root, item, &format!("{place}/{n}"));
                if let Some(found) = value.as_array().into_iter().flatten().enumerate().find_map(inner) {
                    return Some(found);
                }
                true
            }
            ("description" | "title" | "$schema" | "$defs", _) => true,
            (other, _) => panic!("the word {other}"),
        };
        if !fits {
            return wrong(&format!("{word} {rule}, found {value}"));
        }
    }
    None
}

#[test]
fn the_manifest_has_the_form_of_its_schema() {
    let read = |path: &Path| -> Value { serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap() };
    let schema = read(&vectors().join("../manifest.schema.json"));
    let manifest = read(&vectors().join("manifest.json"));
    assert_eq!(violation(&schema, &schema, &manifest, ""), None);
    for (place, value) in [
        ("/tests/0/kind", Value::from("other")),
        ("/tests/0/more", Value::from(1)),
        ("/tests/0/sha256", Value::from("00")),
        ("/tests/0/bytes", Value::from(-1)),
        ("/tests/0/out/form", Value::Null),
        ("/tests/0/both", Value::from(vec!["ivg/0008-small"])),
        ("/manifest", Value::from(1)),
    ] {
        let mut bad = manifest.clone();
        let (parent, key) = place.rsplit_once('/').unwrap();
        bad.pointer_mut(parent).unwrap().as_object_mut().unwrap().insert(key.to_owned(), value);
        assert!(violation(&schema, &schema, &bad, "").is_some(), "{place}");
    }
    // Every field of a test is used by some test.
    let used: BTreeSet<&String> = manifest["tests"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|test| test.as_object().unwrap().keys())
        .collect();
    let known = schema["$defs"]["test"]["properties"].as_object().unwrap();
    assert_eq!(
        used.into_iter().collect::<Vec<_>>(),
        known.keys().collect::<BTreeSet<_>>().into_iter().collect::<Vec<_>>()
    );
}

/// A second reader, written from the specification alone, shows the levels that OUT must hold.
#[test]
fn the_second_reader_shows_the_same_levels() {
    let suite = Suite::open(&vectors()).unwrap();
    let mut files: BTreeMap<&str, Vec<&Test>> = BTreeMap::new();
    for test in suite.manifest.tests.iter().filter(|test| test.op == Op::Lod) {
        files.entry(test.file.as_deref().unwrap()).or_default().push(test);
    }
    assert!(files.len() > 60, "{}", files.len());
    for (file, tests) in files {
        let bytes = suite.read(file).unwrap();
        let Ok(pmesh_format::Step::Consumed(_, header)) =
            pmesh_format::Header::read(&bytes, &pmesh_format::Limits::default())
        else {
            panic!("{file}: no header")
        };
        let mut reference = Reference::new(&header);
        for k in 0..header.packet_count() {
            let range = header.packet_range(k);
            let bytes = &bytes[range.start as usize..range.end as usize];
            reference.take(pmesh_format::decode_packet(&header, k, bytes).unwrap().payload()).unwrap();
        }
        for test in tests {
            let level: u32 = test.args.as_ref().unwrap().parse().unwrap();
            let mesh = reference.level(level).unwrap_or_default();
            let shown =
                [level.to_le_bytes().to_vec(), conformance::vectors::levels::level_bytes(&mesh)].concat();
            let out = suite.expected(test.out.as_ref().unwrap()).unwrap().unwrap();
            assert!(out.ends_with(&shown), "{}", test.id);
            // Before it are header, directory and names.
            let fields = conformance_runner::layout::fields(test, &out);
            let place = fields.iter().find(|field| field.name == "level").unwrap().at;
            assert_eq!(place, out.len() - shown.len(), "{}", test.id);
        }
    }
}

/// One vertex of vectors, by hand: what is known of the file, then the numbers as they are stored.
#[test]
fn the_smallest_grid_is_shown_as_it_is_stored() {
    let suite = Suite::open(&vectors()).unwrap();
    let test = suite.test("ivg/0001-one-vertex").unwrap();
    let file = suite.read(test.file.as_ref().unwrap()).unwrap();
    let out = suite.expected(test.out.as_ref().unwrap()).unwrap().unwrap();
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    let record = 144 + 8;
    let by_hand = [
        words(&[1, 1, 1]),
        file[64..112].to_vec(),
        words(&[0, 0, 0xFFFF_FFFF, 0xFFFF_FFFF]),
        vec![1, 255, 0],
        file[record..record + 216].to_vec(),
    ]
    .concat();
    assert_eq!(out, by_hand);
}

#[test]
fn our_decoders_pass_every_test() {
    let suite = Suite::open(&vectors()).unwrap();
    let options = Options { decoder: adapter(), only: None, skip: Vec::new(), jobs: 4, limit: LIMIT };
    let results = conformance_runner::run::run(&suite, &options).unwrap();
    let text = conformance_runner::report::text(&suite, &results);
    assert_eq!(results.count(Status::Passed), suite.manifest.tests.len(), "{text}");
}
