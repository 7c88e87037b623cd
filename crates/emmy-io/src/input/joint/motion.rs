//! Drives, springs, dampers and motors of a joint.

use emmy::body::{JointKind, JointSpring, TimeFunction};
use emmy::internals::number::short;

use super::{size, with_article};
use crate::input::context::Context;
use crate::input::description::Kind;
use crate::input::fault::Fault;
use crate::input::history;
use crate::input::table::{Item, Read, Table};

/// The forces in the coordinate of a joint.
#[derive(Debug, Default)]
pub(in crate::input) struct Forces {
    pub(in crate::input) spring: Option<JointSpring>,
    pub(super) damping: f64,
    pub(in crate::input) motor: Option<TimeFunction>,
}

/// Difference of a given length from that of the drawing, relative to it, that is rounding in the input.
const SAME_LENGTH: f64 = 1e-6;

/// The given motion of a joint: of its angle, its slide or its length.
pub(super) fn drive(
    table: &Table<'_>,
    own: &Table<'_>,
    (name, kind, at): (&str, JointKind, [f64; 3]),
    context: Context<'_>,
) -> Result<Option<TimeFunction>, Fault> {
    let taken = kind.coordinate();
    let [takes, others] = [true, false].map(|is| {
        ["angle", "slide"].into_iter().find(|key| table.item(key).is_some() && (taken == Some(*key)) == is)
    });
    if let Some(item) = others.and_then(|key| table.item(key)) {
        let (kind, key) = (with_article(kind), item.key);
        let message = format!("joint `{name}`: {kind} joint has no `{key}` to be given");
        let fault = item.fault(message, format!("not of {kind} joint"));
        return Err(fault.help(match key {
            "angle" => "revolute and cylindrical joints take `angle`",
            _ => "prismatic joints take `slide`",
        }));
    }
    if let Some(item) = takes.and_then(|key| table.item(key)) {
        return from_rest(&item, name, context).map(Some);
    }
    let JointKind::Distance { to } = kind else { return Ok(None) };
    let Some(item) = own.item("length").and_then(Item::of_one_kind) else { return Ok(None) };
    let drawn = size([0, 1, 2].map(|i| at[i] - to[i]));
    if matches!(item.kind, Kind::Number(_)) {
        let length: f64 = Read::read(item);
        if (length - drawn).abs() <= SAME_LENGTH * drawn {
            return Ok(None);
        }
        let [length, drawn] = [length, drawn].map(short);
        let message = format!(
            "joint `{name}`: the points are {drawn} apart, `length` says {length}; leave it out to take {drawn}"
        );
        return Err(item.fault(message, format!("not {drawn}")));
    }
    let length = history::without_jumps(item, context)?;
    let start = length.value(0.0);
    if context.is_undeformed && (start - drawn).abs() > SAME_LENGTH * drawn {
        let [start, drawn] = [start, drawn].map(short);
        let message = format!(
            "the drive of `{name}` starts at a length of {start}; joints start as drawn, here at {drawn}"
        );
        return Err(item.fault(message, "not as drawn"));
    }
    // Exactly zero at the start, also where the input has rounded the length.
    let drawn = if context.is_undeformed { start } else { drawn };
    less(&length, drawn).map(Some).map_err(|error| item.fault(error.to_string(), "here"))
}

/// Spring, damping and motor of a joint.
pub(super) fn forces(
    table: &Table<'_>,
    chosen: Item<'_>,
    (name, kind, is_driven): (&str, JointKind, bool),
    context: Context<'_>,
) -> Result<Forces, Fault> {
    let (of_kind, coordinate) = (with_article(kind), kind.coordinate());
    let is_line = matches!(kind, JointKind::Line { .. });
    let given = ["spring", "damping", "torque", "force"].into_iter().filter_map(|key| table.item(key));
    let given: Vec<Item<'_>> = given.collect();
    for item in &given {
        let key = item.key;
        let fault =
            |message: String, label: &str| Err(item.fault(format!("joint `{name}`: {message}"), label));
        let is_angle = coordinate == Some("angle");
        match (kind, coordinate) {
            (JointKind::Distance { .. }, _) => {
                let message = format!("a distance is rigid and leaves `{key}` nothing to do; take a `line`");
                return fault(message, "without effect");
            }
            (_, None) => {
                return fault(format!("{of_kind} joint has no angle or slide for `{key}`"), "not here");
            }
            _ if key == "torque" && !is_angle => {
                return fault(
                    format!("{of_kind} has no angle for a `torque`; give a `force`"),
                    "not an angle",
                );
            }
            _ if key == "force" && is_angle => {
                return fault(format!("{of_kind} joint turns under a `torque`, not a `force`"), "a torque");
            }
            _ if is_driven => {
                let drive = coordinate.unwrap_or_default();
                let message = format!("give either `{drive}` or `{key}`: the drive leaves it nothing to do");
                return fault(message, "without effect");
            }
            _ => {}
        }
    }
    if is_line && given.is_empty() {
        let message =
            format!("joint `{name}`: a line has no constraint; give it `spring`, `damping` or `force`");
        return Err(Fault::at(chosen.key_place, message, "without effect"));
    }
    let motor = ["torque", "force"].into_iter().find_map(|key| table.item(key));
    let spring = table.may("spring");
    Ok(Forces {
        spring: spring
            .map(|own: Table<'_>| JointSpring { stiffness: own.must("stiffness"), rest: own.may("rest") }),
        damping: table.may("damping").unwrap_or(0.0),
        motor: motor.map(|item| history::read(item, context)).transpose()?,
    })
}

/// A drive that starts as drawn.
fn from_rest(item: &Item<'_>, name: &str, context: Context<'_>) -> Result<TimeFunction, Fault> {
    let drive = history::without_jumps(*item, context)?;
    let start = drive.value(0.0);
    if context.is_undeformed && start.abs() > history::ROUNDING {
        let unit = if item.key == "angle" { " rad" } else { "" };
        let message =
            format!("the drive of `{name}` starts at {}{unit}; joints start as drawn, at 0", short(start));
        return Err(item.fault(message, "not 0 at the start"));
    }
    Ok(drive)
}

/// A time function less a number.
fn less(function: &TimeFunction, number: f64) -> emmy::Result<TimeFunction> {
    let entries = function.entries();
    if !entries.is_empty() {
        let entries = entries.iter().map(|&(time, value)| (time, value - number)).collect();
        return if function.is_measured() {
            TimeFunction::measured(entries)
        } else {
            TimeFunction::new(entries)
        };
    }
    let text = format!("{} - {number:?}", function.text().unwrap_or_default());
    let own = function.clone();
    let less = match function.has_rate() {
        true => TimeFunction::smooth(&text, move |time| [own.value(time) - number, own.rate(time), f64::NAN]),
        false => TimeFunction::of_times(&text, move |times, values| {
            values.iter_mut().zip(times).for_each(|(value, time)| *value = own.value(*time) - number);
        }),
    };
    Ok(less.with_kinks(function.kinks()))
}
