//! Fields of a state for output: stress, stretches, densities of energy and momentum, at nodes and in cells.

mod name;
mod nodal_motion;
mod point;
mod projected;
mod recovery;
mod selection;

use std::sync::Arc;

use rayon::prelude::*;

use super::system::Body;
use crate::force::{ContactAtNode, Force};
use crate::input::Region;
use crate::mesh::Mesh;
use crate::nodal;
use crate::space::geometry::for_each_volume_point;
use crate::team::Subdomain;

pub use name::{FieldName, Place};
use name::{Formula, Needs};
pub use nodal_motion::NodalMotion;
use point::{PointState, axial_force};
use projected::Projections;
use recovery::{GradientSum, Recovery};
pub use selection::Selection;

/// The fields of a body, computed from the motion of its nodes for any scheme.
///
/// Stresses, stretches and energy at a node follow from the material and the deformation gradient recovered there: in
/// every cell the displacement gradient is projected from the quadrature points to the nodes
/// ([`crate::element::extrapolation()`]), then averaged over the cells around a node that are of one region, by their
/// volumes.
///
/// ```math
/// G_A = sum_c V_c sum_q X_Aq G_cq / sum_c V_c,      S_A = S(E(G_A)),      sigma_A = F_A S_A F_A^T / det F_A,   F_A = I + G_A
/// ```
///
/// Cells with a projected volume have stresses and energies of this volume. At a node F_A then has the determinant
/// `1 + theta_A`, the mean of the projected volumes of the cells around it: this removes the chequerboard of the
/// pressures of single cells.
///
/// So all fields at a node belong to one strain, energies are positive if the material's are, a rigid rotation rotates
/// the stresses and changes nothing else, and homogeneous deformations are exact. Where regions meet, the values of
/// both sides are averaged by volume; the true stress jumps. Each side by itself is [`Fields::on`] a selection of its
/// cells ([`Fields::select_nodes_in`]), and cell fields are means over the quadrature points of a cell. A node is NaN
/// if its recovered deformation gradient has no positive determinant: the mesh is too coarse there. A node without
/// solid or plane cells has no stress and stretches of 1.
///
/// On a team the fields are those of the nodes and cells of the share.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::body::{FieldName, Fields};
/// let rubber = NeoHooke::new(0.0, 500.0)?;
/// let body = Body::builder(mesh::block([1.0; 3], [2; 3])?).region(Region::new(rubber, 1.0)).build()?;
/// let stretched: Vec<f64> = body.mesh().points().iter().flat_map(|X| [X[0], 0.0, 0.0]).collect();
/// let fields = Fields::new(&body).at([&stretched, &stretched], &[FieldName::CauchyStress]);
/// // sigma = mu (b - I) / J with F = diag(2, 1, 1)
/// assert!((fields[0].numbers[0] - 750.0).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct Fields {
    mesh: Arc<Mesh>,
    regions: Arc<Vec<Region>>,
    region_of_cell: Vec<u32>,
    recovery: Recovery,
    /// Mean density of the cells around each node, by volume; at guests of the cells that are here.
    density: Vec<f64>,
    /// Forces of contact.
    contacts: Vec<Arc<dyn Force>>,
    ranks: Arc<Subdomain>,
}

/// The numbers of a field.
///
/// ```
/// use emmy::body::{FieldName, Fields};
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let values = Fields::new(&body).at([&[0.0; 24], &[1.0; 24]], &[FieldName::Velocity]);
/// assert_eq!((values[0].name, values[0].numbers.len()), (FieldName::Velocity, 24));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FieldValues {
    /// Which field.
    pub name: FieldName,
    /// `[n_nodes][n_components]` or `[n_cells][n_components]`.
    pub numbers: Vec<f64>,
}

impl Body {
    /// Whether the body has a field, as [`Fields::has`], which computes more.
    pub fn has_field(&self, name: FieldName) -> bool {
        let has_contact = self.contacts().next().is_some();
        name.is_of_motion() || self.made_of.iter().any(|region| has_field(region, name, has_contact))
    }
}

fn has_field(region: &Region, name: FieldName, has_contact: bool) -> bool {
    let link = region.link();
    match name.info().needs {
        Needs::Nothing => true,
        Needs::Volume => link.is_none_or(|link| link.area() > 0.0),
        Needs::Solids => link.is_none(),
        Needs::Links => link.is_some(),
        Needs::Contact => has_contact && link.is_none(),
    }
}

impl Fields {
    /// The fields of a body. Computes everything that does not depend on the state.
    pub fn new(body: &Body) -> Self {
        let mesh = body.space.mesh().clone();
        let regions = body.made_of.clone();
        let region_of_cell = body.region_of_cell.clone();
        let projections = Projections::new(&mesh, &regions, &region_of_cell);
        let recovery = Recovery::new(&mesh, body.space.internal().clone(), projections);
        let ranks = body.ranks().clone();
        let (density, contacts) = (Vec::new(), body.forces_of_contact());
        let mut fields = Fields { mesh, regions, region_of_cell, recovery, density, contacts, ranks };
        let (n_nodes, n_cells) = (fields.mesh.n_nodes(), fields.mesh.n_cells());
        fields.density = fields.densities(0..n_cells as u32, n_nodes, |node| node);
        fields
    }

    /// Whether the body has a field: stresses at nodes need solid or plane cells, stresses in cells need a volume,
    /// axial forces need links, and fields of contact need a contact.
    pub fn has(&self, name: FieldName) -> bool {
        name.is_of_motion() || (0..self.regions.len()).any(|region| self.region_has(region, name))
    }

    /// Groups of the regions, in the order of their numbers; `None`: every cell.
    pub fn regions(&self) -> impl Iterator<Item = Option<&str>> {
        self.regions.iter().map(|region| region.group.as_deref())
    }

    /// Whether a region has a field, as [`Fields::has`]; `region`: its number.
    pub fn region_has(&self, region: usize, name: FieldName) -> bool {
        has_field(&self.regions[region], name, !self.contacts.is_empty())
    }

    /// Some fields of a motion, whose lists have [`Body::n_dofs`] numbers. The fields are those of the nodes and cells
    /// of the mesh.
    ///
    /// On a team a call of all ranks: fields at guests come from their owners.
    pub fn at<'a>(&self, motion: impl Into<NodalMotion<'a>>, names: &[FieldName]) -> Vec<FieldValues> {
        let motion = motion.into();
        let displacement = motion.displacement;
        let is_of_state = |name: &FieldName| name.info().formula.is_of_state();
        let wanted = |place: Place| names.iter().any(|name| is_of_state(name) && name.place() == place);
        let nodes = if wanted(Place::Nodes) { self.nodal_states(displacement) } else { Vec::new() };
        let cells = if wanted(Place::Cells) { self.cell_states(displacement) } else { Vec::new() };
        let contact = self.contact_at_nodes(displacement, names);
        let numbers = |name: FieldName| match name.place() {
            Place::Nodes => {
                let members = (0..self.mesh.n_nodes()).zip(self.density.iter().copied());
                self.numbers(name, (&nodes, &contact), members, motion)
            }
            Place::Cells => {
                let members = (0..self.mesh.n_cells()).map(|cell| (cell, 0.0));
                self.numbers(name, (&cells, &contact), members, motion)
            }
        };
        let mut fields: Vec<FieldValues> =
            names.iter().map(|&name| FieldValues { name, numbers: numbers(name) }).collect();
        self.update_guests(&mut fields);
        fields
    }

    /// Contact at every node, `[n_nodes]`; empty if no field needs it.
    fn contact_at_nodes(&self, displacement: &[f64], names: &[FieldName]) -> Vec<ContactAtNode> {
        if !names.iter().any(|name| matches!(name.info().formula, Formula::Contact(_))) {
            return Vec::new();
        }
        let mut all = vec![ContactAtNode::NONE; self.mesh.n_nodes()];
        for force in &self.contacts {
            force.for_each_contact_node(displacement, &mut |node, own| all[node] = all[node].with(own));
        }
        all
    }

    /// The numbers of a field at some members, each with the density around it; `states`: those of the members, and
    /// contact at every node.
    fn numbers(
        &self,
        name: FieldName,
        (states, contact): (&[PointState], &[ContactAtNode]),
        members: impl Iterator<Item = (usize, f64)>,
        motion: NodalMotion<'_>,
    ) -> Vec<f64> {
        match name.info().formula {
            Formula::Vector(vector) => {
                members.flat_map(|(node, density)| vector(density, motion.at(node))).collect()
            }
            Formula::OfCell(number) | Formula::OfMass(number) => {
                members.map(|(cell, _)| number(self, motion, cell)).collect()
            }
            Formula::Contact(number) => members.map(|(node, _)| number(&contact[node])).collect(),
            Formula::Number(number) => flat(states, |state| [number(state)]),
            Formula::Stretches(stretches) => flat(states, stretches),
            Formula::Tensor(tensor) => flat(states, tensor),
        }
    }

    /// Takes the fields at guests from their owners, which have all cells around them.
    fn update_guests(&self, fields: &mut [FieldValues]) {
        let mut at_nodes: Vec<(usize, &mut Vec<f64>)> = fields
            .iter_mut()
            .filter(|field| field.name.place() == Place::Nodes)
            .map(|field| (field.name.components().len(), &mut field.numbers))
            .collect();
        let width = at_nodes.iter().map(|(n, _)| n).sum();
        // Internal nodes of cells have no fields.
        let has_fields = |node: usize| node < self.mesh.n_nodes();
        let read = |fields: &[(usize, &mut Vec<f64>)], node: usize, mut numbers: &mut [f64]| {
            for (n, values) in fields.iter().filter(|_| has_fields(node)) {
                let (own, rest) = numbers.split_at_mut(*n);
                own.copy_from_slice(&values[n * node..n * (node + 1)]);
                numbers = rest;
            }
        };
        let write = |fields: &mut [(usize, &mut Vec<f64>)], node: usize, mut numbers: &[f64]| {
            for (n, values) in fields.iter_mut().filter(|_| has_fields(node)) {
                let (own, rest) = numbers.split_at(*n);
                values[*n * node..*n * (node + 1)].copy_from_slice(own);
                numbers = rest;
            }
        };
        if width > 0 {
            self.ranks.exchange("fields at nodes", width, &mut at_nodes[..], read, write);
        }
    }

    fn region(&self, cell: usize) -> &Region {
        &self.regions[self.region_of_cell[cell] as usize]
    }

    fn axial_force(&self, displacement: &[f64], cell: usize) -> f64 {
        let link = self.region(cell).link();
        link.map_or(0.0, |link| axial_force(&link, &self.mesh, cell, displacement))
    }

    /// Mean over a cell of half the density times the squared velocity, with the quadrature of the consistent mass.
    fn kinetic_energy_density(&self, velocity: &[f64], cell: usize) -> f64 {
        let (mut sum, mut measure) = (0.0, 0.0);
        for_each_volume_point(&self.mesh, std::iter::once(cell as u32), |_, nodes, point| {
            let component = |d: usize| {
                let terms = nodes.iter().zip(point.shapes);
                terms.map(|(&node, N)| N * nodal::at(velocity, node as usize)[d]).sum::<f64>()
            };
            sum += point.weight * (0..3).map(|d| component(d).powi(2)).sum::<f64>();
            measure += point.weight;
        });
        0.5 * self.region(cell).density * sum / measure
    }

    /// Reference volume of a cell: area times thickness of a plane one, length times cross section of a bar; 0 for
    /// springs and attractions \[length^3\].
    pub fn cell_volume(&self, cell: usize) -> f64 {
        self.recovery.measure(&self.mesh, cell) * self.region(cell).section(self.mesh.cell(cell).kind)
    }

    /// Reference volume by which a field's mean in a cell becomes its total: that of the points over which the mean is
    /// taken. These are the points of the mass for kinetic energies, and those of the stresses
    /// ([`Fields::cell_volume`]) for all others; in cells with curved edges the two volumes differ \[length^3\].
    pub fn volume_for(&self, name: FieldName, cell: usize) -> f64 {
        let Formula::OfMass(_) = name.info().formula else { return self.cell_volume(cell) };
        let mut measure = 0.0;
        let cells = std::iter::once(cell as u32);
        for_each_volume_point(&self.mesh, cells, |_, _, point| measure += point.weight);
        measure * self.region(cell).section(self.mesh.cell(cell).kind)
    }

    /// The state at a node by the sum over the cells of a region.
    fn nodal_state(&self, region: u32, sum: &GradientSum) -> PointState {
        let material = &self.regions[region as usize];
        match self.recovery.projections.measure(region) {
            Some(measure) => PointState::with_volume(material, measure, &sum.mean(), sum.mean_volume()),
            None => PointState::new(material, &sum.mean()),
        }
    }

    /// The state at every node, `[n_nodes]`.
    fn nodal_states(&self, displacement: &[f64]) -> Vec<PointState> {
        let n_nodes = self.mesh.n_nodes();
        let mut totals = vec![(0.0, PointState::default()); n_nodes];
        let mut sums = recovery::sums(n_nodes);
        for (index, region) in self.regions.iter().enumerate().filter(|(_, region)| region.link().is_none()) {
            let cells: Vec<u32> = self.cells_of(index as u32).collect();
            let weigh = |kind| region.section(kind);
            let mut nodes = Vec::new();
            self.recovery.for_each_gradient(&self.mesh, &cells, weigh, displacement, |node, own| {
                let sum = &mut sums[node as usize];
                if sum.is_empty() {
                    nodes.push(node);
                }
                sum.add(own);
            });
            let state = |&node: &u32| self.nodal_state(index as u32, &sums[node as usize]);
            let states: Vec<PointState> = nodes.par_iter().with_min_len(64).map(state).collect();
            for (&node, state) in nodes.iter().zip(&states) {
                let total = &mut totals[node as usize];
                let weight = sums[node as usize].take();
                total.0 += weight;
                total.1.add(weight, state);
            }
        }
        totals
            .into_iter()
            .map(|(weight, state)| if weight > 0.0 { state.over(weight) } else { state })
            .collect()
    }

    /// Means over the quadrature points of every cell by reference volume, `[n_cells]`.
    fn cell_states(&self, displacement: &[f64]) -> Vec<PointState> {
        let state = |cell: usize| self.cell_state(cell, displacement);
        (0..self.mesh.n_cells()).into_par_iter().with_min_len(64).map(state).collect()
    }

    fn cell_state(&self, cell: usize, displacement: &[f64]) -> PointState {
        let region = self.region(cell);
        if let Some(link) = region.link() {
            return PointState::of_link(&link, &self.mesh, cell, displacement);
        }
        let mut points = Vec::new();
        let mut sum = PointState::default();
        let mut volume = 0.0;
        self.recovery.points(&self.mesh, cell, displacement, &mut points);
        let projected = self.recovery.projections.of_cell(&self.mesh, cell);
        let theta = projected.map(|kind| (kind, kind.volume(&self.mesh, cell, &points)));
        for (point, (G, weight)) in points.iter().enumerate() {
            let state = match &theta {
                Some((kind, volume)) => PointState::of_projection(kind, G, volume.at_point(point)),
                None => PointState::new(region, G),
            };
            sum.add(*weight, &state);
            volume += weight;
        }
        sum.over(volume)
    }

    fn cells_of(&self, region: u32) -> impl Iterator<Item = u32> + '_ {
        let cells = self.region_of_cell.iter().enumerate();
        cells.filter(move |&(_, &of_cell)| of_cell == region).map(|(cell, _)| cell as u32)
    }

    /// Mean density by volume of the cells around each of `n` nodes, point masses left out; 0 where there is no volume.
    /// `slot`: place of a node, [`ABSENT`] for one that is not asked for.
    ///
    /// [`ABSENT`]: selection::ABSENT
    fn densities(
        &self,
        cells: impl IntoIterator<Item = u32>,
        n: usize,
        slot: impl Fn(u32) -> u32,
    ) -> Vec<f64> {
        let mut sums = vec![[0.0; 2]; n];
        for cell in cells {
            let (density, volume) = (self.region(cell as usize).density, self.cell_volume(cell as usize));
            for &node in self.mesh.cell(cell as usize).nodes {
                if let Some([mass, sum]) = sums.get_mut(slot(node) as usize) {
                    *mass += density * volume;
                    *sum += volume;
                }
            }
        }
        sums.into_iter().map(|[mass, volume]| if volume > 0.0 { mass / volume } else { 0.0 }).collect()
    }
}

/// The numbers of a field one after the other.
fn flat<const N: usize>(states: &[PointState], numbers: impl Fn(&PointState) -> [f64; N] + Sync) -> Vec<f64> {
    let mut flat = vec![0.0; N * states.len()];
    flat.par_chunks_exact_mut(N)
        .with_min_len(256)
        .zip(states)
        .for_each(|(flat, state)| flat.copy_from_slice(&numbers(state)));
    flat
}
