//! Links of two nodes, point masses, springs and attraction to the ground: the systems of point masses of Part I, and
//! theory.

use std::f64::consts::{PI, TAU};

use emmy::body::{Body, GroundAttraction, GroundSpring, InitialVelocity, Load, LoadKind, TimeFunction};
use emmy::body::{PointMass, PointTerms, Region, Support};
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{CellKind, Mesh, MeshBuilder, block};
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::{Error, Result};

use crate::shared::points::{masses, moving, network};
use crate::shared::schemes::at;

fn linked(mesh: Mesh, link: Link, nodal: &PointTerms) -> Body {
    Body::builder(mesh).region(Region::links(link, 0.0)).point_terms(nodal.clone()).build().unwrap()
}

fn motion<'a>(body: &'a Body, scheme: &str, degree: usize, state: State) -> Motion<'a> {
    let settings = NewtonSettings { tolerance: 1e-12, max_iterations: 30, ..NewtonSettings::default() };
    Motion::starting(body, at(scheme.parse().unwrap(), degree), settings, state).unwrap()
}

fn march(motion: &mut Motion<'_>, end: f64, n_steps: usize, mut each: impl FnMut(&Record)) {
    for _ in 1..=n_steps {
        let h = end / n_steps as f64;
        each(motion.step(h).unwrap());
    }
}

/// Two bodies of masses 2 and 1 at a distance of 1 that attract each other with g = 3 and rotate about their common
/// centre, at `speed` times the speed of the circular orbit.
fn two_bodies(speed: f64) -> (Body, State) {
    let mesh = network(&[[1.0 / 3.0, 0.0, 0.0], [-2.0 / 3.0, 0.0, 0.0]], &[[0, 1]]);
    let nodal = PointTerms { masses: masses(&[2.0, 1.0]), ..Default::default() };
    let body = linked(mesh, Link::attraction(3.0).unwrap(), &nodal);
    let v = speed * OMEGA;
    let state = moving(&body, &[[0.0, v / 3.0, 0.0], [0.0, -2.0 / 3.0 * v, 0.0]]);
    (body, state)
}

/// omega^2 = g / (mu r^3), with the reduced mass mu = 2/3: Kepler's third law.
const OMEGA: f64 = 2.121_320_343_559_642_6;

#[test]
fn the_circular_orbit_is_met_with_order_2k() {
    let (body, state) = two_bodies(1.0);
    let end = 0.8 * TAU / OMEGA;
    for (degree, steps) in [(1, 80), (2, 20), (3, 10)] {
        let error = |n_steps: usize| {
            let mut motion = motion(&body, "DGM", degree, state.clone());
            march(&mut motion, end, n_steps, |_| {});
            let (at, angle) = (motion.state().position(&body, 0), 0.8 * TAU);
            (at[0] - angle.cos() / 3.0).hypot(at[1] - angle.sin() / 3.0)
        };
        let (coarse, fine) = (error(steps), error(2 * steps));
        let order = (coarse / fine).log2();
        assert!((order - 2.0 * degree as f64).abs() < 0.4, "k = {degree}: {order} ({coarse:e}, {fine:e})");
    }
}

#[test]
fn an_eccentric_orbit_keeps_energy_and_momenta() {
    let (body, state) = two_bodies(0.7);
    for degree in [1, 2] {
        let mut motion = motion(&body, "DGM", degree, state.clone());
        let first = motion.record().clone();
        let (energy, momentum) = (first.total_energy.abs(), first.angular_momentum[2].abs());
        let mut nearest = f64::INFINITY;
        march(&mut motion, 60.0, 3000, |record| {
            nearest = nearest.min(-3.0 / record.strain_energy);
            assert!(record.energy_residual.abs() < 2e-13 * energy, "k = {degree}: {record:?}");
            assert!(record.angular_momentum_residual < 1e-13 * momentum, "k = {degree}: {record:?}");
            assert!(record.linear_momentum_residual < 1e-13, "k = {degree}: {record:?}");
        });
        let last = motion.record();
        let drift = (last.total_energy - first.total_energy).abs() / energy;
        assert!(drift < 1e-11, "k = {degree}: {drift:e}");
        assert!((last.angular_momentum[2] - first.angular_momentum[2]).abs() < 1e-11 * momentum);
        // Perihelion: a = 1 / (2 - 0.7^2), the start is the aphelion: 2 a - 1.
        let perihelion = 2.0 / (2.0 - 0.49) - 1.0;
        assert!((nearest - perihelion).abs() < 0.02, "{nearest} {perihelion}");
    }
}

/// A lattice of 3 x 3 x 3 irregularly displaced point masses, each joined to its neighbours along the axes and across
/// faces.
fn lattice() -> (Body, State) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let noise = |n: usize| ((n + 1) as f64 * golden).fract() - 0.5;
    let at = |i: usize| [i / 9, i / 3 % 3, i % 3];
    let points: Vec<[f64; 3]> =
        (0..27).map(|i| [0, 1, 2].map(|d| at(i)[d] as f64 + 0.2 * noise(3 * i + d))).collect();
    let near = |i: usize, j: usize| (0..3).map(|d| at(i)[d].abs_diff(at(j)[d]).pow(2)).sum::<usize>() <= 2;
    let pairs = (0..27usize).flat_map(|i| (0..i).map(move |j| (i, j)));
    let links: Vec<[u32; 2]> =
        pairs.filter(|&(i, j)| near(i, j)).map(|(i, j)| [i as u32, j as u32]).collect();
    let of_node: Vec<f64> = (0..27).map(|i| 1.0 + 0.5 * noise(7 * i)).collect();
    let nodal = PointTerms { masses: masses(&of_node), ..Default::default() };
    let body = linked(network(&points, &links), Link::spring(50.0, None).unwrap(), &nodal);
    let velocity = |i: usize| {
        let [x, y, z] = points[i];
        [0.3 - y + 0.5 * noise(5 * i), x + 0.4 * z, -0.4 * y + 0.5 * noise(11 * i)]
    };
    let state = moving(&body, &(0..27).map(velocity).collect::<Vec<_>>());
    (body, state)
}

#[test]
fn a_network_of_springs_keeps_energy_and_momenta() {
    let (body, state) = lattice();
    for degree in [1, 2, 3] {
        let mut motion = motion(&body, "DGM", degree, state.clone());
        let first = motion.record().clone();
        let mut strained = 0f64;
        march(&mut motion, 20.0, 400, |record| {
            strained = strained.max(record.strain_energy / record.total_energy);
            assert!(record.energy_residual.abs() < 1e-12 * first.total_energy, "k = {degree}: {record:?}");
            assert!(record.linear_momentum_residual < 1e-12, "k = {degree}: {record:?}");
            assert!(record.angular_momentum_residual < 1e-11, "k = {degree}: {record:?}");
            // A reused stiffness leaves at most 1e-2 of the residual: from 1e-2 to rounding in seven, and a
            // refactorization.
            assert!(record.newton_iterations <= 9, "k = {degree}: {record:?}");
        });
        let last = motion.record();
        assert!(strained > 0.01, "{strained}");
        assert!((last.total_energy - first.total_energy).abs() < 1e-11 * first.total_energy);
        (0..3).for_each(|d| assert!((last.angular_momentum[d] - first.angular_momentum[d]).abs() < 1e-10));
    }
}

#[test]
fn a_network_of_springs_is_met_with_order_2k() {
    let (body, state) = lattice();
    let displacement = |degree: usize, n_steps: usize| {
        let mut motion = motion(&body, "DGM", degree, state.clone());
        march(&mut motion, 0.8, n_steps, |_| {});
        motion.state().displacement.clone()
    };
    let reference = displacement(4, 64);
    for (degree, steps) in [(1, 32), (2, 16), (3, 8)] {
        let error = |n_steps: usize| {
            let difference = displacement(degree, n_steps);
            difference.iter().zip(&reference).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        let (coarse, fine) = (error(steps), error(2 * steps));
        let order = (coarse / fine).log2();
        assert!((order - 2.0 * degree as f64).abs() < 0.4, "k = {degree}: {order} ({coarse:e}, {fine:e})");
    }
}

/// Two masses on a spring, or at the ends of a bar, vibrate along it: omega^2 = k (1/m_1 + 1/m_2); a bar adds its
/// consistent mass, rho A L/3 on the diagonal and rho A L/6 beside it.
#[test]
fn masses_on_a_link_swing_as_fast_as_theory_says() {
    let mesh = || network(&[[0.0; 3], [1.2, 1.6, 0.0]], &[[0, 1]]);
    let extension = |body: &Body, state: &State| {
        let [a, b] = [0, 1].map(|node| state.position(body, node));
        (0..3).map(|i| (b[i] - a[i]).powi(2)).sum::<f64>().sqrt() - 2.0
    };
    let swings = |body: &Body, v: f64, rate: f64, omega: f64, tolerance: f64| {
        let along = [0.6 * v, 0.8 * v, 0.0];
        let state = moving(body, &[along.map(|v| -rate * v), along]);
        let mut motion = motion(body, "DGM", 3, state);
        for step in 1..=200 {
            let t = 0.02 * f64::from(step);
            motion.step(0.02).unwrap();
            let expected = (1.0 + rate) * v / omega * (omega * t).sin();
            let found = extension(body, motion.state());
            assert!((found - expected).abs() < tolerance * v, "{t}: {found} {expected}");
        }
    };
    // The spring is linear in its length: large amplitudes have the same period. Momentum zero: v_1 = -v m_2/m_1.
    let nodal = PointTerms { masses: masses(&[0.5, 2.0]), ..Default::default() };
    let spring = linked(mesh(), Link::spring(8.0, None).unwrap(), &nodal);
    swings(&spring, 0.1, 4.0, (8.0f64 * (1.0 / 0.5 + 1.0 / 2.0)).sqrt(), 1e-8);
    let nodal = PointTerms { masses: masses(&[1.5, 1.5]), ..Default::default() };
    let bar = vec![Region::links(Link::bar(40.0, 0.5).unwrap(), 3.0)];
    let bar = Body::builder(mesh()).regions(bar).point_terms(nodal.clone()).build().unwrap();
    assert_eq!(bar.regions()[0].mass, 3.0);
    swings(&bar, 1e-7, 1.0, (2.0 * 10.0f64 / (1.5 + 1.0 - 0.5)).sqrt(), 1e-6);
}

/// u = g t^2/2, p = m g t: gravity acts on point masses and on the mass of cells, and time elements are exact for it.
#[test]
fn point_masses_fall() {
    let mesh = network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]]);
    let nodal = PointTerms { masses: masses(&[0.5, 2.0]), ..Default::default() };
    let kind = LoadKind::Acceleration { group: None, acceleration: [0.0, 0.0, -9.81] };
    let gravity = Load { kind, time_function: TimeFunction::constant() };
    let spring = vec![Region::links(Link::spring(8.0, None).unwrap(), 0.0)];
    let body = Body::builder(mesh).regions(spring).point_terms(nodal.clone()).load(gravity).build().unwrap();
    let mut motion = motion(&body, "DGM", 1, State::initial(&body, 0.0, &[]).unwrap());
    march(&mut motion, 2.0, 10, |_| ());
    assert!((motion.record().linear_momentum[2] + 2.5 * 9.81 * 2.0).abs() < 1e-12);
    assert!((motion.state().displacement[2] + 9.81 * 2.0).abs() < 1e-12);
    assert!((motion.record().external_work - 2.5 * 9.81 * 9.81 * 2.0).abs() < 1e-10);
}

/// Two masses joined by a spring that stays at rest, on springs to the ground.
fn on_the_ground() -> (Body, State) {
    let springs = vec![
        GroundSpring { group: "0".into(), stiffness: 4.5 },
        GroundSpring { group: "1".into(), stiffness: 9.0 },
    ];
    let nodal = PointTerms { masses: masses(&[0.5, 1.0]), springs, ..Default::default() };
    let mesh = network(&[[1.0, 0.0, 0.0], [3.0, 1.0, 0.0]], &[[0, 1]]);
    let body = linked(mesh, Link::spring(20.0, None).unwrap(), &nodal);
    let state = moving(&body, &[[0.6, -0.3, 0.9]; 2]);
    (body, state)
}

#[test]
fn springs_to_the_ground_make_an_oscillator() {
    // omega^2 = 4.5/0.5 = 9/1: u = v sin(3 t)/3.
    let (body, state) = on_the_ground();
    let mut motion = motion(&body, "DGM", 3, state);
    let energy = motion.record().total_energy;
    march(&mut motion, PI / 2.0, 40, |record| {
        assert!(record.energy_residual.abs() < 1e-14 && (record.total_energy - energy).abs() < 1e-13);
        assert!(record.linear_momentum_residual < 1e-14 && record.angular_momentum_residual < 1e-14);
    });
    let u = &motion.state().displacement;
    let expected = [-0.2, 0.1, -0.3];
    (0..6).for_each(|dof| assert!((u[dof] - expected[dof % 3]).abs() < 1e-10, "{u:?}"));
}

/// The ground is external: every scheme's own quadrature counts its impulse.
#[test]
fn impulses_of_the_ground_close_the_balances_of_every_scheme() {
    let (spun, _) = on_the_ground();
    let state = moving(&spun, &[[0.6, -0.3, 0.9], [-0.5, 0.8, 0.1]]);
    for (scheme, degree) in
        [("FE(1)", 1), ("FE(3)", 2), ("AS(2)", 2), ("DGM", 1), ("DGM", 3), ("Lobatto(3)", 2)]
            .into_iter()
            .chain(
                ["trapezoidal", "Newmark(0.25, 0.5)", "Bathe", "central-differences"]
                    .map(|scheme| (scheme, 1)),
            )
    {
        let mut motion = motion(&spun, scheme, degree, state.clone());
        let is_conserving = ["FE(1)", "AS(2)", "DGM", "central-differences"].contains(&scheme);
        march(&mut motion, 2.0, 100, |record| {
            assert!(record.linear_momentum_residual < 1e-13, "{scheme}: {record:?}");
            if is_conserving {
                assert!(record.angular_momentum_residual < 1e-13, "{scheme}: {record:?}");
            }
            if scheme == "DGM" {
                assert!(record.energy_residual.abs() < 1e-13, "{scheme}: {record:?}");
            }
        });
        let moved = motion.record().linear_momentum;
        assert!(
            moved.iter().any(|p| p.abs() > 0.1) && motion.state().displacement.iter().all(|u| u.is_finite())
        );
    }
}

/// On a group of facets the stiffness is per area: a block on an elastic foundation of k = 6 per area.
#[test]
fn springs_on_facets_are_a_foundation() {
    let springs = vec![GroundSpring { group: "z-min".into(), stiffness: 6.0 }];
    let nodal = PointTerms { springs, ..Default::default() };
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0);
    let mesh = block([2.0, 3.0, 1.0], [2, 3, 2]).unwrap();
    let body = Body::builder(mesh).region(rubber).point_terms(nodal.clone()).build().unwrap();
    let displacement: Vec<f64> = (0..body.n_dofs()).map(|dof| [0.1, 0.2, -0.2][dof % 3]).collect();
    // k A |u|^2 / 2, with the area 2 x 3.
    assert!((body.strain_energy(&displacement) - 0.5 * 6.0 * 6.0 * 0.09).abs() < 1e-14);
    // The block is moved, not strained.
    assert!((body.strain_state(&displacement).smallest_determinant - 1.0).abs() < 1e-14);
}

/// A link may rotate by any angle: its det F has no meaning.
#[test]
fn links_have_no_determinant() {
    let spring = Link::spring(2.0, None).unwrap();
    let nodal = PointTerms { masses: masses(&[1.0, 1.0]), ..Default::default() };
    let body = linked(network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]]), spring, &nodal);
    let turned_about = [0.0, 0.0, 0.0, -2.5, 0.0, 0.0];
    assert_eq!(body.strain_state(&turned_about).smallest_determinant, f64::INFINITY);
}

/// Two planets opposite each other on a circle about a star away from the origin, joined by a spring at rest.
#[test]
fn a_star_holds_its_planets_on_a_circle() {
    let (c, radius, g) = ([1.0, -2.0, 0.5], 1.5f64, 6.0);
    let points = [[c[0] + radius, c[1], c[2]], [c[0] - radius, c[1], c[2]]];
    let attractions = vec![GroundAttraction { group: None, centre: c, strength: g }];
    let nodal = PointTerms { masses: masses(&[0.3, 0.7]), attractions, ..Default::default() };
    let body = linked(network(&points, &[[0, 1]]), Link::spring(2.0, None).unwrap(), &nodal);
    let omega = (g / radius.powi(3)).sqrt();
    let state = moving(&body, &[[0.0, omega * radius, 0.0], [0.0, -omega * radius, 0.0]]);
    let error = |n_steps: usize| {
        let mut motion = motion(&body, "DGM", 2, state.clone());
        let first = motion.record().clone();
        // V = -g m / R
        assert!((first.strain_energy + g / radius).abs() < 1e-13);
        march(&mut motion, 3.0, n_steps, |record| {
            assert!(record.energy_residual.abs() < 1e-13, "{record:?}");
            assert!((record.total_energy - first.total_energy).abs() < 1e-12, "{record:?}");
            assert!(record.linear_momentum_residual < 1e-13, "{record:?}");
            assert!(record.angular_momentum_residual < 1e-13, "{record:?}");
        });
        let at = motion.state().position(&body, 0);
        (at[0] - c[0] - radius * (omega * 3.0).cos()).hypot(at[1] - c[1] - radius * (omega * 3.0).sin())
    };
    let order = (error(20) / error(40)).log2();
    assert!((order - 4.0).abs() < 0.3, "{order}");
}

/// A block, a mass on two springs, and a bar between mass and block, in free flight.
#[test]
fn solids_springs_bars_and_masses_fly_together() {
    let solid = block([1.0; 3], [1; 3]).unwrap();
    let mut builder = MeshBuilder::new();
    solid.points().iter().for_each(|&point| {
        builder.point(point);
    });
    let mass = builder.point([2.0, 0.4, 0.3]);
    let cell = builder.cell(CellKind::Hex8, solid.cell(0).nodes).unwrap();
    let springs =
        [0, 1].map(|at| builder.cell(CellKind::Line2, &[solid.cell(0).nodes[1 + at], mass]).unwrap());
    let bar = builder.cell(CellKind::Line2, &[mass, solid.cell(0).nodes[6]]).unwrap();
    builder.cell_group("block", [cell]);
    builder.cell_group("springs", springs);
    builder.cell_group("bar", [bar]);
    builder.node_group("mass", [mass]);
    let regions = vec![
        Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0).on("block"),
        Region::links(Link::spring(100.0, Some(0.9)).unwrap(), 0.0).on("springs"),
        Region::links(Link::bar(500.0, 0.1).unwrap(), 1.5).on("bar"),
    ];
    let nodal =
        PointTerms { masses: vec![PointMass { group: "mass".into(), mass: 0.5 }], ..Default::default() };
    let body =
        Body::builder(builder.build().unwrap()).regions(regions).point_terms(nodal.clone()).build().unwrap();
    let summaries = body.regions();
    assert_eq!((summaries.len(), summaries[3].mass, summaries[3].centre), (4, 0.5, [2.0, 0.4, 0.3]));
    let total: f64 = summaries.iter().map(|region| region.mass).sum();
    assert!((body.lumped_mass().iter().sum::<f64>() - total).abs() < 1e-14);
    let spin = InitialVelocity {
        angular_velocity: [1.0, 2.0, 3.0],
        velocity: [1.0, 0.0, 0.0],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    for degree in [1, 2] {
        let mut motion = motion(&body, "DGM", degree, state.clone());
        let first = motion.record().total_energy;
        march(&mut motion, 2.0, 200, |record| {
            assert!(record.energy_residual.abs() < 1e-12 * first, "{record:?}");
            assert!(record.linear_momentum_residual < 1e-12 && record.angular_momentum_residual < 1e-12);
        });
        assert!((motion.record().total_energy - first).abs() < 1e-11 * first);
    }
}

#[test]
fn unsuitable_links_are_rejected() {
    let mesh = || network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]]);
    let body = |regions: Vec<Region>, nodal: PointTerms, supports: &[Support]| -> Result<Body> {
        Body::builder(mesh()).regions(regions).point_terms(nodal.clone()).supports(supports).build()
    };
    let spring = || vec![Region::links(Link::spring(1.0, None).unwrap(), 0.0)];
    let one = || PointTerms { masses: masses(&[1.0]), ..Default::default() };
    let lost = body(spring(), one(), &[]).unwrap_err();
    assert_eq!(lost, Error::NoMass { node: 1, position: [1.0, 0.0, 0.0] });
    // A fixed node needs none.
    let wall = Support { group: "1".into(), fix: [true; 3], ..Default::default() };
    let held = body(spring(), one(), std::slice::from_ref(&wall)).unwrap();
    let state = moving(&held, &[[0.0, 1.0, 0.0]]);
    for scheme in ["DGM", "central-differences"] {
        let mut motion = motion(&held, scheme, 1, state.clone());
        march(&mut motion, 1.0, 100, |record| assert!(record.linear_momentum_residual < 1e-13, "{record:?}"));
        assert!(motion.state().displacement.iter().all(|u| u.is_finite()));
    }
    let rubber = vec![Region::new(NeoHooke::new(1.0, 1.0).unwrap(), 1.0)];
    assert_eq!(
        body(rubber, one(), &[]).unwrap_err(),
        Error::WrongMaterial { cell: 0, kind: CellKind::Line2 }
    );
    let heavy = PointTerms { masses: masses(&[-1.0]), ..Default::default() };
    assert!(matches!(body(spring(), heavy, &[]).unwrap_err(), Error::NotPositive { .. }));
    let limp = PointTerms { springs: vec![GroundSpring { group: "0".into(), stiffness: 0.0 }], ..one() };
    assert!(matches!(body(spring(), limp, &[wall]).unwrap_err(), Error::NotPositive { .. }));
}
