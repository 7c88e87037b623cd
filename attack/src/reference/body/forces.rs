//! Forces and energy of cells, springs and attractions, and the averages of the forces over a step.

use super::{Attraction, Body, StageForces};
use crate::reference::element::{Average, Element};
use crate::reference::numbers::{dot, gauss, lagrange, lagrange_integral, product};

impl Body {
    /// Forces of springs at a displacement.
    pub fn spring_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        for &(a, b, stiffness) in &self.springs {
            (0..3).for_each(|d| force[3 * a + d] += stiffness * displacement[3 * b + d]);
        }
        force
    }

    /// Forces of the attraction at a displacement.
    fn attraction_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        let Some(attraction) = &self.attraction else { return force };
        for (node, strength) in attraction.strengths.iter().enumerate() {
            let arm = self.arm(attraction, node, displacement);
            let factor = strength * dot(&arm, &arm).powf(-1.5);
            (0..3).for_each(|d| force[3 * node + d] += factor * arm[d]);
        }
        force
    }

    fn arm(&self, attraction: &Attraction, node: usize, displacement: &[f64]) -> [f64; 3] {
        std::array::from_fn(|d| self.points[node][d] + displacement[3 * node + d] - attraction.centre[d])
    }

    /// Averages of the attraction by the rule of a link whose strain is its squared length.
    fn stage_attraction(&self, element: &Element, displacement: &[f64], rates: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let k = element.c.len();
        let mut forces = vec![vec![0.0; 3 * self.n_all]; k];
        let Some(attraction) = &self.attraction else { return forces };
        if let Average::Points(points) = &element.average {
            for &(alpha, w) in points {
                let own = self.attraction_forces(&element.path(displacement, rates, alpha));
                for (i, force) in forces.iter_mut().enumerate() {
                    let factor = w * element.weighted(i, alpha);
                    force.iter_mut().zip(&own).for_each(|(sum, f)| *sum += factor * f);
                }
            }
            return forces;
        }
        let stages: Vec<Vec<f64>> = element.c.iter().map(|&c| element.path(displacement, rates, c)).collect();
        for (node, strength) in attraction.strengths.iter().enumerate() {
            let arms: Vec<[f64; 3]> = stages.iter().map(|u| self.arm(attraction, node, u)).collect();
            let start = self.arm(attraction, node, displacement);
            let start = dot(&start, &start);
            // Rates of the squared distance, and the derivative of -g/sqrt(s).
            let square_rates: Vec<f64> =
                (0..k).map(|i| 2.0 * dot(&arms[i], &rates[i][3 * node..3 * node + 3])).collect();
            let square = |alpha: f64| {
                start + (0..k).map(|j| lagrange_integral(&element.c, j, alpha) * square_rates[j]).sum::<f64>()
            };
            let slope = |alpha: f64| 0.5 * strength * square(alpha).powf(-1.5);
            let slopes: Vec<f64> = match element.average {
                Average::Assumed(n) => (0..k)
                    .map(|i| gauss(n).iter().map(|&(s, w)| w * element.weighted(i, s) * slope(s)).sum())
                    .collect(),
                _ => {
                    let rate =
                        |s: f64| (0..k).map(|j| lagrange(&element.c, j, s) * square_rates[j]).sum::<f64>();
                    // A node may fall to a tenth of its distance from the centre.
                    let gain: f64 = gauss(40).iter().map(|&(s, w)| w * slope(s) * rate(s)).sum();
                    let seen: f64 =
                        (0..k).map(|j| element.b[j] * slope(element.c[j]) * square_rates[j]).sum();
                    let sum: f64 = (0..k).map(|j| element.b[j] * square_rates[j] * square_rates[j]).sum();
                    let r = if sum > 1e-28 { (gain - seen) / sum } else { 0.0 };
                    (0..k).map(|i| slope(element.c[i]) + r * square_rates[i]).collect()
                }
            };
            for i in 0..k {
                (0..3).for_each(|d| forces[i][3 * node + d] += 2.0 * slopes[i] * arms[i][d]);
            }
        }
        forces
    }

    /// Forces of cells, springs and attractions at a displacement.
    pub fn forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = self.cell_forces(displacement);
        let ground = self.spring_forces(displacement).into_iter().zip(self.attraction_forces(displacement));
        force.iter_mut().zip(ground).for_each(|(sum, (spring, attraction))| *sum += spring + attraction);
        force
    }

    /// Forces of attractions at a displacement.
    pub fn ground_attraction(&self, displacement: &[f64]) -> Vec<f64> {
        self.attraction_forces(displacement)
    }

    fn cell_forces(&self, displacement: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; 3 * self.n_all];
        for cell in &self.cells {
            for (point, state) in cell.points.iter().zip(cell.state(displacement)) {
                cell.add_force(point, &product(&state.f, &state.stress), &mut force);
            }
        }
        force
    }

    /// Stored energy with springs and attractions, and the smallest det F.
    pub fn energy(&self, displacement: &[f64]) -> (f64, f64) {
        let (mut energy, mut smallest) = (0.0, f64::INFINITY);
        for cell in &self.cells {
            for state in cell.state(displacement) {
                energy += state.weight * state.energy;
                smallest = smallest.min(state.ratio);
            }
        }
        energy += 0.5 * dot(&self.spring_forces(displacement), displacement);
        if let Some(attraction) = &self.attraction {
            for (node, strength) in attraction.strengths.iter().enumerate() {
                let arm = self.arm(attraction, node, displacement);
                energy -= strength / dot(&arm, &arm).sqrt();
            }
        }
        (energy, smallest)
    }

    /// Forces of a step of size h.
    pub fn stage_forces(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
        h: f64,
    ) -> StageForces {
        let k = element.c.len();
        let mut internal = vec![vec![0.0; 3 * self.n_all]; k];
        let mut dissipated = 0.0;
        if let Average::Points(points) = &element.average {
            for &(alpha, w) in points {
                let own = self.cell_forces(&element.path(displacement, rates, alpha));
                for (i, force) in internal.iter_mut().enumerate() {
                    let factor = w * element.weighted(i, alpha);
                    force.iter_mut().zip(&own).for_each(|(sum, f)| *sum += factor * f);
                }
            }
        }
        for cell in &self.cells {
            let is_damped = cell.material.viscosity != [0.0; 3] || element.dissipation.is_some();
            let mut averages = match element.average {
                Average::Points(_) if is_damped => cell.paths_only(element, displacement, rates),
                Average::Points(_) => continue,
                _ => cell.assumed(element, displacement, rates),
            };
            if is_damped {
                dissipated += cell.add_damping(element, &mut averages, h);
            }
            if let Average::Points(points) = &element.average {
                for &(alpha, w) in points {
                    let mut own = vec![0.0; 3 * self.n_all];
                    dissipated +=
                        w * cell.add_viscous_pressure(element, displacement, rates, (alpha, h), &mut own);
                    for (i, force) in internal.iter_mut().enumerate() {
                        let factor = w * element.weighted(i, alpha);
                        force.iter_mut().zip(&own).for_each(|(sum, f)| *sum += factor * f);
                    }
                }
            }
            for (point, stages) in cell.points.iter().zip(&averages) {
                for (i, stage) in stages.iter().enumerate() {
                    cell.add_force(point, &product(&stage.f, &stage.stress), &mut internal[i]);
                }
            }
        }
        let at = |i: usize| element.path(displacement, rates, element.c[i]);
        let springs: Vec<Vec<f64>> = (0..k).map(|i| self.spring_forces(&at(i))).collect();
        let attraction = self.stage_attraction(element, displacement, rates);
        for i in 0..k {
            let ground = springs[i].iter().zip(&attraction[i]);
            internal[i].iter_mut().zip(ground).for_each(|(sum, (s, a))| *sum += s + a);
        }
        StageForces { internal, springs, attraction, dissipated }
    }
}
