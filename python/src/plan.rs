//! The plan of a motion in the words of the input: its phases, also after its start or its end was moved.

use emmy::motion::{Phase, StepPlan};
use emmy_io::input::Tree;

/// A table of a tree, created if it is missing.
fn table<'a>(sections: &'a mut Vec<(String, Tree)>, key: &str) -> &'a mut Vec<(String, Tree)> {
    let at = sections.iter().position(|(own, _)| own == key).unwrap_or_else(|| {
        sections.push((key.to_string(), Tree::Table(Vec::new())));
        sections.len() - 1
    });
    if !matches!(sections[at].1, Tree::Table(_)) {
        sections[at].1 = Tree::Table(Vec::new());
    }
    match &mut sections[at].1 {
        Tree::Table(entries) => entries,
        _ => unreachable!("it was made a table"),
    }
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

/// Lets the plan begin at a time: phases before it are left out, and one that the motion does not do leads there. A
/// motion without a plan gets one that it does not follow. Returns whether there is a plan.
pub(crate) fn begin_at(sections: &mut Vec<(String, Tree)>, start: Option<f64>) -> bool {
    if !has(sections, "time") && has(sections, "equilibrium") {
        return true;
    }
    let time = table(sections, "time");
    let start = start.filter(|&start| start > 0.0);
    let lead = start.map(|start| Phase { until: start, size: start });
    if has(time, "adaptive") {
        return true;
    }
    let Some((_, steps)) = time.iter_mut().find(|(key, _)| key == "steps") else {
        let end = Phase { until: start.unwrap_or(0.0) + 1.0, size: 1.0 };
        set(time, "steps", Tree::List(lead.into_iter().chain([end]).map(phase).collect()));
        return false;
    };
    if let (Tree::List(phases), Some(lead)) = (steps, lead) {
        let is_before = |tree: &Tree| until(tree).is_some_and(|until| until <= lead.until);
        // A plan that ends before the start is left as it is: it has no steps.
        if !phases.iter().all(is_before) {
            phases.retain(|tree| !is_before(tree));
            phases.insert(0, phase(lead));
        }
    }
    true
}

/// Moves the end of a plan: earlier phases are cut, or the last one is continued, with steps of another size from the old
/// end on if one is given.
pub(crate) fn extend(
    sections: &mut Vec<(String, Tree)>,
    plan: Option<&StepPlan>,
    now: f64,
    end: f64,
    size: Option<f64>,
) {
    let time = table(sections, "time");
    if has(time, "adaptive") {
        return set(time, "until", Tree::Number(end));
    }
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
    set(time, "steps", Tree::List(phases.into_iter().map(phase).collect()));
}

/// Adds the keys of a table `output`.
pub(crate) fn add_output(sections: &mut Vec<(String, Tree)>, given: Vec<(String, Tree)>) {
    let output = table(sections, "output");
    given.into_iter().for_each(|(key, value)| set(output, &key, value));
}
