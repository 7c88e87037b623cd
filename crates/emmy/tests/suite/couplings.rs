//! Distributing couplings: points that follow the mean of a group. Against an independent implementation, against the
//! same bodies with spherical joints at the point, and against the node itself.

#![allow(non_snake_case)]

use crate::shared::faces::with_faces;
use crate::shared::joints::rigid;
use crate::shared::schemes::{DGM, assumed_strain, at, dgm, fe};
use emmy::Error;
use emmy::body::{BodyBuilder, Formulation, GroundSpring, PointTerms};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::MeshBuilder;
use emmy::modes::modes;
use emmy::motion::{Adaptivity, NewtonSettings};
use emmy::prelude::*;

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0)
}

/// A plate of eight cells around a hole, with the group of its eight nodes and a wall.
fn bracket() -> Mesh {
    let mut builder = MeshBuilder::new();
    let number = |at: [usize; 3]| (at[0] + 4 * (at[1] + 4 * at[2])) as u32;
    for at in (0..32).map(|at| [at % 4, at / 4 % 4, at / 16]) {
        builder.point(at.map(|x| x as f64));
    }
    for [i, j] in (0..9).map(|cell| [cell % 3, cell / 3]).filter(|cell| *cell != [1, 1]) {
        let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let cell: Vec<u32> = (0..2).flat_map(|k| corners.map(|[a, b]| number([i + a, j + b, k]))).collect();
        builder.cell(CellKind::Hex8, &cell).unwrap();
    }
    let hole = [1, 2].into_iter().flat_map(|i| [1, 2].map(|j| [i, j]));
    builder.node_group("hole", hole.flat_map(|[i, j]| [0, 1].map(|k| number([i, j, k]))));
    builder.node_group("wall", (0..4).flat_map(|i| [0, 1].map(|k| number([i, 0, k]))));
    builder.build().unwrap()
}

fn equilibrium(body: &Body, time: f64) -> State {
    let found = Equilibrium::new(body, time, 2).unwrap().start(NewtonSettings::default(), &[], &mut []);
    found.unwrap_or_else(|error| panic!("{error}"))
}

fn largest(differences: impl Iterator<Item = f64>) -> f64 {
    differences.fold(0.0, |most: f64, own| most.max(own.abs()))
}

const FORCE: [f64; 3] = [10.0, 30.0, 20.0];
const POINT: [f64; 3] = [0.039_098_360_564_458_8, 0.049_553_167_189_581_57, 0.006_481_507_036_070_882];

/// Numbers of an independent implementation: by a force at the point, and by its displacement, for which the point has
/// an equation of its own and the force is a reaction.
#[test]
fn a_bracket_is_loaded_through_its_bolt_hole() {
    let bolt = || Coupling::new("bolt", "hole", [1.5; 3]);
    let builder =
        || Body::builder(bracket()).region(rubber()).support(Support::fixed("wall")).coupling(bolt());
    let pulled = builder().load(Load::nodal_force("bolt", FORCE)).build().unwrap();
    let moved = [0, 1, 2].map(|d| Some(TimeFunction::smooth("u", move |t| [POINT[d] * t, POINT[d], 0.0])));
    let driven = builder().support(Support::driven("bolt", moved)).build().unwrap();
    assert_eq!([pulled.couplings()[0].leads, driven.couplings()[0].leads], [false, true]);
    for (body, time) in [(&pulled, 0.0), (&driven, 1.0)] {
        let state = equilibrium(body, time);
        let point = 3 * body.couplings()[0].node as usize;
        let off = largest((0..3).map(|d| state.displacement[point + d] - POINT[d]));
        let energy = body.strain_energy(&state.displacement) - 0.995_791_914_285_138_4;
        let corner = 3 * body.mesh().nearest_node([3.0, 3.0, 1.0]);
        let due = [0.043_024_057_413_757_866, 0.023_588_372_345_993_76, -0.093_624_153_265_026_15];
        let off_corner = largest((0..3).map(|d| state.displacement[corner + d] - due[d]));
        assert!(off_corner < 1e-11, "{off_corner:e}");
        assert!(off < 1e-11 && energy.abs() < 1e-10, "{off:e} {energy:e}");
        let motion = Motion::new(body, DGM).unwrap().from(state.clone()).unwrap();
        let reactions = motion.with_static_reactions().unwrap();
        let reactions = reactions.reactions();
        let wall = reactions[0].force;
        assert!(largest((0..3).map(|d| wall[d] + FORCE[d])) < 1e-8, "{wall:?}");
        if let Some(bolt) = reactions.get(1) {
            assert!(largest((0..3).map(|d| bolt.force[d] - FORCE[d])) < 1e-8, "{:?}", bolt.force);
        }
    }
}

/// A block 2 x 1 x 1 with faces `left`, `right` and `top`.
fn block(kind: CellKind) -> Mesh {
    let mut builder = MeshBuilder::new();
    let brick = mesh::block([2.0, 1.0, 1.0], [2, 2, 2]).unwrap();
    if kind == CellKind::Hex8 {
        brick.points().iter().for_each(|&X| _ = builder.point(X));
        brick.cells().for_each(|cell| _ = builder.cell(kind, cell.nodes).unwrap());
    } else {
        let linear = emmy::internals::element::element(kind.linear());
        let element = emmy::internals::element::element(kind);
        let mut numbers = std::collections::HashMap::new();
        for cell in brick.cells() {
            let corners: Vec<[f64; 3]> = cell.nodes.iter().map(|&n| brick.points()[n as usize]).collect();
            let mut N = vec![0.0; corners.len()];
            let nodes: Vec<u32> = element
                .nodes()
                .iter()
                .map(|xi| {
                    linear.shape(*xi, &mut N);
                    let X = [0, 1, 2].map(|d| corners.iter().zip(&N).map(|(X, N)| N * X[d]).sum::<f64>());
                    *numbers.entry(X.map(|x| (x * 1e6).round() as i64)).or_insert_with(|| builder.point(X))
                })
                .collect();
            builder.cell(kind, &nodes).unwrap();
        }
    }
    let n_cells = builder.clone().build().unwrap().n_cells() as u32;
    builder.cell_group("body", 0..n_cells);
    with_faces(
        builder,
        &[
            ("left", &|X| X[0].abs() < 1e-9),
            ("right", &|X| (X[0] - 2.0).abs() < 1e-9),
            ("top", &|X| (X[2] - 1.0).abs() < 1e-9),
        ],
    )
}

const AT: [f64; 3] = [2.0, 0.7, 0.4];
const MASS: f64 = 3.0;

/// The block with a mass and a spring at a point that is coupled to its right face.
fn with_mass(mesh: Mesh, region: Region, stiffness: f64) -> BodyBuilder {
    let springs = vec![GroundSpring { group: "engine".into(), stiffness }];
    let springs = if stiffness > 0.0 { springs } else { Vec::new() };
    let masses = vec![PointMass { group: "engine".into(), mass: MASS }];
    Body::builder(mesh)
        .region(region)
        .coupling(Coupling::new("engine", "right", AT))
        .point_terms(PointTerms { masses, springs, ..Default::default() })
}

/// The same by a point mass of its own that a spherical joint holds at the point.
fn with_joint(mesh: Mesh, region: Region, stiffness: f64) -> BodyBuilder {
    let springs = vec![GroundSpring { group: "engine".into(), stiffness }];
    let springs = if stiffness > 0.0 { springs } else { Vec::new() };
    Body::builder(mesh)
        .region(region)
        .coupling(Coupling::new("point", "right", AT))
        .rigid(RigidBody::point("engine", MASS, AT))
        .joint(Joint::new("bolt", JointKind::Spherical, [rigid("engine"), rigid("point")], AT))
        .point_terms(PointTerms { springs, ..Default::default() })
}

fn flight() -> InitialVelocity {
    InitialVelocity {
        velocity: [-0.5, 0.3, 0.2],
        angular_velocity: [1.5, -1.0, 2.0],
        about: [1.0, 0.5, 0.5],
        gradient: [[0.5, 0.0, 0.0], [0.0, -0.3, 0.2], [0.0, 0.0, 0.2]],
        ..Default::default()
    }
}

fn started(body: &Body, scheme: Scheme) -> Motion<'_> {
    let state = State::initial(body, 0.0, &[flight()]).unwrap();
    Motion::starting(body, scheme, NewtonSettings::default(), state).unwrap()
}

/// The name of a formulation, and a region with it.
type Formulated = (&'static str, fn() -> Region);

const REGIONS: [Formulated; 3] = [
    ("standard", rubber),
    ("projected volumes", || {
        let stiff = Region::new(NeoHooke::new(1e6, 500.0).unwrap(), 2.0);
        stiff.with_formulation(Formulation::ProjectedVolume(None))
    }),
    ("incompatible modes", || rubber().with_formulation(Formulation::IncompatibleModes)),
];

/// A mass at the point moves the body as one that is joined to it, and all balances close.
#[test]
fn a_mass_at_the_point_is_one_that_is_joined_to_it() {
    for kind in [CellKind::Hex8, CellKind::Hex20] {
        for (name, region) in REGIONS {
            if kind == CellKind::Hex20 && name != "standard" {
                continue;
            }
            for stiffness in [0.0, 40.0] {
                let [own, other] = [
                    with_mass(block(kind), region(), stiffness).build().unwrap(),
                    with_joint(block(kind), region(), stiffness).build().unwrap(),
                ];
                for k in 1..=3 {
                    let (mut own, mut other) = (started(&own, at(DGM, k)), started(&other, at(DGM, k)));
                    let first = own.record().clone();
                    let mut L = 0.0f64;
                    for _ in 0..8 {
                        let record = own.step(0.05).unwrap().clone();
                        let joined = other.step(0.05).unwrap();
                        let energy = record.total_energy - first.total_energy;
                        assert!(energy.abs() < 1e-11 * first.total_energy, "{name} {k}: {energy:e}");
                        assert!(
                            (record.strain_energy - joined.strain_energy).abs() < 1e-9 * first.total_energy,
                            "{name} {k}: {:e}",
                            record.strain_energy - joined.strain_energy
                        );
                        if stiffness == 0.0 {
                            let change = |a: [f64; 3], b: [f64; 3]| largest((0..3).map(|d| a[d] - b[d]));
                            L = L.max(change(record.angular_momentum, first.angular_momentum));
                            L = L.max(change(record.linear_momentum, first.linear_momentum));
                        }
                    }
                    assert!(L < 1e-11 * MASS, "{name} {k}: {L:e}");
                    let n = own.body().mesh().n_nodes() - 1;
                    let off = largest(
                        (0..3 * n).map(|dof| own.state().displacement[dof] - other.state().displacement[dof]),
                    );
                    assert!(off < 1e-9, "{name} {k}: {off:e}");
                }
            }
        }
    }
}

/// Natural modes, held at the point and with a mass and a spring there, are those with joints.
#[test]
fn modes_are_those_with_joints() {
    for (name, region) in REGIONS {
        let held = |builder: BodyBuilder| builder.support(Support::fixed("left")).build().unwrap();
        let pairs = [
            [
                held(with_mass(block(CellKind::Hex8), region(), 40.0)),
                held(with_joint(block(CellKind::Hex8), region(), 40.0)),
            ],
            [
                held(
                    Body::builder(block(CellKind::Hex8))
                        .region(region())
                        .coupling(Coupling::new("pin", "right", AT))
                        .support(Support::fixed("pin")),
                ),
                held(
                    Body::builder(block(CellKind::Hex8))
                        .region(region())
                        .coupling(Coupling::new("pin", "right", AT))
                        .joint(Joint::new(
                            "pin-joint",
                            JointKind::Spherical,
                            [rigid("pin"), JointEnd::Ground],
                            AT,
                        )),
                ),
            ],
        ];
        for [own, other] in &pairs {
            let [own, other] = [own, other].map(|body| modes(body, 6).unwrap());
            for (own, other) in own.iter().zip(&other) {
                let [a, b] = [own, other].map(|mode| mode.angular_frequency);
                assert!((a - b).abs() < 1e-8 * b, "{name}: {a} {b}");
            }
        }
    }
}

/// Held and driven components have the reactions of a joint with the ground, in equilibria and motions.
#[test]
fn a_held_point_has_the_reaction_of_a_joint() {
    let pin = || Coupling::new("pin", "right", AT);
    let weight = || Load::acceleration([1.0, -3.0, -20.0]);
    let builder = || {
        Body::builder(block(CellKind::Hex8))
            .region(rubber())
            .support(Support::fixed("left"))
            .coupling(pin())
            .load(weight())
    };
    let own = builder().support(Support::fixed("pin")).build().unwrap();
    let joint = Joint::new("ball", JointKind::Spherical, [rigid("pin"), JointEnd::Ground], AT);
    let other = builder().joint(joint).build().unwrap();
    let [a, b] = [&own, &other].map(|body| equilibrium(body, 0.0));
    assert!(largest(a.displacement.iter().zip(&b.displacement).map(|(a, b)| a - b)) < 1e-10);
    let mut own = Motion::new(&own, at(DGM, 2)).unwrap();
    let mut other = Motion::new(&other, at(DGM, 2)).unwrap();
    for _ in 0..10 {
        own.step(0.02).unwrap();
        let force = other.step(0.02).unwrap().joints[0].force;
        let reaction = own.reactions()[1].force;
        let size = largest(force.into_iter());
        assert!(largest((0..3).map(|d| force[d] - reaction[d])) < 1e-7 * size, "{force:?} {reaction:?}");
    }
    let off = own.state().displacement.iter().zip(&other.state().displacement).map(|(a, b)| a - b);
    assert!(largest(off) < 1e-9);
}

/// A coupling to one node is that node: every scheme, with a mass and a spring there, plane strain and dissipation.
#[test]
fn a_coupling_to_one_node_is_the_node() {
    let plane = mesh::rectangle([2.0, 1.0], [3, 2]).unwrap();
    let schemes: Vec<Scheme> = [DGM, fe(2), assumed_strain(3), dgm(0.5), at(DGM, 3)]
        .into_iter()
        .chain(
            ["Newmark(0.25,0.5)", "HHT(0.1)", "generalized-alpha(0.8)", "Bathe", "central-differences"]
                .iter()
                .filter_map(|name| name.parse().ok()),
        )
        .collect();
    assert!(schemes.len() > 6, "{}", schemes.len());
    for base in [block(CellKind::Hex8), block(CellKind::Hex20), plane] {
        let tip = base.nearest_node([2.0, 1.0, 0.0]) as u32;
        let X = base.points()[tip as usize];
        let base = base.with_node_group("tip", [tip]).unwrap();
        let terms = |group: &str| PointTerms {
            masses: vec![PointMass { group: group.into(), mass: 1.5 }],
            springs: vec![GroundSpring { group: group.into(), stiffness: 30.0 }],
            ..Default::default()
        };
        let builder = |group: &str| {
            Body::builder(base.clone())
                .region(rubber())
                .point_terms(terms(group))
                .load(Load::nodal_force(group, [3.0, -2.0, 0.0]))
        };
        let node = builder("tip").build().unwrap();
        let point = builder("end").coupling(Coupling::new("end", "tip", X)).build().unwrap();
        for &scheme in &schemes {
            let start = |body: &Body| State::initial(body, 0.0, &[flight()]);
            let [Ok(own), Ok(other)] = [&point, &node].map(start) else { continue };
            let settings = NewtonSettings::default();
            let mut own = match Motion::starting(&point, scheme, settings, own) {
                Ok(motion) => motion,
                Err(error) => panic!("{scheme:?}: {error}"),
            };
            let mut other = Motion::starting(&node, scheme, settings, other).unwrap();
            for _ in 0..5 {
                own.step(0.002).unwrap();
                other.step(0.002).unwrap();
            }
            let pairs = own.state().displacement.iter().zip(&other.state().displacement);
            let off = largest(pairs.map(|(a, b)| a - b));
            assert!(off < 1e-12, "{scheme:?}: {off:e}");
        }
    }
}

/// Steps of any sizes, chosen by the error, and dissipation: what is lost is booked.
#[test]
fn adaptive_steps_and_dissipation() {
    let body = with_mass(block(CellKind::Hex8), rubber(), 40.0).build().unwrap();
    let mut fine = started(&body, at(DGM, 3));
    (0..80).for_each(|_| _ = fine.step(0.0125).unwrap());
    let exact = fine.record().strain_energy;
    let mut last = f64::INFINITY;
    for tolerance in [1e-3, 1e-5] {
        let mut motion = started(&body, at(DGM, 2));
        let plan = StepPlan::adaptive(0.0, 1.0, Adaptivity::new(tolerance)).unwrap();
        motion.march(&plan, &mut []).unwrap();
        let error = (motion.record().strain_energy - exact).abs() / exact;
        assert!(error < 0.3 * last, "{tolerance:e}: {error:e}");
        last = error;
    }
    let mut motion = started(&body, dgm(0.5));
    let first = motion.record().total_energy;
    for _ in 0..20 {
        let record = motion.step(0.05).unwrap();
        assert!(record.energy_residual.abs() < 1e-11 * first, "{:e}", record.energy_residual);
    }
    assert!(motion.record().total_energy < 0.99 * first);
}

/// Velocities of the cells alone are those of the point, which leads.
#[test]
fn a_point_starts_with_the_mean_velocity_of_its_nodes() {
    let body = with_mass(block(CellKind::Hex8), rubber(), 0.0).build().unwrap();
    let velocity = [1.0, 2.0, -1.0];
    let state = |group: Option<String>| {
        let field = InitialVelocity { group, velocity, ..Default::default() };
        State::initial(&body, 0.0, &[field]).unwrap()
    };
    for group in [Some("body".into()), None] {
        let own = state(group).velocity;
        assert!(largest(own.chunks(3).flat_map(|v| [0, 1, 2].map(|d| v[d] - velocity[d]))) < 1e-12);
    }
}

#[test]
fn impossible_couplings_are_refused() {
    let build = |coupling: Coupling, support: &str| {
        let mass = PointMass { group: "p".into(), mass: 1.0 };
        Body::builder(block(CellKind::Hex8))
            .region(rubber())
            .coupling(coupling)
            .support(Support::fixed(support))
            .point_terms(PointTerms { masses: vec![mass], ..Default::default() })
            .build()
            .unwrap_err()
    };
    let reason = |error: Error| match error {
        Error::Coupling { reason, .. } => reason,
        error => panic!("{error}"),
    };
    let off = reason(build(Coupling::new("p", "right", [2.5, 0.5, 0.5]), "left"));
    assert!(off.contains("lie in a plane") && off.contains("is 0.5 off"), "{off}");
    let held = reason(build(Coupling::new("p", "right", AT), "right"));
    assert!(held.contains("is held"), "{held}");
    let weights = reason(build(Coupling::new("p", "right", AT).with_weights([1.0; 4]), "left"));
    assert!(weights.contains("4 weights for the 9 nodes"), "{weights}");
    let weights = reason(build(Coupling::new("p", "right", AT).with_weights([0.0; 9]), "left"));
    assert!(weights.contains("must be positive"), "{weights}");
}
