//! `time.adaptive`: steps chosen by their error.

use emmy::internals::time::ESTIMATORS;
use emmy::motion::{Adaptivity, StepPlan};
use emmy::time::{MAX_DEGREE, Scheme};

use super::description::{BELOW_ONE, Described, Kind, POSITIVE, Section, whole};
use super::fault::{Fault, Place};
use super::table::{Item, Table, spelled};

/// `time.adaptive`.
pub(super) static ADAPTIVE: Described = Described::new(|| {
    Section::new("`adaptive`", "Steps whose sizes are chosen by the error, in place of `steps`")
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
            Kind::Word(ESTIMATORS.map(|(name, ..)| name).to_vec()),
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
        let message =
            format!("`adaptive` goes up to degree {}: its error is that over the next one", MAX_DEGREE - 1);
        return Err(degree_item.fault(message, "too high"));
    }
    let table = adaptive.table(&ADAPTIVE)?;
    let adaptivity = read(&table)?;
    let checked = adaptivity.check().and_then(|()| adaptivity.check_degree(element));
    if let Err(emmy::Error::Adaptivity { setting, reason }) = checked {
        let item = table.require(setting)?;
        return Err(item.fault(format!("`{setting}` {reason}"), "here"));
    }
    let (end, place) = match until {
        Some(until) => flag(until),
        None => {
            let item = time.require("until")?;
            (item.number()?, item.place().clone())
        }
    };
    let plan = StepPlan::adaptive(0.0, end, adaptivity);
    plan.map_err(|_| {
        let message = format!(
            "the run must end after t = 0 and within 1e12 steps of `max_size`, not at {}",
            spelled(end)
        );
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
    let beside = |key: &str, message: &str, help: &str| match time.get(key) {
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
    let positive = |key: &str| table.get(key).map(|item| item.positive()).transpose();
    let adaptivity = Adaptivity::new(table.require("tolerance")?.number()?);
    let estimators = ESTIMATORS.map(|(name, estimator, _)| (name, estimator));
    Ok(Adaptivity {
        smallest: positive("min_size")?.unwrap_or(adaptivity.smallest),
        largest: positive("max_size")?.unwrap_or(adaptivity.largest),
        first: positive("first_size")?,
        length: positive("length")?,
        velocity: positive("velocity")?,
        degrees: degrees(table)?,
        estimator: table.get("estimator").map(|item| item.one_of("an estimator", &estimators)).transpose()?,
        ..adaptivity
    })
}

/// The degrees to choose from, if there are several.
fn degrees(table: &Table<'_>) -> Result<Option<[usize; 2]>, Fault> {
    let lowest = table.get("min_degree").map(|item| item.whole(1)).transpose()?;
    if lowest.is_none() && table.get("max_degree").is_none() {
        return Ok(None);
    }
    Ok(Some([lowest.unwrap_or(1), table.require("max_degree")?.whole(1)?]))
}

/// Checks the table alone.
pub(super) fn check(item: &Item<'_>) -> Result<(), Fault> {
    let adaptivity = read(&item.table(&ADAPTIVE)?)?;
    adaptivity.check().map_err(|error| item.fault(error.to_string(), "here"))
}

/// `until` without `adaptive`.
pub(super) fn check_until(time: &Table<'_>) -> Result<(), Fault> {
    match time.get("until") {
        Some(item) => {
            let fault = Fault::at(item.key_place, "`until` of [time] needs `adaptive`", "not here");
            Err(fault.help("every phase of `steps` has its own `until`"))
        }
        None => Ok(()),
    }
}
