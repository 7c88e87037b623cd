//! `[[rigid]]`: rigid bodies without cells, and point masses.

use emmy::body::RigidBody;
use emmy::internals::material::Bounds;
use emmy::internals::number::short;

use super::description::{Described, Kind, POSITIVE, Section, TAKEN, either, exactly, vector};
use super::fault::{Fault, Place};
use super::table::{Item, Read, Table};

/// The name of the ground in joints.
pub(super) const GROUND: &str = "ground";

/// `[[rigid]]`.
pub(super) static RIGID: Described = Described::new(|| {
    let moments = exactly(3, Kind::Number(Bounds::Above(0.0)));
    Section::new("[[rigid]]", "A rigid body without cells, or a point mass")
        .must(
            "name",
            Kind::Column(&TAKEN),
            "",
            "Its name in joints and as a group, of one node, its centre: letters, digits, `_` and `-`",
        )
        .must("mass", POSITIVE, "mass", "Its mass")
        .must("centre", vector(), "length", "Its centre of mass")
        .may(
            "inertia",
            either(moments, exactly(3, vector())),
            "mass·length²",
            "Its inertia about the centre: principal moments along x, y and z, or a symmetric matrix",
        )
        .absent("a point mass, which has no directions")
});

/// A rigid body with the places of its table, its name and its inertia.
#[derive(Debug)]
pub(super) struct PlacedRigid {
    pub(super) body: RigidBody,
    pub(super) place: Place,
    pub(super) name: Place,
    /// Place of the inertia; of a point mass that of the table.
    inertia: Place,
}

/// Reads one rigid body.
pub(super) fn read(table: &Table<'_>) -> Result<PlacedRigid, Fault> {
    let name: Item<'_> = table.must("name");
    let text = name.text().unwrap_or_default().to_string();
    if text == GROUND {
        let message = format!("`{GROUND}` is what joints call the ground; give the rigid body another name");
        return Err(name.fault(message, "another name"));
    }
    let (mass, centre) = (table.must("mass"), table.must("centre"));
    let inertia = table.item("inertia");
    let body = match inertia.map(inertia_of).transpose()? {
        Some(inertia) => RigidBody { name: text, mass, centre, inertia: Some(inertia) },
        None => RigidBody::point(text, mass, centre),
    };
    let place = table.place.clone();
    let inertia = inertia.map_or(&place, |item| item.place()).clone();
    Ok(PlacedRigid { body, name: name.place().clone(), inertia, place })
}

/// The inertia tensor.
fn inertia_of(item: Item<'_>) -> Result<[[f64; 3]; 3], Fault> {
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
            return Err(item.fault(message, "each must be less than the sum of the others"));
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

/// The fault of a body with an impossible inertia.
pub(super) fn fault(error: &emmy::Error, placed: &[PlacedRigid]) -> Option<Fault> {
    let emmy::Error::Inertia { body, .. } = error else { return None };
    let own = placed.iter().find(|own| own.body.name == *body)?;
    Some(Fault::at(&own.inertia, error.to_string(), "this inertia"))
}
