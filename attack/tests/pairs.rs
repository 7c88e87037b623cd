//! Every pair of features, computed as the reference does or refused.
#![cfg(unix)]

use emmy_attack::agreement::agrees;
use emmy_attack::features::{AXES, Choice, axis_of, covering, is_void, name, pairs, refusal, tables};

/// A choice by the names of its features; the others are defaults.
fn choice(names: &[(&str, &str)]) -> Choice {
    let mut choice = [0; AXES.len()];
    for (axis, value) in names {
        let axis = axis_of(axis);
        choice[axis] = AXES[axis].values.iter().position(|own| own == value).expect("a value");
    }
    choice
}

/// The choice of a list of features, as faults show it, and its seed, from `EMMY_PAIR`.
fn chosen() -> Option<(Choice, u64)> {
    let text = std::env::var("EMMY_PAIR").ok()?;
    let (names, seed) =
        text.split_once("; seed ").expect("features and a seed, as in the message of a fault");
    let mut choice = [0; AXES.len()];
    for name in names.split(", ").filter(|name| !name.is_empty()) {
        let value = |axis: &usize| AXES[*axis].values.iter().skip(1).position(|own| *own == name);
        let axis = (0..AXES.len()).find(|axis| value(axis).is_some()).expect("a feature");
        choice[axis] = 1 + value(&axis).expect("its value");
    }
    Some((choice, seed.parse().expect("a seed")))
}

/// Faults of choices, in two threads; of the choice in `EMMY_PAIR` alone if there is one.
fn faults(choices: &[Choice]) -> Vec<String> {
    if let Some((choice, seed)) = chosen() {
        return agrees(&choice, seed).err().into_iter().collect();
    }
    let half = choices.len().div_ceil(2);
    let of = |part: &[Choice], first: usize| -> Vec<String> {
        let numbered = part.iter().zip(first..);
        numbered.filter_map(|(choice, number)| agrees(choice, number as u64).err()).collect()
    };
    std::thread::scope(|scope| {
        let (low, high) = choices.split_at(half);
        let second = scope.spawn(|| of(high, half));
        let mut all = of(low, 0);
        all.extend(second.join().expect("a thread without panic"));
        all
    })
}

#[test]
fn every_feature_alone_agrees_with_the_reference() {
    let mut choices = vec![choice(&[])];
    for axis in AXES {
        choices.extend(axis.values.iter().skip(1).map(|value| choice(&[(axis.name, value)])));
    }
    let faults = faults(&choices);
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn every_pair_of_features_agrees_with_the_reference_or_is_refused() {
    let refused = pairs().into_iter().filter(|&(a, b)| refusal(a, b).is_some());
    let mut choices: Vec<Choice> = refused
        .map(|((a, x), (b, y))| choice(&[(AXES[a].name, name((a, x))), (AXES[b].name, name((b, y)))]))
        .collect();
    let computed = covering();
    for (a, b) in pairs() {
        let is_covered = computed.iter().any(|choice| choice[a.0] == a.1 && choice[b.0] == b.1);
        assert!(is_covered || refusal(a, b).is_some() || is_void(a, b), "{} with {}", name(a), name(b));
    }
    eprintln!("{} refused pairs, {} choices cover the others", choices.len(), computed.len());
    choices.extend(computed);
    let faults = faults(&choices);
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// The tables of CONTRIBUTING.md; written there with `EMMY_UPDATE_DOCS=1`.
#[test]
fn the_tables_of_features_are_documented() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../CONTRIBUTING.md");
    let text = std::fs::read_to_string(path).expect("CONTRIBUTING.md");
    let (before, rest) = text.split_once("<!-- features -->\n").expect("the tables");
    let (own, after) = rest.split_once("<!-- end of features -->").expect("their end");
    if std::env::var_os("EMMY_UPDATE_DOCS").is_some() {
        let text = format!("{before}<!-- features -->\n{}<!-- end of features -->{after}", tables());
        std::fs::write(path, text).expect("a file that can be written");
    } else {
        assert_eq!(own, tables(), "run this test again with EMMY_UPDATE_DOCS=1");
    }
}
