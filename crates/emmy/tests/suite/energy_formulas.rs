//! Bodies whose material is a formula: the motions, the losses and the gradients of the built-in material of the same
//! energy, and the conservation of every material.

use emmy::adjoint::{Goal, Parameter, Trajectory};
use emmy::body::{Body, Formulation, InitialVelocity, Region, Viscosity};
use emmy::material::{EnergyFormula, Expression, Invariant, NeoHooke};
use emmy::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
use emmy::time::Scheme;

use crate::shared::schemes::{DGM, assumed_strain, at, fe};

const LAME: [f64; 2] = [1000.0, 500.0];

/// `mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2`
pub(crate) fn formula([lambda, mu]: [f64; 2]) -> Result<EnergyFormula, emmy::Error> {
    let [i1, j] = [Invariant::I1, Invariant::J].map(Expression::from);
    let ln = j.ln();
    EnergyFormula::new(&(0.5 * mu * (i1 - 3.0) - mu * ln.clone() + 0.5 * lambda * ln.power(2.0)), None)
}

/// The same block of the formula and of the built-in material.
fn blocks(change: impl Fn(Region) -> Region) -> [Body; 2] {
    let [lambda, mu] = LAME;
    let regions =
        [Region::new(formula(LAME).unwrap(), 0.7), Region::new(NeoHooke::new(lambda, mu).unwrap(), 0.7)];
    regions.map(|region| {
        let mesh = emmy::mesh::block([1.0, 1.5, 1.0], [2; 3]).unwrap();
        Body::builder(mesh).region(change(region)).build().unwrap()
    })
}

fn start(body: &Body) -> State {
    let field = InitialVelocity {
        angular_velocity: [3.0, 5.0, -4.0],
        about: [0.5, 0.75, 0.5],
        gradient: [[4.0, 1.5, 0.0], [0.0, -3.0, 1.0], [2.0, 0.0, 1.0]],
        velocity: [1.0, -2.0, 0.5],
        ..Default::default()
    };
    State::initial(body, 0.0, &[field]).unwrap()
}

/// Records and last state of 40 steps.
fn flight(body: &Body, scheme: Scheme) -> (Vec<Record>, State) {
    let settings = NewtonSettings { tolerance: 1e-12, ..Default::default() };
    let mut motion = Motion::starting(body, scheme, settings, start(body)).unwrap();
    let records = (0..40).map(|_| motion.step(0.01).unwrap().clone()).collect();
    (records, motion.state().clone())
}

fn distance(a: &State, b: &State) -> f64 {
    let differences = a.displacement.iter().zip(&b.displacement).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

#[test]
fn a_spinning_block_keeps_its_balances_and_moves_as_the_built_in_material() {
    let [own, builtin] = blocks(|region| region);
    // AS(2) has quadrature points enough for the momenta only; energy needs DGM, or many points.
    for (scheme, conserves_energy) in
        [(DGM, true), (assumed_strain(10), true), (assumed_strain(2), false), (fe(2), false)]
    {
        for degree in 1..=2 {
            let scheme = at(scheme, degree);
            let ((records, state), (_, other)) = (flight(&own, scheme), flight(&builtin, scheme));
            for record in &records {
                let total = record.total_energy;
                let momentum = record.angular_momentum.iter().map(|l| l * l).sum::<f64>().sqrt();
                assert!(!conserves_energy || record.energy_residual.abs() < 1e-12 * total, "{record:?}");
                assert!(record.linear_momentum_residual < 1e-12 * momentum, "{scheme}: {record:?}");
                if scheme != at(fe(2), degree) {
                    assert!(record.angular_momentum_residual < 1e-12 * momentum, "{scheme}: {record:?}");
                }
            }
            // The block moves by some units; both motions iterate to 1e-12 in 40 steps.
            let distance = distance(&state, &other);
            assert!(distance < 1e-9, "{scheme}: {distance:e}");
        }
    }
}

#[test]
fn viscosity_and_projected_volumes_match_the_built_in_material() {
    let viscous =
        |region: Region| region.with_viscosity(Viscosity { time: 1e-3, shear: 0.2, ..Viscosity::default() });
    let projected = |region: Region| region.with_formulation(Formulation::ProjectedVolume(None));
    let changes: [&dyn Fn(Region) -> Region; 2] = [&viscous, &projected];
    for change in changes {
        let [own, builtin] = blocks(change).map(|body| flight(&body, DGM));
        assert!(distance(&own.1, &builtin.1) < 1e-9, "{:e}", distance(&own.1, &builtin.1));
        let losses = [&own, &builtin]
            .map(|(records, _)| records.iter().map(|record| record.dissipated_energy).fold(0.0, f64::max));
        assert!((losses[0] - losses[1]).abs() <= 1e-9 * losses[1], "{losses:?}");
    }
}

#[test]
fn gradients_match_the_built_in_material() {
    let plan = StepPlan::new(0.0, vec![Phase { until: 0.2, size: 0.02 }]).unwrap();
    let block = |region: Region| {
        let mesh = emmy::mesh::block([1.0, 1.5, 1.0], [1, 2, 1]).unwrap();
        Body::builder(mesh).region(region).build()
    };
    let own = |[lambda, mu]: [f64; 2]| block(Region::new(formula([lambda, mu])?, 0.7));
    let builtin = |[lambda, mu]: [f64; 2]| block(Region::new(NeoHooke::new(lambda, mu)?, 0.7));
    let gradient = |body: &dyn Fn([f64; 2]) -> Result<Body, emmy::Error>| {
        let [lambda, mu] = LAME;
        let at_values = body(LAME).unwrap();
        let mut motion =
            Motion::starting(&at_values, at(DGM, 2), NewtonSettings::default(), start(&at_values)).unwrap();
        let mut trajectory = Trajectory::new(&motion).unwrap();
        motion.march(&plan, &mut [&mut trajectory]).unwrap();
        let n = at_values.n_dofs();
        let goal = Goal { displacement: (0..n).map(|i| (i as f64).sin()).collect(), velocity: vec![0.0; n] };
        let parameters = [
            Parameter::linear(lambda, lambda, |lambda| body([lambda, mu])).unwrap(),
            Parameter::linear(mu, mu, |mu| body([lambda, mu])).unwrap(),
        ];
        trajectory.gradient(&goal, &parameters).unwrap().parameters
    };
    let (own, builtin) = (gradient(&own), gradient(&builtin));
    for (own, builtin) in own.iter().zip(&builtin) {
        assert!((own - builtin).abs() < 1e-8 * builtin.abs(), "{own} {builtin}");
    }
}
