use super::{fits, patterns, split};

#[test]
fn commands_are_split_as_a_shell_would() {
    for (command, words) in [
        ("./decoder", vec!["./decoder"]),
        ("  node  a.mjs\t-x ", vec!["node", "a.mjs", "-x"]),
        (r#"'my decoder' "a \"b\" \\ \c" d\ e"#, vec!["my decoder", r#"a "b" \ \c"#, "d e"]),
        ("a''b \"\"", vec!["ab", ""]),
        ("echo $HOME; x", vec!["echo", "$HOME;", "x"]),
    ] {
        assert_eq!(split(command).unwrap(), words, "{command}");
    }
    for command in ["", "  ", "'a", "\"a", "a\\", "\"a\\"] {
        assert!(split(command).is_err(), "{command}");
    }
}

#[test]
fn a_pattern_is_a_part_of_an_id_or_has_stars() {
    let id = "ivg/0005-validity/prefix-144";
    for pattern in ["", "0005", "ivg/*", "*prefix-144", "ivg/*/prefix-*", "*", "ivg*-*-144"] {
        assert!(fits(pattern, id), "{pattern}");
    }
    for pattern in ["0006", "pmesh/*", "*prefix", "ivg/*/chunks-*", "*144*144"] {
        assert!(!fits(pattern, id), "{pattern}");
    }
}

#[test]
fn lists_to_skip_have_remarks() {
    assert_eq!(patterns("# all\nivg/*  # later\n\n numeric \n"), ["ivg/*", "numeric"]);
}
