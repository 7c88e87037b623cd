//! A step of a time element.

use super::statics::solve;
use super::{Motion, State, Step, add};
use crate::reference::body::StageForces;
use crate::reference::element::Element;
use crate::reference::history::pieces;
use crate::reference::numbers::{Factors, dot, lagrange};

impl Motion<'_> {
    pub(super) fn element_step(
        &self,
        element: &Element,
        state: &State,
        p: &[f64],
        t: f64,
        h: f64,
    ) -> Result<Step, String> {
        let (n, k) = (self.n(), element.c.len());
        let driven = self.driven(t);
        let free = self.free(t);
        // Given rates: averages of the rate of the support.
        let mut given = vec![vec![0.0; n]; k];
        for (dof, drive) in driven.iter().enumerate() {
            let Some((drive, _)) = drive else { continue };
            for (alpha, w) in pieces(t, h, &drive.kinks()) {
                let rate = h * drive.velocity(t + alpha * h, false);
                (0..k)
                    .for_each(|i| given[i][dof] += w * lagrange(&element.c, i, alpha) / element.b[i] * rate);
            }
        }
        let rates = |x: &[f64]| {
            let mut all = given.clone();
            for (i, rate) in all.iter_mut().enumerate() {
                free.iter().zip(&x[i * free.len()..]).for_each(|(&dof, x)| rate[dof] = *x);
            }
            all
        };
        let dead = self.body.stage_dead_loads(element, (t, h));
        let start = Start { element, state, p, t, h, masses: self.mass_factors(&free), dead };
        let residual = |x: &[f64]| {
            let stages = self.stages(&start, &rates(x)).residuals;
            stages.iter().flat_map(|own| free.iter().map(|&dof| own[dof])).collect()
        };
        let a = self.at_rest_of_step(&state.u, t, t).a;
        let along = |c: &f64| {
            let own = |dof: &usize| h * state.v[*dof] + self.guess * c * h * h * a[*dof];
            free.iter().map(own).collect::<Vec<f64>>()
        };
        let guess = element.c.iter().flat_map(along).collect();
        let x = rates(&solve(guess, 0.1, residual)?);
        let mut step = Step::new(self);
        let Stages { forces, loads, damping, dissipated, .. } = self.stages(&start, &x);
        step.dissipated += forces.dissipated + dissipated;
        // Reactions from the momenta that the driven nodes have at the Gauss points.
        let inverse = Factors::new(element.a.clone());
        let drags: Vec<Vec<f64>> =
            x.iter().map(|x| self.mass_product(x).iter().map(|p| self.body.drag * p / h).collect()).collect();
        let products: Vec<Vec<f64>> = x.iter().map(|x| self.mass_product(x)).collect();
        let mut reactions = vec![vec![0.0; n]; k];
        for dof in (0..n).filter(|dof| driven[*dof].is_some()) {
            let own: Vec<f64> = (0..k).map(|i| products[i][dof] - h * p[dof] - damping[i][dof]).collect();
            for (i, rate) in inverse.solve(&own).iter().enumerate() {
                reactions[i][dof] = rate / (h * h) + forces.internal[i][dof] - loads[i][dof] + drags[i][dof];
            }
        }
        let (mut momentum, mut end) = (p.to_vec(), state.u.clone());
        for i in 0..k {
            let u = element.path(&state.u, &x, element.c[i]);
            let mut external = loads[i].clone();
            add(&mut external, 1.0, &reactions[i]);
            step.work += element.b[i] * dot(&external, &x[i]);
            step.dissipated += element.b[i] * dot(&drags[i], &x[i]);
            add(&mut external, -1.0, &drags[i]);
            add(&mut momentum, -h * element.b[i], &forces.internal[i]);
            add(&mut momentum, h * element.b[i], &external);
            add(&mut end, element.b[i], &x[i]);
            add(&mut external, -1.0, &forces.springs[i]);
            add(&mut external, -1.0, &forces.attraction[i]);
            step.add_impulse(self, h * element.b[i], &u, &external);
            let own = (&reactions[i][..], &forces.springs[i][..]);
            self.add_reactions(&mut step.reactions, element.b[i], (t, &u), own);
        }
        // The velocity of driven nodes is given; the momentum of free ones stays.
        let is_released = |owner: Option<usize>| {
            owner.is_some_and(|number| (self.supports[number].until - t - h).abs() < 1e-9)
        };
        let mut v = vec![0.0; n];
        for (dof, drive) in driven.iter().enumerate() {
            if let Some((drive, owner)) = drive {
                v[dof] = drive.velocity(t + h, is_released(*owner));
            }
        }
        let given_momentum = self.mass_product(&v);
        let (heavy, factors) = &start.masses;
        let right: Vec<f64> = heavy.iter().map(|&dof| momentum[dof] - given_momentum[dof]).collect();
        heavy.iter().zip(factors.solve(&right)).for_each(|(&dof, own)| v[dof] = own);
        let after = self.mass_product(&v);
        // The jump of the momentum of driven nodes is an impulse of the reactions.
        let mut jump = vec![0.0; n];
        let before = end_velocity(element, &x, &state.v, h);
        for (dof, drive) in driven.iter().enumerate() {
            if drive.is_some() {
                jump[dof] = after[dof] - momentum[dof];
                step.work += 0.5 * (before[dof] + v[dof]) * jump[dof];
            }
        }
        step.add_impulse(self, 1.0, &end, &jump);
        let none = vec![0.0; n];
        self.add_reactions(&mut step.reactions, 1.0 / h, (t, &end), (&jump, &none));
        Ok(Step { u: end, v, momentum: after, ..step })
    }

    /// Residuals `M (x_i - h v(c_i))` at the rates of a step, and what they consist of.
    fn stages(&self, start: &Start<'_>, x: &[Vec<f64>]) -> Stages {
        let Start { element, state, p, t, h, masses: (heavy, factors), dead } = start;
        let (n, k, h) = (self.n(), element.c.len(), *h);
        let forces = self.body.stage_forces(element, &state.u, x, h);
        let loads = self.body.stage_loads(element, &state.u, x, (*t, h), dead);
        // Rates of the momentum by alpha.
        let rate = |i: usize| {
            let mut rate = vec![0.0; n];
            add(&mut rate, -h, &forces.internal[i]);
            add(&mut rate, h, &loads[i]);
            add(&mut rate, -self.body.drag, &self.mass_product(&x[i]));
            rate
        };
        let momentum_rates: Vec<Vec<f64>> = (0..k).map(rate).collect();
        let mut damping = vec![vec![0.0; n]; k];
        let mut dissipated = 0.0;
        if let Some((beta, p)) = &element.dissipation {
            let (mut change, mut turn) = (vec![0.0; n], vec![0.0; n]);
            for j in 0..k {
                add(&mut change, element.b[j] * p[j], &momentum_rates[j]);
                add(&mut turn, element.b[j] * p[j], &x[j]);
            }
            let right: Vec<f64> = heavy.iter().map(|&dof| change[dof]).collect();
            let mut velocity = vec![0.0; n];
            heavy.iter().zip(factors.solve(&right)).for_each(|(&dof, own)| velocity[dof] = own);
            let gamma = self.without_rigid(velocity, &turn, heavy);
            let weighted = self.mass_product(&gamma);
            dissipated = beta * dot(&gamma, &weighted);
            (0..k).for_each(|i| add(&mut damping[i], h * beta * p[i], &weighted));
        }
        let residual = |i: usize| {
            let mut own = self.mass_product(&x[i]);
            add(&mut own, -h, p);
            (0..k).for_each(|j| add(&mut own, -h * element.a[i][j], &momentum_rates[j]));
            add(&mut own, -1.0, &damping[i]);
            // Internal nodes have no inertia: their forces vanish at each stage.
            (3 * self.body.n_nodes()..n).for_each(|dof| own[dof] = h * h * forces.internal[i][dof]);
            own
        };
        let residuals = (0..k).map(residual).collect();
        Stages { residuals, forces, loads, damping, dissipated }
    }

    /// A velocity without its parts along translations and turns of the arms, where the body may move so.
    fn without_rigid(&self, mut velocity: Vec<f64>, arms: &[f64], heavy: &[usize]) -> Vec<f64> {
        let n = self.body.n_nodes();
        let is_free = |dof: usize| heavy.binary_search(&dof).is_ok();
        let fixed = |node: usize| [0, 1, 2].map(|d| !is_free(3 * node + d));
        let mut vectors = Vec::new();
        let may_move = [0, 1, 2].map(|d| (0..n).all(|node| is_free(3 * node + d)));
        for d in (0..3).filter(|d| may_move[*d]) {
            let mut vector = vec![0.0; self.n()];
            (0..n).for_each(|node| vector[3 * node + d] = 1.0);
            vectors.push(vector);
        }
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            if (0..n).any(|node| fixed(node) != [true; 3] && (fixed(node)[b] || fixed(node)[c])) {
                continue;
            }
            let mut vector = vec![0.0; self.n()];
            for node in 0..n {
                vector[3 * node + b] = -arms[3 * node + c];
                vector[3 * node + c] = arms[3 * node + b];
            }
            vectors.push(vector);
        }
        let mut basis: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        for mut vector in vectors {
            let size = dot(&vector, &self.mass_product(&vector));
            for _ in 0..2 {
                for (own, weighted) in &basis {
                    let part = dot(&vector, weighted);
                    add(&mut vector, -part, own);
                }
            }
            let weighted = self.mass_product(&vector);
            let square = dot(&vector, &weighted);
            if square > 1e-12 * size {
                let root = 1.0 / square.sqrt();
                basis.push((
                    vector.iter().map(|x| root * x).collect(),
                    weighted.iter().map(|x| root * x).collect(),
                ));
            }
        }
        for (own, weighted) in &basis {
            let part = dot(&velocity, weighted);
            add(&mut velocity, -part, own);
        }
        velocity
    }
}

/// The start of a step.
struct Start<'a> {
    element: &'a Element,
    state: &'a State,
    p: &'a [f64],
    t: f64,
    h: f64,
    masses: (Vec<usize>, Factors),
    dead: Vec<Vec<f64>>,
}

/// Residuals, and what they consist of.
struct Stages {
    residuals: Vec<Vec<f64>>,
    forces: StageForces,
    loads: Vec<Vec<f64>>,
    damping: Vec<Vec<f64>>,
    dissipated: f64,
}

/// Velocity at the end of the polynomial of a step.
fn end_velocity(element: &Element, x: &[Vec<f64>], start: &[f64], h: f64) -> Vec<f64> {
    let points: Vec<f64> = [0.0].into_iter().chain(element.c.iter().copied()).collect();
    let mut v: Vec<f64> = start.iter().map(|v| v * lagrange(&points, 0, 1.0)).collect();
    for (j, x) in x.iter().enumerate() {
        add(&mut v, lagrange(&points, j + 1, 1.0) / h, x);
    }
    v
}
