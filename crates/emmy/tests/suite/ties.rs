//! Ties: bodies whose parts have meshes of their own.

#![allow(non_snake_case)]

use std::collections::HashMap;

use crate::shared::faces::with_faces;
use crate::shared::schemes::{DGM, assumed_strain, at, dgm, fe};
use emmy::body::{BodyBuilder, Formulation, GroundSpring, PointTerms, Viscosity};
use emmy::equilibrium::Equilibrium;
use emmy::internals::sparse::Solver;
use emmy::mesh::{Facet, MeshBuilder};
use emmy::modes::modes;
use emmy::motion::{Adaptivity, NewtonSettings};
use emmy::prelude::*;

/// Adds a block of hexahedra or of six tetrahedra a cell, with nodes of its own unless `shared` has them.
fn add_block(
    mesh: &mut MeshBuilder,
    kind: CellKind,
    [low, high]: [[f64; 3]; 2],
    cells: [usize; 3],
    shared: &mut HashMap<[i64; 3], u32>,
) {
    let size = [0, 1, 2].map(|d| (high[d] - low[d]) / cells[d] as f64);
    let element = emmy::internals::element::element(kind);
    let linear = emmy::internals::element::element(kind.linear());
    for (i, j, k) in (0..cells.iter().product())
        .map(|at: usize| (at / (cells[1] * cells[2]), at / cells[2] % cells[1], at % cells[2]))
    {
        for corners in crate::shared::cells::cells_of_a_brick(kind) {
            let mut N = vec![0.0; corners.len()];
            let nodes = element.nodes().iter().map(|&xi| {
                linear.shape(xi, &mut N);
                let origin = [i as f64, j as f64, k as f64];
                let X = [0, 1, 2].map(|d| {
                    let inside: f64 = corners.iter().zip(&N).map(|(c, N)| N * c[d]).sum();
                    low[d] + size[d] * (origin[d] + inside)
                });
                let key = X.map(|x| (x * 1e6).round() as i64);
                *shared.entry(key).or_insert_with(|| mesh.point(X))
            });
            let nodes: Vec<u32> = nodes.collect();
            mesh.cell(kind, &nodes).unwrap();
        }
    }
}

/// Two blocks 2 x 2 x 1 on each other, the interface at z = 1, with faces `lower-face` and `upper-face`; and groups of
/// cells `lower` and `upper`.
fn blocks(kinds: [CellKind; 2], n: [usize; 2], is_merged: bool) -> Mesh {
    let mut mesh = MeshBuilder::new();
    let mut nodes = HashMap::new();
    let mut numbers = Vec::new();
    for (level, (kind, n)) in kinds.into_iter().zip(n).enumerate() {
        if !is_merged {
            nodes.clear();
        }
        let z = level as f64;
        let before = mesh.clone().build().map_or(0, |mesh| mesh.n_cells());
        add_block(&mut mesh, kind, [[0.0, 0.0, z], [2.0, 2.0, z + 1.0]], [n, n, 2], &mut nodes);
        numbers.push(before as u32..mesh.clone().build().unwrap().n_cells() as u32);
    }
    mesh.cell_group("lower", numbers[0].clone());
    mesh.cell_group("upper", numbers[1].clone());
    let all = mesh.clone().build().unwrap();
    // Faces of one block by its cells: both lie in the same plane.
    for (name, cells) in [("lower-face", &numbers[0]), ("upper-face", &numbers[1])] {
        let facets = cells.clone().flat_map(|cell| {
            let locals = 0..all.cell(cell as usize).kind.facets().len() as u8;
            locals.map(move |local| Facet { cell, local })
        });
        let on = |node: u32| (all.points()[node as usize][2] - 1.0).abs() < 1e-9;
        mesh.facet_group(name, facets.filter(|&facet| all.facet_nodes(facet).all(on)).collect::<Vec<_>>());
    }
    with_faces(mesh, &[("floor", &|X| X[2] == 0.0), ("roof", &|X| X[2] == 2.0), ("side", &|X| X[0] == 2.0)])
}

const HEX8: [CellKind; 2] = [CellKind::Hex8; 2];

fn rubber() -> Region {
    Region::new(NeoHooke::new(4000.0, 2000.0).unwrap(), 1.0)
}

/// Nearly incompressible rubber.
fn projected() -> Region {
    let rubber = Region::new(NeoHooke::new(2e6, 2000.0).unwrap(), 1.0);
    rubber.with_formulation(Formulation::ProjectedVolume(None))
}

fn tie() -> Tie {
    Tie::nodes("upper-face", "lower-face")
}

/// A spin about the centre with a stretch.
fn flight() -> InitialVelocity {
    InitialVelocity {
        velocity: [-0.05, 0.03, -0.02],
        angular_velocity: [0.5, 0.3, 1.0],
        about: [1.0; 3],
        gradient: [[0.05, 0.0, 0.0], [0.0, -0.03, 0.0], [0.0, 0.0, 0.02]],
        ..Default::default()
    }
}

fn nodes_at(mesh: &Mesh, X: [f64; 3]) -> Vec<usize> {
    let is_there = |point: &[f64; 3]| (0..3).all(|d| (point[d] - X[d]).abs() < 1e-9);
    (0..mesh.n_nodes()).filter(|&node| is_there(&mesh.points()[node])).collect()
}

/// Numbers of an independent implementation, by mortar and with nodes tied to facets.
#[test]
fn two_blocks_in_flight_move_as_elsewhere() {
    let by = |kind| Tie { kind: Some(kind), ..Tie::new("upper-face", "lower-face") };
    let body = |kind| Body::builder(blocks(HEX8, [2, 3], false)).region(rubber()).tie(by(kind)).build();
    for (kind, k, h, kinetic, strain, upper, lower) in [
        (
            TieKind::Mortar,
            1,
            0.05,
            3.573158883791574,
            0.005241116208426446,
            [1.2494903582265913, 2.0386515972947086, 2.363306591223248],
            [0.7507404218687413, -0.038626594418302095, -0.36332055701671084],
        ),
        (
            TieKind::Mortar,
            2,
            0.1,
            3.5741960677359015,
            0.004203932264100575,
            [1.2500162727514186, 2.0382230192105766, 2.363432640967401],
            [0.7497449271323341, -0.03815044378827872, -0.36352281741941256],
        ),
        (
            TieKind::Nodes,
            1,
            0.05,
            3.5731681421821877,
            0.005231857817814051,
            [1.2494824942070304, 2.0386599312944957, 2.363332993942927],
            [0.7507362278964319, -0.03859013624627416, -0.36332140173107536],
        ),
        (
            TieKind::Nodes,
            2,
            0.1,
            3.574166510508787,
            0.004233489491215374,
            [1.2500409352099247, 2.0381558041519985, 2.363446878176956],
            [0.7497704564018619, -0.03824817400858922, -0.36349243242105894],
        ),
    ] {
        let body = body(kind).unwrap();
        assert_eq!(body.ties()[0].kind, kind);
        let state = State::initial(&body, 0.0, &[flight()]).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, k), NewtonSettings::default(), state).unwrap();
        while motion.time() < 1.0 - 1e-9 {
            let record = motion.step(h).unwrap();
            assert!(record.energy_residual.abs() < 1e-14 && record.linear_momentum_residual < 1e-14);
            assert!(record.angular_momentum_residual < 2e-14, "{record:?}");
        }
        let record = motion.record();
        assert!((record.kinetic_energy - kinetic).abs() < 1e-9, "{}", record.kinetic_energy);
        assert!((record.strain_energy - strain).abs() < 1e-9, "{}", record.strain_energy);
        for (component, expected) in record.angular_momentum.into_iter().zip([8.0 / 3.0, 1.6, 16.0 / 3.0]) {
            assert!((component - expected).abs() < 1e-13);
        }
        for (X, expected) in [([2.0; 3], upper), ([0.0; 3], lower)] {
            let node = nodes_at(body.mesh(), X)[0];
            let q = motion.state().position(&body, node);
            assert!((0..3).all(|d| (q[d] - expected[d]).abs() < 1e-8), "k = {k}: {q:?}");
        }
    }
}

/// A body, for a comparison of ties with a mesh that is one.
struct Case {
    name: &'static str,
    scheme: Scheme,
    kind: CellKind,
    region: fn() -> Region,
    build: fn(BodyBuilder) -> BodyBuilder,
    start: InitialVelocity,
    h: f64,
    solver: Solver,
}

impl Case {
    fn new(name: &'static str, scheme: Scheme) -> Self {
        let start = flight();
        Case {
            name,
            scheme,
            kind: CellKind::Hex8,
            region: rubber,
            build: |body| body,
            start,
            h: 0.02,
            solver: Solver::Auto,
        }
    }

    fn body(&self, is_merged: bool) -> Body {
        let mesh = blocks([self.kind; 2], [2, 2], is_merged);
        let body = (self.build)(Body::builder(mesh).region((self.region)()));
        if is_merged { body.build().unwrap() } else { body.tie(tie()).build().unwrap() }
    }

    /// Ten steps of both: every node and balance agrees.
    fn compare(&self) {
        let bodies = [true, false].map(|is_merged| self.body(is_merged));
        let settings = NewtonSettings { tolerance: 1e-13, solver: self.solver, ..Default::default() };
        let [merged, tied] = bodies.each_ref().map(|body| {
            let body = self.scheme.body(body);
            let state = State::initial(body, 0.0, std::slice::from_ref(&self.start)).unwrap();
            let mut motion = Motion::starting(body, self.scheme, settings, state).unwrap();
            let records: Vec<_> = (0..10).map(|_| motion.step(self.h).unwrap().clone()).collect();
            (records, motion.state().clone(), motion.reactions().to_vec())
        });
        let name = self.name;
        let meshes = bodies.each_ref().map(|body| body.mesh());
        let size = merged.1.displacement.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        let speed = merged.1.velocity.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        for node in 0..meshes[1].n_nodes() {
            let other = nodes_at(meshes[0], meshes[1].points()[node])[0];
            for d in 0..3 {
                let [u, expected] = [tied.1.displacement[3 * node + d], merged.1.displacement[3 * other + d]];
                assert!((u - expected).abs() < 1e-10 * size, "{name}, node {node}: {u} {expected}");
                let [v, expected] = [tied.1.velocity[3 * node + d], merged.1.velocity[3 * other + d]];
                assert!((v - expected).abs() < 1e-8 * speed, "{name}, node {node}: {v} {expected}");
            }
        }
        for (own, expected) in tied.0.iter().zip(&merged.0) {
            let energy = expected.total_energy.abs().max(expected.kinetic_energy);
            assert!((own.total_energy - expected.total_energy).abs() < 1e-11 * energy, "{name}: {own:?}");
            assert!((own.dissipated_energy - expected.dissipated_energy).abs() < 1e-11 * energy, "{name}");
            assert!((own.external_work - expected.external_work).abs() < 1e-11 * energy, "{name}");
            if self.scheme.is_time_element() {
                assert!(
                    (own.energy_residual - expected.energy_residual).abs() < 1e-12 * energy,
                    "{name}: {own:?}"
                );
                assert!(own.angular_momentum_residual < 1e-12, "{name}: {own:?}");
            }
        }
        for (own, expected) in tied.2.iter().zip(&merged.2) {
            let large = expected.force.iter().fold(1.0, |large: f64, f| large.max(f.abs()));
            assert!(
                (0..3).all(|d| (own.force[d] - expected.force[d]).abs() < 1e-8 * large),
                "{name}: {own:?}"
            );
        }
    }
}

/// Every scheme.
#[test]
fn coinciding_nodes_move_as_one_by_every_scheme() {
    let parsed = |name: &str| name.parse::<Scheme>().unwrap();
    for scheme in [
        at(DGM, 1),
        at(DGM, 2),
        at(DGM, 3),
        at(fe(2), 2),
        at(assumed_strain(5), 1),
        dgm(0.5),
        at(dgm(0.8), 2),
        parsed("Newmark(0.25, 0.5)"),
        parsed("HHT(0.05)"),
        parsed("generalized-alpha(0.8)"),
        parsed("Bathe"),
    ] {
        Case::new("scheme", scheme).compare();
    }
    Case { h: 1e-3, ..Case::new("central differences", parsed("central-differences")) }.compare();
}

/// Every solver, formulation, and force across the tie.
#[test]
fn coinciding_nodes_move_as_one_in_every_body() {
    let viscous = || rubber().with_viscosity(Viscosity { time: 0.01, shear: 3.0, ..Default::default() });
    let modes = || rubber().with_formulation(Formulation::IncompatibleModes);
    let held: fn(BodyBuilder) -> BodyBuilder = |body| {
        let pushed = TimeFunction::smooth("0.2*t*t", |t| [0.2 * t * t, 0.4 * t, 0.4]);
        body.support(Support::driven("floor", [Some(pushed), None, None]))
            .support(Support::of_components("floor", [false, true, true]))
    };
    let shaken: fn(BodyBuilder) -> BodyBuilder = |body| {
        let pushed = TimeFunction::smooth("0.2*t*t", |t| [0.2 * t * t, 0.4 * t, 0.4]);
        body.support(Support::driven("lower-face", [Some(pushed), None, None]))
    };
    let loaded: fn(BodyBuilder) -> BodyBuilder = |body| {
        let spring = GroundSpring { group: "upper-face".into(), stiffness: 50.0 };
        body.support(Support::fixed("floor"))
            .load(Load::pressure("side", 30.0))
            .load(Load::acceleration([1.0, 0.0, -9.81]))
            .point_terms(PointTerms {
                masses: vec![PointMass { group: "upper-face".into(), mass: 0.3 }],
                springs: vec![spring],
                ..Default::default()
            })
    };
    // The side is a plane of symmetry through both blocks, with followers on it.
    let halved: fn(BodyBuilder) -> BodyBuilder = |body| {
        let weight = Load::acceleration([0.0, 3.0, -9.81]);
        body.support(Support::fixed("floor")).support(Support::symmetry("side")).load(weight)
    };
    let rest = InitialVelocity::default;
    for k in [1, 2] {
        let case = || Case::new("body", at(DGM, k));
        for solver in [Solver::Direct, Solver::Iterative, Solver::Multigrid] {
            Case { name: "solver", solver, ..case() }.compare();
        }
        Case { name: "viscous", region: viscous, ..case() }.compare();
        Case { name: "projected", region: projected, ..case() }.compare();
        Case { name: "modes of cells", region: modes, ..case() }.compare();
        Case { name: "tet10", kind: CellKind::Tet10, ..case() }.compare();
        Case { name: "drag", build: |body| body.drag(0.3), ..case() }.compare();
        Case { name: "symmetry", build: halved, start: rest(), ..case() }.compare();
        Case { name: "driven leaders", build: shaken, start: rest(), ..case() }.compare();
        Case { name: "driven", build: held, start: rest(), ..case() }.compare();
        Case { name: "loaded", build: loaded, start: rest(), ..case() }.compare();
        let viscous = || projected().with_viscosity(Viscosity { time: 0.01, ..Default::default() });
        Case { name: "loaded, projected, viscous", build: loaded, start: rest(), region: viscous, ..case() }
            .compare();
        Case { name: "driven, modes of cells", build: held, start: rest(), region: modes, ..case() }
            .compare();
    }
}

/// Meshes that do not match: the balances of every step.
#[test]
fn followers_inside_facets_and_cells_keep_the_balances() {
    let tet10_on_hex20 = blocks([CellKind::Hex20, CellKind::Tet10], [2, 3], false);
    let hex27_on_tet4 = blocks([CellKind::Tet4, CellKind::Hex27], [2, 1], false);
    let mixed = |mesh: Mesh, tie: Tie| {
        let mut upper = rubber().with_formulation(Formulation::IncompatibleModes);
        upper.group = Some("upper".into());
        let mut lower = projected();
        lower.group = Some("lower".into());
        Body::builder(mesh).region(lower).region(upper).tie(tie).build().unwrap()
    };
    let plain = |mesh: Mesh, tie: Tie| Body::builder(mesh).region(rubber()).tie(tie).build().unwrap();
    for (name, body) in [
        ("tet10 on hex20", plain(tet10_on_hex20, tie())),
        ("hex27 on tet4", plain(hex27_on_tet4, tie())),
        ("cells lead", plain(blocks(HEX8, [2, 3], false), Tie::nodes("upper-face", "lower"))),
        ("modes on projected volumes", mixed(blocks(HEX8, [3, 2], false), tie())),
        (
            "projected volumes lead back",
            mixed(blocks(HEX8, [2, 3], false), Tie::nodes("lower-face", "upper-face")),
        ),
    ] {
        for k in [1, 2] {
            let state = State::initial(&body, 0.0, &[flight()]).unwrap();
            let mut motion = Motion::starting(&body, at(DGM, k), NewtonSettings::default(), state).unwrap();
            let first = motion.record().clone();
            for _ in 0..20 {
                let record = motion.step(0.05).unwrap();
                let energy = (record.total_energy - first.total_energy).abs() / first.total_energy;
                let [P, L] = [
                    (record.linear_momentum, first.linear_momentum),
                    (record.angular_momentum, first.angular_momentum),
                ]
                .map(|(a, b)| (0..3).map(|d| (a[d] - b[d]).abs()).fold(0.0, f64::max));
                assert!(energy < 1e-12 && P < 1e-12 && L < 1e-12, "{name}, k = {k}: {energy:e} {P:e} {L:e}");
            }
        }
    }
}

/// A finer mesh that follows a coarser one, nested in it, passes a uniform stress exactly; others do not.
#[test]
fn nested_meshes_pass_a_uniform_stress() {
    // Without a lateral contraction, the sides are free of stress.
    let cork = || Region::new(SaintVenantKirchhoff::new(0.0, 2000.0).unwrap(), 1.0);
    let largest_force = |n: [usize; 2]| {
        let body = Body::builder(blocks(HEX8, n, false)).region(cork()).tie(tie()).build().unwrap();
        let points = body.mesh().points();
        let u: Vec<f64> = points.iter().flat_map(|X| [0.0, 0.0, 0.01 * X[2]]).collect();
        let force = body.internal_force(&u).unwrap();
        let inside = |node: &usize| points[*node][2] > 0.0 && points[*node][2] < 2.0;
        let forces = (0..points.len()).filter(inside).flat_map(|node| [0, 1, 2].map(|d| force[3 * node + d]));
        let total: f64 =
            (0..points.len()).filter(|&node| points[node][2] == 2.0).map(|node| force[3 * node + 2]).sum();
        forces.fold(0.0, |largest: f64, f| largest.max(f.abs())) / total
    };
    assert!(largest_force([2, 4]) < 1e-14 && largest_force([1, 3]) < 1e-14);
    assert!(largest_force([2, 3]) > 1e-3 && largest_force([4, 2]) > 1e-3);
}

/// A mesh with its points moved, and its groups of facets.
fn moved(mesh: &Mesh, to: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    let mut builder = MeshBuilder::new();
    mesh.points().iter().for_each(|X| {
        builder.point(to(*X));
    });
    mesh.cells().for_each(|cell| {
        builder.cell(cell.kind, cell.nodes).unwrap();
    });
    for name in ["lower-face", "upper-face"] {
        builder.facet_group(name, mesh.groups().facets(name).unwrap().iter().copied());
    }
    builder.build().unwrap()
}

/// Kinds of cells and numbers of them along an edge, a region, and whether the meshes are distorted.
type Patch = (&'static str, [CellKind; 2], [usize; 2], fn() -> Region, bool);

/// By mortar any two meshes pass a uniform stress, if the surfaces are plane: of cells of all kinds and formulations,
/// of different sizes, and linear ones distorted.
#[test]
fn mortar_passes_a_uniform_stress() {
    use CellKind::{Hex8, Hex20, Hex27, Pyramid5, Tet4, Tet10, Wedge6};
    // In the plane of the tie, not at its rim.
    let bent = |X: [f64; 3]| {
        let inside = X[0] * (2.0 - X[0]) * X[1] * (2.0 - X[1]);
        [X[0] + 0.1 * inside * (3.0 * X[1]).cos(), X[1] - 0.08 * inside * (2.0 * X[0] + X[2]).sin(), X[2]]
    };
    // Uniaxial tension, because forces of the sides would pass to nodes inside.
    let stretch = 1.02f64;
    let contraction = |rubber: NeoHooke| {
        let stress = |a: f64| {
            let strain = [a, a, stretch].map(|stretch| 0.5 * (stretch * stretch - 1.0));
            rubber.stress(&[strain[0], strain[1], strain[2], 0.0, 0.0, 0.0])[0]
        };
        let (mut low, mut high) = (0.9, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *if stress(middle) < 0.0 { &mut low } else { &mut high } = middle;
        }
        low - 1.0
    };
    let modes = || rubber().with_formulation(Formulation::IncompatibleModes);
    let cases: [Patch; 17] = [
        ("hexahedra", [Hex8; 2], [2, 3], rubber, false),
        ("with a line in common", [Hex8; 2], [2, 4], rubber, false),
        ("with lines in common", [Hex8; 2], [6, 4], rubber, false),
        ("tetrahedra with lines in common", [Tet4; 2], [6, 2], rubber, false),
        ("on finer ones", [Hex8; 2], [5, 3], rubber, false),
        ("distorted", [Hex8; 2], [3, 4], rubber, true),
        ("tetrahedra", [Tet4; 2], [3, 4], rubber, true),
        ("both", [Hex8, Tet4], [3, 2], rubber, true),
        ("wedges and pyramids", [Wedge6, Pyramid5], [2, 3], rubber, true),
        ("projected volumes", [Hex8; 2], [2, 3], projected, false),
        ("incompatible modes", [Hex8; 2], [2, 3], modes, true),
        ("quadratic tetrahedra", [Tet10; 2], [2, 3], rubber, false),
        ("quadratic hexahedra", [Hex20; 2], [2, 3], rubber, false),
        ("biquadratic ones", [Hex27; 2], [2, 3], rubber, false),
        ("quadratic on linear", [Hex20, Hex8], [3, 2], rubber, false),
        ("quadratic of two kinds", [Tet10, Hex20], [3, 2], rubber, false),
        ("quadratic with lines in common", [Hex20, Tet10], [4, 2], rubber, false),
    ];
    for (name, kinds, n, region, is_bent) in cases {
        let mesh = moved(&blocks(kinds, n, false), |X| if is_bent { bent(X) } else { X });
        for (follower, leader) in [("upper-face", "lower-face"), ("lower-face", "upper-face")] {
            let largest_force = |tie: Tie| {
                let body = Body::builder(mesh.clone()).region(region()).tie(tie).build().unwrap();
                let points = body.mesh().points();
                let shifts = body.ties()[0].largest_shift;
                assert!(shifts < 1e-13, "{name}: {shifts:e}");
                let lambda = if name == "projected volumes" { 2e6 } else { 4000.0 };
                let a = contraction(NeoHooke::new(lambda, 2000.0).unwrap());
                let u = |X: &[f64; 3]| [a * X[0], a * X[1], (stretch - 1.0) * X[2]];
                let stretched =
                    State::displaced(&body, 0.0, points.iter().flat_map(u).collect(), &[]).unwrap();
                let force = body.internal_force(&stretched.displacement).unwrap();
                let is_inside = |X: &[f64; 3]| X.iter().all(|x| *x > 1e-9 && *x < 2.0 - 1e-9);
                let size = |node: usize| (0..3).map(|d| force[3 * node + d].abs()).fold(0.0, f64::max);
                let [inside, all] = [true, false].map(|inside_alone| {
                    let nodes = (0..points.len()).filter(|&node| !inside_alone || is_inside(&points[node]));
                    nodes.map(size).fold(0.0, f64::max)
                });
                inside / all
            };
            let by_mortar = largest_force(Tie::new(follower, leader));
            assert!(by_mortar < 1e-12, "{name}: {by_mortar:e}");
            let by_nodes = largest_force(Tie::nodes(follower, leader));
            // The finer mesh follows.
            let is_nested = [("upper-face", [2, 4]), ("lower-face", [6, 2])].contains(&(follower, n));
            let is_quadratic = name.contains("quadratic");
            assert!(is_quadratic || (by_nodes > 1e-3) != is_nested, "{name}: {by_nodes:e}");
        }
    }
}

/// A surface that reaches beyond the other one is tied where they meet; nodes further away than the tolerance are not
/// left out in silence.
#[test]
fn mortar_ties_surfaces_where_they_meet() {
    let mesh = |width: f64| {
        let mut mesh = MeshBuilder::new();
        add_block(&mut mesh, CellKind::Hex8, [[0.0; 3], [3.0, 2.0, 1.0]], [4, 3, 1], &mut HashMap::new());
        let upper = [[0.0, 0.0, 1.0], [width, 2.0, 2.0]];
        add_block(&mut mesh, CellKind::Hex8, upper, [3, 2, 1], &mut HashMap::new());
        let all = mesh.clone().build().unwrap();
        for (name, cells) in [("lower-face", 0..12u32), ("upper-face", 12..18)] {
            let facets = cells.flat_map(|cell| (0..6).map(move |local| Facet { cell, local }));
            let on = |node: u32| (all.points()[node as usize][2] - 1.0).abs() < 1e-9;
            mesh.facet_group(
                name,
                facets.filter(|&facet| all.facet_nodes(facet).all(on)).collect::<Vec<_>>(),
            );
        }
        mesh.build().unwrap()
    };
    let body = Body::builder(mesh(2.2)).region(rubber()).tie(Tie::new("upper-face", "lower-face")).build();
    let body = body.unwrap();
    assert_eq!((body.ties()[0].kind, body.ties()[0].n_followers), (TieKind::Mortar, 12));
    let upper = body.mesh().group_nodes("upper-face").unwrap();
    for &node in &upper {
        let leaders = body.leaders_of(node).unwrap();
        let sum: f64 = leaders.iter().map(|(_, weight)| weight).sum();
        assert!((sum - 1.0).abs() < 1e-14);
    }
    let beyond = Body::builder(mesh(3.5)).region(rubber()).tie(Tie::mortar("upper-face", "lower-face"));
    let error = beyond.build().unwrap_err().to_string();
    assert!(error.contains("its node at [3.5, 0, 1] is 0.5 away"), "{error}");
    // The tie of those that are near alone.
    let partial = Tie::mortar("upper-face", "lower-face").partial();
    let partial = Body::builder(mesh(3.5)).region(rubber()).tie(partial).build().unwrap();
    assert_eq!((partial.ties()[0].n_followers, partial.ties()[0].n_free), (9, 3));
    // Leaders that reach further are free there.
    let over = Body::builder(mesh(3.5)).region(rubber()).tie(Tie::mortar("lower-face", "upper-face"));
    assert_eq!(over.build().unwrap().ties()[0].n_followers, 20);
    let cells = blocks(HEX8, [2, 3], false);
    let body = |tie| Body::builder(cells.clone()).region(rubber()).tie(tie).build();
    assert_eq!(body(Tie::new("upper-face", "lower")).unwrap().ties()[0].kind, TieKind::Nodes);
    let error = body(Tie::mortar("upper-face", "lower")).unwrap_err().to_string();
    assert!(error.contains("mortar joins facets, and \"lower\" has none"), "{error}");
}

/// A support alone holds both blocks, and the motions that nothing holds are those of both.
#[test]
fn equilibria_and_modes_are_those_of_one_mesh() {
    for formulation in
        [Formulation::Standard, Formulation::IncompatibleModes, Formulation::ProjectedVolume(None)]
    {
        let bodies = [true, false].map(|is_merged| {
            let body = Body::builder(blocks(HEX8, [2, 2], is_merged))
                .region(rubber().with_formulation(formulation))
                .support(Support::fixed("floor"))
                .load(Load::acceleration([60.0, 0.0, -100.0]))
                .load(Load::pressure("roof", 100.0));
            if is_merged { body.build().unwrap() } else { body.tie(tie()).build().unwrap() }
        });
        let [merged, tied] = bodies.each_ref().map(|body| {
            let equilibrium = Equilibrium::new(body, 0.0, 2).unwrap();
            equilibrium.start(NewtonSettings::default(), &[], &mut []).unwrap()
        });
        let [mesh, other] = bodies.each_ref().map(|body| body.mesh());
        let size = merged.displacement.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        assert!(size > 0.02);
        for node in 0..other.n_nodes() {
            let of_merged = nodes_at(mesh, other.points()[node])[0];
            for d in 0..3 {
                let difference = tied.displacement[3 * node + d] - merged.displacement[3 * of_merged + d];
                assert!(difference.abs() < 1e-9 * size, "{formulation:?}: {difference:e}");
            }
        }
        let [of_merged, of_tied] = bodies.each_ref().map(|body| modes(body, 6).unwrap());
        for (own, expected) in of_tied.iter().zip(&of_merged) {
            let ratio = own.angular_frequency / expected.angular_frequency;
            assert!((ratio - 1.0).abs() < 1e-9, "{formulation:?}: {ratio}");
        }
        // Followers are drawn where they are.
        let node = nodes_at(other, [2.0, 0.0, 1.0]);
        let shape = |node: usize| [0, 1, 2].map(|d| of_tied[0].shape[3 * node + d]);
        assert_eq!((node.len(), shape(node[0])), (2, shape(node[1])));
    }
    let free = Body::builder(blocks(HEX8, [2, 3], false)).region(rubber()).tie(tie()).build().unwrap();
    let rigid = modes(&free, 8).unwrap().iter().filter(|mode| mode.angular_frequency == 0.0).count();
    assert_eq!(rigid, 6);
    let error = Equilibrium::new(&free, 0.0, 1).unwrap().check().unwrap_err().to_string();
    assert!(error.contains("the body"), "{error}");
}

/// A motion that stops and is resumed has the bits of one that does not, on any number of threads.
#[test]
fn resumed_motions_have_the_same_bits_on_any_number_of_threads() {
    let body = Body::builder(blocks(HEX8, [2, 3], false)).region(rubber()).tie(tie()).build().unwrap();
    for (k, solver) in [(1, Solver::Iterative), (2, Solver::Direct)] {
        let settings = NewtonSettings { solver, ..Default::default() };
        let on = |threads: usize, stop: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let state = State::initial(&body, 0.0, &[flight()]).unwrap();
                let mut motion = Motion::starting(&body, at(DGM, k), settings, state).unwrap();
                for step in 0..12 {
                    if step == stop {
                        motion = Motion::resumed(&body, at(DGM, k), settings, motion.snapshot()).unwrap();
                    }
                    motion.step(0.05).unwrap();
                }
                motion.state().clone()
            })
        };
        let all = on(1, 20);
        assert_eq!(all, on(1, 5));
        assert_eq!(all, on(2, 7));
    }
}

/// Adaptive steps of several degrees find the same errors as for a mesh that is one.
#[test]
fn errors_are_estimated_as_for_one_mesh() {
    for k in [1, 2] {
        let [merged, tied] = [true, false].map(|is_merged| {
            let body = Case::new("adaptive", at(DGM, k)).body(is_merged);
            let state = State::initial(&body, 0.0, &[flight()]).unwrap();
            let mut motion = Motion::starting(&body, at(DGM, k), NewtonSettings::default(), state).unwrap();
            let plan = StepPlan::adaptive(0.0, 0.2, Adaptivity::new(1e-4)).unwrap();
            motion.march(&plan, &mut []).unwrap();
            (motion.record().clone(), motion.statistics().steps)
        });
        assert_eq!(tied.1, merged.1);
        let ratio = tied.0.local_error / merged.0.local_error;
        assert!((ratio - 1.0).abs() < 1e-3, "k = {k}: {ratio}");
    }
}

/// Blocks at a distance; the follower moves onto the leader, and the mass belongs to the moved mesh.
#[test]
fn followers_move_onto_the_leader() {
    let gap = |gap: f64| {
        let mut mesh = MeshBuilder::new();
        for (low, high) in [(0.0, 1.0), (1.0 + gap, 2.0)] {
            let corners = [[0.0, 0.0, low], [1.0, 1.0, high]];
            add_block(&mut mesh, CellKind::Hex8, corners, [1; 3], &mut HashMap::new());
        }
        with_faces(mesh, &[("lower", &|X| X[2] == 1.0), ("upper", &|X| X[2] == 1.0 + gap)])
    };
    let built = |size: f64, tie: Tie| Body::builder(gap(size)).region(rubber()).tie(tie).build();
    let body = built(0.04, Tie::nodes("upper", "lower")).unwrap();
    let summary = &body.ties()[0];
    assert!(summary.n_followers == 4 && (summary.largest_shift - 0.04).abs() < 1e-15, "{summary:?}");
    assert!((body.regions()[0].mass - 2.0).abs() < 1e-14);
    assert_eq!(body.n_free_dofs(), 3 * 12);

    let error = built(0.2, Tie::nodes("upper", "lower")).unwrap_err().to_string();
    assert_eq!(
        error,
        "tie of \"upper\" to \"lower\": its node at [0, 0, 1.2] is 0.2 away, and the limit is 0.05 (tolerance \
         0.05 x edge 1); is there nothing to tie?"
    );
    assert!(built(0.2, Tie::nodes("upper", "lower").with_tolerance(0.2 + 1e-9)).is_ok());
}

/// A tower of three blocks whose followers lead others, and ties that cannot be.
#[test]
fn chains_follow_their_first_leader_and_circles_are_refused() {
    let points = [0.0, 1.0, 1.0, 1.0, 2.0].map(|x| [x, 0.0, 0.0]);
    let named = |mesh: Mesh| {
        let mesh = mesh.with_node_group("a", [1]).unwrap().with_node_group("b", [2]).unwrap();
        mesh.with_node_group("c", [3]).unwrap().with_node_group("ends", [0, 4]).unwrap()
    };
    // The cells 0-1, 2-4, 3-4: three links that meet at x = 1 once they are tied.
    let mesh = || named(Mesh::from_cells(CellKind::Line2, &points, &[[0, 1], [2, 4], [3, 4]]).unwrap());
    let spring = || Region::links(Link::spring(10.0, None).unwrap(), 0.0);
    let mass = |(group, mass): (&str, f64)| PointMass { group: group.into(), mass };
    let masses = [("ends", 1.0), ("a", 0.5), ("b", 0.25), ("c", 2.0)].map(mass).to_vec();
    let masses = PointTerms { masses, ..Default::default() };
    let build =
        |ties: &[Tie]| Body::builder(mesh()).region(spring()).point_terms(masses.clone()).ties(ties).build();
    let body = build(&[Tie::nodes("c", "b"), Tie::nodes("b", "a")]).unwrap();
    assert_eq!(body.n_free_dofs(), 9);
    assert_eq!(body.lumped_mass(), [1.0, 2.75, 0.0, 0.0, 1.0]);
    for (ties, words) in [
        (vec![Tie::nodes("b", "a"), Tie::nodes("a", "b")], "leads and follows in a circle"),
        (vec![Tie::nodes("c", "a"), Tie::nodes("c", "b")], "follows \"a\" too; a node follows once"),
        (vec![Tie::nodes("a", "a")], "both have the node at"),
        (vec![Tie::nodes("a", "b").with_tolerance(-1.0)], "tolerance must be a finite number"),
    ] {
        let error = build(&ties).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    let held =
        Body::builder(mesh()).region(spring()).support(Support::fixed("b")).tie(Tie::nodes("b", "a")).build();
    let error = held.unwrap_err().to_string();
    assert!(error.contains("is tied to others; hold these instead"), "{error}");
}

/// Plane strips of quadrilaterals and of quadratic triangles, and links on a block.
#[test]
fn plane_cells_and_links_are_tied() {
    let strips = |kinds: [CellKind; 2]| {
        let mut mesh = MeshBuilder::new();
        for (kind, [low, high], n) in [(kinds[0], [0.0, 1.0], 2), (kinds[1], [1.01, 2.0], 3)] {
            let corners = [[0.0, low, 0.0], [2.0, high, 0.0]];
            add_block(&mut mesh, kind, corners, [n, 2, 1], &mut HashMap::new());
        }
        with_faces(mesh, &[("lower", &|X| X[1] == 1.0), ("upper", &|X| X[1] == 1.01)])
    };
    let plane = |kinds: [CellKind; 2], tie: Tie| {
        let turns = InitialVelocity { angular_velocity: [0.0, 0.0, 1.0], ..flight() };
        (Body::builder(strips(kinds)).region(rubber()).tie(tie).build().unwrap(), turns)
    };
    let with_links = || {
        let mut mesh = MeshBuilder::new();
        add_block(&mut mesh, CellKind::Hex8, [[0.0; 3], [1.0; 3]], [2; 3], &mut HashMap::new());
        let ends = [[0.3, 0.4, 1.0], [0.5, 0.5, 2.0], [0.8, 0.2, 1.0]].map(|X| mesh.point(X));
        let links =
            [[ends[0], ends[1]], [ends[2], ends[1]]].map(|nodes| mesh.cell(CellKind::Line2, &nodes).unwrap());
        mesh.cell_group("links", links);
        mesh.cell_group("block", 0..8);
        mesh.node_group("feet", [ends[0], ends[2]]);
        let mesh = with_faces(mesh, &[("top", &|X| X[2] == 1.0 && X[0] != 0.3)]);
        let bars = Region::links(Link::bar(4000.0, 0.1).unwrap(), 1.0).on("links");
        let body = Body::builder(mesh).region(rubber().on("block")).region(bars);
        (body.tie(Tie::nodes("feet", "top")).build().unwrap(), flight())
    };
    for (name, (body, start)) in [
        ("quadrilaterals", plane([CellKind::Quad4; 2], Tie::nodes("upper", "lower"))),
        ("quadrilaterals by mortar", plane([CellKind::Quad4; 2], Tie::mortar("upper", "lower"))),
        ("triangles", plane([CellKind::Quad8, CellKind::Tri6], Tie::nodes("lower", "upper"))),
        ("links", with_links()),
    ] {
        for k in [1, 2] {
            let state = State::initial(&body, 0.0, std::slice::from_ref(&start)).unwrap();
            let mut motion = Motion::starting(&body, at(DGM, k), NewtonSettings::default(), state).unwrap();
            let first = motion.record().clone();
            for _ in 0..20 {
                let record = motion.step(0.05).unwrap();
                let energy = (record.total_energy - first.total_energy).abs() / first.total_energy;
                assert!(energy < 1e-12, "{name}, k = {k}: {energy:e}");
                assert!(record.linear_momentum_residual < 1e-12 && record.angular_momentum_residual < 1e-12);
            }
            // The strain is not rounding.
            assert!(motion.record().strain_energy > 1e-5 * first.total_energy, "{name}, k = {k}");
        }
    }
}
