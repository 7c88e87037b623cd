//! Harmonic response by superposition of modes.

use super::pencil::{BodyPencil, Linearised};
use super::{Mode, solved, translations};
use crate::body::{Body, FieldName, Fields, Selection};
use crate::error::{Error, Result};
use crate::sparse::Pencil;
use crate::sparse::reduce::dot;
use crate::time::State;
use crate::time::classic::Forces;

/// Harmonic excitation, `exp(i omega t)`.
#[derive(Debug, Clone, PartialEq)]
pub enum Excitation {
    /// The sum of the loads with these numbers, at factor 1 in the reference configuration; of a field, with its time
    /// function, at t = 0.
    Loads(Vec<usize>),
    /// The supports, with the ground of their springs, have this acceleration \[length/time²\].
    Base([f64; 3]),
}

/// Damping of modes, which it does not couple.
#[derive(Debug, Clone, PartialEq)]
pub enum ModalDamping {
    /// Damping ratio zeta of each mode; the last one holds for all later modes.
    Ratios(Vec<f64>),
    /// Viscosity, drag and dampers of the body, `v^T C v` with the matrix C of their forces.
    OfBody,
}

/// A quantity of a vibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quantity {
    /// Displacement u \[length\].
    #[default]
    Displacement,
    /// Velocity, `i omega u` \[length/time\].
    Velocity,
    /// Acceleration, `-omega^2 u` \[length/time²\].
    Acceleration,
}

impl Quantity {
    /// All quantities with their names.
    pub const ALL: [(&'static str, Quantity); 3] = [
        ("displacement", Quantity::Displacement),
        ("velocity", Quantity::Velocity),
        ("acceleration", Quantity::Acceleration),
    ];
}

/// A complex number, `[real, imaginary]`.
type Complex = [f64; 2];

/// Steady vibration of a body about a state at rest under harmonic excitation, from its modes.
///
/// With shapes v_r, `v_r^T M v_r = 1`, and an excitation `f exp(i omega t)` the displacement relative to the supports
/// is the real part of `u exp(i omega t)`,
///
/// ```math
/// u = sum_r v_r v_r^T f / (omega_r^2 - omega^2 + i omega c_r) + u_c,    c_r = 2 zeta_r omega_r
/// ```
///
/// where the static correction u_c stands for the modes that are left out (Craig and Kurdila, *Fundamentals of
/// Structural Dynamics*, 2006, section 11.4), with a shift s that is small against the elastic `omega_r^2`:
///
/// ```math
/// u_c = (K + s M)^-1 f - sum_r v_r v_r^T f / (omega_r^2 + s)
/// ```
///
/// Base acceleration a has the force `f = -M a`.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicResponse {
    modes: Vec<Mode>,
    damping_rates: Vec<f64>,
    modal_forces: Vec<f64>,
    correction: Vec<f64>,
    base: [f64; 3],
    /// Displacement of the state.
    rest: Vec<f64>,
    /// Largest displacement for derivatives of fields \[length\].
    small: f64,
}

/// First-order changes of a stress at some nodes, with each mode and with the static correction:
/// [`HarmonicResponse::stress`].
#[derive(Debug, Clone, PartialEq)]
pub struct StressChange {
    of_modes: Vec<Vec<f64>>,
    of_correction: Vec<f64>,
}

/// Shift of the static correction over the lowest elastic omega^2.
const SHIFT: f64 = 1e-3;

/// Largest displacement by which a stress is differentiated, over the diagonal of the body: errors are its square.
const SMALL: f64 = 1e-6;

/// Largest displacement of the mode whose damping is evaluated, over the diagonal of the body: its forces are linear in
/// it, and no cell is inverted.
const AMPLITUDE: f64 = 1e-3;

impl HarmonicResponse {
    /// The response with the `count` lowest modes, about a state such as an equilibrium, or about the reference
    /// configuration without loads.
    ///
    /// # Errors
    /// As [`super::modes_about`]; [`Error::Response`] for unstable modes, an observer that turns, negative damping
    /// ratios, and loads that do not exist.
    ///
    /// ```
    /// use emmy::modes::{Excitation, HarmonicResponse, ModalDamping, Quantity};
    /// use emmy::prelude::*;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?)
    ///     .region(rubber)
    ///     .support(Support::fixed("z-min"))
    ///     .build()?;
    /// let excitation = Excitation::Base([1.0, 0.0, 0.0]);
    /// let damping = ModalDamping::Ratios(vec![0.02]);
    /// let response = HarmonicResponse::new(&body, None, 12, &damping, &excitation)?;
    /// // The corner 7 follows a slow base.
    /// let slow = 1e-3 * response.modes()[0].angular_frequency;
    /// let [re, im] = response.absolute(slow, 7, Quantity::Acceleration)[0];
    /// assert!((re - 1.0).abs() < 1e-5 && im.abs() < 1e-5);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn new(
        body: &Body,
        state: Option<&State>,
        count: usize,
        damping: &ModalDamping,
        excitation: &Excitation,
    ) -> Result<Self> {
        body.space.check_whole("a harmonic response")?;
        if body.observer_spin().is_some() {
            return Err(rejected(
                "a body with a load `rotation` has complex modes, which are not superposed",
            ));
        }
        let mut linearised = match state {
            Some(state) => Linearised::about(body, state)?,
            None => Linearised::at_reference(body)?,
        };
        let modes = solved(body, &mut linearised, count)?;
        if modes.iter().any(|mode| mode.angular_frequency < 0.0) {
            return Err(rejected("the state has unstable modes, so it does not vibrate steadily"));
        }
        let (force, base) = force(body, excitation)?;
        let modal_forces: Vec<f64> = modes.iter().map(|mode| dot(&mode.shape, &force)).collect();
        let damping_rates = match damping {
            ModalDamping::Ratios(ratios) => rates(&modes, ratios)?,
            ModalDamping::OfBody => rates_of_body(body, state, &modes)?,
        };
        let correction = correction(body, &mut linearised, force, (&modes, &modal_forces))?;
        let rest = state.map_or_else(|| vec![0.0; body.n_dofs()], |state| state.displacement.clone());
        let small = SMALL * body.mesh().diagonal();
        Ok(HarmonicResponse { modes, damping_rates, modal_forces, correction, base, rest, small })
    }

    /// The modes, the lowest first.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// Damping rate `c_r = 2 zeta_r omega_r` of each mode \[1/time\].
    pub fn damping_rates(&self) -> &[f64] {
        &self.damping_rates
    }

    /// Damping ratio zeta of each mode; NaN for a rigid one.
    pub fn damping_ratios(&self) -> Vec<f64> {
        let ratio = |(mode, rate): (&Mode, &f64)| match mode.is_elastic() {
            true => 0.5 * rate / mode.angular_frequency,
            false => f64::NAN,
        };
        self.modes.iter().zip(&self.damping_rates).map(ratio).collect()
    }

    /// Modal force `v_r^T f` of each mode \[force/sqrt(mass)\].
    pub fn modal_forces(&self) -> &[f64] {
        &self.modal_forces
    }

    /// Complex amplitudes of a node relative to the supports, at an angular frequency \[1/time\]; infinite in an
    /// undamped mode at its own frequency.
    pub fn relative(&self, angular_frequency: f64, node: usize, quantity: Quantity) -> [Complex; 3] {
        let omega = angular_frequency;
        let own = 3 * node..3 * node + 3;
        let mut u: [Complex; 3] = std::array::from_fn(|axis| [self.correction[own.start + axis], 0.0]);
        let shapes = self.modes.iter().map(|mode| &mode.shape[own.clone()]);
        self.superpose(omega, shapes, &mut u);
        u.map(|u| differentiated(u, omega, quantity))
    }

    /// Adds the parts of all modes. `values`: of each mode, with the amplitude 1.
    fn superpose<'a>(&self, omega: f64, values: impl Iterator<Item = &'a [f64]>, sums: &mut [Complex]) {
        let rates = self.modes.iter().zip(&self.damping_rates).zip(&self.modal_forces);
        for (((mode, rate), force), values) in rates.zip(values) {
            let difference = mode.angular_frequency.powi(2) - omega * omega;
            let [re, im] = quotient(*force, [difference, omega * rate]);
            for (sum, value) in sums.iter_mut().zip(values) {
                // No mode moves a node in which it has no part, not even without limit.
                if *value != 0.0 {
                    *sum = [sum[0] + value * re, sum[1] + value * im];
                }
            }
        }
    }

    /// Complex amplitudes of a node with the motion of the supports, as [`HarmonicResponse::relative`].
    pub fn absolute(&self, angular_frequency: f64, node: usize, quantity: Quantity) -> [Complex; 3] {
        let mut amplitudes = self.relative(angular_frequency, node, quantity);
        let omega = angular_frequency;
        for (amplitude, &acceleration) in amplitudes.iter_mut().zip(&self.base) {
            let base = differentiated([-acceleration / (omega * omega), 0.0], omega, quantity);
            if acceleration != 0.0 {
                *amplitude = [amplitude[0] + base[0], amplitude[1] + base[1]];
            }
        }
        amplitudes
    }

    /// First-order changes of a stress about the state, of its elastic part alone: the Cauchy stress or the second
    /// Piola-Kirchhoff stress at some nodes. Equivalent and principal values are not linear and do not vibrate
    /// harmonically.
    ///
    /// # Errors
    /// [`Error::Response`] for other fields, for a body without stresses, and where the state has none.
    ///
    /// ```
    /// use emmy::body::{FieldName, Fields};
    /// use emmy::modes::{Excitation, HarmonicResponse, ModalDamping};
    /// use emmy::prelude::*;
    /// let slab = mesh::block([1.0, 1.0, 0.1], [1, 1, 2])?;
    /// let body = Body::builder(slab)
    ///     .region(Region::new(NeoHooke::new(0.0, 500.0)?, 2.0))
    ///     .support(Support::fixed("z-min"))
    ///     .load(Load::nodal_force("z-max", [0.0, 0.0, 0.25]))
    ///     .build()?;
    /// let damping = ModalDamping::Ratios(vec![0.02]);
    /// let response = HarmonicResponse::new(&body, None, 6, &damping, &Excitation::Loads(vec![0]))?;
    /// let fields = Fields::new(&body);
    /// let middle = body.mesh().nearest_node([0.0, 0.0, 0.05]) as u32;
    /// let change = response.stress(&fields, &fields.select_nodes(&[middle]), FieldName::CauchyStress)?;
    /// // Slowly, the four forces of 0.25 on an area of 1 make a stress of 1 along z.
    /// let slow = 1e-3 * response.modes()[0].angular_frequency;
    /// let [re, _] = response.stress_amplitudes(slow, &change)[2];
    /// assert!((re - 1.0).abs() < 1e-3);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn stress(&self, fields: &Fields, nodes: &Selection, field: FieldName) -> Result<StressChange> {
        if ![FieldName::CauchyStress, FieldName::SecondPiolaKirchhoffStress].contains(&field) {
            return Err(rejected(format!("{field} does not vibrate harmonically: it is not linear")));
        }
        if !fields.has(field) {
            return Err(rejected(format!("the body has no {field}")));
        }
        let change = |shape: &[f64]| -> Result<Vec<f64>> {
            let largest = shape.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
            let factor = if largest > 0.0 { self.small / largest } else { 0.0 };
            let [plus, minus] = [factor, -factor].map(|factor| {
                let moved: Vec<f64> = self.rest.iter().zip(shape).map(|(u, v)| u + factor * v).collect();
                fields.on(nodes, [&moved, &self.rest], field)
            });
            let quotient = |(plus, minus): (&f64, &f64)| match factor {
                0.0 => 0.0,
                factor => 0.5 * (plus - minus) / factor,
            };
            let change: Vec<f64> = plus.iter().zip(&minus).map(quotient).collect();
            match change.iter().all(|x| x.is_finite()) {
                true => Ok(change),
                false => Err(rejected(format!("{field} is not a number at one of the nodes"))),
            }
        };
        let of_modes = self.modes.iter().map(|mode| change(&mode.shape)).collect::<Result<_>>()?;
        Ok(StressChange { of_modes, of_correction: change(&self.correction)? })
    }

    /// Complex amplitudes of a stress at an angular frequency \[1/time\]: xx, yy, zz, xy, yz, xz at each node
    /// \[force/length²\].
    pub fn stress_amplitudes(&self, angular_frequency: f64, change: &StressChange) -> Vec<[f64; 2]> {
        let mut sums: Vec<Complex> = change.of_correction.iter().map(|part| [*part, 0.0]).collect();
        self.superpose(angular_frequency, change.of_modes.iter().map(Vec::as_slice), &mut sums);
        sums
    }
}

fn rejected(reason: impl Into<String>) -> Error {
    Error::Response { reason: reason.into() }
}

/// A real number over a complex one.
fn quotient(number: f64, [re, im]: Complex) -> Complex {
    let square = re * re + im * im;
    match (number == 0.0, square == 0.0) {
        (true, _) => [0.0; 2],
        (_, true) => [f64::INFINITY.copysign(number), 0.0],
        _ => [number * re / square, -number * im / square],
    }
}

/// Amplitude of a quantity with a displacement.
fn differentiated([re, im]: Complex, omega: f64, quantity: Quantity) -> Complex {
    match quantity {
        Quantity::Displacement => [re, im],
        Quantity::Velocity => [-omega * im, omega * re],
        Quantity::Acceleration => [-omega * omega * re, -omega * omega * im],
    }
}

/// The force of an excitation, and the acceleration of the base.
fn force(body: &Body, excitation: &Excitation) -> Result<(Vec<f64>, [f64; 3])> {
    let mut force = vec![0.0; body.n_dofs()];
    match excitation {
        Excitation::Loads(numbers) if numbers.is_empty() => {
            Err(rejected("there is no load to excite the body"))
        }
        Excitation::Loads(numbers) => {
            for number in numbers {
                let load = body.unit_load(*number);
                let load =
                    load.ok_or_else(|| rejected(format!("there is no load with the number {number}")))?;
                force.iter_mut().zip(load).for_each(|(sum, x)| *sum += x);
            }
            match force.iter().all(|x| x.is_finite()) {
                true => Ok((force, [0.0; 3])),
                false => Err(rejected("a load is not finite at t = 0")),
            }
        }
        Excitation::Base(acceleration) => {
            for (product, a) in translations(body).iter().zip(acceleration) {
                force.iter_mut().zip(product).for_each(|(sum, x)| *sum -= a * x);
            }
            Ok((force, *acceleration))
        }
    }
}

/// `2 zeta omega` of each mode.
fn rates(modes: &[Mode], ratios: &[f64]) -> Result<Vec<f64>> {
    if let Some(ratio) = ratios.iter().find(|ratio| !(ratio.is_finite() && **ratio >= 0.0)) {
        return Err(rejected(format!("a damping ratio is {ratio}, but must not be negative")));
    }
    let Some(last) = ratios.last() else { return Err(rejected("there is no damping ratio")) };
    let ratios = ratios.iter().chain(std::iter::repeat(last));
    Ok(modes.iter().zip(ratios).map(|(mode, ratio)| 2.0 * ratio * mode.angular_frequency).collect())
}

/// `v^T C v` of each mode.
fn rates_of_body(body: &Body, state: Option<&State>, modes: &[Mode]) -> Result<Vec<f64>> {
    let rest = State { displacement: vec![0.0; body.n_dofs()], ..State::default() };
    let state = state.unwrap_or(&rest);
    let mut forces = Forces::new(body);
    forces.take_history(state);
    let diagonal = body.mesh().diagonal();
    let rate = |mode: &Mode| {
        let largest = mode.shape.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let factor = if diagonal > 0.0 { AMPLITUDE * diagonal / largest } else { 1.0 };
        let velocity: Vec<f64> = mode.shape.iter().map(|v| factor * v).collect();
        let mut momentum = vec![0.0; velocity.len()];
        body.mass_product(&velocity, &mut momentum);
        let moving = State {
            displacement: state.displacement.clone(),
            coordinates: state.coordinates.clone(),
            history: state.history.clone(),
            velocity,
            momentum,
            ..State::default()
        };
        let force = forces.damping(&moving)?;
        Ok((-dot(&mode.shape, &force) / factor).max(0.0))
    };
    modes.iter().map(rate).collect()
}

/// Static displacement by the modes that are left out.
fn correction(
    body: &Body,
    linearised: &mut Linearised,
    force: Vec<f64>,
    (modes, modal_forces): (&[Mode], &[f64]),
) -> Result<Vec<f64>> {
    let Some(lowest) = modes.iter().find(|mode| mode.is_elastic()) else {
        return Ok(vec![0.0; body.n_dofs()]);
    };
    let mut pencil = BodyPencil::new(body, linearised)?;
    pencil.factorize(SHIFT * lowest.angular_frequency.powi(2))?;
    let mut u = pencil.displacement(force);
    for (mode, force) in modes.iter().zip(modal_forces) {
        let factor = force / (mode.angular_frequency.powi(2) + pencil.shift());
        u.iter_mut().zip(&mode.shape).for_each(|(u, v)| *u -= factor * v);
    }
    Ok(u)
}
