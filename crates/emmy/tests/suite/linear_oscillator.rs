//! One degree of freedom in tiny vibration: every stepper against its amplification in closed form.
//!
//! A brick of length 1 and cross-section 2 x 2 is clamped at one end and cannot move sideways. Its axial mode has the
//! stiffness (lambda + 2 mu) A/L = 12 and a third of the brick's mass, 4/3 (half of it, 2, with lumped mass).

use emmy::body::{Body, Region, Support};
use emmy::material::SaintVenantKirchhoff;
use emmy::motion::{Motion, NewtonSettings, State};
use emmy::time::Scheme;

use crate::shared::schemes::at;

const OMEGA: f64 = 3.0;
const OMEGA_LUMPED: f64 = 2.449_489_742_783_178;

/// So small that the non-linearity is below rounding.
const AMPLITUDE: f64 = 1e-13;

fn brick() -> Body {
    let mesh = emmy::mesh::block([1.0, 2.0, 2.0], [1; 3]).unwrap();
    let material = SaintVenantKirchhoff::new(1.0, 1.0).unwrap();
    let supports = [
        Support { group: "x-min".into(), fix: [true; 3], ..Default::default() },
        Support { group: "body".into(), fix: [false, true, true], ..Default::default() },
    ];
    Body::builder(mesh).region(Region::new(material, 1.0)).supports(&supports).build().unwrap()
}

/// The axial mode, displaced by the amplitude with a velocity of half of it.
fn displaced(body: &Body) -> State {
    let mut state = State::initial(body, 0.0, &[]).unwrap();
    for (node, point) in body.mesh().points().iter().enumerate().filter(|(_, point)| point[0] == 1.0) {
        assert_eq!(point[0], 1.0);
        state.displacement[3 * node] = AMPLITUDE;
        state.velocity[3 * node] = 0.5 * AMPLITUDE;
    }
    body.mass_product(&state.velocity, &mut state.momentum);
    state
}

/// Displacement and velocity of the free end over the amplitude, after every step.
fn run(scheme: Scheme, h: f64, n_steps: usize) -> Vec<[f64; 2]> {
    let body = brick();
    let settings = NewtonSettings { tolerance: 1e-13, max_iterations: 20, ..NewtonSettings::default() };
    let mut motion = Motion::starting(&body, at(scheme, 1), settings, displaced(&body)).unwrap();
    let node = body.mesh().nearest_node([1.0, 0.0, 0.0]);
    let step = |_: usize| {
        motion.step(h).unwrap();
        let state = motion.state();
        [state.displacement[3 * node] / AMPLITUDE, state.velocity[3 * node] / AMPLITUDE]
    };
    (1..=n_steps).map(step).collect()
}

fn assert_same(what: &str, found: &[[f64; 2]], expected: &[[f64; 2]]) {
    let size = |i: usize| expected.iter().fold(1e-300, |size: f64, y| size.max(y[i].abs()));
    for (n, (found, expected)) in found.iter().zip(expected).enumerate() {
        for i in 0..2 {
            let error = (found[i] - expected[i]).abs() / size(i);
            assert!(error < 1e-9, "{what}, step {}: {found:?} instead of {expected:?}", n + 1);
        }
    }
}

/// Hughes (1987), section 9.3, with the alphas of Chung and Hulbert (1993): the acceleration of the linear oscillator.
fn newmark_family([alpha_m, alpha_f, beta, gamma]: [f64; 4], h: f64, n_steps: usize) -> Vec<[f64; 2]> {
    let square = OMEGA * OMEGA;
    let (mut u, mut v) = (1.0, 0.5);
    let mut a = -square * u;
    let step = |_| {
        let predicted = u + h * v + h * h * (0.5 - beta) * a;
        let force = square * ((1.0 - alpha_f) * predicted + alpha_f * u);
        let new = -(force + alpha_m * a) / (1.0 - alpha_m + (1.0 - alpha_f) * beta * h * h * square);
        u = predicted + beta * h * h * new;
        v += h * ((1.0 - gamma) * a + gamma * new);
        a = new;
        [u, v]
    };
    (0..n_steps).map(step).collect()
}

#[test]
fn newmark_family_matches_the_textbooks() {
    let third = 1.0 / 3.0;
    for (scheme, parameters) in [
        ("Newmark(0.25, 0.5)", [0.0, 0.0, 0.25, 0.5]),
        ("Newmark(0.3025, 0.6)", [0.0, 0.0, 0.3025, 0.6]),
        ("HHT(0.05)", [0.0, 0.05, 0.275625, 0.55]),
        ("HHT(0.3)", [0.0, 0.3, 0.4225, 0.8]),
        ("generalized-alpha(1)", [0.5, 0.5, 0.25, 0.5]),
        ("generalized-alpha(0.5)", [0.0, third, 4.0 / 9.0, 5.0 / 6.0]),
        ("generalized-alpha(0)", [-1.0, 0.0, 1.0, 1.5]),
    ] {
        for h in [0.1, 0.5, 3.0, 300.0] {
            let found = run(scheme.parse().unwrap(), h, 20);
            assert_same(&format!("{scheme}, h = {h}"), &found, &newmark_family(parameters, h, 20));
        }
    }
}

/// The trapezoidal rule and the three-point backward difference on the first-order system `u' = v, v' = -omega^2 u`
/// (TR-BDF2 of Bank and others 1985).
fn composite(h: f64, n_steps: usize) -> Vec<[f64; 2]> {
    let (square, split) = (OMEGA * OMEGA, 2.0 - 2f64.sqrt());
    // (c I - A) y = r
    let solve = |c: f64, r: [f64; 2]| {
        let det = c * c + square;
        [(c * r[0] + r[1]) / det, (c * r[1] - square * r[0]) / det]
    };
    let mut y = [1.0, 0.5];
    let step = |_| {
        let c = 2.0 / (split * h);
        let middle = solve(c, [c * y[0] + y[1], c * y[1] - square * y[0]]);
        // Derivative at 1 of the parabola through 0, split, 1.
        let [c_1, c_2] = [(1.0 - split) / (split * h), -1.0 / (split * (1.0 - split) * h)];
        y = solve((2.0 - split) / ((1.0 - split) * h), [0, 1].map(|i| -c_1 * y[i] - c_2 * middle[i]));
        y
    };
    (0..n_steps).map(step).collect()
}

#[test]
fn bathe_is_the_composite_rule() {
    for h in [0.1, 0.5, 3.0, 30.0] {
        assert_same(&format!("Bathe, h = {h}"), &run(Scheme::Bathe, h, 10), &composite(h, 10));
    }
}

#[test]
fn central_differences_match_the_lumped_oscillator() {
    let square = OMEGA_LUMPED * OMEGA_LUMPED;
    for h in [0.05, 0.4, 0.8] {
        let (mut u, mut v) = (1.0, 0.5);
        let step = |_| {
            let old = u;
            u += h * v - 0.5 * h * h * square * u;
            v -= 0.5 * h * square * (old + u);
            [u, v]
        };
        let expected: Vec<[f64; 2]> = (0..50).map(step).collect();
        assert_same(&format!("h = {h}"), &run(Scheme::CentralDifferences, h, 50), &expected);
    }
}

/// Residuals of the recurrence `(E - s)(E - r)^2 y = 0` over the largest y, E the shift by a step: roots of the
/// amplification.
fn recurrence(values: &[f64], s: f64, r: f64) -> f64 {
    let size = values.iter().fold(0.0, |size: f64, y| size.max(y.abs()));
    let residual = |y: &[f64]| y[3] - (s + 2.0 * r) * y[2] + (2.0 * s * r + r * r) * y[1] - s * r * r * y[0];
    values.windows(4).map(|y| residual(y).abs() / size).fold(0.0, f64::max)
}

/// Spectral radius at infinite frequency: rho for generalized-alpha (Chung and Hulbert (1993), section 3), `(1 -
/// alpha)/(1 + alpha)` for HHT (Hilber, Hughes and Taylor 1977) with the spurious root `-alpha/(1 - alpha)`, 1 for
/// average acceleration.
#[test]
fn high_modes_decay_by_the_spectral_radius() {
    for (scheme, spurious, radius) in [
        ("Newmark(0.25, 0.5)", 0.0, 1.0),
        ("HHT(0.05)", 0.05 / 0.95, 0.95 / 1.05),
        ("HHT(0.3)", 0.3 / 0.7, 0.7 / 1.3),
        ("generalized-alpha(0.8)", 0.8, 0.8),
        ("generalized-alpha(0.5)", 0.5, 0.5),
        ("generalized-alpha(0)", 0.0, 0.0),
    ] {
        let found = run(scheme.parse().unwrap(), 1e5, 12);
        for i in 0..2 {
            let values: Vec<f64> = found.iter().map(|y| y[i]).collect();
            let residual = recurrence(&values, -spurious, -radius);
            assert!(residual < 1e-8, "{scheme}: {residual:e}");
        }
    }
    // L-stable: an unresolved mode vanishes after one step, to 4 h/omega (here 1e-5).
    let [u, v] = run(Scheme::Bathe, 1e6, 1)[0];
    assert!(u.abs() < 1e-5 && v.abs() < 1e-5, "{u:e} {v:e}");
}

#[test]
fn average_acceleration_conserves_the_energy_of_a_linear_system() {
    let energies = |scheme: &str, h: f64| {
        let body = brick();
        let settings = NewtonSettings { tolerance: 1e-13, max_iterations: 20, ..NewtonSettings::default() };
        let mut motion =
            Motion::starting(&body, at(scheme.parse().unwrap(), 1), settings, displaced(&body)).unwrap();
        let start = motion.record().total_energy;
        let step = |_| motion.step(h).unwrap().total_energy / start - 1.0;
        (1..=300).map(step).collect::<Vec<f64>>()
    };
    for h in [0.1, 1.0, 10.0] {
        let worst =
            energies("Newmark(0.25, 0.5)", h).into_iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
        assert!(worst < 1e-11, "h = {h}: {worst:e}");
    }
    for scheme in ["Newmark(0.3025, 0.6)", "HHT(0.05)", "generalized-alpha(0.8)", "Bathe"] {
        assert!(energies(scheme, 1.0)[299] < -0.9, "{scheme}");
    }
}

/// The critical step of the lumped oscillator is 2/omega; the axial mode is the highest of the brick's four.
#[test]
fn central_differences_know_their_critical_step() {
    let body = brick();
    let critical = 2.0 / OMEGA_LUMPED;
    let start = displaced(&body);
    let settings = NewtonSettings::default();
    let mut motion = Motion::starting(&body, at(Scheme::CentralDifferences, 1), settings, start).unwrap();
    let before = motion.state().clone();
    match motion.step(0.981 * critical) {
        Err(emmy::Error::StepTooLarge { step: 1, critical: found, limit, .. }) => {
            assert!((found / critical - 1.0).abs() < 1e-5 && (limit / found - 0.98).abs() < 1e-12);
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(*motion.state(), before);
    let h = 0.979 * critical;
    // Stable to the end: the velocity stays below the exact one divided by the root of 1 - (h/h_critical)^2.
    for _ in 1..=500 {
        motion.step(h).unwrap();
        let largest = motion.state().displacement.iter().fold(0.0, |size: f64, u| size.max(u.abs()));
        assert!(largest < 2.0 * AMPLITUDE);
    }
}
