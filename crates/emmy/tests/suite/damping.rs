//! Viscosity, drag, and dissipative schemes: decay against theory, balances, invariants.

use emmy::body::{
    Body, InitialVelocity, Load, LoadKind, PointTerms, Region, Support, TimeFunction, Viscosity,
};
use emmy::internals::polynomial;
use emmy::internals::quadrature;
use emmy::internals::time::LocalError;
use emmy::material::{HolzapfelGasserOgden, Link, NeoHooke, SaintVenantKirchhoff, Volumetric};
use emmy::mesh::{self};
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::time::Scheme;

use crate::shared::points::{masses, moving, network};
use crate::shared::schemes::{DGM, at, dgm, element, fe};

fn settings() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, max_iterations: 30, ..NewtonSettings::default() }
}

fn scheme(text: &str) -> Scheme {
    text.parse().unwrap()
}

/// A mass 1 on a spring of stiffness k to a fixed point, with an amplitude so small that it is linear.
fn oscillator(k: f64, time: f64, drag: f64) -> Body {
    let viscosity = Viscosity { time, ..Viscosity::default() };
    let region = Region::links(Link::spring(k, None).unwrap(), 0.0).with_viscosity(viscosity);
    let fixed = Support { group: "0".into(), fix: [true; 3], ..Support::default() };
    let guided = Support { group: "1".into(), fix: [false, true, true], ..Support::default() };
    let mesh = network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]]);
    let masses = PointTerms { masses: masses(&[1.0, 1.0]), ..PointTerms::default() };
    Body::builder(mesh)
        .region(region)
        .point_terms(masses)
        .support(fixed)
        .support(guided)
        .drag(drag)
        .build()
        .unwrap()
}

/// A block that tumbles, bends and stretches.
fn block(viscosity: Viscosity, supports: &[Support], loads: &[Load]) -> Body {
    block_in_medium(0.0, viscosity, supports, loads)
}

fn block_in_medium(drag: f64, viscosity: Viscosity, supports: &[Support], loads: &[Load]) -> Body {
    let rubber = Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0).with_viscosity(viscosity);
    Body::builder(mesh::block([1.0, 1.0, 2.0], [1, 1, 3]).unwrap())
        .region(rubber)
        .supports(supports)
        .loads(loads)
        .drag(drag)
        .build()
        .unwrap()
}

fn tumbling(body: &Body) -> State {
    let field = InitialVelocity {
        angular_velocity: [0.5, 1.0, 0.3],
        about: [0.2, 0.5, 1.0],
        gradient: [[0.0, 0.0, 1.3], [0.0, 0.4, 0.0], [0.1, 0.0, 1.2]],
        ..InitialVelocity::default()
    };
    State::initial(body, 0.0, &[field]).unwrap()
}

/// Records of a motion of equal steps.
fn records(body: &Body, scheme: Scheme, degree: usize, state: State, h: f64, n: usize) -> Vec<Record> {
    let mut motion = Motion::starting(body, at(scheme, degree), settings(), state).unwrap();
    let step = |_: usize| {
        motion.step(h).unwrap();
        motion.record().clone()
    };
    (0..n).map(step).collect()
}

/// Largest residuals of the balances, relative to the first energy and to the size of the momenta.
fn worst(records: &[Record]) -> [f64; 3] {
    let energy = records.iter().map(|r| r.kinetic_energy + r.strain_energy.abs()).fold(0.0, f64::max);
    let largest = |of: fn(&Record) -> f64| records.iter().map(of).fold(0.0, f64::max);
    [
        largest(|r| r.energy_residual.abs()) / energy,
        largest(|r| r.linear_momentum_residual) / energy,
        largest(|r| r.angular_momentum_residual) / energy,
    ]
}

#[test]
fn a_viscous_spring_and_a_braked_mass_decay_as_in_theory() {
    // x'' + 2 delta x' + omega^2 x = 0 from x = 0, x' = v: x = v/w exp(-delta t) sin(w t), w^2 = omega^2 - delta^2.
    // Viscosity: 2 delta = t_v omega^2; drag: 2 delta = alpha.
    let (k, v, t) = (25.0f64, 1e-6, 2.0);
    for (viscous, drag) in [(0.02, 0.0), (0.0, 0.4), (0.01, 0.3)] {
        let body = oscillator(k, viscous, drag);
        let delta = 0.5 * (viscous * k + drag);
        let w = (k - delta * delta).sqrt();
        let exact = v / w * (-delta * t).exp() * (w * t).sin();
        for (text, degree, n, limit) in
            [("AS(1)", 1, 800, 2e-4), ("DGM", 2, 100, 1e-5), ("AS(3)", 3, 50, 2e-6), ("FE(2)", 2, 100, 1e-5)]
        {
            let mut motion = Motion::starting(
                &body,
                at(scheme(text), degree),
                settings(),
                moving(&body, &[[0.0; 3], [v, 0.0, 0.0]]),
            )
            .unwrap();
            for _ in 1..=n {
                motion.step(t / n as f64).unwrap();
            }
            let error = (motion.state().displacement[3] - exact) * w / v;
            assert!(error.abs() < limit, "{text} {viscous} {drag}: {error:e}");
        }
    }
}

/// A unit cube of one cell whose face x = 1 moves with a velocity, while the opposite face is fixed: F = I + t velocity
/// x e_x.
fn deformed_cube(region: Region, velocity: [f64; 3]) -> Body {
    let along = |v: f64| (v != 0.0).then(|| TimeFunction::smooth("v*t", move |t| [v * t, v, 0.0]));
    let held = Support { group: "x-min".into(), fix: [true; 3], ..Support::default() };
    let moved = Support {
        group: "x-max".into(),
        fix: velocity.map(|v| v == 0.0),
        displacement: velocity.map(along),
        ..Support::default()
    };
    Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap())
        .region(region)
        .support(held)
        .support(moved)
        .build()
        .unwrap()
}

/// The dissipation of a given deformation is an integral over time, computed by hand.
#[test]
fn dissipation_of_a_given_deformation_matches_its_formula() {
    // E = (F^T F - I)/2 with F = I + t v x e_x: E'_xx = v_x + t |v|^2, E'_xy = v_y/2, E'_xz = v_z/2. The power per
    // volume of
    // S = t_v (lambda tr E' I + 2 mu E') + 2 eta dev E' + zeta tr E' I is
    // (t_v lambda + zeta - 2/3 eta) (tr E')^2 + 2 (t_v mu + eta) E' : E'.
    let (lambda, mu, until) = (30.0, 15.0, 0.6);
    let materials: [&dyn Fn() -> Region; 3] = [
        &|| Region::new(NeoHooke::new(lambda, mu).unwrap(), 1.0),
        &|| Region::new(SaintVenantKirchhoff::new(lambda, mu).unwrap(), 1.0),
        // Fibres have no stiffness at rest, so no part in D_0, although the motion stretches them.
        &|| {
            let (bulk, fibres) = (lambda + 2.0 / 3.0 * mu, [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]);
            let law = Volumetric::default();
            let tissue = HolzapfelGasserOgden::new(mu, [5.0, 0.3], 0.0, &fibres, bulk, law).unwrap();
            Region::new(tissue, 1.0)
        },
    ];
    for velocity in [[0.0, 0.7, 0.0], [0.5, 0.0, 0.0], [-0.3, 0.4, 0.6]] {
        let square: f64 = velocity.iter().map(|v: &f64| v * v).sum();
        let across = (velocity[1].powi(2) + velocity[2].powi(2)) / 2.0;
        for (time, shear, bulk) in [(0.0, 0.8, 0.0), (0.0, 0.0, 1.3), (0.02, 0.0, 0.0), (0.01, 0.5, 0.2)] {
            let viscosity = Viscosity { time, shear, bulk };
            let (of_trace, of_rate) = (time * lambda + bulk - 2.0 / 3.0 * shear, 2.0 * (time * mu + shear));
            for region in &materials {
                let body = deformed_cube(region().with_viscosity(viscosity), velocity);
                for (text, degree) in [("DGM", 1), ("DGM", 2), ("AS(3)", 3), ("FE(2)", 2)] {
                    let n = 6;
                    let h = until / f64::from(n);
                    let state = State::initial(&body, 0.0, &[]).unwrap();
                    let taken = records(&body, scheme(text), degree, state, h, n as usize)[n as usize - 1]
                        .dissipated_energy;
                    // (E'_xx)^2 integrated: exactly by two Gauss points and more, by the mid-points for k = 1, which
                    // miss h^2 |v|^4/12.
                    let cube = |t: f64| (velocity[0] + t * square).powi(3) / (3.0 * square);
                    let missed = if degree == 1 { h * h * square * square / 12.0 * until } else { 0.0 };
                    let squared = cube(until) - cube(0.0) - missed;
                    let exact = of_trace * squared + of_rate * (squared + across * until);
                    assert!(
                        (taken - exact).abs() < 1e-13 * exact,
                        "{velocity:?} {viscosity:?} {text} {degree}: {taken} is not {exact}"
                    );
                }
            }
        }
    }
}

/// A cell that vibrates along x with a fixed face, at small strain: `rho L^2/3 u'' + V u' + (lambda + 2 mu) u = 0` with
/// the consistent mass and V = t_v (lambda + 2 mu) + 4/3 eta + zeta.
#[test]
fn a_viscous_block_decays_as_in_theory() {
    let (lambda, mu, density, v, t) = (4.0, 3.0, 2.0, 1e-8, 3.0);
    for (time, shear, bulk) in [(0.04, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.4), (0.02, 0.1, 0.1)] {
        let elastic = SaintVenantKirchhoff::new(lambda, mu).unwrap();
        let region = Region::new(elastic, density).with_viscosity(Viscosity { time, shear, bulk });
        let fixed = Support { group: "x-min".into(), fix: [true; 3], ..Support::default() };
        let guided = Support { group: "x-max".into(), fix: [false, true, true], ..Support::default() };
        let mesh = mesh::block([1.0; 3], [1; 3]).unwrap();
        let body = Body::builder(mesh).region(region).support(fixed).support(guided).build().unwrap();
        let pushed =
            InitialVelocity { group: Some("x-max".into()), velocity: [v, 0.0, 0.0], ..Default::default() };
        let state = State::initial(&body, 0.0, &[pushed]).unwrap();
        let viscous = time * (lambda + 2.0 * mu) + 4.0 / 3.0 * shear + bulk;
        let delta = 1.5 * viscous / density;
        let w = (3.0 * (lambda + 2.0 * mu) / density - delta * delta).sqrt();
        let mut motion = Motion::starting(&body, at(scheme("DGM"), 3), settings(), state).unwrap();
        (1..=60).for_each(|_| drop(motion.step(t / 60.0).unwrap().clone()));
        let exact = v / w * (-delta * t).exp() * (w * t).sin();
        let found = motion.state().displacement[3 * body.mesh().nearest_node([1.0; 3])];
        // The time element's phase error, (w h)^6 w t/100800, is 1e-8; strains of 1e-8 add as much to a linear
        // solution.
        assert!((found - exact).abs() * w / v < 1e-7, "{time} {shear} {bulk}: {found} is not {exact}");
    }
}

#[test]
fn a_braked_body_in_free_flight_slows_down_by_the_factor_of_the_midpoint() {
    // h alpha x + 2 (M x - h p)/.. : v_2/v_1 = (1 - h alpha/2)/(1 + h alpha/2), and for k = 2 the (2, 2) Pade
    // approximant of exp.
    let body = block_in_medium(0.8, Viscosity::default(), &[], &[]);
    let field = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..InitialVelocity::default() };
    let z: f64 = -0.8 * 0.5;
    for (degree, factor) in [
        (1, (1.0 + z / 2.0) / (1.0 - z / 2.0)),
        (2, (1.0 + z / 2.0 + z * z / 12.0) / (1.0 - z / 2.0 + z * z / 12.0)),
    ] {
        let state = State::initial(&body, 0.0, std::slice::from_ref(&field)).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, degree), settings(), state).unwrap();
        motion.step(0.5).unwrap();
        assert!(motion.state().velocity.iter().step_by(3).all(|v| (v / (3.0 * factor) - 1.0).abs() < 1e-13));
        let lost = 0.5 * 2.0 * 9.0 * (1.0 - factor * factor);
        assert!((motion.record().dissipated_energy / lost - 1.0).abs() < 1e-12);
    }
}

#[test]
fn balances_close_with_viscosity_drag_loads_and_supports() {
    let viscosity = Viscosity { time: 0.01, shear: 0.2, bulk: 0.1 };
    let pull = Load {
        kind: LoadKind::Traction { group: "z-max".into(), traction: [0.5, -0.3, 0.4] },
        time_function: TimeFunction::new(vec![(0.0, 0.0), (0.33, 1.0), (0.7, 0.0)]).unwrap(),
    };
    let held = Support { group: "z-min".into(), fix: [true; 3], ..Support::default() };
    for supports in [vec![], vec![held]] {
        let body = block_in_medium(0.2, viscosity, &supports, std::slice::from_ref(&pull));
        for (text, degree) in
            [("DGM", 1), ("DGM", 2), ("AS(6)", 1), ("AS(6)", 2), ("AS(7)", 3), ("DGM(0.5)", 1), ("DGM(0)", 2)]
        {
            let records = records(&body, scheme(text), degree, tumbling(&body), 0.1, 20);
            let [energy, linear, angular] = worst(&records);
            let limit = if text.starts_with("AS") { 1e-8 } else { 1e-12 };
            assert!(
                energy < limit && linear < 1e-12 && angular < 1e-12,
                "{text} {degree}: {energy:e} {linear:e} {angular:e}"
            );
            assert!(records.windows(2).all(|pair| pair[1].dissipated_energy > pair[0].dissipated_energy));
        }
        // FE conserves its momenta; its energy is wrong as far as its stress is not the derivative of an energy.
        let [_, linear, angular] = worst(&records(&body, scheme("FE(2)"), 2, tumbling(&body), 0.1, 20));
        assert!(linear < 1e-12 && angular < 1e-12, "FE(2): {linear:e} {angular:e}");
    }
}

#[test]
fn balances_close_where_a_support_moves_a_damped_body() {
    let rate = TimeFunction::smooth("0.3*sin(2*t)", |t| {
        let (sin, cos) = (2.0 * t).sin_cos();
        [0.3 * sin, 0.6 * cos, -1.2 * sin]
    });
    let driven = Support {
        group: "z-min".into(),
        fix: [false, true, true],
        displacement: [Some(rate), None, None],
        ..Support::default()
    };
    let body = block_in_medium(0.3, Viscosity { time: 0.02, ..Viscosity::default() }, &[driven], &[]);
    for (text, degree) in [("DGM", 1), ("DGM", 2), ("AS(8)", 1)] {
        let state = State::initial(&body, 0.0, &[]).unwrap();
        let records = records(&body, scheme(text), degree, state, 0.1, 30);
        let [energy, linear, angular] = worst(&records);
        assert!(
            energy < 1e-10 && linear < 1e-12 && angular < 1e-12,
            "{text} {degree}: {energy:e} {linear:e} {angular:e}"
        );
        assert!(records[29].dissipated_energy > 1e-2 * records[29].external_work.abs());
    }
}

#[test]
fn viscosity_leaves_the_momenta_and_dies_out_in_a_relative_equilibrium() {
    let body = block(Viscosity { time: 0.3, ..Viscosity::default() }, &[], &[]);
    let records = records(&body, scheme("DGM"), 1, tumbling(&body), 0.1, 600);
    let (first, last) = (&records[0], &records[599]);
    for d in 0..3 {
        assert!((first.angular_momentum[d] - last.angular_momentum[d]).abs() < 1e-11);
        assert!((first.linear_momentum[d] - last.linear_momentum[d]).abs() < 1e-11);
    }
    let taken = |a: &Record, b: &Record| b.dissipated_energy - a.dissipated_energy;
    assert!(taken(&records[589], last) < 1e-3 * taken(first, &records[10]));
    assert!(last.kinetic_energy > 0.1 * first.kinetic_energy);
}

#[test]
fn schemes_that_dissipate_never_add_energy_and_keep_the_momenta() {
    let body = block(Viscosity::default(), &[], &[]);
    for (text, degree) in [
        ("DGM(0)", 1),
        ("DGM(0.5)", 1),
        ("DGM(0.9)", 1),
        ("AS(8, 0.3)", 1),
        ("DGM(0)", 2),
        ("DGM(0.6)", 2),
        ("DGM(0.2)", 3),
    ] {
        for h in [0.02, 0.4] {
            let records = records(&body, scheme(text), degree, tumbling(&body), h, 50);
            let [energy, linear, angular] = worst(&records);
            assert!(
                energy < 1e-10 && linear < 1e-12 && angular < 1e-12,
                "{text} {degree} {h}: {energy:e} {linear:e} {angular:e}"
            );
            let rises = records.windows(2).map(|pair| pair[1].total_energy - pair[0].total_energy);
            let largest = rises.fold(f64::NEG_INFINITY, f64::max);
            assert!(largest < 1e-11 * records[0].total_energy, "{text} {degree} {h}: {largest:e}");
            let drift =
                (0..3).map(|d| (records[49].angular_momentum[d] - records[0].angular_momentum[d]).abs());
            assert!(drift.fold(0.0, f64::max) < 1e-10, "{text} {degree} {h}");
        }
    }
    // The quadrature of AS(8) is exact enough at these steps; without dissipation no energy is lost.
    let free = records(&body, scheme("DGM(1)"), 1, tumbling(&body), 0.1, 20);
    let same = records(&body, scheme("DGM"), 1, tumbling(&body), 0.1, 20);
    assert!(free.iter().zip(&same).all(|(a, b)| (a.kinetic_energy - b.kinetic_energy).abs() < 1e-11));
    assert!(free.iter().all(|record| record.dissipated_energy == 0.0));
}

#[test]
fn a_body_in_plane_strain_keeps_its_angular_momentum_and_one_on_rollers_its_energy_balance() {
    let rubber = || Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0);
    let field = InitialVelocity {
        angular_velocity: [0.0, 0.0, 1.5],
        gradient: [[0.0, 1.3, 0.0], [0.2, 0.8, 0.0], [0.0; 3]],
        ..InitialVelocity::default()
    };
    let plane = Body::builder(mesh::rectangle([2.0, 1.0], [4, 2]).unwrap()).region(rubber()).build().unwrap();
    let state = State::initial(&plane, 0.0, std::slice::from_ref(&field)).unwrap();
    let records = records(&plane, scheme("DGM(0.4)"), 1, state, 0.1, 40);
    let [energy, linear, angular] = worst(&records);
    assert!(energy < 1e-12 && linear < 1e-12 && angular < 1e-12, "{energy:e} {linear:e} {angular:e}");
    assert!(records[39].dissipated_energy > 1e-2 * records[0].total_energy);
    let rollers = Support { group: "y-min".into(), fix: [false, true, false], ..Support::default() };
    let body = block(Viscosity::default(), &[rollers], &[]);
    let records = self::records(&body, scheme("DGM(0.4)"), 1, tumbling(&body), 0.1, 40);
    let [energy, linear, _] = worst(&records);
    assert!(energy < 1e-12 && linear < 1e-12, "{energy:e} {linear:e}");
    assert!(records.windows(2).all(|pair| pair[1].total_energy < pair[0].total_energy));
}

#[test]
fn fast_oscillations_decay_by_the_spectral_radius_and_slow_ones_hardly() {
    for (degree, radius) in [(1, 0.0), (1, 0.5), (1, 0.8), (2, 0.0), (2, 0.5), (3, 0.4)] {
        let dissipative = dgm(radius);
        // omega h = 1e4: two norms with a factor of the radius between them, each step.
        let body = oscillator(1e8, 0.0, 0.0);
        let fast = records(&body, dissipative, degree, moving(&body, &[[0.0; 3], [1e-6, 0.0, 0.0]]), 1.0, 8);
        let factor = (fast[7].total_energy / fast[6].total_energy).sqrt();
        if radius > 0.0 {
            assert!((factor - radius).abs() < 1e-3, "{degree} {radius}: {factor}");
        } else {
            assert!(fast[7].total_energy < 1e-20 * fast[0].total_energy, "{degree}: {factor}");
        }
        // omega h = 0.05: the modulus of the stability function is 1 - c (omega h)^(2k).
        let body = oscillator(0.25, 0.0, 0.0);
        let slow = records(&body, dissipative, degree, moving(&body, &[[0.0; 3], [1e-6, 0.0, 0.0]]), 0.1, 10);
        let lost = 1.0 - slow[9].total_energy / 0.5e-12;
        assert!(lost < 10.0 * 0.05f64.powi(2 * degree as i32), "{degree} {radius}: {lost:e}");
    }
}

/// The coefficients `a_ij + beta p_i b_j p_j` as the book prints them, with p written out for k = 1, 2, 3.
#[test]
fn the_formula_of_the_book_has_the_spectral_radius_and_is_the_scheme() {
    for degree in [1usize, 2, 3] {
        let rule = quadrature::gauss(degree);
        let points: Vec<f64> = rule.points.iter().map(|&[point]| point).collect();
        let p: Vec<f64> = points
            .iter()
            .map(|s| match degree {
                1 => 1.0,
                2 => 3f64.sqrt() * (2.0 * s - 1.0),
                _ => 5f64.sqrt() * (6.0 * s * s - 6.0 * s + 1.0),
            })
            .collect();
        for radius in [0.0, 0.3, 0.8] {
            let beta = (1.0 - radius) / (1.0 + radius) / (2.0 * (2.0 * degree as f64 - 1.0));
            let a: Vec<Vec<f64>> = (0..degree)
                .map(|i| {
                    (0..degree)
                        .map(|j| {
                            polynomial::lagrange_integral(&points, j, points[i])
                                + beta * p[i] * rule.weights[j] * p[j]
                        })
                        .collect()
                })
                .collect();
            // R(z) = det(1 - z a + z 1 b^T)/det(1 - z a); at infinity det(a - 1 b^T)/det a.
            let shifted = |z: [f64; 2], with_b: f64, one: f64| {
                let entry = |i: usize, j: usize| {
                    let number = a[i][j] - with_b * rule.weights[j];
                    [if i == j { one } else { 0.0 } - z[0] * number, -z[1] * number]
                };
                determinant(degree, &entry)
            };
            let [at_infinity, of_a] = [1.0, 0.0].map(|with_b| shifted([-1.0, 0.0], with_b, 0.0)[0]);
            assert!(((at_infinity / of_a).abs() - radius).abs() < 1e-14, "{degree} {radius}");
            // A step of the scheme on an oscillator, from x = 0 with the velocity v: x = Im R v/omega, x' = Re R v.
            let (omega, h, v) = (5.0, 0.3, 1e-7);
            let [top, bottom] = [1.0, 0.0].map(|with_b| shifted([0.0, omega * h], with_b, 1.0));
            let size = bottom[0] * bottom[0] + bottom[1] * bottom[1];
            let real = (top[0] * bottom[0] + top[1] * bottom[1]) / size;
            let imaginary = (top[1] * bottom[0] - top[0] * bottom[1]) / size;
            let body = oscillator(omega * omega, 0.0, 0.0);
            let dissipative = dgm(radius);
            let start = moving(&body, &[[0.0; 3], [v, 0.0, 0.0]]);
            let mut motion = Motion::starting(&body, at(dissipative, degree), settings(), start).unwrap();
            motion.step(h).unwrap();
            let found = [motion.state().displacement[3] * omega / v, motion.state().velocity[3] / v];
            assert!(
                (found[0] - imaginary).abs() < 1e-6 && (found[1] - real).abs() < 1e-6,
                "{degree} {radius}: {found:?} is not {imaginary} {real}"
            );
        }
    }
}

/// Determinant of a complex matrix of up to three rows, by its first row.
fn determinant(n: usize, entry: &dyn Fn(usize, usize) -> [f64; 2]) -> [f64; 2] {
    if n == 0 {
        return [1.0, 0.0];
    }
    (0..n).fold([0.0; 2], |sum, column| {
        let minor = determinant(n - 1, &|i, j| entry(i + 1, if j < column { j } else { j + 1 }));
        let (e, sign) = (entry(0, column), if column % 2 == 0 { 1.0 } else { -1.0 });
        [
            sum[0] + sign * (e[0] * minor[0] - e[1] * minor[1]),
            sum[1] + sign * (e[0] * minor[1] + e[1] * minor[0]),
        ]
    })
}

#[test]
fn dissipative_elements_are_of_order_2k_less_1() {
    let body = block(Viscosity::default(), &[], &[]);
    let end = |scheme: Scheme, degree: usize, n: usize| {
        let mut motion = Motion::starting(&body, at(scheme, degree), settings(), tumbling(&body)).unwrap();
        for _ in 1..=n {
            motion.step(0.4 / n as f64).unwrap();
        }
        motion.state().displacement.clone()
    };
    let exact = end(fe(4), 4, 64);
    for (degree, n) in [(1, 64), (2, 16), (3, 8)] {
        for radius in [0.0, 0.6] {
            let dissipative = dgm(radius);
            let error = |n: usize| {
                let pairs = end(dissipative, degree, n)
                    .into_iter()
                    .zip(&exact)
                    .map(|(a, b)| (a - b).powi(2))
                    .sum::<f64>();
                pairs.sqrt()
            };
            let order = (error(n) / error(2 * n)).log2();
            let expected = element(dissipative, degree).order() as f64;
            assert!((order - expected).abs() < 0.35, "{degree} {radius}: {order}");
        }
    }
}

#[test]
fn a_relative_equilibrium_is_left_alone() {
    // Two masses m at the ends of a spring that turns by theta a step without changing its length l = 2 r:
    // x/h = (v_1 + v_2)/2 gives the speed 2 r tan(theta/2)/h, and M dv = -h f with f = kappa q in the middle
    // tan^2(theta/2) = h^2 kappa/(4 m), kappa = k (l - L)/r.
    let (m, k, length, r, h) = (1.3f64, 50.0, 1.0, 0.6, 0.3);
    let kappa = k * (2.0 * r - length) / r;
    let tangent = (h * h * kappa / (4.0 * m)).sqrt();
    let speed = 2.0 * r * tangent / h;
    let mesh = network(&[[0.5 * length, 0.0, 0.0], [-0.5 * length, 0.0, 0.0]], &[[0, 1]]);
    let region = Region::links(Link::spring(k, None).unwrap(), 0.0);
    let body = Body::builder(mesh)
        .region(region)
        .point_terms(PointTerms { masses: masses(&[m, m]), ..PointTerms::default() })
        .build()
        .unwrap();
    // Also in free flight.
    let mut state = moving(&body, &[[0.3, speed, 0.1], [0.3, -speed, 0.1]]);
    (state.displacement[0], state.displacement[3]) = (r - 0.5 * length, 0.5 * length - r);
    for radius in [0.0, 0.5] {
        let dissipative = dgm(radius);
        let records = records(&body, dissipative, 1, state.clone(), h, 500);
        assert!((records[499].total_energy / records[0].total_energy - 1.0).abs() < 1e-12);
        assert!(records[499].dissipated_energy.abs() < 1e-12 * records[0].total_energy);
        // While a mode of the spring decays.
        let mut shaken = state.clone();
        (0..6).for_each(|dof| shaken.velocity[dof] += [0.4, 0.0, 0.0, -0.4, 0.0, 0.0][dof]);
        body.mass_product(&shaken.velocity, &mut shaken.momentum);
        let shaken = self::records(&body, dissipative, 1, shaken, h, 200);
        assert!(shaken[199].dissipated_energy > 0.5 * m * 0.16, "{}", shaken[199].dissipated_energy);
    }
}

#[test]
fn accelerations_of_a_state_know_viscosity_and_drag() {
    // A tiny oscillator, m = 1: a = -(k u + t_v k v + alpha v).
    let (k, viscous, drag) = (25.0, 0.02, 0.4);
    let body = oscillator(k, viscous, drag);
    let (u, v) = (3e-7, 1e-6);
    let mut state = moving(&body, &[[0.0; 3], [v, 0.0, 0.0]]);
    state.displacement[3] = u;
    let acceleration = LocalError::acceleration(&body, &state).unwrap();
    assert!((acceleration[3] / -(k * u + viscous * k * v + drag * v) - 1.0).abs() < 1e-5);
}

#[test]
fn incompatible_combinations_are_rejected() {
    let viscous = block(Viscosity { time: 0.1, ..Viscosity::default() }, &[], &[]);
    for text in ["Newmark(0.25, 0.5)", "Bathe", "central-differences"] {
        let error =
            Motion::starting(&viscous, at(scheme(text), 1), settings(), tumbling(&viscous)).unwrap_err();
        assert!(error.to_string().contains("viscosity"), "{error}");
    }
    let driven = Support {
        group: "z-max".into(),
        displacement: [Some(TimeFunction::smooth("0.1*t", |t| [0.1 * t, 0.1, 0.0])), None, None],
        ..Support::default()
    };
    let body = block(Viscosity::default(), &[driven], &[]);
    let state = State::initial(&body, 0.0, &[]).unwrap();
    assert!(Motion::starting(&body, at(scheme("DGM(0.5)"), 1), settings(), state).is_err());
    let negative = Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0)
        .with_viscosity(Viscosity { shear: -1.0, ..Viscosity::default() });
    let error = Body::builder(mesh::block([1.0; 3], [1; 3]).unwrap()).region(negative).build().unwrap_err();
    assert!(error.to_string().contains("shear"), "{error}");
}
