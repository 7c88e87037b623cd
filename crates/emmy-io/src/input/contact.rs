//! `[[contact]]`: surfaces that meet obstacles, or each other.

use emmy::body::{Body, Contact, ContactSummary, LayerLaw, Obstacle, Opponent, TimeFunction};
use emmy::time::BodyFeature;

use super::context::Context;
use super::description::{Described, Kind, POSITIVE, Section, TAKEN, either, exactly, vector, word};
use super::fault::{Fault, Faults, Place};
use super::support;
use super::table::{Item, Table};
use super::time::Time;
use crate::units::Units;

/// Part of the remark that the layer of a contact pushes in the undeformed body, which concerns a motion from there.
pub const PUSHES: &str = "pushes from the start, where its layer stores the energy";

/// The word for the whole boundary.
const ALL: &str = "all";

/// `[[contact]]`.
pub(super) static CONTACT: Described = Described::new(|| {
    Section::new("[[contact]]", "Surfaces that meet: a thin layer on them stores energy where something comes near")
        .must(
            "surfaces",
            either(Kind::Text, exactly(2, Kind::Text)),
            "",
            "With an `obstacle` one group of facets, or of cells, whose facets on the boundary are meant, or `\"all\"` for \
             the whole boundary; two groups that meet each other; or `\"all\"` alone: all bodies that are not connected \
             meet each other",
        )
        .may("obstacle", Kind::Table(&OBSTACLE), "", "The obstacle")
        .absent("two surfaces, or all bodies")
        .may(
            "name",
            Kind::Column(&TAKEN),
            "",
            "Name of its forces in the history: letters, digits, `_` and `-`",
        )
        .absent("`contact-1`, `contact-2`, ... by its place")
        .may("stiffness", POSITIVE, "stress", "Modulus of the layer")
        .absent("the smallest Young's modulus of the cells at the surfaces")
        .may("distance", POSITIVE, "length", "Thickness of the layer: nearer than this, it pushes")
        .absent("a tenth of the median edge of the facets, at most half of the smallest gap at the start")
        .may(
            "law",
            word("a law", ["smooth", "linear"]),
            "",
            "`smooth`: the pressure sets in softly, few corrections; `linear`: it sets in as that of an elastic layer, for slow \
             impacts",
        )
        .default("\"smooth\"")
});

/// `obstacle`.
static OBSTACLE: Described = Described::new(|| {
    Section::new("obstacle", "Exactly one shape, which may move")
        .may("plane", Kind::Table(&PLANE), "", "A half-space")
        .may("sphere", Kind::Table(&SPHERE), "", "A sphere")
        .may("cylinder", Kind::Table(&CYLINDER), "", "A cylinder without ends")
        .may(
            "move",
            Kind::Table(&support::MOVE),
            "",
            "Displacement of components over time, such as `{ z = \"-0.1*t\" }`",
        )
        .absent("the obstacle is at rest")
        .exactly_one(&["plane", "sphere", "cylinder"])
});

static PLANE: Described = Described::new(|| {
    Section::new("obstacle.plane", "A half-space")
        .must("point", vector(), "length", "A point of its surface")
        .must("normal", vector(), "", "Direction out of it, towards the body, of any length")
});

/// The meaning of `inside`.
const INSIDE: &str = "The body is inside";

static SPHERE: Described = Described::new(|| {
    Section::new("obstacle.sphere", "A sphere")
        .must("centre", vector(), "length", "Its centre")
        .must("radius", POSITIVE, "length", "Its radius")
        .may("inside", Kind::True, "", INSIDE)
        .absent("outside")
});

static CYLINDER: Described = Described::new(|| {
    Section::new("obstacle.cylinder", "A cylinder without ends")
        .must("point", vector(), "length", "A point of its axis")
        .must("axis", vector(), "", "Direction of its axis, of any length")
        .must("radius", POSITIVE, "length", "Its radius")
        .may("inside", Kind::True, "", INSIDE)
        .absent("outside")
});

/// A contact with the places of its table, of its keys and of the names of its surfaces.
#[derive(Debug)]
pub(super) struct PlacedContact {
    pub(super) contact: Contact,
    place: Place,
    /// The keys of its table, and of the tables in it.
    keys: Vec<(String, Place)>,
    groups: Vec<(String, Place)>,
    /// Where the obstacle is moved.
    moved: Option<Place>,
}

/// Reads one contact.
///
/// # Errors
/// The fault of surfaces that do not go together.
pub(super) fn read(
    table: &Table<'_>,
    context: Context<'_>,
    faults: &mut Faults,
) -> Result<PlacedContact, Fault> {
    let surfaces: Item<'_> = table.must("surfaces");
    let surfaces = surfaces.of_one_kind().unwrap_or(surfaces);
    let groups: Vec<(String, Place)> =
        surfaces.items().iter().map(|item| (item.name(), item.place().clone())).collect();
    let obstacle_table: Option<Table<'_>> = table.may("obstacle");
    let obstacle = obstacle_table.as_ref().map(obstacle);
    let (motion, moved) =
        obstacle_table.as_ref().map(|table| motion(table, context, faults)).unwrap_or_default();
    let named = |(name, _): &(String, Place)| Some(name.clone()).filter(|name| name != ALL);
    let (surface, opponent) = match (&groups[..], obstacle) {
        ([_, other], Some(_)) => {
            let message = "contact with an obstacle has one surface";
            let help = format!("surfaces = {:?}; give each surface a [[contact]] of its own", groups[0].0);
            return Err(Fault::at(&other.1, message, "this is another one").help(help));
        }
        ([own, other], None) if own.0 == other.0 => {
            let message = "contact of a body with itself is not there yet";
            let help = "name two bodies, two surfaces of one body that share no node, or `\"all\"` for all bodies \
                        with each other";
            return Err(Fault::at(&other.1, message, "the same surface").help(help));
        }
        ([own, other], None) => match [named(own), named(other)] {
            [Some(own), Some(other)] => (Some(own), Opponent::Surface(other)),
            _ => {
                let message = "`\"all\"` is all bodies with each other, and stands alone";
                return Err(Fault::at(surfaces.place(), message, "two surfaces").help("surfaces = \"all\""));
            }
        },
        (own, Some(obstacle)) => (own.first().and_then(named), Opponent::Obstacle(obstacle)),
        (own, None) => (own.first().and_then(named), Opponent::Bodies),
    };
    let contact = Contact::new(surface, opponent);
    let law = match table.must::<Item<'_>>("law").text() {
        Some("linear") => LayerLaw::Linear,
        _ => LayerLaw::Smooth,
    };
    let contact = Contact {
        name: table.item("name").map(|name| name.name()),
        stiffness: table.may("stiffness"),
        distance: table.may("distance"),
        law,
        motion,
        ..contact
    };
    let groups = groups.into_iter().filter(|(name, _)| name != ALL).collect();
    Ok(PlacedContact { contact, place: table.place.clone(), keys: keys_of(table), groups, moved })
}

/// The keys of a table and of the tables in it, each with the place of its value, or of the key of a table.
fn keys_of(table: &Table<'_>) -> Vec<(String, Place)> {
    let of_key = |item: Item<'_>| {
        let own = item.table();
        let place = if own.is_some() { item.key_place } else { item.place() };
        let inner = own.as_ref().map(keys_of).unwrap_or_default();
        std::iter::once((item.key.to_string(), place.clone())).chain(inner)
    };
    table.items().flat_map(of_key).collect()
}

/// Checks that the scheme permits obstacles that move.
///
/// # Errors
/// The fault of the first that it does not permit.
pub(super) fn check_scheme(contacts: &[PlacedContact], time: &Time) -> Result<(), Fault> {
    let Some(place) = contacts.iter().find_map(|own| own.moved.as_ref()) else { return Ok(()) };
    if time.scheme.check_feature(BodyFeature::PrescribedMotion).is_ok() {
        return Ok(());
    }
    Err(support::cannot_move(time, ("an obstacle", place)))
}

/// The motion of an obstacle, and its place.
pub(super) fn motion(
    table: &Table<'_>,
    context: Context<'_>,
    faults: &mut Faults,
) -> ([Option<TimeFunction>; 3], Option<Place>) {
    match table.may::<Table<'_>>("move") {
        Some(components) => {
            (support::moved_components(&components, context, faults), Some(components.place.clone()))
        }
        None => Default::default(),
    }
}

fn obstacle(table: &Table<'_>) -> Obstacle {
    if let Some(plane) = table.may::<Table<'_>>("plane") {
        return Obstacle::Plane { point: plane.must("point"), normal: plane.must("normal") };
    }
    if let Some(sphere) = table.may::<Table<'_>>("sphere") {
        let (centre, radius) = (sphere.must("centre"), sphere.must("radius"));
        return Obstacle::Sphere { centre, radius, inside: sphere.item("inside").is_some() };
    }
    let cylinder: Table<'_> = table.must("cylinder");
    let (point, axis) = (cylinder.must("point"), cylinder.must("axis"));
    let (radius, inside) = (cylinder.must("radius"), cylinder.item("inside").is_some());
    Obstacle::Cylinder { point, axis, radius, inside }
}

impl PlacedContact {
    /// The groups of its surfaces with the places of their names; none for the whole boundary.
    pub(super) fn groups(&self) -> impl Iterator<Item = (String, Place)> {
        self.groups.iter().cloned()
    }

    /// The fault of a contact on several ranks.
    pub(super) fn not_on_ranks(&self) -> Fault {
        Fault::at(&self.place, "several ranks do not compute a body with contact", "this contact")
    }
}

/// Notes on layers between bodies that are thicker than their facets are wide, and on those that push from the start of
/// a motion that `starts_as_drawn`, in the reference configuration.
pub(super) fn notes(body: &Body, starts_as_drawn: bool, units: Units) -> Vec<String> {
    let notes = |own: &ContactSummary| {
        let name = &own.name;
        let distance = units.number(own.distance, "length");
        let width = (own.area / own.n_facets as f64).sqrt();
        let thick = (own.n_triangles > 0 && own.distance > width).then(|| {
            format!(
                "contact `{name}`: its layer is thicker (`distance` {distance}) than its facets are wide ({}), so that \
                 each of them meets many others, and steps take long; the default is a tenth of an edge",
                units.number(width, "length")
            )
        });
        let pushes = (starts_as_drawn && own.energy > 0.0).then(|| {
            format!(
                "contact `{name}` {PUSHES} {} (smallest gap {}, \
                 `distance` {distance}): leave a larger gap, take a smaller `distance`, or begin with `[equilibrium]`",
                units.number(own.energy, "energy"),
                units.number(own.smallest_gap, "length")
            )
        });
        [thick, pushes]
    };
    body.contacts().flat_map(notes).flatten().collect()
}

/// The places of a contact by its name: of its table, and of its keys.
pub(super) type ContactPlaces = (String, Place, Vec<(String, Place)>);

/// The fault of an impossible contact, at the key that is wrong, as far as it is given. Several have one name only if
/// this is the fault.
pub(super) fn fault(error: &emmy::Error, placed: &[ContactPlaces]) -> Option<Fault> {
    let emmy::Error::Contact { contact, key, .. } = error else { return None };
    let mut own = placed.iter().filter(|(name, ..)| name == contact).map(|(_, table, keys)| {
        let place = keys.iter().find(|(own, _)| own == key).map(|(_, place)| place);
        let label = match (place, *key) {
            (None, _) => "this contact".to_string(),
            (_, "surfaces") => "these surfaces".to_string(),
            (_, key) => format!("this {key}"),
        };
        (place.unwrap_or(table), label)
    });
    let (place, label) = own.next()?;
    let fault = Fault::at(place, error.to_string(), label);
    Some(own.fold(fault, |fault, (place, label)| fault.label(place, format!("and {label}"))))
}

/// The names of some contacts with their places.
pub(super) fn places(contacts: &[PlacedContact]) -> Vec<ContactPlaces> {
    let of = |(number, own): (usize, &PlacedContact)| {
        (own.contact.name(number), own.place.clone(), own.keys.clone())
    };
    contacts.iter().enumerate().map(of).collect()
}
