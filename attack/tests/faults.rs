//! The attack detects faults.
#![cfg(unix)]

use std::path::Path;
use std::time::Duration;

use emmy_attack::emmy::{Emmy, Outcome};
use emmy_attack::faults::{check, ends_with, is_finite};
use emmy_attack::mutation::damaged;
use emmy_attack::place::Place;
use fastrand::Rng;

/// A shell script instead of the binary.
fn shell(script: &str) -> Outcome {
    Emmy::new("/bin/sh".into()).call("/", ["-c", script]).run()
}

#[track_caller]
fn is_fault(script: &str, part: &str) {
    let fault = check(&shell(script)).unwrap_err();
    assert!(fault.contains(part), "{part} is not in {fault}");
}

#[test]
fn signals_panics_and_bad_messages_are_faults() {
    is_fault("kill -ABRT $$", "signal 6");
    is_fault("echo oh >&2; exit 101", "exit code 101");
    is_fault("exit 2", "without a message");
    is_fault("printf '\\033[2J' >&2; exit 2", "control character");
    is_fault("yes | head -20000 >&2; exit 2", "a message of 40000 bytes");
}

#[test]
fn documented_endings_are_no_faults() {
    assert_eq!(check(&shell("exit 0")), Ok(()));
    let rejected = shell("echo 'no such key' >&2; exit 2");
    assert_eq!(check(&rejected), Ok(()));
    assert!(ends_with(&rejected, &[0]).is_err() && ends_with(&rejected, &[0, 2]).is_ok());
}

#[test]
fn a_call_is_killed_after_its_time() {
    let call = Emmy::new("/bin/sh".into())
        .call("/", ["-c", "sleep 9"])
        .killed_after(Duration::from_millis(20))
        .run();
    assert_eq!((call.signal, call.is_hung), (Some(9), false));
}

#[test]
fn numbers_that_are_none_are_seen_in_a_history() {
    let place = Place::new();
    let checked = |rows: &str| {
        place.write("history.csv", format!("step,time,smallest_determinant\n{rows}"));
        is_finite(&place.path("history.csv"))
    };
    assert!(checked("0,0.0,inf\n1,0.1,1.0\n").is_ok());
    assert!(checked("0,0.0,1.0\n1,NaN,1.0\n").unwrap_err().contains("time is NaN"));
    assert!(is_finite(Path::new("not/there")).is_err());
}

#[test]
fn damage_depends_on_the_seed_alone() {
    let text = b"mesh.box = { size = [1, 2, 1] }\ndensity = 1.5e3\n";
    let copies =
        |seed: u64| (0..200).map(|i| damaged(text, &mut Rng::with_seed(seed + i))).collect::<Vec<_>>();
    assert_eq!(copies(7), copies(7));
    let same = copies(7).iter().filter(|copy| copy.as_slice() == text).count();
    assert!(same < 20, "{same} of 200 are not damaged");
}
