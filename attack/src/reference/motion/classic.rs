//! Steps of the classic schemes: Newmark's family, Bathe's method, central differences.

use super::statics::solve;
use super::{Motion, State, Step, add};
use crate::reference::numbers::dot;

impl Motion<'_> {
    /// Acceleration at a displacement and time, with the supports of the step that starts at `set`.
    pub(super) fn at_rest_of_step(&self, u: &[f64], t: f64, set: f64) -> Memory {
        let free = self.free(set);
        let mut net = self.body.loads(u, t, false);
        add(&mut net, -1.0, &self.body.forces(u));
        let (heavy, factors) = self.mass_factors(&free);
        let right: Vec<f64> = heavy.iter().map(|&dof| net[dof]).collect();
        let mut a = vec![0.0; self.n()];
        heavy.iter().zip(factors.solve(&right)).for_each(|(&dof, own)| a[dof] = own);
        Memory { a }
    }

    /// Adds the impulses of a configuration with its acceleration.
    fn add_configuration(
        &self,
        step: &mut Step,
        (weight, h): (f64, f64),
        (t, set): (f64, f64),
        u: &[f64],
        a: &[f64],
        x: &[f64],
    ) {
        let loads = self.body.loads(u, t, false);
        let springs = self.body.spring_forces(u);
        let (driven, inertia, forces) = (self.driven(set), self.mass_product(a), self.body.forces(u));
        let mut reaction = vec![0.0; self.n()];
        for dof in (0..self.n()).filter(|dof| driven[*dof].is_some()) {
            reaction[dof] = inertia[dof] + forces[dof] - loads[dof];
        }
        step.work += weight * dot(&loads, x);
        let mut external = loads;
        add(&mut external, 1.0, &reaction);
        add(&mut external, -1.0, &springs);
        add(&mut external, -1.0, &self.body.ground_attraction(u));
        step.add_impulse(self, h * weight, u, &external);
        self.add_reactions(&mut step.reactions, weight, (set, u), (&reaction, &springs));
    }

    pub(super) fn newmark_step(
        &self,
        [alpha_m, alpha_f, beta, gamma]: [f64; 4],
        state: &State,
        memory: &mut Option<Memory>,
        t: f64,
        h: f64,
    ) -> Result<Step, String> {
        let n = self.n();
        let free = self.free(t);
        let old = memory.take().unwrap_or_else(|| self.at_rest_of_step(&state.u, t, t)).a;
        // The new acceleration and velocity follow from the increment.
        let acceleration = |x: &[f64]| -> Vec<f64> {
            (0..n).map(|i| ((x[i] - h * state.v[i]) / (h * h) - (0.5 - beta) * old[i]) / beta).collect()
        };
        let net = |u: &[f64], t: f64| {
            let mut net = self.body.forces(u);
            add(&mut net, -1.0, &self.body.loads(u, t, false));
            net
        };
        let before = net(&state.u, t);
        let full = |x: &[f64]| {
            let mut all = vec![0.0; n];
            free.iter().zip(x).for_each(|(&dof, x)| all[dof] = *x);
            all
        };
        let residual = |x: &[f64]| {
            let x = full(x);
            let mean: Vec<f64> = acceleration(&x)
                .iter()
                .zip(&old)
                .map(|(new, old)| (1.0 - alpha_m) * new + alpha_m * old)
                .collect();
            let mut sum = self.mass_product(&mean);
            let u: Vec<f64> = state.u.iter().zip(&x).map(|(u, x)| u + x).collect();
            add(&mut sum, 1.0 - alpha_f, &net(&u, t + h));
            add(&mut sum, alpha_f, &before);
            free.iter().map(|&dof| h * h * sum[dof]).collect()
        };
        let x = full(&solve(free.iter().map(|&dof| h * state.v[dof]).collect(), 0.1, residual)?);
        let mut new = acceleration(&x);
        (3 * self.body.n_nodes()..n).for_each(|dof| new[dof] = 0.0);
        let driven = self.driven(t);
        (0..n).filter(|dof| driven[*dof].is_some()).for_each(|dof| new[dof] = 0.0);
        let mut step = Step::new(self);
        let mut v = state.v.clone();
        add(&mut v, h * (1.0 - gamma), &old);
        add(&mut v, h * gamma, &new);
        let mut u = state.u.clone();
        add(&mut u, 1.0, &x);
        self.add_configuration(&mut step, (1.0 - gamma, h), (t, t), &state.u, &old, &x);
        self.add_configuration(&mut step, (gamma, h), (t + h, t), &u, &new, &x);
        *memory = Some(Memory { a: new });
        Ok(Step { momentum: self.mass_product(&v), u, v, ..step })
    }

    pub(super) fn bathe_step(
        &self,
        state: &State,
        memory: &mut Option<Memory>,
        t: f64,
        h: f64,
    ) -> Result<Step, String> {
        let n = self.n();
        let split = 2.0 - 2f64.sqrt();
        let free = self.free(t);
        let first = memory.take().unwrap_or_else(|| self.at_rest_of_step(&state.u, t, t)).a;
        let (part, rest) = (split * h, (1.0 - split) * h);
        let solve_for = |start: &[f64], t: f64, guess: f64, acceleration: &dyn Fn(&[f64]) -> Vec<f64>| {
            let with = |x: &[f64]| {
                let mut u = start.to_vec();
                free.iter().zip(x).for_each(|(&dof, x)| u[dof] += x);
                u
            };
            let residual = |x: &[f64]| {
                let u = with(x);
                let mut sum = self.mass_product(&acceleration(&u));
                add(&mut sum, 1.0, &self.body.forces(&u));
                add(&mut sum, -1.0, &self.body.loads(&u, t, false));
                free.iter().map(|&dof| h * h * sum[dof]).collect()
            };
            let x = solve(free.iter().map(|&dof| guess * state.v[dof]).collect(), 0.1, residual)?;
            Ok::<_, String>(with(&x))
        };
        // Trapezoidal rule: v_s = v_1 + part/2 (a_1 + a_s), u_s = u_1 + part/2 (v_1 + v_s).
        let split_velocity = |u: &[f64]| -> Vec<f64> {
            (0..n).map(|i| 2.0 * (u[i] - state.u[i]) / part - state.v[i]).collect()
        };
        let split_acceleration = |u: &[f64]| -> Vec<f64> {
            let v = split_velocity(u);
            (0..n).map(|i| 2.0 * (v[i] - state.v[i]) / part - first[i]).collect()
        };
        let u_s = solve_for(&state.u, t + part, part, &split_acceleration)?;
        let clean = |mut field: Vec<f64>| {
            let driven = self.driven(t);
            (0..n)
                .filter(|dof| driven[*dof].is_some() || *dof >= 3 * self.body.n_nodes())
                .for_each(|dof| field[dof] = 0.0);
            field
        };
        let (v_s, a_s) = (clean(split_velocity(&u_s)), clean(split_acceleration(&u_s)));
        // Backward differences on the three points.
        let c = [rest / (part * h), -h / (rest * part), (2.0 * h - part) / (rest * h)];
        let velocity = |u: &[f64]| -> Vec<f64> {
            (0..n).map(|i| c[0] * state.u[i] + c[1] * u_s[i] + c[2] * u[i]).collect()
        };
        let acceleration = |u: &[f64]| -> Vec<f64> {
            let v = velocity(u);
            (0..n).map(|i| c[0] * state.v[i] + c[1] * v_s[i] + c[2] * v[i]).collect()
        };
        let u = solve_for(&u_s, t + h, rest, &acceleration)?;
        let (v, a) = (clean(velocity(&u)), clean(acceleration(&u)));
        let mut step = Step::new(self);
        let x: Vec<f64> = u.iter().zip(&state.u).map(|(new, old)| new - old).collect();
        let weights = [0.5 / (2.0 - split), 0.5 / (2.0 - split), (1.0 - split) / (2.0 - split)];
        self.add_configuration(&mut step, (weights[0], h), (t, t), &state.u, &first, &x);
        self.add_configuration(&mut step, (weights[1], h), (t + part, t), &u_s, &a_s, &x);
        self.add_configuration(&mut step, (weights[2], h), (t + h, t), &u, &a, &x);
        *memory = Some(Memory { a });
        Ok(Step { momentum: self.mass_product(&v), u, v, ..step })
    }

    pub(super) fn central_step(&self, state: &State, t: f64, h: f64) -> Step {
        let old = self.at_rest_of_step(&state.u, t, t).a;
        let mut v = state.v.clone();
        add(&mut v, 0.5 * h, &old);
        let x: Vec<f64> = v.iter().map(|v| h * v).collect();
        let u: Vec<f64> = state.u.iter().zip(&x).map(|(u, x)| u + x).collect();
        let new = self.at_rest_of_step(&u, t + h, t).a;
        add(&mut v, 0.5 * h, &new);
        let mut step = Step::new(self);
        self.add_configuration(&mut step, (0.5, h), (t, t), &state.u, &old, &x);
        self.add_configuration(&mut step, (0.5, h), (t + h, t), &u, &new, &x);
        Step { momentum: self.mass_product(&v), u, v, ..step }
    }
}

/// The acceleration at the end of the last step.
pub(super) struct Memory {
    pub(super) a: Vec<f64>,
}
