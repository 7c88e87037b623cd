//! Cells of one kind and one material (of links, one law): the assembly that every scheme, material and element shares.

mod start_gradient;

use std::fmt;
use std::hint::black_box;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::batches::CellBatches;
use super::damping::{self, OfCells};
use super::geometry::CellTable;
use super::integral::{self, BatchMemory, PointMemory, Scratch};
use super::term::{StepInput, Strained, Term};
use super::viscosity::Viscosity;
use crate::average::{Damping, Want};
use crate::error::{Error, Result};
use crate::material::Material;
use crate::sparse::{Pattern, RowPart};
use crate::tensor::{Batch, Elasticity, LANES, Packed, Register};

/// Cells of one kind and one material.
pub struct SolidTerm<M> {
    /// One for all cells, or one for each (of links).
    materials: Vec<M>,
    /// Elasticity at rest of the one material.
    at_rest: Elasticity<f64>,
    viscosity: Viscosity,
    cells: CellBatches,
    /// Position in the pattern of every pair of nodes, `[cell][A][B]`.
    positions: Vec<u32>,
    /// Batches that touch each part's rows, ascending.
    parts: Vec<Vec<u32>>,
}

impl<M> fmt::Debug for SolidTerm<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SolidTerm<{}>({} cells)", std::any::type_name::<M>(), self.cells.cells.len())
    }
}

/// Most nodes that a cell has.
const MAX_NODES: usize = 27;

/// Batches whose energies are added up one after the other; more of them in a tree of halves.
const ENERGY_RUN: usize = 64;

impl<M: Material> SolidTerm<M> {
    /// The term of a table of cells.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn new(material: M, table: CellTable) -> Result<Self> {
        SolidTerm::with_materials(vec![material], table)
    }

    /// The term of a table of cells with a material for each.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub fn with_materials(materials: Vec<M>, table: CellTable) -> Result<Self> {
        let cells = CellBatches::new(table)?;
        let at_rest = materials.first().map_or([[0.0; 6]; 6], at_rest);
        let viscosity = Viscosity::default();
        Ok(SolidTerm { materials, at_rest, viscosity, cells, positions: Vec::new(), parts: Vec::new() })
    }

    #[inline(always)]
    fn material(&self, cell: usize) -> &M {
        &self.materials[if self.materials.len() == 1 { 0 } else { cell }]
    }

    /// Whether strain rates count in a step.
    #[inline(always)]
    fn damps(&self, step: &StepInput<'_>) -> bool {
        step.damping.excess > 0.0 || step.damping.rate > 0.0 && !self.viscosity.is_zero()
    }

    /// Damping of all cells.
    fn dampings<'a>(&self, of: &'a dyn Fn(usize) -> Damping) -> OfCells<'a> {
        OfCells { of, differs: self.materials.len() > 1 }
    }

    /// Damping of a cell in a step.
    fn damping(&self, cell: usize, step: &StepInput<'_>) -> Damping {
        let at_rest = match self.materials.len() {
            1 => self.at_rest,
            _ => at_rest(&self.materials[cell]),
        };
        let scaled = |tensor: Elasticity<f64>, factor: f64| tensor.map(|row| row.map(|entry| factor * entry));
        let viscous = match self.viscosity.is_zero() {
            true => [[0.0; 6]; 6],
            false => scaled(self.viscosity.tensor(&at_rest), step.damping.rate),
        };
        Damping { viscous, dissipative: scaled(at_rest, step.damping.excess) }
    }

    /// Stage forces and derivatives of a batch, into its memory.
    #[inline(always)]
    fn integrate<R: Register>(
        &self,
        batch: usize,
        step: &StepInput<'_>,
        want: Want,
        memory: &mut BatchMemory,
        point_memory: &mut PointMemory<R>,
    ) -> Result<()> {
        let n_fields = integral::gather(&self.cells, batch, step, self.damps(step), memory);
        let cells = self.cells.cells_of(batch);
        for (part, cell) in cells.clone().step_by(R::WIDTH).enumerate() {
            let (place, law) = ((&self.cells, batch, part), (self.material(cell), self.damps(step)));
            integral::integrate(place, n_fields, law, step, want, (memory, point_memory));
        }
        if !M::IS_LINK {
            let mut dets = memory.min_det.0.into_iter().zip(cells);
            if let Some((det, cell)) = dets.find(|(det, _)| *det <= 0.0 || det.is_nan()) {
                return Err(Error::Inverted { cell: self.cells.cells[cell] as usize, det });
            }
        }
        Ok(())
    }

    /// Reads a number of every block that a batch will write: reads that do not wait for each other bring the blocks from memory to
    /// the cache side by side, and the writes find them there (12 % of an assembly of hex8 cells).
    #[inline(always)]
    fn touch(&self, batch: usize, sink: &mut RowPart) {
        let (cells, pairs) = (self.cells.cells_of(batch), self.cells.n_nodes * self.cells.n_nodes);
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
    fn scatter(
        &self,
        batch: usize,
        step: &StepInput<'_>,
        want: Want,
        memory: &BatchMemory,
        sink: &mut RowPart,
    ) {
        let (n, k) = (self.cells.n_nodes, step.rule.degree());
        // The nodes A of neighbouring cells are often neighbours: their rows stand together in memory.
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
                if want == Want::Tangent {
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
        let (n, k) = (self.cells.n_nodes, step.rule.degree());
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

    /// What a displacement does to some batches.
    #[inline(always)]
    fn strained_of<R: Register>(&self, zero: R, batches: Range<usize>, displacement: &[f64]) -> Strained {
        let mut memory = [[Packed([0.0; LANES]); 3]; MAX_NODES];
        let (nodal, mut sum) = (&mut memory[..self.cells.n_nodes], Strained::NONE);
        let (mut energies, mut dets) = (Packed([0.0; LANES]), Packed([f64::INFINITY; LANES]));
        for batch in batches {
            self.cells.gather(
                batch,
                nodal,
                #[inline(always)]
                |node| displacement.as_chunks().0[node],
            );
            let cells = self.cells.cells_of(batch);
            for (part, cell) in cells.clone().step_by(R::WIDTH).enumerate() {
                let place = (&self.cells, batch, part);
                let (energy, det) = integral::strained(zero, place, self.material(cell), nodal);
                energy.store(&mut energies, part);
                if !M::IS_LINK {
                    det.store(&mut dets, part);
                }
            }
            for (lane, cell) in cells.clone().enumerate() {
                let (smallest_determinant, smallest_cell) = (dets.0[lane], self.cells.cells[cell] as usize);
                sum = sum.with(Strained { strain_energy: 0.0, smallest_determinant, smallest_cell });
            }
            sum.strain_energy += energies.0[..cells.len()].iter().sum::<f64>();
        }
        sum
    }

    /// What a displacement does to some batches, added up in an order that does not depend on the threads.
    fn strained_sum(&self, batches: Range<usize>, displacement: &[f64]) -> Strained {
        if batches.len() <= ENERGY_RUN {
            return if M::IS_LINK {
                self.strained_of(0.0, batches, displacement)
            } else {
                Arch::new().dispatch(StrainedSum { term: self, batches, displacement })
            };
        }
        let middle = batches.start + batches.len() / 2;
        let (left, right) = (batches.start..middle, middle..batches.end);
        let sum = |batches| self.strained_sum(batches, displacement);
        let (left, right) = match self.parts.len() {
            1 => (sum(left), sum(right)),
            _ => rayon::join(|| sum(left), || sum(right)),
        };
        left.with(right)
    }
}

/// Which of its memories a part works with.
type MemoryOf<R> = fn(&mut Scratch) -> (&mut BatchMemory, &mut PointMemory<R>);

/// The batches of a part of the rows, in the registers of an instruction set.
struct PartAssembly<'a, M> {
    term: &'a SolidTerm<M>,
    step: &'a StepInput<'a>,
    want: Want,
    batches: &'a [u32],
    scratch: &'a mut Scratch,
    sink: &'a mut RowPart,
}

impl<M: Material> PartAssembly<'_, M> {
    #[inline(always)]
    fn run<R: Register>(
        term: &SolidTerm<M>,
        (step, want): (&StepInput<'_>, Want),
        batches: &[u32],
        (scratch, memory): (&mut Scratch, MemoryOf<R>),
        sink: &mut RowPart,
    ) -> Result<()> {
        for &batch in batches {
            if want == Want::Tangent {
                term.touch(batch as usize, sink);
            }
            let (batch_memory, point_memory) = memory(scratch);
            term.integrate(batch as usize, step, want, batch_memory, point_memory)?;
            if term.damps(step) {
                damping::add(
                    &term.cells,
                    batch as usize,
                    term.dampings(&|cell| term.damping(cell, step)),
                    step,
                    want,
                    scratch,
                );
            }
            term.scatter(batch as usize, step, want, memory(scratch).0, sink);
        }
        Ok(())
    }
}

impl<M: Material> WithSimd for PartAssembly<'_, M> {
    type Output = Result<()>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Result<()> {
        let memory = (self.scratch, Scratch::registers::<Batch<S>> as MemoryOf<Batch<S>>);
        Self::run(self.term, (self.step, self.want), self.batches, memory, self.sink)
    }
}

/// Elasticity of a material at rest; zero of an attraction, which is no stiffness there.
fn at_rest<M: Material>(material: &M) -> Elasticity<f64> {
    let (_, elasticity) = material.stress_and_elasticity(&[0.0; 6]);
    if M::IS_LINK && elasticity[0][0] < 0.0 { [[0.0; 6]; 6] } else { elasticity }
}

/// What a displacement does to some batches, in the registers of an instruction set.
struct StrainedSum<'a, M> {
    term: &'a SolidTerm<M>,
    batches: Range<usize>,
    displacement: &'a [f64],
}

impl<M: Material> WithSimd for StrainedSum<'_, M> {
    type Output = Strained;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Strained {
        self.term.strained_of(Batch::new(simd, 0.0), self.batches, self.displacement)
    }
}

impl<M: Material> Term for SolidTerm<M> {
    fn couplings(&self) -> (&[u32], usize) {
        (&self.cells.nodes, self.cells.n_nodes)
    }

    fn n_points(&self) -> usize {
        self.cells.n_points
    }

    fn attach(&mut self, pattern: &Pattern, parts: &[Range<usize>]) {
        let n = self.cells.n_nodes;
        self.positions = Vec::with_capacity(self.cells.nodes.len() * n);
        for nodes in self.cells.nodes.chunks_exact(n) {
            for &row in nodes {
                let position = |&column: &u32| pattern.position(row as usize, column as usize);
                self.positions.extend(nodes.iter().filter_map(position).map(|position| position as u32));
            }
        }
        let touches = |batch: &u32, rows: &Range<usize>| {
            let cells = self.cells.cells_of(*batch as usize);
            self.cells.nodes[cells.start * n..cells.end * n]
                .iter()
                .any(|&node| rows.contains(&(node as usize)))
        };
        let batches = 0..self.cells.len() as u32;
        self.parts =
            parts.iter().map(|rows| batches.clone().filter(|batch| touches(batch, rows)).collect()).collect();
    }

    fn assemble(
        &self,
        step: &StepInput<'_>,
        want: Want,
        part: usize,
        scratch: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        let batches = &self.parts[part];
        if M::IS_LINK {
            return PartAssembly::run(self, (step, want), batches, (scratch, Scratch::numbers), sink);
        }
        Arch::new().dispatch(PartAssembly { term: self, step, want, batches, scratch, sink })
    }

    fn set_viscosity(&mut self, viscosity: &Viscosity) {
        self.viscosity = *viscosity;
    }

    fn viscosity_and_stiffness(&self) -> [f64; 2] {
        let trace =
            |D: &Elasticity<f64>| (0..6).map(|a| D[a][a]).sum::<f64>() * self.cells.cells.len() as f64;
        [trace(&self.viscosity.tensor(&self.at_rest)), trace(&self.at_rest)]
    }

    fn dissipated(&self, step: &StepInput<'_>, scratch: &mut Scratch) -> f64 {
        if !self.damps(step) {
            return 0.0;
        }
        damping::dissipated(&self.cells, self.dampings(&|cell| self.damping(cell, step)), step, scratch)
    }

    fn add_start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        self.add_start_gradient_of_cells(step, adjoint, gradient);
    }

    fn strained(&self, displacement: &[f64]) -> Strained {
        self.strained_sum(0..self.cells.len(), displacement)
    }
}
