//! The load `body_force`: expressions of position and time, against integrals and a solution worked out by hand.

use emmy::motion::{Motion, State};
use emmy_io::input::{self, Overrides, Problem};

fn problem(text: &str) -> Problem {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("box.toml");
    std::fs::write(&file, text).unwrap();
    input::read(&file, &Overrides::default()).unwrap()
}

fn motion(problem: &Problem) -> Motion<'_> {
    let state = State::initial(&problem.body, 0.0, &problem.initial).unwrap();
    Motion::starting(&problem.body, problem.scheme, problem.newton, state).unwrap()
}

/// A free block [0, 2] x [0, 1] x [0, 1].
const FREE: &str = "
    mesh.box = { size = [2, 1, 1], cells = [4, 2, 2] }
    region = [{ density = 2, material.neo-hooke = { lambda = 10, mu = 5 } }]
    load = [{ body_force = [3, 'y*exp(-t)', 'x^2*y*z*sin(t)'] }]
    time = { scheme = 'DGM', degree = 2, steps = [{ until = 1, size = 0.1 }] }\n";

/// Integrals over the block: x^2 y z dV = 8/3 1/2 1/2, and y dV = 2 1/2; moments about the origin likewise.
#[test]
fn force_and_torque_are_the_integrals_of_the_expressions() {
    let problem = problem(FREE);
    let (body, time) = (&problem.body, 0.7f64);
    let mut force = vec![0.0; body.n_dofs()];
    assert!(body.loads_at(time, &mut force).unwrap());
    let (b_y, b_z) = ((-time).exp(), time.sin());
    let total = emmy::internals::body::sum(&force);
    for (found, expected) in total.into_iter().zip([6.0, b_y, 2.0 / 3.0 * b_z]) {
        assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
    }
    // The shape functions reproduce X, so the moment of the nodal forces is that of the field.
    let torque = body.moment(&vec![0.0; body.n_dofs()], &force);
    // y b_z - z b_y = y^2 z x^2 b_z - z y b_y, z b_x - x b_z = 3 z - x^3 y z b_z, x b_y - y b_x = x y b_y - 3 y.
    let expected = [8.0 / 3.0 / 3.0 / 2.0 * b_z - 0.5 * b_y, 3.0 - b_z, b_y - 3.0];
    for (found, expected) in torque.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-14, "{found} is not {expected}");
    }
    let resultant = body.load_resultants()[0];
    assert!((resultant.force[0] - 6.0).abs() < 1e-14 && (resultant.force[1] - 1.0).abs() < 1e-14);
}

/// The momentum at t = 1 is the impulse of the field, and the work is the change of the energy, both to round-off.
#[test]
fn momentum_and_energy_are_balanced_at_round_off() {
    let problem = problem(FREE);
    let mut motion = motion(&problem);
    let mut energy: f64 = 0.0;
    for _ in 0..10 {
        let record = motion.step(0.1).unwrap();
        energy = energy.max(record.total_energy);
        assert!(record.energy_residual.abs() < 1e-12 * energy, "{}", record.energy_residual);
        assert!(record.linear_momentum_residual < 1e-12, "{}", record.linear_momentum_residual);
        assert!(record.angular_momentum_residual < 1e-11, "{}", record.angular_momentum_residual);
    }
    let record = motion.record();
    let impulse = [6.0, 1.0 - (-1f64).exp(), 2.0 / 3.0 * (1.0 - 1f64.cos())];
    for (found, expected) in record.linear_momentum.into_iter().zip(impulse) {
        assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
    }
    assert!((record.external_work - record.total_energy).abs() < 1e-12 * record.total_energy);
    assert!(record.strain_energy > 1e-3);
}

/// A bar that moves along x alone, u = 0.1 x (2 - x) sin^2 t, held at x = 0 and free at x = 1. With F = 1 + u_,x and
/// P = mu (F - 1/F) + lambda ln F / F it needs
///
/// b = rho u_,tt - dP/dF u_,xx,    dP/dF = mu (1 + 1/F^2) + lambda (1 - ln F)/F^2
fn bar(n: usize) -> f64 {
    let stretch = "(1 + 0.2*(1 - x)*sin(t)^2)";
    let modulus = format!("(20*(1 + 1/{stretch}^2) + 30*(1 - ln({stretch}))/{stretch}^2)");
    let force = format!("1.5*0.2*x*(2 - x)*cos(2*t) + {modulus}*0.2*sin(t)^2");
    let problem = problem(&format!(
        "mesh.box = {{ size = [1, 0.5, 0.5], cells = [{n}, 1, 1] }}
        region = [{{ density = 1.5, material.neo-hooke = {{ lambda = 30, mu = 20 }} }}]
        load = [{{ group = 'body', body_force = ['{force}', 0, 0] }}]
        support = [{{ group = 'body', fix = ['y', 'z'] }}, {{ group = 'x-min', fix = ['x'] }}]
        time = {{ scheme = 'DGM', degree = 3, steps = [{{ until = 1, size = 0.1 }}] }}\n"
    ));
    let mut motion = motion(&problem);
    for _ in 0..10 {
        motion.step(0.1).unwrap();
    }
    let nodes = problem.body.mesh().points().iter().zip(motion.state().displacement.chunks_exact(3));
    let exact = |x: f64| 0.1 * x * (2.0 - x) * 1f64.sin().powi(2);
    nodes.map(|(point, u)| (u[0] - exact(point[0])).abs()).fold(0.0, f64::max)
}

#[test]
fn a_manufactured_motion_comes_back_with_order_2() {
    let [coarse, fine] = [8, 16].map(bar);
    let order = (coarse / fine).log2();
    assert!((order - 2.0).abs() < 0.2 && fine < 1e-4, "order {order}, {fine:e}");
}

/// `history` is a factor, and a group bounds the load.
#[test]
fn groups_and_histories_go_with_it() {
    let text = FREE.replace("'x^2*y*z*sin(t)'] }", "'x'], group = 'body', history = [[0, 0], [1, 4]] }");
    let problem = problem(&text);
    let mut force = vec![0.0; problem.body.n_dofs()];
    problem.body.loads_at(0.5, &mut force).unwrap();
    // Factor 2 times the integral of x.
    assert!((emmy::internals::body::sum(&force)[2] - 4.0).abs() < 1e-14);
}
