//! The lowest period of a body, and the steps that resolve it, for `emmy check`.

use emmy::internals::time::CentralDifferences;
use emmy::modes::{Mode, lowest_elastic_mode};
use emmy::time::Scheme;
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
    let share = largest / period;
    report.line(
        "",
        &format!(
            "a step of {} is {} of this period: {} steps a period",
            units.number(largest, "time"),
            two_digits(share),
            count(1.0 / share)
        ),
    );
    if problem.scheme != Scheme::CentralDifferences {
        let wanted = steps_per_period(problem.scheme.degree());
        let size = number(rounded_down(period / wanted));
        report.line(
            "",
            &format!("`size = {size}` makes {wanted} steps a period: a phase error of about 0.1 %"),
        );
    }
}

/// Steps in a period of the lowest mode, for a relative phase error of 1e-3: `(omega h)^2/12` with degree 1,
/// `(omega h)^4/720` with degree 2, less with higher ones.
fn steps_per_period(degree: usize) -> f64 {
    if degree == 1 { 58.0 } else { 8.0 }
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

/// A number with two digits.
fn two_digits(value: f64) -> String {
    format!("{value:.1e}").parse::<f64>().map_or_else(|_| number(value), number)
}

/// A number of steps with one digit after the point, where that says more.
fn count(steps: f64) -> String {
    if steps < 10.0 { format!("{steps:.1}") } else { format!("{steps:.0}") }
}

/// The number with two digits, rounded down.
fn rounded_down(value: f64) -> f64 {
    let digit = 10f64.powi(value.log10().floor() as i32 - 1);
    // The small excess keeps a number that already has two digits.
    (value / digit * (1.0 + 1e-12)).floor() * digit
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggested_sizes_have_two_digits() {
        for (value, expected) in [(0.012345, "0.012"), (7.99e-6, "0.0000079"), (31.0, "31"), (0.025, "0.025")]
        {
            assert_eq!(number(rounded_down(value)), number(expected.parse::<f64>().unwrap()));
        }
    }

    /// (omega h)^2/12 and (omega h)^4/720 for h = T/n.
    #[test]
    fn phase_errors_of_the_suggestions() {
        let angle = |degree| std::f64::consts::TAU / steps_per_period(degree);
        assert!(angle(1).powi(2) / 12.0 < 1e-3 && angle(2).powi(4) / 720.0 < 1e-3);
    }
}
