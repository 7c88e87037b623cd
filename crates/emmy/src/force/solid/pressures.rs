//! Pressures of a term with a projected volume: their numbers, and the results of its cells.

use std::ops::Range;

use super::SolidForce;
use crate::average::Request;
use crate::force::integral::BatchMemory;
use crate::force::pressures::{PressureNumbers, PressureResults};
use crate::force::step::StepInput;
use crate::tensor::{LANES, Packed};

impl SolidForce {
    /// The numbers of the pressures; a batch is saved by the part with the smallest node of its first cell.
    pub(super) fn numbered(&self, term: usize, first: usize, parts: &[Range<usize>]) -> PressureNumbers {
        let Some(projection) = &self.projection else { return PressureNumbers::default() };
        let n_cells = self.cells.cells.len();
        let mut begin = 0;
        let mut saved = Vec::new();
        for rows in parts {
            let mut end = begin;
            while end < n_cells && self.smallest_node(end) < rows.end {
                end = (end + LANES).min(n_cells);
            }
            saved.push(begin..end);
            begin = end;
        }
        PressureNumbers { n_functions: projection.n_functions, term, first, saved }
    }

    fn smallest_node(&self, cell: usize) -> usize {
        self.cells.nodes_of(cell).iter().min().map_or(0, |&node| node as usize)
    }

    /// Copies the pressures of a step to the cells of a batch.
    #[inline(always)]
    pub(super) fn gather_pressures(&self, batch: usize, step: &StepInput<'_>, memory: &mut BatchMemory) {
        let Some(projection) = &self.projection else { return };
        memory.volume.fit(step.rule, projection.n_functions, self.cells.n_nodes);
        let Some(pressures) = step.local else { return };
        let given = &mut memory.volume.given;
        let of_term = &pressures[self.pressures.first * step.rule.n_pressures()..];
        let last = self.cells.cells.len() - 1;
        for lane in 0..LANES {
            let cell = (batch * LANES + lane).min(last);
            let of_cell = &of_term[cell * given.len()..(cell + 1) * given.len()];
            given.iter_mut().zip(of_cell).for_each(|(packed, pressure)| packed.0[lane] = *pressure);
        }
    }

    /// Keeps the pressures of a batch, and their linearisation after a tangent.
    #[inline(always)]
    pub(super) fn save_pressures(
        &self,
        (batch, part): (usize, usize),
        step: &StepInput<'_>,
        request: Request,
        memory: &BatchMemory,
        results: &mut [PressureResults],
    ) {
        if self.projection.is_none() {
            return;
        }
        let saved = &self.pressures.saved[part];
        let cells = self.cells.cells_of(batch);
        if !saved.contains(&cells.start) {
            return;
        }
        let volume = &memory.volume;
        let results = &mut results[self.pressures.term];
        let at = (cells.start - saved.start, saved.len(), cells.len());
        store(&volume.pressures, at, &mut results.pressures);
        if request == Request::Tangent {
            let k = step.rule.degree();
            debug_assert_eq!(volume.responses.len(), k * volume.forces.len());
            store(volume.forces.as_flattened(), at, &mut results.forces);
            store(volume.responses.as_flattened(), at, &mut results.responses);
        }
    }
}

/// Copies the numbers of a batch to a table of cells, `[cell][number]`; `at`: first cell of the batch, number of cells
/// of the table and of the batch.
#[inline(always)]
fn store(numbers: &[Packed], (first, n_cells, n_own): (usize, usize, usize), table: &mut Vec<f64>) {
    table.resize(n_cells * numbers.len(), 0.0);
    let of_batch = table[first * numbers.len()..].chunks_exact_mut(numbers.len()).take(n_own);
    for (lane, of_cell) in of_batch.enumerate() {
        of_cell.iter_mut().zip(numbers).for_each(|(number, packed)| *number = packed.0[lane]);
    }
}
