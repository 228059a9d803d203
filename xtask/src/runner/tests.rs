use super::{Action, Context, Step, list, run};
use crate::invocation::Invocation;
use std::cell::RefCell;
use std::rc::Rc;

fn call(
    calls: &Rc<RefCell<Vec<&'static str>>>,
    name: &'static str,
    result: Result<(), &'static str>,
) -> Step {
    let calls = Rc::clone(calls);
    let action = Action::Call(
        "a test",
        Box::new(move |_| {
            calls.borrow_mut().push(name);
            result.map_err(str::to_owned)
        }),
    );
    Step { name, actions: vec![action] }
}

fn outcome(steps: &[Step]) -> (bool, String) {
    let mut out = Vec::new();
    let passed = run(steps, &mut Context::new(".".into()), &mut out).unwrap();
    (passed, String::from_utf8(out).unwrap())
}

#[test]
fn all_steps_pass_in_order() {
    let calls = Rc::default();
    let (passed, text) = outcome(&[call(&calls, "first", Ok(())), call(&calls, "second", Ok(()))]);
    assert!(passed);
    assert_eq!(*calls.borrow(), ["first", "second"]);
    assert_eq!(text.lines().last(), Some("2 passed, 0 failed"));
}

#[test]
fn the_first_failure_stops_the_run_and_is_named_at_the_end() {
    let calls = Rc::default();
    let steps = [
        call(&calls, "first", Ok(())),
        call(&calls, "second", Err("it broke")),
        call(&calls, "third", Ok(())),
    ];
    let (passed, text) = outcome(&steps);
    assert!(!passed);
    assert_eq!(*calls.borrow(), ["first", "second"]);
    let end: Vec<&str> = text.lines().rev().take(3).collect();
    assert_eq!(end[0], "1 passed, 1 failed");
    assert_eq!(end[1], "failed: it broke");
    assert!(text.contains("third   not run"), "{text}");
}

#[test]
fn a_failing_command_is_shown_as_it_can_be_repeated() {
    let steps = [Step { name: "no", actions: vec![Action::Run(Invocation::new("false", "--with reasons"))] }];
    let (passed, text) = outcome(&steps);
    assert!(!passed);
    assert!(text.contains("failed: `false --with reasons` ended with"), "{text}");
}

#[test]
fn later_actions_of_a_failed_step_do_not_run() {
    let calls: Rc<RefCell<Vec<&'static str>>> = Rc::default();
    let mut step = call(&calls, "one", Err("no"));
    step.actions.extend(call(&calls, "two", Ok(())).actions);
    assert!(!outcome(&[step]).0);
    assert_eq!(*calls.borrow(), ["one"]);
}

#[test]
fn a_listing_runs_nothing() {
    let calls: Rc<RefCell<Vec<&'static str>>> = Rc::default();
    let mut out = Vec::new();
    assert!(list(&[call(&calls, "first", Ok(()))], &mut out).unwrap());
    assert!(calls.borrow().is_empty());
    assert_eq!(String::from_utf8(out).unwrap(), "first\n    (a test)\n");
}

#[test]
fn the_environment_reaches_the_programs_of_steps() {
    let check = Action::Run(Invocation::new("sh", "-c").argument(r#"test "$GIVEN_BY_THE_SUITE" = yes"#));
    let steps = [Step { name: "environment", actions: vec![check] }];
    let mut context = Context::new(".".into());
    assert!(!run(&steps, &mut context, &mut Vec::new()).unwrap());
    let mut context = context.environment("GIVEN_BY_THE_SUITE", "yes");
    assert!(run(&steps, &mut context, &mut Vec::new()).unwrap());
}
