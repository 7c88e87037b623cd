//! Frames of reference that move with a part of the body.

#![allow(non_snake_case)]

use crate::body::Body;
use crate::error::{Error, Result};
use crate::nodal;
use crate::tensor::rotation::{image, polar, transposed};
use crate::tensor::{Mat3, cross, three};
use crate::time::fitted_spin;

/// The motion of a frame of reference: a translation with some nodes, or the rigid motion that fits the body best.
///
/// ```
/// use emmy::motion::ReferenceMotion;
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// // A quarter turn about the z axis.
/// let turned: Vec<f64> = body.mesh().points().iter().flat_map(|X| [-X[1] - X[0], X[0] - X[1], 0.0]).collect();
/// let [relative, _] = ReferenceMotion::of_body().seen(&body, &turned, &[0.0; 24]);
/// assert!(relative.iter().all(|u| u.abs() < 1e-14));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceMotion(Kind);

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// The mean of each component over some nodes of the rank.
    Mean([Vec<usize>; 3]),
    /// The rigid motion that fits the nodes best, weighted with their lumped masses.
    Rigid,
}

impl ReferenceMotion {
    /// The mean motion of the nodes of a group. On a team a call of all ranks.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`] if no rank has the group.
    pub fn of_group(body: &Body, group: &str) -> Result<Self> {
        let nodes = body.mesh().group_nodes(group);
        let own = |node: &usize| body.space.own_nodes().contains(node);
        let found = nodes.iter().flatten().map(|&node| node as usize).filter(own).collect::<Vec<usize>>();
        let mut n = [found.len() as f64];
        body.space.sum_ranks("nodes of a group", &mut n);
        match nodes {
            Err(error) if n[0] == 0.0 => Err(error),
            _ => Ok(ReferenceMotion(Kind::Mean([found.clone(), found.clone(), found]))),
        }
    }

    /// The mean motion of the nodes that supports drive; none along an axis without driven nodes. On a team a call of
    /// all ranks.
    ///
    /// # Errors
    /// [`Error::NoBase`] if no support moves.
    pub fn of_base(body: &Body) -> Result<Self> {
        let mut nodes = [const { Vec::new() }; 3];
        for dof in body.space.driven_dofs().filter(|dof| body.space.own_nodes().contains(&(dof / 3))) {
            nodes[dof % 3].push(dof / 3);
        }
        let mut n = [nodes.iter().map(Vec::len).sum::<usize>() as f64];
        body.space.sum_ranks("driven nodes", &mut n);
        if n[0] == 0.0 { Err(Error::NoBase) } else { Ok(ReferenceMotion(Kind::Mean(nodes))) }
    }

    /// The rigid motion that fits the body best: its rotation R and its centre c minimise
    ///
    /// ```math
    /// sum_A m_A |q_A - c - R (X_A - C)|^2
    /// ```
    ///
    /// Relative displacements are `R^T (q - c) - (X - C)`, in axes that rotate with the body, and relative velocities
    /// are their rates.
    pub fn of_body() -> Self {
        ReferenceMotion(Kind::Rigid)
    }

    /// Relative displacement and velocity of all nodes, `[n_nodes][3]`. On a team a call of all ranks.
    pub fn seen(&self, body: &Body, displacement: &[f64], velocity: &[f64]) -> [Vec<f64>; 2] {
        match &self.0 {
            Kind::Mean(nodes) => relative_to_mean(body, nodes, [displacement, velocity]),
            Kind::Rigid => RigidFit::new(body, displacement, velocity).seen(body, displacement, velocity),
        }
    }
}

fn relative_to_mean(body: &Body, nodes: &[Vec<usize>; 3], motion: [&[f64]; 2]) -> [Vec<f64>; 2] {
    // Two sums and the number of nodes for each component.
    let mut sums = [0.0; 9];
    for (d, nodes) in nodes.iter().enumerate() {
        for (sum, own) in sums[3 * d..].iter_mut().zip(motion) {
            *sum = nodes.iter().map(|node| own[nodal::dof(*node, d)]).sum();
        }
        sums[3 * d + 2] = nodes.len() as f64;
    }
    body.space.sum_ranks("motion of a reference", &mut sums);
    [0, 1].map(|which| {
        let mean = |d: usize| sums[3 * d + which] / sums[3 * d + 2].max(1.0);
        let mut relative = motion[which].to_vec();
        // Internal nodes of cells, which come last, are no places.
        let of_mesh = relative.iter_mut().take(body.mesh().n_dofs()).enumerate();
        of_mesh.for_each(|(dof, own)| *own -= mean(dof % 3));
        relative
    })
}

/// The rigid motion that fits that of a body.
struct RigidFit {
    /// Centres of mass in the reference configuration and now, and the velocity of the latter.
    centres: [[f64; 3]; 3],
    /// R.
    rotation: Mat3<f64>,
    /// Spin in the axes of the body turned back, `R^T w`.
    spin: [f64; 3],
}

impl RigidFit {
    fn new(body: &Body, displacement: &[f64], velocity: &[f64]) -> Self {
        let points = body.mesh().points();
        let nodes = || body.space.own_nodes().take_while(|node| *node < points.len());
        let mass = |node: usize| body.lumped_mass()[node];
        let vectors = |node: usize| {
            let (X, u) = (points[node], nodal::at(displacement, node));
            [X, three(|d| X[d] + u[d]), nodal::at(velocity, node)]
        };
        let mut sums = [0.0; 10];
        for node in nodes() {
            sums[9] += mass(node);
            let own = vectors(node);
            sums.iter_mut().zip(own.as_flattened()).for_each(|(sum, x)| *sum += mass(node) * x);
        }
        body.space.sum_ranks("centre of mass", &mut sums);
        let centres = [0, 1, 2].map(|which| three(|d| sums[3 * which + d] / sums[9]));
        let about = |node: usize| {
            let own = vectors(node);
            [0, 1, 2].map(|which| three(|d| own[which][d] - centres[which][d]))
        };
        // The sum of m a b^T over the nodes.
        let products = |pair: &dyn Fn([[f64; 3]; 3]) -> [[f64; 3]; 2]| {
            let mut sum = Mat3::default();
            for node in nodes() {
                let [a, b] = pair(about(node));
                (0..9).for_each(|i| sum[i / 3][i % 3] += mass(node) * a[i / 3] * b[i % 3]);
            }
            body.space.sum_ranks("moments of mass", sum.as_flattened_mut());
            sum
        };
        let rotation = polar(&products(&|[Z, r, _]| [r, Z]));
        let back = transposed(&rotation);
        // The condition of the fit, sum m Z x R^T r = 0, holds at all times.
        let inertia = products(&|[Z, r, _]| [image(&back, &r), Z]);
        let moments = products(&|[Z, _, v]| [image(&back, &v), Z]);
        let spin = fitted_spin(&inertia, &moments, [true; 3]).unwrap_or_default();
        RigidFit { centres, rotation, spin }
    }

    fn seen(&self, body: &Body, displacement: &[f64], velocity: &[f64]) -> [Vec<f64>; 2] {
        let (RigidFit { centres: [C, c, v_c], spin, .. }, points) = (self, body.mesh().points());
        let back = transposed(&self.rotation);
        // Internal nodes of cells, which come last, are no places.
        let [mut relative, mut rates] = [displacement, velocity].map(<[f64]>::to_vec);
        for (node, X) in points.iter().enumerate() {
            let (u, v) = (nodal::at(displacement, node), nodal::at(velocity, node));
            let y = image(&back, &three(|d| X[d] + u[d] - c[d]));
            let rate = image(&back, &three(|d| v[d] - v_c[d]));
            let turned = cross(*spin, y);
            *nodal::at_mut(&mut relative, node) = three(|d| y[d] - (X[d] - C[d]));
            *nodal::at_mut(&mut rates, node) = three(|d| rate[d] - turned[d]);
        }
        [relative, rates]
    }
}
