//! `[[contact]]`: surfaces that meet obstacles.

use emmy::body::{Contact, LayerLaw, Obstacle};

use super::description::{Described, Kind, POSITIVE, Section, TAKEN, vector, word};
use super::fault::{Fault, Place};
use super::table::{Item, Table};

/// The word for the whole boundary.
const ALL: &str = "all";

/// `[[contact]]`.
pub(super) static CONTACT: Described = Described::new(|| {
    Section::new("[[contact]]", "A surface that meets an obstacle: a thin layer on it stores energy where it comes near")
        .must(
            "surfaces",
            Kind::Text,
            "",
            "Group of facets, or of cells, whose facets on the boundary are meant; `\"all\"`: the whole boundary",
        )
        .must("obstacle", Kind::Table(&OBSTACLE), "", "The obstacle, at rest")
        .may(
            "name",
            Kind::Column(&TAKEN),
            "",
            "Name of its forces in the history: letters, digits, `_` and `-`",
        )
        .absent("`contact-1`, `contact-2`, ... by its place")
        .may("stiffness", POSITIVE, "stress", "Modulus of the layer")
        .absent("the smallest Young's modulus of the cells at the surface")
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
    Section::new("obstacle", "Exactly one shape")
        .may("plane", Kind::Table(&PLANE), "", "A half-space")
        .may("sphere", Kind::Table(&SPHERE), "", "A sphere")
        .may("cylinder", Kind::Table(&CYLINDER), "", "A cylinder without ends")
        .exactly_one(&["plane", "sphere", "cylinder"])
});

static PLANE: Described =
    Described::new(|| {
        Section::new("plane", "A half-space")
            .must("point", vector(), "length", "A point of its surface")
            .must("normal", vector(), "", "Direction out of it, towards the body, of any length")
    });

/// The meaning of `inside`.
const INSIDE: &str = "The body is inside";

static SPHERE: Described = Described::new(|| {
    Section::new("sphere", "A sphere")
        .must("centre", vector(), "length", "Its centre")
        .must("radius", POSITIVE, "length", "Its radius")
        .may("inside", Kind::True, "", INSIDE)
        .absent("outside")
});

static CYLINDER: Described = Described::new(|| {
    Section::new("cylinder", "A cylinder without ends")
        .must("point", vector(), "length", "A point of its axis")
        .must("axis", vector(), "", "Direction of its axis, of any length")
        .must("radius", POSITIVE, "length", "Its radius")
        .may("inside", Kind::True, "", INSIDE)
        .absent("outside")
});

/// A contact with the places of its table and of the name of its surface.
#[derive(Debug)]
pub(super) struct PlacedContact {
    pub(super) contact: Contact,
    place: Place,
    surface: Place,
}

/// Reads one contact.
pub(super) fn read(table: &Table<'_>) -> PlacedContact {
    let surface: Item<'_> = table.must("surfaces");
    let obstacle = obstacle(&table.must("obstacle"));
    let contact = match surface.name() {
        name if name == ALL => Contact::of_all_with_obstacle(obstacle),
        name => Contact::with_obstacle(name, obstacle),
    };
    let law = match table.must::<Item<'_>>("law").text() {
        Some("linear") => LayerLaw::Linear,
        _ => LayerLaw::Smooth,
    };
    let contact = Contact {
        name: table.item("name").map(|name| name.name()),
        stiffness: table.may("stiffness"),
        distance: table.may("distance"),
        law,
        ..contact
    };
    PlacedContact { contact, place: table.place.clone(), surface: surface.place().clone() }
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
    /// The group of its surface with the place of the name; `None`: the whole boundary.
    pub(super) fn group(&self) -> Option<(String, Place)> {
        Some((self.contact.surface.clone()?, self.surface.clone()))
    }

    /// The fault of a contact on several ranks.
    pub(super) fn not_on_ranks(&self) -> Fault {
        Fault::at(&self.place, "several ranks do not compute a body with contact", "this contact")
    }
}

/// The fault of an impossible contact.
pub(super) fn fault(error: &emmy::Error, placed: &[(String, Place)]) -> Option<Fault> {
    let emmy::Error::Contact { contact, .. } = error else { return None };
    let (_, place) = placed.iter().find(|(name, _)| name == contact)?;
    Some(Fault::at(place, error.to_string(), "this contact"))
}

/// The names of some contacts with the places of their tables.
pub(super) fn places(contacts: &[PlacedContact]) -> Vec<(String, Place)> {
    let named = contacts.iter().enumerate();
    named.map(|(number, own)| (own.contact.name(number), own.place.clone())).collect()
}
