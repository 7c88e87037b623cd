//! Nodes that follow others.
//!
//! A follower s moves with its leaders, `u_s = sum_A w_A u_A`, or u = T u of the others. It has no equation: masses,
//! forces and stiffnesses are those of the leaders, `T^T M T`, `T^T f`, `T^T K T`. With `sum_A w_A = 1` and
//! `X_s = sum_A w_A X_A` the reduced body has all rigid motions, so every balance holds as it stands.
//!
//! Vectors keep all nodes. At followers, masses, momenta and forces are zero; displacements, rates and velocities are
//! those of [`Ties::follow`].

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::coupled_point::CoupledPoint;
use crate::error::{Error, Result};
use crate::input::{Tie, TieKind};
use crate::mesh::{Facet, Mesh, Nearest, Patch, distance, mortar};
use crate::nodal;
use crate::number::{short, short_vector};
use crate::sparse::{Couplings, Pattern, StageMatrix};

/// Followers with their leaders and weights.
#[derive(Debug, Clone, Default)]
pub(crate) struct Ties {
    /// Followers, ascending.
    followers: Vec<u32>,
    /// Where the leaders of each begin, and the end of all.
    begin: Vec<usize>,
    leaders: Vec<(u32, f64)>,
    summaries: Vec<TieSummary>,
    /// Rigid bodies with the nodes that follow them, ascending.
    bodies: Vec<(String, Vec<u32>)>,
    /// Points of distributing couplings.
    points: Vec<CoupledPoint>,
}

/// Nodes that follow a rigid body, ascending.
#[derive(Debug)]
pub(crate) struct RigidFollowers {
    /// Name of the body.
    pub body: String,
    /// The nodes with their leaders.
    pub nodes: Vec<(u32, Vec<(u32, f64)>)>,
}

/// Numbers of a tie.
///
/// ```
/// use emmy::prelude::*;
/// let points = [0.0, 1.0, 1.02, 2.0].map(|x| [x, 0.0, 0.0]);
/// let bars = Mesh::from_cells(CellKind::Line2, &points, &[[0, 1], [2, 3]])?
///     .with_node_group("end", [1])?
///     .with_node_group("start", [2])?;
/// let bar = Region::links(Link::bar(200.0, 0.5)?, 1.0);
/// let body = Body::builder(bars).region(bar).tie(Tie::nodes("start", "end")).build()?;
/// assert_eq!(body.ties()[0].n_followers, 1);
/// assert!((body.ties()[0].largest_shift - 0.02).abs() < 1e-15);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct TieSummary {
    /// Group of the nodes that follow.
    pub follower: String,
    /// Group that they follow.
    pub leader: String,
    /// How the weights were found.
    pub kind: TieKind,
    /// Number of nodes that follow.
    pub n_followers: usize,
    /// Number of nodes of the group that stay free.
    pub n_free: usize,
    /// Largest distance by which a follower was moved in the reference configuration \[length\].
    pub largest_shift: f64,
}

/// Distances below this part of the diagonal of the mesh are rounding of coordinates.
const ROUNDING: f64 = 1e-9;

/// Distances below this part of it are rounding of integrals.
const ROUNDING_OF_INTEGRALS: f64 = 1e-14;

/// The leaders of followers, while they are collected.
type Leaders = BTreeMap<u32, Vec<(u32, f64)>>;

impl Ties {
    /// Finds the leaders of all followers, and moves the followers to the points that they follow. Nodes that are
    /// `held` do not follow the point of a distributing coupling.
    ///
    /// # Errors
    /// [`Error::UnknownGroup`]; [`Error::Tie`] for a follower too far from its leader, of two ties or a tie and a rigid
    /// body, or that leads back; [`Error::Rigid`] for a follower of two rigid bodies; [`Error::Coupling`] for a point
    /// that leads without a free node.
    pub(crate) fn new(
        mesh: &mut Mesh,
        ties: &[Tie],
        rigid: Vec<RigidFollowers>,
        (points, held): (Vec<CoupledPoint>, &[bool]),
    ) -> Result<Self> {
        let mut all = Leaders::new();
        let mut number_of = BTreeMap::new();
        let mut bodies: Vec<(String, Vec<u32>)> = Vec::new();
        for RigidFollowers { body, nodes } in rigid {
            if let Some((node, _)) = nodes.iter().find(|(node, _)| all.contains_key(node)) {
                let (at, other) = (place(mesh, *node), body_of(&bodies, *node).unwrap_or_default());
                let reason =
                    format!("its node at {at} belongs to \"{other}\", too; make them one body, or join them");
                return Err(Error::Rigid { body, reason });
            }
            bodies.push((body, nodes.iter().map(|(node, _)| *node).collect()));
            all.extend(nodes);
        }
        let mut kinds = Vec::with_capacity(ties.len());
        for (number, tie) in ties.iter().enumerate() {
            let (kind, found) = of_tie(mesh, number, tie)?;
            kinds.push((kind, mesh.group_nodes(&tie.follower)?.len() - found.len()));
            for (node, weights) in found {
                if let Some(body) = body_of(&bodies, node) {
                    let at = place(mesh, node);
                    let reason = format!(
                        "its node at {at} belongs to the rigid body \"{body}\" and follows that; swap follower and \
                         leader"
                    );
                    return Err(fault(number, tie, reason));
                }
                if let Some(other) = number_of.insert(node, number) {
                    let other: &Tie = &ties[other];
                    let reason = format!(
                        "its node at {} follows \"{}\" too; a node follows once",
                        place(mesh, node),
                        other.leader
                    );
                    return Err(fault(number, tie, reason));
                }
                all.insert(node, weights);
            }
        }
        add_points(mesh, &mut all, &points, held)?;
        compose(&mut all, ties.len() + bodies.len().min(1) + points.len()).map_err(|node| {
            let reason = format!("its node at {} leads and follows in a circle", place(mesh, node));
            match (number_of.get(&node), points.first()) {
                (Some(&number), _) => fault(number, &ties[number], reason),
                (None, Some(point)) => Error::Coupling { coupling: point.name.clone(), reason },
                (None, None) => Error::Rigid { body: String::new(), reason },
            }
        })?;
        let mut summaries: Vec<TieSummary> = ties.iter().zip(kinds).map(TieSummary::new).collect();
        let (mut followers, mut begin, mut leaders) = (Vec::new(), vec![0], Vec::new());
        for (node, own) in all {
            // Nodes of rigid bodies are where they are.
            if let Some(&number) = number_of.get(&node) {
                let mut X = [0.0; 3];
                for &(leader, weight) in &own {
                    (0..3).for_each(|d| X[d] += weight * mesh.points()[leader as usize][d]);
                }
                let summary = &mut summaries[number];
                let shift = distance(X, mesh.points()[node as usize]);
                summary.n_followers += 1;
                summary.largest_shift = summary.largest_shift.max(shift);
                // Integrals have rounding that coordinates need not have.
                if summary.kind == TieKind::Nodes || shift > ROUNDING_OF_INTEGRALS * mesh.diagonal() {
                    mesh.move_node(node as usize, X);
                }
            }
            followers.push(node);
            leaders.extend(own);
            begin.push(leaders.len());
        }
        Ok(Ties { followers, begin, leaders, summaries, bodies, points })
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.followers.is_empty()
    }

    /// The points of distributing couplings.
    pub(crate) fn points(&self) -> &[CoupledPoint] {
        &self.points
    }

    /// Sets velocities `[n_nodes][3]` at points of couplings that lead to the mean over their nodes.
    pub(crate) fn set_points(&self, velocity: &mut [f64]) {
        self.points.iter().filter(|point| point.leads).for_each(|point| point.set_mean(velocity));
    }

    /// A summary of each tie.
    pub(crate) fn summaries(&self) -> &[TieSummary] {
        &self.summaries
    }

    /// Followers, ascending.
    pub(crate) fn followers(&self) -> &[u32] {
        &self.followers
    }

    /// Name of the rigid body that a node of the mesh belongs to.
    pub(crate) fn body_of(&self, node: u32) -> Option<&str> {
        body_of(&self.bodies, node)
    }

    /// Degrees of freedom of the followers.
    pub(crate) fn dofs(&self) -> impl Iterator<Item = usize> {
        self.followers.iter().flat_map(|&node| nodal::dofs(node as usize))
    }

    /// The leaders of a node with their weights, if it follows.
    pub(crate) fn leaders_of(&self, node: u32) -> Option<&[(u32, f64)]> {
        let at = self.followers.binary_search(&node).ok()?;
        Some(&self.leaders[self.begin[at]..self.begin[at + 1]])
    }

    /// Followers with their leaders.
    fn iter(&self) -> impl Iterator<Item = (usize, &[(u32, f64)])> {
        let leaders = self.begin.windows(2).map(|range| &self.leaders[range[0]..range[1]]);
        self.followers.iter().map(|&node| node as usize).zip(leaders)
    }

    /// Sets nodal vectors at followers to those of their leaders, `[k][n_nodes][3]`.
    pub(crate) fn follow(&self, vectors: &mut [f64], n_dofs: usize) {
        for (node, leaders) in self.iter() {
            for vector in vectors.chunks_exact_mut(n_dofs) {
                let mut sum = [0.0; 3];
                for &(leader, weight) in leaders {
                    let own = nodal::at(vector, leader as usize);
                    (0..3).for_each(|d| sum[d] += weight * own[d]);
                }
                *nodal::at_mut(vector, node) = sum;
            }
        }
    }

    /// Moves forces at followers to their leaders, `[k][n_nodes][3]`.
    pub(crate) fn gather(&self, forces: &mut [f64], n_dofs: usize) {
        for (node, leaders) in self.iter() {
            for force in forces.chunks_exact_mut(n_dofs) {
                let own = std::mem::take(nodal::at_mut(force, node));
                for &(leader, weight) in leaders {
                    let sum = nodal::at_mut(force, leader as usize);
                    (0..3).for_each(|d| sum[d] += weight * own[d]);
                }
            }
        }
    }

    /// Moves the stage forces at followers to their leaders, and with `blocks` their rows and columns of the matrix.
    pub(crate) fn fold(&self, pattern: &Pattern, matrix: &mut StageMatrix, blocks: bool) {
        for (node, leaders) in self.iter() {
            matrix.fold_force(node, leaders);
            if blocks && is_coupled(pattern, node) {
                matrix.fold_row(pattern, node, leaders);
            }
        }
        if blocks {
            let coupled = self.iter().filter(|(node, _)| is_coupled(pattern, *node));
            coupled.for_each(|(node, leaders)| matrix.fold_column(pattern, node, leaders));
        }
    }

    /// Moves couplings of followers to their leaders.
    pub(crate) fn fold_couplings(&self, couplings: &mut Couplings) {
        if !self.is_empty() {
            couplings.fold(|node| self.leaders_of(node));
        }
    }

    /// `T^T M T` for a mass of each coupling.
    pub(crate) fn fold_mass(&self, pattern: &Pattern, mass: &mut [f64]) {
        for (node, leaders) in self.iter().filter(|(node, _)| is_coupled(pattern, *node)) {
            for (from, &column) in pattern.range(node).zip(pattern.row(node)) {
                let own = std::mem::take(&mut mass[from]);
                for &(leader, weight) in leaders {
                    mass[pattern.coupling(leader as usize, column as usize)] += weight * own;
                }
            }
        }
        for (node, leaders) in self.iter().filter(|(node, _)| is_coupled(pattern, *node)) {
            for row in pattern.row(node).iter().map(|&row| row as usize) {
                let own = std::mem::take(&mut mass[pattern.coupling(row, node)]);
                for &(leader, weight) in leaders {
                    mass[pattern.coupling(row, leader as usize)] += weight * own;
                }
            }
        }
    }

    /// Moves lumped masses to the leaders, in proportion to the moduli of their weights: those of quadratic facets may
    /// be negative.
    pub(crate) fn fold_lumped(&self, masses: &mut [f64]) {
        for (node, leaders) in self.iter() {
            let mass = std::mem::take(&mut masses[node]);
            let sum: f64 = leaders.iter().map(|(_, weight)| weight.abs()).sum();
            leaders.iter().for_each(|&(leader, weight)| masses[leader as usize] += mass * weight.abs() / sum);
        }
    }
}

/// Whether a node has couplings with others: points of distributing couplings that follow have neither mass nor
/// stiffness.
fn is_coupled(pattern: &Pattern, node: usize) -> bool {
    pattern.row(node).len() > 1
}

impl TieSummary {
    fn new((tie, (kind, n_free)): (&Tie, (TieKind, usize))) -> Self {
        let Tie { follower, leader, .. } = tie.clone();
        TieSummary { follower, leader, kind, n_followers: 0, n_free, largest_shift: 0.0 }
    }
}

/// Moves the points of couplings to the means that they follow, and adds their followers.
fn add_points(mesh: &mut Mesh, all: &mut Leaders, points: &[CoupledPoint], held: &[bool]) -> Result<()> {
    for (number, point) in points.iter().enumerate() {
        let mut X = [0.0; 3];
        for &(node, weight) in &point.weights {
            (0..3).for_each(|d| X[d] += weight * mesh.points()[node as usize][d]);
        }
        mesh.move_node(point.node as usize, X);
        // A node in two couplings would lead to a circle.
        let is_shared = |node: u32| {
            let others = points.iter().enumerate().filter(|(other, point)| *other != number && point.leads);
            others.flat_map(|(_, point)| &point.weights).any(|(other, _)| *other == node)
        };
        let is_free = |node: u32| !all.contains_key(&node) && !held[node as usize] && !is_shared(node);
        let Some((follower, leaders)) = point.follower(is_free) else {
            let reason = "each of its nodes is held, tied, in a rigid body or in another coupling, so none can follow \
                          its point, which has a mass, a spring, a support or a joint";
            return Err(Error::Coupling { coupling: point.name.clone(), reason: reason.to_string() });
        };
        all.insert(follower, leaders);
    }
    Ok(())
}

/// The kind of a tie, and its followers with the weights of their leaders.
fn of_tie(mesh: &Mesh, number: usize, tie: &Tie) -> Result<(TieKind, Leaders)> {
    if let Some(weights) = &tie.weights {
        return Ok((TieKind::Nodes, weighted(mesh, number, tie, weights)?));
    }
    let nearest = nearest(mesh, number, tie)?;
    let facets = [&tie.follower, &tie.leader].map(|group| facets(mesh, group));
    let unfit = facets.iter().position(|facets| facets.is_empty());
    let kind = tie.kind.unwrap_or(if unfit.is_none() { TieKind::Mortar } else { TieKind::Nodes });
    let mut surfaces = match (kind, unfit) {
        (TieKind::Mortar, Some(side)) => {
            let group = [&tie.follower, &tie.leader][side];
            let reason = format!("mortar joins facets, and \"{group}\" has none");
            return Err(fault(number, tie, format!("{reason}; kind = \"nodes\" joins all")));
        }
        (TieKind::Mortar, None) => mortar(mesh, facets, tie.tolerance),
        (TieKind::Nodes, _) => BTreeMap::new(),
    };
    // A node that no leader covers follows the nearest point.
    let weights = |(node, own): (u32, Nearest)| (node, surfaces.remove(&node).unwrap_or(own.weights));
    Ok((kind, nearest.into_iter().map(weights).collect()))
}

/// The follower of a tie with given weights.
fn weighted(mesh: &Mesh, number: usize, tie: &Tie, weights: &[f64]) -> Result<Leaders> {
    let (followers, leaders) = (mesh.group_nodes(&tie.follower)?, mesh.group_nodes(&tie.leader)?);
    let fail = |reason: String| Err(fault(number, tie, reason));
    let [node] = followers[..] else {
        return fail(format!(
            "weights are those of one follower, and \"{}\" has {}",
            tie.follower,
            followers.len()
        ));
    };
    if weights.len() != leaders.len() {
        return fail(format!("it has {} weights for {} leaders", weights.len(), leaders.len()));
    }
    if leaders.binary_search(&node).is_ok() {
        return fail(format!("both have the node at {}; a tie joins different nodes", place(mesh, node)));
    }
    let sum: f64 = weights.iter().sum();
    // Not a number is no one, either.
    let is_one = (sum - 1.0).abs() <= SUM_OF_WEIGHTS;
    if !is_one {
        return fail(format!("its weights sum to {}, not to 1", short(sum)));
    }
    let own: Vec<(u32, f64)> = leaders.into_iter().zip(weights.iter().map(|weight| weight / sum)).collect();
    let mut X = [0.0; 3];
    for &(leader, weight) in &own {
        (0..3).for_each(|d| X[d] += weight * mesh.points()[leader as usize][d]);
    }
    let shift = distance(X, mesh.points()[node as usize]);
    let edge = shortest_edges(mesh, &followers).get(&node).copied().unwrap_or(0.0);
    if shift > tie.tolerance * edge + ROUNDING * mesh.diagonal() {
        return fail(format!(
            "its node at {} is {} away from the point of its weights, {}",
            place(mesh, node),
            short(shift),
            short_vector(X)
        ));
    }
    Ok(Leaders::from([(node, own)]))
}

/// Difference of the sum of weights from 1 that decks with six digits have.
const SUM_OF_WEIGHTS: f64 = 1e-5;

/// The followers of a tie with the nearest points of the leader.
fn nearest(mesh: &Mesh, number: usize, tie: &Tie) -> Result<Vec<(u32, Nearest)>> {
    if !(tie.tolerance >= 0.0 && tie.tolerance.is_finite()) {
        let reason =
            format!("its tolerance must be a finite number of at least 0, not {}", short(tie.tolerance));
        return Err(fault(number, tie, reason));
    }
    let mut followers = mesh.group_nodes(&tie.follower)?;
    let leaders = mesh.group_nodes(&tie.leader)?;
    if tie.partial {
        followers.retain(|node| leaders.binary_search(node).is_err());
    }
    if let Some(&node) = followers.iter().find(|node| leaders.binary_search(node).is_ok()) {
        let reason = format!("both have the node at {}; a tie joins different nodes", place(mesh, node));
        return Err(fault(number, tie, reason));
    }
    let patches = patches(mesh, &tie.leader);
    let point = |node: u32| mesh.points()[node as usize];
    let edges = if patches.is_empty() { shortest_edges(mesh, &followers) } else { BTreeMap::new() };
    let nearest = |&node: &u32| {
        let X = point(node);
        if patches.is_empty() {
            let nodes = leaders.iter().map(|&leader| (leader, distance(point(leader), X)));
            let (leader, distance) = nodes.min_by(|a, b| a.1.total_cmp(&b.1))?;
            let size = edges.get(&node).copied().unwrap_or(0.0);
            return Some((node, Nearest { weights: vec![(leader, 1.0)], distance, size }));
        }
        let reach = patches.iter().map(|patch| patch.bounds(X)[1]).fold(f64::INFINITY, f64::min);
        let near = patches.iter().filter(|patch| patch.bounds(X)[0] <= reach);
        let found = near.map(|patch| patch.nearest(X)).min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        Some((node, found))
    };
    let mut found: Vec<(u32, Nearest)> = followers.par_iter().filter_map(nearest).collect();
    let rounding = ROUNDING * mesh.diagonal();
    let is_far = |(_, nearest): &(u32, Nearest)| nearest.distance > tie.tolerance * nearest.size + rounding;
    if tie.partial {
        found.retain(|own| !is_far(own));
    }
    let Some((node, nearest)) = found.iter().find(|own| is_far(own)) else { return Ok(found) };
    let hint = match patches.is_empty() {
        true => "nodes must meet: name facets or cells to follow, or is there nothing to tie?",
        false => "is there nothing to tie?",
    };
    let reason = format!(
        "its node at {} is {} away, and the limit is {} (tolerance {} x edge {}); {hint}",
        place(mesh, *node),
        short(nearest.distance),
        short(tie.tolerance * nearest.size),
        short(tie.tolerance),
        short(nearest.size)
    );
    Err(fault(number, tie, reason))
}

/// The facets of a group; empty if it has none.
fn facets<'m>(mesh: &'m Mesh, group: &str) -> &'m [Facet] {
    let has_facets = mesh.groups().kinds(group).contains(&"facets");
    if has_facets { mesh.groups().facets(group).unwrap_or_default() } else { &[] }
}

/// The facets of a group, else its cells; empty if it is one of nodes.
fn patches(mesh: &Mesh, group: &str) -> Vec<Patch> {
    let facets = facets(mesh, group);
    if !facets.is_empty() {
        return facets.iter().map(|&facet| Patch::of_facet(mesh, facet)).collect();
    }
    let is_of_nodes = mesh.groups().kinds(group).contains(&"nodes");
    let cells = if is_of_nodes { &[] } else { mesh.groups().cells(group).unwrap_or_default() };
    cells.iter().map(|&cell| Patch::of_cell(mesh, cell as usize)).collect()
}

/// The shortest distance from each of some nodes to another node of its cells.
fn shortest_edges(mesh: &Mesh, nodes: &[u32]) -> BTreeMap<u32, f64> {
    let mut shortest = BTreeMap::new();
    for cell in mesh.cells() {
        for &node in cell.nodes.iter().filter(|node| nodes.binary_search(node).is_ok()) {
            let X = mesh.points()[node as usize];
            let others = cell.nodes.iter().filter(|other| **other != node);
            let own = others.map(|&other| distance(mesh.points()[other as usize], X));
            let least: &mut f64 = shortest.entry(node).or_insert(f64::INFINITY);
            *least = own.fold(*least, f64::min);
        }
    }
    shortest
}

fn body_of(bodies: &[(String, Vec<u32>)], node: u32) -> Option<&str> {
    let own = bodies.iter().find(|(_, nodes)| nodes.binary_search(&node).is_ok());
    own.map(|(name, _)| name.as_str())
}

/// Replaces leaders that follow themselves by their leaders; the error is a node that leads itself.
fn compose(all: &mut Leaders, n_ties: usize) -> std::result::Result<(), u32> {
    // A chain has each tie once at most.
    for pass in 0..=n_ties {
        let follows = |own: &[(u32, f64)]| own.iter().any(|(leader, _)| all.contains_key(leader));
        let chained: Vec<u32> = all.iter().filter(|(_, own)| follows(own)).map(|(&node, _)| node).collect();
        match chained.first() {
            None => return Ok(()),
            Some(&node) if pass == n_ties => return Err(node),
            Some(_) => {}
        }
        for node in chained {
            let mut sums = BTreeMap::new();
            for &(leader, weight) in &all[&node] {
                match all.get(&leader) {
                    None => *sums.entry(leader).or_insert(0.0) += weight,
                    Some(others) => others.iter().for_each(|&(other, share)| {
                        *sums.entry(other).or_insert(0.0) += weight * share;
                    }),
                }
            }
            all.insert(node, sums.into_iter().collect());
        }
    }
    Ok(())
}

fn place(mesh: &Mesh, node: u32) -> String {
    short_vector(mesh.points()[node as usize])
}

fn fault(number: usize, tie: &Tie, reason: String) -> Error {
    let Tie { follower, leader, .. } = tie.clone();
    Error::Tie { number, follower, leader, reason }
}
