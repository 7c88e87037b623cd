//! Stage forces of cells with a projected volume: one pass over the points for the volume, one for the stress.

use super::{BatchMemory, CellLaw, PointMemory, RegisterCells, set_forces_of_stages, vector};
use crate::average::{Request, Rule, VolumeAverage, VolumeDamping};
use crate::force::projection::Projection;
use crate::force::step::StepInput;
use crate::tensor::{LANES, Mat3, Packed, Register, Sym, dot3, green_lagrange};

/// Results of a batch that only projected volumes have; `n`: number of pressures of a function in a step.
#[derive(Debug, Default)]
pub(crate) struct VolumeMemory {
    /// Pressures pi of the step, `[function][n]`.
    pub given: Vec<Packed>,
    /// Pressures of the deformation, `[function][n]`.
    pub pressures: Vec<Packed>,
    /// Forces of unit pressures, `[function][n][n_nodes][3]`.
    pub forces: Vec<[Packed; 3]>,
    /// Derivatives of the pressures by the rates, `[function][n][k][n_nodes][3]`.
    pub responses: Vec<[Packed; 3]>,
    /// Derivatives of the volumes by the rates, like `responses`.
    volumes: Vec<[Packed; 3]>,
    /// Derivatives of the pressures by the volumes, `[function a][n l][function b][n m]`.
    stiffness: Vec<Packed>,
}

const ZERO: Packed = Packed([0.0; LANES]);

impl VolumeMemory {
    /// Makes room for the pressures of a rule in cells of a projection.
    pub(crate) fn fit(&mut self, rule: &Rule, n_functions: usize, n_nodes: usize) {
        let n = n_functions * rule.n_pressures();
        let k = rule.degree();
        if self.given.len() != n || self.responses.len() != n * k * n_nodes {
            self.given.resize(n, ZERO);
            self.pressures.resize(n, ZERO);
            self.forces.resize(n * n_nodes, [ZERO; 3]);
            self.responses.resize(n * k * n_nodes, [ZERO; 3]);
            self.volumes.resize(n * k * n_nodes, [ZERO; 3]);
            self.stiffness.resize(n * n, ZERO);
        }
    }

    /// Sets the sums over the points to zero.
    fn clear(&mut self, request: Request) {
        self.pressures.fill(ZERO);
        if request == Request::Tangent {
            self.forces.fill([ZERO; 3]);
            self.responses.fill([ZERO; 3]);
            self.volumes.fill([ZERO; 3]);
            self.stiffness.fill(ZERO);
        }
    }
}

/// Working memory of the cells of a register.
#[derive(Debug)]
pub(super) struct VolumeRegisters<R> {
    volume: VolumeAverage<R>,
    /// Displacement gradient and rates at every point, `[point][n_fields]`.
    gradients: Vec<Mat3<R>>,
    /// Displacement gradients and stresses of unit pressures at every point, `[point][n]`.
    unit_stresses: Vec<(Mat3<R>, Sym<R>)>,
    /// Volumes of the cell, `[function][1 + n]`: at the start, then as in [`VolumeAverage::change`].
    of_cell: Vec<R>,
    /// Rates of these volumes, `[function][n]`; for a damping alone.
    rates: Vec<R>,
    /// The volumes at a point, `[1 + n]`.
    of_point: Vec<R>,
    pressure: Vec<R>,
    stiffness: Vec<R>,
    /// Forces of unit pressures and responses of the volumes at a point, `[n]`, `[n k]`.
    forces: Vec<Mat3<R>>,
    responses: Vec<Mat3<R>>,
}

impl<R: Register> VolumeRegisters<R> {
    fn new(rule: &Rule, n_points: usize, n_functions: usize, zero: R) -> Self {
        let n = rule.n_pressures();
        let k = rule.degree();
        VolumeRegisters {
            volume: VolumeAverage::new(rule, zero),
            gradients: vec![[[zero; 3]; 3]; n_points * (1 + k)],
            unit_stresses: vec![([[zero; 3]; 3], [zero; 6]); n_points * n],
            of_cell: vec![zero; n_functions * (1 + n)],
            rates: vec![zero; n_functions * n],
            of_point: vec![zero; 1 + n],
            pressure: vec![zero; n],
            stiffness: vec![zero; n * n],
            forces: vec![[[zero; 3]; 3]; n],
            responses: vec![[[zero; 3]; 3]; n * k],
        }
    }

    /// The registers for cells of a projection, made when they are needed first.
    fn of<'a>(
        kept: &'a mut Option<Self>,
        rule: &Rule,
        cells: RegisterCells<'_, R>,
        projection: &Projection,
    ) -> &'a mut Self {
        let (n_points, n_functions) = (cells.cells.n_points, projection.n_functions);
        if kept.as_ref().is_some_and(|registers| !registers.fits(rule, n_points, n_functions)) {
            *kept = None;
        }
        kept.get_or_insert_with(|| VolumeRegisters::new(rule, n_points, n_functions, cells.zero))
    }

    fn fits(&self, rule: &Rule, n_points: usize, n_functions: usize) -> bool {
        self.pressure.len() == rule.n_pressures()
            && self.gradients.len() >= n_points * (1 + rule.degree())
            && self.unit_stresses.len() >= n_points * rule.n_pressures()
            && self.of_cell.len() == n_functions * self.of_point.len()
    }
}

/// [`super::integrate`] for cells with a projected volume; takes the pressures in `given` if `is_given`.
#[inline(always)]
pub(crate) fn integrate<R: Register>(
    cells: RegisterCells<'_, R>,
    n_fields: usize,
    (law, projection): (CellLaw<'_, R>, &Projection),
    (step, request): (&StepInput<'_>, Request),
    (memory, point_memory): (&mut BatchMemory, &mut PointMemory<R>),
) {
    let rule = step.rule;
    let n_points = cells.cells.n_points;
    let damping = law.volume_damping.as_ref();
    let registers = VolumeRegisters::of(&mut point_memory.volume, rule, cells, projection);
    if cells.part == 0 {
        memory.volume.clear(request);
    }
    set_volumes(cells, n_fields, (projection, damping), step, memory, registers);
    set_pressures(cells, projection, (step, request), &mut memory.volume, registers);
    if let Some(damping) = damping {
        add_damping(cells, damping, (rule, request), &mut memory.volume, registers);
    }
    let mut min_det = cells.zero.splat(f64::INFINITY);
    for point in 0..n_points {
        let fields = &registers.gradients[point * n_fields..(point + 1) * n_fields];
        let (start, rates) = (&fields[0], &fields[1..]);
        let average = &mut point_memory.average;
        law.average(rule, start, rates, request, average);
        let volume = &mut registers.volume;
        if request == Request::Tangent {
            rule.set_volume(projection.law.measure(), start, rates, request, volume);
        } else {
            let n = registers.pressure.len();
            volume.take_unit_stresses(&registers.unit_stresses[point * n..(point + 1) * n]);
        }
        set_point_pressure(
            cells,
            projection,
            point,
            step.local.is_some(),
            &memory.volume,
            &mut registers.pressure,
        );
        rule.add_pressure(&registers.pressure, volume, rates, request, average);
        min_det = min_det.min(average.min_det);
        cells.add_average(point, average, &law, (step, request), memory);
        if request == Request::Tangent {
            rule.pressure_force(volume, &mut registers.forces);
            rule.volume_response(volume, rates, &mut registers.responses);
            add_unit_forces(cells, projection, point, memory, registers);
            if let Some(damping) = damping.filter(|_| !rule.changes_are_rates()) {
                rule.volume_rate_response(&registers.volume, rates, &mut registers.responses);
                add_rate_responses(cells, projection, point, damping, memory, registers);
            }
        }
    }
    min_det.store(&mut memory.min_det, cells.part);
    if request == Request::Tangent {
        set_responses(cells, &mut memory.volume);
        add_coupling(cells, &law, step, memory);
    }
    set_forces_of_stages(cells, rule.degree(), memory);
}

/// Projected volumes of the cells.
#[inline(always)]
fn set_volumes<R: Register>(
    cells: RegisterCells<'_, R>,
    n_fields: usize,
    (projection, damping): (&Projection, Option<&VolumeDamping>),
    step: &StepInput<'_>,
    memory: &BatchMemory,
    registers: &mut VolumeRegisters<R>,
) {
    let n = cells.cells.n_nodes;
    let VolumeRegisters { volume, gradients, unit_stresses, of_cell, rates, .. } = registers;
    of_cell.fill(cells.zero);
    rates.fill(cells.zero);
    let n_volumes = 1 + volume.change.len();
    for point in 0..cells.cells.n_points {
        let fields = &mut gradients[point * n_fields..(point + 1) * n_fields];
        cells.set_field_gradients(point, &memory.nodal[..n_fields * n], fields);
        step.rule.set_volume(projection.law.measure(), &fields[0], &fields[1..], Request::Stress, volume);
        volume.save_unit_stresses(&mut unit_stresses[point * (n_volumes - 1)..]);
        let weight = cells.weight(point);
        if damping.is_some() {
            let of_point: &[R] = if step.rule.changes_are_rates() {
                &volume.change
            } else {
                step.rule.set_volume_rates(&fields[1..], volume);
                &volume.rate
            };
            let functions = projection.at(cells.batch, point).iter();
            for (psi, sums) in functions.zip(rates.chunks_exact_mut(n_volumes - 1)) {
                let psi = cells.zero.load(psi, cells.part) * weight;
                sums.iter_mut().zip(of_point).for_each(|(sum, rate)| *sum = psi.mul_add(*rate, *sum));
            }
        }
        for (psi, sums) in projection.at(cells.batch, point).iter().zip(of_cell.chunks_exact_mut(n_volumes)) {
            let psi = cells.zero.load(psi, cells.part) * weight;
            sums[0] = psi.mul_add(volume.start, sums[0]);
            for (sum, change) in sums[1..].iter_mut().zip(&volume.change) {
                *sum = psi.mul_add(*change, *sum);
            }
        }
    }
}

/// Pressures of the projected volumes, and their derivatives by them.
#[inline(always)]
fn set_pressures<R: Register>(
    cells: RegisterCells<'_, R>,
    projection: &Projection,
    (step, request): (&StepInput<'_>, Request),
    memory: &mut VolumeMemory,
    registers: &mut VolumeRegisters<R>,
) {
    let (zero, part) = (cells.zero, cells.part);
    let VolumeRegisters { of_cell, of_point, pressure, stiffness, .. } = registers;
    let n = pressure.len();
    // A constant volume is that of any point, with the weight of the whole cell.
    let is_constant = projection.n_functions == 1;
    for point in 0..if is_constant { 1 } else { cells.cells.n_points } {
        let functions = projection.at(cells.batch, point);
        of_point.fill(zero);
        for (psi, of_cell) in functions.iter().zip(of_cell.chunks_exact(1 + n)) {
            let psi = zero.load(psi, part);
            for (sum, volume) in of_point.iter_mut().zip(of_cell) {
                *sum = psi.mul_add(*volume, *sum);
            }
        }
        let law = &projection.law;
        step.rule.mean_pressure(law, of_point[0], &of_point[1..], request, pressure, stiffness);
        let one = zero.splat(1.0);
        let weight = if is_constant {
            let psi = zero.load(&functions[0], part);
            one / (psi * psi)
        } else {
            cells.weight(point)
        };
        for (a, psi) in functions.iter().enumerate() {
            let psi = zero.load(psi, part) * weight;
            for (sum, p) in memory.pressures[a * n..(a + 1) * n].iter_mut().zip(&*pressure) {
                psi.mul_add(*p, zero.load(sum, part)).store(sum, part);
            }
            if request == Request::Stress {
                continue;
            }
            for (b, other) in functions.iter().enumerate() {
                let factor = zero.load(other, part) * psi;
                for (l, m) in (0..n * n).map(|at| (at / n, at % n)) {
                    let sum = &mut memory.stiffness[((a * n + l) * functions.len() + b) * n + m];
                    factor.mul_add(stiffness[l * n + m], zero.load(sum, part)).store(sum, part);
                }
            }
        }
    }
}

/// Adds the pressures of a damping, and their derivatives by the rates of the volume if these are the changes of
/// volume.
#[inline(always)]
fn add_damping<R: Register>(
    cells: RegisterCells<'_, R>,
    damping: &VolumeDamping,
    (rule, request): (&Rule, Request),
    memory: &mut VolumeMemory,
    registers: &VolumeRegisters<R>,
) {
    let (zero, part) = (cells.zero, cells.part);
    let n = registers.pressure.len();
    let n_all = registers.rates.len();
    for (index, rate) in registers.rates.iter().enumerate() {
        let (a, m) = (index / n, index % n);
        for l in 0..n {
            let factor = zero.splat(rule.volume_damping(damping, l, m));
            let sum = &mut memory.pressures[a * n + l];
            factor.mul_add(*rate, zero.load(sum, part)).store(sum, part);
            if request == Request::Tangent && rule.changes_are_rates() {
                let sum = &mut memory.stiffness[(a * n + l) * n_all + index];
                (zero.load(sum, part) + factor).store(sum, part);
            }
        }
    }
}

/// Adds a point to the derivatives of the pressures of a viscosity by the rates, which a standard rule has beside its
/// volumes.
#[inline(always)]
fn add_rate_responses<R: Register>(
    cells: RegisterCells<'_, R>,
    projection: &Projection,
    point: usize,
    damping: &VolumeDamping,
    memory: &mut BatchMemory,
    registers: &VolumeRegisters<R>,
) {
    let n = cells.cells.n_nodes;
    let weight = cells.weight(point) * damping.viscous;
    let size = registers.responses.len() * n;
    for (a, psi) in projection.at(cells.batch, point).iter().enumerate() {
        let factor = cells.zero.load(psi, cells.part) * weight;
        let sums = &mut memory.volume.responses[a * size..];
        add_divergences(&registers.responses, &memory.gradients[..n], factor, sums, cells.part);
    }
}

/// Energy that a damping dissipates in the cells of a register in a step, from the nodal fields in their memory.
#[inline(always)]
pub(crate) fn dissipated<R: Register>(
    cells: RegisterCells<'_, R>,
    (damping, projection): (&VolumeDamping, &Projection),
    step: &StepInput<'_>,
    (memory, point_memory): (&BatchMemory, &mut PointMemory<R>),
) -> R {
    let rule = step.rule;
    let registers = VolumeRegisters::of(&mut point_memory.volume, rule, cells, projection);
    set_volumes(cells, 1 + rule.degree(), (projection, Some(damping)), step, memory, registers);
    let n = registers.pressure.len();
    let mut energy = cells.zero;
    for rates in registers.rates.chunks_exact(n) {
        for (l, m) in (0..n * n).map(|at| (at / n, at % n)) {
            let factor = rule.pressure_work_weight(l) * rule.volume_damping(damping, l, m);
            energy += rates[l] * rates[m] * factor;
        }
    }
    energy
}

/// The pressures of the step at a point, or those of the deformation.
#[inline(always)]
fn set_point_pressure<R: Register>(
    cells: RegisterCells<'_, R>,
    projection: &Projection,
    point: usize,
    is_given: bool,
    memory: &VolumeMemory,
    pressure: &mut [R],
) {
    let (zero, part) = (cells.zero, cells.part);
    let of_cell = if is_given { &memory.given } else { &memory.pressures };
    pressure.fill(zero);
    for (psi, of_cell) in projection.at(cells.batch, point).iter().zip(of_cell.chunks_exact(pressure.len())) {
        let psi = zero.load(psi, part);
        for (sum, p) in pressure.iter_mut().zip(of_cell) {
            *sum = psi.mul_add(zero.load(p, part), *sum);
        }
    }
}

/// Adds a point to the forces of unit pressures and to the responses of the volumes.
#[inline(always)]
fn add_unit_forces<R: Register>(
    cells: RegisterCells<'_, R>,
    projection: &Projection,
    point: usize,
    memory: &mut BatchMemory,
    registers: &VolumeRegisters<R>,
) {
    let (zero, part, n) = (cells.zero, cells.part, cells.cells.n_nodes);
    let weight = cells.weight(point);
    let gradients = &memory.gradients[..n];
    let of_function = registers.forces.len() * n;
    for (a, psi) in projection.at(cells.batch, point).iter().enumerate() {
        let factor = zero.load(psi, part) * weight;
        let forces = &mut memory.volume.forces[a * of_function..];
        add_divergences(&registers.forces, gradients, factor, forces, part);
        let volumes = &mut memory.volume.volumes[a * registers.responses.len() * n..];
        add_divergences(&registers.responses, gradients, factor, volumes, part);
    }
}

/// Adds `factor T grad N_A` for each tensor T, to `[tensor][n_nodes][3]`.
#[inline(always)]
fn add_divergences<R: Register>(
    tensors: &[Mat3<R>],
    gradients: &[[Packed; 3]],
    factor: R,
    sums: &mut [[Packed; 3]],
    part: usize,
) {
    for (T, sums) in tensors.iter().zip(sums.chunks_exact_mut(gradients.len())) {
        for (gradient, sum) in gradients.iter().zip(sums) {
            let gradient = vector(factor, gradient, part);
            for i in 0..3 {
                let term = dot3(T[i], gradient);
                factor.mul_add(term, factor.load(&sum[i], part)).store(&mut sum[i], part);
            }
        }
    }
}

/// Derivatives of the pressures by the rates, `W = Y dtheta/dx`, added to those of a viscosity.
#[inline(always)]
fn set_responses<R: Register>(cells: RegisterCells<'_, R>, memory: &mut VolumeMemory) {
    let (zero, part) = (cells.zero, cells.part);
    let VolumeMemory { pressures, responses, volumes, stiffness, .. } = memory;
    let size = responses.len() / pressures.len();
    for (response, row) in responses.chunks_exact_mut(size).zip(stiffness.chunks_exact(pressures.len())) {
        for at in 0..3 * size {
            let mut sum = zero.load(&response[at / 3][at % 3], part);
            for (volume, y) in volumes.chunks_exact(size).zip(row) {
                sum = zero.load(y, part).mul_add(zero.load(&volume[at / 3][at % 3], part), sum);
            }
            sum.store(&mut response[at / 3][at % 3], part);
        }
    }
}

/// Adds the part of the tangent through the pressures, `sum_l weight_il g_l (x) W_lj`.
#[inline(always)]
fn add_coupling<R: Register>(
    cells: RegisterCells<'_, R>,
    law: &CellLaw<'_, R>,
    step: &StepInput<'_>,
    memory: &mut BatchMemory,
) {
    let (zero, part, n) = (cells.zero, cells.part, cells.cells.n_nodes);
    let rule = step.rule;
    let k = rule.degree();
    let skips = rule.is_symmetric(law.damping.is_some());
    let BatchMemory { volume, stiffness, .. } = memory;
    let pressures = volume.forces.chunks_exact(n).zip(volume.responses.chunks_exact(n * k));
    for (index, (force, responses)) in pressures.enumerate() {
        for i in 0..k {
            let weight = rule.pressure_weight(i, index % rule.n_pressures()) * step.tangent_factor;
            if weight == 0.0 {
                continue;
            }
            for (j, response) in responses.chunks_exact(n).enumerate() {
                let blocks = &mut stiffness[(i * k + j) * n * n..(i * k + j + 1) * n * n];
                for A in 0..n {
                    let g = vector(zero, &force[A], part);
                    let g = [g[0] * weight, g[1] * weight, g[2] * weight];
                    let first = if skips { A } else { 0 };
                    for (block, w) in blocks[A * n + first..(A + 1) * n].iter_mut().zip(&response[first..]) {
                        let w = vector(zero, w, part);
                        for entry in 0..9 {
                            let sum = g[entry / 3].mul_add(w[entry % 3], zero.load(&block[entry], part));
                            sum.store(&mut block[entry], part);
                        }
                    }
                }
            }
        }
    }
}

/// [`super::strain_state`] for cells with a projected volume.
#[inline(always)]
pub(crate) fn strain_state<R: Register>(
    cells: RegisterCells<'_, R>,
    material: &dyn crate::material::Response<R>,
    projection: &Projection,
    nodal: &[[Packed; 3]],
) -> (R, R) {
    let (zero, part) = (cells.zero, cells.part);
    let (mut energy, min_det) = super::strain_state(cells, material, nodal);
    let mut of_cell = [zero; MAX_FUNCTIONS];
    let mut G = [[[zero; 3]; 3]];
    for point in 0..cells.cells.n_points {
        cells.set_field_gradients(point, nodal, &mut G);
        let volume = projection.law.measure().change(&green_lagrange(&G[0])) * cells.weight(point);
        for (psi, sum) in projection.at(cells.batch, point).iter().zip(&mut of_cell) {
            *sum = zero.load(psi, part).mul_add(volume, *sum);
        }
    }
    for point in 0..cells.cells.n_points {
        let mut volume = zero;
        for (psi, of_cell) in projection.at(cells.batch, point).iter().zip(&of_cell) {
            volume = zero.load(psi, part).mul_add(*of_cell, volume);
        }
        energy = projection.law.energy(volume).mul_add(cells.weight(point), energy);
    }
    (energy, min_det)
}

/// Most functions of the pressure that a cell has.
const MAX_FUNCTIONS: usize = 4;
