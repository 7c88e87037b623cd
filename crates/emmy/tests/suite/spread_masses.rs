//! Masses spread over groups: the moments of a plate, a density of cells, closed frequencies, and ranks.

#![allow(non_snake_case)]

use std::sync::Arc;

use emmy::Error;
use emmy::body::{
    Body, BodyBuilder, Field, FieldDomain, Load, LoadKind, PointMass, PointTerms, Region, SpreadMass, Support,
};
use emmy::internals::body::sum;
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{CellKind, Mesh, MeshBuilder, Share, owners};
use emmy::modes::modes;
use emmy::motion::{Motion, State};
use emmy::team::{Team, Threads};
use emmy::time::TimeElement;

use crate::shared::patch::Patch;
use crate::shared::plane_patch::plane_patch;

fn rubber(density: f64) -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), density)
}

fn spread(group: &str, total: f64) -> PointTerms {
    PointTerms { spread: vec![SpreadMass { group: group.into(), total }], ..PointTerms::default() }
}

fn with(mesh: Mesh, region: Region, points: PointTerms) -> Body {
    Body::builder(mesh).region(region).point_terms(points).build().unwrap()
}

/// The mesh with a further group of cells.
fn grouped(mesh: &Mesh, name: &str, is_in: impl Fn(u32) -> bool) -> Mesh {
    let mut builder = MeshBuilder::new();
    mesh.points().iter().for_each(|&point| _ = builder.point(point));
    for cell in mesh.cells() {
        let index = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group(name, is_in(index).then_some(index));
    }
    for (name, facets) in &mesh.groups().facets {
        builder.facet_group(name, facets.iter().copied());
    }
    builder.build().unwrap()
}

fn velocity(body: &Body, of: impl Fn([f64; 3]) -> [f64; 3]) -> Vec<f64> {
    body.mesh().points().iter().flat_map(|&X| of(X)).collect()
}

/// Linear and angular momentum of a field of velocities.
fn momenta(body: &Body, velocity: &[f64]) -> [f64; 6] {
    let mut momentum = vec![0.0; body.n_dofs()];
    body.mass_product(velocity, &mut momentum);
    let [p, l] = [sum(&momentum), body.moment(&vec![0.0; body.n_dofs()], &momentum)];
    [p[0], p[1], p[2], l[0], l[1], l[2]]
}

fn assert_near(own: &[f64], exact: &[f64], tolerance: f64, what: &str) {
    for (a, b) in own.iter().zip(exact) {
        assert!((a - b).abs() < tolerance, "{what}: {own:?} is not {exact:?}");
    }
}

/// A plate of mass m on the unit square at x = 1, on faces of uneven cells: m v, and the angular momentum
/// `integral rho X x (omega x X) dA` about the origin, with integral y^2 dA = 1/3 and integral y z dA = 1/4.
#[test]
fn a_mass_on_a_face_moves_as_a_plate() {
    let kinds = CellKind::ALL.into_iter().filter(|kind| kind.dimension() == 3);
    let mut largest_offset: f64 = 0.0;
    for kind in kinds {
        for curved in [false, true] {
            let mesh = Patch { bricks: 3, curved, distortion: 1.0 }.mesh(kind);
            let bare = with(mesh.clone(), rubber(2.0), PointTerms::default());
            let body = with(mesh.clone(), rubber(2.0), spread("x-max", 3.0));
            let of_plate = |velocity: &[f64]| {
                let [bare, body] = [&bare, &body].map(|body| momenta(body, velocity));
                [0, 1, 2, 3, 4, 5].map(|i| body[i] - bare[i])
            };
            // X x e_x = (0, z, -y)
            let slide = of_plate(&velocity(&body, |_| [1.0, 0.0, 0.0]));
            assert_near(&slide, &[3.0, 0.0, 0.0, 0.0, 1.5, -1.5], 1e-13, "translation");
            let plate = body.regions().last().unwrap();
            assert_near(&plate.centre, &[1.0, 0.5, 0.5], 1e-13, "centre");
            assert_near(&[plate.mass], &[3.0], 1e-13, "total");
            if !curved {
                // omega = e_y: v = (z, 0, -x), X x v = (-x y, z^2 + x^2, -y z)
                let spin = of_plate(&velocity(&body, |[x, _, z]| [z, 0.0, -x]));
                assert_near(&spin, &[1.5, 0.0, -3.0, -1.5, 4.0, -0.75], 1e-13, "spin");
                assert_near(&[plate.inertia[0][0], plate.inertia[1][1]], &[0.5, 0.25], 1e-13, "inertia");
            }
            assert_near(&body.centre_of("x-max").unwrap(), &[1.0, 0.5, 0.5], 1e-13, "centre of the group");
            let lumped = body.lumped_mass().iter().zip(bare.lumped_mass()).map(|(own, bare)| own - bare);
            let lumped: Vec<f64> = lumped.collect();
            assert!(lumped.iter().all(|&mass| mass > -1e-15), "{kind}: negative lumped mass");
            assert_near(&[lumped.iter().sum()], &[3.0], 1e-12, "lumped");
            // The same mass in equal parts at the nodes lies elsewhere.
            let n = mesh.group_nodes("x-max").unwrap().len() as f64;
            let masses = vec![PointMass { group: "x-max".into(), mass: 3.0 / n }];
            let at_nodes = with(mesh, rubber(2.0), PointTerms { masses, ..PointTerms::default() });
            largest_offset = largest_offset.max((at_nodes.regions()[1].centre[1] - 0.5).abs());
        }
    }
    assert!(largest_offset > 1e-3, "the faces are even: {largest_offset}");
}

/// A mass over all cells is a density: equal products of the mass matrix, with the thickness of plane cells.
#[test]
fn a_mass_over_cells_is_a_density() {
    for kind in CellKind::ALL {
        let (mesh, thickness) = match kind.dimension() {
            3 => (Patch { bricks: 2, curved: false, distortion: 1.0 }.mesh(kind), 1.0),
            2 => (plane_patch(kind, 3), 0.3),
            _ => continue,
        };
        let mesh = grouped(&mesh, "all", |_| true);
        let region = |density: f64| rubber(density).with_thickness(thickness);
        let by_mass = with(mesh.clone(), region(2.0), spread("all", 3.0));
        let by_density = with(mesh, region(2.0 + 3.0 / thickness), PointTerms::default());
        let wave = velocity(&by_mass, |[x, y, z]| [(3.0 * y).sin() + x * x, x - y * z, 0.0]);
        let products = [&by_mass, &by_density].map(|body| {
            let mut product = vec![0.0; body.n_dofs()];
            body.mass_product(&wave, &mut product);
            product
        });
        assert_near(&products[0], &products[1], 1e-13, &kind.to_string());
        assert_near(by_mass.lumped_mass(), by_density.lumped_mass(), 1e-13, &kind.to_string());
    }
}

/// Over bars by length: the mass is that of a density m/(A sum L), whatever their lengths; over springs too, whose
/// nodes have no other mass.
#[test]
fn a_mass_over_links_goes_by_their_length() {
    let points = [[0.0; 3], [1.0, 0.0, 0.0], [4.0, 0.0, 0.0]];
    let mesh = |kind: &[[u32; 2]]| {
        let mut builder = MeshBuilder::new();
        points.iter().for_each(|&point| _ = builder.point(point));
        let cells: Vec<u32> = kind.iter().map(|cell| builder.cell(CellKind::Line2, cell).unwrap()).collect();
        builder.cell_group("chain", cells);
        builder.build().unwrap()
    };
    let chain = mesh(&[[0, 1], [1, 2]]);
    let bar = Region::links(Link::bar(10.0, 0.5).unwrap(), 2.0);
    let body = with(chain.clone(), bar, spread("chain", 8.0));
    // A density of 2 on an area of 0.5, and 8 over a length of 4.
    assert_near(body.lumped_mass(), &[1.5, 6.0, 4.5], 1e-14, "bars");
    let plate = body.regions().last().unwrap();
    assert_near(&plate.centre, &[2.0, 0.0, 0.0], 1e-14, "centre");
    // m L^2 / 12 across the chain.
    assert_near(&[plate.inertia[1][1]], &[8.0 * 16.0 / 12.0], 1e-12, "inertia");
    let springs = with(chain, Region::links(Link::spring(3.0, None).unwrap(), 0.0), spread("chain", 8.0));
    assert_near(springs.lumped_mass(), &[1.0, 4.0, 3.0], 1e-14, "springs");
    assert_near(&momenta(&springs, &[1.0; 9])[..3], &[8.0; 3], 1e-14, "momentum");
}

/// On edges of plane cells, over area = length times thickness: one half of the mass at each end of one edge.
#[test]
fn masses_on_edges_and_nodes_have_their_total() {
    let mesh = plane_patch(CellKind::Quad8, 3);
    let body = with(mesh, rubber(2.0).with_thickness(0.3), spread("y-max", 5.0));
    let plate = body.regions().last().unwrap();
    assert_near(&[plate.mass], &[5.0], 1e-13, "total");
    assert_near(&plate.centre, &[0.5, 1.0, 0.7], 1e-13, "centre");
    let mesh = plane_patch(CellKind::Quad4, 2).with_node_group("some", [0, 3, 4, 5]).unwrap();
    let bare = with(mesh.clone(), rubber(2.0), PointTerms::default());
    let body = with(mesh, rubber(2.0), spread("some", 6.0));
    for node in 0..9 {
        let own = if [0, 3, 4, 5].contains(&node) { 1.5 } else { 0.0 };
        assert_near(&[body.lumped_mass()[node] - bare.lumped_mass()[node]], &[own], 1e-14, "node");
    }
}

/// Gravity accelerates the mass matrix, so that a body falls without strain: also as a field.
#[test]
fn a_body_with_a_plate_falls_as_if_rigid() {
    for kind in [CellKind::Hex8, CellKind::Hex20, CellKind::Tet10] {
        let mesh = Patch { bricks: 2, curved: true, distortion: 1.0 }.mesh(kind);
        let field = Field::new(|_, _| [0.0, 0.0, -9.81]);
        let gravity = LoadKind::AccelerationField { group: None, field };
        assert!(matches!(gravity.field(), Some((_, FieldDomain::Masses(None)))));
        for load in
            [Load::acceleration([0.0, 0.0, -9.81]), Load { kind: gravity, ..Load::acceleration([0.0; 3]) }]
        {
            let builder = Body::builder(mesh.clone()).region(rubber(2.0)).point_terms(spread("x-max", 3.0));
            let body = builder.load(load).build().unwrap();
            let resultant = &body.load_resultants()[0];
            // m (2 at the centre of the cube, 3 at the plate): torque about the origin (-y, x, 0) m g.
            let g = 9.81;
            assert_near(&resultant.force, &[0.0, 0.0, -5.0 * g], 1e-12, "weight");
            assert!((resultant.torque[1] - (0.5 * 2.0 + 3.0) * g).abs() < 1e-4, "{:?}", resultant.torque);
            let state = State::initial(&body, 0.0, &[]).unwrap();
            let scheme = TimeElement::discrete_gradient(1).unwrap();
            let mut motion = Motion::new(&body, scheme).unwrap().from(state).unwrap();
            (0..2).for_each(|_| _ = motion.step(0.1).unwrap());
            let record = motion.step(0.1).unwrap();
            assert!(record.strain_energy < 1e-20, "{kind}: {}", record.strain_energy);
            // m g^2 t^2 / 2
            let kinetic = 0.5 * 5.0 * (g * 0.3f64).powi(2);
            assert!((record.kinetic_energy - kinetic).abs() < 1e-11 * kinetic, "{kind}");
        }
    }
}

/// A layer of one cell under a heavy plate, without Poisson's effect: the uniform axial motion is a mode, whatever the
/// cells of the face are: omega^2 = (E A / h) / (m + rho A h / 3), with the effective mass (m + rho A h / 2)^2 / (m +
/// rho A h / 3) along the axis and none across.
#[test]
fn a_plate_on_an_uneven_layer_has_one_axial_mode() {
    let (E, density, h, total) = (100.0, 2.0, 0.2, 7.0);
    let graded = [0.0, 0.1, 0.25, 0.5, 1.0];
    let mut builder = MeshBuilder::new();
    let node = |i: usize, j: usize, k: usize| (25 * k + 5 * j + i) as u32;
    for k in 0..2 {
        for (y, x) in graded.iter().flat_map(|&y| graded.map(|x| (y, x))) {
            builder.point([x, y, k as f64 * h]);
        }
    }
    for (j, i) in (0..4).flat_map(|j| (0..4).map(move |i| (j, i))) {
        let face = |k: usize| [node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k)];
        builder.cell(CellKind::Hex8, &[face(0), face(1)].concat()).unwrap();
    }
    builder.node_group("base", 0..25);
    // The upper facet of each cell.
    let mesh = builder.clone().build().unwrap();
    let upper = (0..mesh.n_cells() as u32)
        .flat_map(|cell| (0..6).map(move |local| emmy::mesh::Facet { cell, local }));
    let lies = |facet: &emmy::mesh::Facet| mesh.facet_nodes(*facet).all(|node| node >= 25);
    builder.facet_group("top", upper.filter(lies).collect::<Vec<_>>());
    let mesh = builder.build().unwrap();
    let layer = || Region::new(NeoHooke::from_engineering(E, 0.0).unwrap(), density);
    let clamped = |points: PointTerms| -> BodyBuilder {
        Body::builder(mesh.clone()).region(layer()).support(Support::fixed("base")).point_terms(points)
    };
    let effective = |points: PointTerms| {
        let body = clamped(points).build().unwrap();
        let found = modes(&body, 20).unwrap();
        let axial =
            found.into_iter().max_by(|a, b| a.effective_mass[2].total_cmp(&b.effective_mass[2])).unwrap();
        (axial.angular_frequency, axial.effective_mass)
    };
    let (frequency, mass) = effective(spread("top", total));
    let inertia = total + density * h / 3.0;
    let exact = (E / h / inertia).sqrt();
    assert!((frequency / exact - 1.0).abs() < 1e-9, "{frequency} is not {exact}");
    let along = (total + density * h / 2.0).powi(2) / inertia;
    assert_near(&mass, &[0.0, 0.0, along], 1e-9, "effective mass");
    let masses = vec![PointMass { group: "top".into(), mass: total / 25.0 }];
    let (_, split) = effective(PointTerms { masses, ..PointTerms::default() });
    assert!(split[2] < 0.9 * along, "equal masses at the nodes give one mode too: {split:?}");
}

#[test]
fn ranks_have_the_masses_of_the_whole() {
    let mesh = Patch { bricks: 3, curved: true, distortion: 1.0 }.mesh(CellKind::Tet10);
    let mesh = grouped(&mesh, "some", |cell| cell % 3 == 0);
    let mesh = mesh.with_node_group("few", [1, 17, 40, 41]).unwrap();
    let names = ["x-max", "some", "few", "z-min"];
    let points = || PointTerms {
        spread: names.map(|group| SpreadMass { group: group.into(), total: 2.5 }).to_vec(),
        ..PointTerms::default()
    };
    let run = |builder: BodyBuilder| {
        let body = builder.region(rubber(2.0)).point_terms(points());
        let body = body.load(Load::acceleration([0.3, -1.0, 0.5])).build().unwrap();
        let masses: Vec<f64> = body.regions()[1..]
            .iter()
            .flat_map(|own| [own.mass, own.centre[0], own.centre[1], own.centre[2], own.inertia[0][1]])
            .collect();
        let centre = body.centre_of("some").unwrap();
        let mut state = State::initial(&body, 0.0, &[]).unwrap();
        let wave = velocity(&body, |[x, y, z]| [y * z, 0.3 * x, x - y]);
        state.velocity[..wave.len()].copy_from_slice(&wave);
        let whole_momentum = {
            let mut momentum = vec![0.0; body.n_dofs()];
            body.mass_product(&state.velocity, &mut momentum);
            momentum
        };
        state.momentum = whole_momentum;
        let scheme = TimeElement::discrete_gradient(1).unwrap();
        let mut motion = Motion::new(&body, scheme).unwrap().from(state).unwrap();
        let record = motion.step(0.02).unwrap();
        let mut all = vec![record.kinetic_energy, record.strain_energy];
        all.extend(
            record.linear_momentum.into_iter().chain(record.angular_momentum).chain(masses).chain(centre),
        );
        all
    };
    let whole = run(Body::builder(mesh.clone()));
    assert_near(&whole[8..9], &[2.5], 1e-13, "total");
    let owners = owners(&mesh, 3).unwrap();
    let of_rank = |team: Arc<dyn Team>| {
        let share = Share::new(&mesh, &owners, team.rank());
        run(Body::shared(share, team))
    };
    for ranks in Threads::run(3, of_rank).unwrap() {
        assert_near(&ranks, &whole, 1e-9, "ranks");
    }
}

#[test]
fn masses_that_cannot_be_spread_are_rejected() {
    let mut builder = MeshBuilder::new();
    for X in [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 2.0]] {
        builder.point(X);
    }
    let tet = builder.cell(CellKind::Tet4, &[0, 1, 2, 3]).unwrap();
    let line = builder.cell(CellKind::Line2, &[3, 4]).unwrap();
    for (name, cells) in [("tet", vec![tet]), ("line", vec![line]), ("both", vec![tet, line])] {
        builder.cell_group(name, cells);
    }
    let mesh = builder.build().unwrap();
    let build = |points: PointTerms| {
        let regions = [rubber(1.0).on("tet"), Region::links(Link::bar(1.0, 1.0).unwrap(), 1.0).on("line")];
        Body::builder(mesh.clone()).regions(regions).point_terms(points).build().map(drop)
    };
    assert!(matches!(build(spread("both", 1.0)), Err(Error::Mass { group, .. }) if group == "both"));
    assert!(matches!(build(spread("line", -1.0)), Err(Error::NotPositive { .. })));
    assert!(matches!(build(spread("lime", 1.0)), Err(Error::UnknownGroup { .. })));
    assert!(build(spread("line", 1.0)).is_ok());
}
