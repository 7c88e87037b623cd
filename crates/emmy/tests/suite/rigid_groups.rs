//! Rigid bodies that have nodes of a mesh: cells that move as one, and faces of elastic bodies on rigid frames.

#![allow(non_snake_case)]

use crate::shared::joints::{hinge, rigid};
use crate::shared::schemes::{DGM, at, dgm};
use emmy::body::{Formulation, GroundSpring, PointTerms, RegionSummary};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::MeshBuilder;
use emmy::motion::{Adaptivity, NewtonSettings, Record};
use emmy::prelude::*;

fn rubber(density: f64) -> Region {
    Region::new(NeoHooke::new(4000.0, 2000.0).unwrap(), density)
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| (a[d] - b[d]).powi(2)).sum::<f64>().sqrt()
}

fn spin(angular_velocity: [f64; 3]) -> InitialVelocity {
    InitialVelocity { angular_velocity, ..Default::default() }
}

fn started<'b>(body: &'b Body, scheme: Scheme, fields: &[InitialVelocity]) -> Motion<'b> {
    let state = State::initial(body, 0.0, fields).unwrap();
    Motion::starting(body, scheme, NewtonSettings::default(), state).unwrap()
}

/// A box of hexahedra from a corner.
struct Part {
    corner: [f64; 3],
    size: [f64; 3],
    cells: [usize; 3],
}

/// A mesh of boxes that share no nodes; each is the group of cells of its name.
fn boxes(parts: &[(&str, Part)]) -> MeshBuilder {
    let mut mesh = MeshBuilder::new();
    for (name, Part { corner, size, cells }) in parts {
        let own = mesh::block(*size, *cells).unwrap();
        let nodes: Vec<u32> =
            own.points().iter().map(|X| mesh.point([0, 1, 2].map(|d| corner[d] + X[d]))).collect();
        for cell in own.cells() {
            let moved: Vec<u32> = cell.nodes.iter().map(|&node| nodes[node as usize]).collect();
            let number = mesh.cell(cell.kind, &moved).unwrap();
            mesh.cell_group(name, [number]);
        }
    }
    mesh
}

/// The mesh with the nodes that are chosen as a group.
fn with_nodes(mesh: Mesh, name: &str, is_chosen: impl Fn([f64; 3]) -> bool) -> Mesh {
    let nodes: Vec<u32> =
        (0..).zip(mesh.points()).filter(|(_, X)| is_chosen(**X)).map(|(node, _)| node).collect();
    mesh.with_node_group(name, nodes).unwrap()
}

/// A beam along x, 4 x 1 x 1, whose cells beyond x = 2 are the group `tip-cells`.
fn beam() -> Mesh {
    let [corner, size] = [[0.0; 3], [2.0, 1.0, 1.0]];
    let root = Part { corner, size, cells: [2, 1, 2] };
    let tip = Part { corner: [2.0, 0.0, 0.0], size, cells: [2, 1, 2] };
    let apart = boxes(&[("root", root), ("tip-cells", tip)]).build().unwrap();
    // One node for both parts where they meet.
    let mut merged = MeshBuilder::new();
    let mut seen: Vec<[f64; 3]> = Vec::new();
    let number_of = apart.points().iter().map(|X| {
        seen.iter().position(|Y| distance(*X, *Y) < 1e-9).unwrap_or_else(|| {
            seen.push(*X);
            seen.len() - 1
        }) as u32
    });
    let number_of: Vec<u32> = number_of.collect();
    seen.iter().for_each(|X| _ = merged.point(*X));
    for (number, cell) in (0..).zip(apart.cells()) {
        let nodes: Vec<u32> = cell.nodes.iter().map(|&node| number_of[node as usize]).collect();
        merged.cell(cell.kind, &nodes).unwrap();
        let name =
            if apart.groups().cells("tip-cells").unwrap().contains(&number) { "tip-cells" } else { "root" };
        merged.cell_group(name, [number]);
    }
    merged.build().unwrap()
}

/// A group of cells has mass, centre and inertia of its region, and moves as the body with these numbers.
#[test]
fn a_rigid_region_moves_as_the_body_of_its_mass() {
    let mesh = mesh::block([1.0, 0.6, 0.4], [3, 2, 1]).unwrap();
    let with_cells =
        Body::builder(mesh).region(rubber(5.0)).rigid(RigidBody::group("brick", "body")).build().unwrap();
    let own = &with_cells.regions()[0];
    let inertia = [0, 1, 2].map(|d| own.inertia[d][d]);
    let alone = RigidBody::new("brick", own.mass, own.centre, inertia);
    let alone = Body::builder(Mesh::without_cells()).rigid(alone).build().unwrap();
    let exact = [[0.6, 0.4], [1.0, 0.4], [1.0, 0.6]].map(|[a, b]: [f64; 2]| 1.2 * (a * a + b * b) / 12.0);
    assert!(distance(inertia, exact) < 1e-13 && (own.mass - 1.2).abs() < 1e-13, "{own:?}");
    let flies = InitialVelocity { velocity: [0.3, -0.2, 0.1], ..spin([2.0, -1.0, 1.5]) };
    for k in 1..=3 {
        let mut motions =
            [&with_cells, &alone].map(|body| started(body, at(DGM, k), std::slice::from_ref(&flies)));
        for step in 0..=20 {
            let [meshed, alone] = motions.each_ref().map(Motion::record);
            let what = format!("k = {k}, step {step}");
            assert!(
                (meshed.kinetic_energy - alone.kinetic_energy).abs() < 1e-13,
                "{what}: {meshed:?} {alone:?}"
            );
            assert!(distance(meshed.angular_momentum, alone.angular_momentum) < 1e-12, "{what}");
            assert!(distance(meshed.linear_momentum, alone.linear_momentum) < 1e-13, "{what}");
            let [own, other] = [meshed, alone].map(|record| record.rigid_bodies[0]);
            assert!(distance(own.position, other.position) < 1e-12, "{what}: {own:?} {other:?}");
            (0..3).for_each(|i| assert!(distance(own.axes[i], other.axes[i]) < 1e-12, "{what}"));
            assert!(meshed.strain_energy == 0.0 && meshed.constraint_residual < 1e-14, "{what}: {meshed:?}");
            motions.iter_mut().for_each(|motion| _ = motion.step(0.1).unwrap());
        }
        // The nodes of the mesh are those of a rigid body.
        let (state, own) = (motions[0].state(), motions[0].record().rigid_bodies[0]);
        let centre = with_cells.rigid_bodies().next().unwrap().centre.unwrap();
        for (node, X) in with_cells.mesh().points().iter().enumerate() {
            let place = |d: usize| (0..3).map(|i| own.axes[i][d] * (X[i] - centre[i])).sum::<f64>();
            let expected = [0, 1, 2].map(|d| own.position[d] + place(d));
            assert!(distance(state.position(&with_cells, node), expected) < 1e-13, "k = {k}: {node}");
        }
    }
}

/// A mass in addition, at a centre of its own.
#[test]
fn a_mass_adds_to_that_of_the_cells() {
    let mesh = || mesh::block([1.0, 0.6, 0.4], [1; 3]).unwrap();
    let (mass, centre, moments) = (0.7, [0.2, 0.9, -0.3], [0.05, 0.04, 0.06]);
    let added = RigidBody { group: Some("body".into()), ..RigidBody::new("brick", mass, centre, moments) };
    let with_cells = Body::builder(mesh()).region(rubber(5.0)).rigid(added).build().unwrap();
    assert_eq!(with_cells.regions().len(), 2);
    let whole = RegionSummary::combined(with_cells.regions());
    let inertia = [0, 1, 2].map(|i| [0, 1, 2].map(|j| 0.5 * (whole.inertia[i][j] + whole.inertia[j][i])));
    let joined = RigidBody { inertia: Some(inertia), ..RigidBody::point("brick", whole.mass, whole.centre) };
    let alone = Body::builder(Mesh::without_cells()).rigid(joined).build().unwrap();
    let mut motions = [&with_cells, &alone].map(|body| started(body, at(DGM, 2), &[spin([2.0, -1.0, 1.5])]));
    (0..20).for_each(|_| motions.iter_mut().for_each(|motion| _ = motion.step(0.1).unwrap()));
    let [meshed, alone] = motions.each_ref().map(Motion::record);
    assert!((meshed.kinetic_energy - alone.kinetic_energy).abs() < 1e-12, "{meshed:?} {alone:?}");
    assert!(distance(meshed.angular_momentum, alone.angular_momentum) < 1e-12);
    let axes = alone.rigid_bodies[0].axes;
    let place = |d: usize| (0..3).map(|i| axes[i][d] * (centre[i] - whole.centre[i])).sum::<f64>();
    let expected = [0, 1, 2].map(|d| alone.rigid_bodies[0].position[d] + place(d));
    assert!(distance(meshed.rigid_bodies[0].position, expected) < 1e-12, "{meshed:?} {expected:?}");
}

/// An elastic beam with a rigid tip, or a rigid face, tumbles.
fn assert_balances(body: &Body, scheme: Scheme, n: usize) -> Record {
    let flies = InitialVelocity { velocity: [0.3, -0.2, 0.1], ..spin([1.0, -0.7, 1.2]) };
    let mut motion = started(body, scheme, &[flies]);
    let first = motion.record().clone();
    let mut strain = 0.0f64;
    for _ in 0..n {
        let record = motion.step(0.1).unwrap();
        assert!(record.energy_residual.abs() < 1e-12 * first.total_energy.max(1.0), "{scheme}: {record:?}");
        let moved = distance(record.angular_momentum, first.angular_momentum);
        assert!(moved < 1e-12 * distance(first.angular_momentum, [0.0; 3]).max(1.0), "{scheme}: {moved:e}");
        assert!(distance(record.linear_momentum, first.linear_momentum) < 1e-12, "{scheme}: {record:?}");
        assert!(record.constraint_residual < 1e-13, "{scheme}: {record:?}");
        strain = strain.max(record.strain_energy);
    }
    assert!(strain > 1e-5, "{scheme}: {strain:e}");
    motion.record().clone()
}

#[test]
fn elastic_bodies_with_rigid_parts_keep_energy_and_momenta() {
    let tip = Body::builder(beam())
        .region(rubber(1.0))
        .rigid(RigidBody::group("tip", "tip-cells"))
        .build()
        .unwrap();
    assert_eq!(tip.n_followers(), 3 * 2 * 3);
    let modes = emmy::modes::modes(&tip, 7).unwrap();
    assert_eq!(modes.iter().filter(|mode| mode.angular_frequency == 0.0).count(), 6);
    let face = with_nodes(beam(), "face", |X| X[0] == 4.0);
    // Their plane leaves a direction without mass; so it does with a centre off it.
    let centre = Some([4.7, 0.1, 0.2]);
    for plate in
        [RigidBody::group("plate", "face"), RigidBody { centre, ..RigidBody::group("plate", "face") }]
    {
        let plate = Body::builder(face.clone()).region(rubber(1.0)).rigid(plate).build().unwrap();
        for k in 1..=3 {
            assert_balances(&plate, at(DGM, k), 30);
        }
        let last = assert_balances(&plate, at(dgm(0.5), 2), 1);
        assert!(last.dissipated_energy > 0.0);
    }
    for k in 1..=3 {
        assert_balances(&tip, at(DGM, k), 30);
    }
}

/// The discrete motion does not depend on the centre of a frame, which only names its nodes.
#[test]
fn the_centre_of_a_face_does_not_matter() {
    let face = with_nodes(beam(), "face", |X| X[0] == 4.0);
    let plate = |centre| {
        let plate = RigidBody { centre, ..RigidBody::group("plate", "face") };
        let body = Body::builder(face.clone()).region(rubber(1.0)).rigid(plate).build().unwrap();
        assert_balances(&body, at(DGM, 2), 20)
    };
    let [own, other] = [None, Some([4.7, 0.1, 0.2])].map(plate);
    assert!((own.strain_energy - other.strain_energy).abs() < 1e-11, "{own:?} {other:?}");
    assert!((own.kinetic_energy - other.kinetic_energy).abs() < 1e-11, "{own:?} {other:?}");
}

/// A rigid body is the limit of stiff ones.
#[test]
fn stiff_parts_become_rigid() {
    let flies = spin([0.4, -0.3, 0.5]);
    let end = |body: &Body| {
        let mut motion = started(body, at(DGM, 2), std::slice::from_ref(&flies));
        (0..20).for_each(|_| _ = motion.step(0.05).unwrap());
        (motion.state().position(body, 0), motion.record().strain_energy)
    };
    let soft = || rubber(1.0).on("root");
    let tip = RigidBody::group("tip", "tip-cells");
    let limit =
        Body::builder(beam()).regions([soft(), rubber(1.0).on("tip-cells")]).rigid(tip).build().unwrap();
    let (place, energy) = end(&limit);
    let mut last = f64::INFINITY;
    for stiffness in [1e2, 1e4, 1e6] {
        let stiff = NeoHooke::new(4000.0 * stiffness, 2000.0 * stiffness).unwrap();
        let body =
            Body::builder(beam()).regions([soft(), Region::new(stiff, 1.0).on("tip-cells")]).build().unwrap();
        let (own, own_energy) = end(&body);
        let error = distance(own, place) + (own_energy - energy).abs();
        assert!(error < 20.0 / stiffness && error < 0.1 * last, "{stiffness:e}: {error:e}");
        last = error;
    }
}

/// Two panels unfold from a hub on driven hinges: numbers of an independent implementation.
#[test]
fn a_satellite_unfolds_as_elsewhere() {
    let panel = |x: f64| Part { corner: [x, -0.5, 0.0], size: [3.0, 1.0, 0.4], cells: [3, 1, 1] };
    let mesh = boxes(&[("right", panel(0.5)), ("left", panel(-3.5))]).build().unwrap();
    let mesh = with_nodes(mesh, "right-root", |X| X[0] == 0.5);
    let mesh = with_nodes(mesh, "left-root", |X| X[0] == -0.5);
    let node = |X: [f64; 3]| mesh.points().iter().position(|Y| distance(*Y, X) < 1e-12).unwrap();
    let corners = [3.5, -3.5].map(|x| node([x, 0.5, 0.0]));
    let angle = |sign: f64| {
        TimeFunction::smooth("unfolds", move |t| {
            let (duration, whole) = (2.0, sign * std::f64::consts::FRAC_PI_2);
            let turn = 2.0 * std::f64::consts::PI / duration;
            let value = t / duration - (turn * t).sin() / (2.0 * std::f64::consts::PI);
            [
                whole * value,
                whole * (1.0 - (turn * t).cos()) / duration,
                whole * turn * (turn * t).sin() / duration,
            ]
        })
    };
    let mut builder =
        Body::builder(mesh).region(rubber(0.5)).rigid(RigidBody::new("hub", 5.0, [0.0; 3], [1.2, 1.0, 1.5]));
    for (side, x, sign) in [("right", 0.5, 1.0), ("left", -0.5, -1.0)] {
        let at = [x, 0.0, 0.2];
        let root =
            RigidBody { centre: Some(at), ..RigidBody::group(side.to_uppercase(), format!("{side}-root")) };
        let between = [rigid(&root.name), rigid("hub")];
        builder = builder.rigid(root).joint(hinge(side, between, at, [0.0, 1.0, 0.0]).driven(angle(sign)));
    }
    let body = builder.build().unwrap();
    for (k, h, [kinetic, strain, work], hub, right, left) in [
        (
            1,
            0.05,
            [3.354854533905923, 0.315554696060852, 3.079589229966767],
            [0.02972145919234054, -0.022516079314583756, 0.2866909619402451],
            [-0.68066357782316, -0.2638713926092995, -2.427457821228483],
            [-0.5957919404789993, -0.2308962077471466, -2.45277629542522],
        ),
        (
            2,
            0.05,
            [3.364297573555207, 0.3566908721616583, 3.1301684457168566],
            [0.02977523032919386, -0.02249442516014223, 0.28678215451443423],
            [-0.6879543607243477, -0.25529733088673334, -2.4285602485801836],
            [-0.5882343525377194, -0.2411735258295048, -2.4557980016198595],
        ),
        (
            3,
            0.1,
            [3.363472745852578, 0.3570020978007532, 3.129654843653331],
            [0.02977522351035436, -0.02249539518783592, 0.28678518293634103],
            [-0.6877599413380668, -0.2554667039453804, -2.4284738847487195],
            [-0.5883898845244371, -0.24101350224734763, -2.4556754628687205],
        ),
    ] {
        let mut motion = started(&body, at(DGM, k), &[spin([0.1, 0.0, 0.4])]);
        let first = motion.record().clone();
        let mut corrections = 0;
        for _ in 0..(2.5f64 / h).round() as usize {
            let record = motion.step(h).unwrap();
            corrections += record.newton_iterations;
            assert!(record.energy_residual.abs() < 1e-11, "k = {k}: {record:?}");
            assert!(distance(record.angular_momentum, first.angular_momentum) < 1e-11, "k = {k}: {record:?}");
            assert!(distance(record.linear_momentum, first.linear_momentum) < 1e-12, "k = {k}: {record:?}");
        }
        let record = motion.record();
        assert!((record.kinetic_energy - kinetic).abs() < 1e-8, "k = {k}: {}", record.kinetic_energy);
        assert!((record.strain_energy - strain).abs() < 1e-8, "k = {k}: {}", record.strain_energy);
        assert!((record.external_work - work).abs() < 1e-8, "k = {k}: {}", record.external_work);
        assert!(distance(record.rigid_bodies[0].position, hub) < 1e-8, "k = {k}: {record:?}");
        for (node, expected) in corners.into_iter().zip([right, left]) {
            let q = motion.state().position(&body, node);
            assert!(distance(q, expected) < 1e-8, "k = {k}: {q:?}");
        }
        assert!(corrections < 800, "k = {k}: {corrections}");
    }
}

/// A crank turns a flexible rod, whose other end slides; pins and slider are nodes. Numbers of an independent
/// implementation.
#[test]
fn a_slider_crank_with_a_flexible_rod_moves_as_elsewhere() {
    let rod = Part { corner: [1.0, -0.25, 0.0], size: [4.0, 0.5, 0.5], cells: [4, 2, 1] };
    let mesh = boxes(&[("rod", rod)]).build().unwrap();
    let is_on_axis = |X: [f64; 3], x: f64| X[0] == x && X[1] == 0.0;
    let mesh = with_nodes(mesh, "slider", |X| is_on_axis(X, 5.0));
    let node = |X: [f64; 3]| mesh.points().iter().position(|Y| distance(*Y, X) < 1e-12).unwrap();
    let pins = [[1.0, 0.0, 0.0], [1.0, 0.0, 0.5]];
    let nodes = pins.map(node);
    let end = node([5.0, 0.0, 0.0]);
    let turns = TimeFunction::smooth("2*t", |t| [2.0 * t, 2.0, 0.0]);
    let masses = vec![PointMass { group: "slider".into(), mass: 0.5 }];
    let mut builder = Body::builder(mesh)
        .region(rubber(1.0))
        .point_terms(PointTerms { masses, ..Default::default() })
        .support(Support::of_components("slider", [false, true, false]))
        .rigid(RigidBody::new("crank", 1.0, [0.5, 0.0, 0.25], [0.05, 0.1, 0.1]))
        .joint(
            hinge("drive", [rigid("crank"), JointEnd::Ground], [0.0, 0.0, 0.25], [0.0, 0.0, 1.0])
                .driven(turns),
        );
    for (number, (at, node)) in pins.into_iter().zip(nodes).enumerate() {
        let ends = [JointEnd::Node(node as u32), rigid("crank")];
        builder = builder.joint(Joint::new(format!("pin-{number}"), JointKind::Spherical, ends, at));
    }
    let body = builder.build().unwrap();
    let start = [
        InitialVelocity { group: Some("crank".into()), ..spin([0.0, 0.0, 2.0]) },
        InitialVelocity { group: Some("rod".into()), about: [5.0, 0.0, 0.0], ..spin([0.0, 0.0, -0.5]) },
    ];
    for (k, h, strain, work, x) in [
        (1, 0.05, 0.007836734775890513, 1.0249884384253467, 3.2791779610651806),
        (2, 0.05, 0.09901477589188931, 0.9430494466554353, 3.249838512634586),
        (2, 0.1, 0.07140075918941384, 0.9048611283997423, 3.254064678036646),
    ] {
        let mut motion = started(&body, at(DGM, k), &start);
        for _ in 0..(2.0f64 / h).round() as usize {
            let record = motion.step(h).unwrap();
            assert!(record.energy_residual.abs() < 1e-11, "k = {k}: {record:?}");
        }
        let record = motion.record();
        assert!((record.strain_energy - strain).abs() < 1e-8, "k = {k}: {}", record.strain_energy);
        assert!((record.external_work - work).abs() < 1e-8, "k = {k}: {}", record.external_work);
        assert!((motion.state().position(&body, end)[0] - x).abs() < 1e-8, "k = {k}");
    }
}

/// Loads on the nodes and facets of a rigid body have its resultant and its moment.
#[test]
fn loads_on_a_rigid_group_act_on_its_body() {
    let mesh = || mesh::block([1.0, 0.6, 0.4], [2, 1, 1]).unwrap();
    let end = |body: &Body| {
        let mut motion = Motion::new(body, at(DGM, 2)).unwrap();
        for _ in 0..20 {
            let record = motion.step(0.05).unwrap();
            assert!(record.energy_residual.abs() < 1e-12, "{record:?}");
            assert!(record.linear_momentum_residual < 1e-12 && record.angular_momentum_residual < 1e-12);
        }
        motion.record().rigid_bodies[0]
    };
    let group = || Body::builder(mesh()).region(rubber(5.0)).rigid(RigidBody::group("brick", "body"));
    // The force of a face has its resultant in the middle of it, as equal forces at its nodes.
    let force = [0.2, -0.5, 1.0];
    let pushed = end(&group().load(Load::force("x-max", force)).build().unwrap());
    let corner = with_nodes(mesh(), "middle-0", |X| X[0] == 1.0);
    let at_nodes = Body::builder(corner)
        .region(rubber(5.0))
        .rigid(RigidBody::group("brick", "body"))
        .load(Load::nodal_force("middle-0", force.map(|f| 0.25 * f)))
        .build()
        .unwrap();
    let at_nodes = end(&at_nodes);
    assert!(
        distance(pushed.position, at_nodes.position) < 1e-12
            && distance(pushed.axes[0], at_nodes.axes[0]) < 1e-12
    );
    // F t^2 / (2 m), with the mass 1.2 at t = 1.
    let centre = [0.5, 0.3, 0.2];
    let expected = [0, 1, 2].map(|d| centre[d] + 0.5 * force[d] / 1.2);
    assert!(distance(pushed.position, expected) < 1e-12, "{pushed:?} {expected:?}");
    assert!(distance(pushed.spin, [0.0; 3]) > 0.1);
    // A pressure turns with the face: 0.24 of area push along -x.
    let pressed = end(&group().load(Load::pressure("x-max", 0.8)).build().unwrap());
    assert!((pressed.position[0] - (0.5 - 0.5 * 0.8 * 0.24 / 1.2)).abs() < 1e-12, "{pressed:?}");
    // Weight, a point mass at a node, and a force on the body by its name.
    let falls = end(&group().load(Load::acceleration([0.0, 0.0, -10.0])).build().unwrap());
    assert!(distance(falls.position, [0.5, 0.3, 0.2 - 5.0]) < 1e-11, "{falls:?}");
    let named = end(&group().load(Load::nodal_force("brick", force)).build().unwrap());
    assert!(
        distance(named.position, expected) < 1e-12 && distance(named.spin, [0.0; 3]) < 1e-13,
        "{named:?}"
    );
}

/// A spring hangs on a node of a rigid body, and a tie follows a face of it.
#[test]
fn ties_and_joints_at_nodes_of_a_rigid_group_follow_its_body() {
    let [corner, size] = [[0.0; 3], [1.0, 1.0, 1.0]];
    let lower = Part { corner, size, cells: [1; 3] };
    let upper = Part { corner: [0.0, 0.0, 1.0], size, cells: [2; 3] };
    let mesh = boxes(&[("lower", lower), ("upper", upper)]).build().unwrap();
    let n = mesh.groups().cells("lower").unwrap().len();
    assert_eq!(n, 1);
    // The nodes of the lower face of the upper block lie on the cell of the lower one.
    let upper_nodes = mesh.group_nodes("upper").unwrap();
    let feet: Vec<u32> =
        upper_nodes.into_iter().filter(|&node| mesh.points()[node as usize][2] == 1.0).collect();
    let mesh = mesh.with_node_group("feet", feet).unwrap();
    let build = |tie: Tie| {
        Body::builder(mesh.clone())
            .region(rubber(1.0))
            .rigid(RigidBody::group("base", "lower"))
            .tie(tie)
            .build()
    };
    let body = build(Tie::nodes("feet", "lower")).unwrap();
    assert_eq!(body.n_followers(), 8 + 9);
    for k in 1..=2 {
        assert_balances(&body, at(DGM, k), 20);
    }
    let error = build(Tie::nodes("lower", "feet").with_tolerance(3.0)).unwrap_err().to_string();
    assert!(error.contains("belongs to the rigid body \"base\" and follows that; swap"), "{error}");
    // A node of the group in a joint is a point of the body.
    let pinned = |end: JointEnd| {
        let pin = Joint::new("pin", JointKind::Spherical, [end, JointEnd::Ground], [0.0; 3]);
        let body = Body::builder(mesh::block(size, [1; 3]).unwrap())
            .region(rubber(1.0))
            .rigid(RigidBody::group("base", "body"))
            .load(Load::acceleration([0.0, 0.0, -10.0]))
            .joint(pin)
            .build()
            .unwrap();
        assert_eq!(body.mobility().degrees_of_freedom, Some(3));
        let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
        (0..10).for_each(|_| _ = motion.step(0.05).unwrap());
        motion.record().rigid_bodies[0].position
    };
    assert!(distance(pinned(rigid("base")), pinned(JointEnd::Node(0))) < 1e-13);
}

/// A moment on a rigid region is that on the body of its mass. A face whose hinge is released keeps its balances,
/// though a direction of its frame has no mass.
#[test]
fn moments_and_releases_meet_rigid_groups() {
    let moment = [0.3, -0.2, 0.5];
    let mesh = mesh::block([1.0, 0.6, 0.4], [3, 2, 1]).unwrap();
    let with_cells = Body::builder(mesh).region(rubber(5.0)).rigid(RigidBody::group("brick", "body"));
    let with_cells = with_cells.load(Load::moment("brick", moment)).build().unwrap();
    let own = &with_cells.regions()[0];
    let alone = RigidBody::new("brick", own.mass, own.centre, [0, 1, 2].map(|d| own.inertia[d][d]));
    let alone = Body::builder(Mesh::without_cells()).rigid(alone).load(Load::moment("brick", moment));
    let alone = alone.build().unwrap();
    let mut motions = [&with_cells, &alone].map(|body| started(body, at(DGM, 2), &[spin([2.0, -1.0, 1.5])]));
    let start = motions[0].record().angular_momentum;
    for _ in 0..20 {
        motions.iter_mut().for_each(|motion| _ = motion.step(0.1).unwrap());
        let [meshed, alone] = motions.each_ref().map(Motion::record);
        let growth = [0, 1, 2].map(|d| start[d] + meshed.time * moment[d]);
        assert!(distance(meshed.angular_momentum, growth) < 1e-12, "{meshed:?}");
        assert!(distance(meshed.rigid_bodies[0].position, alone.rigid_bodies[0].position) < 1e-12);
        assert!(meshed.energy_residual.abs() < 1e-12, "{meshed:?}");
    }
    let mesh = with_nodes(beam(), "end", |X| X[0] == 0.0);
    let released =
        hinge("pin", [rigid("plate"), JointEnd::Ground], [0.0, 0.5, 0.5], [0.0, 0.0, 1.0]).until(0.5);
    let body =
        Body::builder(mesh).region(rubber(1.0)).rigid(RigidBody::group("plate", "end")).joint(released);
    let body = body.build().unwrap();
    for k in 1..=3 {
        let mut motion = started(&body, at(DGM, k), &[spin([0.0, 0.0, 1.5])]);
        let energy = motion.record().total_energy;
        let mut free: Option<[[f64; 3]; 2]> = None;
        for n in 1..=20 {
            let record = motion.step(0.05).unwrap();
            let kept = record.total_energy - record.external_work;
            assert!(
                (kept - energy).abs() < 1e-11 && record.constraint_residual < 1e-13,
                "k = {k}: {record:?}"
            );
            assert!(record.angular_momentum_residual < 1e-12, "k = {k}: {record:?}");
            if n > 10 {
                let own = [record.linear_momentum, record.angular_momentum];
                let first = free.get_or_insert(own);
                assert!((0..2).all(|i| distance(first[i], own[i]) < 1e-11), "k = {k}, step {n}: {record:?}");
            }
        }
    }
}

#[test]
fn impossible_rigid_groups_are_refused() {
    let with = |rigid: &[RigidBody]| {
        let builder =
            Body::builder(with_nodes(beam(), "edge", |X| X[0] == 4.0 && X[1] == 0.0)).region(rubber(1.0));
        rigid.iter().fold(builder, |builder, own| builder.rigid(own.clone()))
    };
    let says = |built: emmy::Result<Body>, words: &str| {
        let error = built.unwrap_err().to_string();
        assert!(error.contains(words), "{error}\n{words}");
    };
    let edge = RigidBody::group("pins", "edge");
    let line = "the nodes of \"edge\" lie on a line, about which nothing holds the body; add a node off it, or give mass, centre and inertia";
    says(with(std::slice::from_ref(&edge)).build(), line);
    // With an inertia a line of nodes is a handle.
    let handle = RigidBody {
        group: Some("edge".into()),
        ..RigidBody::new("pins", 1.0, [4.0, 0.0, 0.5], [0.1, 0.1, 0.1])
    };
    assert_balances(&with(std::slice::from_ref(&handle)).build().unwrap(), at(DGM, 2), 20);
    let tip = RigidBody::group("tip", "tip-cells");
    says(with(&[tip.clone(), handle]).build(), "belongs to \"tip\", too; make them one body, or join them");
    let held = with(std::slice::from_ref(&tip)).support(Support::fixed("edge"));
    says(
        held.build(),
        "belongs to the rigid body \"tip\"; hold the body instead, as by a fixed joint to the ground",
    );
    says(with(&[RigidBody::group("tip", "top")]).build(), "top");
    let modes = rubber(1.0).with_formulation(Formulation::IncompatibleModes);
    let body = Body::builder(beam()).region(modes).rigid(tip);
    says(body.build(), "it is part of a rigid body, which has no incompatible modes");
    let plane = mesh::rectangle([1.0, 1.0], [1, 1]).unwrap();
    let plane = Body::builder(plane).region(rubber(1.0)).rigid(RigidBody::group("plate", "body"));
    says(plane.build(), "cells in plane strain cannot be rigid");
    let nowhere = RigidBody { centre: None, ..RigidBody::point("ball", 1.0, [0.0; 3]) };
    says(Body::builder(Mesh::without_cells()).rigid(nowhere).build(), "it needs a centre, or a group");
}

/// A flat body has no mass in the third direction of its frame; it turns as its moments tell.
#[test]
fn flat_bodies_tumble() {
    let plate = RigidBody::new("plate", 2.0, [0.0; 3], [0.3, 0.5, 0.8]);
    let flat = Body::builder(Mesh::without_cells()).rigid(plate.clone()).build().unwrap();
    let thick = RigidBody::new("plate", 2.0, [0.0; 3], [0.3, 0.5, 0.8 - 1e-6]);
    let thick = Body::builder(Mesh::without_cells()).rigid(thick).build().unwrap();
    for k in 1..=3 {
        let [flat, thick] = [&flat, &thick].map(|body| {
            let mut motion = started(body, at(DGM, k), &[spin([1.0, -0.8, 0.5])]);
            let energy = motion.record().kinetic_energy;
            for _ in 0..20 {
                let record = motion.step(0.1).unwrap();
                assert!((record.kinetic_energy - energy).abs() < 1e-13, "k = {k}: {record:?}");
                assert!(record.angular_momentum_residual < 1e-13, "k = {k}: {record:?}");
            }
            motion.record().rigid_bodies[0]
        });
        (0..3).for_each(|i| {
            assert!(distance(flat.axes[i], thick.axes[i]) < 2e-5, "k = {k}: {flat:?} {thick:?}")
        });
    }
}

#[test]
fn motions_with_rigid_groups_are_adaptive_and_resumed_bit_for_bit() {
    let face = with_nodes(beam(), "face", |X| X[0] == 4.0);
    let axis = [0.0, 1.0, 0.0];
    let body = Body::builder(face)
        .region(rubber(1.0))
        .rigid(RigidBody::group("plate", "face"))
        .joint(hinge("hinge", [rigid("plate"), JointEnd::Ground], [4.0, 0.5, 0.5], axis))
        .load(Load::acceleration([0.0, 0.0, -10.0]))
        .build()
        .unwrap();
    assert_eq!(body.mobility().degrees_of_freedom, None);
    for scheme in [at(DGM, 2), at(dgm(0.8), 1)] {
        let mut motion = Motion::new(&body, scheme).unwrap();
        (0..6).for_each(|_| _ = motion.step(0.05).unwrap());
        let mut resumed =
            Motion::resumed(&body, scheme, NewtonSettings::default(), motion.snapshot()).unwrap();
        for _ in 0..6 {
            assert_eq!(resumed.step(0.05).unwrap(), motion.step(0.05).unwrap());
            assert_eq!(resumed.state(), motion.state());
        }
    }
    let mut last = f64::INFINITY;
    let exact = {
        let mut motion = Motion::new(&body, at(DGM, 3)).unwrap();
        (0..100).for_each(|_| _ = motion.step(0.01).unwrap());
        motion.record().strain_energy
    };
    for tolerance in [1e-3, 1e-5] {
        let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
        let plan = StepPlan::adaptive(0.0, 1.0, Adaptivity::new(tolerance)).unwrap();
        motion.march(&plan, &mut []).unwrap();
        let error = (motion.record().strain_energy - exact).abs() / exact;
        assert!(error < 0.3 * last, "{tolerance:e}: {error:e}");
        last = error;
    }
}

/// A rigid face whose frame is off its plane, driven there: the same as with a mass there, however small; its energy
/// is the work.
#[test]
fn a_rigid_coupling_is_driven_off_its_face() {
    let mesh = mesh::block([4.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let lift = TimeFunction::smooth("z", |t| [0.1 - 0.1 * (2.0 * t).cos(), 0.2 * (2.0 * t).sin(), 0.0]);
    let spin = |mass: f64| {
        let coupling = RigidBody { centre: Some([6.0, 0.5, 0.5]), ..RigidBody::group("p", "x-max") };
        let points = PointTerms {
            masses: if mass > 0.0 { vec![PointMass { group: "p".into(), mass }] } else { Vec::new() },
            ..PointTerms::default()
        };
        let body = Body::builder(mesh.clone())
            .region(rubber(1.0))
            .rigid(coupling)
            .point_terms(points)
            .support(Support::fixed("x-min"))
            .support(Support::driven("p", [None, None, Some(lift.clone())]))
            .build()
            .unwrap();
        let mut motion = started(&body, at(DGM, 2), &[]);
        for _ in 0..20 {
            let record = motion.step(0.05).unwrap();
            let size = record.kinetic_energy + record.strain_energy;
            assert!(
                record.energy_residual.abs() < 1e-11 * size.max(1.0),
                "{mass}: {:e}",
                record.energy_residual
            );
        }
        motion.record().rigid_bodies[0].spin
    };
    let spins = [0.0, 1e-9, 1e-3].map(spin);
    for spin in &spins {
        assert!(spin[0].abs() < 1e-9 && spin[2].abs() < 1e-9, "{spins:?}");
        assert!((spin[1] - spins[2][1]).abs() < 1e-4 * spins[2][1].abs(), "{spins:?}");
    }
}

/// A body that is driven at its centre of mass does not turn; its spin at the start is that given.
#[test]
fn a_driven_centre_of_mass_leaves_the_spin() {
    for (k, velocity, spin) in [(1, [0.0; 3], [0.0; 3]), (2, [1.0, 1.0, 1.0], [1.0, 0.0, 0.0])] {
        let rise = TimeFunction::smooth("z", |t| [t * t, 2.0 * t, 2.0]);
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("p", 2.0, [0.0; 3], [0.1, 0.2, 0.25]))
            .support(Support { fix: [true, true, false], ..Support::driven("p", [None, None, Some(rise)]) })
            .build()
            .unwrap();
        let start = InitialVelocity { velocity, angular_velocity: spin, ..Default::default() };
        let mut motion = started(&body, at(DGM, k), &[start]);
        let of = |motion: &Motion<'_>| motion.record().rigid_bodies[0].spin;
        assert!((0..3).all(|d| (of(&motion)[d] - spin[d]).abs() < 1e-14), "{:?}", of(&motion));
        for _ in 0..20 {
            motion.step(0.05).unwrap();
        }
        assert!((0..3).all(|d| (of(&motion)[d] - spin[d]).abs() < 1e-12), "{:?}", of(&motion));
        assert!((motion.record().rigid_bodies[0].position[2] - 1.0).abs() < 1e-14);
    }
}

/// A rigid block on a bed of springs sinks by its weight over their stiffness.
#[test]
fn springs_hold_a_rigid_group() {
    let stone = || RigidBody::group("stone", "body");
    let springs = vec![GroundSpring { group: "z-min".into(), stiffness: 50.0 }];
    let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [2, 2, 1]).unwrap())
        .region(rubber(3.0))
        .rigid(stone())
        .point_terms(PointTerms { springs, ..PointTerms::default() })
        .load(Load::acceleration([0.0, 0.0, -10.0]))
        .build()
        .unwrap();
    let found = Equilibrium::new(&body, 0.0, 1).unwrap().start(NewtonSettings::default(), &[], &mut []);
    let state = found.unwrap_or_else(|error| panic!("{error}"));
    let sinks = 6.0 * 10.0 / (50.0 * 2.0);
    assert!((state.displacement[2] + sinks).abs() < 1e-9, "{}", state.displacement[2]);
}
