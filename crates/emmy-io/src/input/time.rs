//! `[time]`: scheme with its degree, and step plan; `--until`.

use emmy::body::Body;
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
    let is_number = |number: &str| number.trim_end_matches(')').trim().parse::<f64>().is_ok();
    let are_wrong = |name: &str, numbers: &str| {
        FAMILIES.contains(&name) && numbers.contains(',') && numbers.split(',').all(is_number)
    };
    let label = match (text.split_once('('), meant(text)) {
        // Only the numbers are wrong.
        (Some((name, numbers)), _) if are_wrong(name, numbers) => "this scheme".to_string(),
        (_, Some(word)) => format!("did you mean \"{word}\"?"),
        _ => "not a scheme".to_string(),
    };
    Some((Fault::new(error.to_string()).help("`emmy list schemes` explains them"), label))
}

/// Names of schemes with numbers in brackets.
const FAMILIES: [&str; 7] = ["FE", "AS", "DGM", "Lobatto", "Newmark", "HHT", "generalized-alpha"];

/// Words of schemes, as [`meant`] sees them.
const WORDS: [&str; 10] = [
    "fe",
    "as",
    "dgm",
    "trapezoidal",
    "lobatto",
    "newmark",
    "hht",
    "generalizedalpha",
    "bathe",
    "centraldifferences",
];

/// The scheme meant by a text in another case, without brackets, or with another name.
fn meant(text: &str) -> Option<String> {
    let plain: String = text.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    let word = plain.trim_end_matches(|c: char| c.is_ascii_digit());
    let points = match &plain[word.len()..] {
        "" | "0" => "1",
        digits => digits,
    };
    let word = nearest(word, WORDS).unwrap_or(word);
    let scheme = match word {
        "dgm" | "dg" | "discretegradient" | "energymomentum" => "DGM".to_string(),
        "midpoint" | "implicitmidpoint" => "FE(1)".to_string(),
        "simotarnow" => "AS(1)".to_string(),
        "trapezoid" | "trapezoidal" | "averageacceleration" => "trapezoidal".to_string(),
        "newmark" => "Newmark(0.25, 0.5)".to_string(),
        "hht" => "HHT(0.05)".to_string(),
        "generalizedalpha" => "generalized-alpha(0.8)".to_string(),
        "bathe" => "Bathe".to_string(),
        "centraldifference" | "centraldifferences" => "central-differences".to_string(),
        "fe" | "cg" => format!("FE({points})"),
        "as" => format!("AS({points})"),
        "lobatto" => format!("Lobatto({})", if points == "1" { "2" } else { points }),
        _ => return None,
    };
    Some(scheme)
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
        for (text, scheme) in
            [("as5", "AS(5)"), ("dgm", "DGM"), ("Mid-Point", "FE(1)"), ("lobatto (3)", "Lobatto(3)")]
                .into_iter()
                .chain([("DMG", "DGM"), ("newmrk", "Newmark(0.25, 0.5)"), ("HTT(0.1)", "HHT(0.05)")])
        {
            assert_eq!(meant(text).as_deref(), Some(scheme));
            Scheme::from_name(scheme).unwrap();
        }
        assert_eq!(meant("leapfrog"), None);
    }
}
