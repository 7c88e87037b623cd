//! Schemes in time, one step after the other, by Newton's iteration with differences for derivatives.

mod classic;
mod drive;
mod statics;
mod time_element;

pub use drive::Drive;

use super::body::Body;
use super::element::Element;
use super::numbers::{Factors, Matrix, cross, dot};

/// A support: driven degrees of freedom, or springs, up to a time.
#[derive(Debug, Clone)]
pub struct Support {
    /// Driven degrees of freedom.
    pub drives: Vec<(usize, Drive)>,
    /// Whether the springs of the body belong to it.
    pub has_springs: bool,
    /// Time of release.
    pub until: f64,
}

/// A scheme.
#[derive(Debug, Clone)]
pub enum Scheme {
    /// A time element.
    Element(Element),
    /// Newmark's family: alpha_m, alpha_f, beta, gamma.
    Newmark([f64; 4]),
    /// Bathe's composite method.
    Bathe,
    /// Central differences.
    Central,
}

/// A row of the history.
#[derive(Debug, Clone)]
pub struct Row {
    /// Time.
    pub time: f64,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Stored energy.
    pub strain: f64,
    /// Smallest det F.
    pub determinant: f64,
    /// External work since the start.
    pub work: f64,
    /// Dissipated energy since the start.
    pub dissipated: f64,
    /// Residual of the energy in the step.
    pub energy_residual: f64,
    /// Momenta, linear and angular.
    pub momenta: [[f64; 3]; 2],
    /// Norms of the residuals of momenta in the step.
    pub momentum_residuals: [f64; 2],
    /// Mean force and moment of each support.
    pub reactions: Vec<[[f64; 3]; 2]>,
    /// Displacement, with internal nodes.
    pub displacement: Vec<f64>,
    /// Velocity.
    pub velocity: Vec<f64>,
}

/// State between steps.
#[derive(Debug, Clone)]
pub struct State {
    /// Displacement, with internal nodes.
    pub u: Vec<f64>,
    /// Velocity.
    pub v: Vec<f64>,
}

/// A motion.
#[derive(Debug)]
pub struct Motion<'a> {
    /// The body.
    pub body: &'a Body,
    /// Its supports.
    pub supports: &'a [Support],
    /// The scheme.
    pub scheme: &'a Scheme,
    /// Factor on the accelerations of the first guess of a time element, which decides between several solutions of
    /// a step.
    pub guess: f64,
}

/// Impulses of a step.
struct Step {
    u: Vec<f64>,
    v: Vec<f64>,
    momentum: Vec<f64>,
    work: f64,
    dissipated: f64,
    linear: [f64; 3],
    angular: [f64; 3],
    reactions: Vec<[[f64; 3]; 2]>,
}

fn add(sum: &mut [f64], factor: f64, other: &[f64]) {
    sum.iter_mut().zip(other).for_each(|(s, o)| *s += factor * o);
}

impl Motion<'_> {
    fn n(&self) -> usize {
        3 * self.body.n_all
    }

    /// Driven degrees of freedom in a step that starts at a time, the first support that holds one first.
    fn driven(&self, t: f64) -> Vec<Option<(Drive, Option<usize>)>> {
        let mut driven: Vec<Option<(Drive, Option<usize>)>> = vec![None; self.n()];
        if self.body.is_plane {
            (2..self.n()).step_by(3).for_each(|dof| driven[dof] = Some((Drive::Fixed, None)));
        }
        for (number, support) in self.supports.iter().enumerate() {
            if t > support.until - 1e-9 {
                continue;
            }
            for (dof, drive) in &support.drives {
                if driven[*dof].as_ref().is_none_or(|(_, owner)| owner.is_none()) {
                    driven[*dof] = Some((drive.clone(), Some(number)));
                }
            }
        }
        driven
    }

    /// Degrees of freedom that are not driven in a step that starts at a time.
    pub fn free(&self, t: f64) -> Vec<usize> {
        self.driven(t).iter().enumerate().filter(|(_, drive)| drive.is_none()).map(|(dof, _)| dof).collect()
    }

    fn mass_product(&self, v: &[f64]) -> Vec<f64> {
        let mut p = vec![0.0; self.n()];
        let n = self.body.n_nodes();
        for i in 0..n {
            for d in 0..3 {
                p[3 * i + d] = match self.scheme {
                    Scheme::Central => self.body.lumped[i] * v[3 * i + d],
                    _ => (0..n).map(|j| self.body.mass[i][j] * v[3 * j + d]).sum(),
                };
            }
        }
        p
    }

    /// `M_ff` of free degrees of freedom with mass.
    fn mass_factors(&self, free: &[usize]) -> (Vec<usize>, Factors) {
        let heavy: Vec<usize> = free.iter().copied().filter(|dof| *dof < 3 * self.body.n_nodes()).collect();
        let entry = |a: usize, b: usize| match (a % 3 == b % 3, self.scheme) {
            (false, _) => 0.0,
            (true, Scheme::Central) => {
                if a == b {
                    self.body.lumped[a / 3]
                } else {
                    0.0
                }
            }
            (true, _) => self.body.mass[a / 3][b / 3],
        };
        let rows: Matrix = heavy.iter().map(|&a| heavy.iter().map(|&b| entry(a, b)).collect()).collect();
        (heavy, Factors::new(rows))
    }

    /// The rows of the history at some times; the state is that at the first of them, with the given velocity of nodes
    /// that are not driven.
    ///
    /// # Errors
    /// If a step does not converge.
    pub fn rows(&self, mut state: State, times: &[f64], is_equilibrium: bool) -> Result<Vec<Row>, String> {
        let driven = self.driven(times[0]);
        for (dof, drive) in driven.iter().enumerate() {
            if let Some((drive, _)) = drive {
                state.v[dof] = drive.velocity(times[0], false);
            }
        }
        (3 * self.body.n_nodes()..self.n()).for_each(|dof| state.v[dof] = 0.0);
        let mut momentum = self.mass_product(&state.v);
        let mut rows = vec![self.row(times[0], &state, &momentum)];
        if is_equilibrium {
            rows[0].reactions = self.static_reactions(&state.u, 1.0);
        }
        let mut memory = None;
        let mut free = self.free(times[0]);
        for pair in times.windows(2) {
            let (t, h) = (pair[0], pair[1] - pair[0]);
            if self.free(t) != free {
                memory = None;
                free = self.free(t);
            }
            let step = match self.scheme {
                Scheme::Element(element) => self.element_step(element, &state, &momentum, t, h)?,
                Scheme::Newmark(parameters) => self.newmark_step(*parameters, &state, &mut memory, t, h)?,
                Scheme::Bathe => self.bathe_step(&state, &mut memory, t, h)?,
                Scheme::Central => self.central_step(&state, t, h),
            };
            state = State { u: step.u, v: step.v };
            momentum = step.momentum;
            let before = rows[rows.len() - 1].clone();
            let mut row = self.row(pair[1], &state, &momentum);
            row.work = before.work + step.work;
            row.dissipated = before.dissipated + step.dissipated;
            row.energy_residual =
                row.kinetic + row.strain - before.kinetic - before.strain - step.work + step.dissipated;
            for (m, impulse) in [step.linear, step.angular].iter().enumerate() {
                let defect: [f64; 3] =
                    std::array::from_fn(|d| row.momenta[m][d] - before.momenta[m][d] - impulse[d]);
                row.momentum_residuals[m] = dot(&defect, &defect).sqrt();
            }
            row.reactions = step.reactions;
            rows.push(row);
        }
        Ok(rows)
    }

    fn row(&self, time: f64, state: &State, momentum: &[f64]) -> Row {
        let (strain, determinant) = self.body.energy(&state.u);
        Row {
            time,
            kinetic: 0.5 * dot(momentum, &state.v),
            strain,
            determinant,
            work: 0.0,
            dissipated: 0.0,
            energy_residual: 0.0,
            momenta: self.resultants(&state.u, momentum),
            momentum_residuals: [0.0; 2],
            reactions: Vec::new(),
            displacement: state.u.clone(),
            velocity: state.v.clone(),
        }
    }

    /// Sum of a nodal field, and its moment about the origin.
    fn resultants(&self, u: &[f64], field: &[f64]) -> [[f64; 3]; 2] {
        let mut sums = [[0.0; 3]; 2];
        for (node, point) in self.body.points.iter().enumerate() {
            let own: [f64; 3] = std::array::from_fn(|d| field[3 * node + d]);
            let place = std::array::from_fn(|d| point[d] + u[3 * node + d]);
            let moment = cross(place, own);
            (0..3).for_each(|d| (sums[0][d] += own[d], sums[1][d] += moment[d]).0);
        }
        sums
    }

    /// Adds the resultants of a nodal force of one support.
    fn add_reaction(&self, sum: &mut [[f64; 3]; 2], weight: f64, u: &[f64], force: &[f64]) {
        let own = self.resultants(u, force);
        (0..2).for_each(|m| (0..3).for_each(|d| sum[m][d] += weight * own[m][d]));
    }

    fn add_reactions(
        &self,
        sums: &mut [[[f64; 3]; 2]],
        weight: f64,
        (t, u): (f64, &[f64]),
        (reaction, springs): (&[f64], &[f64]),
    ) {
        let driven = self.driven(t);
        for (number, support) in self.supports.iter().enumerate() {
            let mut force = vec![0.0; self.n()];
            for (dof, drive) in driven.iter().enumerate() {
                if drive.as_ref().is_some_and(|(_, owner)| *owner == Some(number)) {
                    force[dof] = reaction[dof];
                }
            }
            if support.has_springs {
                add(&mut force, -1.0, springs);
            }
            self.add_reaction(&mut sums[number], weight, u, &force);
        }
    }

    /// Reactions of a body at rest at time 0, under a part of the loads.
    pub fn static_reactions(&self, u: &[f64], fraction: f64) -> Vec<[[f64; 3]; 2]> {
        let mut sums = vec![[[0.0; 3]; 2]; self.supports.len()];
        let mut reaction = self.body.forces(u);
        add(&mut reaction, -fraction, &self.body.loads(u, 0.0, true));
        self.add_reactions(&mut sums, 1.0, (0.0, u), (&reaction, &self.body.spring_forces(u)));
        sums
    }
}

impl Step {
    fn new(motion: &Motion<'_>) -> Self {
        Step {
            u: Vec::new(),
            v: Vec::new(),
            momentum: Vec::new(),
            work: 0.0,
            dissipated: 0.0,
            linear: [0.0; 3],
            angular: [0.0; 3],
            reactions: vec![[[0.0; 3]; 2]; motion.supports.len()],
        }
    }

    fn add_impulse(&mut self, motion: &Motion<'_>, duration: f64, u: &[f64], force: &[f64]) {
        let [linear, angular] = motion.resultants(u, force);
        add(&mut self.linear, duration, &linear);
        add(&mut self.angular, duration, &angular);
    }
}
