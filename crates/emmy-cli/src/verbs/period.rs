//! The lowest period of a body, and the steps that resolve it, for `emmy check`.

use emmy::internals::time::CentralDifferences;
use emmy::modes::{Mode, lowest_elastic_mode};
use emmy::time::Scheme;
use emmy_io::accuracy;
use emmy_io::input::Problem;

use super::check::Report;
use crate::print::number;

/// Largest body whose modes are computed by a check, in degrees of freedom: a second or two.
const MAX_DOFS: usize = 30_000;

/// Reports on the lowest elastic mode about the reference configuration.
pub(super) fn report(report: &mut Report, problem: &Problem) {
    let body = &problem.body;
    if body.n_dofs() > MAX_DOFS {
        let text = format!(
            "not computed beyond {MAX_DOFS} degrees of freedom; `emmy modes --count 7` finds the lowest one"
        );
        report.line("period", &text);
    } else {
        match lowest_elastic_mode(body) {
            Ok(Some((mode, n_rigid))) => lowest(report, problem, &mode, n_rigid),
            Ok(None) => report.line("period", "none: the lowest modes of this body are rigid or unstable"),
            Err(error) => report.line("period", &format!("not found: {error}")),
        }
    }
    if problem.scheme != Scheme::CentralDifferences && !problem.is_static() {
        explicit(report, problem);
    }
}

/// The period, and the steps of the plan over it.
fn lowest(report: &mut Report, problem: &Problem, mode: &Mode, n_rigid: usize) {
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
    let plan = &problem.plan;
    if plan.adaptivity().is_some() || problem.is_static() {
        return;
    }
    let largest = plan.phases().iter().map(|phase| phase.size).fold(0.0, f64::max);
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
    }
    if accuracy::is_coarse(largest, period, problem.scheme) {
        match n_rigid == 0 || accuracy::may_vibrate(problem) {
            true => report.notes.push(accuracy::note(largest, period, problem.scheme, units)),
            false => report
                .line("", "vibrations are not resolved; this is harmless while the body moves as if rigid"),
        }
    }
}

/// The critical step of the explicit scheme, for comparison; there is none with incompatible modes, which have no mass.
fn explicit(report: &mut Report, problem: &Problem) {
    if problem.body.n_dofs() > problem.body.mesh().n_dofs() {
        return;
    }
    let rest = vec![0.0; problem.body.n_dofs()];
    if let Ok([critical, _]) = CentralDifferences::critical_steps(&problem.body, &rest) {
        let text = match critical.is_finite() {
            true => problem.units.number(critical, "time"),
            false => "infinite: nothing is stiff".to_string(),
        };
        report.line("", &format!("critical step of central differences {text}"));
    }
}
