//! Natural modes against exact solutions, theories of beams and plates, and SciPy.

#![allow(non_snake_case)]

use std::f64::consts::{PI, SQRT_2};

use emmy::Error;
use emmy::body::{Body, Load, PointTerms, Region, Support};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::Quadrature;
use emmy::internals::time::CentralDifferences;
use emmy::material::{Link, NeoHooke, SaintVenantKirchhoff};
use emmy::mesh::{self, CellKind, Mesh, MeshBuilder};
use emmy::modes::{Mode, lowest_elastic_mode, modes, modes_about};
use emmy::motion::{Motion, NewtonSettings, State};
use emmy::time::TimeElement;

use crate::shared::bricks::brick;
use crate::shared::points::{masses, network};

/// A body of density 2.
fn body(mesh: Mesh, youngs_modulus: f64, poissons_ratio: f64, supports: &[Support]) -> Body {
    let material = NeoHooke::from_engineering(youngs_modulus, poissons_ratio).unwrap();
    Body::builder(mesh).region(Region::new(material, 2.0)).supports(supports).build().unwrap()
}

fn frequencies(modes: &[Mode]) -> Vec<f64> {
    modes.iter().map(|mode| mode.angular_frequency).collect()
}

fn n_rigid(modes: &[Mode]) -> usize {
    modes.iter().filter(|mode| mode.angular_frequency == 0.0).count()
}

fn close(value: f64, expected: f64, relative: f64) {
    let error = (value / expected - 1.0).abs();
    assert!(error < relative, "{value} is not {expected}: {error:e}");
}

/// Axial motion without Poisson's effect is one-dimensional: omega_n = (n - 1/2) pi c / L if one end is held, with
/// effective masses 8/(pi^2 (2n - 1)^2), and n pi c / L if both are free.
#[test]
fn a_bar_has_its_axial_modes() {
    let (length, c) = (6.0, (50.0f64 / 2.0).sqrt());
    for kind in [CellKind::Hex20, CellKind::Hex27] {
        let mesh = brick(kind, [length, 1.0, 1.0], [12, 1, 1]);
        for is_held in [true, false] {
            let mut supports = vec![Support::of_components("all", [false, true, true])];
            supports.extend(is_held.then(|| Support::fixed("x-min")));
            let body = body(mesh.clone(), 50.0, 0.0, &supports);
            let found = modes(&body, 4).unwrap();
            for (n, mode) in found.iter().enumerate() {
                let half_waves = if is_held { n as f64 + 0.5 } else { n as f64 };
                let expected = half_waves * PI * c / length;
                if expected == 0.0 {
                    assert_eq!(mode.angular_frequency, 0.0);
                    close(mode.effective_mass[0], 12.0, 1e-10);
                    continue;
                }
                // Relative error of quadratic elements (Hughes 2000, section 9.1).
                let error = |n: f64| (n * PI / 12.0).powi(4) / 1440.0;
                close(mode.angular_frequency, expected, 1.2 * error(half_waves));
                if is_held {
                    // Errors of shapes have the same order.
                    close(
                        mode.effective_mass[0] / 12.0,
                        2.0 / (PI * half_waves).powi(2),
                        5.0 * error(half_waves),
                    );
                }
            }
        }
    }
}

/// Clamped slender beam: beta L = 1.875104, 4.694091 by Euler and Bernoulli, each twice for a square section; effective
/// masses 0.6131 and 0.1883 of the beam's (Clough and Penzien, Dynamics of Structures). Shear and rotary inertia lower
/// the second frequency by 0.3 %.
#[test]
fn a_cantilever_has_the_modes_of_beam_theory() {
    let (length, rigidity, mass) = (40.0f64, 3e4f64 / 12.0, 2.0);
    let held = [Support::fixed("x-min")];
    let body = body(brick(CellKind::Hex20, [length, 1.0, 1.0], [20, 1, 1]), 3e4, 0.0, &held);
    let found = modes(&body, 4).unwrap();
    for (pair, (beta, share, tolerance)) in
        [(1.875_104f64, 0.6131, 1e-3), (4.694_091, 0.1883, 4e-3)].into_iter().enumerate()
    {
        let expected = (beta / length).powi(2) * (rigidity / mass).sqrt();
        for mode in &found[2 * pair..2 * pair + 2] {
            close(mode.angular_frequency, expected, tolerance);
        }
        // Both directions of bending together: the modes of a pair are any two of their plane.
        let sum: f64 = found[2 * pair..2 * pair + 2].iter().map(|mode| mode.effective_mass[1]).sum();
        close(sum / 80.0, share, 0.02);
    }
}

/// u = (cos kx sin ky, -sin kx cos ky, 0), k = pi/a, leaves all faces of a cube free: omega = sqrt(2) pi c_t / a for
/// every Poisson's ratio, three times (Lame 1852; Demarest 1971).
#[test]
fn a_free_cube_has_lames_modes() {
    let shear_speed = (100.0 / (2.0 * 1.3) / 2.0f64).sqrt();
    let expected = SQRT_2 * PI * shear_speed / 3.0;
    for cells in [4, 6] {
        let cube = body(brick(CellKind::Hex27, [3.0; 3], [cells; 3]), 100.0, 0.3, &[]);
        let found = modes(&cube, 20).unwrap();
        assert_eq!(n_rigid(&found), 6);
        // Three translations, each with the whole mass, then rotations.
        for (i, mode) in found[..6].iter().enumerate() {
            let expected = [0, 1, 2].map(|axis| if axis == i { 54.0 } else { 0.0 });
            assert!((0..3).all(|axis| (mode.effective_mass[axis] - expected[axis]).abs() < 1e-9));
        }
        // Order 4: five times the error of a wave along an edge.
        let bound = 5.0 * (PI / cells as f64).powi(4) / 1440.0;
        let lame = frequencies(&found).into_iter().filter(|omega| (omega / expected - 1.0).abs() < bound);
        assert_eq!(lame.count(), 3, "{expected}: {:?}", frequencies(&found));
    }
}

/// Free square plate, nu = 0.3: omega a^2 sqrt(rho h / D) = 13.489, 19.789, 24.432, 35.024, 35.024 (Leissa 1973, table
/// C21, by Ritz: upper bounds of up to 1 %).
#[test]
fn a_free_plate_has_leissas_modes() {
    let (side, thickness) = (10.0f64, 0.1f64);
    let plate = body(brick(CellKind::Hex20, [side, side, thickness], [10, 10, 1]), 1e5, 0.3, &[]);
    let rigidity = 1e5 * thickness.powi(3) / (12.0 * (1.0 - 0.09));
    let scale = side.powi(2) * (2.0 * thickness / rigidity).sqrt();
    let found = frequencies(&modes(&plate, 11).unwrap());
    assert_eq!(found[5], 0.0);
    for (omega, expected) in found[6..].iter().zip([13.489, 19.789, 24.432, 35.024, 35.024]) {
        close(omega * scale, expected, 0.012);
    }
}

/// Springs between n equal masses along a line: omega_j = 2 sqrt(k/m) sin(j pi / (2 (n + 1))) along, and across it with
/// the tension over the length in place of k. In compression, the modes across grow at these rates.
#[test]
fn a_chain_under_tension_vibrates_like_a_string() {
    let n = 8;
    let points: Vec<[f64; 3]> = (0..n + 2).map(|i| [i as f64, 0.0, 0.0]).collect();
    let links: Vec<[u32; 2]> = (0..=n as u32).map(|i| [i, i + 1]).collect();
    let nodal = PointTerms { masses: masses(&[0.5; 10]), ..Default::default() };
    let ends = [Support::fixed("0"), Support::fixed("9")];
    let chain = Body::builder(network(&points, &links))
        .region(Region::links(Link::spring(3.0, None).unwrap(), 0.0))
        .point_terms(nodal)
        .supports(&ends)
        .build()
        .unwrap();
    let sine = |j: usize| (j as f64 * PI / (2.0 * (n + 1) as f64)).sin();
    for stretch in [0.02, -0.01f64] {
        let displacement = points.iter().flat_map(|X| [stretch * X[0], 0.0, 0.0]).collect();
        let state = State { displacement, ..State::initial(&chain, 0.0, &[]).unwrap() };
        let found = modes_about(&chain, &state, 3 * n).unwrap();
        let across = 3.0 * stretch / (1.0 + stretch) / 0.5;
        let transverse = (1..=n).map(|j| 2.0 * across.abs().sqrt().copysign(across) * sine(j));
        let mut expected: Vec<f64> = transverse.flat_map(|omega| [omega, omega]).collect();
        expected.extend((1..=n).map(|j| 2.0 * (3.0f64 / 0.5).sqrt() * sine(j)));
        expected.sort_by(f64::total_cmp);
        for (mode, expected) in found.iter().zip(&expected) {
            close(mode.angular_frequency, *expected, 1e-10);
        }
        assert_eq!(found[0].is_elastic(), stretch > 0.0);
        assert_eq!(found[0].period().is_finite(), stretch > 0.0);
    }
    // Without tension, nothing holds the masses across the chain.
    let found = modes(&chain, 3 * n).unwrap();
    assert_eq!(n_rigid(&found), 2 * n);
    close(found[2 * n].angular_frequency, 2.0 * 6f64.sqrt() * sine(1), 1e-12);
    let (lowest, n_rigid) = lowest_elastic_mode(&chain).unwrap().unwrap();
    assert_eq!(n_rigid, 2 * n);
    close(lowest.angular_frequency, found[2 * n].angular_frequency, 1e-12);
}

/// Beam between walls that its ends slide along, under an axial force N: omega^2 = k^2 (E I k^2 + N)/(rho A), k = pi/L,
/// in both directions. Beyond Euler's load, N < -E I k^2, both modes are unstable. Shear and rotary inertia take 0.7 %
/// of E I k^2.
#[test]
fn axial_force_changes_the_bending_of_a_beam() {
    let (length, rigidity, stiffness) = (20.0, 100.0, 1200.0);
    let walls = ["x-min", "x-max"].map(|wall| Support::of_components(wall, [true, false, false]));
    let beam = body(brick(CellKind::Hex20, [length, 1.0, 1.0], [10, 1, 1]), stiffness, 0.0, &walls);
    let k: f64 = PI / length;
    let euler = rigidity * k * k;
    for force in [0.5 * euler, 0.0, -0.5 * euler, -1.5 * euler] {
        let strain = force / stiffness;
        let displacement = beam.mesh().points().iter().flat_map(|X| [strain * X[0], 0.0, 0.0]).collect();
        let state = State { displacement, ..State::initial(&beam, 0.0, &[]).unwrap() };
        let found = modes_about(&beam, &state, 5).unwrap();
        assert_eq!(n_rigid(&found), 3);
        for mode in found.iter().filter(|mode| mode.angular_frequency != 0.0) {
            let square = mode.angular_frequency * mode.angular_frequency.abs();
            let expected = k * k * (euler + force) / 2.0;
            assert!((square - expected).abs() < 0.01 * k * k * euler / 2.0, "{force}: {square} {expected}");
        }
    }
}

/// A body that is set in motion with the velocity of a mode returns to it after the period, as far as an amplitude of
/// 1e-7 is linear and steps of order 6 are accurate.
#[test]
fn the_motion_of_a_mode_has_its_period() {
    let beam =
        body(brick(CellKind::Hex20, [6.0, 1.0, 1.5], [4, 1, 1]), 100.0, 0.3, &[Support::fixed("x-min")]);
    for mode in &modes(&beam, 4).unwrap() {
        let mut state = State::initial(&beam, 0.0, &[]).unwrap();
        state.velocity = mode.shape.iter().map(|v| 1e-7 * v).collect();
        beam.mass_product(&state.velocity, &mut state.momentum);
        let start = state.velocity.clone();
        let scheme = TimeElement::discrete_gradient(3).unwrap();
        let settings = NewtonSettings::default();
        let mut motion = Motion::starting(&beam, scheme, settings, state).unwrap();
        (0..16).for_each(|_| _ = motion.step(mode.period() / 16.0).unwrap());
        // Phase error (omega h)^6/100800 of each step: 2.3e-7 in all.
        let error = motion.state().velocity.iter().zip(&start).map(|(v, start)| (v - start).abs());
        let size = start.iter().fold(0.0f64, |size, v| size.max(v.abs()));
        assert!(error.fold(0.0, f64::max) < 1e-5 * size);
        let displacement = motion.state().displacement.iter().fold(0.0f64, |largest, u| largest.max(u.abs()));
        assert!(displacement * mode.angular_frequency < 1e-5 * size);
    }
}

/// All modes of a small body: `V^T M V = 1`, the effective masses sum to the mass, residuals are small.
#[test]
fn all_modes_of_a_small_body_are_orthonormal() {
    let cube = body(brick(CellKind::Hex20, [1.0, 2.0, 1.0], [1, 2, 1]), 100.0, 0.3, &[]);
    let n = cube.n_dofs();
    let found = modes(&cube, n).unwrap();
    assert_eq!(found.len(), n);
    let mut product = vec![0.0; n];
    for (i, mode) in found.iter().enumerate() {
        cube.mass_product(&mode.shape, &mut product);
        for (j, other) in found.iter().enumerate() {
            let entry: f64 = product.iter().zip(&other.shape).map(|(p, v)| p * v).sum();
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((entry - expected).abs() < 1e-11, "{i}, {j}: {entry}");
        }
        assert!(mode.residual < 1e-8, "{i}: {}", mode.residual);
        let largest = mode.shape.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        assert!(mode.shape.contains(&largest), "the largest component is positive");
    }
    for axis in 0..3 {
        close(found.iter().map(|mode| mode.effective_mass[axis]).sum(), 4.0, 1e-10);
    }
}

#[test]
fn rigid_modes_are_counted() {
    let rigid = |body: &Body| n_rigid(&modes(body, body.n_free_dofs().min(20)).unwrap());
    let plane = Body::builder(mesh::rectangle([2.0, 1.0], [4, 2]).unwrap());
    let plane = plane.region(Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0)).build().unwrap();
    assert_eq!(rigid(&plane), 3);
    let mut two = MeshBuilder::new();
    let block = mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    for shift in [0, block.n_nodes() as u32] {
        block.points().iter().for_each(|X| _ = two.point([X[0] + f64::from(5 * shift), X[1], X[2]]));
        for cell in block.cells() {
            two.cell(cell.kind, &cell.nodes.iter().map(|node| node + shift).collect::<Vec<_>>()).unwrap();
        }
    }
    assert_eq!(rigid(&body(two.build().unwrap(), 10.0, 0.2, &[])), 12);
    // A beam whose lowest elastic modes are 10^-11 of its highest ones, in omega^2.
    assert_eq!(rigid(&body(brick(CellKind::Hex20, [100.0, 1.0, 1.0], [80, 2, 2]), 10.0, 0.2, &[])), 6);
    // Rollers leave three.
    let rollers = Support::of_components("x-min", [true, false, false]);
    assert_eq!(rigid(&body(brick(CellKind::Hex8, [2.0, 1.0, 1.0], [4, 2, 2]), 10.0, 0.2, &[rollers])), 3);
}

/// A cube of St. Venant-Kirchhoff material in a fluid, at the stretch l with pressure p = -(3 lambda + 2 mu)(l^2 -
/// 1)/(2 l): its rigid modes need no force, because the stiffness of the pressure balances the stiffness of the stress.
#[test]
fn a_body_under_pressure_keeps_its_rigid_modes() {
    let (lambda, mu, l) = (20.0, 10.0, 0.95);
    let pressure = -(3.0 * lambda + 2.0 * mu) * (l * l - 1.0) / (2.0 * l);
    let mesh = mesh::block([1.0, 2.0, 1.0], [2, 3, 2]).unwrap();
    let material = SaintVenantKirchhoff::new(lambda, mu).unwrap();
    let faces = ["x-min", "x-max", "y-min", "y-max", "z-min", "z-max"];
    let loads: Vec<Load> = faces.iter().map(|face| Load::pressure(*face, pressure)).collect();
    let body = Body::builder(mesh).region(Region::new(material, 1.0)).loads(&loads).build().unwrap();
    let displacement: Vec<f64> = body.mesh().points().iter().flatten().map(|X| (l - 1.0) * X).collect();
    let state = State { displacement, ..State::initial(&body, 0.0, &[]).unwrap() };
    let found = frequencies(&modes_about(&body, &state, 10).unwrap());
    assert!(found[..6].iter().all(|omega| *omega == 0.0) && found[6] > 0.1, "{found:?}");
    // Without loads: the modes about the reference configuration are those of an unloaded body.
    let unloaded = Body::builder(mesh::block([1.0, 2.0, 1.0], [2, 3, 2]).unwrap());
    let unloaded = unloaded.region(Region::new(material, 1.0)).build().unwrap();
    assert_eq!(modes(&body, 10).unwrap(), modes(&unloaded, 10).unwrap());
}

#[test]
fn there_are_as_many_modes_as_free_degrees_of_freedom() {
    let mesh = || brick(CellKind::Hex8, [1.0; 3], [1; 3]);
    let held = body(mesh(), 10.0, 0.2, &[Support::fixed("x-min")]);
    assert_eq!(modes(&held, 12).unwrap().len(), 12);
    assert_eq!(modes(&held, 13), Err(Error::TooManyModes { count: 13, free: 12 }));
}

/// The largest frequency of a body is at most that of a cell, and the bound of a cell is close for well-shaped ones.
#[test]
fn cells_bound_the_largest_frequency() {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Hex27] {
        for (distortion, least) in [(0.0, 0.5), (0.1, 0.3)] {
            let plain = brick(kind, [2.0, 1.0, 1.0], [4, 2, 2]);
            let mut builder = MeshBuilder::new();
            for [x, y, z] in plain.points() {
                let wave = |s: f64, t: f64| distortion * (5.0 * s).sin() * (3.0 * t + 1.0).cos();
                builder.point([x + wave(*y, *z), y + wave(*z, *x), z + wave(*x, *y)]);
            }
            plain.cells().for_each(|cell| _ = builder.cell(cell.kind, cell.nodes).unwrap());
            check_bound(&body(builder.build().unwrap(), 100.0, 0.3, &[]), least);
        }
    }
    let steel = || Region::new(NeoHooke::from_engineering(100.0, 0.3).unwrap(), 2.0);
    let plane =
        Body::builder(mesh::rectangle([3.0, 1.0], [6, 3]).unwrap()).region(steel().with_thickness(1e-3));
    check_bound(&plane.build().unwrap(), 0.5);
    check_bound(&Body::builder(mesh::l_block(1.0).unwrap()).region(steel()).build().unwrap(), 0.5);
    // Links and springs have stiffness without mass of their own.
    let link = Region::links(Link::spring(3.0, None).unwrap(), 0.0);
    let nodal = PointTerms { masses: masses(&[1.0, 1.0]), ..Default::default() };
    let pair =
        Body::builder(network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]])).region(link).point_terms(nodal);
    assert_eq!(pair.build().unwrap().frequency_bound(), Ok(None));
}

/// Compares the bound of a body with its largest frequency, by power iteration to six digits.
fn check_bound(body: &Body, least: f64) {
    let [critical, _] = CentralDifferences::critical_steps(body, &vec![0.0; body.n_dofs()]).unwrap();
    let bound = 2.0 / body.frequency_bound().unwrap().unwrap().sqrt();
    assert!(bound < critical * (1.0 + 1e-3) && bound > least * critical, "{bound} {critical}");
}

/// The L-shaped block of rubber, held at one end.
fn held_l_block() -> Body {
    let mesh = mesh::l_block(1.0).unwrap();
    body(mesh, 1000.0, 0.3, &[Support::fixed("face-a")])
}

/// The same matrices by SciPy 1.17, `eigsh` with shift-and-invert: `modes.py` beside this file.
#[test]
fn scipy_finds_the_same_eigenvalues() {
    let found = modes(&held_l_block(), 12).unwrap();
    for (mode, expected) in found.iter().zip(SCIPY) {
        close(mode.angular_frequency.powi(2), expected, 1e-8);
        assert!(mode.residual < 1e-10, "{}", mode.residual);
    }
}

const SCIPY: [f64; 12] = [
    0.231_864_518_781_1,
    0.233_406_990_950_9,
    1.328_985_619_016,
    3.512_243_064_061,
    8.263_900_641_303,
    11.212_747_313_78,
    26.749_904_515_30,
    28.648_383_634_12,
    30.728_491_667_93,
    68.303_295_703_10,
    74.808_224_568_51,
    78.201_135_539_67,
];

/// Writes the matrices for `modes.py`: rows of indices of free degrees of freedom, K and M.
#[test]
#[ignore = "writes a file for modes.py"]
fn matrices_for_scipy() {
    let Some(file) = std::env::var_os("EMMY_MATRICES") else { return };
    let body = held_l_block();
    let rule = Rule::standard(1, &Quadrature { points: vec![[1.0]], weights: vec![1.0] });
    let rest = vec![0.0; body.n_dofs()];
    let step = StepInput {
        rule: &rule,
        tangent_factor: 1.0,
        displacement: &rest,
        rates: &rest,
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    let mut assembly = body.assembly(step.rule);
    body.assemble(&step, Request::Tangent, &[0.0], &mut assembly).unwrap();
    let mut text = String::new();
    for row in 0..body.n_dofs() {
        for (position, &node) in body.pattern().range(row / 3).zip(body.pattern().row(row / 3)) {
            for (d, column) in (3 * node as usize..).take(3).enumerate() {
                if !body.fixed()[row] && !body.fixed()[column] {
                    let stiffness = assembly.matrix.block(position)[3 * (row % 3) + d];
                    let mass = if d == row % 3 { body.mass()[position] } else { 0.0 };
                    text += &format!("{row} {column} {stiffness:e} {mass:e}\n");
                }
            }
        }
    }
    std::fs::write(file, text).unwrap();
}
