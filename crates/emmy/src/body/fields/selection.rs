//! Fields at some nodes or in some cells, from the cells around them alone.

use rayon::prelude::*;

use super::name::Formula;
use super::point::PointState;
use super::recovery::{GradientSum, sums};
use super::{FieldName, Fields, Place};

/// Some nodes or cells of a body, for [`Fields::on`].
///
/// ```
/// use emmy::body::{FieldName, Fields};
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(0.0, 500.0)?, 1.0);
/// let body = Body::builder(mesh::block([1.0; 3], [2; 3])?).region(rubber).build()?;
/// let stretched: Vec<f64> = body.mesh().points().iter().flat_map(|X| [X[0], 0.0, 0.0]).collect();
/// let fields = Fields::new(&body);
/// let stress = fields.on(&fields.select_nodes(&[0, 3]), &stretched, &stretched, FieldName::VonMisesStress);
/// // mu (lambda^2 - 1) / lambda for a stretch of 2 along x alone
/// assert!(stress.len() == 2 && (stress[0] - 750.0).abs() < 1e-10);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    place: Place,
    /// Indices of the nodes or cells.
    members: Vec<u32>,
    /// The cells around the nodes, by region; empty for cells.
    around: Vec<(u32, Vec<u32>)>,
    /// Place of each node of these cells among the members, [`ABSENT`] for other nodes, one cell after the other.
    slots: Vec<u32>,
}

const ABSENT: u32 = u32::MAX;

/// Cells that one thread takes at a time.
const RUN: usize = 256;

impl Fields {
    /// Some nodes, for fields at nodes.
    pub fn select_nodes(&self, nodes: &[u32]) -> Selection {
        let mut slot_of = vec![ABSENT; self.mesh.n_nodes()];
        nodes.iter().enumerate().for_each(|(slot, &node)| slot_of[node as usize] = slot as u32);
        let (mut around, mut slots) = (Vec::new(), Vec::new());
        let touches = |cell: &u32| {
            self.mesh.cell(*cell as usize).nodes.iter().any(|&node| slot_of[node as usize] != ABSENT)
        };
        let mut cells: Vec<u32> = (0..self.mesh.n_cells() as u32).filter(touches).collect();
        cells.retain(|&cell| self.region(cell as usize).link().is_none());
        // A stable order: by region, then by number, as for all nodes.
        cells.sort_by_key(|&cell| self.region_of_cell[cell as usize]);
        for cells in
            cells.chunk_by(|&a, &b| self.region_of_cell[a as usize] == self.region_of_cell[b as usize])
        {
            let nodes = cells.iter().flat_map(|&cell| self.mesh.cell(cell as usize).nodes);
            slots.extend(nodes.map(|&node| slot_of[node as usize]));
            around.push((self.region_of_cell[cells[0] as usize], cells.to_vec()));
        }
        Selection { place: Place::Nodes, members: nodes.to_vec(), around, slots }
    }

    /// Some cells, for fields in cells.
    pub fn select_cells(&self, cells: &[u32]) -> Selection {
        Selection { place: Place::Cells, members: cells.to_vec(), around: Vec::new(), slots: Vec::new() }
    }

    /// A field at the members of a selection of its place, bit-identical to their numbers in [`Fields::at`]:
    /// `[n_members][n_components]`. `displacement`, `velocity`: `[n_nodes][3]`. On a team no call of all ranks: nodes are own
    /// ones, because the cells around guests are not all here.
    ///
    /// # Panics
    /// If the field and the selection have different places.
    pub fn on(
        &self,
        selection: &Selection,
        displacement: &[f64],
        velocity: &[f64],
        name: FieldName,
    ) -> Vec<f64> {
        assert_eq!(
            selection.place,
            name.place(),
            "a selection of nodes for fields at nodes, of cells for fields in cells"
        );
        let members = selection.members.iter().map(|&member| member as usize);
        let formula = &name.info().formula;
        let states = if formula.is_of_state() { self.states(selection, displacement) } else { Vec::new() };
        match formula {
            Formula::Vector(vector) => {
                members.flat_map(|node| vector(self, [displacement, velocity], node)).collect()
            }
            Formula::OfCell(number) => {
                members.map(|cell| number(self, [displacement, velocity], cell)).collect()
            }
            Formula::Number(number) => states.iter().map(number).collect(),
            Formula::Stretches(stretches) => states.iter().flat_map(stretches).collect(),
            Formula::Tensor(tensor) => states.iter().flat_map(tensor).collect(),
        }
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
            let recovered = |run: &[u32]| self.recovery.run(&self.mesh, run, weigh, displacement);
            let runs: Vec<Vec<GradientSum>> = cells.par_chunks(RUN).map(recovered).collect();
            for (own, &slot) in runs.iter().flatten().zip(slots.by_ref()) {
                if let Some(sum) = sums.get_mut(slot as usize) {
                    sum.add(own);
                }
            }
            for (sum, total) in sums.iter_mut().zip(&mut totals) {
                let own = *sum;
                let weight = sum.take();
                if weight > 0.0 {
                    total.0 += weight;
                    total.1.add(weight, &self.nodal_state(*index, &own));
                }
            }
        }
        let over = |(weight, state): (f64, PointState)| if weight > 0.0 { state.over(weight) } else { state };
        totals.into_iter().map(over).collect()
    }
}
