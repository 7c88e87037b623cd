//! The place of a body: rotations and shifts.

use crate::error::{Error, Result};
use crate::tensor::cross;

/// Rotations and shifts, one after the other: the place of a part of a mesh.
///
/// ```
/// use emmy::mesh::Placement;
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let placement = Placement::default().turned([0.0, 0.0, 2.0], quarter, [1.0, 0.0, 0.0])?.shifted([0.0, 5.0, 0.0]);
/// assert_eq!(placement.point([2.0, 0.0, 3.0]), [1.0, 6.0, 3.0]);
/// assert_eq!(placement.direction([0.0, 0.0, 1.0]), [0.0, 0.0, 1.0]);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Rows of the rotation.
    rotation: [[f64; 3]; 3],
    /// Shift after it.
    shift: [f64; 3],
}

impl Default for Placement {
    /// The place where the body is.
    fn default() -> Self {
        Placement { rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] }
    }
}

impl Placement {
    /// This placement, then a rotation by an angle \[radian\] about an axis of any length through a point,
    /// counter-clockwise seen from its tip.
    ///
    /// # Errors
    /// [`Error::Turn`] if the axis has no length, or a number is not finite.
    pub fn turned(self, axis: [f64; 3], angle: f64, about: [f64; 3]) -> Result<Self> {
        let largest = axis.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let finite = axis.iter().chain(&about).chain([&angle]).all(|x| x.is_finite());
        if !(largest > 0.0 && finite) {
            return Err(Error::Turn { axis, angle });
        }
        // The square of the length itself could overflow.
        let scaled = axis.map(|x| x / largest);
        let length = dot(scaled, scaled).sqrt();
        let n = scaled.map(|x| x / length);
        let (sine, cosine) = sine_and_cosine(angle);
        // Rodrigues' formula.
        let turn = |x: [f64; 3]| {
            let (across, along) = (cross(n, x), dot(n, x) * (1.0 - cosine));
            [0, 1, 2].map(|i| cosine * x[i] + sine * across[i] + along * n[i])
        };
        let columns = [0, 1, 2].map(|j| turn(self.rotation.map(|row| row[j])));
        let rotation = [0, 1, 2].map(|i| columns.map(|column| column[i]));
        let from_axis = [0, 1, 2].map(|i| self.shift[i] - about[i]);
        let turned = turn(from_axis);
        Ok(Placement { rotation, shift: [0, 1, 2].map(|i| about[i] + turned[i]) })
    }

    /// This placement, then a shift \[length\].
    pub fn shifted(self, by: [f64; 3]) -> Self {
        Placement { shift: [0, 1, 2].map(|i| self.shift[i] + by[i]), ..self }
    }

    /// The place of a point.
    pub fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.direction(point);
        [0, 1, 2].map(|i| turned[i] + self.shift[i])
    }

    /// The direction of a vector.
    pub fn direction(&self, vector: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| dot(row, vector))
    }

    /// A symmetric tensor, such as an inertia, with components along the fixed axes.
    pub fn tensor(&self, tensor: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
        // Q T transposed is T transposed with every row turned.
        let turn_rows = |own: [[f64; 3]; 3]| own.map(|row| self.direction(row));
        let transposed = |own: [[f64; 3]; 3]| [0, 1, 2].map(|i| own.map(|row| row[i]));
        turn_rows(transposed(turn_rows(tensor)))
    }

    /// Whether it turns about the z axis only.
    pub(super) fn keeps_z(&self) -> bool {
        self.rotation[2][2] > 1.0 - 1e-12
    }

    /// The smallest box along the axes around a box at its place.
    pub(super) fn box_of(&self, bounds: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
        let corner = |corner: usize| [0, 1, 2].map(|i| bounds[corner >> i & 1][i]);
        let corners: Vec<[f64; 3]> = (0..8).map(|i| self.point(corner(i))).collect();
        super::bounds(corners.iter())
    }
}

/// Sine and cosine, exact for quarter turns: planes of the mesh along the axes stay planes.
fn sine_and_cosine(angle: f64) -> (f64, f64) {
    let quarters = angle / std::f64::consts::FRAC_PI_2;
    if quarters != quarters.round() {
        return angle.sin_cos();
    }
    match quarters.rem_euclid(4.0) {
        1.0 => (1.0, 0.0),
        2.0 => (0.0, -1.0),
        3.0 => (-1.0, 0.0),
        _ => (0.0, 1.0),
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{MeshBuilder, ball, block, quality, rectangle};

    #[test]
    fn rotations_match_their_definition() {
        let (axis, angle, about) = ([1.0, -2.0, 0.5], 0.7, [0.3, 4.0, -1.0]);
        let placement = Placement::default().turned(axis, angle, about).unwrap();
        let close = |a: [f64; 3], b: [f64; 3]| (0..3).all(|i| (a[i] - b[i]).abs() < 1e-14);
        // Points of the axis stay.
        assert!(close(placement.point([1.3, 2.0, -0.5]), [1.3, 2.0, -0.5]));
        // A vector across the axis turns by the angle, counter-clockwise.
        let r = [2.0, 1.0, 0.0];
        let turned = placement.direction(r);
        assert!((dot(r, turned) / dot(r, r) - angle.cos()).abs() < 1e-15);
        assert!(dot(cross(r, turned), axis) > 0.0);
        // Two halves are the whole, and the way back leads back.
        let half = Placement::default().turned(axis, angle / 2.0, about).unwrap();
        let twice = half.turned(axis, angle / 2.0, about).unwrap();
        let back = placement.turned(axis, -angle, about).unwrap();
        let x = [0.1, 0.2, 0.3];
        assert!(close(twice.point(x), placement.point(x)) && close(back.point(x), x));
        // The tensor of a vector with itself.
        let own = [0, 1, 2].map(|i| r.map(|x| r[i] * x));
        let expected = [0, 1, 2].map(|i| turned.map(|x| turned[i] * x));
        assert!((0..3).all(|i| close(placement.tensor(own)[i], expected[i])));
    }

    #[test]
    fn quarter_turns_are_exact() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for (n, expected) in
            [(1.0, [-2.0, 1.0]), (2.0, [-1.0, -2.0]), (3.0, [2.0, -1.0]), (-1.0, [2.0, -1.0])]
        {
            let turn = Placement::default().turned([0.0, 0.0, 3e200], n * quarter, [0.0; 3]).unwrap();
            assert_eq!(turn.point([1.0, 2.0, 3.0]), [expected[0], expected[1], 3.0]);
        }
    }

    #[test]
    fn bad_rotations_are_rejected() {
        let turn = |axis, angle, about| Placement::default().turned(axis, angle, about);
        let z = [0.0, 0.0, 1.0];
        assert!(turn([0.0; 3], 1.0, [0.0; 3]).is_err() && turn(z, f64::NAN, [0.0; 3]).is_err());
        assert!(turn([f64::INFINITY, 0.0, 0.0], 1.0, [0.0; 3]).is_err());
        assert!(turn(z, 1.0, [f64::NAN; 3]).is_err());
        let plane = rectangle([1.0, 1.0], [1, 1]).unwrap();
        let over = turn([1.0, 0.0, 0.0], 0.1, [0.0; 3]).unwrap();
        assert_eq!(plane.clone().placed(&over), Err(Error::TurnedPlane));
        assert!(
            (quality(&plane.placed(&turn(z, 0.1, [0.0; 3]).unwrap()).unwrap()).volume - 1.0).abs() < 1e-15
        );
    }

    #[test]
    fn parts_keep_their_groups_under_their_names() {
        let mut builder = MeshBuilder::new();
        let left = block([1.0; 3], [2, 1, 1]).unwrap().with_node_group("tip", [3]).unwrap();
        builder.part("left", &left).unwrap();
        builder.part("right", &ball(1.0, 1).unwrap()).unwrap();
        let again = builder.part("left", &left).unwrap_err();
        assert_eq!(again, Error::GroupOfPartExists { part: "left".into(), group: "left".into() });
        // A name that a group of another part has.
        let error = builder.part("left-tip", &left).unwrap_err();
        assert_eq!(error, Error::GroupOfPartExists { part: "left-tip".into(), group: "left-tip".into() });
        for name in ["", "a b", "nodes:a", "a.b"] {
            assert_eq!(builder.part(name, &left), Err(Error::PartName { part: name.into() }));
        }
        let plane = rectangle([1.0, 1.0], [1, 1]).unwrap();
        assert_eq!(builder.part("plane", &plane), Err(Error::MixedParts { part: "plane".into() }));
        let mesh = builder.build().unwrap();
        assert_eq!(mesh.n_cells(), 2 + 8);
        assert_eq!(mesh.groups().cells("right").unwrap(), [2, 3, 4, 5, 6, 7, 8, 9]);
        assert_eq!(mesh.groups().nodes["left-tip"], [3]);
        assert_eq!(mesh.group_nodes("right-surface").unwrap().len(), 26);
        assert_eq!(mesh.parts().len(), 2);
        assert!(mesh.groups().cells("left-body").is_err() && mesh.groups().cells("body").is_err());
    }
}
