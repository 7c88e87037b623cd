//! Follower pressure: its effect on energy and momenta, for every kind of facet and every family of schemes.

#![allow(non_snake_case)]

use std::collections::HashMap;

use crate::shared::patch::Patch;
use crate::shared::schemes::{DGM, at};
use emmy::Error;
use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, Support, TimeFunction};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{Sampling, Span, StepDamping, StepInput};
use emmy::internals::element::facet_element;
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, Mesh, MeshBuilder, Share};
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::team::Threads;
use emmy::time::Scheme;

const PRESSURE: f64 = 80.0;

/// Square of the size of a step.
const H2: f64 = 0.04;

fn pressure(group: &str, time_function: TimeFunction) -> Load {
    Load { kind: LoadKind::Pressure { group: group.into(), pressure: PRESSURE }, time_function }
}

fn body(mesh: Mesh, supports: &[Support], load: Load) -> Body {
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0);
    Body::builder(mesh).region(rubber).supports(supports).load(load).build().unwrap()
}

/// A patch whose whole surface is a group, its bricks distorted.
fn cube(kind: CellKind) -> Mesh {
    Patch { bricks: if kind.n_nodes() > 10 { 1 } else { 2 }, curved: true, distortion: 1.0 }.mesh(kind)
}

/// A cube of 3 x 3 x 3 bricks without the one in the middle; the facets around the hole are the group `cavity`.
fn hollow() -> Mesh {
    let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
    let reference = emmy::internals::element::element(CellKind::Hex8).nodes();
    for at in (0..27).map(|at| [at / 9, at / 3 % 3, at % 3]).filter(|&at| at != [1, 1, 1]) {
        let corners: Vec<u32> = reference
            .iter()
            .map(|xi| {
                let grid = [0, 1, 2].map(|d| at[d] + usize::from(xi[d] > 0.0));
                *nodes.entry(grid).or_insert_with(|| builder.point(grid.map(|x| x as f64 / 3.0)))
            })
            .collect();
        builder.cell(CellKind::Hex8, &corners).unwrap();
    }
    let mesh = builder.clone().build().unwrap();
    let inside = |node: u32| mesh.points()[node as usize].iter().all(|&x| x > 0.1 && x < 0.9);
    let facets = (0..mesh.n_cells() as u32)
        .flat_map(|cell| (0..6).map(move |local| emmy::mesh::Facet { cell, local }))
        .filter(|&facet| mesh.facet_nodes(facet).all(inside));
    builder.facet_group("cavity", facets.collect::<Vec<_>>());
    builder.build().unwrap()
}

/// A block of two bricks along x, or of two rectangles, with the facet between them as the group `between`.
fn divided(is_plane: bool) -> Mesh {
    let block = match is_plane {
        true => emmy::mesh::rectangle([2.0, 1.0], [2, 1]).unwrap(),
        false => emmy::mesh::block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap(),
    };
    let mut builder = MeshBuilder::new();
    block.points().iter().for_each(|&point| _ = builder.point(point));
    block.cells().for_each(|cell| _ = builder.cell(cell.kind, cell.nodes).unwrap());
    let middle = |node: &u32| block.points()[*node as usize][0] == 1.0;
    builder.facet_group_by_nodes("between", vec![(0..block.n_nodes() as u32).filter(middle).collect()]);
    builder.facet_group("x-max", block.groups().facets("x-max").unwrap().iter().copied());
    builder.build().unwrap()
}

#[test]
fn a_pressure_between_cells_is_rejected_on_any_number_of_ranks() {
    let rubber = || Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0);
    for is_plane in [false, true] {
        let mesh = divided(is_plane);
        let build = |group: &str| {
            Body::builder(mesh.clone()).region(rubber()).load(Load::pressure(group, 3.0)).build().map(drop)
        };
        assert_eq!(build("x-max"), Ok(()));
        let at = [1.0, 0.5, if is_plane { 0.0 } else { 0.5 }];
        assert_eq!(build("between"), Err(Error::PressureInside { group: "between".into(), at }));
        // Each rank has one end, and the nodes between belong to the first or to the second.
        for owner_between in [0, 1] {
            let owner = |&[x, ..]: &[f64; 3]| if x == 1.0 { owner_between } else { u32::from(x > 1.0) };
            let owners: Vec<u32> = mesh.points().iter().map(owner).collect();
            let messages = Threads::run(2, |team| {
                let share = Share::new(&mesh, &owners, team.rank());
                let body = Body::shared(share, team).region(rubber()).load(Load::pressure("between", 3.0));
                body.build().unwrap_err().to_string()
            });
            for message in messages.unwrap() {
                assert!(message.contains("has cells on both sides"), "{message}");
            }
        }
    }
}

/// Volume enclosed by the facets of a group, by Gauss' theorem; positive if their normals point outward.
fn enclosed_volume(body: &Body, group: &str, state: &State) -> f64 {
    let mesh = body.mesh();
    let mut volume = 0.0;
    for &facet in mesh.groups().facets(group).unwrap() {
        let kind = mesh.cell(facet.cell as usize).kind.facets()[facet.local as usize].kind;
        let (element, n) = (facet_element(kind), kind.n_nodes());
        let q: Vec<[f64; 3]> =
            mesh.facet_nodes(facet).map(|node| state.position(body, node as usize)).collect();
        let (mut N, mut dN) = (vec![0.0; n], vec![[0.0; 2]; n]);
        for (&xi, weight) in element.quadrature().iter() {
            element.shape(xi, &mut N);
            element.gradient(xi, &mut dN);
            let sum = |of: &dyn Fn(usize) -> f64| {
                (0..n).fold([0.0; 3], |sum, A| [0, 1, 2].map(|i| sum[i] + of(A) * q[A][i]))
            };
            let (x, a, b) = (sum(&|A| N[A]), sum(&|A| dN[A][0]), sum(&|A| dN[A][1]));
            let triple: f64 = (0..3)
                .map(|i| x[i] * (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]))
                .sum();
            volume += weight * triple / 3.0;
        }
    }
    volume
}

fn start(body: &Body) -> State {
    let field = InitialVelocity {
        velocity: [1.0, 0.0, 0.5],
        angular_velocity: [3.0, 2.0, 5.0],
        gradient: [[3.0, 1.0, 0.0], [0.0, -2.0, 0.0], [1.0, 0.0, 1.0]],
        ..Default::default()
    };
    State::initial(body, 0.0, &[field]).unwrap()
}

/// Records of n steps of a size, and the enclosed volume after each.
fn flight(body: &Body, group: &str, scheme: &str, k: usize, steps: (usize, f64)) -> Vec<(Record, f64)> {
    flight_with(NewtonSettings::default(), body, group, (scheme, k), steps)
}

fn flight_with(
    settings: NewtonSettings,
    body: &Body,
    group: &str,
    (scheme, k): (&str, usize),
    (n, h): (usize, f64),
) -> Vec<(Record, f64)> {
    let scheme: Scheme = scheme.parse().unwrap();
    let mut motion = Motion::starting(body, at(scheme, k), settings, start(body)).unwrap();
    let mut records = vec![(motion.record().clone(), enclosed_volume(body, group, motion.state()))];
    for _ in 1..=n {
        let record = motion.step(h).unwrap().clone();
        records.push((record, enclosed_volume(body, group, motion.state())));
    }
    records
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

/// A constant pressure p on a closed surface has the potential p V with the enclosed volume V: T + V + p V and the
/// linear momentum are conserved, and the balances close.
fn keeps_the_sum(body: &Body, group: &str, scheme: &str, k: usize) {
    let flight = flight(body, group, scheme, k, (15, 0.01));
    let sum = |(record, volume): &(Record, f64)| record.total_energy + PRESSURE * volume;
    let (first, size) = (sum(&flight[0]), flight[0].0.total_energy + PRESSURE);
    let name = format!("{} {scheme} k = {k}", body.mesh().cell(0).kind);
    for at in &flight {
        assert!((sum(at) - first).abs() < 1e-12 * size, "{name}: {} is not {first}", sum(at));
        assert!(at.0.energy_residual.abs() < 1e-12 * size, "{name}: {:?}", at.0);
        assert!(at.0.angular_momentum_residual < 1e-12 * size, "{name}: {:?}", at.0);
        assert!(distance(at.0.linear_momentum, flight[0].0.linear_momentum) < 1e-12 * size, "{name}");
    }
    let spread = flight.iter().map(|(_, v)| (v - flight[0].1).abs()).fold(0.0, f64::max);
    assert!(spread > 0.01 * flight[0].1.abs(), "{name}: the volume hardly changes: {spread}");
}

#[test]
fn pressure_around_a_body_has_a_potential_for_every_kind_of_facet() {
    for kind in CellKind::SOLIDS {
        let body = body(cube(kind), &[], pressure("surface", TimeFunction::constant()));
        (1..=2).for_each(|k| keeps_the_sum(&body, "surface", "DGM", k));
    }
}

/// For the neo-Hookean material many inner points make AS exact up to round-off.
#[test]
fn pressure_in_a_cavity_has_a_potential() {
    let body = body(hollow(), &[], pressure("cavity", TimeFunction::constant()));
    for (scheme, k) in [("DGM", 1), ("DGM", 2), ("DGM", 3), ("AS(12)", 1), ("AS(12)", 2)] {
        keeps_the_sum(&body, "cavity", scheme, k);
    }
}

/// Change of the angular momentum over t = 0.04 in n steps, over its norm.
fn drift(body: &Body, scheme: &str, k: usize, n: usize) -> f64 {
    let flight = flight(body, "surface", scheme, k, (n, 0.04 / n as f64));
    let (first, last) = (flight[0].0.angular_momentum, flight[n].0.angular_momentum);
    distance(last, first) / distance(first, [0.0; 3])
}

/// FE(k) evaluates the pressure at the k Gauss points, where a closed surface of any shape has no moment.
#[test]
fn closed_surfaces_have_no_moment_with_fe_k() {
    let body = body(cube(CellKind::Hex20), &[], pressure("surface", TimeFunction::constant()));
    for k in 1..=3 {
        assert!(drift(&body, &format!("FE({k})"), k, 10) < 1e-12, "k = {k}");
    }
}

/// With averages of exact work, the moment of a closed surface is of order 2k in the step.
#[test]
fn moments_of_closed_surfaces_are_of_order_2k_with_dgm() {
    let body = body(cube(CellKind::Hex8), &[], pressure("surface", TimeFunction::constant()));
    for (k, n) in [(1, 10), (2, 5)] {
        let (coarse, fine) = (drift(&body, "DGM", k, n), drift(&body, "DGM", k, 2 * n));
        let order = (coarse / fine).log2();
        assert!((order - 2.0 * k as f64).abs() < 0.3, "k = {k}: {coarse:e} {fine:e}, order {order}");
    }
}

/// A time function with a kink and a jump inside steps, one face, a clamped one: work and reactions close the balances.
#[test]
fn balances_close_with_time_functions_and_supports() {
    let time_function =
        TimeFunction::new(vec![(0.0, 0.0), (0.033, 1.0), (0.071, 1.0), (0.071, -0.5), (0.2, 0.3)]).unwrap();
    let clamp = Support { group: "x-min".into(), fix: [true; 3], ..Default::default() };
    for kind in [CellKind::Hex8, CellKind::Tet10] {
        let body = body(cube(kind), std::slice::from_ref(&clamp), pressure("x-max", time_function.clone()));
        for (scheme, k) in [("DGM", 1), ("DGM", 2), ("AS(12)", 2)] {
            for (record, _) in flight(&body, "surface", scheme, k, (15, 0.01)) {
                assert!(record.energy_residual.abs() < 1e-11, "{kind} {scheme} {k}: {record:?}");
                assert!(record.linear_momentum_residual < 1e-11, "{kind} {scheme} {k}: {record:?}");
                assert!(record.angular_momentum_residual < 1e-11, "{kind} {scheme} {k}: {record:?}");
            }
        }
    }
}

/// A step of size 0.2.
fn step_at<'a>(rule: &'a Rule, displacement: &'a [f64], rates: &'a [f64]) -> StepInput<'a> {
    let damping = StepDamping::default();
    StepInput { rule, tangent_factor: H2, displacement, rates, coordinates: &[], damping, local: None }
}

/// The derivatives in the stage matrix belong to the stage averages, which are quadratic in the rates: their central
/// difference is exact for any step.
#[test]
fn tangent_is_consistent() {
    let kind = CellKind::Wedge15;
    let grows = TimeFunction::new(vec![(0.0, 1.0), (1.0, 2.0)]).unwrap();
    let body = body(cube(kind), &[], pressure("surface", grows));
    let n = body.n_dofs();
    let noise = |i: usize, seed: f64| 0.1 * ((i as f64 + seed) * 0.618_034).fract();
    for rule in [Rule::discrete_gradient(1), Rule::discrete_gradient(2)] {
        let k = rule.degree();
        let displacement: Vec<f64> = (0..n).map(|i| noise(i, 1.0)).collect();
        let rates: Vec<f64> = (0..k * n).map(|i| noise(i, 2.0)).collect();
        let direction: Vec<f64> = (0..k * n).map(|i| noise(i, 3.0) - 0.05).collect();
        let mut assembly = body.assembly(&rule);
        body.begin(&rule, (Span::new(0.0, 1.0), Sampling::Averages), &[], &mut assembly).unwrap();
        let mut force = |step: f64| {
            let rates: Vec<f64> = rates.iter().zip(&direction).map(|(x, d)| x + step * d).collect();
            body.evaluate_external(&step_at(&rule, &displacement, &rates), &mut assembly).unwrap();
            assembly.external_parts()[1].to_vec()
        };
        let (plus, minus) = (force(0.5), force(-0.5));
        let step = step_at(&rule, &displacement, &rates);
        body.assemble(&step, Request::Tangent, &vec![0.0; k * k], &mut assembly).unwrap();
        let mut product = |add: bool| {
            if add {
                body.add_external_tangent(&step, &mut assembly).unwrap();
            }
            let mut product = vec![0.0; k * n];
            assembly.matrix.multiply(body.pattern(), &direction, &mut product);
            product
        };
        let (without, with) = (product(false), product(true));
        for i in 0..k * n {
            let expected = -H2 * (plus[i] - minus[i]);
            assert!((with[i] - without[i] - expected).abs() < 1e-11, "k = {k}, {i}: {expected}");
        }
    }
}

/// A strong pressure on one face is solved with Newton's quadratic convergence: three iterations and one or two
/// corrections after them.
#[test]
fn newton_converges_quadratically() {
    let clamp = Support { group: "x-min".into(), fix: [true; 3], ..Default::default() };
    let body = body(cube(CellKind::Hex8), &[clamp], pressure("x-max", TimeFunction::constant()));
    for (scheme, k) in [("DGM", 1), ("DGM", 2), ("FE(1)", 1), ("Newmark(0.25, 0.5)", 1), ("HHT(0.1)", 1)] {
        let settings = NewtonSettings { exact_tangent: true, ..Default::default() };
        let flight = flight_with(settings, &body, "surface", (scheme, k), (15, 0.01));
        let worst = flight.iter().map(|(record, _)| record.newton_iterations).max().unwrap();
        assert!(worst <= 5, "{scheme} {k}: {worst}");
    }
}

/// Every scheme keeps its order with a pressure that changes in time, on one face only.
#[test]
fn orders_in_time() {
    let time_function = TimeFunction::smooth("cos(8 t)", |t| {
        [(8.0 * t).cos(), -8.0 * (8.0 * t).sin(), -64.0 * (8.0 * t).cos()]
    });
    let body = body(emmy::mesh::block([1.0; 3], [1; 3]).unwrap(), &[], pressure("z-max", time_function));
    let orders = [
        ("DGM", 1, 8, 2.0),
        ("DGM", 2, 6, 4.0),
        ("DGM", 3, 5, 6.0),
        ("AS(3)", 2, 6, 4.0),
        ("FE(1)", 1, 8, 2.0),
        ("FE(2)", 2, 6, 4.0),
        ("trapezoidal", 1, 8, 2.0),
        ("Lobatto(4)", 2, 6, 4.0),
        ("Newmark(0.25, 0.5)", 1, 16, 2.0),
        ("HHT(0.1)", 1, 16, 2.0),
        ("generalized-alpha(0.8)", 1, 16, 2.0),
        ("Bathe", 1, 16, 2.0),
        ("central-differences", 1, 32, 2.0),
    ];
    for (scheme, k, n, expected) in orders {
        let end = |n: usize| {
            let scheme: Scheme = scheme.parse().unwrap();
            let settings = NewtonSettings { tolerance: 1e-13, ..Default::default() };
            let mut motion = Motion::starting(&body, at(scheme, k), settings, start(&body)).unwrap();
            let h = 0.04 / n as f64;
            (1..=n).for_each(|_| {
                motion.step(h).unwrap();
            });
            motion.state().displacement.clone()
        };
        let difference =
            |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let (coarse, middle, fine) = (end(n), end(2 * n), end(4 * n));
        let order = (difference(&coarse, &middle) / difference(&middle, &fine)).log2();
        assert!((order - expected).abs() < 0.1, "{scheme} k = {k}: order {order}");
    }
}

/// In plane strain the enclosed volume is area times thickness; the pressure acts on edges.
#[test]
fn pressure_around_a_plane_body_has_a_potential() {
    let sides = ["x-min", "x-max", "y-min", "y-max"];
    let loads = sides.map(|group| pressure(group, TimeFunction::constant()));
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0).with_thickness(0.5);
    let mesh = emmy::mesh::rectangle([1.0, 1.0], [2, 2]).unwrap();
    let body = Body::builder(mesh).region(rubber).loads(&loads).build().unwrap();
    // Area by the shoelace formula over the nodes of the boundary, in the order of the edges.
    let area = |state: &State| -> f64 {
        let edges = sides.iter().flat_map(|group| body.mesh().groups().facets(group).unwrap());
        let part = |&facet: &emmy::mesh::Facet| {
            let q: Vec<[f64; 3]> =
                body.mesh().facet_nodes(facet).map(|node| state.position(&body, node as usize)).collect();
            0.5 * (q[0][0] * q[1][1] - q[1][0] * q[0][1])
        };
        edges.map(part).sum()
    };
    for k in 1..=2 {
        let scheme = DGM;
        let mut motion =
            Motion::starting(&body, at(scheme, k), NewtonSettings::default(), start(&body)).unwrap();
        let sum = |motion: &Motion<'_>| motion.record().total_energy + 0.5 * PRESSURE * area(motion.state());
        let (first, volume) = (sum(&motion), area(motion.state()));
        for _ in 1..=15 {
            motion.step(0.01).unwrap();
            assert!((sum(&motion) - first).abs() < 1e-12 * first, "k = {k}: {} is not {first}", sum(&motion));
        }
        assert!((area(motion.state()) - volume).abs() > 0.005, "k = {k}");
    }
}
