//! Bodies of cells against locking, and equilibria, on a team.

use emmy::equilibrium::Equilibrium;

use super::*;

/// Bricks along x in the cell groups `left` and `right`, with the node groups `clamp` and `tip`.
fn bricks() -> Mesh {
    bricks_of([4, 2, 2])
}

fn bricks_of(cells: [usize; 3]) -> Mesh {
    let block = mesh::block([2.0, 1.0, 1.0], cells).unwrap();
    let mut builder = MeshBuilder::new();
    block.points().iter().for_each(|&point| _ = builder.point(point));
    let x = |node: u32| block.points()[node as usize][0];
    for cell in block.cells() {
        let is_left = cell.nodes.iter().all(|&node| x(node) <= 1.0);
        let index = builder.cell(cell.kind, cell.nodes).unwrap();
        builder.cell_group(if is_left { "left" } else { "right" }, [index]);
    }
    let at = |place: f64| (0..block.n_nodes() as u32).filter(move |&node| x(node) == place);
    builder.node_group("clamp", at(0.0));
    builder.node_group("tip", at(2.0));
    builder.build().unwrap()
}

/// A beam that is clamped at one end and pushed at the other.
fn pushed(parts: fn(BodyBuilder) -> BodyBuilder, scheme: Scheme) -> Case {
    Case {
        mesh: bricks(),
        parts,
        start: InitialVelocity::default(),
        scheme,
        exact_tangent: false,
        plan: plan(0.08, 0.02),
    }
}

fn push(builder: BodyBuilder) -> BodyBuilder {
    let force = Load::nodal_force("tip", [0.5, 1.0, 2.0]).over([(0.0, 1.0), (0.06, 0.0)]).unwrap();
    builder.support(Support::fixed("clamp")).load(force)
}

/// Incompatible modes in one half of a beam.
fn incompatible(builder: BodyBuilder) -> BodyBuilder {
    let heavy = Region::new(SaintVenantKirchhoff::new(900.0, 700.0).unwrap(), 2.0).on("right");
    let modes = rubber().on("left").with_formulation(Formulation::IncompatibleModes);
    push(builder).region(modes).region(heavy)
}

#[test]
fn incompatible_modes_are_those_of_the_whole_body() {
    for degree in 1..=2 {
        pushed(incompatible, at(DGM, degree)).assert_equal(2..=4, 1e-12);
    }
    Case { exact_tangent: true, ..pushed(incompatible, at(assumed_strain(5), 2)) }.assert_equal([3], 1e-12);
}

/// Projected volumes in one half of a beam, where K/mu = 17.
fn projected(builder: BodyBuilder) -> BodyBuilder {
    let viscosity = Viscosity { time: 0.01, shear: 1.0, bulk: 1.0 };
    let firm = Region::new(NeoHooke::new(8000.0, 500.0).unwrap(), 0.5).on("left");
    let firm = firm.with_formulation(Formulation::ProjectedVolume(None)).with_viscosity(viscosity);
    push(builder).region(firm).region(rubber().on("right")).drag(0.2)
}

#[test]
fn projected_volumes_are_those_of_the_whole_body() {
    for scheme in [fe(1), at(DGM, 1), at(DGM, 2)] {
        pushed(projected, scheme).assert_equal(2..=4, 1e-12);
    }
    pushed(projected, dgm(0.5)).assert_equal([3], 1e-11);
    Case { exact_tangent: true, ..pushed(projected, at(assumed_strain(5), 2)) }.assert_equal([3], 1e-12);
}

/// Cells whose nodes are all held or driven: no correction takes place on any rank.
#[test]
fn projected_volumes_without_free_nodes_are_those_of_the_whole_body() {
    let held = |builder: BodyBuilder| {
        let at_rest = || Some(TimeFunction::smooth("0", |_| [0.0; 3]));
        let moved = TimeFunction::smooth("t", |t| [t, 1.0, 0.0]);
        let firm = Region::new(NeoHooke::new(8000.0, 500.0).unwrap(), 0.5);
        builder
            .region(firm.with_formulation(Formulation::ProjectedVolume(None)))
            .support(Support::fixed("z-min"))
            .support(Support::driven("z-max", [at_rest(), at_rest(), Some(moved)]))
    };
    let mesh = mesh::block([3.0, 2.0, 1.0], [3, 2, 1]).unwrap();
    for scheme in [DGM, at(assumed_strain(5), 2)] {
        let case = Case { mesh: mesh.clone(), ..pushed(held, scheme) };
        let whole = case.whole().unwrap();
        let last = &whole.records[whole.records.len() - 1];
        assert!(last.strain_energy > 1.0 && last.energy_residual.abs() < 1e-12 * last.strain_energy);
        case.assert_equal(2..=3, 1e-12);
    }
}

/// Incompatible modes and projected volumes in one body.
fn both(builder: BodyBuilder) -> BodyBuilder {
    let firm = Region::new(NeoHooke::new(8000.0, 500.0).unwrap(), 0.5).on("left");
    let modes = rubber().on("right").with_formulation(Formulation::IncompatibleModes);
    push(builder).region(firm.with_formulation(Formulation::ProjectedVolume(None))).region(modes)
}

#[test]
fn dissipative_and_classic_schemes_are_those_of_the_whole_body() {
    pushed(both, dgm(0.5)).assert_equal([2], 1e-11);
    pushed(both, at(dgm(0.8), 2)).assert_equal([3], 1e-11);
    for scheme in ["Newmark(0.25, 0.5)", "Bathe"] {
        pushed(both, scheme.parse().unwrap()).assert_equal([3], 1e-11);
    }
}

/// Ranks with enough nodes for several threads each.
#[test]
fn threads_of_ranks_compute_cells_against_locking() {
    let case = Case { mesh: bricks_of([6, 5, 5]), plan: plan(0.04, 0.02), ..pushed(both, DGM) };
    case.assert_equal([2], 1e-12);
}

/// A corner is pushed through its cell, so that a step is cut on all ranks.
#[test]
fn cut_steps_of_incompatible_modes_are_those_of_the_whole_body() {
    let corner = |builder: BodyBuilder| {
        let load = Load::nodal_force("corner", [-60.0, 0.0, 0.0]);
        builder
            .region(rubber().with_formulation(Formulation::IncompatibleModes))
            .support(Support::fixed("x-min"))
            .load(load.over([(0.0, 1.0), (0.04, 0.0)]).unwrap())
    };
    let case = Case {
        mesh: mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap().with_node_group("corner", [44]).unwrap(),
        plan: plan(0.04, 0.02),
        ..pushed(corner, DGM)
    };
    assert!(case.whole().unwrap().events.contains(&EventKind::Cut));
    case.assert_equal([2, 3], 1e-9);
}

/// Adaptive steps: the decisions of the whole body.
#[test]
fn adaptive_steps_of_both_are_those_of_the_whole_body() {
    let plan = StepPlan::adaptive(0.0, 0.1, Adaptivity::new(1e-3)).unwrap();
    let case = Case { plan, ..pushed(both, at(DGM, 2)) };
    let whole = case.whole().unwrap();
    let ranks: Vec<End> = case.shared(3).into_iter().collect::<Result<_>>().unwrap();
    assert!(ranks.iter().all(|end| *end == ranks[0]) && whole.records.len() > 3);
    assert_eq!((ranks[0].records.len(), &ranks[0].events), (whole.records.len(), &whole.events));
    let [own, other] = [&ranks[0], &whole].map(|end| end.records[end.records.len() - 1].total_energy);
    assert!((own / other - 1.0).abs() < 1e-4);
}

#[test]
fn one_rank_and_resumed_teams_have_the_same_bits() {
    let case = pushed(both, at(DGM, 2));
    assert_eq!(case.shared(1), [case.whole()]);
    let ends = on_team(&case.mesh, 3, |share, team| {
        let body = (case.parts)(Body::shared(share, team)).build()?;
        let mut motion = Motion::new(&body, case.scheme)?.newton(case.settings())?;
        let mut watch = Watch { snapshot_after: Some(2), ..Watch::default() };
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

/// The equilibrium of a body, as far as it is here, and a motion from it.
struct Start {
    /// Number in the whole mesh and displacement of each own node.
    nodes: Vec<(usize, [f64; 3])>,
    increments: Vec<Record>,
    reactions: Vec<Reaction>,
    motion: Vec<Record>,
}

/// The equilibrium of some parts under their loads at t = 0, and a motion from it.
fn from_equilibrium(parts: fn(BodyBuilder) -> BodyBuilder, builder: BodyBuilder) -> Result<Start> {
    let body = parts(builder).build()?;
    let equilibrium = Equilibrium::new(&body, 0.0, 2)?;
    equilibrium.check()?;
    let mut watch = Watch::default();
    let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
    let state = equilibrium.start(settings, &[], &mut [&mut watch])?;
    let displacement = state.displacement.as_chunks::<3>().0;
    let nodes = body.ranks().nodes()[..body.ranks().n_own()].iter().map(|&node| node as usize);
    let nodes = nodes.zip(displacement).map(|(node, u)| (node, *u)).collect();
    let mut motion = Motion::starting(&body, at(DGM, 2), settings, state)?.with_static_reactions()?;
    let reactions = motion.reactions().to_vec();
    let mut moves = Watch::default();
    motion.march(&plan(0.04, 0.02), &mut [&mut moves])?;
    Ok(Start { nodes, increments: watch.records, reactions, motion: moves.records })
}

/// Compares the equilibria of teams with that of the whole body.
fn assert_same_equilibrium(mesh: &Mesh, parts: fn(BodyBuilder) -> BodyBuilder, sizes: &[usize]) {
    let whole = from_equilibrium(parts, Body::builder(mesh.clone())).unwrap();
    let size = whole.nodes.iter().map(|(_, u)| norm(*u)).fold(0.0, f64::max);
    let energy = whole.increments[2].strain_energy;
    let force = whole.reactions.iter().map(|reaction| norm(reaction.force)).fold(0.0, f64::max);
    assert!(size > 1e-3 && energy > 0.0 && force > 0.0);
    for &ranks in sizes {
        let starts =
            on_team(mesh, ranks, |share, team| from_equilibrium(parts, Body::shared(share, team)).unwrap());
        assert_eq!(starts.iter().map(|start| start.nodes.len()).sum::<usize>(), mesh.n_nodes());
        for start in &starts {
            assert_eq!(start.increments, starts[0].increments);
            assert_eq!(start.motion, starts[0].motion);
            for (node, u) in &start.nodes {
                let difference = norm([0, 1, 2].map(|d| u[d] - whole.nodes[*node].1[d]));
                assert!(difference < 1e-10 * size, "{ranks} ranks: {difference:e}");
            }
            for (own, other) in start.reactions.iter().zip(&whole.reactions) {
                let difference = norm([0, 1, 2].map(|d| own.force[d] - other.force[d]));
                assert!(difference < 1e-10 * force, "{ranks} ranks: {difference:e}");
            }
            let records = start.increments.iter().zip(&whole.increments);
            for (own, other) in records.chain(start.motion.iter().zip(&whole.motion)) {
                let scalars: [fn(&Record) -> f64; 3] =
                    [|r| r.kinetic_energy, |r| r.strain_energy, |r| r.external_work];
                for of in scalars {
                    let difference = (of(own) - of(other)).abs();
                    assert!(difference < 1e-12 * energy, "{ranks} ranks: {difference:e}\n{own:?}\n{other:?}");
                }
            }
        }
    }
}

fn weight(builder: BodyBuilder) -> BodyBuilder {
    builder
        .support(Support::fixed("clamp"))
        .load(Load::acceleration([0.0, 0.0, -9.81]).over([(0.0, 1.0), (0.01, 0.0)]).unwrap())
}

#[test]
fn equilibria_are_those_of_the_whole_body() {
    let standard = |b: BodyBuilder| weight(b).region(rubber());
    assert_same_equilibrium(&bricks(), standard, &[1, 2, 4]);
    let modes = |b: BodyBuilder| {
        let modes = rubber().on("left").with_formulation(Formulation::IncompatibleModes);
        weight(b).region(modes).region(rubber().on("right"))
    };
    assert_same_equilibrium(&bricks(), modes, &[3]);
    let volumes = |b: BodyBuilder| {
        let firm = Region::new(NeoHooke::new(8000.0, 500.0).unwrap(), 0.5).on("left");
        let firm = firm.with_formulation(Formulation::ProjectedVolume(None));
        weight(b).region(firm).region(rubber().on("right"))
    };
    assert_same_equilibrium(&bricks(), volumes, &[3]);
    let quadratic = |b: BodyBuilder| {
        weight(b)
            .region(rubber().on("left"))
            .region(Region::new(CiarletGeymonat::new(800.0, 400.0).unwrap(), 1.0).on("right"))
    };
    assert_same_equilibrium(&halves(), quadratic, &[2]);
}

/// Follower pressure, springs to the ground, and an end that is moved.
#[test]
fn equilibria_under_pressures_and_moved_supports_are_those_of_the_whole_body() {
    let mesh = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let pressed = |b: BodyBuilder| {
        let springs = vec![GroundSpring { group: "x-max".to_string(), stiffness: 40.0 }];
        b.region(rubber())
            .point_terms(PointTerms { springs, ..Default::default() })
            .support(Support::fixed("x-min"))
            .load(Load::pressure("z-max", 30.0).over([(0.0, 1.0), (0.01, 0.0)]).unwrap())
    };
    assert_same_equilibrium(&mesh, pressed, &[2, 3]);
    let moved = |b: BodyBuilder| {
        let back = TimeFunction::smooth("0.1 - t", |t| [0.1 - t, -1.0, 0.0]);
        b.region(rubber())
            .support(Support::fixed("x-min"))
            .support(Support::driven("x-max", [Some(back), None, None]))
    };
    assert_same_equilibrium(&mesh, moved, &[2]);
}

/// A body for an observer that turns, whose own rows of the mass are whole on each rank.
#[test]
fn equilibria_for_observers_that_turn_are_those_of_the_whole_body() {
    let mesh = bricks();
    let displacements = |builder: BodyBuilder| -> Result<Vec<(usize, [f64; 3])>> {
        let spread = vec![SpreadMass { group: "clamp".into(), total: 0.5 }];
        let body = builder
            .region(rubber())
            .point_terms(PointTerms { spread, ..Default::default() })
            .support(Support::fixed("clamp"))
            .load(Load::rotation([0.2, -0.1, 1.0], [0.0, 0.4, 0.0], 3.0))
            .build()?;
        let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
        let state = Equilibrium::new(&body, 0.0, 2)?.start(settings, &[], &mut [])?;
        let nodes = body.ranks().nodes()[..body.ranks().n_own()].iter().map(|&node| node as usize);
        Ok(nodes.zip(state.displacement.as_chunks::<3>().0.iter().copied()).collect())
    };
    let whole = displacements(Body::builder(mesh.clone())).unwrap();
    let size = whole.iter().map(|(_, u)| norm(*u)).fold(0.0, f64::max);
    assert!(size > 1e-3);
    for ranks in [1, 3] {
        for own in on_team(&mesh, ranks, |share, team| displacements(Body::shared(share, team)).unwrap()) {
            for (node, u) in own {
                let difference = norm([0, 1, 2].map(|d| u[d] - whole[node].1[d]));
                assert!(difference < 1e-10 * size, "{ranks} ranks: {difference:e}");
            }
        }
    }
}

/// Two blocks, of which one is held by a plane of symmetry alone.
#[test]
fn free_motions_are_found_on_a_team() {
    let block = mesh::block([1.0, 1.0, 1.0], [2, 2, 2]).unwrap();
    let mut builder = MeshBuilder::new();
    for shift in [0.0, 5.0] {
        let first = block.points().iter().map(|x| builder.point([x[0] + shift, x[1], x[2]])).min().unwrap();
        for cell in block.cells() {
            let nodes: Vec<u32> = cell.nodes.iter().map(|&node| first + node).collect();
            builder.cell(cell.kind, &nodes).unwrap();
        }
        let plane = (0..27).filter(|&node| block.points()[node as usize][0] == 0.0).map(|node| first + node);
        builder.node_group(if shift == 0.0 { "clamp" } else { "plane" }, plane);
    }
    let mesh = builder.build().unwrap();
    let check = |builder: BodyBuilder| {
        let plane = Support::of_components("plane", [true, false, false]);
        let body = builder.region(rubber()).support(Support::fixed("clamp")).support(plane).build().unwrap();
        Equilibrium::new(&body, 0.0, 1).unwrap().check().unwrap_err()
    };
    let whole = check(Body::builder(mesh.clone()));
    assert!(whole.to_string().contains("the part of the body with cell 8"), "{whole}");
    for size in 1..=4 {
        let errors = on_team(&mesh, size, |share, team| check(Body::shared(share, team)));
        assert!(errors.iter().all(|error| error.to_string() == whole.to_string()), "{errors:?}");
    }
}
