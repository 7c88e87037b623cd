//! Free vibrations as an observer sees them who turns with the body.
//!
//! ```math
//! M u'' + 2 G u' + K u = 0,    G u = M (s x u)
//! ```
//!
//! In a space of real modes, K is the diagonal matrix of their `omega_j^2` and G an antisymmetric one, g. With
//! `p = y'` and `s_j = omega_j y_j` the equations have an antisymmetric matrix, whose eigenvalues `i omega` are
//! imaginary (Meirovitch 1974, AIAA Journal 12):
//!
//! ```math
//! s' = D p,    p' = -D s - 2 g p,    D = diag(omega_j)
//! ```

use super::pencil::{BodyPencil, Linearised};
use super::{Mode, n_modes, solved, translations};
use crate::body::Body;
use crate::error::{Error, Result};
use crate::sparse::reduce::dot;
use crate::sparse::{Pencil, antisymmetric_eigenpairs};

/// Number of real modes for each one that is wanted.
const REAL_MODES: usize = 2;

/// Shift of the norm of residuals over the lowest `omega_j^2`.
const SHIFT: f64 = 0.01;

/// The lowest modes that an observer with an angular velocity sees.
///
/// # Errors
/// Those of [`solved`]; [`Error::Rotation`] if the stiffness is not positive definite.
pub(super) fn modes(
    body: &Body,
    linearised: &mut Linearised,
    spin: [f64; 3],
    count: usize,
) -> Result<Vec<Mode>> {
    // A count beyond the number of modes is refused there.
    let real = solved(body, linearised, (REAL_MODES * count).min(n_modes(body)).max(count))?;
    let lowest = real.first().map_or(0.0, |mode| mode.angular_frequency);
    if lowest <= 0.0 {
        return Err(Error::Rotation { reason: reason(&real) });
    }
    let (n, m) = (body.n_dofs(), real.len());
    let mut pencil = BodyPencil::new(body, linearised)?;
    // Rigid bodies under the softening may need a larger one.
    pencil.factorize(SHIFT * lowest * lowest)?;
    let basis: Vec<f64> = real.iter().flat_map(|mode| mode.shape.iter().copied()).collect();
    let mut turned = vec![0.0; basis.len()];
    pencil.multiply_gyroscopic(spin, &basis, &mut turned);
    let vector = |of: &[f64], j: usize| -> Vec<f64> { of[j * n..(j + 1) * n].to_vec() };
    let mut matrix = vec![0.0; 4 * m * m];
    for (i, j) in (0..m).flat_map(|i| (0..m).map(move |j| (i, j))) {
        matrix[(m + i) * 2 * m + m + j] = -2.0 * dot(&basis[i * n..(i + 1) * n], &vector(&turned, j));
    }
    for (j, mode) in real.iter().enumerate() {
        matrix[j * 2 * m + m + j] = mode.angular_frequency;
        matrix[(m + j) * 2 * m + j] = -mode.angular_frequency;
    }
    let translations = translations(body);
    let found = antisymmetric_eigenpairs(&matrix)?;
    let seen = found.into_iter().take(count).map(|(omega, z)| {
        // y = s/D, scaled by sqrt(2) omega.
        let scale = |j: usize| std::f64::consts::SQRT_2 * omega / real[j].angular_frequency;
        let part = |of: fn(&(f64, f64)) -> f64| {
            let mut sum = vec![0.0; n];
            for (j, z) in z[..m].iter().enumerate() {
                let c = scale(j) * of(z);
                sum.iter_mut().zip(&basis[j * n..]).for_each(|(sum, x)| *sum += c * x);
            }
            sum
        };
        let v = [part(|z| z.0), part(|z| z.1)];
        let residual = residual(&mut pencil, spin, omega, &v);
        let masses = translations.each_ref().map(|e| dot(&v[0], e).powi(2) + dot(&v[1], e).powi(2));
        Mode { angular_frequency: omega, shape: at_largest(&v), effective_mass: masses, residual }
    });
    Ok(seen.collect())
}

/// Why there are no vibrations about a state.
fn reason(real: &[Mode]) -> String {
    let unstable = real.iter().filter(|mode| mode.angular_frequency < 0.0).count();
    let rest = "frequencies for an observer that turns need a stiffness that is positive definite";
    match unstable {
        0 => format!("nothing holds the body against a rigid motion; {rest}"),
        _ => format!(
            "the stiffness, softened by the centrifugal force, has {unstable} unstable mode{}: the speed is beyond the limit of \
             static stability; {rest}",
            if unstable == 1 { "" } else { "s" }
        ),
    }
}

/// The relative residual of a vibration `v exp(i omega t)`, `[real, imaginary]`.
fn residual(pencil: &mut BodyPencil<'_>, spin: [f64; 3], omega: f64, v: &[Vec<f64>; 2]) -> f64 {
    let n = v[0].len();
    let v = v.concat();
    let [mut stiff, mut mass, mut turned] = [(); 3].map(|()| vec![0.0; 2 * n]);
    pencil.multiply_stiffness(&v, &mut stiff);
    pencil.multiply_mass(&v, &mut mass);
    pencil.multiply_gyroscopic(spin, &v, &mut turned);
    // The product of i with (x, y) is (-y, x).
    let coriolis = |at: usize| if at < n { -turned[n + at] } else { turned[at - n] };
    let rest: Vec<f64> =
        (0..2 * n).map(|at| stiff[at] - omega * omega * mass[at] + 2.0 * omega * coriolis(at)).collect();
    let mut size = |vector: Vec<f64>| {
        let mut solution = vector.clone();
        pencil.solve(&mut solution);
        dot(&vector, &solution).abs().sqrt()
    };
    size(rest) / size(stiff)
}

/// The real part of a complex vector in the phase in which its largest component is real and positive.
fn at_largest([x, y]: &[Vec<f64>; 2]) -> Vec<f64> {
    let larger =
        |most: (f64, f64), z: (f64, f64)| if z.0.hypot(z.1) > most.0.hypot(most.1) { z } else { most };
    let (re, im) = x.iter().copied().zip(y.iter().copied()).fold((0.0, 0.0), larger);
    let size = re.hypot(im);
    x.iter().zip(y).map(|(x, y)| (x * re + y * im) / size).collect()
}
