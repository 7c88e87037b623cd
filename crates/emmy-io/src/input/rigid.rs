//! `[[rigid]]`: rigid bodies by their mass, centre and inertia, point masses, and groups of a mesh that move as one.

use emmy::body::RigidBody;
use emmy::internals::material::Bounds;
use emmy::internals::number::short;

use super::description::{Described, Kind, POSITIVE, Section, TAKEN, either, exactly, vector};
use super::fault::{Fault, Place};
use super::placed::Members;
use super::placed::NamedGroup;
use super::table::{Item, Read, Table};

/// The name of the ground in joints.
pub(super) const GROUND: &str = "ground";

/// `[[rigid]]`.
pub(super) static RIGID: Described = Described::new(|| {
    let moments = exactly(3, Kind::Number(Bounds::AtLeast(0.0)));
    Section::new(
        "[[rigid]]",
        "A rigid body by its mass, a point mass, or a group of the mesh that moves as one",
    )
    .must(
        "name",
        Kind::Column(&TAKEN),
        "",
        "Its name in joints and as a group, of one node, its centre: letters, digits, `_` and `-`",
    )
    .may("group", Kind::Text, "", "Group of facets, nodes or cells that move with it, with their masses")
    .absent("a body without a mesh, by `mass`, `centre` and `inertia`")
    .may("mass", POSITIVE, "mass", "Its mass; with `group` in addition to that of the nodes")
    .absent("with `group`: none in addition")
    .may(
        "centre",
        vector(),
        "length",
        "Its centre of mass; with `group` that of what is added, and of the frame",
    )
    .absent("with `group`: the centre of mass of its cells, of a face the mean of its nodes")
    .may(
        "inertia",
        either(moments, exactly(3, vector())),
        "mass·length²",
        "Its inertia about the centre: principal moments along x, y and z, or a symmetric matrix",
    )
    .absent("a point mass, which has no directions without a `group`")
});

/// A rigid body with the places of its table, its name and its inertia.
#[derive(Debug)]
pub(super) struct PlacedRigid {
    pub(super) body: RigidBody,
    pub(super) place: Place,
    pub(super) name: Place,
    /// Place of the inertia; of a point mass that of the table.
    inertia: Place,
    /// Its group with the place of the name.
    group: Option<(String, Place)>,
}

impl PlacedRigid {
    /// The rigid body of a coupling, or of a mass that is coupled.
    pub(super) fn of_coupling(table: &Table<'_>, body: RigidBody) -> Self {
        let place = |key: &str| table.item(key).map_or(table.place, |item| item.place()).clone();
        PlacedRigid {
            body,
            place: table.place.clone(),
            name: place("name"),
            inertia: place("inertia"),
            group: table.group(),
        }
    }

    /// Its group.
    pub(super) fn group(&self) -> Option<NamedGroup> {
        let (name, place) = self.group.clone()?;
        Some(NamedGroup::of_mesh(name, place, Members::Nodes))
    }
}

/// The name of a rigid body or a coupling.
pub(super) fn name(table: &Table<'_>) -> Result<String, Fault> {
    let name: Item<'_> = table.must("name");
    let text = name.text().unwrap_or_default().to_string();
    if text == GROUND {
        let message = format!("`{GROUND}` is what joints call the ground; give this another name");
        return Err(name.fault(message, "another name"));
    }
    Ok(text)
}

/// Reads one rigid body.
pub(super) fn read(table: &Table<'_>) -> Result<PlacedRigid, Fault> {
    let text = name(table)?;
    let name: Item<'_> = table.must("name");
    let (group, inertia) = (table.group(), table.item("inertia"));
    let is_missing =
        |key: &&str| table.item(key).is_none() && (group.is_none() || inertia.is_some() && *key == "mass");
    let missing: Vec<String> =
        ["mass", "centre"].iter().filter(|key| is_missing(key)).map(|key| format!("`{key}`")).collect();
    if !missing.is_empty() {
        let are = if missing.len() == 1 { "is" } else { "are" };
        let message = format!("{} {are} missing in [[rigid]]", missing.join(" and "));
        let fault = Fault::at(table.place, message, format!("needs {}", missing.join(" and ")));
        return Err(match (&group, inertia) {
            (Some(_), Some(inertia)) => fault.label(inertia.place(), "that of a mass in addition"),
            _ => fault.help("or a `group` of the mesh, which moves as one"),
        });
    }
    let body = RigidBody {
        name: text,
        group: group.as_ref().map(|(name, _)| name.clone()),
        mass: table.may("mass").unwrap_or(0.0),
        centre: table.may("centre"),
        inertia: inertia.map(inertia_of).transpose()?,
    };
    let place = table.place.clone();
    let inertia = inertia.map_or(&place, |item| item.place()).clone();
    Ok(PlacedRigid { body, name: name.place().clone(), inertia, group, place })
}

/// The inertia tensor.
pub(super) fn inertia_of(item: Item<'_>) -> Result<[[f64; 3]; 3], Fault> {
    let item = item.of_one_kind().unwrap_or(item);
    let rows = item.items();
    let is_matrix = rows.iter().any(|row| matches!(row.kind, Kind::Exactly(..)));
    if !is_matrix {
        let [x, y, z]: [f64; 3] = Read::read(item);
        let mut sorted = [x, y, z];
        sorted.sort_by(f64::total_cmp);
        let [a, b, largest] = sorted;
        if largest > a + b {
            let [largest, a, b] = [largest, a, b].map(short);
            let message = format!("no body has these moments of inertia: {largest} exceeds {a} + {b}");
            return Err(item.fault(message, "each is at most the sum of the others"));
        }
        return Ok([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]]);
    }
    let matrix: [[f64; 3]; 3] = Read::read(item);
    let pairs = [(0, 1), (0, 2), (1, 2)];
    match pairs.into_iter().find(|&(i, j)| matrix[i][j] != matrix[j][i]) {
        Some((i, j)) => {
            let [own, other] = [matrix[i][j], matrix[j][i]].map(short);
            let message = format!(
                "`inertia` must be symmetric: row {} has {own} in column {}, and row {} has {other} in column {}",
                i + 1,
                j + 1,
                j + 1,
                i + 1
            );
            Err(rows.get(j).unwrap_or(&item).fault(message, "not symmetric"))
        }
        None => Ok(matrix),
    }
}

/// The fault of a body with an impossible inertia or group.
pub(super) fn fault(error: &emmy::Error, placed: &[PlacedRigid]) -> Option<Fault> {
    let (emmy::Error::Inertia { body, .. } | emmy::Error::Rigid { body, .. }) = error else { return None };
    let own = placed.iter().find(|own| own.body.name == *body)?;
    Some(match (error, &own.group) {
        (emmy::Error::Rigid { .. }, Some((_, place))) => Fault::at(place, error.to_string(), "this group"),
        _ => Fault::at(&own.inertia, error.to_string(), "this inertia"),
    })
}
