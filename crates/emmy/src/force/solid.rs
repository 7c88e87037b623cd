//! Cells of one kind and one material (for links, one law): the assembly shared by all schemes, materials and elements.

mod pressures;
mod region_material;
mod scatter;
mod start_gradient;
mod start_pressure;

use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::batches::CellBatches;
use super::integral::{self, BatchMemory, CellLaw, PointMemory, RegisterCells, Scratch, projected};
use super::interface::{Book, Force, ForceMemory, Side};
use super::pressures::{PressureCells, PressureNumbers};
use super::projection::Projection;
use super::step::{StepDamping, StepInput};
use super::strain_state::StrainState;
use crate::average::{Damping, Request, VolumeDamping};
use crate::error::{Error, Result};
use crate::input::Viscosity;
use crate::material::{CompiledMaterial, LinkEnergy, Response};
use crate::space::CellTable;
use crate::sparse::{Pattern, RowPart};
use crate::tensor::{Batch, Elasticity, LANES, Packed, Register};

/// Cells of one kind and one material.
#[derive(Debug)]
pub(crate) struct SolidForce {
    materials: Materials,
    /// Elasticity at rest, if there is one material.
    at_rest: Elasticity<f64>,
    viscosity: Viscosity,
    side: Side,
    /// Projection of the volume; `None`: the whole energy is that of the material at the points.
    projection: Option<Projection>,
    pressures: PressureNumbers,
    cells: CellBatches,
    /// Position in the pattern of every pair of nodes, `[cell][A][B]`.
    positions: Vec<u32>,
    /// Batches that touch each part's rows, ascending.
    parts: Vec<Vec<u32>>,
}

#[derive(Debug)]
enum Materials {
    /// One material for all cells.
    Solid(CompiledMaterial),
    /// One material per cell.
    Links(Vec<LinkEnergy>),
}

impl Materials {
    /// The material of a cell for a lane type.
    #[inline(always)]
    fn response<R: Register>(&self, cell: usize) -> &dyn Response<R> {
        match self {
            Materials::Solid(material) => material.response(),
            Materials::Links(links) => &links[cell],
        }
    }

    fn is_links(&self) -> bool {
        matches!(self, Materials::Links(_))
    }

    /// The instruction set to use: links have a material each and are assembled one by one.
    #[inline(always)]
    fn arch(&self) -> Arch {
        if self.is_links() { Arch::Scalar } else { Arch::new() }
    }

    /// Elasticity of the material of a cell at rest; zero for an attraction, which has no stiffness there.
    fn at_rest(&self, cell: usize) -> Elasticity<f64> {
        let mut stress = [0.0; 6];
        let mut elasticity = [[0.0; 6]; 6];
        let material = self.response::<f64>(cell);
        material.stress_and_elasticity(&[0.0; 6], &mut stress, &mut elasticity);
        if material.is_link() && elasticity[0][0] < 0.0 { [[0.0; 6]; 6] } else { elasticity }
    }
}

/// Most nodes that a cell has.
const MAX_NODES: usize = 27;

/// Batches whose energies are summed sequentially; more batches are summed in a binary tree.
const ENERGY_RUN: usize = 64;

impl SolidForce {
    /// The force of a table of cells.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) fn new(material: CompiledMaterial, table: CellTable) -> Result<Self> {
        SolidForce::with_materials(Materials::Solid(material), table)
    }

    /// The same force on a side of the body; one from outside, with links to fixed points, has no damping.
    pub(super) fn on(self, side: Side) -> Self {
        SolidForce { side, ..self }
    }

    /// The same force with the energy of a projected volume beside that of its material.
    pub(crate) fn with_projection(self, projection: Projection) -> Self {
        SolidForce { projection: Some(projection), ..self }
    }

    /// The force of a table of links, with the energy of each.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`].
    pub(crate) fn links(energies: Vec<LinkEnergy>, table: CellTable) -> Result<Self> {
        SolidForce::with_materials(Materials::Links(energies), table)
    }

    fn with_materials(materials: Materials, table: CellTable) -> Result<Self> {
        let cells = CellBatches::new(table)?;
        let at_rest = if cells.cells.is_empty() { [[0.0; 6]; 6] } else { materials.at_rest(0) };
        Ok(SolidForce {
            materials,
            at_rest,
            viscosity: Viscosity::default(),
            side: Side::Inside,
            projection: None,
            pressures: PressureNumbers::default(),
            cells,
            positions: Vec::new(),
            parts: Vec::new(),
        })
    }

    /// Whether a step has terms in the strain rates.
    #[inline(always)]
    fn damps(&self, step: &StepInput<'_>) -> bool {
        let StepDamping { dissipation, inverse_step_size } = step.damping;
        let damps = dissipation > 0.0 || inverse_step_size > 0.0 && !self.viscosity.is_zero();
        damps && self.side == Side::Inside
    }

    /// Damping of a cell in a step; `None` if there is none.
    fn damping(&self, cell: usize, step: &StepInput<'_>) -> Option<Damping> {
        if !self.damps(step) {
            return None;
        }
        let at_rest = if self.materials.is_links() { self.materials.at_rest(cell) } else { self.at_rest };
        let scaled = |tensor: Elasticity<f64>, factor: f64| tensor.map(|row| row.map(|entry| factor * entry));
        let viscous = match self.viscosity.is_zero() {
            true => [[0.0; 6]; 6],
            false => scaled(self.viscosity.tensor(&at_rest), step.damping.inverse_step_size),
        };
        Some(Damping { viscous, dissipative: scaled(at_rest, step.damping.dissipation) })
    }

    /// Damping of the projected volume in a step: that of the stiffness which [`SolidForce::damping`] does not see.
    fn volume_damping(&self, step: &StepInput<'_>) -> Option<VolumeDamping> {
        let modulus = self.projection.as_ref()?.law.modulus();
        let damping = VolumeDamping {
            viscous: self.viscosity.time * step.damping.inverse_step_size * modulus,
            dissipative: step.damping.dissipation * modulus,
        };
        Some(damping).filter(|damping| *damping != VolumeDamping::default())
    }

    /// The cells of a batch, register by register, with the index of the first cell.
    #[inline(always)]
    fn registers<R: Register>(
        &self,
        zero: R,
        batch: usize,
    ) -> impl Iterator<Item = (RegisterCells<'_, R>, usize)> {
        let first_cells = self.cells.cells_of(batch).step_by(R::WIDTH).enumerate();
        first_cells.map(
            #[inline(always)]
            move |(part, cell)| (RegisterCells { cells: &self.cells, batch, part, zero }, cell),
        )
    }

    /// Stage forces and derivatives of a batch, into its memory.
    #[inline(always)]
    fn integrate<R: Register>(
        &self,
        (zero, batch): (R, usize),
        (step, request): (&StepInput<'_>, Request),
        (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
    ) -> Result<()> {
        let n_fields = integral::gather(&self.cells, batch, step, self.damps(step), &mut memory.nodal);
        self.gather_pressures(batch, step, memory);
        let volume_damping = self.volume_damping(step);
        for (cells, cell) in self.registers(zero, batch) {
            let damping = self.damping(cell, step);
            let material = self.materials.response(cell);
            let law = CellLaw { material, damping: damping.as_ref(), volume_damping };
            match &self.projection {
                None => integral::integrate(cells, n_fields, law, (step, request), (memory, point_memory)),
                Some(projection) => {
                    let law = (law, projection);
                    projected::integrate(cells, n_fields, law, (step, request), (memory, point_memory));
                }
            }
        }
        if !self.materials.is_links() {
            let mut dets = memory.min_det.0.into_iter().zip(self.cells.cells_of(batch));
            if let Some((det, cell)) = dets.find(|(det, _)| *det <= 0.0 || det.is_nan()) {
                return Err(Error::Inverted { cell: self.cells.cells[cell] as usize, det });
            }
        }
        Ok(())
    }

    /// Strain energy and smallest det F of some batches.
    #[inline(always)]
    fn strain_state_of<R: Register>(
        &self,
        zero: R,
        batches: Range<usize>,
        displacement: &[f64],
    ) -> StrainState {
        let mut memory = [[Packed([0.0; LANES]); 3]; MAX_NODES];
        let nodal = &mut memory[..self.cells.n_nodes];
        let mut sum = StrainState::NONE;
        let mut energies = Packed([0.0; LANES]);
        let mut dets = Packed([f64::INFINITY; LANES]);
        for batch in batches {
            self.cells.gather(
                batch,
                nodal,
                #[inline(always)]
                |node| displacement.as_chunks().0[node],
            );
            for (cells, cell) in self.registers(zero, batch) {
                let material = self.materials.response(cell);
                let (energy, det) = match &self.projection {
                    None => integral::strain_state(cells, material, nodal),
                    Some(projection) => projected::strain_state(cells, material, projection, nodal),
                };
                energy.store(&mut energies, cells.part);
                if !self.materials.is_links() {
                    det.store(&mut dets, cells.part);
                }
            }
            let cells = self.cells.cells_of(batch);
            for (lane, cell) in cells.clone().enumerate() {
                let smallest_determinant = dets.0[lane];
                let smallest_cell = self.cells.cells[cell] as usize;
                sum = sum.with(StrainState { smallest_determinant, smallest_cell, ..StrainState::NONE });
            }
            sum.strain_energy += energies.0[..cells.len()].iter().sum::<f64>();
        }
        sum
    }

    /// Strain energy and smallest det F of some batches, summed in an order that does not depend on the threads.
    fn strain_state_sum(&self, batches: Range<usize>, displacement: &[f64]) -> StrainState {
        if batches.len() <= ENERGY_RUN {
            return self.materials.arch().dispatch(StrainStateSum { force: self, batches, displacement });
        }
        let middle = batches.start + batches.len() / 2;
        let left = batches.start..middle;
        let right = middle..batches.end;
        let sum = |batches| self.strain_state_sum(batches, displacement);
        let (left, right) = match self.parts.len() {
            1 => (sum(left), sum(right)),
            _ => rayon::join(|| sum(left), || sum(right)),
        };
        left.with(right)
    }

    /// Energy that the damping of all cells dissipates in a step.
    #[inline(always)]
    fn dissipated_in<R: Register>(
        &self,
        zero: R,
        step: &StepInput<'_>,
        (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
    ) -> f64 {
        let mut sum = 0.0;
        let mut energies = Packed([0.0; LANES]);
        let volume_damping = self.volume_damping(step);
        for batch in 0..self.cells.len() {
            integral::gather(&self.cells, batch, step, true, &mut memory.nodal);
            for (cells, cell) in self.registers(zero, batch) {
                let Some(damping) = self.damping(cell, step) else { continue };
                let mut energy = integral::dissipated(cells, &damping, step, (memory, point_memory));
                if let Some(volume) = volume_damping.as_ref().zip(self.projection.as_ref()) {
                    energy += projected::dissipated(cells, volume, step, (memory, point_memory));
                }
                energy.store(&mut energies, cells.part);
            }
            sum += energies.0[..self.cells.cells_of(batch).len()].iter().sum::<f64>();
        }
        sum
    }
}

/// The batches of a part of the rows, in the registers of an instruction set.
struct PartAssembly<'a> {
    force: &'a SolidForce,
    step: &'a StepInput<'a>,
    request: Request,
    part: usize,
    scratch: &'a mut Scratch,
    sink: &'a mut RowPart,
}

impl WithSimd for PartAssembly<'_> {
    type Output = Result<()>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Result<()> {
        let PartAssembly { force, step, request, part, scratch, sink } = self;
        let (memory, point_memory, results) = scratch.of::<Batch<S>>();
        for batch in force.parts[part].iter().map(|batch| *batch as usize) {
            if request == Request::Tangent {
                force.touch(batch, sink);
            }
            force.integrate((Batch::new(simd, 0.0), batch), (step, request), (memory, point_memory))?;
            force.scatter(batch, step, request, memory, sink);
            force.save_pressures((batch, part), step, request, memory, results);
        }
        Ok(())
    }
}

/// Strain energy and smallest det F of some batches, in the registers of an instruction set.
struct StrainStateSum<'a> {
    force: &'a SolidForce,
    batches: Range<usize>,
    displacement: &'a [f64],
}

impl WithSimd for StrainStateSum<'_> {
    type Output = StrainState;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> StrainState {
        self.force.strain_state_of(Batch::new(simd, 0.0), self.batches, self.displacement)
    }
}

/// Dissipated energy of all cells, in the registers of an instruction set.
struct Dissipated<'a> {
    force: &'a SolidForce,
    step: &'a StepInput<'a>,
    scratch: &'a mut Scratch,
}

impl WithSimd for Dissipated<'_> {
    type Output = f64;
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let (memory, point_memory, _) = self.scratch.of();
        self.force.dissipated_in(Batch::new(simd, 0.0), self.step, (memory, point_memory))
    }
}

impl SolidForce {
    /// Looks up the positions of the nodes of its cells in the pattern, and the batches that touch the rows of each
    /// part.
    pub(crate) fn attach(&mut self, pattern: &Pattern, parts: &[Range<usize>]) {
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

    /// Numbers the pressures: the force is `index` among those with pressures, and its functions begin with `first`.
    pub(super) fn number_pressures(&mut self, index: usize, first: usize, parts: &[Range<usize>]) {
        self.pressures = self.numbered(index, first, parts);
    }

    /// Gives the cells a viscosity.
    pub(super) fn set_viscosity(&mut self, viscosity: &Viscosity) {
        self.viscosity = *viscosity;
    }

    /// Traces of viscosity and elasticity at rest, times the number of cells.
    pub(crate) fn viscosity_and_stiffness(&self) -> [f64; 2] {
        // The elasticity K I (x) I of a projected volume has the trace 3 K.
        let volume = 3.0 * self.projection.as_ref().map_or(0.0, |projection| projection.law.modulus());
        let trace = |D: &Elasticity<f64>, volume: f64| {
            ((0..6).map(|a| D[a][a]).sum::<f64>() + volume) * self.cells.cells.len() as f64
        };
        let viscosity = self.viscosity.tensor(&self.at_rest);
        [trace(&viscosity, self.viscosity.time * volume), trace(&self.at_rest, volume)]
    }
}

impl Force for SolidForce {
    fn book(&self) -> Book {
        Book::Stored
    }

    fn side(&self) -> Side {
        self.side
    }

    fn scratch_size(&self) -> [usize; 2] {
        [self.cells.n_nodes, self.cells.n_points]
    }

    fn assemble(
        &self,
        (step, request): (&StepInput<'_>, Request),
        _: &ForceMemory,
        part: usize,
        scratch: &mut Scratch,
        sink: &mut RowPart,
    ) -> Result<()> {
        self.materials.arch().dispatch(PartAssembly { force: self, step, request, part, scratch, sink })
    }

    fn dissipates(&self) -> bool {
        !self.viscosity.is_zero()
    }

    fn without_adjoint(&self) -> Option<&'static str> {
        (!self.viscosity.is_zero()).then_some("viscosity and drag are not covered")
    }

    fn dissipated(&self, step: &StepInput<'_>, scratch: &mut Scratch) -> f64 {
        if !self.damps(step) {
            return 0.0;
        }
        self.materials.arch().dispatch(Dissipated { force: self, step, scratch })
    }

    fn add_start_gradient(&self, step: &StepInput<'_>, adjoint: &[f64], gradient: &mut [f64]) {
        self.add_start_gradient_of_cells(step, adjoint, gradient);
    }

    fn strain_state(&self, displacement: &[f64], _: &[f64]) -> StrainState {
        self.strain_state_sum(0..self.cells.len(), displacement)
    }

    fn pressure_cells(&self) -> Option<PressureCells<'_>> {
        self.projection.as_ref()?;
        let CellBatches { cells, nodes, n_nodes, .. } = &self.cells;
        let viscous_time = self.viscosity.time;
        Some(PressureCells { cells, nodes, n_nodes: *n_nodes, numbers: &self.pressures, viscous_time })
    }
}
