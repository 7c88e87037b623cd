//! Writes the results of a batch to the rows of the stage forces and the stage matrix.

use std::hint::black_box;

use super::SolidForce;
use crate::average::Request;
use crate::force::integral::BatchMemory;
use crate::force::step::StepInput;
use crate::sparse::RowPart;
use crate::tensor::Packed;

impl SolidForce {
    /// Reads one number of every block that a batch will write. Independent reads bring the blocks into the cache in
    /// parallel, before the writes need them (12 % of an assembly of hex8 cells).
    #[inline(always)]
    pub(super) fn touch(&self, batch: usize, sink: &mut RowPart) {
        let cells = self.cells.cells_of(batch);
        let pairs = self.cells.n_nodes * self.cells.n_nodes;
        let stages = sink.degree() * sink.degree();
        let (blocks, first) = sink.blocks_mut();
        let mut sum = 0.0;
        for &position in &self.positions[cells.start * pairs..cells.end * pairs] {
            // Positions of other parts are out of bounds.
            let block = (position as usize).checked_sub(first).and_then(|index| blocks.get(index * stages));
            sum += block.map_or(0.0, |block| block[4]);
        }
        black_box(sum);
    }

    /// Writes the rows of a batch that a part owns.
    #[inline(always)]
    pub(super) fn scatter(
        &self,
        batch: usize,
        step: &StepInput<'_>,
        request: Request,
        memory: &BatchMemory,
        sink: &mut RowPart,
    ) {
        let n = self.cells.n_nodes;
        let k = step.rule.degree();
        // The nodes A of neighbouring cells are often neighbours: their rows are close in memory.
        for A in 0..n {
            for (lane, cell) in self.cells.cells_of(batch).enumerate() {
                let node = self.cells.nodes_of(cell)[A];
                if !sink.owns(node) {
                    continue;
                }
                for stage in 0..k {
                    let force = &memory.force[stage * n + A];
                    sink.add_force(stage, node, [force[0].0[lane], force[1].0[lane], force[2].0[lane]]);
                }
                if request == Request::Tangent {
                    self.scatter_row((cell, A, lane), step, &memory.stiffness, sink);
                }
            }
        }
    }

    /// Writes the blocks of a cell in the row of its node A.
    #[inline(always)]
    fn scatter_row(
        &self,
        (cell, A, lane): (usize, usize, usize),
        step: &StepInput<'_>,
        stiffness: &[[Packed; 9]],
        sink: &mut RowPart,
    ) {
        let n = self.cells.n_nodes;
        let k = step.rule.degree();
        let positions = &self.positions[(cell * n + A) * n..(cell * n + A + 1) * n];
        let mirrored = if step.rule.is_symmetric(self.damps(step)) { A } else { 0 };
        let (blocks, first) = sink.blocks_mut();
        for stages in 0..k * k {
            let stiffness = &stiffness[stages * n * n..(stages + 1) * n * n];
            let at = |position: u32| (position as usize - first) * k * k + stages;
            for (&position, row) in positions[..mirrored].iter().zip(stiffness.chunks_exact(n)) {
                let block = &mut blocks[at(position)];
                for entry in 0..9 {
                    block[entry] += row[A][3 * (entry % 3) + entry / 3].0[lane];
                }
            }
            let row = &stiffness[A * n..(A + 1) * n];
            for (&position, values) in positions[mirrored..].iter().zip(&row[mirrored..]) {
                let block = &mut blocks[at(position)];
                for entry in 0..9 {
                    block[entry] += values[entry].0[lane];
                }
            }
        }
    }
}
