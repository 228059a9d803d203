//! The runner in Rust and `run.py` say the same of any decoder, and both can say that one fails.

mod support;

use conformance_runner::explain::explain;
use conformance_runner::manifest::Suite;
use conformance_runner::report;
use conformance_runner::run::{Options, Results, Status, run};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::time::Duration;
use support::{adapter, vectors};

/// A decoder, the tests that it is given, and how long each may take \[s\].
struct Case {
    decoder: String,
    only: &'static str,
    limit: u64,
}

impl Case {
    fn new(decoder: impl Into<String>, only: &'static str) -> Self {
        Self { decoder: decoder.into(), only, limit: 60 }
    }

    fn in_rust(&self) -> Results {
        let options = Options {
            decoder: self.decoder.clone(),
            only: Some(self.only.to_owned()),
            skip: vec!["*/chunks-3".to_owned()],
            jobs: 1,
            limit: Duration::from_secs(self.limit),
        };
        run(&Suite::open(&vectors()).unwrap(), &options).unwrap()
    }

    fn in_python(&self, folder: &Path) -> Output {
        fs::write(folder.join("skip"), "# what both leave out\n*/chunks-3\n").unwrap();
        let [limit, jobs] = [self.limit.to_string(), "1".to_owned()];
        Command::new("python3")
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("run.py"))
            .args([
                "run",
                "--decoder",
                &self.decoder,
                "--only",
                self.only,
                "--jobs",
                &jobs,
                "--timeout",
                &limit,
            ])
            .arg("--skip")
            .arg(folder.join("skip"))
            .arg("--json")
            .arg(folder.join("results.json"))
            .arg("--junit")
            .arg(folder.join("results.xml"))
            .output()
            .expect("python3")
    }

    /// Runs both, compares what they say, and returns it.
    fn compare(&self) -> Results {
        let folder = tempfile::tempdir().unwrap();
        let (rust, python) = (self.in_rust(), self.in_python(folder.path()));
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        let ours: Value = serde_json::from_str(&report::json(&rust)).unwrap();
        let theirs: Value = serde_json::from_str(&read("results.json")).unwrap();
        assert_eq!(ours, theirs, "{}", self.decoder);
        assert_eq!(report::junit(&rust), read("results.xml"), "{}", self.decoder);
        let text = String::from_utf8(python.stdout).unwrap();
        assert_eq!(text.lines().last(), Some(report::summary(&rust).as_str()), "{}", self.decoder);
        let untimed = |text: &str| -> Vec<String> {
            text.lines()
                .filter(|line| !line.ends_with(" s") && !line.starts_with("    | "))
                .map(str::to_owned)
                .collect()
        };
        let ours = text_of(&rust) + &report::summary(&rust);
        assert_eq!(untimed(&ours), untimed(&text), "{}", self.decoder);
        let failed = rust.count(Status::Failed) > 0;
        assert_eq!(python.status.code(), Some(i32::from(failed)), "{}", self.decoder);
        rust
    }
}

fn text_of(results: &Results) -> String {
    report::text(&Suite::open(&vectors()).unwrap(), results)
}

/// How many tests were not left out.
fn run_of(results: &Results) -> usize {
    results.answers.len() - results.count(Status::Skipped)
}

#[test]
fn both_say_that_a_good_decoder_passes() {
    let results = Case::new(adapter(), "5").compare();
    assert!(results.count(Status::Passed) > 500, "{}", report::summary(&results));
    assert_eq!(results.count(Status::Failed), 0, "{}", text_of(&results));
    assert!(results.count(Status::Skipped) > 0);
}

#[test]
fn both_say_that_a_bad_decoder_fails_everything() {
    for decoder in
        ["sh -c 'exit 0'", "sh -c 'exit 41'", "sh -c 'kill -SEGV $$'", "sh -c 'exit 1'", "/no/such/decoder"]
    {
        for only in ["ivg/0005*", "pmesh/x-11*", "x-603", "numeric"] {
            let results = Case::new(decoder, only).compare();
            assert_eq!(results.count(Status::Failed), run_of(&results), "{decoder}, {only}");
        }
    }
}

#[test]
fn both_stop_waiting_for_a_decoder_that_gives_no_answer() {
    let folder = tempfile::tempdir().unwrap();
    let mark = folder.path().join("alive").display().to_string();
    // What hangs was started by what was started.
    let decoder = format!("sh -c 'sh -c \"sleep 4; touch {mark}\"; true'");
    let results = Case { limit: 1, ..Case::new(decoder, "ivg/000*") }.compare();
    assert!(results.answers.len() > 50);
    assert_eq!(results.count(Status::Failed), run_of(&results));
    assert_eq!(results.answers[0].detail, "no answer in time");
    std::thread::sleep(Duration::from_secs(4));
    assert!(!Path::new(&mark).exists(), "it was ended too");
}

#[test]
fn both_name_the_first_number_that_differs() {
    // It shows every file as it is.
    let decoder = r#"sh -c 'if [ "$3" ]; then cp "$2" "$3"; fi'"#;
    for only in ["ivg/0005*", "pmesh/0005*"] {
        let results = Case::new(decoder, only).compare();
        assert_eq!(results.count(Status::Passed), 0);
        let named = results.answers.iter().filter(|answer| answer.detail.contains("(byte ")).count();
        assert!(named > 5, "{}", text_of(&results));
        let text = text_of(&results);
        assert!(text.contains("every test of these clauses failed: "), "{text}");
        let ours = results.answers.iter().find(|answer| !answer.clauses.is_empty()).unwrap();
        assert!(report::junit(&results).contains(&format!("; {}", ours.clauses[0])));
    }
}

#[test]
fn both_ask_no_more_than_is_claimed() {
    let claims = r"ivg decode chunks prefixes\nencodings packed-oct24\norders slices\ncodes\n";
    let script = format!(
        r#"case $0 in capabilities) printf "{claims}";; *) exec {} "$0" "$@";; esac"#,
        adapter().replace('\'', "")
    );
    let results = Case::new(format!("sh -c '{script}'"), "-1").compare();
    let of = |id: &str| results.answers.iter().find(|answer| answer.id == id).unwrap().status;
    assert_eq!(of("ivg/x-118-reserved"), Status::Passed);
    // It reads an order that it says it does not have.
    assert_eq!(of("ivg/0110-octree-1x1x1/chunks-1"), Status::Failed);
    assert_eq!(of("ivg/0005-validity/prefix-144"), Status::NotClaimed);
    assert_eq!(of("pmesh/x-111-record-id"), Status::NotClaimed);
}

/// What `run.py` prints.
fn printed(arguments: &[&str]) -> String {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("run.py");
    let output = Command::new("python3").arg(script).args(arguments).output().expect("python3");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[test]
fn both_explain_and_list_alike() {
    let suite = Suite::open(&vectors()).unwrap();
    for id in [
        "ivg/0005-validity",
        "ivg/x-303-step-zero",
        "ivg/x-603-chunks/chunks-mixed",
        "ivg/x-605-vertices",
        "pmesh/x-502-coded-normal",
        "pmesh/0005-seam/lod-4",
        "pmesh/x-111-packets-swapped",
        "numeric/oct24",
    ] {
        let text = explain(&suite, id).unwrap();
        assert_eq!(text, printed(&["explain", id]));
        // The text of every clause is found.
        let clauses = &suite.test(id).unwrap().clauses;
        assert!(clauses.iter().all(|clause| text.contains(&format!("\n**{clause}** ("))), "{text}");
    }
    let text = explain(&suite, "ivg/x-303-step-zero").unwrap();
    assert!(text.contains("  header.step, at 88 (0x58):") || text.contains("header.step + "), "{text}");
    assert!(explain(&suite, "ivg/none").is_err());
    assert_eq!(report::list(&suite, Some("x-3*")), printed(&["list", "--only", "x-3*"]));
    assert_eq!(report::list(&suite, Some("lod")), printed(&["list", "--only", "lod"]));
}

#[test]
fn the_small_reader_in_python_passes_what_it_claims() {
    let adapter = Path::new(env!("CARGO_MANIFEST_DIR")).join("adapters/python/adapter.py");
    let results = Case::new(format!("python3 '{}'", adapter.display()), "ivg/0005*").in_rust();
    assert_eq!(results.count(Status::Failed), 0, "{}", text_of(&results));
    assert!(results.count(Status::Passed) > 10, "{}", report::summary(&results));
    assert!(results.count(Status::NotClaimed) > 3, "{}", report::summary(&results));
}
