//! Directions in a material.

use crate::error::{Error, Result};
use crate::tensor::cross;

/// A unit vector.
pub(super) fn unit(material: &'static str, parameter: &'static str, v: [f64; 3]) -> Result<[f64; 3]> {
    // Scaled first: the squares of a long or a short vector need not be numbers.
    let size = v.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    if size == 0.0 || !v.iter().all(|x| x.is_finite()) {
        return Err(Error::Direction {
            material,
            parameter,
            requirement: "must have a positive, finite length",
        });
    }
    let v = v.map(|x| x / size);
    let length = dot(&v, &v).sqrt();
    Ok(v.map(|x| x / length))
}

/// Right-handed orthonormal axes: the first along the first direction, the second in the plane of both.
pub(super) fn from_directions(material: &'static str, directions: [[f64; 3]; 2]) -> Result<[[f64; 3]; 3]> {
    let first = unit(material, "axis_1", directions[0])?;
    let second = unit(material, "axis_2", directions[1])?;
    let third = cross(first, second);
    let sine = dot(&third, &third).sqrt();
    if sine <= 1e-6 {
        let requirement = "must not be parallel to axis_1 (they are [0, 1, 0] and [1, 0, 0] unless given)";
        return Err(Error::Direction { material, parameter: "axis_2", requirement });
    }
    let third = third.map(|x| x / sine);
    Ok([first, cross(third, first), third])
}

pub(super) fn dot(u: &[f64; 3], v: &[f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        let axes = from_directions("m", [[0.0, 3.0, 0.0], [5.0, 7.0, 0.0]]).unwrap();
        assert_eq!(axes, [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]);
        assert_eq!(unit("m", "axis_1", [0.0, -1e200, 0.0]).unwrap(), [0.0, -1.0, 0.0]);
    }
}
