//! The observer: the default view of the page, at a distance from which all of a body is seen.

use crate::drawing::Viewpoint;
use crate::vector::{Vector, dot};

/// Azimuth and elevation of the default view (`assets/scripts/viewer.js`).
const VIEW: [f64; 2] = [-1.0, 0.42];

/// Half of the angle of view across the longer side of the window, as in the page.
const HALF_ANGLE: f64 = 16.0;

/// A part of the canvas, in samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Window {
    /// Left and upper end.
    pub(super) start: [f64; 2],
    /// Width and height.
    pub(super) size: [f64; 2],
}

/// The default view of a body: from above, z upwards; of a plane one, from the front.
pub(super) fn viewpoint(points: &[Vector], has_surface: bool) -> Viewpoint {
    let [_, _, [low, high]] = [0, 1, 2].map(|i| ends(points.iter().map(|point| point[i])));
    let size = [0, 1, 2].map(|i| ends(points.iter().map(|point| point[i]))).map(|[low, high]| high - low);
    let is_plane = high - low < 1e-9 * dot(size, size).sqrt() || !has_surface && high == low;
    if is_plane {
        return Viewpoint { from: [0.0, 0.0, 1.0], up: [0.0, 1.0, 0.0] };
    }
    let [azimuth, elevation] = VIEW;
    let across = elevation.cos();
    Viewpoint { from: [across * azimuth.cos(), across * azimuth.sin(), elevation.sin()], up: [0.0, 0.0, 1.0] }
}

/// An observer in front of a window.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Camera {
    /// Unit vectors to the right, up and to the observer.
    axes: [Vector; 3],
    /// The observer, by these axes.
    place: Vector,
    /// Middle of the window.
    middle: [f64; 2],
    /// Tangent of the angle of view of a sample.
    step: f64,
}

impl Camera {
    /// The nearest observer who sees all of some points in a window.
    pub(super) fn fitted(view: &Viewpoint, points: &[Vector], window: Window) -> Self {
        let axes = view.axes();
        let seen: Vec<Vector> = points.iter().map(|&point| axes.map(|axis| dot(axis, point))).collect();
        let longest = window.size[0].max(window.size[1]);
        let step = 2.0 * HALF_ANGLE.to_radians().tan() / longest;
        // Of an observer at x and distance z, |x - x_i| <= tan (z - z_i) for all points, and likewise upwards.
        let fit = [0, 1].map(|i| {
            let tangent = 0.5 * step * window.size[i];
            let [_, most] = ends(seen.iter().map(|at| at[i] + tangent * at[2]));
            let [least, _] = ends(seen.iter().map(|at| at[i] - tangent * at[2]));
            [0.5 * (most + least), 0.5 * (most - least) / tangent]
        });
        let size = [0, 1, 2].map(|i| ends(seen.iter().map(|at| at[i]))).map(|[low, high]| high - low);
        let diagonal = dot(size, size).sqrt();
        let [_, nearest] = ends(seen.iter().map(|at| at[2]));
        // A point alone is seen from any distance.
        let least = nearest + if diagonal > 0.0 { 0.1 * diagonal } else { 1.0 };
        let distance = fit[0][1].max(fit[1][1]).max(least);
        let middle = [0, 1].map(|i| window.start[i] + 0.5 * window.size[i]);
        Camera { axes, place: [fit[0][0], fit[1][0], distance], middle, step }
    }

    /// Unit vectors to the right, up and to the observer.
    pub(super) fn axes(&self) -> [Vector; 3] {
        self.axes
    }

    /// Place on the canvas in samples, and reciprocal of the distance.
    pub(super) fn project(&self, point: Vector) -> ([f64; 2], f64) {
        let from = self.towards(point);
        let scale = 1.0 / (from[2] * self.step);
        ([self.middle[0] - scale * from[0], self.middle[1] + scale * from[1]], 1.0 / from[2])
    }

    /// Vector from a point to the observer, by the axes.
    pub(super) fn towards(&self, point: Vector) -> Vector {
        [0, 1, 2].map(|i| self.place[i] - dot(self.axes[i], point))
    }
}

/// Height of some points over their width, as a distant observer sees them.
pub(super) fn height_over_width(view: &Viewpoint, points: &[Vector]) -> f64 {
    let [right, up, _] = view.axes();
    let [width, height] = [right, up].map(|axis| {
        let [low, high] = ends(points.iter().map(|&point| dot(axis, point)));
        high - low
    });
    height / width
}

/// Least and largest of some numbers; those that are not finite are left out.
fn ends(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    numbers.filter(|x| x.is_finite()).fold(none, |[low, high], x| [low.min(x), high.max(x)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn box_of(size: Vector) -> Vec<Vector> {
        (0..8).map(|corner| [0, 1, 2].map(|i| if corner >> i & 1 == 1 { size[i] } else { 0.0 })).collect()
    }

    #[test]
    fn a_body_of_any_shape_fills_the_window_and_does_not_leave_it() {
        let window = Window { start: [10.0, 20.0], size: [400.0, 300.0] };
        for size in [[1.0, 1.0, 1.0], [100.0, 1.0, 1.0], [1.0, 1.0, 50.0], [1e-3, 2e-3, 0.0], [0.0, 0.0, 7.0]]
        {
            let points = box_of(size);
            let camera = Camera::fitted(&viewpoint(&points, true), &points, window);
            let places: Vec<[f64; 2]> = points.iter().map(|&point| camera.project(point).0).collect();
            let fills = [0, 1].map(|i| {
                let [low, high] = ends(places.iter().map(|place| place[i]));
                let [start, end] = [window.start[i], window.start[i] + window.size[i]];
                assert!(low > start - 1e-6 && high < end + 1e-6, "{size:?} {low} {high}");
                (high - low) / window.size[i]
            });
            assert!(fills[0].max(fills[1]) > 0.95, "{size:?} {fills:?}");
        }
    }

    #[test]
    fn the_view_is_that_of_the_page() {
        let body = viewpoint(&box_of([1.0; 3]), true).axes();
        // x goes to the right and to the front, z upwards.
        assert!(body[0][0] > 0.0 && body[2][0] > 0.0 && body[1][2] > 0.9 && body[0][2] == 0.0, "{body:?}");
        assert!((body[2][2] - 0.42f64.sin()).abs() < 1e-15);
        let plane = viewpoint(&box_of([1.0, 2.0, 0.0]), true).axes();
        assert_eq!(plane, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(
            height_over_width(&viewpoint(&box_of([1.0, 2.0, 0.0]), true), &box_of([1.0, 2.0, 0.0])),
            2.0
        );
    }

    #[test]
    fn a_point_alone_is_in_the_middle() {
        let window = Window { start: [0.0; 2], size: [400.0, 300.0] };
        let camera = Camera::fitted(&viewpoint(&[[3.0; 3]], false), &[[3.0; 3]], window);
        assert_eq!(camera.project([3.0; 3]), ([200.0, 150.0], 1.0));
    }
}
