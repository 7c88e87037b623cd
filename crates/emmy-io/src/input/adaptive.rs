//! `time.adaptive`: steps chosen by their error.

use emmy::internals::time::ESTIMATORS;
use emmy::motion::{Adaptivity, StepPlan};
use emmy::time::{MAX_DEGREE, Scheme};

use super::description::{BELOW_ONE, Described, POSITIVE, Section, whole, word};
use super::fault::{Fault, Place};
use super::table::{Item, Table, spelled};

/// `time.adaptive`.
pub(super) static ADAPTIVE: Described = Described::new(|| {
    Section::new("adaptive", "Steps whose sizes are chosen by the error, in place of `steps`")
        .must("tolerance", BELOW_ONE, "", "Largest error of a step, relative to the scales")
        .may("min_size", POSITIVE, "time", "Smallest step; one that is too inaccurate even then ends the run")
        .may("max_size", POSITIVE, "time", "Largest step")
        .may("first_size", POSITIVE, "time", "First step")
        .absent("chosen from velocity and acceleration")
        .may("length", POSITIVE, "length", "Scale of the errors of positions")
        .absent("the radius of gyration of the lumped masses")
        .may("velocity", POSITIVE, "length/time", "Scale of the errors of velocities")
        .absent("errors of velocities do not count")
        .may(
            "estimator",
            word("an estimator", ESTIMATORS.map(|(name, ..)| name)),
            "",
            "Estimator of the error; `emmy list estimators` explains them",
        )
        .absent("`difference` for degree 1 without dissipation, else `sampled`")
        .may("min_degree", whole(1), "", "Lowest degree of the automatic choice, which minimises the work")
        .absent("1")
        .may("max_degree", whole(1), "", "Highest degree to choose from; `degree` is the first one")
        .absent("`degree` stays")
});

/// The plan of a `[time]` with `adaptive` instead of `steps`; `until` is the end given on the command line.
pub(super) fn plan(
    time: &Table<'_>,
    adaptive: &Item<'_>,
    scheme: Scheme,
    (scheme_item, degree_item): (&Item<'_>, &Item<'_>),
    until: Option<f64>,
) -> Result<StepPlan, Fault> {
    check_beside(time, adaptive)?;
    let Scheme::TimeElement(element) = scheme else {
        let fault = scheme_item.fault("`adaptive` needs a time element", "not a time element");
        return Err(fault.help("`emmy list schemes` explains them"));
    };
    if element.degree >= MAX_DEGREE {
        let message = format!(
            "`adaptive` allows degrees up to {}: the next degree estimates the error",
            MAX_DEGREE - 1
        );
        return Err(degree_item.fault(message, "too high"));
    }
    let table: Table<'_> = time.must("adaptive");
    let adaptivity = read(&table)?;
    let checked = adaptivity.check().and_then(|()| adaptivity.check_degree(element));
    if let Err(emmy::Error::Adaptivity { setting, reason }) = checked {
        let place = table.item(setting).map_or(table.place, |item| item.place());
        return Err(Fault::at(place, format!("`{setting}` {reason}"), "here"));
    }
    let (end, place) = match (until, time.item("until")) {
        (Some(until), _) => flag(until),
        (None, Some(item)) => (time.must("until"), item.place().clone()),
        (None, None) => {
            return Err(Fault::at(
                time.place,
                "`until` is missing in [time]: adaptive steps need an end",
                "needs `until`",
            ));
        }
    };
    let plan = StepPlan::adaptive(0.0, end, adaptivity);
    plan.map_err(|_| {
        let message = match end > 0.0 {
            true => format!("the run must end within 1e12 steps of `max_size`, not at {}", spelled(end)),
            false => format!("`until` must be after the start, t = 0, not {}", spelled(end)),
        };
        Fault::at(&place, message, "this end")
    })
}

/// The end on the command line, and its place.
fn flag(until: f64) -> (f64, Place) {
    let flag = format!("--until {}", spelled(until));
    (until, Place::start_of("--until", &flag).at("--until ".len()..flag.len()))
}

/// Checks that no key is given that it replaces.
fn check_beside(time: &Table<'_>, adaptive: &Item<'_>) -> Result<(), Fault> {
    let beside = |key: &str, message: &str, help: &str| match time.item(key) {
        Some(item) => {
            let fault = Fault::at(item.key_place, message, "this one");
            Err(fault.label(adaptive.key_place, "and this one").help(help.to_string()))
        }
        None => Ok(()),
    };
    beside(
        "steps",
        "`adaptive` replaces `steps`: give one of them",
        "the end of adaptive steps is `until = T`; remove `steps`, on the command line with `--set time.steps=`",
    )?;
    beside(
        "smallest_step",
        "`smallest_step` needs `steps`",
        "the smallest adaptive step is `adaptive.min_size`",
    )
}

fn read(table: &Table<'_>) -> Result<Adaptivity, Fault> {
    let adaptivity = Adaptivity::new(table.must("tolerance"));
    let estimators = ESTIMATORS.map(|(name, estimator, _)| (name, estimator));
    Ok(Adaptivity {
        smallest: table.may("min_size").unwrap_or(adaptivity.smallest),
        largest: table.may("max_size").unwrap_or(adaptivity.largest),
        first: table.may("first_size"),
        length: table.may("length"),
        velocity: table.may("velocity"),
        degrees: degrees(table)?,
        estimator: table.item("estimator").map(|item| item.one_of(estimators)),
        ..adaptivity
    })
}

/// The degrees to choose from, if there are several.
fn degrees(table: &Table<'_>) -> Result<Option<[usize; 2]>, Fault> {
    match (table.may("min_degree"), table.may("max_degree")) {
        (None, None) => Ok(None),
        (lowest, Some(highest)) => Ok(Some([lowest.unwrap_or(1), highest])),
        (Some(_), None) => {
            let message =
                "`max_degree` is missing in `adaptive`: with `min_degree` alone there is nothing to choose";
            Err(Fault::at(table.place, message, "needs `max_degree`"))
        }
    }
}

/// Checks the table alone.
pub(super) fn check(table: &Table<'_>) -> Result<(), Fault> {
    read(table)?.check().map_err(|error| Fault::at(table.place, error.to_string(), "here"))
}

/// `until` without `adaptive`.
pub(super) fn check_until(time: &Table<'_>) -> Result<(), Fault> {
    match time.item("until") {
        Some(item) => {
            let fault = Fault::at(item.key_place, "`until` of [time] needs `adaptive`", "not here");
            Err(fault.help("every phase of `steps` has its own `until`"))
        }
        None => Ok(()),
    }
}
