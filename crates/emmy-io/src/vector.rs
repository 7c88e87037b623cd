//! Vectors in space.

pub(crate) type Vector = [f64; 3];

pub(crate) fn minus(a: Vector, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}

pub(crate) fn distance(a: Vector, b: Vector) -> f64 {
    norm(minus(a, b))
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The unit vector of a direction; `None` without one.
pub(crate) fn unit(a: Vector) -> Option<Vector> {
    let length = norm(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}

/// Whether three of some points are not on one line, up to rounding of their distances.
pub(crate) fn span_a_plane(points: &[Vector]) -> bool {
    let Some((&first, rest)) = points.split_first() else { return false };
    let far = |to: &dyn Fn(Vector) -> f64| {
        rest.iter().copied().map(|point| (to(point), point)).max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let Some((length, end)) = far(&|point| distance(point, first)) else { return false };
    let along = minus(end, first);
    let off = far(&|point| norm(cross(along, minus(point, first))));
    off.is_some_and(|(area, _)| length > 0.0 && area > 1e-6 * length * length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_line_span_no_plane() {
        let on_a_line = [[0.0; 3], [1.0, 1.0, 0.0], [3.0, 3.0, 0.0]];
        assert!(!span_a_plane(&on_a_line) && !span_a_plane(&on_a_line[..1]) && !span_a_plane(&[]));
        assert!(!span_a_plane(&[[1.0; 3]; 4]));
        assert!(span_a_plane(&[[0.0; 3], [1.0, 1.0, 0.0], [3.0, 3.1, 0.0]]));
    }
}
