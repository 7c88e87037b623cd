//! Averages of the stresses of a cell over a step: assumed strain and discrete gradient, viscosity and dissipation.

use super::cell::strain_rate;
use super::{Averaged, Cell, Path, Point, UNIT};
use crate::reference::element::{Average, Element};
use crate::reference::energies::{Measure, Tensor};
use crate::reference::numbers::{
    cofactor, contract, determinant, dot, gauss, lagrange, lagrange_integral, plus, product, transpose,
};

impl Cell {
    /// Averages of S over a step for the assumed strain.
    pub(super) fn assumed(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
    ) -> Vec<Vec<Averaged>> {
        let k = element.c.len();
        let starts: Vec<Tensor> =
            self.points.iter().map(|point| self.deformation(point, displacement)).collect();
        let paths: Vec<Path> = self
            .points
            .iter()
            .zip(&starts)
            .map(|(point, f)| self.strain_path(element, point, f, rates))
            .collect();
        let mut all: Vec<Vec<Averaged>> = Vec::new();
        for path in &paths {
            let stresses = self.stresses(element, path);
            let averaged = |i: usize| Averaged {
                f: path.f[i],
                strain_rate: path.rates[i],
                stress: stresses[i],
                volume: None,
            };
            all.push((0..k).map(averaged).collect());
        }
        if self.projection.is_some() {
            self.add_pressures(element, &paths, &mut all);
        }
        all
    }

    fn strain_path(&self, element: &Element, point: &Point, start: &Tensor, rates: &[Vec<f64>]) -> Path {
        let k = element.c.len();
        let f_rates: Vec<Tensor> = rates.iter().map(|rate| self.sum(point, rate)).collect();
        let at = |i: usize| (0..k).fold(*start, |f, j| plus(&f, element.a[i][j], &f_rates[j]));
        let f: Vec<Tensor> = (0..k).map(at).collect();
        let rates: Vec<Tensor> = (0..k).map(|i| strain_rate(&f[i], &f_rates[i])).collect();
        Path { start: product(&transpose(start), start), f, rates }
    }

    /// S of the part at the points.
    fn stresses(&self, element: &Element, path: &Path) -> Vec<Tensor> {
        let k = element.c.len();
        let along = |alpha: f64| self.local(&path.strain(element, alpha)).1;
        match element.average {
            Average::Assumed(n) => {
                let mut stresses = vec![[[0.0; 3]; 3]; k];
                for (alpha, w) in gauss(n) {
                    let stress = along(alpha);
                    for (i, sum) in stresses.iter_mut().enumerate() {
                        *sum = plus(sum, w * element.weighted(i, alpha), &stress);
                    }
                }
                stresses
            }
            _ => {
                let mut stresses: Vec<Tensor> = element.c.iter().map(|&c| along(c)).collect();
                let power = |alpha: f64, stress: &Tensor| {
                    let rate = (0..k).fold([[0.0; 3]; 3], |sum, j| {
                        plus(&sum, lagrange(&element.c, j, alpha), &path.rates[j])
                    });
                    contract(stress, &rate)
                };
                // A fine rule along the path loses no digits where the strain hardly changes.
                let mut gain: f64 = gauss(12).iter().map(|&(alpha, w)| w * power(alpha, &along(alpha))).sum();
                let exact = self.local(&path.strain(element, 1.0)).0 - self.local(&path.start).0;
                if (exact - gain).abs() > 1e-9 * exact.abs() {
                    gain = exact;
                }
                let seen: f64 = (0..k).map(|j| element.b[j] * contract(&stresses[j], &path.rates[j])).sum();
                let square: f64 =
                    (0..k).map(|j| element.b[j] * contract(&path.rates[j], &path.rates[j])).sum();
                let r = if square > 1e-28 { (gain - seen) / square } else { 0.0 };
                stresses.iter_mut().zip(&path.rates).for_each(|(s, rate)| *s = plus(s, r, rate));
                stresses
            }
        }
    }

    /// Adds the averages of the projected pressures: C, det C, J, their projection, the energy of it.
    fn add_pressures(&self, element: &Element, paths: &[Path], all: &mut [Vec<Averaged>]) {
        let k = element.c.len();
        let integral = |i: usize, alpha: f64| lagrange_integral(&element.c, i, alpha);
        let volumes: Vec<(f64, Vec<f64>, Vec<Tensor>)> =
            paths.iter().map(|path| self.volume_path(element, path)).collect();
        let starts: Vec<f64> = volumes.iter().map(|volume| volume.0).collect();
        let starts = self.project(&starts).unwrap_or_default();
        let rates: Vec<Vec<f64>> = (0..k)
            .map(|i| self.project(&volumes.iter().map(|volume| volume.1[i]).collect::<Vec<_>>()))
            .map(Option::unwrap_or_default)
            .collect();
        let mut pressures = vec![vec![0.0; paths.len()]; k];
        for q in 0..paths.len() {
            let theta =
                |alpha: f64| starts[q] + (0..k).map(|j| integral(j, alpha) * rates[j][q]).sum::<f64>();
            let pressure = |alpha: f64| self.volume_energy(theta(alpha)).1;
            if let Average::Assumed(n) = element.average {
                for (alpha, w) in gauss(n) {
                    let own = w * pressure(alpha);
                    (0..k).for_each(|i| pressures[i][q] += element.weighted(i, alpha) * own);
                }
                continue;
            }
            let rate = |alpha: f64| (0..k).map(|j| lagrange(&element.c, j, alpha) * rates[j][q]).sum::<f64>();
            let gain: f64 = gauss(12).iter().map(|&(s, w)| w * pressure(s) * rate(s)).sum();
            let seen: f64 = (0..k).map(|j| element.b[j] * pressure(element.c[j]) * rates[j][q]).sum();
            let square: f64 = (0..k).map(|j| element.b[j] * rates[j][q] * rates[j][q]).sum();
            let r = if square > 1e-28 { (gain - seen) / square } else { 0.0 };
            (0..k).for_each(|i| pressures[i][q] = pressure(element.c[i]) + r * rates[i][q]);
        }
        for i in 0..k {
            let own = self.project(&pressures[i]).unwrap_or_default();
            for q in 0..paths.len() {
                all[q][i].stress = plus(&all[q][i].stress, 2.0 * own[q], &volumes[q].2[i]);
                all[q][i].volume = Some((rates[i][q], volumes[q].2[i]));
            }
        }
    }

    /// Measure of volume at the start, its rates, and the symmetric tensors N_i with `rate_i = N_i : C'_i`.
    fn volume_path(&self, element: &Element, path: &Path) -> (f64, Vec<f64>, Vec<Tensor>) {
        let k = element.c.len();
        let twice: Vec<Tensor> = path.rates.iter().map(|rate| rate.map(|row| row.map(|x| 2.0 * x))).collect();
        let start = self.measure(&path.start).0;
        if self.material.energy.measure() == Measure::Trace {
            let half = UNIT.map(|row| row.map(|x| 0.5 * x));
            return (start, twice.iter().map(|rate| contract(&half, rate)).collect(), vec![half; k]);
        }
        let mut cofactors = vec![[[0.0; 3]; 3]; k];
        for (alpha, w) in gauss(2 * k) {
            let own = cofactor(&path.strain(element, alpha));
            for (i, sum) in cofactors.iter_mut().enumerate() {
                *sum = plus(sum, w * element.weighted(i, alpha), &own);
            }
        }
        let d: Vec<f64> = cofactors.iter().zip(&twice).map(|(m, rate)| contract(m, rate)).collect();
        let first = determinant(&path.start);
        let at = |i: usize| first + (0..k).map(|j| element.a[i][j] * d[j]).sum::<f64>();
        let phi: Vec<f64> = (0..k).map(|i| 0.5 / at(i).sqrt()).collect();
        let second = first + dot(&element.b, &d);
        let mean = 1.0 / (first.sqrt() + second.sqrt());
        let square: f64 = (0..k).map(|j| element.b[j] * d[j] * d[j]).sum();
        let gap: f64 = (0..k).map(|j| element.b[j] * d[j] * (mean - phi[j])).sum();
        let r = if square < 1e-16 * first * first { 0.0 } else { gap / square };
        let g: Vec<f64> = (0..k).map(|i| phi[i] + r * d[i]).collect();
        let n = (0..k).map(|i| cofactors[i].map(|row| row.map(|x| g[i] * x))).collect();
        (start, (0..k).map(|i| g[i] * d[i]).collect(), n)
    }

    /// Viscous stress of a strain rate per time.
    fn viscous(&self, rate: &Tensor) -> Tensor {
        let [time, shear, bulk] = self.material.viscosity;
        let trace = rate[0][0] + rate[1][1] + rate[2][2];
        let deviator = plus(rate, -trace / 3.0, &UNIT);
        let stress = plus(&self.rest_stress(rate, time), 2.0 * shear, &deviator);
        plus(&stress, bulk * trace, &UNIT)
    }

    /// `factor D_0 : rate`.
    fn rest_stress(&self, rate: &Tensor, factor: f64) -> Tensor {
        if factor == 0.0 {
            return [[0.0; 3]; 3];
        }
        let energy = &self.material.energy;
        let mut stress = energy.elastic_stress(rate, self.projection.is_some());
        if self.share > 0.0 {
            let volume = plus(&energy.elastic_stress(rate, false), -1.0, &stress);
            stress = plus(&stress, self.share, &volume);
        }
        stress.map(|row| row.map(|x| factor * x))
    }

    /// Paths without stress.
    pub(super) fn paths_only(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
    ) -> Vec<Vec<Averaged>> {
        let path = |point: &Point| {
            let path = self.strain_path(element, point, &self.deformation(point, displacement), rates);
            let stage = |(f, rate): (&Tensor, &Tensor)| Averaged {
                f: *f,
                strain_rate: *rate,
                stress: [[0.0; 3]; 3],
                volume: None,
            };
            path.f.iter().zip(&path.rates).map(stage).collect()
        };
        self.points.iter().map(path).collect()
    }

    /// Adds the forces of the viscous pressure of a projected volume at a point of a step, as a standard rule takes
    /// them; returns the power by alpha.
    pub(super) fn add_viscous_pressure(
        &self,
        element: &Element,
        displacement: &[f64],
        rates: &[Vec<f64>],
        (alpha, h): (f64, f64),
        force: &mut [f64],
    ) -> f64 {
        let factor =
            self.material.viscosity[0] / h * (1.0 - self.share) * self.material.energy.bulk_stiffness();
        if factor == 0.0 || self.projection.is_none() {
            return 0.0;
        }
        let place = element.path(displacement, rates, alpha);
        let mut rate = vec![0.0; displacement.len()];
        for (j, own) in rates.iter().enumerate() {
            let weight = lagrange(&element.c, j, alpha);
            rate.iter_mut().zip(own).for_each(|(sum, x)| *sum += weight * x);
        }
        let at = |point: &Point| {
            let f = self.deformation(point, &place);
            let n = self.measure(&product(&transpose(&f), &f)).1;
            let own = 2.0 * contract(&n, &strain_rate(&f, &self.sum(point, &rate)));
            (f, n, own)
        };
        let states: Vec<(Tensor, Tensor, f64)> = self.points.iter().map(at).collect();
        let own: Vec<f64> = states.iter().map(|state| state.2).collect();
        let projected = self.project(&own).unwrap_or_default();
        let mut power = 0.0;
        for ((point, (f, n, _)), theta) in self.points.iter().zip(&states).zip(projected) {
            let stress = n.map(|row| row.map(|x| 2.0 * factor * theta * x));
            self.add_force(point, &product(f, &stress), force);
            power += point.weight * factor * theta * theta;
        }
        power
    }

    /// Adds viscous stresses and those of a dissipative element; returns the energy that they take.
    pub(super) fn add_damping(&self, element: &Element, averages: &mut [Vec<Averaged>], h: f64) -> f64 {
        let mut dissipated = 0.0;
        for (point, stages) in self.points.iter().zip(averages) {
            let highest = element.dissipation.as_ref().map(|(beta, p)| {
                let sum = stages.iter().enumerate().fold([[0.0; 3]; 3], |sum, (j, stage)| {
                    plus(&sum, element.b[j] * p[j], &stage.strain_rate)
                });
                (p, self.rest_stress(&sum, *beta))
            });
            let modulus = (1.0 - self.share) * self.material.energy.bulk_stiffness();
            let volume_rate = |stage: &Averaged| stage.volume.map_or(0.0, |volume| volume.0);
            let highest_volume: f64 = element.dissipation.as_ref().map_or(0.0, |(_, p)| {
                stages.iter().enumerate().map(|(j, stage)| element.b[j] * p[j] * volume_rate(stage)).sum()
            });
            for (i, stage) in stages.iter_mut().enumerate() {
                // The volume has its own pressure.
                let mut pressure = self.material.viscosity[0] * modulus * volume_rate(stage) / h;
                if let Some((beta, p)) = &element.dissipation {
                    pressure += beta * p[i] * modulus * highest_volume;
                }
                let per_time = stage.strain_rate.map(|row| row.map(|x| x / h));
                let mut own = self.viscous(&per_time);
                if let Some((p, stress)) = &highest {
                    own = plus(&own, p[i], stress);
                }
                if let Some((_, n)) = &stage.volume {
                    own = plus(&own, 2.0 * pressure, n);
                }
                dissipated += point.weight * element.b[i] * contract(&own, &stage.strain_rate);
                stage.stress = plus(&stage.stress, 1.0, &own);
            }
        }
        dissipated
    }
}
