//! Rigid motions that fit those of a component best, by least squares over its nodes.

use super::rigid_step;
use crate::tensor::Mat3;
use crate::tensor::rotation::polar;
use crate::unknowns::Component;

/// The rotation from some positions of the nodes to others.
pub(super) fn rotation(
    component: &Component,
    from: impl Fn(usize) -> [f64; 3],
    to: impl Fn(usize) -> [f64; 3],
) -> Mat3<f64> {
    let means = [component.mean(&to), component.mean(&from)];
    polar(&component.products(|node| about(means, [to(node), from(node)])))
}

/// Mean and spin of rates at some positions of the nodes.
pub(super) fn rates(
    component: &Component,
    positions: impl Fn(usize) -> [f64; 3],
    rates: impl Fn(usize) -> [f64; 3],
) -> [[f64; 3]; 2] {
    let [rate, centre] = [component.mean(&rates), component.mean(&positions)];
    let inertia = component.products(|node| {
        let [q, _] = about([centre; 2], [positions(node); 2]);
        [q; 2]
    });
    let moments = component.products(|node| about([rate, centre], [rates(node), positions(node)]));
    [rate, rigid_step::spin(&inertia, &moments, [true; 3]).unwrap_or_default()]
}

fn about(centres: [[f64; 3]; 2], vectors: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [0, 1].map(|i| [0, 1, 2].map(|d| vectors[i][d] - centres[i][d]))
}
