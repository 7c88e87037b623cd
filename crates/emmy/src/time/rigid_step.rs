//! The rigid motion that obeys the equations of a step: k spins from the balance of moments.

use super::stage_coefficients::StageCoefficients;
use crate::sparse::eliminate;
use crate::tensor::Mat3;
use crate::tensor::rotation::{IDENTITY, log, moment, product, product_transposed, skew};

/// More iterations than Newton's method needs from no rotation, for up to a radian or two per step.
const ITERATIONS: usize = 20;

/// Moments up to this part of their terms count as balanced.
const ROUNDING: f64 = 1e-13;

/// Inertia, relative to the largest, assigned to a body without any about an axis (all points on a line).
const SMALLEST: f64 = 1e-10;

/// Passes that compute a spin to rounding.
const REFINEMENTS: usize = 3;

/// The rates of a step in which a body moves without strain.
///
/// With the positions y about the centre of mass at the start of the step, the rates are `x_j = D_j y`. Zero strain
/// rates at the Gauss points c_i mean a spin w_i there,
///
/// ```math
/// D_i = [w_i] T_i,     T_i = I + sum_j a_ij D_j
/// ```
///
/// which is Gauss collocation of a rotation: the body ends rotated by an orthogonal tensor (for k = 1 Cayley's).
/// Internal forces have no moment about the positions `T_i y`, so the stage equations leave
///
/// ```math
/// sum_A T_i y_A x ( sum_j m_ij (M D_j y)_A - G_iA ) = 0,     G_i = g_i + s^2 f_i^ext
/// ```
///
/// which contain the body only through the tensors `J = sum_A (M y)_A y_A^T` and `B_i = sum_A G_iA y_A^T`: 3k equations
/// for k spins.
#[derive(Debug)]
pub(crate) struct RigidStep {
    /// Degree of the time element.
    k: usize,
    /// Spins w_i.
    pub spins: Vec<[f64; 3]>,
    /// D_j.
    pub rates: Vec<Mat3<f64>>,
    /// T_i.
    positions: Vec<Mat3<f64>>,
    /// Rotation vector of the whole step.
    pub rotation: [f64; 3],
    /// Matrix of the collocation and its right-hand sides: three for D, then three for every component of a spin.
    collocation: Vec<f64>,
    changes: Vec<f64>,
    jacobian: Vec<f64>,
    turns: Vec<f64>,
    scratch: Vec<f64>,
    /// Whether spins, changes and Jacobian belong to a solution.
    is_solved: bool,
}

impl RigidStep {
    pub(crate) fn new(k: usize) -> Self {
        RigidStep {
            k,
            spins: vec![[0.0; 3]; k],
            rates: vec![[[0.0; 3]; 3]; k],
            positions: vec![IDENTITY; k],
            rotation: [0.0; 3],
            collocation: vec![0.0; 9 * k * k],
            changes: vec![0.0; 3 * k * (3 + 9 * k)],
            jacobian: vec![0.0; 9 * k * k],
            turns: vec![0.0; 3 * k],
            scratch: vec![0.0; 9 * k * k],
            is_solved: false,
        }
    }

    /// No rotation.
    pub(crate) fn set_rest(&mut self) {
        self.spins.fill([0.0; 3]);
        self.rates.fill([[0.0; 3]; 3]);
        self.positions.fill(IDENTITY);
        self.rotation = [0.0; 3];
        self.is_solved = false;
    }

    /// Changes of the D_j that remove the moments of the stages from a body, `moments: [k]`; zero about axes that are
    /// not free, and if no rotation is possible.
    pub(crate) fn balance(&mut self, moments: &[[f64; 3]], free: [bool; 3], changes: &mut [Mat3<f64>]) {
        changes.fill([[0.0; 3]; 3]);
        if !self.is_solved {
            return;
        }
        let columns = 3 + 9 * self.k;
        for (turn, (moment, d)) in
            self.turns.iter_mut().zip(moments.iter().flat_map(|m| [(m, 0), (m, 1), (m, 2)]))
        {
            *turn = if free[d] { -moment[d] } else { 0.0 };
        }
        self.scratch.copy_from_slice(&self.jacobian);
        if !eliminate(&mut self.scratch, &mut self.turns, 1) {
            return;
        }
        for (j, change) in changes.iter_mut().enumerate() {
            for (column, turn) in self.turns.iter().enumerate() {
                add(change, *turn, &block(&self.changes, columns, j, 3 + 3 * column));
            }
        }
    }

    /// Finds the spins about the free axes; without a solution the body does not rotate.
    pub(crate) fn solve(
        &mut self,
        coefficients: &StageCoefficients,
        inertia: &Mat3<f64>,
        known: &[Mat3<f64>],
        free: [bool; 3],
    ) {
        self.set_rest();
        if !free.contains(&true) {
            return;
        }
        for _ in 0..ITERATIONS {
            if !self.collocate(coefficients) {
                break;
            }
            if self.linearise(coefficients, inertia, known, free) {
                self.set_rotation(coefficients);
                self.is_solved = true;
                return;
            }
            if !eliminate(&mut self.jacobian, &mut self.turns, 1) {
                break;
            }
            for (spin, turn) in self.spins.iter_mut().zip(self.turns.chunks_exact(3)) {
                (0..3).for_each(|d| spin[d] += turn[d]);
            }
        }
        self.set_rest();
    }

    /// Takes given spins; the rest follows from them.
    pub(crate) fn follow(&mut self, coefficients: &StageCoefficients, spins: impl Iterator<Item = [f64; 3]>) {
        self.set_rest();
        self.spins.iter_mut().zip(spins).for_each(|(own, spin)| *own = spin);
        if self.collocate(coefficients) {
            self.set_rotation(coefficients);
        } else {
            self.set_rest();
        }
    }

    /// Sets the rotation over the step from the rates.
    fn set_rotation(&mut self, coefficients: &StageCoefficients) {
        let mut end = IDENTITY;
        self.rates.iter().zip(coefficients.rule.weights()).for_each(|(D, b)| add(&mut end, *b, D));
        self.rotation = log(&end);
    }

    /// Sets D, T and the changes of D with the spins.
    ///
    /// ```math
    /// D_i - [w_i] sum_j a_ij D_j = [w_i],     dD_i - [w_i] sum_j a_ij dD_j = [dw_i] T_i
    /// ```
    fn collocate(&mut self, coefficients: &StageCoefficients) -> bool {
        let k = self.k;
        let n = 3 * self.k;
        let a = coefficients.rule.coefficients();
        // T_i first, for the right-hand sides of the changes; two eliminations of a small matrix.
        for columns in [3, 3 + 3 * n] {
            self.collocation.fill(0.0);
            let changes = &mut self.changes[..n * columns];
            changes.fill(0.0);
            for i in 0..k {
                let spin = skew(&self.spins[i]);
                for d in 0..3 {
                    let row = 3 * i + d;
                    for (j, e) in (0..k).flat_map(|j| [(j, 0), (j, 1), (j, 2)]) {
                        self.collocation[row * n + 3 * j + e] = -a[i * k + j] * spin[d][e];
                    }
                    self.collocation[row * n + row] += 1.0;
                    changes[row * columns..row * columns + 3].copy_from_slice(&spin[d]);
                    for axis in (0..3).filter(|_| columns > 3) {
                        let at = row * columns + 3 + 3 * (3 * i + axis);
                        let turned = product(&unit_cross(axis), &self.positions[i]);
                        changes[at..at + 3].copy_from_slice(&turned[d]);
                    }
                }
            }
            if !eliminate(&mut self.collocation, changes, columns) {
                return false;
            }
            for i in 0..k {
                self.rates[i] = block(changes, columns, i, 0);
            }
            for i in 0..k {
                self.positions[i] = IDENTITY;
                (0..k).for_each(|j| add(&mut self.positions[i], a[i * k + j], &self.rates[j]));
            }
        }
        true
    }

    /// Sets the negative moments and their derivatives by the spins; returns whether the moments are balanced.
    fn linearise(
        &mut self,
        coefficients: &StageCoefficients,
        inertia: &Mat3<f64>,
        known: &[Mat3<f64>],
        free: [bool; 3],
    ) -> bool {
        let k = self.k;
        let n = 3 * self.k;
        let m = &coefficients.mass;
        let a = coefficients.rule.coefficients();
        let columns = 3 + 3 * n;
        let trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
        let (mut size, mut largest) = (0f64, 0f64);
        for i in 0..k {
            let mut force = [[0.0; 3]; 3];
            (0..k).for_each(|j| add(&mut force, m[i * k + j], &product(&self.rates[j], inertia)));
            let parts = force.iter().flatten().chain(known[i].iter().flatten());
            size = parts.fold(size, |size, part| size.max(part.abs()));
            add(&mut force, -1.0, &known[i]);
            let residual = moment(&product_transposed(&force, &self.positions[i]));
            for d in 0..3 {
                self.turns[3 * i + d] = if free[d] { -residual[d] } else { 0.0 };
                largest = largest.max(self.turns[3 * i + d].abs());
            }
            for column in 0..n {
                let (mut of_force, mut of_place) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
                for j in 0..k {
                    let change = block(&self.changes, columns, j, 3 + 3 * column);
                    add(&mut of_force, m[i * k + j], &product(&change, inertia));
                    add(&mut of_place, a[i * k + j], &change);
                }
                let mut change = product_transposed(&of_force, &self.positions[i]);
                add(&mut change, 1.0, &product_transposed(&force, &of_place));
                let change = moment(&change);
                for d in 0..3 {
                    let both = free[d] && free[column % 3];
                    self.jacobian[(3 * i + d) * n + column] = if both { change[d] } else { 0.0 };
                }
            }
            for d in 0..3 {
                let at = (3 * i + d) * (n + 1);
                self.jacobian[at] += if free[d] { SMALLEST * trace } else { 1.0 };
            }
        }
        largest <= ROUNDING * size
    }
}

/// Spin of a rigid body with the moments `sum_A p_A y_A^T` of its momentum, about the free axes; `None` if its inertia
/// is singular.
pub(crate) fn spin(inertia: &Mat3<f64>, moments: &Mat3<f64>, free: [bool; 3]) -> Option<[f64; 3]> {
    let trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
    let about = |d: usize, e: usize| if d == e { trace - inertia[d][e] } else { -inertia[d][e] };
    let moments = moment(moments);
    let mut spin = [0.0; 3];
    // The regularisation leaves its own small part to the next pass, except along an axis without inertia.
    for _ in 0..REFINEMENTS {
        let (mut matrix, mut change) = ([0.0; 9], [0.0; 3]);
        for d in (0..3).filter(|&d| free[d]) {
            change[d] = moments[d] - (0..3).map(|e| about(d, e) * spin[e]).sum::<f64>();
        }
        for (d, e) in (0..9).map(|n| (n / 3, n % 3)) {
            let own = if d == e { SMALLEST * trace } else { 0.0 };
            let is_free = free[d] && free[e];
            matrix[3 * d + e] = if is_free { about(d, e) + own } else { f64::from(u8::from(d == e)) };
        }
        if !eliminate(&mut matrix, &mut change, 1) {
            return None;
        }
        (0..3).for_each(|d| spin[d] += change[d]);
    }
    Some(spin)
}

/// Tensor of the rows 3 i.. and the columns from one on.
fn block(matrix: &[f64], columns: usize, i: usize, column: usize) -> Mat3<f64> {
    [0, 1, 2].map(|d| [0, 1, 2].map(|e| matrix[(3 * i + d) * columns + column + e]))
}

fn unit_cross(axis: usize) -> Mat3<f64> {
    let mut unit = [0.0; 3];
    unit[axis] = 1.0;
    skew(&unit)
}

/// `A += s B`.
fn add(A: &mut Mat3<f64>, s: f64, B: &Mat3<f64>) {
    for (A, B) in A.iter_mut().flatten().zip(B.iter().flatten()) {
        *A += s * B;
    }
}
