//! `*ORIENTATION`: local directions of connectors.

use super::find::reals;
use super::{Maker, Owned};
use crate::vector::{Vector, cross, minus, unit};

/// Local directions 1, 2 and 3, unit vectors.
pub(super) type Axes = [Vector; 3];

impl<'a> Maker<'a, '_> {
    /// Directions of an orientation of an instance or of the assembly; the reason if there are none.
    pub(super) fn orientation(&self, instance: Option<u32>, name: &str) -> Result<Axes, &'static str> {
        let is_named = |owned: &&Owned<'a>| {
            owned.keyword() == "ORIENTATION"
                && owned.value("NAME").is_some_and(|own| own.eq_ignore_ascii_case(name))
        };
        let of = |wanted: Option<u32>| {
            self.cards.iter().find(|owned| owned.instance == wanted && is_named(owned)).copied()
        };
        let found = of(instance).or_else(|| of(None)).ok_or("its orientation is not in the file")?;
        let axes = axes(found)?;
        let place = found.instance.map_or(0, |index| index as usize + 1);
        Ok(axes.map(|axis| self.assembly.placements[place].turned(axis)))
    }
}

/// With the points a, b and the origin c of the first line, direction 1 is that of a from c, and direction 2 lies in
/// the plane of a, b and c, on the side of b (Abaqus Analysis User's Guide, "Orientations").
fn axes(owned: Owned<'_>) -> Result<Axes, &'static str> {
    const NOT_READ: &str = "its orientation is not rectangular by the coordinates of points";
    let is = |key: &str, wanted: [&str; 2]| {
        owned.value(key).is_none_or(|own| wanted.iter().any(|wanted| own.eq_ignore_ascii_case(wanted)))
    };
    if !is("SYSTEM", ["RECTANGULAR", "R"]) || !is("DEFINITION", ["COORDINATES", "COORDINATES"]) {
        return Err(NOT_READ);
    }
    let values = |line: usize| owned.card.lines.get(line).and_then(|(_, fields)| reals(fields));
    let Some(values_of_points) = values(0).filter(|values| (5..=9).contains(&values.len())) else {
        return Err(NOT_READ);
    };
    // An additional rotation about one of the directions.
    if values(1).is_some_and(|rotation| rotation.get(1).is_some_and(|angle| *angle != 0.0)) {
        return Err(NOT_READ);
    }
    let point = |at: usize| [0, 1, 2].map(|i| values_of_points.get(3 * at + i).copied().unwrap_or(0.0));
    let [a, b, c] = [0, 1, 2].map(point);
    let one = unit(minus(a, c)).ok_or(NOT_READ)?;
    let three = unit(cross(one, minus(b, c))).ok_or(NOT_READ)?;
    Ok([one, cross(three, one), three])
}
