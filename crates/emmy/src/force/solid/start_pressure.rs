//! The part of the derivatives by the start of a step that comes through a projected volume.

use super::start_gradient::CellMemory;
use crate::average::{Request, Rule, VolumeAverage, VolumeStart};
use crate::force::integral::RegisterCells;
use crate::force::projection::Projection;
use crate::force::step::StepInput;
use crate::tensor::Mat3;

/// Working memory of a cell with a projected volume; n: number of pressures of a function in a step.
pub(super) struct VolumeMemory {
    volume: VolumeAverage<f64>,
    start: VolumeStart,
    /// Volumes, `[function][1 + n]`: at the start, then as in [`VolumeAverage::change`].
    volumes: Vec<f64>,
    /// Pressures, and the derivatives of the goal by them, `[function][n]`.
    pressures: Vec<f64>,
    by_pressures: Vec<f64>,
    /// Derivatives of the goal by the volumes, like them.
    by_volumes: Vec<f64>,
    /// Volumes and pressures at a point, the derivatives of the latter, and the forces of unit pressures.
    at_point: Vec<f64>,
    pressure: Vec<f64>,
    stiffness: Vec<f64>,
    slope: Vec<f64>,
    forces: Vec<Mat3<f64>>,
}

impl VolumeMemory {
    pub(super) fn new(rule: &Rule, projection: &Projection) -> Self {
        let (n, n_functions) = (rule.n_pressures(), projection.n_functions);
        VolumeMemory {
            volume: VolumeAverage::new(rule, 0.0),
            start: VolumeStart::new(rule),
            volumes: vec![0.0; n_functions * (1 + n)],
            pressures: vec![0.0; n_functions * n],
            by_pressures: vec![0.0; n_functions * n],
            by_volumes: vec![0.0; n_functions * (1 + n)],
            at_point: vec![0.0; 1 + n],
            pressure: vec![0.0; n],
            stiffness: vec![0.0; n * n],
            slope: vec![0.0; n],
            forces: vec![[[0.0; 3]; 3]; n],
        }
    }

    /// Computes volumes and pressures of a cell, and the derivatives of `sum_i f_i . mu_i` by both.
    pub(super) fn set_cell(
        &mut self,
        cells: RegisterCells<'_, f64>,
        projection: &Projection,
        step: &StepInput<'_>,
        memory: &mut CellMemory,
    ) {
        let rule = step.rule;
        let n = rule.n_pressures();
        for list in [&mut self.volumes, &mut self.pressures, &mut self.by_pressures, &mut self.by_volumes] {
            list.fill(0.0);
        }
        for point in 0..cells.cells.n_points {
            cells.set_field_gradients(point, &memory.nodal, &mut memory.gradients);
            self.set_volume(projection, step, memory);
            let (weight, functions) = (cells.weight(point), functions(cells, projection, point));
            rule.pressure_force(&self.volume, &mut self.forces);
            let adjoints = &memory.gradients[1 + rule.degree()..];
            for (a, psi) in functions.enumerate() {
                let volumes = &mut self.volumes[a * (1 + n)..];
                volumes[0] += weight * psi * self.volume.start;
                for (l, (change, force)) in self.volume.change.iter().zip(&self.forces).enumerate() {
                    volumes[1 + l] += weight * psi * change;
                    let work = |(i, mu): (usize, &Mat3<f64>)| rule.pressure_weight(i, l) * product(force, mu);
                    let work: f64 = adjoints.iter().enumerate().map(work).sum();
                    self.by_pressures[a * n + l] += weight * psi * work;
                }
            }
        }
        for point in 0..cells.cells.n_points {
            self.set_point_pressure(cells, projection, point, rule);
            self.add_point_pressure(cells, projection, point);
        }
    }

    fn set_volume(&mut self, projection: &Projection, step: &StepInput<'_>, memory: &CellMemory) {
        let (start, rates) = (&memory.gradients[0], &memory.gradients[1..1 + step.rule.degree()]);
        let measure = projection.law.measure();
        step.rule.set_volume(measure, start, rates, Request::Tangent, &mut self.volume);
        step.rule.set_volume_start(measure, start, rates, &self.volume, &mut self.start);
    }

    /// Sets the pressures at a point and their derivatives.
    fn set_point_pressure(
        &mut self,
        cells: RegisterCells<'_, f64>,
        projection: &Projection,
        point: usize,
        rule: &Rule,
    ) {
        self.at_point.fill(0.0);
        for (psi, of_cell) in
            functions(cells, projection, point).zip(self.volumes.chunks_exact(self.at_point.len()))
        {
            self.at_point.iter_mut().zip(of_cell).for_each(|(sum, volume)| *sum += psi * volume);
        }
        let (start, change) = (self.at_point[0], &self.at_point[1..]);
        let law = &projection.law;
        rule.mean_pressure(law, start, change, Request::Tangent, &mut self.pressure, &mut self.stiffness);
        rule.mean_pressure_start(law, start, change, &mut self.slope);
    }

    /// Adds a point to the pressures of the cell, and to the derivatives by its volumes.
    fn add_point_pressure(&mut self, cells: RegisterCells<'_, f64>, projection: &Projection, point: usize) {
        let n = self.pressure.len();
        let weight = cells.weight(point);
        let mut by_volume = std::mem::take(&mut self.at_point);
        by_volume.fill(0.0);
        for l in 0..n {
            let of_cell = functions(cells, projection, point).enumerate();
            let by_pressure: f64 = of_cell.map(|(a, psi)| psi * self.by_pressures[a * n + l]).sum();
            by_volume[0] += weight * by_pressure * self.slope[l];
            for m in 0..n {
                by_volume[1 + m] += weight * by_pressure * self.stiffness[l * n + m];
            }
        }
        for (a, psi) in functions(cells, projection, point).enumerate() {
            let sums = &mut self.by_volumes[a * (1 + n)..(a + 1) * (1 + n)];
            sums.iter_mut().zip(&by_volume).for_each(|(sum, value)| *sum += psi * value);
            let sums = &mut self.pressures[a * n..(a + 1) * n];
            sums.iter_mut().zip(&self.pressure).for_each(|(sum, p)| *sum += weight * psi * p);
        }
        self.at_point = by_volume;
    }

    /// Adds the stress of the pressures at a point to its derivatives by the start, and the part through the volumes to
    /// `T`, times the weight of the point.
    pub(super) fn add_point(
        &mut self,
        (cells, point): (RegisterCells<'_, f64>, usize),
        projection: &Projection,
        step: &StepInput<'_>,
        memory: &mut CellMemory,
        T: &mut [f64; 9],
    ) {
        let n = self.pressure.len();
        self.set_volume(projection, step, memory);
        self.pressure.fill(0.0);
        let weight = cells.weight(point);
        for (a, psi) in functions(cells, projection, point).enumerate() {
            let pressures = &self.pressures[a * n..(a + 1) * n];
            self.pressure.iter_mut().zip(pressures).for_each(|(sum, p)| *sum += psi * p);
            let by_volumes = &self.by_volumes[a * (1 + n)..];
            let of_start = (&self.start.start, by_volumes[0]);
            let of_changes = self.start.change.iter().zip(by_volumes[1..].iter().copied());
            for (derivative, by_volume) in std::iter::once(of_start).chain(of_changes) {
                let entries = T.iter_mut().zip(derivative.as_flattened());
                entries.for_each(|(sum, entry)| *sum += weight * psi * by_volume * entry);
            }
        }
        let fields = (&memory.gradients[0], &memory.gradients[1..1 + step.rule.degree()]);
        let tangent = &mut memory.start_tangent;
        step.rule.add_pressure_start(&self.pressure, &self.volume, &self.start, fields, tangent);
    }
}

/// Functions of a cell at a point.
fn functions<'a>(
    cells: RegisterCells<'_, f64>,
    projection: &'a Projection,
    point: usize,
) -> impl Iterator<Item = f64> + 'a {
    let part = cells.part;
    projection.at(cells.batch, point).iter().map(move |packed| packed.0[part])
}

fn product(A: &Mat3<f64>, B: &Mat3<f64>) -> f64 {
    A.as_flattened().iter().zip(B.as_flattened()).map(|(a, b)| a * b).sum()
}
