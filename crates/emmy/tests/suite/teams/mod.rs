//! Bodies that a team of ranks computes, against the whole body on one.

mod bodies;

use std::sync::Arc;

use emmy::body::NodalMotion;
use emmy::body::{
    Body, BodyBuilder, Field, FieldName, Fields, Formulation, InitialVelocity, Load, LoadKind, PointMass,
    PointTerms,
};
use emmy::body::{
    GroundAttraction, GroundSpring, Place, Reaction, Region, Rotation, SpreadMass, Support, TimeFunction,
    Viscosity,
};
use emmy::material::{CiarletGeymonat, Link, NeoHooke, SaintVenantKirchhoff};
use emmy::mesh::{self, CellKind, Mesh, MeshBuilder, Share};
use emmy::motion::{
    Adaptivity, EventKind, MarchError, Motion, NewtonSettings, Phase, Record, Snapshot, Solver,
};
use emmy::motion::{ReferenceMotion, State, StepPlan};
use emmy::team::{Team, Threads};
use emmy::time::{Estimator, Scheme};
use emmy::{Error, Result};

use crate::shared::patch::Patch;
use crate::shared::schemes::{DGM, assumed_strain, at, dgm, fe};
use crate::shared::watch::Watch;

/// A body and its motion, as every rank sets them up.
struct Case {
    mesh: Mesh,
    parts: fn(BodyBuilder) -> BodyBuilder,
    start: InitialVelocity,
    scheme: Scheme,
    exact_tangent: bool,
    plan: StepPlan,
}

/// Results of a rank at the end of a motion.
#[derive(Debug, PartialEq)]
struct End {
    records: Vec<Record>,
    reactions: Vec<Reaction>,
    largest: emmy::motion::LargestDisplacement,
    mass: f64,
    gyration: f64,
    events: Vec<EventKind>,
}

impl Case {
    /// The paper's block with its load, which deforms by half of its size.
    fn l_block(scheme: Scheme, degree: usize) -> Case {
        Case {
            mesh: mesh::l_block(1.0).unwrap(),
            parts: |builder| builder.region(rubber()).loads(hat_loads()),
            start: InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() },
            scheme: at(scheme, degree),
            exact_tangent: false,
            plan: plan(1.0, 0.1),
        }
    }

    fn settings(&self) -> NewtonSettings {
        // Ranks have other preconditioners, so they agree to the tolerance.
        let exact_tangent = self.exact_tangent;
        NewtonSettings { tolerance: 1e-13, solver: Solver::Iterative, exact_tangent, ..Default::default() }
    }

    fn run(&self, builder: BodyBuilder) -> Result<End> {
        let body = (self.parts)(builder).build()?;
        let state = State::initial(&body, 0.0, std::slice::from_ref(&self.start))?;
        let mut motion = Motion::starting(&body, self.scheme, self.settings(), state)?;
        motion.allow_cuts(None);
        let mut watch = Watch::default();
        motion.march(&self.plan, &mut [&mut watch])?;
        Ok(End {
            records: watch.records,
            reactions: motion.reactions().to_vec(),
            largest: motion.statistics().largest_displacement,
            mass: body.regions().iter().map(|region| region.mass).sum(),
            gyration: body.radius_of_gyration(),
            events: watch.events.iter().map(|event| event.kind).collect(),
        })
    }

    fn whole(&self) -> Result<End> {
        self.run(Body::builder(self.mesh.clone()))
    }

    /// The outcomes of all ranks.
    fn shared(&self, size: usize) -> Vec<Result<End>> {
        on_team(&self.mesh, size, |share, team| self.run(Body::shared(share, team)))
    }

    /// Compares teams of some sizes with the whole body, to a part of the largest energies and momenta.
    fn assert_equal(&self, sizes: impl IntoIterator<Item = usize>, tolerance: f64) {
        let whole = self.whole().unwrap();
        for size in sizes {
            let ranks: Vec<End> = self.shared(size).into_iter().collect::<Result<_>>().unwrap();
            assert!(ranks.iter().all(|end| *end == ranks[0]), "{size} ranks differ from each other");
            ranks[0].assert_near(&whole, tolerance, &format!("{} on {size} ranks", self.scheme));
        }
    }
}

impl End {
    fn assert_near(&self, other: &End, tolerance: f64, name: &str) {
        assert_eq!(self.records.len(), other.records.len(), "{name}");
        assert_eq!(self.events, other.events, "{name}");
        let size =
            |of: &dyn Fn(&Record) -> f64| other.records.iter().map(|r| of(r).abs()).fold(1e-300, f64::max);
        let norm = |v: [f64; 3]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let energy = size(&|r| r.kinetic_energy + r.strain_energy);
        let linear = size(&|r| norm(r.linear_momentum)).max((2.0 * energy * other.mass).sqrt());
        let angular = size(&|r| norm(r.angular_momentum)).max(linear * other.gyration);
        for (own, other) in self.records.iter().zip(&other.records) {
            let scalars: [fn(&Record) -> f64; 6] = [
                |r| r.kinetic_energy,
                |r| r.strain_energy,
                |r| r.total_energy,
                |r| r.external_work,
                |r| r.dissipated_energy,
                |r| r.energy_residual,
            ];
            for (index, of) in scalars.iter().enumerate() {
                let difference = (of(own) - of(other)).abs() / energy;
                assert!(difference < tolerance, "{name}, step {}, number {index}: {difference:e}", own.step);
            }
            for d in 0..3 {
                let difference = (own.linear_momentum[d] - other.linear_momentum[d]).abs() / linear;
                assert!(difference < tolerance, "{name}, step {}: {difference:e}", own.step);
                let difference = (own.angular_momentum[d] - other.angular_momentum[d]).abs() / angular;
                assert!(difference < tolerance, "{name}, step {}: {difference:e}", own.step);
            }
            let change = own.linear_momentum_residual - other.linear_momentum_residual;
            assert!(change.abs() < tolerance * linear, "{name}: {change:e}");
            let change = own.angular_momentum_residual - other.angular_momentum_residual;
            assert!(change.abs() < tolerance * angular, "{name}: {change:e}");
            assert!(
                (own.smallest_determinant - other.smallest_determinant).abs() < 1e3 * tolerance,
                "{name}"
            );
        }
        let force = other.reactions.iter().map(|r| norm(r.force)).fold(1e-300, f64::max);
        let moment = other.reactions.iter().map(|r| norm(r.moment)).fold(1e-300, f64::max);
        assert_eq!(self.reactions.len(), other.reactions.len(), "{name}");
        for (own, other) in self.reactions.iter().zip(&other.reactions) {
            for d in 0..3 {
                assert!(
                    (own.force[d] - other.force[d]).abs() < 100.0 * tolerance * force,
                    "{name}: {own:?} {other:?}"
                );
                assert!((own.moment[d] - other.moment[d]).abs() < 100.0 * tolerance * moment, "{name}");
            }
        }
        let (own, other_node) = (&self.largest, &other.largest);
        assert_eq!(
            (own.node, own.step, own.point),
            (other_node.node, other_node.step, other_node.point),
            "{name}"
        );
        assert!((own.value / other_node.value - 1.0).abs() < 1e3 * tolerance, "{name}");
        assert!(
            (self.mass / other.mass - 1.0).abs() < 1e-14
                && (self.gyration / other.gyration - 1.0).abs() < 1e-14
        );
    }
}

/// Runs a function on every rank of a team with its share of a mesh.
fn on_team<T: Send>(mesh: &Mesh, size: usize, rank: impl Fn(Share, Arc<dyn Team>) -> T + Sync) -> Vec<T> {
    let owners = mesh::owners(mesh, size).unwrap();
    Threads::run(size, |team| rank(Share::new(mesh, &owners, team.rank()), team)).unwrap()
}

fn plan(until: f64, size: f64) -> StepPlan {
    StepPlan::new(0.0, vec![Phase { until, size }]).unwrap()
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.5)
}

/// Tractions of the paper's load as a hat over 0..1.
fn hat_loads() -> [Load; 2] {
    [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| {
        let traction = [256.0, 512.0, 768.0].map(|t| sign * t / 9.0);
        Load::traction(group, traction).over([(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]).unwrap()
    })
}

#[test]
fn every_scheme_and_degree_is_that_of_the_whole_body() {
    for scheme in [fe(1), assumed_strain(5), DGM] {
        for degree in 1..=3 {
            let scheme = if scheme == fe(1) { fe(degree) } else { scheme };
            Case::l_block(scheme, degree).assert_equal(2..=4, 1e-12);
        }
    }
}

#[test]
fn one_rank_has_all_bits_of_the_whole_body_and_every_run_has_the_same() {
    for degree in 1..=2 {
        let case = Case::l_block(DGM, degree);
        let whole = case.whole().unwrap();
        assert_eq!(case.shared(1), [Ok(whole)]);
        assert_eq!(case.shared(3), case.shared(3));
    }
}

#[test]
fn the_exact_tangent_is_that_of_the_whole_body() {
    let case = Case { exact_tangent: true, plan: plan(0.3, 0.1), ..Case::l_block(DGM, 2) };
    case.assert_equal([2, 3], 1e-12);
}

/// Ten-node tetrahedra and two materials, a clamped end, gravity, a nodal force, viscosity and drag.
#[test]
fn a_damped_beam_of_two_materials_is_that_of_the_whole_body() {
    let case = Case {
        mesh: halves(),
        parts: |builder| {
            let viscosity = Viscosity { time: 0.02, shear: 1.0, bulk: 0.5 };
            builder
                .region(Region::new(SaintVenantKirchhoff::new(2000.0, 900.0).unwrap(), 1.0).on("left"))
                .region(
                    Region::new(CiarletGeymonat::new(800.0, 400.0).unwrap(), 2.0)
                        .on("right")
                        .with_viscosity(viscosity),
                )
                .support(Support::fixed("clamp"))
                .support(Support::of_components("tip", [false, true, false]))
                .load(Load::acceleration([0.0, 0.0, -9.81]))
                .load(Load::nodal_force("tip", [1.0, 0.0, 2.0]).over([(0.0, 1.0), (0.2, 0.0)]).unwrap())
                .drag(0.3)
        },
        start: InitialVelocity {
            group: Some("right".to_string()),
            velocity: [0.0, 0.0, 0.5],
            ..Default::default()
        },
        scheme: at(DGM, 1),
        exact_tangent: false,
        plan: plan(0.4, 0.02),
    };
    let whole = case.whole().unwrap();
    let last = &whole.records[whole.records.len() - 1];
    assert!(last.dissipated_energy > 1e-3 * last.kinetic_energy && norm(whole.reactions[0].force) > 1.0);
    case.assert_equal([2, 4], 1e-12);
    Case { scheme: at(assumed_strain(5), 2), ..case }.assert_equal([3], 1e-12);
}

fn norm(vector: [f64; 3]) -> f64 {
    vector.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// A beam of tet10 along x, with the cell groups `left` and `right` and the node groups `clamp` and `tip`.
fn halves() -> Mesh {
    let whole = mesh::block([4.0, 1.0, 1.0], [6, 2, 2]).unwrap();
    let mut builder = MeshBuilder::new();
    let mut mids = std::collections::HashMap::new();
    let mut points: Vec<[f64; 3]> = whole.points().to_vec();
    let mut cells = Vec::new();
    for brick in whole.cells() {
        let x = brick.nodes.iter().map(|&node| points[node as usize][0]).fold(0.0, f64::max);
        for corners in [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]] {
            let corners = corners.map(|corner: usize| brick.nodes[corner]);
            let mut nodes = corners.to_vec();
            for [a, b] in [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]] {
                let (a, b) = (corners[a].min(corners[b]), corners[a].max(corners[b]));
                nodes.push(*mids.entry((a, b)).or_insert_with(|| {
                    let (p, q) = (points[a as usize], points[b as usize]);
                    points.push([0, 1, 2].map(|d| 0.5 * (p[d] + q[d])));
                    points.len() as u32 - 1
                }));
            }
            cells.push((nodes, if x > 2.0 + 1e-9 { "right" } else { "left" }));
        }
    }
    points.iter().for_each(|&point| _ = builder.point(point));
    for (nodes, group) in &cells {
        let cell = builder.cell(CellKind::Tet10, nodes).unwrap();
        builder.cell_group(group, [cell]);
    }
    let at = |x: f64| points.iter().zip(0..).filter(move |(point, _)| point[0] == x).map(|(_, node)| node);
    builder.node_group("clamp", at(0.0));
    builder.node_group("tip", at(4.0));
    builder.build().unwrap()
}

/// A bent beam of two materials: all fields at own nodes, at guests and in cells.
/// Motions in frames of reference, and mass and volume, are those of the whole body.
#[test]
fn frames_of_reference_are_those_of_the_whole_body() {
    let mesh = halves();
    let parts = |builder: BodyBuilder| {
        let rubber = |density: f64| Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), density);
        builder.region(rubber(1.0).on("left")).region(rubber(3.0).on("right")).build().unwrap()
    };
    let bent = |[x, y, z]: [f64; 3]| [0.1 * x * y - y, x + 0.05 * x * x, 2.0 + 0.2 * z * (x + y)];
    let numbers = |body: &Body| {
        let motion: Vec<f64> = body.mesh().points().iter().flat_map(|&x| bent(x)).collect();
        let frames = [ReferenceMotion::of_body(), ReferenceMotion::of_group(body, "left").unwrap()];
        (frames.map(|frame| frame.seen(body, &motion, &motion)), body.mass_and_volume())
    };
    let (whole, [mass, volume]) = numbers(&parts(Body::builder(mesh.clone())));
    for size in [2, 4] {
        on_team(&mesh, size, |share, team| {
            let body = parts(Body::shared(share, team));
            let (own, [own_mass, own_volume]) = numbers(&body);
            assert!((own_mass - mass).abs() < 1e-12 * mass && (own_volume - volume).abs() < 1e-12 * volume);
            for (own, whole) in own.iter().flatten().zip(whole.iter().flatten()) {
                for (own, &node) in own.chunks_exact(3).zip(body.ranks().nodes()) {
                    let there = &whole[3 * node as usize..][..3];
                    assert!(own.iter().zip(there).all(|(a, b)| (a - b).abs() < 1e-12), "{node}");
                }
            }
        });
    }
}

#[test]
fn fields_are_those_of_the_whole_body() {
    let mesh = halves();
    let parts = |builder: BodyBuilder| {
        builder
            .region(Region::new(SaintVenantKirchhoff::new(2000.0, 900.0).unwrap(), 1.0).on("left"))
            .region(rubber().on("right"))
            .build()
            .unwrap()
    };
    let bent = |[x, y, z]: [f64; 3]| [0.1 * x * y, 0.05 * x * x, 0.2 * z * (x + y)];
    let fields = |body: &Body| {
        let motion: Vec<f64> = body.mesh().points().iter().flat_map(|&x| bent(x)).collect();
        let there = Fields::new(body);
        let names: Vec<FieldName> = FieldName::ALL.into_iter().filter(|&name| there.has(name)).collect();
        let motion = NodalMotion { displacement: &motion, velocity: &motion, acceleration: &motion };
        there.at(motion, &names)
    };
    let whole = fields(&parts(Body::builder(mesh.clone())));
    assert_eq!(whole.len(), FieldName::ALL.len() - 3); // no axial force, no contact
    for size in [2, 4] {
        on_team(&mesh, size, |share, team| {
            let body = parts(Body::shared(share, team));
            let part = body.ranks();
            for (own, whole) in fields(&body).iter().zip(&whole) {
                let (n, numbers) = match own.name.place() {
                    Place::Nodes => (body.mesh().n_nodes(), part.nodes()),
                    Place::Cells => (body.mesh().n_cells(), part.cells()),
                };
                let width = own.name.components().len();
                assert_eq!(own.numbers.len(), width * n, "{}", own.name);
                let largest = whole.numbers.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
                for (own, &member) in own.numbers.chunks_exact(width).zip(numbers) {
                    let there = &whole.numbers[width * member as usize..][..width];
                    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * largest;
                    assert!(own.iter().zip(there).all(is_near), "{}, {member}", whole.name);
                }
            }
        });
    }
}

/// A plane of symmetry, a support that is released, a force over a surface, and a follower pressure.
#[test]
fn a_block_that_is_released_is_that_of_the_whole_body() {
    let case = |scheme| Case {
        mesh: mesh::block([3.0, 1.0, 1.0], [6, 2, 2]).unwrap(),
        parts: |builder| {
            builder
                .region(rubber())
                .support(Support::symmetry("x-min"))
                .support(Support::fixed("y-min").until(0.1))
                .load(
                    Load::force("x-max", [5.0, 20.0, 10.0])
                        .over([(0.0, 0.0), (0.1, 1.0), (0.2, 0.0)])
                        .unwrap(),
                )
                .load(Load::pressure("z-max", 30.0).over([(0.0, 1.0), (0.2, 0.0)]).unwrap())
        },
        start: InitialVelocity::default(),
        scheme,
        exact_tangent: false,
        plan: plan(0.4, 0.025),
    };
    let whole = case(DGM).whole().unwrap();
    assert!(whole.events.contains(&EventKind::Release) && whole.records[16].external_work > 0.1);
    case(DGM).assert_equal([2, 4], 1e-12);
    Case { exact_tangent: true, ..case(at(assumed_strain(5), 2)) }.assert_equal([3], 1e-12);
}

/// One end moves, the other one turns.
#[test]
fn supports_that_move_are_those_of_the_whole_body() {
    for degree in 1..=2 {
        let case = Case {
            mesh: halves(),
            parts: |builder| {
                let there_and_back =
                    |t: f64| [0.1 * (1.0 - (6.0 * t).cos()), 0.6 * (6.0 * t).sin(), 3.6 * (6.0 * t).cos()];
                let moved = TimeFunction::smooth("there and back", there_and_back);
                let angle = TimeFunction::smooth("t^2", |t| [t * t, 2.0 * t, 2.0]);
                let turn = Rotation { axis: [1.0, 0.0, 0.0], about: [0.0, 0.5, 0.5], angle };
                // A thousand times as dense: velocities keep their digits in both.
                let dense = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 500.0);
                builder
                    .region(rubber().on("left"))
                    .region(dense.on("right"))
                    .support(Support::driven("tip", [None, None, Some(moved)]))
                    .support(Support { rotation: Some(turn), ..Support::of_components("clamp", [false; 3]) })
            },
            start: InitialVelocity::default(),
            scheme: at(DGM, degree),
            exact_tangent: false,
            plan: plan(0.5, 0.05),
        };
        case.assert_equal([2, 3], 1e-12);
    }
}

/// Point masses, springs to the ground and attraction to a point.
#[test]
fn masses_and_forces_at_nodes_are_those_of_the_whole_body() {
    let case = Case {
        mesh: mesh::block([3.0, 1.0, 1.0], [6, 2, 2]).unwrap(),
        parts: |builder| {
            let terms = PointTerms {
                masses: vec![PointMass { group: "x-max".to_string(), mass: 0.1 }],
                spread: vec![SpreadMass { group: "y-max".to_string(), total: 0.4 }],
                springs: vec![GroundSpring { group: "x-min".to_string(), stiffness: 40.0 }],
                attractions: vec![GroundAttraction { group: None, centre: [5.0, 4.0, 3.0], strength: 2.0 }],
            };
            builder.region(rubber()).point_terms(terms)
        },
        start: InitialVelocity { angular_velocity: [0.0, 1.0, 2.0], ..Default::default() },
        scheme: at(DGM, 1),
        exact_tangent: false,
        plan: plan(0.5, 0.05),
    };
    let whole = case.whole().unwrap();
    assert!(norm(whole.reactions[0].force) > 1.0);
    case.assert_equal(2..=4, 1e-12);
    Case { scheme: at(fe(2), 2), ..case }.assert_equal([3], 1e-12);
}

/// A block on springs without mass and a bar, as cells of two nodes.
#[test]
fn links_are_those_of_the_whole_body() {
    let block = mesh::block([3.0, 1.0, 1.0], [6, 2, 2]).unwrap();
    let mut builder = MeshBuilder::new();
    block.points().iter().for_each(|&point| _ = builder.point(point));
    for cell in block.cells() {
        let cell = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group("block", [cell]);
    }
    let far = builder.point([3.0, 3.0, 3.0]);
    builder.node_group("far", [far]);
    let near = |x: [f64; 3]| block.nearest_node(x) as u32;
    for (group, ends) in [
        ("springs", [near([0.0; 3]), near([3.0, 1.0, 1.0])]),
        ("springs", [near([0.0, 1.0, 0.0]), near([3.0, 0.0, 1.0])]),
        ("bars", [near([3.0, 1.0, 1.0]), far]),
    ] {
        let cell = builder.cell(CellKind::Line2, &ends).unwrap();
        builder.cell_group(group, [cell]);
    }
    let case = Case {
        mesh: builder.build().unwrap(),
        parts: |builder| {
            builder
                .region(rubber().on("block"))
                .region(Region::links(Link::spring(30.0, Some(2.0)).unwrap(), 0.0).on("springs"))
                .region(Region::links(Link::bar(2000.0, 0.01).unwrap(), 3.0).on("bars"))
                .support(Support::fixed("far"))
        },
        start: InitialVelocity {
            group: Some("block".to_string()),
            angular_velocity: [0.3, 1.0, 0.5],
            ..Default::default()
        },
        scheme: at(DGM, 1),
        exact_tangent: false,
        plan: plan(0.5, 0.05),
    };
    case.assert_equal(2..=4, 1e-12);
    let springs = |body: &Body| body.regions()[1].clone();
    let whole = springs(&(case.parts)(Body::builder(case.mesh.clone())).build().unwrap());
    let of_ranks = on_team(&case.mesh, 3, |share, team| {
        springs(&(case.parts)(Body::shared(share, team)).build().unwrap())
    });
    assert!(
        of_ranks
            .iter()
            .all(|own| (own.n_cells, own.mass) == (whole.n_cells, 0.0) && own.centre[0].is_finite())
    );
}

/// A state of central differences, whose lumped momenta guests have too, as the start of a time element.
#[test]
fn a_state_of_another_scheme_is_that_of_the_whole_body() {
    let mesh = mesh::l_block(1.0).unwrap();
    let run = |builder: BodyBuilder| -> Result<Record> {
        let body = builder.region(rubber()).build()?;
        let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
        let mut first = Motion::new(&body, "central-differences".parse::<Scheme>()?)?;
        first = first.from(State::initial(&body, 0.0, &[spin])?)?;
        first.step(0.001)?;
        let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
        let mut second = Motion::starting(&body, dgm(0.8), settings, first.state().clone())?;
        for _ in 0..5 {
            second.step(0.05)?;
        }
        Ok(second.record().clone())
    };
    let whole = run(Body::builder(mesh.clone())).unwrap();
    for record in on_team(&mesh, 3, |share, team| run(Body::shared(share, team)).unwrap()) {
        assert!((record.total_energy / whole.total_energy - 1.0).abs() < 1e-12);
        let size = norm(whole.angular_momentum);
        for d in 0..3 {
            assert!((record.linear_momentum[d] - whole.linear_momentum[d]).abs() < 1e-12 * size);
            assert!((record.angular_momentum[d] - whole.angular_momentum[d]).abs() < 1e-12 * size);
        }
    }
}

/// Schemes that dissipate energy, free and held.
#[test]
fn dissipation_is_that_of_the_whole_body() {
    for (scheme, degree) in [(dgm(0.5), 1), (dgm(0.8), 2), (dgm(0.0), 3)] {
        let case = Case::l_block(scheme, degree);
        let end = case.whole().unwrap();
        assert!(end.records[10].dissipated_energy > 0.0);
        case.assert_equal([2, 3], 1e-11);
        let held = |builder: BodyBuilder| {
            builder.region(rubber()).loads(hat_loads()).support(Support::fixed("face-b"))
        };
        Case { parts: held, start: InitialVelocity::default(), exact_tangent: true, ..case }
            .assert_equal([2], 1e-11);
    }
}

/// Newmark's family, Bathe's method and central differences, with supports, springs and loads.
#[test]
fn classic_steppers_are_those_of_the_whole_body() {
    for name in ["Newmark(0.25, 0.5)", "HHT(0.1)", "generalized-alpha(0.8)", "Bathe", "central-differences"] {
        let case = Case {
            mesh: mesh::block([3.0, 1.0, 1.0], [6, 2, 2]).unwrap(),
            parts: |builder| {
                let springs = vec![GroundSpring { group: "x-max".to_string(), stiffness: 40.0 }];
                builder
                    .region(rubber())
                    .point_terms(PointTerms { springs, ..Default::default() })
                    .support(Support::fixed("x-min"))
                    .load(Load::pressure("z-max", 20.0).over([(0.0, 1.0), (0.2, 0.0)]).unwrap())
            },
            start: InitialVelocity {
                gradient: [[0.0; 3], [0.1, 0.0, 0.0], [0.5, 0.1, 0.0]],
                ..Default::default()
            },
            scheme: name.parse().unwrap(),
            exact_tangent: false,
            plan: plan(0.1, 0.0025),
        };
        case.assert_equal([2, 3], 1e-11);
    }
}

/// Weight, attraction and a bed of springs on quadratic cells, with the consistent and with the lumped mass.
#[test]
fn quadratic_cells_are_those_of_the_whole_body() {
    for scheme in ["DGM", "central-differences"] {
        let case = Case {
            mesh: Patch { bricks: 2, curved: true, distortion: 1.0 }.mesh(CellKind::Hex20),
            parts: |builder| {
                let terms = PointTerms {
                    springs: vec![GroundSpring { group: "x-max".to_string(), stiffness: 40.0 }],
                    attractions: vec![GroundAttraction {
                        group: None,
                        centre: [5.0, 4.0, 3.0],
                        strength: 20.0,
                    }],
                    ..Default::default()
                };
                let field = Field::new(|x, t| [3.0 * x[1], -2.0, t]);
                builder
                    .region(rubber())
                    .point_terms(terms)
                    .load(Load::acceleration([0.0, 1.0, -9.81]))
                    .load(Load::new(LoadKind::BodyForceField { group: None, field }))
            },
            start: InitialVelocity { angular_velocity: [0.0, 1.0, 2.0], ..Default::default() },
            scheme: scheme.parse().unwrap(),
            exact_tangent: false,
            plan: plan(0.02, 0.0005),
        };
        case.assert_equal([2, 3], 1e-11);
    }
}

/// Steps and degrees chosen by the error: the same on all ranks, and the decisions of the whole body.
#[test]
fn adaptive_steps_are_those_of_the_whole_body() {
    for (degree, adaptivity) in [
        (1, Adaptivity::new(1e-3)),
        (2, Adaptivity::new(1e-5)),
        (2, Adaptivity { estimator: Some(Estimator::Residual), ..Adaptivity::new(1e-5) }),
        (2, Adaptivity { estimator: Some(Estimator::Element), ..Adaptivity::new(1e-5) }),
        (1, Adaptivity { degrees: Some([1, 3]), ..Adaptivity::new(1e-5) }),
    ] {
        let plan = StepPlan::adaptive(0.0, 1.0, adaptivity).unwrap();
        let case = Case { plan, ..Case::l_block(DGM, degree) };
        let whole = case.whole().unwrap();
        for size in [2, 3] {
            let ranks: Vec<End> = case.shared(size).into_iter().collect::<Result<_>>().unwrap();
            assert!(ranks.iter().all(|end| *end == ranks[0]), "{size} ranks differ from each other");
            assert_eq!((ranks[0].records.len(), &ranks[0].events), (whole.records.len(), &whole.events));
            // Estimates are solved to 1e-4, so sizes differ by some of it, and the motions by the errors of their
            // steps.
            let [own, other] = [&ranks[0], &whole].map(|end| &end.records[end.records.len() - 1]);
            assert!((own.total_energy / other.total_energy - 1.0).abs() < 1e-4, "{own:?}");
            for record in &ranks[0].records {
                assert!(record.energy_residual.abs() < 1e-11 * other.total_energy, "{record:?}");
                assert!(record.angular_momentum_residual < 1e-11 * other.total_energy, "{record:?}");
            }
        }
    }
}

/// Loads by functions of position and time, and one of them that fails at a point of one rank.
#[test]
fn loads_by_fields_are_those_of_the_whole_body() {
    let case = |field: fn([f64; 3], f64) -> [f64; 3]| {
        let mesh = mesh::block([3.0, 1.0, 1.0], [6, 2, 2]).unwrap();
        move |size: usize| {
            let run = |builder: BodyBuilder| -> Result<(Record, usize)> {
                let load = Load::new(LoadKind::BodyForceField { group: None, field: Field::new(field) });
                let body = builder.region(rubber()).support(Support::fixed("x-min")).load(load).build()?;
                let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
                let mut motion = Motion::new(&body, at(DGM, 2))?.newton(settings)?;
                motion.allow_cuts(None);
                motion.march(&plan(0.4, 0.1), &mut [])?;
                Ok((motion.record().clone(), motion.statistics().unresolved_loads))
            };
            let ranks = on_team(&mesh, size, |share, team| run(Body::shared(share, team)));
            (run(Body::builder(mesh.clone())), ranks)
        }
    };
    let waves = case(|x, t| [0.0, 20.0 * (3.0 * x[0] - 9.0 * t).sin(), 10.0 * (400.0 * t).sin()]);
    for size in [2, 3] {
        let (whole, ranks) = waves(size);
        let (whole, unresolved) = whole.unwrap();
        assert!(whole.external_work.abs() > 0.1 && unresolved > 0, "{whole:?} {unresolved}");
        for rank in ranks {
            let (record, own_unresolved) = rank.unwrap();
            assert!((record.total_energy / whole.total_energy - 1.0).abs() < 1e-12);
            assert!((record.external_work / whole.external_work - 1.0).abs() < 1e-12);
            assert_eq!(own_unresolved, unresolved);
        }
    }
    let fails = case(|x, t| [if x[0] > 2.8 && t > 0.15 { f64::NAN } else { 1.0 }, 0.0, 0.0]);
    let (whole, ranks) = fails(3);
    let Error::NotFiniteAt { time, .. } = whole.unwrap_err() else { panic!("another error") };
    let errors: Vec<Error> = ranks.into_iter().map(Result::unwrap_err).collect();
    assert!(errors.iter().all(|error| *error == errors[0] || error.to_string() == errors[0].to_string()));
    assert!(matches!(&errors[0], Error::NotFiniteAt { time: own, .. } if *own == time), "{}", errors[0]);
}

/// Plane strain, and a share without any node of a group.
#[test]
fn a_plate_in_plane_strain_is_that_of_the_whole_body() {
    let case = Case {
        mesh: mesh::rectangle([6.0, 1.0], [12, 2]).unwrap(),
        parts: |builder| {
            let corner = Load::traction("x-max", [0.0, 3.0, 0.0]).over([(0.0, 1.0), (0.3, 0.0)]).unwrap();
            builder.region(rubber().with_thickness(0.1)).support(Support::fixed("x-min")).load(corner)
        },
        start: InitialVelocity::default(),
        scheme: at(DGM, 2),
        exact_tangent: false,
        plan: plan(0.5, 0.05),
    };
    case.assert_equal([2, 4], 1e-12);
}

/// A corner of the block is pushed through its cell: the step is cut on all ranks, and fails in the end with the same
/// error.
#[test]
fn failures_are_those_of_the_whole_body() {
    const HAT: [(f64, f64); 2] = [(0.0, 1.0), (0.1, 0.0)];
    let crushed = |parts| Case {
        mesh: mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap().with_node_group("corner", [44]).unwrap(),
        parts,
        start: InitialVelocity::default(),
        scheme: fe(1),
        exact_tangent: false,
        plan: plan(0.2, 0.02),
    };
    let case = crushed(|builder| {
        let load = Load::nodal_force("corner", [-100.0, 0.0, 0.0]).over(HAT).unwrap();
        builder.region(rubber()).support(Support::fixed("x-min")).load(load)
    });
    assert!(case.whole().unwrap().events.contains(&EventKind::Cut));
    case.assert_equal([2, 3], 1e-9);
    // Without cuts: the cell and the place of the fault, or the node with the largest residual.
    for (force, max_iterations) in [(4e3, 20), (40.0, 1)] {
        let failure = |builder: BodyBuilder| {
            let load = Load::nodal_force("corner", [-force, 0.0, 0.0]);
            let body = builder.region(rubber()).support(Support::fixed("x-min")).load(load).build()?;
            let settings = NewtonSettings { max_iterations, tolerance: 1e-14, ..case.settings() };
            Motion::new(&body, DGM)?.newton(settings)?.step(0.02).cloned()
        };
        let whole = place(&failure(Body::builder(case.mesh.clone())).unwrap_err());
        for error in on_team(&case.mesh, 3, |share, team| failure(Body::shared(share, team)).unwrap_err()) {
            assert_eq!(place(&error), whole, "{error}");
        }
    }
}

/// Cell or node of a failed step, and its position.
fn place(error: &Error) -> (Option<CellKind>, usize, [f64; 3]) {
    match *error {
        Error::CellInverted { cell, kind, position, .. } => (Some(kind), cell, position),
        Error::NoConvergence { node, ref position, .. } => (None, node, **position),
        _ => panic!("{error}"),
    }
}

/// A motion from a snapshot of every rank has the bits of the undisturbed one.
#[test]
fn a_team_resumes_with_the_same_bits() {
    let case = Case::l_block(DGM, 2);
    let ends = on_team(&case.mesh, 3, |share, team| {
        let body = (case.parts)(Body::shared(share, team)).build()?;
        let state = State::initial(&body, 0.0, std::slice::from_ref(&case.start))?;
        let mut motion = Motion::starting(&body, case.scheme, case.settings(), state)?;
        let mut watch = Watch { snapshot_after: Some(4), ..Watch::default() };
        motion.march(&case.plan, &mut [&mut watch])?;
        let snapshot: Snapshot = watch.snapshot.take().unwrap();
        let mut again = Motion::resumed(&body, case.scheme, case.settings(), snapshot)?;
        again.march_on(&case.plan, &mut [])?;
        Ok((motion.record().clone(), motion.state().clone(), again.record().clone(), again.state().clone()))
    });
    for end in ends {
        let (record, state, resumed_record, resumed) = end.map_err(|error: Error| error).unwrap();
        assert_eq!((record, state), (resumed_record, resumed));
    }
}

/// An observer that fails on one rank.
struct Fails(bool);

impl emmy::motion::Observer for Fails {
    fn observe(&mut self, _: emmy::motion::View<'_>) -> emmy::motion::ObserverResult {
        if self.0 { Err("the disk is full".into()) } else { Ok(()) }
    }
}

#[test]
fn an_error_of_one_rank_is_an_error_of_all() {
    let mesh = mesh::l_block(1.0).unwrap();
    let outcomes = on_team(&mesh, 3, |share, team| {
        let rank = team.rank();
        let density = if rank == 1 { -1.0 } else { 0.5 };
        let region = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), density);
        let wrong = Body::shared(share, team).region(region).build().unwrap_err();
        (rank, wrong)
    });
    for (_, error) in outcomes {
        let message = "density must be positive and finite, not -1".to_string();
        assert_eq!(error, Error::OnRank { rank: 1, message });
    }
    let outcomes = on_team(&mesh, 3, |share, team| {
        let mut fails = Fails(team.rank() == 2);
        let body = Body::shared(share, team).region(rubber()).build().unwrap();
        let mut motion = Motion::new(&body, DGM).unwrap();
        Error::from(motion.march(&plan(1.0, 0.1), &mut [&mut fails]).unwrap_err()).to_string()
    });
    assert_eq!(outcomes, ["rank 2: the disk is full", "rank 2: the disk is full", "the disk is full"]);
    // Wrong on all ranks: one message, as of the whole body.
    let outcomes = on_team(&mesh, 2, |share, team| {
        Body::shared(share, team).region(rubber()).support(Support::fixed("nowhere")).build().unwrap_err()
    });
    let whole = Body::builder(mesh).region(rubber()).support(Support::fixed("nowhere")).build().unwrap_err();
    assert_eq!(outcomes, [whole.clone(), whole]);
}

#[test]
fn a_cell_that_is_inverted_in_the_mesh_has_its_number_in_the_whole_mesh() {
    let mut builder = MeshBuilder::new();
    let whole = mesh::block([8.0, 1.0, 1.0], [8, 1, 1]).unwrap();
    whole.points().iter().for_each(|&point| _ = builder.point(point));
    for (index, cell) in whole.cells().enumerate() {
        let mut nodes = cell.nodes.to_vec();
        if index == 6 {
            nodes.rotate_left(4);
        }
        builder.cell(cell.kind, &nodes).unwrap();
    }
    let mesh = builder.build().unwrap();
    let errors =
        on_team(&mesh, 2, |share, team| Body::shared(share, team).region(rubber()).build().unwrap_err());
    for error in errors {
        assert!(error.to_string().contains("cell 6 "), "{error}");
    }
}

/// The message with which all ranks of a team reject a request.
fn asked(
    parts: impl Fn(BodyBuilder) -> BodyBuilder + Sync,
    ask: impl Fn(&Body) -> Result<()> + Sync,
) -> String {
    let mesh = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let errors = on_team(&mesh, 2, |share, team| {
        let body = parts(Body::shared(share, team)).build();
        body.and_then(|body| ask(&body)).unwrap_err().to_string()
    });
    assert_eq!(errors[0], errors[1]);
    errors[0]
        .strip_suffix(" is not possible on a team")
        .unwrap_or_else(|| panic!("{}", errors[0]))
        .to_string()
}

#[test]
fn what_a_team_does_not_compute_is_rejected() {
    let region = |b: BodyBuilder| b.region(rubber());
    let with = |scheme: Scheme, solver: Solver| {
        let settings = NewtonSettings { solver, ..Default::default() };
        asked(region, move |body| {
            Motion::starting(body, scheme, settings, State::initial(body, 0.0, &[])?).map(|_| ())
        })
    };
    let factorisation = "a factorisation without MUMPS (feature `petsc` of emmy-mpi)";
    assert_eq!(with(DGM, Solver::Direct), factorisation);
    assert_eq!(with("Bathe".parse().unwrap(), Solver::Direct), factorisation);
    assert_eq!(asked(region, |body| emmy::modes::modes(body, 3).map(|_| ())), "a search for natural modes");
    let adjoint = |body: &Body| emmy::adjoint::Trajectory::new(&Motion::new(body, DGM)?).map(|_| ());
    assert_eq!(asked(region, adjoint), "an adjoint");
    let firm = |b: BodyBuilder| {
        let firm = Region::new(NeoHooke::new(1e6, 500.0).unwrap(), 0.5);
        b.region(firm.with_formulation(Formulation::ProjectedVolume(None)))
            .support(Support::fixed("x-min"))
            .load(Load::acceleration([0.0, 0.0, 1.0]))
    };
    let stiff = "a factorisation, which these stiff projected volumes need, without MUMPS (feature `petsc` of emmy-mpi)";
    let step = |body: &Body| match Motion::new(body, DGM)?.step(0.1) {
        Err(Error::StepFailed { cause, .. }) => Err(*cause),
        outcome => outcome.map(|_| ()),
    };
    assert_eq!(asked(firm, step), stiff);
    // Smaller steps would need no factorisation, but a thousand times as many of them are no way out.
    let march = |body: &Body| {
        let mut motion = Motion::new(body, DGM)?;
        motion.allow_cuts(None);
        let plan = StepPlan::new(0.0, vec![Phase { until: 0.1, size: 0.1 }])?;
        match motion.march(&plan, &mut []) {
            Err(MarchError::Step(Error::StepFailed { cause, .. })) => Err(*cause),
            outcome => panic!("{outcome:?}"),
        }
    };
    assert_eq!(asked(firm, march), stiff);

    // Shares of two partitions.
    let mesh = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let errors = Threads::run(2, |team| {
        let owners: Vec<u32> = (0..45).map(|node| u32::from(node > 20 + team.rank())).collect();
        Body::shared(Share::new(&mesh, &owners, team.rank()), team)
            .region(rubber())
            .build()
            .unwrap_err()
            .to_string()
    });
    assert_eq!(errors.unwrap(), ["a body of shares of different partitions is not possible on a team"; 2]);
    // A share of another rank.
    let mesh = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let owners = mesh::owners(&mesh, 2).unwrap();
    let errors = Threads::run(2, |team| {
        let owners: Vec<u32> =
            owners.iter().map(|&rank| if team.rank() == 0 { rank } else { 1 - rank }).collect();
        Body::shared(Share::new(&mesh, &owners, 0), team).region(rubber()).build().unwrap_err().to_string()
    });
    assert!(
        errors
            .unwrap()
            .iter()
            .all(|error| error.contains("the share of rank 0 on rank 1 is not possible on a team"))
    );
}

/// A changed velocity is found on every rank, at the same node of the whole mesh; states of a driven team are not.
#[test]
fn starts_of_a_team_belong_to_the_body() {
    let mesh = mesh::l_block(1.0).unwrap();
    let node = mesh.n_nodes() - 1;
    let start = |builder: BodyBuilder| -> Result<()> {
        let body = builder.region(rubber()).build()?;
        let mut state = State::initial(&body, 0.0, &[])?;
        let own = body.ranks().nodes().iter().position(|&whole| whole as usize == node);
        own.into_iter().for_each(|own| state.velocity[3 * own] = 1.0);
        Motion::starting(&body, DGM, NewtonSettings::default(), state).map(|_| ())
    };
    let whole = start(Body::builder(mesh.clone())).unwrap_err();
    assert!(matches!(whole, Error::StartMomentum { .. }), "{whole}");
    for error in on_team(&mesh, 3, |share, team| start(Body::shared(share, team)).unwrap_err()) {
        assert_eq!(error.to_string(), whole.to_string());
    }
    let driven = |builder: BodyBuilder| -> Result<()> {
        let angle = TimeFunction::smooth("t^2", |t| [t * t, 2.0 * t, 2.0]);
        let rotation = Rotation { axis: [0.0, 0.0, 1.0], about: [0.0; 3], angle };
        let turned = Support { group: "face-a".into(), rotation: Some(rotation), ..Default::default() };
        let body = builder.region(rubber()).support(turned).build()?;
        let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
        let mut first = Motion::starting(&body, DGM, settings, State::initial(&body, 0.0, &[])?)?;
        (0..3).try_for_each(|_| first.step(0.05).map(|_| ()))?;
        Motion::starting(&body, at(DGM, 2), settings, first.state().clone()).map(|_| ())
    };
    for outcome in on_team(&mesh, 3, |share, team| driven(Body::shared(share, team))) {
        outcome.unwrap();
    }
}
