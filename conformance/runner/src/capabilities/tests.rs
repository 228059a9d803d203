use super::{Capabilities, Plan};
use crate::manifest::{Test, Verdict};

fn test(json: &str) -> Test {
    let rest = r#""kind": "positive", "verdict": "invalid", "code": 303, "why": "", "origin": """#;
    serde_json::from_str(&format!("{{{json}, {rest}}}")).unwrap()
}

fn run(verdict: Verdict, code: Option<u16>) -> Plan {
    Plan::Run { verdicts: vec![verdict], code, out: false }
}

#[test]
fn what_is_not_claimed_is_not_run() {
    let decode = test(r#""id": "a", "format": "ivg", "op": "decode", "needs": {"order": "octree"}"#);
    let prefixes = test(r#""id": "a", "format": "ivg", "op": "prefixes", "needs": {"order": "octree"}"#);
    let mesh = test(r#""id": "a", "format": "pmesh", "op": "decode""#);
    let table = test(r#""id": "a", "op": "numeric", "args": "f16""#);
    let all = Capabilities::parse("name mine 1\nivg decode prefixes\ncodes\nnumeric f16 oct24\n");
    assert_eq!(all.name().as_deref(), Some("mine 1"));
    assert_eq!(all.plan(&decode), run(Verdict::Invalid, Some(303)));
    assert_eq!(all.plan(&prefixes), run(Verdict::Invalid, Some(303)));
    assert_eq!(all.plan(&mesh), Plan::NotClaimed);
    assert_eq!(all.plan(&table), run(Verdict::Invalid, Some(303)));
    let few = Capabilities::parse("ivg decode prefixes\norders slices\n");
    assert_eq!(few.plan(&decode), run(Verdict::Unsupported, None));
    assert_eq!(few.plan(&prefixes), Plan::NotClaimed);
    assert_eq!(few.plan(&table), Plan::NotClaimed);
    let bare = Capabilities::parse("ivg\n");
    assert_eq!(bare.plan(&decode), run(Verdict::Invalid, None));
    assert_eq!(bare.plan(&prefixes), Plan::NotClaimed);
}

#[test]
fn who_names_no_format_is_tested_in_everything() {
    for text in ["", "codes\n", "Segmentation fault"] {
        let capabilities = Capabilities::parse(text);
        let mesh = test(r#""id": "a", "format": "pmesh", "op": "lod", "needs": {"mode": "coded"}"#);
        assert_eq!(capabilities.plan(&mesh), run(Verdict::Invalid, Some(303)), "{text}");
    }
}
