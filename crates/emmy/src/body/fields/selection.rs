//! Fields at some nodes or in some cells, from the cells around them alone.

use rayon::prelude::*;

use super::point::PointState;
use super::recovery::sums;
use super::{FieldName, FieldValues, Fields, NodalMotion, Place};

/// Some nodes or cells of a body, for [`Fields::on`].
///
/// ```
/// use emmy::body::{FieldName, Fields};
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 1.0);
/// let body = Body::builder(mesh::block([1.0; 3], [2; 3])?).region(rubber).build()?;
/// let stretched: Vec<f64> = body.mesh().points().iter().flat_map(|X| [X[0], 0.0, 0.0]).collect();
/// let fields = Fields::new(&body);
/// let stress = fields.on(&fields.select_nodes(&[0, 3]), [&stretched, &stretched], FieldName::VonMisesStress);
/// // mu (lambda^2 - 1) / lambda for a stretch of 2 along x alone
/// assert!(stress.len() == 2 && (stress[0] - 750.0).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    place: Place,
    /// Indices of the nodes or cells.
    members: Vec<u32>,
    /// Mean density around each node; empty for cells.
    densities: Vec<f64>,
    /// The cells around the nodes, by region; empty for cells.
    around: Vec<(u32, Vec<u32>)>,
    /// Place of each node of these cells among the members, [`ABSENT`] for other nodes, one cell after the other.
    slots: Vec<u32>,
}

/// Slot of a node that is not a member.
pub(super) const ABSENT: u32 = u32::MAX;

impl Selection {
    /// Indices of the nodes or cells, in their order.
    pub fn members(&self) -> &[u32] {
        &self.members
    }
}

impl Fields {
    /// Some nodes, for fields at nodes from all cells around them.
    pub fn select_nodes(&self, nodes: &[u32]) -> Selection {
        let cells: Vec<u32> = (0..self.mesh.n_cells() as u32).collect();
        self.select_nodes_in(nodes, cells)
    }

    /// Some nodes, for fields that are recovered from some cells alone, such as those of a region: at an interface,
    /// where stresses jump, its own side. A node that none of the cells touches has no stress.
    ///
    /// ```
    /// use emmy::body::{FieldName, Fields};
    /// use emmy::prelude::*;
    /// // Two cubes side by side, of which the second one is ten times as stiff.
    /// let mut mesh = mesh::MeshBuilder::new();
    /// let at = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    /// let nodes: Vec<u32> = (0..3).flat_map(|x| at.map(|[y, z]| [x as f64, y, z])).map(|X| mesh.point(X)).collect();
    /// for (group, first) in [("soft", 0), ("stiff", 4)] {
    ///     let cell = mesh.cell(mesh::CellKind::Hex8, &nodes[first..first + 8])?;
    ///     mesh.cell_group(group, [cell]);
    /// }
    /// let region = |group: &str, mu: f64| -> emmy::Result<Region> { Ok(Region::new(NeoHooke::new(0.0, mu)?, 1.0).on(group)) };
    /// let body = Body::builder(mesh.build()?).regions([region("soft", 50.0)?, region("stiff", 500.0)?]).build()?;
    /// let stretched: Vec<f64> = body.mesh().points().iter().flat_map(|X| [X[0], 0.0, 0.0]).collect();
    /// let (fields, face) = (Fields::new(&body), [4, 5]);
    /// let stress = |cells: Vec<u32>| {
    ///     fields.on(&fields.select_nodes_in(&face, cells), [&stretched, &stretched], FieldName::VonMisesStress)[0]
    /// };
    /// // mu (lambda^2 - 1) / lambda for a stretch of 2 along x alone
    /// assert!((stress(vec![0]) - 75.0).abs() < 1e-11 && (stress(vec![1]) - 750.0).abs() < 1e-10);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn select_nodes_in(&self, nodes: &[u32], mut cells: Vec<u32>) -> Selection {
        let mut slot_of = vec![ABSENT; self.mesh.n_nodes()];
        nodes.iter().enumerate().for_each(|(slot, &node)| slot_of[node as usize] = slot as u32);
        let (mut around, mut slots) = (Vec::new(), Vec::new());
        let touches = |cell: &u32| {
            self.mesh.cell(*cell as usize).nodes.iter().any(|&node| slot_of[node as usize] != ABSENT)
        };
        cells.retain(touches);
        // By number, as for all nodes.
        cells.sort_unstable();
        let densities = self.densities(cells.iter().copied(), nodes.len(), |node| slot_of[node as usize]);
        cells.retain(|&cell| self.region(cell as usize).link().is_none());
        cells.sort_by_key(|&cell| self.region_of_cell[cell as usize]);
        for cells in
            cells.chunk_by(|&a, &b| self.region_of_cell[a as usize] == self.region_of_cell[b as usize])
        {
            let nodes = cells.iter().flat_map(|&cell| self.mesh.cell(cell as usize).nodes);
            slots.extend(nodes.map(|&node| slot_of[node as usize]));
            around.push((self.region_of_cell[cells[0] as usize], cells.to_vec()));
        }
        Selection { place: Place::Nodes, members: nodes.to_vec(), densities, around, slots }
    }

    /// Some cells, for fields in cells.
    pub fn select_cells(&self, cells: &[u32]) -> Selection {
        let (densities, around, slots) = Default::default();
        Selection { place: Place::Cells, members: cells.to_vec(), densities, around, slots }
    }

    /// A field at the members of a selection of its place, bit-identical to their numbers in [`Fields::at`] if all
    /// cells around them are selected: `[n_members][n_components]`. On a
    /// team no call of all ranks: nodes are own ones, because the cells around guests are not all here.
    ///
    /// # Panics
    /// If the field and the selection have different places.
    pub fn on<'a>(
        &self,
        selection: &Selection,
        motion: impl Into<NodalMotion<'a>>,
        name: FieldName,
    ) -> Vec<f64> {
        self.all_on(selection, motion, &[name]).remove(0).numbers
    }

    /// Several fields as [`Fields::on`]; the deformation is recovered once.
    ///
    /// # Panics
    /// If a field and the selection have different places.
    pub fn all_on<'a>(
        &self,
        selection: &Selection,
        motion: impl Into<NodalMotion<'a>>,
        names: &[FieldName],
    ) -> Vec<FieldValues> {
        let motion = motion.into();
        let displacement = motion.displacement;
        assert!(
            names.iter().all(|name| name.place() == selection.place),
            "a selection of nodes for fields at nodes, of cells for fields in cells"
        );
        let is_of_state = names.iter().any(|name| name.info().formula.is_of_state());
        let states = if is_of_state { self.states(selection, displacement) } else { Vec::new() };
        let contact = self.contact_at_nodes(displacement, names);
        let numbers = |name: FieldName| {
            let members = selection.members.iter().map(|&member| member as usize);
            let densities = selection.densities.iter().copied().chain(std::iter::repeat(0.0));
            self.numbers(name, (&states, &contact), members.zip(densities), motion)
        };
        names.iter().map(|&name| FieldValues { name, numbers: numbers(name) }).collect()
    }

    /// The state at every member.
    fn states(&self, selection: &Selection, displacement: &[f64]) -> Vec<PointState> {
        match selection.place {
            Place::Nodes => self.states_at_nodes(selection, displacement),
            Place::Cells => {
                let cells = selection.members.par_iter().with_min_len(64);
                cells.map(|&cell| self.cell_state(cell as usize, displacement)).collect()
            }
        }
    }

    fn states_at_nodes(&self, selection: &Selection, displacement: &[f64]) -> Vec<PointState> {
        let n = selection.members.len();
        let mut totals = vec![(0.0, PointState::default()); n];
        let mut sums = sums(n);
        let mut slots = selection.slots.iter();
        for (index, cells) in &selection.around {
            let region = &self.regions[*index as usize];
            let weigh = |kind| region.section(kind);
            self.recovery.for_each_gradient(&self.mesh, cells, weigh, displacement, |_, own| {
                let slot = slots.next().copied().unwrap_or(ABSENT);
                if let Some(sum) = sums.get_mut(slot as usize) {
                    sum.add(own);
                }
            });
            sums.par_iter_mut().zip(&mut totals).with_min_len(64).for_each(|(sum, total)| {
                let own = *sum;
                let weight = sum.take();
                if weight > 0.0 {
                    total.0 += weight;
                    total.1.add(weight, &self.nodal_state(*index, &own));
                }
            });
        }
        let over = |(weight, state): (f64, PointState)| if weight > 0.0 { state.over(weight) } else { state };
        totals.into_iter().map(over).collect()
    }
}
