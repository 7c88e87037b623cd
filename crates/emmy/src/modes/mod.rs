//! Natural modes: small free vibrations about a state at rest, and the response to harmonic excitation by them.

mod pencil;
mod response;
mod rigid;
mod turning;

use pencil::{BodyPencil, Linearised, n_dependent, n_free};
pub use response::{Excitation, HarmonicResponse, ModalDamping, Quantity, StressChange};

use crate::body::Body;
use crate::error::{Error, Result};
use crate::sparse::reduce::dot;
use crate::sparse::{Eigenmodes, Pencil, smallest};
use crate::time::State;

/// A natural mode. For an observer that turns, [`modes_about`] says what its fields are.
///
/// ```
/// use emmy::modes::Mode;
/// let mode = Mode { angular_frequency: 4.0, shape: Vec::new(), effective_mass: [0.0; 3], residual: 0.0 };
/// assert_eq!((mode.frequency(), mode.period()), (4.0 / std::f64::consts::TAU, 0.5 * std::f64::consts::PI));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    /// Angular frequency omega \[1/time\]; 0 for a rigid mode. An unstable mode, which grows as `exp(gamma t)`, has
    /// `-gamma`.
    pub angular_frequency: f64,
    /// Shape v with `v^T M v = 1` and a positive largest component, `[n_nodes][3]` \[1/sqrt(mass)\].
    pub shape: Vec<f64>,
    /// Effective mass of each direction, `(v^T M e_d)^2` with the rigid translation e_d \[mass\]. The sums over all
    /// modes of a free body are its mass.
    pub effective_mass: [f64; 3],
    /// Relative residual `|r| / sqrt(omega^2 + s)` of the computed mode, `r = K v - omega^2 M v` in the norm of
    /// `(K + s M)^-1`, with a shift s up to about the lowest elastic omega^2; at most [`MAX_RESIDUAL`]. An exact
    /// `omega^2 + s` is as near, relatively.
    pub residual: f64,
}

impl Mode {
    /// Frequency `omega / (2 pi)` \[1/time\].
    pub fn frequency(&self) -> f64 {
        self.angular_frequency / std::f64::consts::TAU
    }

    /// Period `2 pi / omega` \[time\]; infinite for a rigid or unstable mode.
    pub fn period(&self) -> f64 {
        if self.is_elastic() { 1.0 / self.frequency() } else { f64::INFINITY }
    }

    /// Whether the body vibrates in this mode: it is neither rigid nor unstable.
    pub fn is_elastic(&self) -> bool {
        self.angular_frequency > 0.0
    }
}

/// Relative residual of the Ritz vectors at which the iteration ends; the errors of the eigenvalues are its square.
const TOLERANCE: f64 = 1e-9;

/// Largest relative residual of a mode; beyond it the search has failed.
pub const MAX_RESIDUAL: f64 = 1e-6;

/// Relative difference of shifts that find the same.
const SAME_SHIFT: f64 = 1e-3;

/// Number of shifts that are tried.
const MAX_SHIFTS: usize = 6;

/// Least ratio of the shift to the lowest elastic omega^2 of a body with rigid modes, whose eigenvalues 1/s must not
/// drown the others.
const LEAST_SHIFT: f64 = 1e-7;

/// Number of modes from which the search for the lowest elastic one starts: one more than a solid has rigid ones.
const RIGID_AND_ONE: usize = 7;

/// Number of modes at which that search ends.
const MAX_SEARCHED: usize = 56;

/// The modes of lowest frequency of a body without loads, about its reference configuration, the lowest first.
///
/// ```math
/// K v = omega^2 M v
/// ```
///
/// with the consistent mass M and the stiffness K of cells, links and springs; fixed and driven degrees of freedom are
/// held. Viscosity and drag are left out. Rigid modes are counted, and have the frequency 0: translations along x, y
/// and z as far as the body has them, then rotations and mechanisms. Motions are those that rigid bodies and joints
/// allow, `G v = 0`; given motions of joints are held.
///
/// # Errors
/// [`Error::TooManyModes`], [`Error::OutOfMemory`], [`Error::Modes`] if a residual exceeds [`MAX_RESIDUAL`].
///
/// ```
/// use emmy::modes::modes;
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let modes = modes(&body, 8)?;
/// assert_eq!(modes.iter().filter(|mode| mode.angular_frequency == 0.0).count(), 6);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn modes(body: &Body, count: usize) -> Result<Vec<Mode>> {
    body.space.check_whole("a search for natural modes")?;
    solved(body, &mut Linearised::at_reference(body)?, count)
}

/// The modes about a state, such as an equilibrium, with the stiffness of its displacement and of its follower
/// pressures (their symmetric part: exact for a pressure on a closed surface, or on one whose edge is held). A mode is
/// unstable if the equilibrium is. Velocities have no effect, nor have forces that are not balanced: the positions of a
/// motion at an instant count as those of a body at rest. The forces by which rigid bodies and joints carry the loads
/// have a stiffness, too: a pendulum has its frequency where it hangs.
///
/// Under a load [`LoadKind::Rotation`](crate::body::LoadKind::Rotation) the frequencies are those that the observer
/// sees, who turns with `s = Omega a`: K has the softening `-Omega^2 M P`, and the Coriolis force couples its modes.
///
/// ```math
/// M u'' + 2 G u' + K u = 0,    G u = M (s x u)
/// ```
///
/// This is solved in the space of the 2 `count` lowest modes of K and M, and the residual
/// `|(K + 2 i omega G - omega^2 M) v| / |K v|`, in the norm of `(K + s M)^-1` with a small shift s, tells what the
/// others would add: it has no bound but in the whole space, where it is rounding. The vibration v is complex, since
/// points run through ellipses. `shape` is its place at the moment of the largest component, `Re v`, with
/// `v^H (K + omega^2 M) v = 2 omega^2`, and the effective masses `|v^H M e_d|^2` still have the mass as their sum over
/// all modes of a free body.
///
/// # Errors
/// As [`modes`], and [`Error::Inverted`]; [`Error::Rotation`] where K is not positive definite for an observer that
/// turns: beyond the limit of static stability, or with rigid modes.
///
/// ```
/// use emmy::modes::{modes, modes_about};
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let state = State::initial(&body, 0.0, &[])?;
/// assert_eq!(modes_about(&body, &state, 8)?, modes(&body, 8)?);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn modes_about(body: &Body, state: &State, count: usize) -> Result<Vec<Mode>> {
    body.space.check_whole("a search for natural modes")?;
    seen(body, &mut about(body, state)?, count)
}

/// The modes of a linearised body as its observer sees them.
fn seen(body: &Body, linearised: &mut Linearised, count: usize) -> Result<Vec<Mode>> {
    match body.observer_spin() {
        Some(spin) => turning::modes(body, linearised, spin, count),
        None => solved(body, linearised, count),
    }
}

/// The body linearised about a state.
fn about(body: &Body, state: &State) -> Result<Linearised> {
    Linearised::about(body, state)
}

/// Number of modes of a body: its free degrees of freedom with mass, so that the incompatible modes of cells do not
/// count, less those that follow from others by rigid bodies and joints as drawn.
///
/// ```
/// use emmy::modes::n_modes;
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).support(Support::fixed("z-min")).build()?;
/// assert_eq!(n_modes(&body), 12);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn n_modes(body: &Body) -> usize {
    n_free(body) - n_dependent(body)
}

/// The lowest elastic mode about the reference configuration, and the number of rigid ones; `None` if the 56 lowest
/// modes are rigid or unstable.
///
/// # Errors
/// As [`modes`].
///
/// ```
/// use emmy::modes::lowest_elastic_mode;
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let (mode, n_rigid) = lowest_elastic_mode(&body)?.unwrap();
/// assert!(n_rigid == 6 && mode.period().is_finite());
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn lowest_elastic_mode(body: &Body) -> Result<Option<(Mode, usize)>> {
    body.space.check_whole("a search for natural modes")?;
    lowest_elastic(body, &mut Linearised::at_reference(body)?, solved)
}

/// The lowest elastic mode about a state, and the number of rigid ones, as [`modes_about`] has them; `None` if the 56
/// lowest modes are rigid or unstable.
///
/// # Errors
/// As [`modes_about`].
///
/// ```
/// use emmy::modes::{lowest_elastic_mode, lowest_elastic_mode_about};
/// use emmy::prelude::*;
/// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
/// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?;
/// let state = State::initial(&body, 0.0, &[])?;
/// assert_eq!(lowest_elastic_mode_about(&body, &state)?, lowest_elastic_mode(&body)?);
/// # Ok::<(), emmy::Error>(())
/// ```
pub fn lowest_elastic_mode_about(body: &Body, state: &State) -> Result<Option<(Mode, usize)>> {
    body.space.check_whole("a search for natural modes")?;
    lowest_elastic(body, &mut about(body, state)?, seen)
}

fn lowest_elastic(
    body: &Body,
    linearised: &mut Linearised,
    solved: impl Fn(&Body, &mut Linearised, usize) -> Result<Vec<Mode>>,
) -> Result<Option<(Mode, usize)>> {
    let most = MAX_SEARCHED.min(n_modes(body));
    let mut count = RIGID_AND_ONE.min(most);
    loop {
        let modes = if count == 0 { Vec::new() } else { solved(body, linearised, count)? };
        let n_rigid = modes.iter().filter(|mode| mode.angular_frequency == 0.0).count();
        let elastic = modes.into_iter().find(Mode::is_elastic);
        if elastic.is_some() || count == most {
            return Ok(elastic.map(|mode| (mode, n_rigid)));
        }
        count = (2 * count).min(most);
    }
}

/// The lowest modes of a linearised body, with a shift near the lowest elastic one.
fn solved(body: &Body, linearised: &mut Linearised, count: usize) -> Result<Vec<Mode>> {
    let mut pencil = BodyPencil::new(body, linearised)?;
    let free = pencil.n_modes();
    if count > free {
        return Err(Error::TooManyModes { count, free });
    }
    let max_vectors = 6 * count + 200;
    check_memory(body.n_dofs(), max_vectors.min(free))?;
    let mut shift = pencil.suggested_shift();
    let mut residual = f64::INFINITY;
    for _ in 0..MAX_SHIFTS {
        pencil.factorize(shift)?;
        let mut found = smallest(&mut pencil, count, TOLERANCE, max_vectors);
        let zero = pencil.rounding();
        let lowest = found.values.iter().copied().find(|value| *value > zero);
        let is_rigid = found.values.iter().any(|value| value.abs() <= zero);
        residual = found.largest_residual(count);
        let is_found = found.is_complete && residual <= MAX_RESIDUAL;
        let before = shift;
        match lowest {
            Some(lowest) if !is_found => shift = lowest,
            Some(lowest) if is_rigid && pencil.shift() < LEAST_SHIFT * lowest => shift = 0.1 * lowest,
            None if !is_found => shift = 0.01 * pencil.shift(),
            _ => {
                body.space.follow(&mut found.vectors);
                return Ok(described(body, found, zero));
            }
        }
        if (shift / before - 1.0).abs() < SAME_SHIFT {
            break;
        }
    }
    Err(Error::Modes { count, residual, limit: MAX_RESIDUAL })
}

/// Checks that there is memory for the basis and its products with the mass.
fn check_memory(n: usize, n_vectors: usize) -> Result<()> {
    let numbers = 2 * n * n_vectors;
    let gigabytes = 8e-9 * numbers as f64;
    let reserved = Vec::<f64>::new().try_reserve_exact(numbers);
    reserved.map_err(|_| Error::OutOfMemory { what: "the basis of the modes", gigabytes })
}

/// Products of the mass with the rigid translation along each axis.
fn translations(body: &Body) -> [Vec<f64>; 3] {
    let n = body.n_dofs();
    [0, 1, 2].map(|axis| {
        let e: Vec<f64> = (0..n).map(|dof| if dof % 3 == axis { 1.0 } else { 0.0 }).collect();
        let mut product = vec![0.0; n];
        body.mass_product(&e, &mut product);
        product
    })
}

/// The modes of eigenpairs; values up to `zero` are rounding.
fn described(body: &Body, mut found: Eigenmodes, zero: f64) -> Vec<Mode> {
    let n = body.n_dofs();
    let translations = translations(body);
    let first = found.values.iter().filter(|value| **value < -zero).count();
    let n_rigid = found.values[first..].iter().filter(|value| **value <= zero).count();
    rigid::separate(&mut found.vectors[first * n..(first + n_rigid) * n], &translations);
    let eigenpairs = found.values.iter().zip(found.vectors.chunks_exact(n)).zip(&found.residuals);
    let mode = |((&value, vector), &residual): ((&f64, &[f64]), &f64)| {
        let largest = |largest: f64, &x: &f64| if x.abs() > largest.abs() { x } else { largest };
        let sign = vector.iter().fold(0.0, largest).signum();
        Mode {
            angular_frequency: if value.abs() <= zero { 0.0 } else { value.abs().sqrt().copysign(value) },
            shape: vector.iter().map(|x| x * sign).collect(),
            effective_mass: translations.each_ref().map(|product| dot(vector, product).powi(2)),
            residual,
        }
    };
    eigenpairs.map(mode).collect()
}
