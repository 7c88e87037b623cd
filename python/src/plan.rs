//! The plan of a motion in the words of the input: its phases, also after its start or its end was moved.

use emmy::motion::{Phase, StepPlan};
use emmy_io::input::Tree;

use crate::body::entries;

/// Changes the entries of a table, which is created if it is missing.
fn edit<T>(
    sections: &mut Vec<(String, Tree)>,
    key: &str,
    change: impl FnOnce(&mut Vec<(String, Tree)>) -> T,
) -> T {
    let at = sections.iter().position(|(own, _)| own == key);
    let mut table = at.map_or(Vec::new(), |at| entries(sections.remove(at).1));
    let value = change(&mut table);
    sections.insert(at.unwrap_or(sections.len()), (key.to_string(), Tree::Table(table)));
    value
}

fn set(entries: &mut Vec<(String, Tree)>, key: &str, value: Tree) {
    entries.retain(|(own, _)| own != key);
    entries.push((key.to_string(), value));
}

fn has(sections: &[(String, Tree)], key: &str) -> bool {
    sections.iter().any(|(own, _)| own == key)
}

fn phase(Phase { until, size }: Phase) -> Tree {
    let entry = |key: &str, value| (key.to_string(), Tree::Number(value));
    Tree::Table(vec![entry("until", until), entry("size", size)])
}

fn number(tree: &Tree) -> Option<f64> {
    match tree {
        Tree::Number(value) => Some(*value),
        Tree::Whole(value) => Some(*value as f64),
        _ => None,
    }
}

/// The end of a phase.
fn until(tree: &Tree) -> Option<f64> {
    let Tree::Table(entries) = tree else { return None };
    entries.iter().find(|(key, _)| key == "until").and_then(|(_, value)| number(value))
}

/// Adds a plan from a start on, if there is none; a motion does not follow it. Returns whether there was a plan.
pub(crate) fn complete(sections: &mut Vec<(String, Tree)>, start: f64) -> bool {
    if !has(sections, "time") && has(sections, "equilibrium") {
        return true;
    }
    edit(sections, "time", |time| {
        let is_planned = has(time, "adaptive") || has(time, "steps");
        if !is_planned {
            let start = start.max(0.0);
            let lead = (start > 0.0).then_some(Phase { until: start, size: start });
            let end = Phase { until: start + 1.0, size: 1.0 };
            set(time, "steps", Tree::List(lead.into_iter().chain([end]).map(phase).collect()));
        }
        is_planned
    })
}

/// Makes the plan begin at a time: one phase, which the motion never runs, replaces everything before it.
pub(crate) fn begin_at(sections: &mut Vec<(String, Tree)>, start: f64) {
    edit(sections, "time", |time| {
        let Some((_, Tree::List(phases))) = time.iter_mut().find(|(key, _)| key == "steps") else { return };
        phases.retain(|tree| until(tree).is_none_or(|until| until > start));
        phases.insert(0, phase(Phase { until: start, size: start }));
    });
}

/// Moves the end of a plan: earlier phases are cut, or the last one is continued, with steps of another size from the
/// old end on if one is given.
pub(crate) fn extend(
    sections: &mut Vec<(String, Tree)>,
    plan: Option<&StepPlan>,
    now: f64,
    end: f64,
    size: Option<f64>,
) {
    edit(sections, "time", |time| match has(time, "adaptive") {
        true => set(time, "until", Tree::Number(end)),
        false => {
            set(time, "steps", Tree::List(phases(plan, now, end, size).into_iter().map(phase).collect()))
        }
    });
}

/// The phases of a plan with its end at another time.
fn phases(plan: Option<&StepPlan>, now: f64, end: f64, size: Option<f64>) -> Vec<Phase> {
    let before = plan.map_or(&[][..], StepPlan::phases);
    let mut phases: Vec<Phase> = before.iter().copied().filter(|phase| phase.until < end).collect();
    if plan.is_none() && now > 0.0 {
        phases.push(Phase { until: now, size: now });
    }
    let cut = before.get(phases.len()).map(|phase| phase.size);
    let last = before.last().map(|phase| phase.size);
    match (cut, size, last) {
        // It ends inside the plan.
        (Some(size), _, _) | (None, Some(size), _) => phases.push(Phase { until: end, size }),
        (None, None, Some(size)) => match phases.last_mut() {
            Some(phase) => phase.until = end,
            None => phases.push(Phase { until: end, size }),
        },
        (None, None, None) => {}
    }
    phases
}

/// Adds the keys of a table `output`; `every` and `interval` replace each other.
pub(crate) fn add_output(sections: &mut Vec<(String, Tree)>, given: Vec<(String, Tree)>) {
    edit(sections, "output", |output| {
        let is_given = |key: &str| given.iter().any(|(given, _)| given == key);
        output.retain(|(own, _)| match own.as_str() {
            "every" => !is_given("interval"),
            "interval" => !is_given("every"),
            _ => true,
        });
        given.into_iter().for_each(|(key, value)| set(output, &key, value));
    });
}
