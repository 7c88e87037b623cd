//! Schemes in time, one step after the other, by Newton's iteration with differences for derivatives.

use super::body::{Body, Element, History, StageForces, pieces};
use super::numbers::{Factors, Matrix, cross, dot, lagrange};

/// Motion of a driven degree of freedom.
#[derive(Debug, Clone)]
pub enum Drive {
    /// It does not move.
    Fixed,
    /// Factor times a history.
    Move(f64, History),
    /// Rotation about the z axis through a point by a history of the angle, for component 0 or 1 of a node at an arm.
    Turn {
        /// Arm x, y of the node.
        arm: [f64; 2],
        /// Component.
        component: usize,
        /// Angle over time.
        angle: History,
    },
}

impl Drive {
    fn displacement(&self, t: f64) -> f64 {
        match self {
            Drive::Fixed => 0.0,
            Drive::Move(factor, history) => factor * history.at(t),
            Drive::Turn { arm, component, angle } => {
                let (s, c) = angle.at(t).sin_cos();
                [c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]][*component] - arm[*component]
            }
        }
    }

    fn velocity(&self, t: f64, is_before: bool) -> f64 {
        match self {
            Drive::Fixed => 0.0,
            Drive::Move(factor, history) => factor * history.rate(t, is_before),
            Drive::Turn { arm, component, angle } => {
                let (s, c) = angle.at(t).sin_cos();
                let rate = angle.rate(t, is_before);
                rate * [-s * arm[0] - c * arm[1], c * arm[0] - s * arm[1]][*component]
            }
        }
    }

    fn kinks(&self) -> Vec<f64> {
        match self {
            Drive::Move(_, history) | Drive::Turn { angle: history, .. } => history.kinks(),
            Drive::Fixed => Vec::new(),
        }
    }
}

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

/// Root of a residual: Newton's iteration with a matrix of differences, renewed when it is slow.
///
/// # Errors
/// If it does not converge.
pub fn solve(mut x: Vec<f64>, scale: f64, residual: impl Fn(&[f64]) -> Vec<f64>) -> Result<Vec<f64>, String> {
    if x.is_empty() {
        return Ok(x);
    }
    let norm = |r: &[f64]| dot(r, r).sqrt();
    let mut current = residual(&x);
    for _ in 0..20 {
        let step = 1e-6 * scale;
        let mut jacobian = vec![vec![0.0; x.len()]; x.len()];
        for j in 0..x.len() {
            let mut moved = x.clone();
            moved[j] += step;
            let after = residual(&moved);
            (0..x.len()).for_each(|i| jacobian[i][j] = (after[i] - current[i]) / step);
        }
        let factors = Factors::new(jacobian);
        for round in 0..40 {
            let correction = factors.solve(&current);
            let size = correction.iter().fold(0.0f64, |m, c| m.max(c.abs()));
            if !size.is_finite() {
                return Err("not finite".into());
            }
            // With a new matrix a correction that is too long is halved.
            let (mut factor, mut next, mut next_residual);
            let mut halvings = 0;
            loop {
                factor = 0.5f64.powi(halvings);
                next = x.iter().zip(&correction).map(|(x, c)| x - factor * c).collect::<Vec<f64>>();
                next_residual = residual(&next);
                let is_short = norm(&next_residual) < norm(&current) || size < 1e-9 * scale;
                if is_short || round > 0 || halvings == 12 {
                    break;
                }
                halvings += 1;
            }
            let is_better = norm(&next_residual) < 0.5 * norm(&current);
            if is_better || round == 0 && size > 1e-13 * scale {
                x = next;
                current = next_residual;
            }
            if size < 1e-11 * scale && !is_better || norm(&current) == 0.0 {
                return Ok(x);
            }
            if !is_better {
                break;
            }
        }
    }
    Err("does not converge".into())
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

    /// Static equilibria under parts of the loads before time 0, with the same parts of the motion of driven supports.
    ///
    /// # Errors
    /// If one is not found.
    pub fn equilibria(&self, fractions: &[f64]) -> Result<Vec<Vec<f64>>, String> {
        let (driven, free) = (self.driven(0.0), self.free(0.0));
        let mut u = vec![0.0; self.n()];
        let mut path = Vec::new();
        for &fraction in fractions {
            for (dof, drive) in driven.iter().enumerate() {
                if let Some((drive, _)) = drive {
                    u[dof] = fraction * drive.displacement(0.0);
                }
            }
            let with = |x: &[f64]| {
                let mut all = u.clone();
                free.iter().zip(x).for_each(|(&dof, x)| all[dof] = *x);
                all
            };
            let residual = |x: &[f64]| {
                let all = with(x);
                let (forces, loads) = (self.body.forces(&all), self.body.loads(&all, 0.0, true));
                free.iter().map(|&dof| forces[dof] - fraction * loads[dof]).collect()
            };
            let x = solve(free.iter().map(|&dof| u[dof]).collect(), 1.0, residual)?;
            u = with(&x);
            path.push(u.clone());
        }
        Ok(path)
    }

    /// Derivative of the forces at a displacement, by differences of the fourth order, less the symmetric part of the
    /// derivative of the pressure at time 0.
    pub fn stiffness(&self, u: &[f64], has_pressure: bool) -> Matrix {
        let h = 1e-5;
        let force = |u: &[f64], transposed: bool| {
            let mut force = if transposed { vec![0.0; u.len()] } else { self.body.forces(u) };
            if has_pressure {
                add(&mut force, -0.5, &self.body.pressure_load(u, 0.0));
            }
            force
        };
        let mut whole = self.derivative(u, h, |u| force(u, false));
        if has_pressure {
            let other = self.derivative(u, h, |u| force(u, true));
            (0..u.len()).for_each(|i| (0..u.len()).for_each(|j| whole[i][j] += other[j][i]));
        }
        whole
    }

    fn derivative(&self, u: &[f64], h: f64, force: impl Fn(&[f64]) -> Vec<f64>) -> Matrix {
        let column = |dof: usize| {
            let at = |factor: f64| {
                let mut moved = u.to_vec();
                moved[dof] += factor * h;
                force(&moved)
            };
            let [a, b, c, d] = [1.0, -1.0, 2.0, -2.0].map(at);
            (0..u.len()).map(|i| (8.0 * (a[i] - b[i]) - (c[i] - d[i])) / (12.0 * h)).collect::<Vec<f64>>()
        };
        let columns: Matrix = (0..u.len()).map(column).collect();
        (0..u.len()).map(|i| (0..u.len()).map(|j| columns[j][i]).collect()).collect()
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

    fn element_step(
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
            let own = |dof: &usize| h * state.v[*dof] + c * h * h * a[*dof];
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

    /// Acceleration, and loads with reactions, at a state.
    fn at_rest_of_step(&self, u: &[f64], t: f64, set: f64) -> Memory {
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

    fn newmark_step(
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

    fn bathe_step(&self, state: &State, memory: &mut Option<Memory>, t: f64, h: f64) -> Result<Step, String> {
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

    fn central_step(&self, state: &State, t: f64, h: f64) -> Step {
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

/// What a step starts from.
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

/// The acceleration at the end of the last step.
struct Memory {
    a: Vec<f64>,
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

/// Velocity at the end of the polynomial of a step.
fn end_velocity(element: &Element, x: &[Vec<f64>], start: &[f64], h: f64) -> Vec<f64> {
    let points: Vec<f64> = [0.0].into_iter().chain(element.c.iter().copied()).collect();
    let mut v: Vec<f64> = start.iter().map(|v| v * lagrange(&points, 0, 1.0)).collect();
    for (j, x) in x.iter().enumerate() {
        add(&mut v, lagrange(&points, j + 1, 1.0) / h, x);
    }
    v
}
