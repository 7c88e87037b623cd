//! Rigid motions that neither supports nor the ground hold.

use super::couplings;
use super::forces::Assembly;
use super::system::Body;
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::force::{Force, StepInput};
use crate::mesh::Mesh;
use crate::nodal;
use crate::number::short_vector;
use crate::quadrature::gauss;
use crate::sparse::null_space;
use crate::tensor::cross;
use crate::unknowns::Component;

/// Components of a rigid motion: rotations about x, y, z through a centre, then translations along x, y, z.
pub(super) const MOTIONS: usize = 6;

/// Rotations, angles and distances below this part of the size of a part count as zero.
const ROUNDING: f64 = 1e-6;

/// Angle, or distance over the radius of a part, of a motion that tests the force of the ground; the smaller ones are
/// for surfaces so near to an obstacle that they would pass.
const DIFFERENCE_STEPS: [f64; 3] = [1e-4, 1e-6, 1e-8];

/// A rigid motion, by its components; rotations are distances at the radius of the part.
pub(super) type Twist = [f64; MOTIONS];

impl Body {
    /// Checks that supports, springs, attractions and joints hold each connected part of the body in the reference
    /// configuration.
    ///
    /// # Errors
    /// [`Error::NotHeld`] names the rigid motions that are free.
    pub(crate) fn check_held(&self) -> Result<()> {
        if !self.mechanism.is_empty() {
            return self.check_mechanism_held();
        }
        let mut assembly = self.assembly(&Rule::standard(1, &gauss(1)));
        let parts = self.connected_parts();
        let n_parts = parts.len();
        for (cell, nodes) in parts {
            let part = Part::new(self, nodes);
            let free = part.free_motions(self, &mut assembly)?;
            if !free.is_empty() {
                let what = match n_parts {
                    1 => "the body".to_string(),
                    _ => format!("the part of the body with cell {cell}"),
                };
                let (motions, contacts) = (listed(&free), self.open_contacts(part.nodes()));
                return Err(Error::NotHeld { part: what, motions, contacts });
            }
        }
        Ok(())
    }

    /// The first cell of each connected part of the body, in the whole mesh, and its own nodes here, ascending; rigid
    /// bodies alone come last.
    pub(super) fn connected_parts(&self) -> Vec<(usize, Vec<u32>)> {
        if !self.space.is_shared() {
            return self.own_parts();
        }
        let nodes_of = |cells: &Vec<u32>| {
            let mut nodes: Vec<u32> =
                cells.iter().flat_map(|&cell| self.mesh().cell(cell as usize).nodes).copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        };
        let here: Vec<(Vec<u32>, Vec<u32>)> =
            self.mesh().parts().into_iter().map(|cells| (nodes_of(&cells), cells)).collect();
        let ranks = self.ranks();
        // The parts of all ranks that meet at guests get the lowest cell among them.
        let whole = |cells: &[u32]| cells.iter().map(|&cell| ranks.cells()[cell as usize]).min();
        let mut first = vec![f64::INFINITY; self.mesh().n_nodes()];
        for (nodes, cells) in &here {
            let own = whole(cells).map_or(f64::INFINITY, f64::from);
            nodes.iter().for_each(|&node| first[node as usize] = own);
        }
        let mut changed = [1.0];
        while changed[0] > 0.0 {
            let read = |first: &[f64], node: usize, number: &mut [f64]| number[0] = first[node];
            let write =
                |first: &mut [f64], node: usize, number: &[f64]| first[node] = first[node].min(number[0]);
            ranks.exchange("first cells", 1, &mut first[..], read, write);
            changed = [0.0];
            for (nodes, _) in &here {
                let lowest = nodes.iter().map(|&node| first[node as usize]).fold(f64::INFINITY, f64::min);
                for &node in nodes {
                    if first[node as usize] > lowest {
                        (first[node as usize], changed) = (lowest, [1.0]);
                    }
                }
            }
            ranks.largest("change of first cells", &mut changed);
        }
        let own = &first[..ranks.n_own()];
        let mut parts: Vec<(usize, Vec<u32>)> = Vec::new();
        loop {
            let last = parts.last().map_or(-1.0, |(cell, _)| *cell as f64);
            let next = own.iter().copied().filter(|cell| *cell > last && cell.is_finite());
            let next = next.reduce(f64::min).map(|cell| cell as usize);
            let Some(cell) = ranks.lowest("next part", next) else { return parts };
            let nodes = (0..).zip(own).filter(|(_, first)| **first == cell as f64).map(|(node, _)| node);
            parts.push((cell, nodes.collect()));
        }
    }

    /// The components that may turn on their own: those between joints, or else the parts of a body with contact that
    /// the stiffness does not couple. None if there is but one.
    pub(crate) fn turning_components(&self) -> Vec<Component> {
        let between_joints = &self.mechanism.components;
        if !between_joints.is_empty() || !self.has_bounds() {
            return between_joints.clone();
        }
        let mut coupled = couplings::of_cells(self.mesh(), self.space.internal(), self.space.ties());
        coupled.extend(self.mechanism.coupled_nodes());
        let parts = self.mechanism.connected(self.n_dofs() / 3, &coupled);
        if parts.len() > 1 { parts } else { Vec::new() }
    }

    /// The connected parts of a body that is no part of a team, without the nodes that follow others.
    fn own_parts(&self) -> Vec<(usize, Vec<u32>)> {
        let (mesh, ties) = (self.mesh(), self.space.ties());
        let of_cells = couplings::of_cells(mesh, self.space.internal(), ties);
        let components = self.mechanism.connected(self.n_dofs() / 3, &of_cells);
        let mut number_of = vec![0; self.n_dofs() / 3];
        for (number, component) in components.iter().enumerate() {
            component.nodes().for_each(|node| number_of[node] = number);
        }
        let mut first = vec![usize::MAX; components.len()];
        for (index, cell) in mesh.cells().enumerate() {
            let own = &mut first[number_of[cell.nodes[0] as usize]];
            *own = index.min(*own);
        }
        let leads = |node: &usize| *node < mesh.n_nodes() && ties.leaders_of(*node as u32).is_none();
        let nodes = |component: &Component| component.nodes().filter(leads).map(|node| node as u32).collect();
        let mut parts: Vec<(usize, Vec<u32>)> = first.into_iter().zip(components.iter().map(nodes)).collect();
        // Nodes without cells are no part, but for those of rigid bodies.
        let is_part = |cell: usize, node: u32| cell < usize::MAX || self.mechanism.is_rigid(node as usize);
        parts.retain(|(cell, nodes)| nodes.first().is_some_and(|&node| is_part(*cell, node)));
        parts.sort_by_key(|(cell, _)| *cell);
        parts
    }

    /// The contacts of a part, given by its nodes, ascending, that touch nothing in the reference configuration: the
    /// name of each, its smallest gap and its distance.
    pub(super) fn open_contacts(&self, nodes: &[u32]) -> Vec<(String, [f64; 2])> {
        let rest = vec![0.0; self.n_dofs()];
        let is_of_part = |force: &dyn Force| {
            let mut is_of_part = false;
            force.for_each_contact_node(&rest, &mut |node, _| {
                is_of_part |= nodes.binary_search(&(node as u32)).is_ok();
            });
            is_of_part
        };
        let forces = self.forces_of_contact();
        let open = forces.iter().filter_map(|force| {
            let own = force.contact().filter(|own| own.smallest_gap >= own.distance)?;
            is_of_part(&**force).then(|| (own.name.clone(), [own.smallest_gap, own.distance]))
        });
        open.collect()
    }

    /// Force of the contacts between bodies in the reference configuration.
    fn touching_force(&self, assembly: &mut Assembly) -> Result<Vec<f64>> {
        let rest = vec![0.0; self.n_dofs()];
        let rule = Rule::standard(1, &gauss(1));
        let mut force = rest.clone();
        self.touching_force_at(&StepInput::undamped(&rule, &rest, &rest), assembly, &mut force)?;
        Ok(force)
    }

    /// Force of springs and attractions on a displacement.
    fn ground_force_at(
        &self,
        displacement: &[f64],
        assembly: &mut Assembly,
        force: &mut [f64],
    ) -> Result<()> {
        let rest = vec![0.0; self.n_dofs()];
        let rule = Rule::standard(1, &gauss(1));
        let step = StepInput::undamped(&rule, displacement, &rest);
        self.ground_force(&step, assembly, force)
    }
}

/// A connected part of the mesh, with the own nodes of each rank.
pub(super) struct Part<'a> {
    mesh: &'a Mesh,
    nodes: Vec<u32>,
    centre: [f64; 3],
    radius: f64,
}

impl<'a> Part<'a> {
    pub(super) fn new(body: &'a Body, nodes: Vec<u32>) -> Self {
        let mesh = body.mesh();
        let mut n_nodes = [nodes.len() as f64];
        body.space.sum_ranks("nodes of a part", &mut n_nodes);
        let mut centre = [0.0; 3];
        for X in nodes.iter().map(|&node| mesh.points()[node as usize]) {
            (0..3).for_each(|d| centre[d] += X[d] / n_nodes[0]);
        }
        body.space.sum_ranks("centre of a part", &mut centre);
        let distance = |&node: &u32| {
            let X = mesh.points()[node as usize];
            (0..3).map(|d| (X[d] - centre[d]).powi(2)).sum::<f64>().sqrt()
        };
        let mut radius = [nodes.iter().map(distance).fold(0.0, f64::max)];
        body.space.largest_of_ranks("radius of a part", &mut radius);
        let [radius] = radius;
        Part { mesh, nodes, centre, radius: if radius > 0.0 { radius } else { 1.0 } }
    }

    /// Its nodes.
    pub(super) fn nodes(&self) -> &[u32] {
        &self.nodes
    }

    /// Displacement of a component of the node by each rigid motion.
    pub(super) fn row(&self, node: u32, component: usize) -> Twist {
        let X = self.mesh.points()[node as usize];
        let r = [0, 1, 2].map(|d| (X[d] - self.centre[d]) / self.radius);
        let mut row = [0.0; MOTIONS];
        for axis in 0..3 {
            let mut unit = [0.0; 3];
            unit[axis] = 1.0;
            row[axis] = cross(unit, r)[component];
        }
        row[3 + component] = 1.0;
        row
    }

    /// The free rigid motions, each named.
    fn free_motions(&self, body: &Body, assembly: &mut Assembly) -> Result<Vec<String>> {
        let free = reduced(null_space(&self.held(body, assembly)?)?);
        Ok(free.iter().map(|twist| self.name(twist, &[])).collect())
    }

    /// The square of the rigid motions that supports and the ground hold, and of those that move no node: zero for
    /// free ones.
    pub(super) fn held(&self, body: &Body, assembly: &mut Assembly) -> Result<[f64; MOTIONS * MOTIONS]> {
        let dofs = || self.nodes.iter().flat_map(|&node| (0..3).map(move |i| (node, i)));
        let mut all = Gram::default();
        let mut held = Gram::default();
        for (node, component) in dofs() {
            let row = self.row(node, component);
            all.add(&row, &row);
            if nodal::at(body.fixed(), node as usize)[component] {
                held.add(&row, &row);
            }
        }
        body.space.sum_ranks("motions of a part", &mut all.0);
        body.space.sum_ranks("motions that supports hold", &mut held.0);
        let mut sum = held.normalized();
        if body.has_ground() {
            sum.add_all(&self.ground(body, assembly)?.squared().normalized());
        }
        // How another body that touches it holds it depends on the shapes of both.
        if self.touches(body, assembly)? {
            for motion in 0..MOTIONS {
                let mut unit = [0.0; MOTIONS];
                unit[motion] = 1.0;
                sum.add(&unit, &unit);
            }
        }
        // Rotations that move no node, of a part on a line, need not be held.
        for idle in null_space(&all.normalized().0)? {
            sum.add(&idle, &idle);
        }
        Ok(sum.0)
    }

    /// Whether another body touches it in the reference configuration.
    fn touches(&self, body: &Body, assembly: &mut Assembly) -> Result<bool> {
        if body.contacts().next().is_none() {
            return Ok(false);
        }
        let force = body.touching_force(assembly)?;
        Ok(self.nodes.iter().any(|node| nodal::at(&force, *node as usize) != [0.0; 3]))
    }

    /// Derivatives of the force and the moment of the ground by the rigid motions, by central differences. Both are
    /// seen from the body: a motion around a centre of attraction does not change them.
    fn ground(&self, body: &Body, assembly: &mut Assembly) -> Result<Gram> {
        let [first, smaller @ ..] = DIFFERENCE_STEPS;
        let found = self.ground_by(body, assembly, first);
        smaller.into_iter().fold(found, |found, step| found.or_else(|_| self.ground_by(body, assembly, step)))
    }

    /// The same by differences of a step.
    fn ground_by(&self, body: &Body, assembly: &mut Assembly, step: f64) -> Result<Gram> {
        let mut gram = Gram::default();
        let mut displacement = vec![0.0; body.n_dofs()];
        let mut force = displacement.clone();
        for (motion, sign) in (0..MOTIONS).flat_map(|motion| [(motion, 1.0), (motion, -1.0)]) {
            let angle = if motion < 3 { sign * step } else { 0.0 };
            for &node in &self.nodes {
                let X = self.mesh.points()[node as usize];
                let r = [0, 1, 2].map(|d| X[d] - self.centre[d]);
                let turned = turned(r, motion % 3, angle);
                *nodal::at_mut(&mut displacement, node as usize) = [0, 1, 2].map(|d| turned[d] - r[d]);
                if motion >= 3 {
                    nodal::at_mut(&mut displacement, node as usize)[motion - 3] = sign * step * self.radius;
                }
            }
            body.space.follow(&mut displacement);
            body.ground_force_at(&displacement, assembly, &mut force)?;
            for &node in &self.nodes {
                let own = nodal::at(&force, node as usize).map(|f| sign * f);
                let own = turned(own, motion % 3, -angle);
                let mut unit = [0.0; MOTIONS];
                unit[motion] = 1.0;
                for (component, f) in own.into_iter().enumerate() {
                    gram.add(&self.row(node, component).map(|x| f * x), &unit);
                }
            }
        }
        body.space.sum_ranks("forces of the ground", &mut gram.0);
        Ok(gram)
    }

    /// Name of a rigid motion, its axis by one of some places where it passes one.
    pub(super) fn name(&self, twist: &Twist, places: &[[f64; 3]]) -> String {
        let spin = [0, 1, 2].map(|d| twist[d] / self.radius);
        let shift = [3, 4, 5].map(|d| twist[d]);
        let square: f64 = spin.iter().map(|w| w * w).sum();
        if square.sqrt() * self.radius < ROUNDING {
            return format!("translation along {}", direction(shift));
        }
        let is_at_rest = |X: &&[f64; 3]| {
            let turning = cross(spin, [0, 1, 2].map(|d| X[d] - self.centre[d]));
            (0..3).all(|d| (turning[d] + shift[d]).abs() < ROUNDING)
        };
        if let Some(place) = places.iter().find(is_at_rest) {
            return format!("rotation about {} through {}", direction(spin), short_vector(*place));
        }
        // The point of the axis next to the centre.
        let arm = cross(spin, shift).map(|x| x / square);
        let about = direction(spin);
        if arm.iter().all(|x| x.abs() < ROUNDING * self.radius) {
            return format!("rotation about {about}");
        }
        let point = [0, 1, 2].map(|d| self.centre[d] + arm[d]);
        let point = point.map(|x| if x.abs() < ROUNDING * self.radius { 0.0 } else { x });
        format!("rotation about {about} through {}", short_vector(point))
    }
}

/// A vector turned about a coordinate axis.
fn turned(v: [f64; 3], axis: usize, angle: f64) -> [f64; 3] {
    let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
    let mut turned = v;
    turned[b] = angle.cos() * v[b] - angle.sin() * v[c];
    turned[c] = angle.sin() * v[b] + angle.cos() * v[c];
    turned
}

/// A coordinate axis by its name, any other direction as a vector.
fn direction(vector: [f64; 3]) -> String {
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    let unit = vector.map(|x| if x.abs() < ROUNDING * length { 0.0 } else { x / length });
    match unit.iter().position(|x| x.abs() > 1.0 - ROUNDING) {
        Some(axis) => ["x", "y", "z"][axis].to_string(),
        None => format!("the direction {}", short_vector(unit)),
    }
}

/// `a`, `a and b`, `a, b and c`.
pub(super) fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [name] => name.clone(),
        [names @ .., last] => format!("{} and {last}", names.join(", ")),
    }
}

/// Basis of the same space in reduced echelon form: each motion has a component 1 that the others do not have.
pub(super) fn reduced(mut basis: Vec<Vec<f64>>) -> Vec<Twist> {
    let mut done = 0;
    for column in 0..MOTIONS {
        let size = |vector: &Vec<f64>| vector[column].abs();
        let best = (done..basis.len()).max_by(|&a, &b| size(&basis[a]).total_cmp(&size(&basis[b])));
        let Some(best) = best.filter(|&best| size(&basis[best]) > ROUNDING) else { continue };
        basis.swap(done, best);
        let pivot = basis[done][column];
        basis[done].iter_mut().for_each(|x| *x /= pivot);
        let row = basis[done].clone();
        for (_, other) in basis.iter_mut().enumerate().filter(|(index, _)| *index != done) {
            let factor = other[column];
            other.iter_mut().zip(&row).for_each(|(x, y)| *x -= factor * y);
        }
        done += 1;
    }
    basis.iter().map(|vector| [0, 1, 2, 3, 4, 5].map(|i| vector[i])).collect()
}

/// A symmetric matrix of the rigid motions, row by row.
#[derive(Debug, Clone, Copy)]
struct Gram([f64; MOTIONS * MOTIONS]);

impl Default for Gram {
    fn default() -> Self {
        Gram([0.0; MOTIONS * MOTIONS])
    }
}

impl Gram {
    /// Adds `a b^T`.
    fn add(&mut self, a: &[f64], b: &[f64]) {
        for (at, sum) in self.0.iter_mut().enumerate() {
            *sum += a[at / MOTIONS] * b[at % MOTIONS];
        }
    }

    fn add_all(&mut self, other: &Gram) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, x)| *sum += x);
    }

    /// The matrix over its largest entry.
    fn normalized(mut self) -> Gram {
        let largest = self.0.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        if largest > 0.0 {
            self.0.iter_mut().for_each(|x| *x /= largest);
        }
        self
    }

    /// The product with the transpose from the left: positive semidefinite, with the same null space.
    fn squared(self) -> Gram {
        let unit = self.normalized().0;
        let mut square = Gram::default();
        for row in unit.chunks_exact(MOTIONS) {
            square.add(row, row);
        }
        square
    }
}
