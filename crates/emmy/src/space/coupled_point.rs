//! Points of distributing couplings.

use super::geometry::add_facet_areas;
use crate::error::{Error, Result};
use crate::input::Coupling;
use crate::mesh::Mesh;
use crate::nodal;
use crate::number::{short, short_vector};
use crate::tensor::{dot3, eigen};

/// The point of a distributing coupling, a node without cells: it moves with the affine mean of other nodes.
///
/// ```
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
/// let middle = Coupling::new("middle", "x-max", [1.0, 0.5, 0.5]);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).coupling(middle).build()?;
/// let point = &body.couplings()[0];
/// assert_eq!((point.name.as_str(), point.node, point.weights.len()), ("middle", 8, 4));
/// assert!(point.weights.iter().all(|(_, weight)| (weight - 0.25).abs() < 1e-15));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledPoint {
    /// Name of the coupling.
    pub name: String,
    /// Its node.
    pub node: u32,
    /// The nodes with their weights, which sum to 1.
    pub weights: Vec<(u32, f64)>,
    /// Whether it has an equation of its own, and one of the nodes follows it and the others. Then masses, springs,
    /// supports and joints act at the point itself; else it follows, and carries forces alone.
    pub leads: bool,
}

/// Part of the largest second moment, or of the square of the size, that is rounding.
const FLAT: f64 = 1e-9;

/// Largest number of nodes that are all coupled with each other.
const MOST_NODES: usize = 2000;

impl CoupledPoint {
    /// The point of a coupling with the number of its node; `section`: thickness of each cell.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`]; [`Error::Coupling`] for weights that are not positive or not as many as nodes, a point
    /// off the plane or line of its nodes, or too many nodes for a point that leads.
    pub(crate) fn new(
        coupling: &Coupling,
        node: u32,
        (mesh, section): (&Mesh, &[f64]),
        leads: bool,
    ) -> Result<Self> {
        let Coupling { name, group, point, .. } = coupling;
        let fault = |reason: String| Error::Coupling { coupling: name.clone(), reason };
        let fail = |reason: String| Err(fault(reason));
        if let Some(x) = point.iter().find(|x| !x.is_finite()) {
            return fail(format!("its point has the coordinate {x}"));
        }
        let nodes = mesh.group_nodes(group)?;
        let parts = parts(coupling, &nodes, (mesh, section)).map_err(fault)?;
        if nodes.is_empty() {
            return fail(format!("the group \"{group}\" is empty"));
        }
        let places: Vec<[f64; 3]> = nodes.iter().map(|node| mesh.points()[*node as usize]).collect();
        let affine = affine_weights(*point, &places, &parts, FLAT * mesh.diagonal()).map_err(|off| {
            let what = if off.is_of_plane { "a plane" } else { "a line" };
            fault(format!(
                "the nodes of \"{group}\" lie in {what}, and the point {} is {} off; put it there, or couple it rigidly",
                short_vector(*point),
                short(off.distance)
            ))
        })?;
        let weights: Vec<(u32, f64)> = nodes.into_iter().zip(affine).filter(|own| own.1 != 0.0).collect();
        if leads && weights.len() > MOST_NODES {
            return fail(format!(
                "a mass, spring, support or joint at its point connects all {} nodes of \"{group}\" with each other; \
                 the limit is {MOST_NODES}: take fewer nodes, or couple them rigidly",
                weights.len()
            ));
        }
        Ok(CoupledPoint { name: name.clone(), node, weights, leads })
    }

    /// The follower with its leaders: the point, or if it leads the node with the largest weight of those that are
    /// free; `None` without such a node.
    pub(super) fn follower(&self, is_free: impl Fn(u32) -> bool) -> Option<(u32, Vec<(u32, f64)>)> {
        if !self.leads {
            return Some((self.node, self.weights.clone()));
        }
        let free = self.weights.iter().filter(|(node, _)| is_free(*node));
        let &(follower, largest) = free.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let others = self.weights.iter().filter(|(node, _)| *node != follower);
        let others = others.map(|(node, weight)| (*node, -weight / largest));
        Some((follower, others.chain([(self.node, 1.0 / largest)]).collect()))
    }

    /// Sets a nodal vector `[n_nodes][3]` at the point to the mean over its nodes.
    pub(super) fn set_mean(&self, vector: &mut [f64]) {
        let mut sum = [0.0; 3];
        for &(node, weight) in &self.weights {
            let own = nodal::at(vector, node as usize);
            (0..3).for_each(|d| sum[d] += weight * own[d]);
        }
        *nodal::at_mut(vector, self.node as usize) = sum;
    }
}

/// A point that is off the plane or the line of some places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OffPlane {
    /// Distance from it.
    pub distance: f64,
    /// Whether the places lie in a plane, and not on a line.
    pub is_of_plane: bool,
}

/// Weights with which a point X moves as the affine mean of places, of which each has a part v, one in sum.
///
/// ```math
/// w_A = v_A (1 + s · (X_A − X̄)),   J s = X − X̄,   J = Σ v_A (X_A − X̄) ⊗ (X_A − X̄)
/// ```
///
/// `rounding`: a distance below which the point is not off the plane of the places.
///
/// ```
/// use emmy::internals::body::affine_weights;
/// let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
/// let weights = affine_weights([1.5, 0.0, 0.0], &line, &[0.25, 0.5, 0.25], 0.0).unwrap();
/// assert!(weights.iter().zip([0.0, 0.5, 0.5]).all(|(weight, due)| (weight - due).abs() < 1e-15));
/// let off = affine_weights([1.5, 0.25, 0.0], &line, &[0.25, 0.5, 0.25], 0.0).unwrap_err();
/// assert_eq!((off.distance, off.is_of_plane), (0.25, false));
/// ```
///
/// # Errors
/// [`OffPlane`].
#[allow(non_snake_case)]
pub fn affine_weights(
    point: [f64; 3],
    places: &[[f64; 3]],
    parts: &[f64],
    rounding: f64,
) -> std::result::Result<Vec<f64>, OffPlane> {
    let Some(origin) = places.first() else { return Ok(Vec::new()) };
    let sum = |of: &dyn Fn(&[f64; 3]) -> f64| -> f64 {
        places.iter().zip(parts).map(|(place, part)| part * of(place)).sum()
    };
    // About a place, so that places far from the origin keep their digits.
    let mean = [0, 1, 2].map(|d| origin[d] + sum(&|X| X[d] - origin[d]));
    let J = |i: usize, j: usize| sum(&|X| (X[i] - mean[i]) * (X[j] - mean[j]));
    let (moments, axes) = eigen(&[J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(1, 2), J(0, 2)]);
    let largest = moments.iter().fold(0.0f64, |most, moment| most.max(*moment));
    let arm = [0, 1, 2].map(|d| point[d] - mean[d]);
    let mut slope = [0.0; 3];
    for (k, moment) in moments.into_iter().enumerate() {
        let axis = [0, 1, 2].map(|d| axes[d][k]);
        let along = dot3(arm, axis);
        if moment > FLAT * largest && moment > 0.0 {
            (0..3).for_each(|d| slope[d] += along / moment * axis[d]);
        } else if along.abs() > FLAT.sqrt() * largest.sqrt() + rounding {
            let n_flat = moments.iter().filter(|moment| **moment <= FLAT * largest).count();
            return Err(OffPlane { distance: along.abs(), is_of_plane: n_flat == 1 });
        }
    }
    let weight = |(place, part): (&[f64; 3], &f64)| {
        let arm = [0, 1, 2].map(|d| place[d] - mean[d]);
        part * (1.0 + dot3(slope, arm))
    };
    Ok(places.iter().zip(parts).map(weight).collect())
}

/// Checks that the point of a distributing coupling can follow its group in a mesh.
///
/// # Errors
/// [`Error::UnknownGroup`], [`Error::Coupling`].
pub fn check_coupling(mesh: &Mesh, coupling: &Coupling) -> Result<()> {
    CoupledPoint::new(coupling, u32::MAX, (mesh, &vec![1.0; mesh.n_cells()]), false).map(drop)
}

/// The parts v_A of the nodes of a coupling, which sum to 1.
fn parts(
    coupling: &Coupling,
    nodes: &[u32],
    (mesh, section): (&Mesh, &[f64]),
) -> std::result::Result<Vec<f64>, String> {
    let Coupling { group, weights, .. } = coupling;
    let mut parts = match weights {
        Some(weights) => {
            if weights.len() != nodes.len() {
                let [given, due] = [weights.len(), nodes.len()];
                return Err(format!("it has {given} weights for the {due} nodes of \"{group}\""));
            }
            if let Some(weight) = weights.iter().find(|weight| !(**weight > 0.0 && weight.is_finite())) {
                return Err(format!("its weights must be positive and finite, not {}", short(*weight)));
            }
            weights.clone()
        }
        None if mesh.groups().kinds(group).contains(&"facets") => {
            let mut areas = vec![0.0; mesh.n_nodes()];
            let facets = mesh.groups().facets(group).unwrap_or_default();
            add_facet_areas(mesh, facets, section, &mut areas);
            nodes.iter().map(|node| areas[*node as usize]).collect()
        }
        None => vec![1.0; nodes.len()],
    };
    let sum: f64 = parts.iter().sum();
    parts.iter_mut().for_each(|part| *part /= sum);
    Ok(parts)
}
