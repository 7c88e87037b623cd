//! Cells: gradients of the shape functions, masses, the part of the energy at the points and the projected one.

use super::{Cell, Formulation, Material, Point, PointState, UNIT};
use crate::reference::cells::Kind;
use crate::reference::energies::{Energy, Measure, Tensor};
use crate::reference::mesh::{Item, Mesh};
use crate::reference::numbers::{Matrix, cofactor, determinant, dot, plus, product, transpose};

/// Gradients of shape functions and the volume of a point, from nodes and duals.
fn gradients(kind: Kind, nodes: &[[f64; 3]], at: [f64; 3]) -> (Vec<[f64; 3]>, Tensor, f64) {
    let shapes = kind.shapes(at);
    let mut jacobian = [[0.0; 3]; 3];
    for (shape, node) in shapes.iter().zip(nodes) {
        (0..3).for_each(|i| (0..3).for_each(|j| jacobian[i][j] += node[i] * shape.by[j]));
    }
    if kind.dimension() == 2 {
        jacobian[2][2] = 1.0;
    }
    let volume = determinant(&jacobian);
    let inverse_transpose = cofactor(&jacobian).map(|row| row.map(|x| x / volume));
    let gradient = |by: [f64; 6]| std::array::from_fn(|i| dot(&inverse_transpose[i], &by[..3]));
    (shapes.iter().map(|shape| gradient(shape.by)).collect(), jacobian, volume)
}

pub(super) fn strain_rate(f: &Tensor, rate: &Tensor) -> Tensor {
    let c = product(&transpose(f), rate);
    std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (c[i][j] + c[j][i])))
}

impl Cell {
    pub(super) fn new(
        item: &Item,
        mesh: &Mesh,
        material: &Material,
        internal: usize,
        is_second: bool,
    ) -> Self {
        let own: Vec<[f64; 3]> = item.nodes.iter().map(|&node| mesh.points[node]).collect();
        let (kind, mut nodes) = (item.kind, item.nodes.clone());
        let rule = kind.strain_rule();
        let n_modes = match material.formulation {
            Formulation::Modes => kind.dimension(),
            _ => 0,
        };
        nodes.extend(internal..internal + n_modes);
        let (_, middle, middle_volume) = gradients(kind, &own, kind.middle());
        let middle_inverse = cofactor(&middle).map(|row| row.map(|x| x / middle_volume));
        let mut places = Vec::new();
        let mut all = Vec::new();
        for (at, weight) in rule {
            let (mut own_gradients, _, volume) = gradients(kind, &own, at);
            for m in 0..n_modes {
                let factor = middle_volume / volume * at[m];
                own_gradients.push(std::array::from_fn(|i| factor * middle_inverse[i][m]));
            }
            let mut place = [0.0; 3];
            for (shape, node) in kind.shapes(at).iter().zip(&own) {
                (0..3).for_each(|d| place[d] += shape.value * node[d]);
            }
            places.push(place);
            all.push(Point { weight: weight * volume * mesh.thickness, gradients: own_gradients });
        }
        let functions = match material.formulation {
            Formulation::Constant => 1,
            Formulation::Linear => 1 + kind.dimension(),
            _ => 0,
        };
        let projection = (functions > 0).then(|| projection(&all, &places, functions));
        let is_tet10 = kind == Kind::Tet10 && functions > 0;
        let share = match material.energy {
            Energy::MooneyRivlin { c10, c01, bulk } if is_tet10 => 4.0 / 3.0 * (c10 + c01) / bulk,
            Energy::Formula { c, bulk, .. } if is_tet10 => 4.0 / 3.0 * c / bulk,
            Energy::Fibres { mu, bulk, .. } if is_tet10 => 2.0 / 3.0 * mu / bulk,
            _ => 0.0,
        };
        let mass_point = |(at, weight): ([f64; 3], f64)| {
            let (_, _, volume) = gradients(kind, &own, at);
            (
                material.density * weight * volume * mesh.thickness,
                kind.shapes(at).iter().map(|shape| shape.value).collect(),
            )
        };
        let mass_points: Vec<(f64, Vec<f64>)> = kind.mass_rule().into_iter().map(mass_point).collect();
        let total: f64 = mass_points.iter().map(|point| point.0).sum();
        let squares: f64 = mass_points.iter().map(|(weight, shapes)| weight * dot(shapes, shapes)).sum();
        let lumped = |(_, shapes): &(f64, Vec<f64>)| match kind.middles().is_empty() {
            true => shapes.clone(),
            false => shapes.iter().map(|shape| shape * shape * total / squares).collect(),
        };
        let lumped_shapes = mass_points.iter().map(lumped).collect();
        let material = material.clone();
        Cell { nodes, points: all, projection, share, material, is_second, mass_points, lumped_shapes }
    }

    /// Points of the mass with the functions by which loads act on it.
    pub(super) fn load_points(&self, is_lumped: bool) -> impl Iterator<Item = (f64, &Vec<f64>, &Vec<f64>)> {
        let points = self.mass_points.iter().zip(&self.lumped_shapes);
        points
            .map(move |((weight, shapes), lumped)| (*weight, shapes, if is_lumped { lumped } else { shapes }))
    }

    /// Masses with their places.
    pub fn mass_places(&self, points: &[[f64; 3]]) -> Vec<(f64, [f64; 3])> {
        let place = |shapes: &[f64]| {
            std::array::from_fn(|d| {
                shapes.iter().zip(&self.nodes).map(|(s, &node)| s * points[node][d]).sum()
            })
        };
        self.mass_points.iter().map(|(weight, shapes)| (*weight, place(shapes))).collect()
    }

    /// Its volume by the rule of the mass.
    pub fn mass_volume(&self) -> f64 {
        self.mass_points.iter().map(|point| point.0).sum::<f64>() / self.material.density
    }

    /// Its volume by the rule of the strain energy.
    pub fn volume(&self) -> f64 {
        self.points.iter().map(|point| point.weight).sum()
    }

    pub(super) fn sum(&self, point: &Point, field: &[f64]) -> Tensor {
        let mut sum = [[0.0; 3]; 3];
        for (&node, gradient) in self.nodes.iter().zip(&point.gradients) {
            (0..3).for_each(|i| (0..3).for_each(|j| sum[i][j] += field[3 * node + i] * gradient[j]));
        }
        sum
    }

    pub(super) fn deformation(&self, point: &Point, displacement: &[f64]) -> Tensor {
        plus(&self.sum(point, displacement), 1.0, &UNIT)
    }

    pub(super) fn add_force(&self, point: &Point, stress: &Tensor, force: &mut [f64]) {
        for (&node, gradient) in self.nodes.iter().zip(&point.gradients) {
            (0..3).for_each(|i| force[3 * node + i] += point.weight * dot(&stress[i], gradient));
        }
    }

    pub(super) fn project(&self, field: &[f64]) -> Option<Vec<f64>> {
        let projection = self.projection.as_ref()?;
        Some(projection.iter().map(|row| dot(row, field)).collect())
    }

    /// Energy and stress of the part at a point.
    pub(super) fn local(&self, c: &Tensor) -> (f64, Tensor) {
        let energy = &self.material.energy;
        if self.projection.is_none() {
            return energy.at(c, false);
        }
        let (rest, stress) = energy.at(c, true);
        if self.share == 0.0 {
            return (rest, stress);
        }
        let (whole, whole_stress) = energy.at(c, false);
        let volume = plus(&whole_stress, -1.0, &stress);
        (rest + self.share * (whole - rest), plus(&stress, self.share, &volume))
    }

    pub(super) fn volume_energy(&self, theta: f64) -> (f64, f64) {
        let (value, rate) = self.material.energy.volume_energy(theta);
        ((1.0 - self.share) * value, (1.0 - self.share) * rate)
    }

    /// Measure of volume at a strain, and its derivative by C.
    pub(super) fn measure(&self, c: &Tensor) -> (f64, Tensor) {
        match self.material.energy.measure() {
            Measure::Ratio => {
                let ratio = determinant(c).sqrt();
                (ratio - 1.0, cofactor(c).map(|row| row.map(|x| 0.5 * x / ratio)))
            }
            Measure::Trace => {
                (0.5 * (c[0][0] + c[1][1] + c[2][2] - 3.0), UNIT.map(|row| row.map(|x| 0.5 * x)))
            }
        }
    }

    /// Energy per volume and S at every point, and det F.
    pub fn state(&self, displacement: &[f64]) -> Vec<PointState> {
        let fs: Vec<Tensor> = self.points.iter().map(|point| self.deformation(point, displacement)).collect();
        let cs: Vec<Tensor> = fs.iter().map(|f| product(&transpose(f), f)).collect();
        let measures: Vec<(f64, Tensor)> = cs.iter().map(|c| self.measure(c)).collect();
        let volumes: Vec<f64> = measures.iter().map(|measure| measure.0).collect();
        let energies = self.project(&volumes).map(|projected| {
            let energies: Vec<(f64, f64)> =
                projected.iter().map(|&theta| self.volume_energy(theta)).collect();
            let rates: Vec<f64> = energies.iter().map(|energy| energy.1).collect();
            (energies, self.project(&rates).unwrap_or_default())
        });
        let state = |q: usize| {
            let (mut energy, mut stress) = self.local(&cs[q]);
            let ratio = determinant(&fs[q]);
            if let Some((energies, pressures)) = &energies {
                energy += energies[q].0;
                stress = plus(&stress, 2.0 * pressures[q], &measures[q].1);
            }
            PointState { weight: self.points[q].weight, f: fs[q], energy, stress, ratio }
        };
        (0..fs.len()).map(state).collect()
    }

    /// Integral of density times v^2/2.
    pub fn kinetic_energy(&self, velocity: &[f64]) -> f64 {
        let square = |shapes: &[f64]| {
            let v: [f64; 3] = std::array::from_fn(|d| {
                shapes.iter().zip(&self.nodes).map(|(shape, node)| shape * velocity[3 * node + d]).sum()
            });
            dot(&v, &v)
        };
        self.mass_points.iter().map(|(weight, shapes)| 0.5 * weight * square(shapes)).sum()
    }
}

/// Projection on polynomials of the position, as a matrix from point to point.
fn projection(points: &[Point], places: &[[f64; 3]], functions: usize) -> Matrix {
    let n = points.len();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for f in 0..functions {
        let mut own: Vec<f64> = places.iter().map(|place| if f == 0 { 1.0 } else { place[f - 1] }).collect();
        let product = |a: &[f64], b: &[f64]| (0..n).map(|q| points[q].weight * a[q] * b[q]).sum::<f64>();
        for _ in 0..2 {
            for other in &basis {
                let part = product(other, &own);
                own.iter_mut().zip(other).for_each(|(x, y)| *x -= part * y);
            }
        }
        let norm = product(&own, &own).sqrt();
        basis.push(own.iter().map(|x| x / norm).collect());
    }
    let entry = |q: usize, r: usize| basis.iter().map(|f| f[q] * f[r]).sum::<f64>() * points[r].weight;
    (0..n).map(|q| (0..n).map(|r| entry(q, r)).collect()).collect()
}
