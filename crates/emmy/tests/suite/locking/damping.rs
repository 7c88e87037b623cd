//! Viscosity and dissipative schemes damp projected volumes like all other motions.

use emmy::body::{Formulation, PressureSpace, TimeFunction};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::{gauss, lobatto};
use emmy::prelude::*;

use super::mapped;
use crate::shared::schemes::{DGM, assumed_strain, at, dgm, fe, lobatto as lobatto_scheme};

const PROJECTED: Formulation = Formulation::ProjectedVolume(None);

fn strict() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, max_iterations: 40, ..NewtonSettings::default() }
}

fn rubber(bulk_modulus: f64) -> Region {
    let rubber = NeoHookeIsochoric::new(1.0, bulk_modulus, Volumetric::SimoTaylor).unwrap();
    Region::new(rubber, 1.0).with_formulation(PROJECTED)
}

/// One cell in uniaxial strain along x, which swings with omega^2 = 3 (K + 4/3 mu) / density.
fn bar(region: Region) -> Body {
    let rollers = |group: &str, axis: usize| Support::of_components(group, [0, 1, 2].map(|d| d == axis));
    Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap())
        .region(region)
        .support(Support::fixed("x-min"))
        .supports(&[rollers("y-min", 1), rollers("y-max", 1), rollers("z-min", 2), rollers("z-max", 2)])
        .build()
        .unwrap()
}

/// The viscous modulus of uniaxial strain is t_v (K + 4/3 mu) + 4/3 eta + zeta; the oscillator has delta = 3/2 of it.
#[test]
fn the_motion_of_a_volume_decays_as_in_theory() {
    let (bulk, v, t) = (100.0, 1e-8, 1.0);
    // The first has the damping ratio 1/20.
    for (time, shear, bulk_viscosity) in [(0.005735393346764044, 0.0, 0.0), (0.002, 0.1, 0.2)] {
        let viscosity = Viscosity { time, shear, bulk: bulk_viscosity };
        let body = bar(rubber(bulk).with_viscosity(viscosity));
        let pushed =
            InitialVelocity { group: Some("x-max".into()), velocity: [v, 0.0, 0.0], ..Default::default() };
        let modulus = bulk + 4.0 / 3.0;
        let delta = 1.5 * (time * modulus + 4.0 / 3.0 * shear + bulk_viscosity);
        let w = (3.0 * modulus - delta * delta).sqrt();
        let exact = v / w * (-delta * t).exp() * (w * t).sin();
        for scheme in
            [at(DGM, 3), at(assumed_strain(4), 3), at(fe(3), 3), at(fe(5), 3), at(lobatto_scheme(4), 3)]
        {
            let state = State::initial(&body, 0.0, std::slice::from_ref(&pushed)).unwrap();
            let mut motion = Motion::starting(&body, scheme, strict(), state).unwrap();
            (0..100).for_each(|_| _ = motion.step(t / 100.0).unwrap());
            let found = motion.state().displacement[3 * body.mesh().nearest_node([1.0; 3])];
            // The phase error of the time element, (w h)^6 w t / 100800, is 5e-9; strains of 1e-9 add as much.
            assert!((found - exact).abs() * w / v < 3e-8, "{scheme}, {time}: {found} is not {exact}");
            // The energy that is missing: of both signs, the work of the viscosity.
            let record = motion.record();
            let start = v * v / 6.0;
            assert!(
                (record.total_energy + record.dissipated_energy - start).abs() < 1e-6 * start,
                "{scheme}"
            );
        }
    }
}

/// A stretch 1 + a t in uniaxial strain has E' = (1 + a t) a and theta' = a: by the elasticity at rest, 2 mu dev and K,
/// the loss is `t_v a^2 integral 4/3 mu (1 + a t)^2 + K dt`.
#[test]
fn the_loss_of_a_given_deformation_matches_its_formula() {
    let (bulk, time, a, t) = (50.0, 0.03, 0.6, 0.5);
    let exact = time * (4.0 / 9.0 * a * ((1.0f64 + a * t).powi(3) - 1.0) + bulk * a * a * t);
    let cells = [
        (CellKind::Hex8, None),
        (CellKind::Hex20, Some(PressureSpace::Linear)),
        (CellKind::Hex27, Some(PressureSpace::Linear)),
    ];
    for (kind, space) in cells {
        let mut mesh = mapped(kind, [1, 2, 1], |x| x).build().unwrap();
        let mut supports = Vec::new();
        for (number, height) in [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().enumerate() {
            let nodes = mesh.points().iter().enumerate().filter(|(_, x)| (x[1] - height).abs() < 1e-9);
            let nodes: Vec<u32> = nodes.map(|(node, _)| node as u32).collect();
            if nodes.is_empty() {
                continue;
            }
            mesh = mesh.with_node_group(&format!("level-{number}"), nodes).unwrap();
            let at_rest = || Some(TimeFunction::smooth("0", |_| [0.0; 3]));
            let moved = TimeFunction::smooth("a t", move |t| [height * a * t, height * a, 0.0]);
            supports.push(Support::driven(format!("level-{number}"), [at_rest(), Some(moved), at_rest()]));
        }
        let viscosity = Viscosity { time, ..Viscosity::default() };
        let region =
            rubber(bulk).with_formulation(Formulation::ProjectedVolume(space)).with_viscosity(viscosity);
        let body = Body::builder(mesh).region(region).supports(&supports).build().unwrap();
        for scheme in
            [at(DGM, 2), at(assumed_strain(6), 2), at(fe(2), 2), at(fe(4), 3), at(lobatto_scheme(4), 2)]
        {
            let mut motion = Motion::new(&body, scheme).unwrap();
            (0..5).for_each(|_| _ = motion.step(t / 5.0).unwrap());
            let record = motion.record();
            let error = record.dissipated_energy / exact - 1.0;
            assert!(error.abs() < 1e-12, "{kind}, {scheme}: {error:e}");
        }
    }
}

/// With a spectral radius, the theta method with theta = (1 + chi)/2 = 1/(1 + rho), of which
/// `|R|^2 = (1 + (1 - theta)^2 z^2) / (1 + theta^2 z^2)`.
#[test]
fn fast_motions_of_a_volume_decay_by_the_spectral_radius() {
    let z: f64 = 1000.0;
    for ratio in [2.0, 100.0] {
        let body = bar(rubber(ratio));
        let size = z / (3.0 * (ratio + 4.0 / 3.0)).sqrt();
        let pushed =
            InitialVelocity { group: Some("x-max".into()), velocity: [1e-9, 0.0, 0.0], ..Default::default() };
        let factors = |scheme: Scheme| {
            let state = State::initial(&body, 0.0, std::slice::from_ref(&pushed)).unwrap();
            let mut motion = Motion::starting(&body, scheme, strict(), state).unwrap();
            let energies: Vec<f64> = (0..4).map(|_| motion.step(size).unwrap().total_energy).collect();
            [1, 2, 3].map(|n| (energies[n] / energies[n - 1]).sqrt())
        };
        for rho in [0.0, 0.5, 0.8] {
            let theta = 1.0 / (1.0 + rho);
            let exact = ((1.0 + ((1.0 - theta) * z).powi(2)) / (1.0 + (theta * z).powi(2))).sqrt();
            let assumed: Scheme = format!("AS(4, {rho})").parse().unwrap();
            for scheme in [dgm(rho), assumed] {
                for factor in factors(scheme) {
                    assert!(
                        (factor / exact - 1.0).abs() < 1e-5,
                        "{scheme}, K = {ratio} mu: {factor} {exact}"
                    );
                }
            }
            for degree in [2, 3].into_iter().filter(|_| rho > 0.0) {
                for factor in factors(at(dgm(rho), degree)) {
                    // |R| is rho to second order in 1/z.
                    assert!((factor - rho).abs() < 1e-3, "k = {degree}, K = {ratio} mu: {factor} {rho}");
                }
            }
        }
    }
}

/// Two distorted cells.
fn two_cells(kind: CellKind, space: Option<PressureSpace>, bulk: f64, viscosity: Viscosity) -> Body {
    let map = |[a, b, c]: [f64; 3]| [2.0 * a + 0.1 * (2.0 * b).sin(), b + 0.15 * a * c, c - 0.1 * a * b];
    let region = rubber(bulk).with_formulation(Formulation::ProjectedVolume(space)).with_viscosity(viscosity);
    Body::builder(mapped(kind, [2, 1, 1], map).build().unwrap()).region(region).build().unwrap()
}

fn step<'a>(rule: &'a Rule, displacement: &'a [f64], rates: &'a [f64], dissipation: f64) -> StepInput<'a> {
    StepInput {
        rule,
        tangent_factor: 1.0,
        displacement,
        rates,
        coordinates: &[],
        damping: StepDamping { inverse_step_size: 2.0, dissipation },
        local: None,
    }
}

#[test]
fn tangents_of_damped_volumes_are_derivatives() {
    let viscosity = Viscosity { time: 0.4, shear: 0.3, bulk: 0.1 };
    for (kind, space) in [(CellKind::Hex8, None), (CellKind::Hex20, Some(PressureSpace::Linear))] {
        let body = two_cells(kind, space, 20.0, viscosity);
        let n = body.n_dofs();
        for k in 1..=3 {
            let rules = [
                (Rule::standard(k, &gauss(k)), 0.0),
                (Rule::standard(k, &lobatto(k + 1)), 0.0),
                (Rule::assumed_strain(k, k + 1), 0.3),
                (Rule::discrete_gradient(k), 0.3),
            ];
            for (rule, dissipation) in rules {
                let wave = |s: f64| move |at: usize| 0.05 * ((at as f64 + 0.3) * s).sin();
                let displacement: Vec<f64> = (0..n).map(wave(0.7)).collect();
                let rates: Vec<f64> = (0..k * n).map(wave(1.1)).collect();
                let direction: Vec<f64> = (0..k * n).map(wave(0.37)).collect();
                let mut assembly = body.assembly(&rule);
                let mut force = |length: f64| {
                    let rates: Vec<f64> = rates.iter().zip(&direction).map(|(x, d)| x + length * d).collect();
                    body.assemble(
                        &step(&rule, &displacement, &rates, dissipation),
                        Request::Stress,
                        &[],
                        &mut assembly,
                    )
                    .unwrap();
                    let mut force = vec![0.0; k * n];
                    assembly.matrix.copy_force(&mut force);
                    force
                };
                let [plus, minus] = [1e-5, -1e-5].map(&mut force);
                let whole = step(&rule, &displacement, &rates, dissipation);
                body.assemble(&whole, Request::Tangent, &vec![0.0; k * k], &mut assembly).unwrap();
                let mut product = vec![0.0; k * n];
                assembly.matrix.multiply(body.pattern(), &direction, &mut product);
                let size = product.iter().fold(0.0, |size: f64, y| size.max(y.abs()));
                for ((plus, minus), y) in plus.iter().zip(&minus).zip(&product) {
                    let error = (plus - minus) / 2e-5 - y;
                    assert!(error.abs() < 1e-7 * size, "{kind}, k = {k}, {rule:?}: {error:e} of {size}");
                }
            }
        }
    }
}

#[test]
fn damped_volumes_never_add_energy_and_keep_the_momenta() {
    let none = Viscosity::default();
    let viscous = Viscosity { time: 0.02, ..none };
    let cases = [
        (none, dgm(0.0)),
        (none, at(dgm(0.5), 2)),
        (none, "AS(8, 0.3)".parse().unwrap()),
        (viscous, DGM),
        (viscous, at(assumed_strain(8), 2)),
        (viscous, at(dgm(0.6), 2)),
    ];
    let start = InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.4, 0.0, 0.0], [0.0, -0.25, 0.0], [0.0, 0.0, -0.15]],
        ..Default::default()
    };
    for (viscosity, scheme) in cases {
        for (kind, space) in [(CellKind::Hex8, None), (CellKind::Hex20, Some(PressureSpace::Linear))] {
            let body = two_cells(kind, space, 1000.0, viscosity);
            for size in [0.02, 0.2] {
                let state = State::initial(&body, 0.0, std::slice::from_ref(&start)).unwrap();
                let mut motion = Motion::starting(&body, scheme, strict(), state).unwrap();
                let first = motion.record().clone();
                let mut before = first.total_energy;
                for _ in 0..40 {
                    let record = motion.step(size).unwrap();
                    let (own, energy) = (record.total_energy, first.total_energy);
                    assert!(own - before < 1e-11 * energy, "{scheme}, {kind}: {before} rises to {own}");
                    assert!(record.energy_residual.abs() < 1e-10 * energy, "{scheme}, {kind}: {record:?}");
                    let change = |d: usize| (record.angular_momentum[d] - first.angular_momentum[d]).abs();
                    assert!((0..3).all(|d| change(d) < 1e-10), "{scheme}, {kind}: {record:?}");
                    assert!(record.linear_momentum_residual < 1e-11, "{scheme}, {kind}: {record:?}");
                    before = own;
                }
                let lost = motion.record().dissipated_energy;
                assert!(lost > 1e-6 * first.total_energy, "{scheme}, {kind}: {lost}");
            }
        }
    }
}

/// A viscosity takes all vibration out of a spinning block; then a dissipative scheme has nothing to take.
#[test]
fn a_relative_equilibrium_of_rubber_is_left_alone() {
    let body = |time: f64| {
        let region = rubber(100.0).with_viscosity(Viscosity { time, ..Viscosity::default() });
        Body::builder(mesh::block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap()).region(region).build().unwrap()
    };
    let (viscous, elastic) = (body(0.3), body(0.0));
    let spin =
        InitialVelocity { angular_velocity: [0.0, 0.0, 0.5], about: [1.0, 0.5, 0.5], ..Default::default() };
    let state = State::initial(&viscous, 0.0, &[spin]).unwrap();
    let mut motion = Motion::starting(&viscous, DGM, strict(), state).unwrap();
    (0..600).for_each(|_| _ = motion.step(0.1).unwrap());
    let lost = motion.record().dissipated_energy;
    let mut motion = Motion::starting(&elastic, dgm(0.5), strict(), motion.state().clone()).unwrap();
    let energy = motion.record().total_energy;
    (0..200).for_each(|_| _ = motion.step(0.1).unwrap());
    assert!(lost > 1e-4 * energy && (motion.record().total_energy / energy - 1.0).abs() < 1e-12, "{lost:e}");
    assert!(motion.record().dissipated_energy.abs() < 1e-12 * energy);
}
