//! `[time]`: scheme with its degree, and step plan; `--until`.

use emmy::body::Body;
use emmy::internals::time::SCHEMES;
use emmy::motion::{Phase, StepPlan};
use emmy::time::{MAX_DEGREE, Scheme};

use super::adaptive;
use super::description::{Described, Kind, NUMBER, POSITIVE, Section, list};
use super::fault::{Fault, Place};
use super::suggest::nearest;
use super::table::{Item, Table, spelled};

/// `[time]`.
pub(super) static TIME: Described = Described::new(|| {
    Section::new("[time]", "Scheme, degree and steps")
        .must("scheme", Kind::Scheme(doubt), "", "Scheme in time; `emmy list schemes` explains them")
        .may(
            "degree",
            Kind::Whole(1, Some(MAX_DEGREE)),
            "",
            "Degree k of the time elements; of order 2k at the ends of the steps",
        )
        .default("1")
        .may("steps", list(1, Kind::Table(&PHASE)), "", "Phases of steps, from t = 0 on")
        .may(
            "adaptive",
            Kind::Table(&adaptive::ADAPTIVE),
            "",
            "Sizes chosen by the error of each step, in place of `steps`",
        )
        .may("until", NUMBER, "time", "End of a run with adaptive steps")
        .may(
            "smallest_step",
            POSITIVE,
            "time",
            "Size down to which a failing step is halved; if it exceeds the planned sizes, steps are not cut",
        )
        .absent("1/1024 of the planned size")
        .at_least_one(&["steps", "adaptive"])
});

static PHASE: Described = Described::new(|| {
    Section::new("a phase of steps", "Steps of one size")
        .must("until", NUMBER, "time", "Time at which the phase ends")
        .must("size", POSITIVE, "time", "Step size; the last step of a phase is shortened to end on `until`")
});

/// Scheme and plan.
#[derive(Debug, Clone)]
pub(super) struct Time {
    pub(super) scheme: Scheme,
    pub(super) plan: StepPlan,
    /// Place of `adaptive`.
    pub(super) adaptive: Option<Place>,
    /// Smallest size of a cut step.
    pub(super) smallest_step: Option<f64>,
}

/// Reads the table; `until` is the end given on the command line, `step` a time and the step size after it.
pub(super) fn read(table: &Table<'_>, until: Option<f64>, step: Option<(f64, f64)>) -> Result<Time, Fault> {
    let (scheme_item, degree_item): (Item<'_>, Item<'_>) = (table.must("scheme"), table.must("degree"));
    let scheme = Scheme::from_name(table.must("scheme"));
    let scheme = scheme.and_then(|scheme| scheme.with_degree(table.must("degree"))).map_err(|error| {
        let fault = scheme_item.fault(error.to_string(), "this scheme");
        fault.label(degree_item.place(), "with this degree")
    })?;
    let plan = match table.item("adaptive") {
        Some(adaptive) => adaptive::plan(table, &adaptive, scheme, (&scheme_item, &degree_item), until)?,
        None => {
            adaptive::check_until(table)?;
            plan(table)?
        }
    };
    let plan = until.map_or(Ok(plan.clone()), |until| cut_or_extended(&plan, until))?;
    let plan = step.map_or(Ok(plan.clone()), |(from, size)| with_size_from(&plan, from, size))?;
    let adaptive = table.item("adaptive").map(|item| item.place().clone());
    Ok(Time { scheme, plan, adaptive, smallest_step: table.may("smallest_step") })
}

/// Checks that there is a scale of positions.
pub(super) fn check_scale(body: &Body, time: &Time) -> Result<(), Fault> {
    let has_scale = time.plan.adaptivity().is_none_or(|adaptivity| adaptivity.length.is_some());
    match &time.adaptive {
        Some(place) if !has_scale && body.radius_of_gyration() == 0.0 => {
            let message = "`adaptive` needs a `length`: the body is a point and has none";
            Err(Fault::at(place, message, "needs `length`"))
        }
        _ => Ok(()),
    }
}

/// The fault of a scheme's name.
fn doubt(text: &str) -> Option<(Fault, String)> {
    let error = Scheme::from_name(text).err()?;
    // Only numbers are out of range.
    let is_known = !error.to_string().contains("not a scheme");
    let label = if is_known { "this scheme".to_string() } else { meant(text) };
    Some((Fault::new(error.to_string()).help("`emmy list schemes` explains them"), label))
}

/// A label for a text that is no scheme: the scheme that is meant, with the numbers of the text, or else its form.
fn meant(text: &str) -> String {
    let word = |form: &'static str| form.split('(').next().unwrap_or(form);
    let letters = |text: &str| text.to_lowercase().replace(|c: char| !c.is_ascii_alphabetic(), "");
    let (name, numbers) = text.split_at(text.find(|c: char| "(0123456789".contains(c)).unwrap_or(text.len()));
    let scheme = match &*letters(name) {
        "dg" | "discretegradient" | "energymomentum" => "DGM",
        "midpoint" | "implicitmidpoint" => "FE(1)",
        "simotarnow" => "AS(1)",
        "averageacceleration" => "trapezoidal",
        "cg" => "FE",
        name => {
            let known: Vec<String> = SCHEMES.iter().map(|row| letters(word(row.form))).collect();
            let near = nearest(name, known.iter().map(String::as_str));
            let Some(row) = known.iter().position(|own| Some(&**own) == near) else {
                return "not a scheme".to_string();
            };
            word(SCHEMES[row].form)
        }
    };
    let numbers = numbers.trim_matches(['(', ')', ' ']).split(',').map(str::trim);
    let numbers: Vec<&str> = numbers.filter(|number| !number.is_empty()).collect();
    let own = match &numbers[..] {
        [] => scheme.to_string(),
        numbers => format!("{scheme}({})", numbers.join(", ")),
    };
    if Scheme::from_name(&own).is_ok() {
        return format!("did you mean \"{own}\"?");
    }
    let forms = SCHEMES.iter().map(|row| row.form).filter(|form| word(form) == word(scheme));
    format!("did you mean the form {}?", forms.collect::<Vec<_>>().join(" or "))
}

fn plan(table: &Table<'_>) -> Result<StepPlan, Fault> {
    let (item, tables): (Item<'_>, Vec<Table<'_>>) = (table.must("steps"), table.must("steps"));
    let phase = |table: &Table<'_>| Phase { until: table.must("until"), size: table.must("size") };
    StepPlan::new(0.0, tables.iter().map(phase).collect()).map_err(|error| match error {
        emmy::Error::Plan { phase, reason } => {
            let place = tables.get(phase).map_or(item.place(), |table| table.place);
            Fault::at(place, format!("phase {} of `steps`: {reason}", phase + 1), "this phase")
        }
        other => item.fault(other.to_string(), "here"),
    })
}

/// Message about an invalid plan.
fn plan_reason(error: emmy::Error) -> String {
    match error {
        emmy::Error::Plan { reason, .. } => reason,
        error => error.to_string(),
    }
}

/// The plan with another end: later phases are left out, or the last one is extended.
fn cut_or_extended(plan: &StepPlan, until: f64) -> Result<StepPlan, Fault> {
    let flag = format!("--until {}", spelled(until));
    let place = Place::start_of("--until", &flag).at("--until ".len()..flag.len());
    if !until.is_finite() {
        return Err(Fault::at(&place, format!("{flag}: the time must be a finite number"), "not finite"));
    }
    let mut phases: Vec<Phase> = plan.phases().iter().copied().filter(|phase| phase.until < until).collect();
    let next = plan.phases().get(phases.len()).copied();
    match (next, phases.last_mut()) {
        (Some(phase), _) => phases.push(Phase { until, ..phase }),
        (None, Some(last)) => last.until = until,
        (None, None) => {}
    }
    plan.with_phases(phases)
        .map_err(|error| Fault::at(&place, format!("{flag}: {}", plan_reason(error)), "this time"))
}

fn with_size_from(plan: &StepPlan, from: f64, size: f64) -> Result<StepPlan, Fault> {
    plan.with_size_from(from, size).map_err(|error| {
        let flag = format!("--step {}", spelled(size));
        let place = Place::start_of("--step", &flag).at("--step ".len()..flag.len());
        Fault::at(&place, format!("{flag}: {}", plan_reason(error)), "this size")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plans_are_cut_and_extended() {
        let phase = |until, size| Phase { until, size };
        let plan = StepPlan::new(0.0, vec![phase(1.0, 0.1), phase(4.0, 0.5)]).unwrap();
        let phases = |until| cut_or_extended(&plan, until).map(|plan| plan.phases().to_vec());
        assert_eq!(phases(0.25).unwrap(), [phase(0.25, 0.1)]);
        assert_eq!(phases(1.0).unwrap(), [phase(1.0, 0.1)]);
        assert_eq!(phases(2.0).unwrap(), [phase(1.0, 0.1), phase(2.0, 0.5)]);
        assert_eq!(phases(9.0).unwrap(), [phase(1.0, 0.1), phase(9.0, 0.5)]);
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(phases(bad).unwrap_err().message().contains("--until"), "{bad}");
        }
        let message = phases(1e300).unwrap_err().message().to_string();
        assert!(message.contains("--until 1e300: steps of 0.5 until 1e300 are more"), "{message}");
    }

    #[test]
    fn schemes_that_were_meant_are_found() {
        for (text, scheme) in [
            ("as5", "AS(5)"),
            ("dgm", "DGM"),
            ("Mid-Point", "FE(1)"),
            ("lobatto (3)", "Lobatto(3)"),
            ("DMG", "DGM"),
            ("AS(5,)", "AS(5)"),
            ("HTT(0.1)", "HHT(0.1)"),
            ("DGM(0.5", "DGM(0.5)"),
            ("generalised-alpha(0.5)", "generalized-alpha(0.5)"),
            ("newmrk(0.3, 0.6)", "Newmark(0.3, 0.6)"),
        ] {
            assert_eq!(meant(text), format!("did you mean \"{scheme}\"?"));
            Scheme::from_name(scheme).unwrap();
        }
        // No numbers are invented.
        for (text, form) in [
            ("AS(5.5)", "AS(n) or AS(n,rho)"),
            ("AS(-1)", "AS(n) or AS(n,rho)"),
            ("AS", "AS(n) or AS(n,rho)"),
            ("newmrk", "Newmark(beta,gamma)"),
            ("generalised-alpha(2)", "generalized-alpha(rho)"),
            ("trapezoidal(1)", "trapezoidal"),
        ] {
            assert_eq!(meant(text), format!("did you mean the form {form}?"));
        }
        assert_eq!(meant("leapfrog"), "not a scheme");
    }
}
