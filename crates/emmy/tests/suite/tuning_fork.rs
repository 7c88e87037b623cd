//! A tuning fork in its lowest modes: the estimated error at the end, in a body that is stiff relative to its steps.

use emmy::body::{Body, InitialVelocity, Region, Support};
use emmy::material::NeoHooke;
use emmy::mesh::{CellKind, Mesh, MeshBuilder};
use emmy::motion::{Adaptivity, GlobalError, Motion, NewtonSettings, Phase, State, StepPlan};
use emmy::time::Scheme;

use crate::shared::schemes::{DGM, at};

fn settings() -> NewtonSettings {
    NewtonSettings { tolerance: 1e-12, max_iterations: 30, ..NewtonSettings::default() }
}

/// Start of the tines, of length 10 and thickness 1.
const TINES: f64 = 3.0;

/// Stem, bridge and tines of bricks of 1/2 x 1 x 1; groups `stem`, `left`, `right`.
fn mesh() -> Mesh {
    let parts = [([2, 4], [0, 2]), ([0, 6], [2, 3]), ([0, 2], [3, 13]), ([4, 6], [3, 13])];
    let corners = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let mut builder = MeshBuilder::new();
    let mut nodes = vec![None; 7 * 14 * 2];
    let mut groups: [Vec<u32>; 3] = Default::default();
    for (part, ([x0, x1], [y0, y1])) in parts.into_iter().enumerate() {
        for (x, y) in (x0..x1).flat_map(|x| (y0..y1).map(move |y| (x, y))) {
            let mut node = |[i, j, z]: [usize; 3]| {
                let point = [0.5 * (x + i) as f64, (y + j) as f64, z as f64];
                *nodes[((x + i) * 14 + y + j) * 2 + z].get_or_insert_with(|| builder.point(point))
            };
            let cell = corners.map(&mut node);
            match (part, y) {
                (0, 0) => groups[0].extend([0, 1, 4, 5].map(|i| cell[i])),
                (2, _) => groups[1].extend(cell),
                (3, _) => groups[2].extend(cell),
                _ => {}
            }
            builder.cell(CellKind::Hex8, &cell).unwrap();
        }
    }
    for (name, nodes) in ["stem", "left", "right"].into_iter().zip(groups) {
        builder.node_group(name, nodes);
    }
    builder.build().unwrap()
}

/// Period of a tine by the theory of slender beams, `tau L^2/1.875^2 sqrt(rho A/(E I))`, A = 1, I = 1/12: 0.98.
fn period() -> f64 {
    std::f64::consts::TAU * 100.0 / 1.8751f64.powi(2) * (12.0 / E).sqrt()
}

/// Young's modulus.
const E: f64 = 4e5;

fn fork() -> Body {
    let (lambda, mu) = (E * 0.3 / (1.3 * 0.4), E / 2.6);
    let metal = Region::new(NeoHooke::new(lambda, mu).unwrap(), 1.0);
    let held = Support { group: "stem".into(), fix: [true; 3], ..Support::default() };
    Body::builder(mesh()).region(metal).support(held).build().unwrap()
}

/// The fork after ten periods by Bathe's method, which damps the modes that its steps do not resolve.
fn ringing(body: &Body) -> State {
    let swing = |group: &str, rate: f64| InitialVelocity {
        group: Some(group.into()),
        velocity: [-rate * TINES, 0.0, 0.0],
        gradient: [[0.0, rate, 0.0], [0.0; 3], [0.0; 3]],
        ..InitialVelocity::default()
    };
    let struck = State::initial(body, 0.0, &[swing("left", -0.3), swing("right", 0.3)]).unwrap();
    let mut motion = Motion::starting(body, at(Scheme::Bathe, 1), settings(), struck).unwrap();
    let h = period() / 20.0;
    for _ in 1..=200 {
        motion.step(h).unwrap();
    }
    State { time: 0.0, step: 0, ..motion.state().clone() }
}

fn equal(end: f64, n: usize) -> StepPlan {
    StepPlan::new(0.0, vec![Phase { until: end, size: end / n as f64 }]).unwrap()
}

/// The state at the end of a plan.
fn marched(body: &Body, start: &State, degree: usize, plan: &StepPlan) -> State {
    let mut motion = Motion::starting(body, at(DGM, degree), settings(), start.clone()).unwrap();
    motion.march(plan, &mut []).unwrap();
    motion.state().clone()
}

/// Estimated over true error of the positions at the end of a plan, and the true one.
fn effectivity(body: &Body, start: &State, degree: usize, plan: &StepPlan, exact: &State) -> (f64, f64) {
    let mut estimate = GlobalError::new(body, at(DGM, degree), settings(), start).unwrap();
    let mut motion = Motion::starting(body, at(DGM, degree), settings(), start.clone()).unwrap();
    motion.march(plan, &mut [&mut estimate]).unwrap();
    let pairs = motion.state().displacement.iter().zip(&exact.displacement);
    let error: Vec<f64> = pairs.map(|(own, exact)| own - exact).collect();
    (
        body.mass_weighted_rms(estimate.displacement()) / body.mass_weighted_rms(&error),
        body.mass_weighted_rms(&error),
    )
}

#[test]
fn the_error_at_the_end_is_estimated_in_low_modes() {
    let body = fork();
    let start = ringing(&body);
    let end = 0.7 * period();
    let exact = marched(&body, &start, 4, &equal(end, 120));
    let other = marched(&body, &start, 5, &equal(end, 80));
    let pairs = other.displacement.iter().zip(&exact.displacement);
    let doubt = body.mass_weighted_rms(&pairs.map(|(a, b)| a - b).collect::<Vec<_>>());
    // The book's table has the last two columns: with equal steps, with adaptive ones.
    for (degree, n, tolerance, quoted) in
        [(1, 40, 1e-5, [1.000, 1.000]), (2, 15, 1e-6, [0.99, 0.98]), (3, 8, 1e-6, [0.95, 0.79])]
    {
        let adaptive = StepPlan::adaptive(0.0, end, Adaptivity::new(tolerance)).unwrap();
        for (name, plan, quoted) in [("equal", equal(end, n), quoted[0]), ("adaptive", adaptive, quoted[1])] {
            let (ratio, error) = effectivity(&body, &start, degree, &plan, &exact);
            println!(
                "k = {degree}, {name} steps: estimated/true {ratio:.4}, error {error:.2e}, references differ by {doubt:.1e}"
            );
            // The reference is accurate enough as a divisor.
            assert!(doubt < 0.1 * error, "k = {degree}, {name}: {error:e}, references differ by {doubt:e}");
            assert!(
                (ratio - quoted).abs() < 0.01,
                "k = {degree}, {name}: {ratio} is not the book's {quoted}"
            );
        }
    }
}
