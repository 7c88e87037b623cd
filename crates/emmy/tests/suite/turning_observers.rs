//! Equilibria and modes for observers that turn: against closed forms, theories of beams, and bodies in other parts.

#![allow(non_snake_case)]

use emmy::Error;
use emmy::body::{Formulation, GroundSpring, PointTerms, SpreadMass};
use emmy::equilibrium::{Equilibrium, unbalanced_force};
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{Sampling, Span, StepDamping, StepInput};
use emmy::modes::{Mode, modes_about, n_modes};
use emmy::motion::NewtonSettings;
use emmy::prelude::*;

use crate::shared::joints::{hinge, rigid};

const Z: [f64; 3] = [0.0, 0.0, 1.0];

fn about_z(speed: f64) -> Load {
    Load::rotation(Z, [0.0; 3], speed)
}

fn equilibrium(body: &Body, load_steps: usize) -> State {
    Equilibrium::new(body, 0.0, load_steps).unwrap().start(NewtonSettings::default(), &[], &mut []).unwrap()
}

fn at_rest(body: &Body) -> State {
    State::initial(body, 0.0, &[]).unwrap()
}

fn frequencies(modes: &[Mode]) -> Vec<f64> {
    modes.iter().map(|mode| mode.angular_frequency).collect()
}

fn assert_close(found: &[f64], expected: &[f64], relative: f64) {
    let is_close = |(a, b): (&f64, &f64)| (a - b).abs() <= relative * b.abs();
    let are_close = found.len() == expected.len() && found.iter().zip(expected).all(is_close);
    assert!(are_close, "{found:?} is not {expected:?}");
}

fn assert_closed(modes: &[Mode]) {
    assert!(modes.iter().all(|mode| mode.residual < 1e-9), "{modes:?}");
}

// ---- the force

/// Mass, its first and its second moments.
#[derive(Clone, Copy, Default)]
struct Moments {
    mass: f64,
    first: [f64; 3],
    second: [[f64; 3]; 3],
}

impl Moments {
    /// Of a box from a corner, which may be flat.
    fn of_box(mass: f64, corner: [f64; 3], size: [f64; 3]) -> Self {
        let centre = [0, 1, 2].map(|d| corner[d] + 0.5 * size[d]);
        let own = |i: usize, j: usize| if i == j { size[i] * size[i] / 12.0 } else { 0.0 };
        Moments {
            mass,
            first: centre.map(|x| mass * x),
            second: [0, 1, 2].map(|i| [0, 1, 2].map(|j| mass * (centre[i] * centre[j] + own(i, j)))),
        }
    }

    fn and(self, other: Moments) -> Self {
        Moments {
            mass: self.mass + other.mass,
            first: [0, 1, 2].map(|i| self.first[i] + other.first[i]),
            second: [0, 1, 2].map(|i| [0, 1, 2].map(|j| self.second[i][j] + other.second[i][j])),
        }
    }

    /// Work of the centrifugal force at `A X + b` in the change `B X + d`.
    fn work(&self, load: &LoadKind, [A, B]: [[[f64; 3]; 3]; 2], [b, d]: [[f64; 3]; 2]) -> f64 {
        let LoadKind::Rotation { axis, about, speed } = load else { panic!("{load:?}") };
        let length: f64 = axis.iter().map(|x| x * x).sum();
        let b = [0, 1, 2].map(|i| b[i] - about[i]);
        let mut work = 0.0;
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            // The integral of (A X + b)_i (B X + d)_j.
            let mut product = self.mass * b[i] * d[j];
            for k in 0..3 {
                product += A[i][k] * self.first[k] * d[j] + b[i] * B[j][k] * self.first[k];
                product += (0..3).map(|l| A[i][k] * self.second[k][l] * B[j][l]).sum::<f64>();
            }
            let P = if i == j { 1.0 } else { 0.0 } - axis[i] * axis[j] / length;
            work += speed * speed * P * product;
        }
        work
    }
}

/// The external force at a displacement, and the product of its derivative with a change, less that of other forces.
fn force_and_change(body: &Body, u: &[f64], v: &[f64], time: f64) -> [Vec<f64>; 2] {
    let (rule, rest) = (Rule::at_end(), vec![0.0; u.len()]);
    let mut assembly = body.assembly(&rule);
    let step = StepInput {
        rule: &rule,
        tangent_factor: 1.0,
        displacement: u,
        rates: &rest,
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    body.begin(&rule, (Span::at(time), Sampling::Points), &[], &mut assembly).unwrap();
    body.evaluate_external(&step, &mut assembly).unwrap();
    let force = assembly.external_parts()[1].to_vec();
    body.assemble(&step, Request::Tangent, &[0.0], &mut assembly).unwrap();
    let [mut without, mut with] = [(); 2].map(|()| rest.clone());
    assembly.matrix.multiply(body.pattern(), v, &mut without);
    body.add_external_tangent(&step, &mut assembly).unwrap();
    assembly.matrix.multiply(body.pattern(), v, &mut with);
    [force, without.iter().zip(&with).map(|(without, with)| without - with).collect()]
}

/// `F X + b` at all nodes; those of incompatible modes are in the middle of their cells.
fn affine(body: &Body, F: [[f64; 3]; 3], b: [f64; 3]) -> Vec<f64> {
    let mut all = vec![0.0; body.n_dofs()];
    let points = body.mesh().points();
    let n_modes = (all.len() / 3 - points.len()) / body.mesh().n_cells();
    let middles = body.mesh().cells().flat_map(|cell| {
        let n = cell.nodes.len() as f64;
        let sum = |d: usize| cell.nodes.iter().map(|&node| points[node as usize][d]).sum::<f64>();
        vec![[0, 1, 2].map(|d| sum(d) / n); n_modes]
    });
    let places: Vec<[f64; 3]> = points.iter().copied().chain(middles).collect();
    for (X, value) in places.iter().zip(all.as_chunks_mut::<3>().0) {
        *value = [0, 1, 2].map(|i| b[i] + (0..3).map(|j| F[i][j] * X[j]).sum::<f64>());
    }
    all
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(4000.0, 2000.0).unwrap(), 2.0)
}

/// Two blocks on each other, 2 x 1 x 1 each, with nodes of their own or with common ones.
fn stack(is_merged: bool) -> Mesh {
    let mut builder = MeshBuilder::new();
    let block = mesh::block([2.0, 1.0, 1.0], [4, 2, 2]).unwrap();
    let mut nodes = [Vec::new(), Vec::new()];
    for level in 0..2 {
        for X in block.points() {
            let shared = if is_merged && level == 1 && X[2] == 0.0 {
                block.points().iter().position(|Y| *Y == [X[0], X[1], 1.0]).map(|at| nodes[0][at])
            } else {
                None
            };
            let node = shared.unwrap_or_else(|| builder.point([X[0], X[1], X[2] + level as f64]));
            nodes[level].push(node);
        }
        for cell in block.cells() {
            let own: Vec<u32> = cell.nodes.iter().map(|&node| nodes[level][node as usize]).collect();
            builder.cell(cell.kind, &own).unwrap();
        }
    }
    let chosen = |level: usize, is_on: &dyn Fn([f64; 3]) -> bool| -> Vec<u32> {
        (0..)
            .zip(block.points())
            .filter(|(_, X)| is_on(**X))
            .map(|(at, _): (usize, _)| nodes[level][at])
            .collect()
    };
    builder.node_group("lower-face", chosen(0, &|X| X[2] == 1.0));
    builder.node_group("upper-face", chosen(1, &|X| X[2] == 0.0));
    builder.node_group("root", chosen(0, &|X| X[0] == 0.0).into_iter().chain(chosen(1, &|X| X[0] == 0.0)));
    builder.node_group("end", chosen(1, &|X| X[0] == 2.0));
    builder.build().unwrap()
}

/// Work, in affine changes of affine positions, by the moments of the masses; derivatives, load fraction.
#[test]
fn the_force_is_that_of_the_masses() {
    let block = || mesh::block([2.0, 1.0, 0.5], [3, 2, 1]).unwrap();
    let alone = Moments::of_box(2.0, [0.0; 3], [2.0, 1.0, 0.5]);
    let corner = |X: [f64; 3]| Moments::of_box(0.3, X, [0.0; 3]);
    let mut bodies = Vec::new();
    for formulation in
        [Formulation::Standard, Formulation::IncompatibleModes, Formulation::ProjectedVolume(None)]
    {
        bodies.push((Body::builder(block()).region(rubber().with_formulation(formulation)), alone));
    }
    let terms = PointTerms {
        masses: vec![PointMass { group: "corner".into(), mass: 0.3 }],
        spread: vec![SpreadMass { group: "x-max".into(), total: 1.5 }],
        ..PointTerms::default()
    };
    let mesh = block();
    let last = mesh.nearest_node([2.0, 1.0, 0.5]) as u32;
    let mesh = mesh.with_node_group("corner", vec![last]).unwrap();
    let face = Moments::of_box(1.5, [2.0, 0.0, 0.0], [0.0, 1.0, 0.5]);
    bodies.push((
        Body::builder(mesh).region(rubber()).point_terms(terms),
        alone.and(corner([2.0, 1.0, 0.5])).and(face),
    ));
    let quadratic = mesh::block([2.0, 1.0, 0.5], [3, 2, 1]).unwrap();
    bodies.push((
        Body::builder(quadratic.clone()).region(rubber()).rigid(RigidBody::group("brick", "body")),
        alone,
    ));
    // The end of the block is rigid, and has a mass of its own beside that of its cells; a top flies beside it.
    let own = RigidBody {
        mass: 0.7,
        centre: Some([1.0, 0.5, 0.2]),
        inertia: Some([[0.3, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.5]]),
        ..RigidBody::group("end", "x-max")
    };
    let of_top = |mass: f64, X: [f64; 3], J: [f64; 3]| {
        let half = 0.5 * (J[0] + J[1] + J[2]);
        let point = Moments::of_box(mass, X, [0.0; 3]);
        let second = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { half - J[i] } else { 0.0 }));
        point.and(Moments { second, ..Moments::default() })
    };
    let top = RigidBody::new("top", 2.0, [3.0, -1.0, 0.4], [0.3, 0.5, 0.4]);
    bodies.push((
        Body::builder(quadratic).region(rubber()).rigid(own).rigid(top),
        alone.and(of_top(0.7, [1.0, 0.5, 0.2], [0.3, 0.4, 0.5])).and(of_top(
            2.0,
            [3.0, -1.0, 0.4],
            [0.3, 0.5, 0.4],
        )),
    ));
    let tied = || Body::builder(stack(false)).region(rubber()).tie(Tie::nodes("upper-face", "lower-face"));
    bodies.push((tied(), Moments::of_box(8.0, [0.0; 3], [2.0, 1.0, 2.0])));

    let load = Load::rotation([1.0, -2.0, 0.5], [0.3, 0.1, -0.4], -3.0);
    let A = [[1.1, 0.2, -0.1], [0.0, 0.9, 0.3], [0.1, -0.2, 1.05]];
    let B = [[0.3, -0.5, 0.2], [0.7, 0.1, -0.4], [-0.6, 0.2, 0.5]];
    let (b, d) = ([0.2, -0.3, 0.1], [0.5, -0.2, 0.7]);
    let minus_one = [0, 1, 2].map(|i| [0, 1, 2].map(|j| A[i][j] - if i == j { 1.0 } else { 0.0 }));
    for (index, (builder, moments)) in bodies.into_iter().enumerate() {
        let body = builder.load(load.clone()).build().unwrap();
        let (u, v) = (affine(&body, minus_one, b), affine(&body, B, d));
        let [force, change] = force_and_change(&body, &u, &v, 0.0);
        let work: f64 = force.iter().zip(&v).map(|(f, v)| f * v).sum();
        let expected = moments.work(&load.kind, [A, B], [b, d]);
        assert!((work - expected).abs() < 1e-12 * expected.abs(), "{index}: {work} is not {expected}");
        // Linear in the positions: the change is a difference, also a large one.
        let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + 0.25 * v).collect();
        let [there, _] = force_and_change(&body, &moved, &v, 0.0);
        let size = force.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        for ((there, here), change) in there.iter().zip(&force).zip(&change) {
            assert!((there - here - 0.25 * change).abs() < 1e-10 * size, "{index}: {there} {here} {change}");
        }
        let part = body.in_proportion(0.0);
        let [third, _] = force_and_change(&part, &u, &v, 0.3);
        assert!(third.iter().zip(&force).all(|(part, whole)| (part - 0.3 * whole).abs() < 1e-14 * size));
        let resultant = body.load_resultants()[0].force;
        for (axis, found) in resultant.into_iter().enumerate() {
            let mut e = [0.0; 3];
            e[axis] = 1.0;
            let one = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { 1.0 } else { 0.0 }));
            let expected = moments.work(&load.kind, [one, [[0.0; 3]; 3]], [[0.0; 3], e]);
            assert!((found - expected).abs() < 1e-11 * size, "{index}: {resultant:?}");
        }
    }
}

/// A tied body stretches and vibrates as the one whose parts have common nodes.
#[test]
fn tied_parts_are_as_merged_ones() {
    let terms =
        || PointTerms { masses: vec![PointMass { group: "end".into(), mass: 0.1 }], ..PointTerms::default() };
    let builder = |is_merged| {
        let load = Load::rotation([0.1, 0.0, 1.0], [0.0, 0.3, 0.0], 4.0);
        let builder = Body::builder(stack(is_merged)).region(rubber()).point_terms(terms());
        builder.support(Support::fixed("root")).load(load)
    };
    let merged = builder(true).build().unwrap();
    let tied = builder(false).tie(Tie::nodes("upper-face", "lower-face")).build().unwrap();
    let [merged, tied] = [merged, tied].map(|body| {
        let state = equilibrium(&body, 2);
        let corner = body.mesh().nearest_node([2.0, 1.0, 2.0]);
        let modes = modes_about(&body, &state, 6).unwrap();
        (state.displacement[3 * corner..3 * corner + 3].to_vec(), modes)
    });
    assert_close(&tied.0, &merged.0, 1e-9);
    assert_close(&frequencies(&tied.1), &frequencies(&merged.1), 1e-8);
    for (tied, merged) in tied.1.iter().zip(&merged.1) {
        assert!((tied.residual / merged.residual - 1.0).abs() < 1e-5, "{tied:?}");
    }
}

// ---- equilibria

/// Position of the end of a rotating bar, by its equations `(E A S(q'))' + rho A Omega^2 q = 0` with the stress
/// `S = l (l^2 - 1)/2` at a stretch l, by the method of shooting.
fn end_of_a_bar(length: f64, square: f64) -> f64 {
    let stretch = |stress: f64| {
        let mut l = 1.0;
        (0..30).for_each(|_| l -= (0.5 * l * (l * l - 1.0) - stress) / (1.5 * l * l - 0.5));
        l
    };
    let shot = |first: f64| {
        let (mut q, mut stress, n) = (0.0, first, 400);
        let h = length / f64::from(n);
        let rate = |[q, stress]: [f64; 2]| [stretch(stress), -square * q];
        for _ in 0..n {
            let at = |k: [f64; 2], c: f64| [q + c * h * k[0], stress + c * h * k[1]];
            let k1 = rate([q, stress]);
            let k2 = rate(at(k1, 0.5));
            let k3 = rate(at(k2, 0.5));
            let k4 = rate(at(k3, 1.0));
            q += h / 6.0 * (k1[0] + 2.0 * (k2[0] + k3[0]) + k4[0]);
            stress += h / 6.0 * (k1[1] + 2.0 * (k2[1] + k3[1]) + k4[1]);
        }
        [q, stress]
    };
    let (mut a, mut b) = (0.0, square * length * length);
    for _ in 0..100 {
        let middle = 0.5 * (a + b);
        if shot(middle)[1] < 0.0 { a = middle } else { b = middle }
    }
    shot(0.5 * (a + b))[0]
}

/// The beam of Simo and Vu-Quoc (1987, J. Applied Mechanics 54) in its steady rotation: `tan(b L)/b - L = 5.143175e-4`,
/// `b = Omega sqrt(rho A/(E A))`. A strain of Green and Lagrange, as that of bars here, is stiffer by 1.5 times itself.
#[test]
fn a_bar_has_its_steady_extension() {
    let (length, stiffness, mass, speed) = (10.0, 2.8e7f64, 1.2, 6.0);
    let b = speed * (mass / stiffness).sqrt();
    let linear = (b * length).tan() / b - length;
    assert!((linear - 5.143175e-4).abs() < 5e-11, "{linear}");
    let exact = end_of_a_bar(length, b * b) - length;
    // The mean strain is 5e-5.
    assert!((exact / linear - 1.0).abs() < 1.5e-4 && exact < linear, "{exact}");

    let mut solid = Vec::new();
    for n in [10, 20] {
        let region =
            Region::new(SaintVenantKirchhoff::new(0.0, 0.5 * stiffness / 0.25).unwrap(), mass / 0.25);
        let body = Body::builder(mesh::block([length, 0.5, 0.5], [n, 1, 1]).unwrap())
            .region(region)
            .supports([Support::fixed("x-min"), Support::of_components("body", [false, true, true])])
            .load(about_z(speed))
            .build()
            .unwrap();
        let state = equilibrium(&body, 1);
        solid.push(state.displacement[3 * body.mesh().nearest_node([length, 0.0, 0.0])]);
    }
    // The ends of linear elements are exact but for the part of the force that the extension adds.
    assert!((solid[1] / exact - 1.0).abs() < 1e-7, "{solid:?} {exact}");
    let mut builder = MeshBuilder::new();
    let nodes: Vec<u32> = (0..=20).map(|i| builder.point([0.5 * f64::from(i), 0.0, 0.0])).collect();
    nodes.windows(2).for_each(|pair| _ = builder.cell(CellKind::Line2, pair).unwrap());
    builder.node_group("axis", [nodes[0]]);
    builder.node_group("all", nodes.clone());
    let links = Region::links(Link::bar(stiffness, 1.0).unwrap(), mass);
    let body = Body::builder(builder.build().unwrap())
        .region(links)
        .supports([Support::fixed("axis"), Support::of_components("all", [false, true, true])])
        .load(about_z(speed))
        .build()
        .unwrap();
    let end = equilibrium(&body, 1).displacement[60];
    assert!((end / solid[1] - 1.0).abs() < 1e-9, "{end}");
}

/// A mass on springs to the ground, drawn off the axis: `r = k r_0/(k - m Omega^2)`, and frequencies
/// `omega_0 -+ Omega`, `omega_0` along the axis. Its axis may have any place and direction.
#[test]
fn a_mass_on_springs_is_thrown_out_and_whirls() {
    let (mass, stiffness, speed) = (2.0, 18.0f64, 1.25);
    for (axis, about, at) in [
        (Z, [0.0; 3], [0.0; 3]),
        (Z, [0.0; 3], [0.5, 0.0, 1.0]),
        ([2.0, -1.0, 2.0], [0.3, 0.2, 0.1], [1.0, 2.0, -0.5]),
    ] {
        let springs = vec![GroundSpring { group: "ball".into(), stiffness }];
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::point("ball", mass, at))
            .point_terms(PointTerms { springs, ..PointTerms::default() })
            .load(Load::rotation(axis, about, speed))
            .build()
            .unwrap();
        let state = equilibrium(&body, 3);
        let factor = mass * speed * speed / (stiffness - mass * speed * speed);
        let length: f64 = axis.iter().map(|x| x * x).sum();
        let along: f64 = (0..3).map(|d| axis[d] * (at[d] - about[d])).sum::<f64>() / length;
        for d in 0..3 {
            let arm = at[d] - about[d] - along * axis[d];
            assert!((state.displacement[d] - factor * arm).abs() < 1e-13, "{:?}", state.displacement);
        }
        let found = modes_about(&body, &state, 3).unwrap();
        assert_close(&frequencies(&found), &[3.0 - speed, 3.0, 3.0 + speed], 1e-13);
        assert_closed(&found);
        // The effective masses of all modes are the mass.
        for d in 0..3 {
            assert!((found.iter().map(|mode| mode.effective_mass[d]).sum::<f64>() - mass).abs() < 1e-12);
        }
    }
}

/// Springs that an observer finds too soft: `k = m Omega^2`.
#[test]
fn a_speed_beyond_the_limit_is_refused() {
    let ball = |speed: f64, x: f64| {
        let springs = vec![GroundSpring { group: "ball".into(), stiffness: 18.0 }];
        Body::builder(Mesh::without_cells())
            .rigid(RigidBody::point("ball", 2.0, [x, 0.0, 0.0]))
            .point_terms(PointTerms { springs, ..PointTerms::default() })
            .load(about_z(speed))
            .build()
            .unwrap()
    };
    for x in [0.0, 1.0] {
        let body = ball(6.0, x);
        // The limit is a load fraction of (3/6)^2, which increments of 1/10 leap over.
        let error = Equilibrium::new(&body, 0.0, 10).unwrap().start(NewtonSettings::default(), &[], &mut []);
        let Err(emmy::motion::MarchError::Step(Error::NoEquilibrium { fraction, cause, .. })) = error else {
            panic!("{error:?}");
        };
        assert!((fraction - 0.25).abs() < 1e-3, "{fraction}");
        // A mass off the axis runs away as the limit comes near.
        let is_known =
            matches!(*cause, Error::Softened { .. }) || x > 0.0 && matches!(*cause, Error::Singular { .. });
        assert!(is_known, "{cause}");
        let error = modes_about(&body, &at_rest(&body), 2).unwrap_err();
        assert!(error.to_string().contains("beyond the limit of static stability"), "{error}");
    }
    assert!(equilibrium(&ball(2.9, 1.0), 10).displacement[0] > 10.0);
}

// ---- modes

/// A rigid blade on a hinge at a distance e from the axis, with a spring: `omega^2 = (k + Omega^2 e m r)/J + Omega^2`
/// across the plane of rotation, and without the last term in it (Johnson, Helicopter Theory).
#[test]
fn hinged_blades_flap_and_lag() {
    let (e, r, mass, J, spring, speed) = (0.2, 0.6, 3.0, 0.25, 2.0, 7.0);
    for (axis, own) in [([0.0, 1.0, 0.0], speed * speed), (Z, 0.0)] {
        let blade = RigidBody::new("blade", mass, [e + r, 0.0, 0.0], [0.0, J, J]);
        let pin = hinge("pin", [rigid("blade"), JointEnd::Ground], [e, 0.0, 0.0], axis);
        let body = Body::builder(Mesh::without_cells())
            .rigid(blade)
            .joint(pin.with_spring(spring, None))
            .load(about_z(speed))
            .build()
            .unwrap();
        let state = equilibrium(&body, 2);
        assert!(state.displacement.iter().all(|u| u.abs() < 1e-13));
        let about_hinge = J + mass * r * r;
        let square = (spring + speed * speed * e * mass * r) / about_hinge + own;
        let found = modes_about(&body, &state, 1).unwrap();
        assert_close(&frequencies(&found), &[square.sqrt()], 1e-11);
        assert_closed(&found);
    }
}

/// A rod of a governor, on a hinge in the axis, below its point: `cos theta = 3 g/(2 Omega^2 L)`, and
/// `omega = Omega sin theta`, by the force of the hinge and the softening alone.
#[test]
fn the_rod_of_a_governor_swings_about_its_angle() {
    let (length, mass, gravity) = (2.0, 1.5, 9.81f64);
    let cosine = 0.6f64;
    let (sine, speed) = (0.8, (1.5 * gravity / (length * cosine)).sqrt());
    let along = [sine, 0.0, -cosine];
    let J = mass * length * length / 12.0;
    let inertia =
        [0, 1, 2].map(|i| [0, 1, 2].map(|j| J * (if i == j { 1.0 } else { 0.0 } - along[i] * along[j])));
    let rod = RigidBody {
        inertia: Some(inertia),
        ..RigidBody::point("rod", mass, along.map(|x| 0.5 * length * x))
    };
    let body = Body::builder(Mesh::without_cells())
        .rigid(rod)
        .joint(hinge("pin", [rigid("rod"), JointEnd::Ground], [0.0; 3], [0.0, 1.0, 0.0]))
        .load(Load::acceleration([0.0, 0.0, -gravity]))
        .load(about_z(speed))
        .build()
        .unwrap();
    let state = at_rest(&body);
    let left = unbalanced_force(&body, &state.displacement, 0.0).unwrap();
    assert!(left.iter().all(|force| force.abs() < 1e-12), "{left:?}");
    let found = modes_about(&body, &state, 1).unwrap();
    assert_close(&frequencies(&found), &[speed * sine], 1e-12);
}

/// A carriage on a slide along x with a spring, and on it a slide along y with a mass, about the place where no spring
/// has a force:
///
/// ```math
/// M x'' - 2 m Omega y' + (k - M Omega^2) x = 0,    m y'' + 2 m Omega x' + (l - m Omega^2) y = 0
/// ```
#[test]
fn slides_are_coupled_by_the_coriolis_force() {
    let (carriage, m, k, l, speed) = (1.5, 0.5, 40.0, 30.0, 2.5f64);
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("carriage", carriage, [0.0; 3], [0.2, 0.3, 0.4]))
        .rigid(RigidBody::new("box", m, [0.0, 0.0, 0.3], [0.1, 0.1, 0.15]))
        .joint(
            Joint::new(
                "x",
                JointKind::Prismatic { axis: [1.0, 0.0, 0.0] },
                [rigid("carriage"), JointEnd::Ground],
                [0.0; 3],
            )
            .with_spring(k, None),
        )
        .joint(
            Joint::new(
                "y",
                JointKind::Prismatic { axis: [0.0, 1.0, 0.0] },
                [rigid("box"), rigid("carriage")],
                [0.0, 0.0, 0.3],
            )
            .with_spring(l, None),
        )
        .load(about_z(speed))
        .build()
        .unwrap();
    let found = modes_about(&body, &equilibrium(&body, 1), 2).unwrap();
    let (M, square) = (carriage + m, speed * speed);
    let (a, c) = (k / M - square, l / m - square);
    // (a - w)(c - w) = 4 Omega^2 (m/M) w
    let half = 0.5 * (a + c + 4.0 * square * m / M);
    let root = (half * half - a * c).sqrt();
    assert_close(&frequencies(&found), &[(half - root).sqrt(), (half + root).sqrt()], 1e-11);
    assert_closed(&found);
}

/// Flapping frequencies of a uniform cantilever blade that is clamped in the axis, `omega sqrt(rho A L^4/(E I))` at the
/// speeds `Omega sqrt(rho A L^4/(E I))`: Wright, Smith, Thresher and Wang (1982, J. Applied Mechanics 49). In the plane
/// of rotation `omega^2` is less by `Omega^2`. Southwell's coefficient is 1.17 to 1.19 of them.
const BLADE: [(f64, f64); 4] = [(1.0, 3.6816), (2.0, 4.1373), (4.0, 5.5850), (6.0, 7.3604)];

#[test]
fn a_blade_stiffens_as_southwell_says() {
    let (length, side, modulus, density) = (40.0f64, 1.0, 3e6, 2.0);
    let scale = (density * 12.0 * length * length * length * length / (modulus * side * side)).sqrt();
    let blade = |load: Option<Load>| {
        let region = Region::new(SaintVenantKirchhoff::new(0.0, 0.5 * modulus).unwrap(), density);
        Body::builder(mesh::block([length, side, side], [20, 1, 1]).unwrap())
            .region(region.with_formulation(Formulation::IncompatibleModes))
            .support(Support::fixed("x-min"))
            .loads(load)
            .build()
            .unwrap()
    };
    let still = emmy::modes::modes(&blade(None), 1).unwrap()[0].angular_frequency * scale;
    assert!((still / 3.5160 - 1.0).abs() < 2e-3, "{still}");
    for (speed, expected) in BLADE {
        // Through the middle of the section.
        let load = Load::rotation(Z, [0.0, 0.5 * side, 0.0], speed / scale);
        let body = blade(Some(load));
        let state = equilibrium(&body, 4);
        let found = modes_about(&body, &state, 2).unwrap();
        let lag = (expected * expected - speed * speed).sqrt();
        let own: Vec<f64> = frequencies(&found).iter().map(|omega| omega * scale).collect();
        // Shear, rotary inertia and the length of the cells.
        assert_close(&own, &[lag, expected], 3e-3);
        let southwell = (own[1] * own[1] - still * still) / (speed * speed);
        assert!((1.16..1.20).contains(&southwell), "{speed}: {southwell}");
        // Four modes of bending lack the axial motion that the Coriolis force adds, at most 2 Omega/omega_axial.
        let axial = 0.5 * std::f64::consts::PI * (modulus / density).sqrt() / length;
        let most = 1.01 * 2.0 * speed / scale / axial;
        assert!(found.iter().all(|mode| mode.residual < most), "{} {most}", found[0].residual);
    }
}

/// Vibrations of a whole space have no residual; those of a part come near it with their number.
#[test]
fn residuals_tell_what_is_left_out() {
    let region = Region::new(SaintVenantKirchhoff::new(0.0, 500.0).unwrap(), 1.0);
    let body = Body::builder(mesh::block([2.0, 1.0, 1.0], [2, 1, 1]).unwrap())
        .region(region)
        .support(Support::fixed("x-min"))
        .load(Load::rotation([0.2, 0.1, 1.0], [0.0; 3], 4.0))
        .build()
        .unwrap();
    let state = equilibrium(&body, 2);
    let n = n_modes(&body);
    let whole = modes_about(&body, &state, n).unwrap();
    assert_closed(&whole);
    assert!(matches!(modes_about(&body, &state, n + 1), Err(Error::TooManyModes { .. })));
    let mut before = [f64::INFINITY; 2];
    for count in [1, 3, 6, n] {
        let found = modes_about(&body, &state, count).unwrap();
        let difference = found[0].angular_frequency / whole[0].angular_frequency - 1.0;
        // The error of a frequency is of second order in the residual.
        assert!(difference.abs() <= 2.0 * found[0].residual.powi(2) + 1e-13, "{count}: {difference}");
        let now = [difference.abs() - 1e-13, found[0].residual - 1e-12];
        assert!((0..2).all(|i| now[i] < before[i]), "{count}: {now:?} {before:?}");
        before = now.map(|x| x.max(0.0) + 1e-13);
    }
    let mass: f64 = body.regions()[0].mass;
    // The clamped face carries the rest of the mass.
    assert!((0..3).all(|d| whole.iter().map(|mode| mode.effective_mass[d]).sum::<f64>() < mass));
}

// ---- refusals

#[test]
fn motions_refuse_an_observer_that_turns() {
    let mesh = || mesh::block([1.0; 3], [1; 3]).unwrap();
    let body = Body::builder(mesh()).region(rubber()).load(about_z(1.0)).build().unwrap();
    for scheme in
        ["DGM", "AS(2)", "DGM(0.5)", "trapezoidal", "Newmark(0.25, 0.5)", "Bathe", "central-differences"]
    {
        let error = Motion::new(&body, scheme.parse::<Scheme>().unwrap()).unwrap_err();
        assert!(matches!(error, Error::Scheme { .. }), "{error}");
        assert!(error.to_string().contains("a support that turns"), "{error}");
    }
    let refused = |load: Load| {
        let error = Body::builder(mesh()).region(rubber()).load(load).build().unwrap_err();
        assert!(matches!(error, Error::Rotation { .. }), "{error}");
        error.to_string()
    };
    let turned = |axis, about, speed| refused(Load::rotation(axis, about, speed));
    assert!(turned([0.0; 3], [0.0; 3], 1.0).contains("axis"));
    assert!(turned([0.0, f64::NAN, 1.0], [0.0; 3], 1.0).contains("axis"));
    assert!(turned([f64::INFINITY, 0.0, 1.0], [0.0; 3], 1.0).contains("axis"));
    assert!(turned(Z, [0.0, f64::NAN, 1.0], 1.0).contains("point on its axis"));
    assert!(turned(Z, [0.0; 3], 0.0).contains("speed"));
    assert!(turned(Z, [0.0; 3], f64::INFINITY).contains("speed"));
    assert!(refused(about_z(1.0).over([(0.0, 0.0), (1.0, 1.0)]).unwrap()).contains("constant"));
    let twice = Body::builder(mesh()).region(rubber()).loads([about_z(1.0), about_z(2.0)]).build();
    assert!(twice.unwrap_err().to_string().contains("one axis"));
    // A long axis and a short one are the same.
    let spins = [1e-200, 1e200].map(|length| {
        let load = Load::rotation([length, 0.0, 0.0], [0.0; 3], 3.0);
        Body::builder(mesh()).region(rubber()).load(load).build().unwrap().observer_spin()
    });
    assert_eq!(spins, [Some([3.0, 0.0, 0.0]); 2]);
    // Nothing holds the body.
    let free = modes_about(&body, &at_rest(&body), 1).unwrap_err();
    assert!(matches!(free, Error::Rotation { .. }), "{free}");
}
