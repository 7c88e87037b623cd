//! The lowest period of a body, and the steps that resolve it, for `emmy check`.

use std::borrow::Cow;

use emmy::internals::time::CentralDifferences;
use emmy::modes::{Mode, lowest_elastic_mode, lowest_elastic_mode_about};
use emmy::motion::State;
use emmy::time::Scheme;
use emmy_io::accuracy;
use emmy_io::input::{Problem, Start, StartError};

use super::check::Report;
use crate::failure::with_causes;
use crate::print::number;

/// Largest body whose modes a check computes, in degrees of freedom; they take a second or two.
const MAX_DOFS: usize = 30_000;

/// Reports on the lowest elastic mode of the start.
pub(super) fn report(report: &mut Report, problem: &Problem, start: Option<&State>) {
    let body = &problem.body;
    if body.n_dofs() > MAX_DOFS {
        let text = format!(
            "not computed beyond {MAX_DOFS} degrees of freedom; `emmy modes --count 7` finds the lowest one"
        );
        report.line("period", &text);
    } else {
        of_start(report, problem, start);
    }
    let has_joints = !(problem.rigid.is_empty() && problem.joints.is_empty());
    if problem.scheme != Scheme::CentralDifferences && !problem.is_static() && !has_joints {
        explicit(report, problem);
    }
}

/// The lowest elastic mode about the state from which the motion starts.
fn of_start(report: &mut Report, problem: &Problem, start: Option<&State>) {
    let (about, state) = match state(problem, start) {
        Ok(found) => found,
        Err(error) => {
            return report.line("period", &format!("not found: no equilibrium: {}", with_causes(&error)));
        }
    };
    let found = match &state {
        Some(state) => lowest_elastic_mode_about(&problem.body, state),
        None => lowest_elastic_mode(&problem.body),
    };
    match found {
        Ok(Some((mode, n_rigid))) => lowest(report, problem, &mode, (n_rigid, about)),
        Ok(None) => {
            let modes = format!("the lowest modes {about}");
            report.line("period", &format!("none: {} are rigid or unstable", modes.trim_end()));
        }
        Err(error) => report.line("period", &format!("not found: {error}")),
    }
}

/// The state about which the body vibrates, in words and as a state; `None`: the undeformed body. The equilibrium of a
/// larger body takes too long for a check.
fn state<'a>(
    problem: &Problem,
    start: Option<&'a State>,
) -> Result<(&'static str, Option<Cow<'a, State>>), StartError> {
    match problem.start {
        Start::Run(_) => Ok(("about the state of that run", start.map(Cow::Borrowed))),
        Start::Undeformed if !problem.is_static() => Ok(("", None)),
        _ if accuracy::has_cheap_equilibrium(problem) => {
            Ok(("about the equilibrium", problem.state_of_vibration()?.map(Cow::Owned)))
        }
        _ => Ok(("about the undeformed body: `emmy modes` has those about the equilibrium", None)),
    }
}

/// The period, and the steps of the plan over it.
fn lowest(report: &mut Report, problem: &Problem, mode: &Mode, (n_rigid, about): (usize, &str)) {
    let units = problem.units;
    let period = mode.period();
    let frequency = units.number(mode.frequency(), "frequency");
    let beside = match n_rigid {
        0 => String::new(),
        1 => ", beside 1 rigid mode".to_string(),
        n => format!(", beside {n} rigid modes"),
    };
    let text = format!(
        "{} in the lowest elastic mode (frequency {frequency}){beside}",
        units.number(period, "time")
    );
    report.line("period", &text);
    if !about.is_empty() {
        report.line("", about);
    }
    let plan = &problem.plan;
    if plan.adaptivity().is_some() || problem.is_static() {
        return;
    }
    let largest = plan.largest_step();
    let steps = match largest < period {
        true => format!(": {} steps a period", accuracy::count(period / largest)),
        false => String::new(),
    };
    let part = accuracy::part(largest, period);
    report.line("", &format!("a step of {} is {part} this period{steps}", units.number(largest, "time")));
    let is_explicit = problem.scheme == Scheme::CentralDifferences;
    if !is_explicit {
        let wanted = accuracy::steps_per_period(problem.scheme);
        let size = number(accuracy::suggested_size(period, problem.scheme));
        report.line(
            "",
            &format!("`size = {size}` makes {wanted} steps a period: a phase error of about 0.1 %"),
        );
        let shortest = shortest_part(problem);
        if let Some(part) =
            shortest.filter(|part| part / 8.0 < accuracy::suggested_size(period, problem.scheme))
        {
            let [size, part] = [number(part / 8.0), units.number(part, "time")];
            let text =
                format!("`size = {size}` makes 8 steps in the shortest part of a load, which lasts {part}");
            report.line("", &text);
        }
    }
    if accuracy::is_coarse(largest, period, problem.scheme) {
        match n_rigid == 0 || accuracy::may_vibrate(problem) {
            true => report.notes.push(accuracy::note(largest, period, problem.scheme, units)),
            false => report
                .line("", "vibrations are not resolved; this is harmless while the body moves as if rigid"),
        }
    }
}

/// The shortest time between two kinks of a load or of a given motion, if it is no jump; records have none.
fn shortest_part(problem: &Problem) -> Option<f64> {
    let laws = problem.time_functions().filter(|law| !law.acceleration().unwrap_or(law).is_measured());
    let plan = &problem.plan;
    let parts = laws.flat_map(|law| {
        let kinks = law.kinks();
        kinks
            .windows(2)
            .filter(|pair| pair[0] < plan.end())
            .map(|pair| pair[1] - pair[0])
            .collect::<Vec<f64>>()
    });
    // Shorter parts are jumps that have been given a duration.
    parts.filter(|part| *part >= 1e-3 * (plan.end() - plan.start())).min_by(f64::total_cmp)
}

/// The critical step of the explicit scheme, for comparison. For a large body it is a bound from the cells, which needs
/// no matrix. Bodies with incompatible modes, which have no mass, have none.
fn explicit(report: &mut Report, problem: &Problem) {
    if problem.body.n_dofs() > problem.body.mesh().n_dofs() {
        return;
    }
    let body = &problem.body;
    let step = if body.n_dofs() > MAX_DOFS {
        let bound = body.frequency_bound().ok().flatten();
        bound.map(|square| (2.0 / square.sqrt(), "at least "))
    } else {
        let rest = vec![0.0; body.n_dofs()];
        CentralDifferences::critical_steps(body, &rest).ok().map(|[critical, _]| (critical, ""))
    };
    let Some((critical, least)) = step else { return };
    let text = match critical.is_finite() {
        true => format!("{least}{}", problem.units.number(critical, "time")),
        false => "infinite: nothing is stiff".to_string(),
    };
    report.line("", &format!("critical step of central differences {text}"));
}
