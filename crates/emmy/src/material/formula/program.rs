//! The derivatives of an energy at rest, and its tapes.

use super::expression::{Expression, Invariant};
use super::graph::{F, Graph, Id, Node, U, VARIABLES, W, Z};
use super::lowering::Lowering;
use super::tape::Tape;
use crate::error::{Error, Result};
use crate::number::short;

/// Largest number of operations in a formula.
const LONGEST: usize = 500;

/// Stress at rest by the moduli below which it is the rounding of the parameters.
const RESIDUAL_STRESS: f64 = 1e-10;

/// Pairs of variables, in the order of the second derivatives.
pub(super) const PAIRS: [[usize; 2]; 10] =
    [[Z, Z], [Z, W], [Z, U], [Z, F], [W, W], [W, U], [W, F], [U, U], [U, F], [F, F]];

/// Factors of the stress and second derivatives: [`Program::gradient`] and one number for each of [`PAIRS`].
pub(super) const TANGENT: usize = 4 + PAIRS.len();

/// An energy as tapes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Program {
    /// W.
    pub(super) energy: Tape<1>,
    /// The change of W, for the inputs at the start and the differences of the variables.
    pub(super) energy_change: Tape<1>,
    /// `W_z`, `W_z + W_w + W_u`, `W_z + W_w + 2 W_u` and `W_f`.
    pub(super) gradient: Tape<4>,
    /// The gradient and the second derivatives.
    pub(super) tangent: Tape<TANGENT>,
    /// Whether second derivatives by a variable occur.
    pub(super) is_curved: [bool; VARIABLES],
    /// Derivatives at rest.
    pub(super) rest: Rest,
}

/// First and second derivatives of an energy at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rest {
    first: [f64; VARIABLES],
    second: [f64; PAIRS.len()],
}

/// An error with its reason.
pub(super) fn invalid<T>(reason: impl Into<String>) -> Result<T> {
    Err(Error::EnergyFormula { reason: reason.into() })
}

/// An energy and its derivatives in a graph.
struct Derivatives {
    graph: Graph,
    energy: Id,
    first: [Id; VARIABLES],
    second: [Id; PAIRS.len()],
}

impl Derivatives {
    fn new(energy: &Expression) -> Self {
        let mut graph = Graph::default();
        let energy = graph.read(&energy.0);
        let first = [Z, W, U, F].map(|variable| graph.derivative(energy, variable));
        let second = PAIRS.map(|[i, j]| graph.derivative(first[i], j));
        Derivatives { graph, energy, first, second }
    }

    fn rest(&self) -> Rest {
        Rest {
            first: self.first.map(|id| self.graph.rest(id)),
            second: self.second.map(|id| self.graph.rest(id)),
        }
    }

    /// Whether the energy and its derivatives are smooth at rest.
    fn check_smooth(&self) -> Result<()> {
        let at_rest = |id: &Id| self.graph.rest(*id);
        for node in self.graph.nodes() {
            match node {
                Node::Ln(argument) if at_rest(argument) <= 0.0 => {
                    let value = short(at_rest(argument));
                    return invalid(format!(
                        "it takes a logarithm of an expression that is {value} at rest, where it must be positive"
                    ));
                }
                Node::Power(base, exponent) if exponent.value().fract() != 0.0 && at_rest(base) <= 0.0 => {
                    let [base, exponent] = [at_rest(base), exponent.value()].map(short);
                    return invalid(format!(
                        "it takes the power {exponent} of an expression that is {base} at rest, where it must be \
                         positive unless the exponent is a whole number"
                    ));
                }
                _ => {}
            }
        }
        let mut derivatives = self.first.iter().chain(&self.second);
        if !at_rest(&self.energy).is_finite() || !derivatives.all(|id| at_rest(id).is_finite()) {
            return invalid("it or its derivatives are not finite at rest (C = I)");
        }
        Ok(())
    }
}

impl Rest {
    fn second(&self, i: usize, j: usize) -> f64 {
        let pair = PAIRS.iter().position(|pair| *pair == [i.min(j), i.max(j)]);
        pair.map_or(0.0, |pair| self.second[pair])
    }

    /// Shear modulus without a fibre.
    pub(super) fn shear_modulus(&self) -> f64 {
        -2.0 * (self.first[W] + self.first[U])
    }

    /// Bulk modulus without a fibre.
    pub(super) fn bulk_modulus(&self) -> f64 {
        4.0 * self.second(Z, Z) - 4.0 / 3.0 * self.shear_modulus()
    }

    fn check_stress(&self) -> Result<()> {
        let stiff = [self.shear_modulus(), 4.0 * self.second(Z, Z), 4.0 * self.second(F, F)];
        let stiff = stiff.into_iter().fold(0.0, |stiff: f64, modulus| stiff.max(modulus.abs()));
        let [pressure, tension] = [2.0 * self.first[Z], 2.0 * self.first[F]];
        let is_left = |stress: f64| stress.abs() > RESIDUAL_STRESS * stiff;
        let mut left = Vec::new();
        let remedy = |stress: f64, term: &str| {
            let verb = if stress > 0.0 { "subtract" } else { "add" };
            format!("({verb} {}*{term})", short(stress.abs()))
        };
        if is_left(pressure) {
            left.push(format!("{} in every direction {}", short(pressure), remedy(pressure, "ln(J)")));
        }
        if is_left(tension) {
            left.push(format!("{} along the fibre {}", short(tension), remedy(tension, "(I4 - 1)/2")));
        }
        match left.is_empty() {
            true => Ok(()),
            false => invalid(format!("the stress at rest must be 0, and is {}", left.join(" and "))),
        }
    }

    /// Whether every strain at rest has a positive energy.
    fn check_stable(&self) -> Result<()> {
        let [bulk, shear] = [self.bulk_modulus(), self.shear_modulus()];
        let is_stiff = shear > 0.0;
        if !is_stiff {
            let shear = short(shear);
            return invalid(format!("the shear modulus at rest must be positive, and is {shear}"));
        }
        let [across, along] = [self.second(Z, F), self.second(F, F)].map(|second| 4.0 * second);
        if across == 0.0 && along == 0.0 {
            let is_stable = bulk > 0.0;
            return match is_stable {
                true => Ok(()),
                false => {
                    invalid(format!("the bulk modulus at rest must be positive, and is {}", short(bulk)))
                }
            };
        }
        // Fibre along 1. Energy of the strains e along it and t in both directions across it:
        // D_1111 e^2 / 2 + 2 D_1122 e t + (D_2222 + D_2233) t^2.
        let lambda = bulk - 2.0 / 3.0 * shear;
        let along_along = lambda + 2.0 * shear + 2.0 * across + along;
        let mixed = lambda + across;
        let across_across = 2.0 * (lambda + shear);
        if along_along > 0.0 && across_across > 0.0 && along_along * across_across > 2.0 * mixed * mixed {
            return Ok(());
        }
        let [along_along, mixed, across_across] = [along_along, mixed, across_across].map(short);
        invalid(format!(
            "the elasticity at rest must be positive definite; with the fibre along 1 it has D_1111 = {along_along}, \
             D_1122 = {mixed}, D_2222 + D_2233 = {across_across}"
        ))
    }
}

impl Program {
    /// The program of an energy.
    ///
    /// # Errors
    /// [`Error::EnergyFormula`] if the energy is not smooth or too long, or the reference configuration is not free of
    /// stress and stable.
    pub(super) fn new(energy: &Expression) -> Result<Self> {
        let program = Program::unchecked(energy)?;
        program.rest.check_stress()?;
        program.rest.check_stable()?;
        Ok(program)
    }

    /// The program without the checks of stress and stability: of a part of an energy.
    pub(super) fn unchecked(energy: &Expression) -> Result<Self> {
        let size = energy.0.size();
        if size > LONGEST {
            return invalid(format!("it has {size} operations, more than {LONGEST}"));
        }
        let mut derivatives = Derivatives::new(energy);
        derivatives.check_smooth()?;
        let rest = derivatives.rest();
        let Derivatives { graph, energy, first, second } = &mut derivatives;
        let is_curved = [Z, W, U, F].map(|variable| {
            PAIRS.iter().zip(&*second).any(|(pair, id)| pair.contains(&variable) && !graph.is_zero(*id))
        });
        let [dz, dw, du, df] = *first;
        let strain = graph.sum(0.0, &[(dz, 1.0), (dw, 1.0), (du, 1.0)]);
        let cofactor = graph.sum(0.0, &[(dz, 1.0), (dw, 1.0), (du, 2.0)]);
        let mut lowering = Lowering::new(graph);
        let energy_change = lowering.bend_difference(*energy);
        let energy = lowering.bend(*energy);
        let gradient =
            [lowering.change(dz), lowering.value(strain), lowering.value(cofactor), lowering.change(df)];
        let second = second.map(|id| lowering.value(id));
        let mut tangent = [energy; TANGENT];
        tangent[..4].copy_from_slice(&gradient);
        tangent[4..].copy_from_slice(&second);
        let instructions = &lowering.instructions;
        let tapes = || {
            let [energy, energy_change] = [instructions.tape([energy])?, instructions.tape([energy_change])?];
            let (gradient, tangent) = (instructions.tape(gradient)?, instructions.tape(tangent)?);
            Some(Program { energy, energy_change, gradient, tangent, is_curved, rest })
        };
        tapes().map_or_else(|| invalid("it and its derivatives have too many terms"), Ok)
    }
}

/// A function of the volume, `T(J)`, by its derivatives at rest and its values.
pub(super) struct VolumeFunction {
    graph: Graph,
    energy: Id,
    /// dT/dJ and d^2T/dJ^2 at J = 1.
    pub(super) derivatives: [f64; 2],
}

impl VolumeFunction {
    pub(super) fn new(energy: &Expression) -> Self {
        let Derivatives { mut graph, energy, first, .. } = Derivatives::new(energy);
        let second = graph.derivative(first[Z], Z);
        let [first, second] = [first[Z], second].map(|id| graph.rest(id));
        // J = sqrt(1 + z)
        VolumeFunction { graph, energy, derivatives: [2.0 * first, 4.0 * second + 2.0 * first] }
    }

    /// T(J) - T(1).
    pub(super) fn change(&self, ratio: f64) -> f64 {
        let z = (ratio - 1.0) * (ratio + 1.0);
        self.graph.value_at(self.energy, &[z, 0.0, 0.0, 0.0]) - self.graph.rest(self.energy)
    }
}

/// Checks that an energy has a fibre exactly if it uses one.
pub(super) fn check_fibre(energy: &Expression, has_fibre: bool) -> Result<()> {
    let used = Invariant::ALL.into_iter().find(|own| own.needs_fibre() && energy.has(*own));
    match (used, has_fibre) {
        (Some(used), false) => {
            invalid(format!("{} needs the direction of a fibre, such as fibre = [1, 0, 0]", used.name()))
        }
        (None, true) => invalid("neither I4 nor I4_bar occurs in it, so that `fibre` has no effect"),
        _ => Ok(()),
    }
}
