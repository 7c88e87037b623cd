//! Placement of an instance in the assembly.

/// Translation, then rotation about an axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Placement {
    translation: [f64; 3],
    rotation: Option<Rotation>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Rotation {
    point: [f64; 3],
    /// Unit vector.
    axis: [f64; 3],
    /// Sine and cosine of the angle.
    sine: f64,
    cosine: f64,
}

impl Placement {
    /// Takes a data line of `*Instance`: at most three numbers translate; seven (two points of the axis and an angle
    /// in degrees) rotate. The reason if it is neither.
    pub(super) fn add(&mut self, values: &[f64]) -> Result<(), &'static str> {
        match *values {
            [ax, ay, az, bx, by, bz, angle] => {
                self.rotation = Some(Rotation::new([ax, ay, az], [bx, by, bz], angle)?);
            }
            _ if values.len() <= 3 && self.rotation.is_none() => {
                self.translation[..values.len()].copy_from_slice(values);
            }
            _ => {
                return Err(
                    "expected a translation (3 numbers) or a rotation (two points and an angle in degrees)",
                );
            }
        }
        Ok(())
    }

    /// Position of a point of the instance in the assembly.
    pub(super) fn place(&self, point: [f64; 3]) -> [f64; 3] {
        let moved = [0, 1, 2].map(|i| point[i] + self.translation[i]);
        self.rotation.map_or(moved, |rotation| rotation.turned(moved))
    }

    /// A direction of the instance in the assembly.
    pub(super) fn turned(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.map_or(direction, |rotation| Rotation { point: [0.0; 3], ..rotation }.turned(direction))
    }
}

impl Rotation {
    fn new(from: [f64; 3], to: [f64; 3], degrees: f64) -> Result<Self, &'static str> {
        let direction = [0, 1, 2].map(|i| to[i] - from[i]);
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return Err("the two points of the axis of rotation must differ");
        }
        let (sine, cosine) = sine_and_cosine(degrees);
        Ok(Rotation { point: from, axis: direction.map(|x| x / length), sine, cosine })
    }

    /// Rodrigues' formula.
    fn turned(&self, x: [f64; 3]) -> [f64; 3] {
        let n = self.axis;
        let r = [0, 1, 2].map(|i| x[i] - self.point[i]);
        let along = (n[0] * r[0] + n[1] * r[1] + n[2] * r[2]) * (1.0 - self.cosine);
        let across = emmy::internals::tensor::cross(n, r);
        [0, 1, 2].map(|i| self.point[i] + self.cosine * r[i] + self.sine * across[i] + along * n[i])
    }
}

/// Exact for quarter turns, which most assemblies use: planes of the mesh stay planes.
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        angle => angle.to_radians().sin_cos(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn translation_comes_before_rotation() {
        let mut placement = Placement::default();
        placement.add(&[1.0, 0.0, 0.0]).unwrap();
        placement.add(&[0.0, 0.0, 0.0, 0.0, 0.0, 5.0, 90.0]).unwrap();
        assert_eq!(placement.place([1.0, 0.0, 3.0]), [0.0, 2.0, 3.0]);
    }

    #[test]
    fn the_axis_stays_where_it_is() {
        let mut placement = Placement::default();
        placement.add(&[1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 35.0]).unwrap();
        let fixed = placement.place([3.0, 6.0, 9.0]);
        assert!((0..3).all(|i| (fixed[i] - [3.0, 6.0, 9.0][i]).abs() < 1e-14));
        assert!(placement.add(&[1.0; 5]).is_err());
        assert!(placement.add(&[1.0; 7]).is_err());
    }
}
