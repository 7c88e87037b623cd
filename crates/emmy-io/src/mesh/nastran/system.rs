//! Coordinate systems: rectangular, cylindrical and spherical, by three points or by three grid points.

use std::collections::HashMap;

use super::super::abaqus::{At, Deck};
use super::super::{MeshError, Result};
use crate::vector::{cross, dot, minus, norm, unit};

/// Largest number of systems that are given in each other.
const MAX_DEPTH: usize = 500;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Shape {
    Rectangular,
    Cylindrical,
    Spherical,
}

/// The origin, a point on the axis z and a point in the plane x-z.
#[derive(Debug, Clone, Copy)]
pub(super) enum Points {
    /// Coordinates in a system.
    Given(u64, [[f64; 3]; 3]),
    Grids([u64; 3]),
}

#[derive(Debug, Clone, Copy)]
pub(super) struct System {
    pub(super) shape: Shape,
    pub(super) points: Points,
    pub(super) at: At,
}

/// A grid point as the file gives it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub(super) number: u64,
    /// None: the system of `GRDSET`.
    pub(super) system: Option<u64>,
    pub(super) coordinates: [f64; 3],
    /// The system of its displacements. None: that of `GRDSET`.
    pub(super) displacement: Option<u64>,
    pub(super) at: At,
}

/// Origin and axes in the basic system.
#[derive(Debug, Clone, Copy)]
struct Frame {
    shape: Shape,
    origin: [f64; 3],
    axes: [[f64; 3]; 3],
}

impl Frame {
    fn place(&self, coordinates: [f64; 3]) -> [f64; 3] {
        let local = rectangular(self.shape, coordinates);
        let sum = |i: usize| (0..3).map(|axis| local[axis] * self.axes[axis][i]).sum::<f64>();
        [0, 1, 2].map(|i| self.origin[i] + sum(i))
    }

    /// Directions of the components 1, 2, 3 at a place: the axes, or the radius, the angles and the axis there.
    fn directions(&self, place: [f64; 3]) -> [[f64; 3]; 3] {
        let [x, y, z] = self.axes;
        let arm = minus(place, self.origin);
        let [a, b, c] = self.axes.map(|axis| dot(arm, axis));
        // On the axis z the angle is zero.
        let (cos, sin) = if a.hypot(b) > 0.0 { (a / a.hypot(b), b / a.hypot(b)) } else { (1.0, 0.0) };
        let radial = [0, 1, 2].map(|i| cos * x[i] + sin * y[i]);
        let around = [0, 1, 2].map(|i| cos * y[i] - sin * x[i]);
        match self.shape {
            Shape::Rectangular => self.axes,
            Shape::Cylindrical => [radial, around, z],
            Shape::Spherical => {
                let length = a.hypot(b).hypot(c);
                let (cos, sin) = if length > 0.0 { (c / length, a.hypot(b) / length) } else { (1.0, 0.0) };
                let outward = [0, 1, 2].map(|i| sin * radial[i] + cos * z[i]);
                [outward, [0, 1, 2].map(|i| cos * radial[i] - sin * z[i]), around]
            }
        }
    }
}

/// Rectangular coordinates of (r, theta, z) or (r, theta, phi), with angles in degrees: theta of a sphere begins at the
/// axis z, phi and theta of a cylinder begin at the axis x.
fn rectangular(shape: Shape, [a, b, c]: [f64; 3]) -> [f64; 3] {
    match shape {
        Shape::Rectangular => [a, b, c],
        Shape::Cylindrical => {
            let [sin, cos] = sin_cos(b);
            [a * cos, a * sin, c]
        }
        Shape::Spherical => {
            let [[sin, cos], [sin_phi, cos_phi]] = [sin_cos(b), sin_cos(c)];
            [a * sin * cos_phi, a * sin * sin_phi, a * cos]
        }
    }
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90 degrees.
fn sin_cos(degrees: f64) -> [f64; 2] {
    let quarters = (degrees / 90.0).round();
    let (sin, cos) = (degrees - 90.0 * quarters).to_radians().sin_cos();
    match quarters.rem_euclid(4.0) as u8 {
        0 => [sin, cos],
        1 => [cos, -sin],
        2 => [-sin, -cos],
        _ => [-cos, sin],
    }
}

/// Places grid points in the basic system.
pub(super) struct Placement<'a> {
    deck: &'a Deck,
    systems: &'a HashMap<u64, System>,
    grids: &'a [Grid],
    /// The system of grid points that name none.
    default: u64,
    frames: HashMap<u64, Frame>,
}

impl<'a> Placement<'a> {
    pub(super) fn new(
        deck: &'a Deck,
        systems: &'a HashMap<u64, System>,
        grids: &'a [Grid],
        default: u64,
    ) -> Self {
        Placement { deck, systems, grids, default, frames: HashMap::new() }
    }

    pub(super) fn points(mut self) -> Result<Vec<[f64; 3]>> {
        self.grids.iter().map(|grid| self.point(grid, 0)).collect()
    }

    /// Directions of the components 1, 2, 3 of a system at a place.
    pub(super) fn directions(&mut self, system: u64, by: At, place: [f64; 3]) -> Result<[[f64; 3]; 3]> {
        match system {
            0 => Ok([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
            system => Ok(self.frame(system, by, 0)?.directions(place)),
        }
    }

    fn point(&mut self, grid: &Grid, depth: usize) -> Result<[f64; 3]> {
        let system = grid.system.unwrap_or(self.default);
        let point = match system {
            0 => grid.coordinates,
            system => self.frame(system, grid.at, depth)?.place(grid.coordinates),
        };
        if point.iter().all(|x| x.is_finite()) {
            return Ok(point);
        }
        Err(MeshError::CoordinateNotFinite { place: self.deck.place(grid.at), node: grid.number })
    }

    /// The frame of a system that an entry names.
    fn frame(&mut self, number: u64, by: At, depth: usize) -> Result<Frame> {
        if let Some(frame) = self.frames.get(&number) {
            return Ok(*frame);
        }
        let deck = self.deck;
        let malformed = |at, problem: String, advice| {
            Err(MeshError::Malformed { place: deck.place(at), problem, advice })
        };
        let undefined = |at, problem: String, advice| {
            Err(MeshError::Undefined { place: deck.place(at), problem, advice })
        };
        let Some(&System { shape, points, at }) = self.systems.get(&number) else {
            let problem = format!("there is no coordinate system {number}");
            return undefined(
                by,
                problem,
                "systems of CORD1R, CORD1C, CORD1S, CORD2R, CORD2C and CORD2S are read",
            );
        };
        if depth == MAX_DEPTH {
            let problem = format!("more than {MAX_DEPTH} coordinate systems, given in each other");
            return malformed(at, problem, "is a system given in itself?");
        }
        let [origin, top, side] = match points {
            Points::Given(0, points) => points,
            Points::Given(system, points) => {
                let frame = self.frame(system, at, depth + 1)?;
                points.map(|point| frame.place(point))
            }
            Points::Grids(numbers) => {
                let mut points = [[0.0; 3]; 3];
                for (point, number) in points.iter_mut().zip(numbers) {
                    let Some(&index) = deck.root.nodes.get(&number) else {
                        let problem =
                            format!("there is no grid point {number}, which defines a coordinate system");
                        return undefined(at, problem, "add it, or take another one");
                    };
                    let grid = self.grids[index as usize];
                    *point = self.point(&grid, depth + 1)?;
                }
                points
            }
        };
        let axes = || {
            let z = unit(minus(top, origin))?;
            let side = minus(side, origin);
            let along = dot(side, z);
            let x = minus(side, z.map(|component| along * component));
            // Relative, because the points are given with few digits.
            let x = Some(x).filter(|&x| norm(x) > 1e-10 * norm(side)).and_then(unit)?;
            Some([x, cross(z, x), z])
        };
        let Some(axes) = axes() else {
            let problem = format!("the three points of coordinate system {number} lie on one line");
            return malformed(
                at,
                problem,
                "give its origin, a point on its axis z, and one in its plane x-z",
            );
        };
        let frame = Frame { shape, origin, axes };
        self.frames.insert(number, frame);
        Ok(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_degrees_and_exact_at_right_angles() {
        assert_eq!(rectangular(Shape::Cylindrical, [2.0, 90.0, 5.0]), [0.0, 2.0, 5.0]);
        assert_eq!(rectangular(Shape::Cylindrical, [2.0, -180.0, 5.0]), [-2.0, 0.0, 5.0]);
        assert_eq!(rectangular(Shape::Cylindrical, [2.0, 630.0, 5.0]), [0.0, -2.0, 5.0]);
        assert_eq!(rectangular(Shape::Spherical, [2.0, 90.0, 90.0]), [0.0, 2.0, 0.0]);
        assert_eq!(rectangular(Shape::Spherical, [2.0, 180.0, 30.0]), [0.0, 0.0, -2.0]);
        let [x, y, z] = rectangular(Shape::Spherical, [2.0, 60.0, 30.0]);
        let expected = [2.0 * 0.75, 2.0 * 0.75_f64.sqrt() * 0.5, 1.0];
        assert!([x, y, z].iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
