//! Reactions of supports: their impulses and those of the loads, integrated here, are the change of the momenta for
//! every stepper; and reactions that theory knows.

#![allow(non_snake_case)]

use emmy::body::{Body, Field, GroundAttraction, GroundSpring, InitialVelocity, Load, LoadKind};
use emmy::body::{PointMass, PointTerms, Reaction, Region, Rotation, Support, TimeFunction, Viscosity};
use emmy::internals::quadrature::gauss;
use emmy::material::{Link, NeoHooke};
use emmy::motion::{
    Adaptivity, Motion, NewtonSettings, Observer, ObserverResult, Phase, State, StepPlan, View,
};
use emmy::time::{AveragingRule, NewmarkFamily, Scheme};

use crate::shared::points::{masses, moving, network};
use crate::shared::schemes::at;

type Vector = [f64; 3];

const DENSITY: f64 = 0.7;
const GRAVITY: Vector = [1.0, -9.81, 2.0];
const PRESSURE: f64 = 3.0;
const DRAG: f64 = 0.4;

/// Relative size of the part of an impulse that is round-off.
const ROUND_OFF: f64 = 1e-12;

fn tight() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-13, max_iterations: 40, ..NewtonSettings::default() }
}

fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), DENSITY)
}

/// A column of three unit cubes.
fn column() -> emmy::mesh::Mesh {
    emmy::mesh::block([1.0, 3.0, 1.0], [1, 3, 1]).unwrap()
}

fn scaled(a: f64, v: Vector) -> Vector {
    v.map(|x| a * x)
}

fn plus(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn minus(a: Vector, b: Vector) -> Vector {
    plus(a, scaled(-1.0, b))
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: Vector) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Mass matrix of the column over the density: products of 1/3 and 1/6, by unit cubes.
fn mass_product(body: &Body, values: &[Vector]) -> Vec<Vector> {
    let points = body.mesh().points();
    let mut product = vec![[0.0; 3]; points.len()];
    for cell in body.mesh().cells() {
        for (&a, &b) in cell.nodes.iter().flat_map(|a| cell.nodes.iter().map(move |b| (a, b))) {
            let (a, b) = (a as usize, b as usize);
            let m: f64 =
                (0..3).map(|d| if points[a][d] == points[b][d] { 1.0 / 3.0 } else { 1.0 / 6.0 }).product();
            product[a] = plus(product[a], scaled(m, values[b]));
        }
    }
    product
}

/// A body force that is linear in X, so that its nodal forces are those of the mass matrix, and sharpens with time.
fn field_at(X: Vector, time: f64) -> Vector {
    scaled(1.0 + time * time, [5.0 * X[1], -3.0 * X[2], 2.0 - X[0]])
}

/// Pressure on the end y = 3 of the column: `-p int N_A q_,xi x q_,eta`, normal to the deformed facet.
fn pressure(body: &Body, q: &[Vector]) -> Vec<Vector> {
    let points = body.mesh().points();
    let corner = |x: f64, z: f64| points.iter().position(|X| *X == [x, 3.0, z]).unwrap();
    // z first, so that the normal is along +y.
    let nodes = [corner(0.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0), corner(1.0, 0.0)];
    let mut forces = vec![[0.0; 3]; points.len()];
    let g = gauss(3);
    for ((&[s], u), (&[t], w)) in g.iter().flat_map(|a| g.iter().map(move |b| (a, b))) {
        let shapes = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
        let by_s = [t - 1.0, 1.0 - t, t, -t];
        let by_t = [s - 1.0, -s, s, 1.0 - s];
        let tangent = |by: [f64; 4]| (0..4).fold([0.0; 3], |sum, a| plus(sum, scaled(by[a], q[nodes[a]])));
        let area = cross(tangent(by_s), tangent(by_t));
        for (shape, node) in shapes.iter().zip(nodes) {
            forces[node] = plus(forces[node], scaled(-PRESSURE * u * w * shape, area));
        }
    }
    forces
}

/// A load, and its nodal forces as they are computed here.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Case {
    Nothing,
    Weight,
    Field,
    Pressure,
}

impl Case {
    const ALL: [Case; 4] = [Case::Nothing, Case::Weight, Case::Field, Case::Pressure];

    fn load(self) -> Option<Load> {
        let field = || LoadKind::BodyForceField { group: None, field: Field::new(field_at) };
        match self {
            Case::Nothing => None,
            Case::Weight => Some(Load::acceleration(GRAVITY)),
            Case::Field => Some(Load::new(field())),
            Case::Pressure => Some(Load::pressure("y-max", PRESSURE)),
        }
    }

    /// Force on each node at a time and at positions of all nodes.
    fn forces(self, body: &Body, time: f64, q: &[Vector]) -> Vec<Vector> {
        let points = body.mesh().points();
        match self {
            Case::Nothing => vec![[0.0; 3]; points.len()],
            Case::Weight => mass_product(body, &vec![scaled(DENSITY, GRAVITY); points.len()]),
            Case::Field => {
                mass_product(body, &points.iter().map(|&X| field_at(X, time)).collect::<Vec<Vector>>())
            }
            Case::Pressure => pressure(body, q),
        }
    }
}

/// Gauss points, and the Lagrange polynomials on them.
struct Basis {
    points: Vec<f64>,
    weights: Vec<f64>,
}

impl Basis {
    fn new(degree: usize) -> Self {
        let (points, weights) = gauss(degree).iter().map(|(&[point], weight)| (point, weight)).unzip();
        Basis { points, weights }
    }

    fn value(&self, i: usize, alpha: f64) -> f64 {
        let c = &self.points;
        (0..c.len()).filter(|&j| j != i).map(|j| (alpha - c[j]) / (c[i] - c[j])).product()
    }

    /// Integral from 0 to alpha.
    fn integral(&self, i: usize, alpha: f64) -> f64 {
        gauss(self.points.len()).iter().map(|(&[s], w)| alpha * w * self.value(i, alpha * s)).sum()
    }
}

/// The last step of a motion as its time element: positions at a part of it, from the rates.
struct Path<'a> {
    start: &'a State,
    rates: &'a [f64],
    basis: Basis,
}

impl Path<'_> {
    fn rate(&self, i: usize) -> Vec<Vector> {
        let n = self.start.displacement.len();
        self.rates[i * n..(i + 1) * n].as_chunks().0.to_vec()
    }

    fn positions(&self, body: &Body, alpha: f64) -> Vec<Vector> {
        let n = self.start.displacement.len();
        let mut q: Vec<Vector> = (0..n / 3).map(|node| self.start.position(body, node)).collect();
        for j in 0..self.basis.points.len() {
            let passed = self.basis.integral(j, alpha);
            q.iter_mut().zip(self.rate(j)).for_each(|(q, x)| *q = plus(*q, scaled(passed, x)));
        }
        q
    }
}

/// Impulse and angular impulse of loads and drag over a step of a time element,
/// `h sum_i int l_i F dalpha` and `h sum_i q(c_i) x int l_i F dalpha`.
fn impulses_of_element(body: &Body, case: Case, path: &Path<'_>, h: f64) -> [Vector; 2] {
    let (mut linear, mut angular) = ([0.0; 3], [0.0; 3]);
    for i in 0..path.basis.points.len() {
        let q = path.positions(body, path.basis.points[i]);
        let mut add = |factor: f64, forces: &[Vector]| {
            for (q, force) in q.iter().zip(forces) {
                linear = plus(linear, scaled(factor, *force));
                angular = plus(angular, scaled(factor, cross(*q, *force)));
            }
        };
        for (&[alpha], w) in gauss(6).iter() {
            let factor = h * w * path.basis.value(i, alpha);
            add(factor, &case.forces(body, path.start.time + alpha * h, &path.positions(body, alpha)));
        }
        if body.drag() > 0.0 {
            let momentum = mass_product(body, &path.rate(i));
            add(-DRAG * DENSITY * path.basis.weights[i], &momentum);
        }
    }
    [linear, angular]
}

/// Impulses over a step of a classic stepper, by its weights of the forces at start and end. Bathe's method has a third
/// point, whose positions are hidden: its loads must be constant, and the angular impulse is that of no load.
fn impulses_of_classic(body: &Body, case: Case, scheme: Scheme, states: [&State; 2], h: f64) -> [Vector; 2] {
    let end_weight = match scheme {
        Scheme::Newmark(family) => family.parameters().gamma,
        _ => 0.5,
    };
    let (mut linear, mut angular) = ([0.0; 3], [0.0; 3]);
    for (state, w) in states.into_iter().zip([1.0 - end_weight, end_weight]) {
        let n = body.mesh().n_nodes();
        let q: Vec<Vector> = (0..n).map(|node| state.position(body, node)).collect();
        for (q, force) in q.iter().zip(case.forces(body, state.time, &q)) {
            linear = plus(linear, scaled(h * w, force));
            angular = plus(angular, scaled(h * w, cross(*q, force)));
        }
    }
    [linear, angular]
}

fn momenta(body: &Body, state: &State) -> [Vector; 2] {
    let linear = state.momentum.as_chunks().0.iter().fold([0.0; 3], |sum, p| plus(sum, *p));
    [linear, state.angular_momentum(body)]
}

/// Sum of all reactions, times the step size.
fn impulses_of_reactions(reactions: &[Reaction], h: f64) -> [Vector; 2] {
    let sum = |part: fn(&Reaction) -> Vector| {
        scaled(h, reactions.iter().fold([0.0; 3], |sum, reaction| plus(sum, part(reaction))))
    };
    [sum(|reaction| reaction.force), sum(|reaction| reaction.moment)]
}

/// Whether a scheme conserves linear and angular momentum. For any other, its own residual is left over.
fn conserves(scheme: Scheme) -> [bool; 2] {
    match scheme {
        Scheme::TimeElement(element) => {
            let has_stress_of_strain =
                matches!(element.rule, AveragingRule::DiscreteGradient | AveragingRule::AssumedStrain(_));
            // The dissipation changes the angular momentum about axes that supports hold.
            [true, has_stress_of_strain && element.spectral_radius.is_none()]
        }
        // HHT and generalized-alpha weigh the forces of two times, but not the impulses.
        Scheme::Newmark(family) => [matches!(family, NewmarkFamily::Newmark { .. }), false],
        Scheme::Bathe => [true, false],
        Scheme::Static => [false; 2],
        Scheme::CentralDifferences | Scheme::Own(_) => [true; 2],
    }
}

/// Does steps and checks that reactions and loads close both balances.
fn assert_closed(body: &Body, case: Case, scheme: Scheme, h: f64) {
    let spin = InitialVelocity { angular_velocity: [1.0, 2.0, -1.0], ..Default::default() };
    let state = State::initial(body, 0.0, &[spin]).unwrap();
    let mut motion = Motion::starting(body, scheme, tight(), state).unwrap();
    assert!(motion.reactions().is_empty(), "no step, no reaction");
    let mut largest = 0.0_f64;
    for step in 1..=12 {
        let start = motion.state().clone();
        let before = momenta(body, &start);
        motion.step(h).unwrap();
        let after = momenta(body, motion.state());
        let reactions = impulses_of_reactions(motion.reactions(), h);
        let rates = motion.stepper().rates();
        let loads = if rates.is_empty() {
            impulses_of_classic(body, case, scheme, [&start, motion.state()], h)
        } else {
            let path = Path { start: &start, rates, basis: Basis::new(scheme.degree()) };
            impulses_of_element(body, case, &path, h)
        };
        let record = motion.record();
        let residuals = [record.linear_momentum_residual, record.angular_momentum_residual];
        let is_hidden = scheme == Scheme::Bathe && loads[1] != [0.0; 3];
        for i in 0..if is_hidden { 1 } else { 2 } {
            let parts = [minus(after[i], before[i]), reactions[i], loads[i], before[i]];
            let scale = parts.map(norm).into_iter().fold(0.0, f64::max);
            let missing = norm(minus(minus(parts[0], parts[1]), parts[2]));
            let own = if conserves(scheme)[i] { 0.0 } else { residuals[i] };
            let name = format!("{scheme}, step {step}, {}", ["linear", "angular"][i]);
            assert!((missing - own).abs() <= ROUND_OFF * scale, "{name}: {missing:e} - {own:e} of {scale:e}");
            largest = largest.max(norm(reactions[i]) / scale);
        }
    }
    assert!(largest > 1e-2, "{scheme}: the supports do something");
}

const ELEMENTS: [&str; 6] = ["FE(2)", "FE(6)", "AS(4)", "AS(10)", "DGM", "trapezoidal"];
const DAMPED: [&str; 3] = ["DGM(0.5)", "DGM(0)", "AS(10, 0.8)"];
const CLASSIC: [&str; 6] = [
    "Newmark(0.25, 0.5)",
    "Newmark(0.4, 0.7)",
    "HHT(0.1)",
    "generalized-alpha(0.6)",
    "Bathe",
    "central-differences",
];

fn of_degrees(names: &[&str]) -> Vec<Scheme> {
    let parsed = names.iter().map(|name| name.parse::<Scheme>().unwrap());
    parsed.flat_map(|scheme| (1..=3).filter_map(move |degree| scheme.with_degree(degree).ok())).collect()
}

/// Whether a scheme integrates a pressure over its steps as exactly as it is here. Standard rules take their own
/// points, and `l_i F` has degree 3k - 1.
fn is_exact(scheme: Scheme, case: Case) -> bool {
    let rule = scheme.time_element().map(|element| element.rule);
    let is_coarse = matches!(rule, Some(AveragingRule::Standard(2) | AveragingRule::Trapezoidal));
    case != Case::Pressure || !is_coarse
}

fn step_of(scheme: Scheme) -> f64 {
    if scheme == Scheme::CentralDifferences { 0.004 } else { 0.03 }
}

fn every_scheme() -> Vec<Scheme> {
    let classic = CLASSIC.iter().map(|name| name.parse::<Scheme>().unwrap());
    of_degrees(&ELEMENTS).into_iter().chain(of_degrees(&DAMPED)).chain(classic).collect()
}

/// Held on one side along x and y, on another along z; springs on a third.
fn held() -> [Support; 2] {
    [
        Support::of_components("y-min", [true, true, false]),
        Support::of_components("x-min", [false, false, true]),
    ]
}

fn springs() -> PointTerms {
    let spring = |group: &str, stiffness: f64| GroundSpring { group: group.into(), stiffness };
    PointTerms { springs: vec![spring("x-max", 60.0), spring("y-min", 20.0)], ..PointTerms::default() }
}

#[test]
fn reactions_and_loads_change_the_momenta_for_every_stepper() {
    for case in Case::ALL {
        let body = Body::builder(column()).region(rubber()).loads(case.load());
        let supported = body.supports(held()).point_terms(springs()).build().unwrap();
        let groups: Vec<&str> = supported.supported_groups().collect();
        assert_eq!(groups, ["y-min", "x-min", "x-max"]);
        for scheme in every_scheme() {
            // Loads of the hidden point of Bathe's method are not known if they change.
            let is_known = scheme != Scheme::Bathe || matches!(case, Case::Nothing | Case::Weight);
            if is_known && is_exact(scheme, case) {
                assert_closed(&supported, case, scheme, step_of(scheme));
            }
        }
    }
}

#[test]
fn springs_alone_are_supports_too() {
    let body = Body::builder(column()).region(rubber()).point_terms(springs()).build().unwrap();
    every_scheme()
        .into_iter()
        .for_each(|scheme| assert_closed(&body, Case::Nothing, scheme, step_of(scheme)));
}

#[test]
fn damped_bodies_and_driven_supports_close_too() {
    let viscosity = Viscosity { time: 1e-2, shear: 3.0, bulk: 2.0 };
    let damped = || Body::builder(column()).region(rubber().with_viscosity(viscosity)).drag(DRAG);
    let angle = TimeFunction::smooth("0.3 sin(4 t)", |t| [0.3 * (4.0 * t).sin(), 1.2 * (4.0 * t).cos(), 0.0]);
    let rotation = Some(Rotation { axis: [0.0, 1.0, 0.5], about: [0.5; 3], angle });
    // With kinks inside of steps.
    let table = TimeFunction::new(vec![(0.0, 0.0), (0.1, 0.02), (0.21, -0.01), (1.0, 0.0)]).unwrap();
    let driven = [
        Support { group: "y-min".into(), rotation, ..Default::default() },
        Support::driven("y-max", [Some(table), None, None]),
    ];
    for case in [Case::Nothing, Case::Weight, Case::Pressure] {
        let of_damped = damped().loads(case.load()).supports(held()).point_terms(springs()).build().unwrap();
        let schemes = || of_degrees(&ELEMENTS).into_iter().filter(|&scheme| is_exact(scheme, case));
        let all = schemes().chain(of_degrees(&DAMPED));
        all.for_each(|scheme| assert_closed(&of_damped, case, scheme, 0.03));
        let of_driven = damped().loads(case.load()).supports(&driven).build().unwrap();
        schemes().for_each(|scheme| assert_closed(&of_driven, case, scheme, 0.03));
    }
}

/// Checks the balance of the linear momentum under gravity in every accepted step.
struct Balance {
    momentum: Option<Vector>,
    /// Rejections and cuts so far.
    repeated: usize,
}

impl Observer for Balance {
    fn observe(&mut self, view: View<'_>) -> ObserverResult {
        let [now, _] = momenta(view.body, view.state);
        if let Some(before) = self.momentum.replace(now) {
            let h = view.record.step_size;
            let loads = scaled(h * 3.0 * DENSITY, GRAVITY);
            let [reactions, _] = impulses_of_reactions(view.motion.reactions(), h);
            let missing = norm(minus(minus(now, before), plus(reactions, loads)));
            assert!(missing <= ROUND_OFF * (norm(reactions) + norm(loads) + norm(now)), "{missing:e}");
        }
        self.repeated += view.record.rejections + view.record.cuts;
        Ok(())
    }
}

#[test]
fn rejected_and_cut_steps_leave_no_trace() {
    let body = Body::builder(column()).region(rubber()).load(Load::acceleration(GRAVITY)).supports(held());
    let body = body.build().unwrap();
    let adaptivity = Adaptivity { first: Some(0.2), ..Adaptivity::new(1e-4) };
    let adaptive = StepPlan::adaptive(0.0, 0.5, adaptivity).unwrap();
    let mut balance = Balance { momentum: None, repeated: 0 };
    let mut motion = Motion::starting(&body, at("DGM".parse().unwrap(), 2), tight(), rest(&body)).unwrap();
    motion.march(&adaptive, &mut [&mut balance]).unwrap();
    assert!(balance.repeated > 0);
    // Three iterations are too few for the planned steps.
    let few = NewtonSettings { tolerance: 1e-13, max_iterations: 3, ..NewtonSettings::default() };
    let plan = StepPlan::new(0.0, vec![Phase { until: 0.8, size: 0.4 }]).unwrap();
    let mut balance = Balance { momentum: None, repeated: 0 };
    let mut motion = Motion::starting(&body, at("DGM".parse().unwrap(), 1), few, rest(&body)).unwrap();
    motion.allow_cuts(None);
    motion.march(&plan, &mut [&mut balance]).unwrap();
    assert!(balance.repeated > 0);
}

fn rest(body: &Body) -> State {
    State::initial(body, 0.0, &[]).unwrap()
}

#[test]
fn a_released_support_keeps_its_place() {
    let supports =
        [Support::fixed("y-min").until(0.1), Support::of_components("x-min", [true, false, false])];
    let body = Body::builder(column()).region(rubber()).load(Load::acceleration(GRAVITY)).supports(&supports);
    let body = body.build().unwrap();
    for scheme in ["DGM", "Newmark(0.25, 0.5)"] {
        let mut motion =
            Motion::starting(&body, scheme.parse::<Scheme>().unwrap(), tight(), rest(&body)).unwrap();
        for step in 1..=6 {
            let [before, _] = momenta(&body, motion.state());
            motion.step(0.05).unwrap();
            let [first, second] = motion.reactions() else { panic!("two groups") };
            let loads = scaled(0.05 * 3.0 * DENSITY, GRAVITY);
            let reactions = scaled(0.05, plus(first.force, second.force));
            let change = minus(momenta(&body, motion.state())[0], before);
            assert!(
                norm(minus(change, plus(reactions, loads))) < ROUND_OFF * (norm(reactions) + norm(loads))
            );
            assert_eq!(norm(first.force) > 0.0, step <= 2, "{scheme}, step {step}");
        }
    }
}

/// All nodes of a cube are held, each with an eighth of its mass: reactions are known, also which support has them.
#[test]
fn a_component_held_twice_counts_for_the_first() {
    let forces = |order: &[&str]| {
        let cube = Body::builder(emmy::mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber());
        let supports: Vec<Support> = order.iter().map(|group| Support::fixed(*group)).collect();
        let body = cube.load(Load::acceleration(GRAVITY)).supports(&supports).build().unwrap();
        let mut motion = Motion::new(&body, "DGM".parse::<Scheme>().unwrap()).unwrap();
        motion.step(0.1).unwrap();
        let parts = motion.reactions().iter().map(|own| own.force[1] / (-DENSITY * GRAVITY[1]));
        parts.collect::<Vec<f64>>()
    };
    let close = |parts: Vec<f64>, exact: &[f64]| {
        assert!(
            parts.len() == exact.len() && parts.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-14),
            "{parts:?}"
        );
    };
    close(forces(&["x-min", "x-max", "z-min"]), &[0.5, 0.5, 0.0]);
    close(forces(&["z-min", "x-min", "x-max"]), &[0.5, 0.25, 0.25]);
    // Two supports of one group have one reaction.
    close(forces(&["x-min", "x-max", "x-min"]), &[0.5, 0.5]);
}

/// A mass of 2 on a stretched spring: the pull is its weight, in every step.
#[test]
fn a_hanging_mass_at_rest_pulls_with_its_weight() {
    let g = 9.81;
    let (mass, stiffness) = (2.0, 50.0);
    let mesh = network(&[[0.5, 0.0, 1.0], [0.5, 0.0, 0.0]], &[[0, 1]]).with_node_group("top", [0]).unwrap();
    let spring = Link::spring(stiffness, Some(1.0 - mass * g / stiffness)).unwrap();
    let bob = PointMass { group: "1".into(), mass };
    let nodal = PointTerms { masses: vec![bob], ..Default::default() };
    for scheme in every_scheme() {
        let body = Body::builder(mesh.clone()).region(Region::links(spring, 0.0)).point_terms(nodal.clone());
        let body =
            body.support(Support::fixed("top")).load(Load::acceleration([0.0, 0.0, -g])).build().unwrap();
        let mut motion = Motion::new(&body, scheme).unwrap();
        for _ in 0..20 {
            motion.step(0.05).unwrap();
            let Reaction { force, moment } = motion.reactions()[0];
            assert!(norm(minus(force, [0.0, 0.0, mass * g])) < 1e-12 * mass * g, "{scheme}: {force:?}");
            assert!(
                norm(minus(moment, [0.0, -0.5 * mass * g, 0.0])) < 1e-12 * mass * g,
                "{scheme}: {moment:?}"
            );
        }
    }
}

/// A mass on a spring about a fixed point, in a circle: the reaction is the centripetal force m omega^2 r towards the
/// centre, whose mean over a step of the angle a is less by sin(a/2)/(a/2).
#[test]
fn a_mass_in_a_circle_needs_its_centripetal_force() {
    let (mass, omega, radius, stiffness) = (2.0, 3.0, 0.5, 400.0);
    let pull = mass * omega * omega * radius;
    let mesh = network(&[[0.0; 3], [radius, 0.0, 0.0]], &[[0, 1]]).with_node_group("hub", [0]).unwrap();
    let spring = Link::spring(stiffness, Some(radius - pull / stiffness)).unwrap();
    let nodal = PointTerms { masses: vec![PointMass { group: "1".into(), mass }], ..Default::default() };
    let body = Body::builder(mesh).region(Region::links(spring, 0.0)).point_terms(nodal);
    let body = body.support(Support::fixed("hub")).build().unwrap();
    let h = 0.1 / omega;
    for (degree, tolerance) in [(1, 2e-3), (2, 2e-6), (3, 2e-9)] {
        let state = moving(&body, &[[0.0; 3], [0.0, omega * radius, 0.0]]);
        let scheme = at("DGM".parse().unwrap(), degree);
        let mut motion = Motion::starting(&body, scheme, tight(), state).unwrap();
        for step in 1..=10 {
            motion.step(h).unwrap();
            let angle = omega * h * (step as f64 - 0.5);
            let mean = pull * (0.5 * omega * h).sin() / (0.5 * omega * h);
            let exact = [-mean * angle.cos(), -mean * angle.sin(), 0.0];
            let error = norm(minus(motion.reactions()[0].force, exact)) / pull;
            assert!(error < tolerance, "k = {degree}: {error:e}");
        }
    }
}

/// Two springs at one mass share its pull by their stiffness; an attraction is a load, which a support has to hold.
#[test]
fn springs_and_attractions_are_told_apart() {
    let mesh = network(&[[0.0; 3], [2.0, 0.0, 0.0]], &[[0, 1]]).with_node_group("all", [0, 1]).unwrap();
    let mesh = mesh.with_node_group("end", [1]).unwrap();
    let spring = |group: &str, stiffness: f64| GroundSpring { group: group.into(), stiffness };
    let link = Link::spring(3.0, None).unwrap();
    let springs = vec![spring("all", 1.0), spring("end", 3.0), spring("1", 4.0)];
    let nodal = PointTerms { masses: masses(&[1.0, 2.0]), springs, ..Default::default() };
    let body =
        Body::builder(mesh.clone()).region(Region::links(link, 0.0)).point_terms(nodal).build().unwrap();
    for scheme in ["DGM", "Newmark(0.25, 0.5)"] {
        let state = moving(&body, &[[0.0; 3], [1.0, 0.5, 0.0]]);
        let scheme: Scheme = scheme.parse().unwrap();
        let mut motion = Motion::starting(&body, scheme, tight(), state).unwrap();
        motion.step(0.02).unwrap();
        let [_, end, one] = motion.reactions() else { panic!("three groups") };
        assert!(end.force[0] < 0.0 && (one.force[0] / end.force[0] - 4.0 / 3.0).abs() < 1e-14);
    }
    // Both masses are held at distances of 1 and 3 from the centre: strength times mass over distance squared.
    let attraction = GroundAttraction { group: None, centre: [-1.0, 0.0, 0.0], strength: 9.0 };
    let nodal =
        PointTerms { masses: masses(&[1.0, 2.0]), attractions: vec![attraction], ..Default::default() };
    let body = Body::builder(mesh).region(Region::links(link, 0.0)).point_terms(nodal);
    let body = body.support(Support::fixed("all")).build().unwrap();
    for scheme in ["DGM", "Newmark(0.25, 0.5)", "central-differences"] {
        let mut motion = Motion::new(&body, scheme.parse::<Scheme>().unwrap()).unwrap();
        motion.step(0.1).unwrap();
        assert!((motion.reactions()[0].force[0] - (9.0 + 2.0)).abs() < 1e-13, "{scheme}");
    }
}

/// A motion that was resumed has the reactions of the motion itself, bit for bit.
#[test]
fn resumed_motions_have_the_same_reactions() {
    let body = Body::builder(column()).region(rubber()).load(Load::acceleration(GRAVITY)).supports(held());
    let body = body.point_terms(springs()).build().unwrap();
    for scheme in every_scheme() {
        let h = step_of(scheme);
        let mut motion = Motion::starting(&body, scheme, tight(), rest(&body)).unwrap();
        for _ in 0..3 {
            motion.step(h).unwrap();
        }
        let mut resumed = Motion::resumed(&body, scheme, tight(), motion.snapshot()).unwrap();
        motion.step(h).unwrap();
        resumed.step(h).unwrap();
        assert_eq!(motion.reactions(), resumed.reactions(), "{scheme}");
    }
}
