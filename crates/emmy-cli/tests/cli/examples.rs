//! Every example runs unchanged, with a number as evidence. Some of the numbers come from `examples.py` beside this
//! file, which computes the same motions on the same meshes without Emmy, with an error in time below their last digit.

use super::Place;

fn run(name: &str) -> (Place, std::collections::BTreeMap<String, Vec<f64>>) {
    let place = Place::new();
    let file = format!("{name}.toml");
    place.succeed(&["new", name]);
    place.succeed(&["run", &file, "--quiet"]);
    let history = place.history(name);
    (place, history)
}

fn close(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance * expected.abs(), "{value} is not {expected}");
}

fn last(column: &[f64]) -> f64 {
    column[column.len() - 1]
}

#[test]
fn l_block() {
    let (place, history) = run("l-block");
    close(last(&history["total_energy"]), 5500.150056, 1e-9);
    close(last(&history["angular_momentum_x"]), 1745.575399, 1e-9);
    close(last(&history["angular_momentum_y"]), 977.681278, 1e-9);
    close(last(&history["angular_momentum_z"]), -1233.645985, 1e-9);
    assert_eq!(place.summary("l-block")["steps"], 175);
}

#[test]
fn quasi_rigid() {
    let (_, history) = run("quasi-rigid");
    close(last(&history["total_energy"]), 4340.552314, 1e-9);
    close(last(&history["angular_momentum_x"]), 2231.747394, 1e-9);
    close(last(&history["angular_momentum_z"]), -1612.465803, 1e-9);
}

#[test]
fn cantilever() {
    let (_, history) = run("cantilever");
    // The falling body gains the work of gravity: T + V equals the work, always.
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work).abs() < 1e-8, "{energy} {work}");
    }
    // `examples.py`; the steps of 0.05 pass the turning point, at t = 1.265, by 0.015.
    let lowest = history["end_z"].iter().copied().fold(f64::INFINITY, f64::min);
    close(lowest, -4.04943, 1e-3);
}

#[test]
fn spinning_block() {
    let (_, history) = run("spinning-block");
    for name in ["total_energy", "angular_momentum_x", "angular_momentum_y", "angular_momentum_z"] {
        history[name].iter().for_each(|&value| close(value, history[name][0], 1e-12));
    }
    close(history["total_energy"][0], 464.5311, 1e-12);
}

#[test]
fn soft_tissue() {
    let (place, history) = run("soft-tissue");
    // v = A (X - c) + G c with the squares 0.29, 0.1925, 0.0725 of the columns of A, the second moments V L^2 / 12 of
    // the strip, and the mass 0.088: at all times,
    // T = 1.1e-3/2 80/12 (0.29 10^2 + 0.1925 4^2 + 0.0725 2^2) + 0.088/2 (1.5^2 + 0.3^2 + 0.15^2) is the whole energy.
    history["total_energy"].iter().for_each(|&value| close(value, 0.22264, 1e-10));
    let strained = history["strain_energy"].iter().copied().fold(0.0, f64::max);
    assert!(strained > 0.01, "{strained}");
    assert!(place.read("soft-tissue/input.toml").contains("mu/b*(exp(b/2*(I1_bar - 3)) - 1)"));
}

#[test]
fn plane_beam() {
    let (_, history) = run("plane-beam");
    // From t = 1 on it vibrates freely, with all its energy, by more than its thickness.
    let swing = history["time"].iter().position(|&time| time >= 1.0).unwrap();
    let energy = &history["total_energy"][swing..];
    energy.iter().for_each(|&value| close(value, energy[0], 1e-11));
    let (largest, tip) = (0.5, &history["tip_x"][swing..]);
    assert!(tip.iter().any(|&x| x > largest) && tip.iter().any(|&x| x < -largest), "{tip:?}");
    // A clamped beam's first mode: omega = 1.8751^2 sqrt(E' I / (rho A)) / L^2, E' = E / (1 - nu^2); half a period lies
    // between the turning points. The linear cells are stiffer than the beam (shear locking); large deflection hardly
    // matters.
    let crossings: Vec<f64> = (1..tip.len())
        .filter(|&i| (tip[i - 1] > 0.0) != (tip[i] > 0.0))
        .map(|i| {
            let (a, b) = (tip[i - 1], tip[i]);
            history["time"][swing + i - 1] + 0.05 * a / (a - b)
        })
        .collect();
    let omega = 1.8751f64.powi(2) * (1e5f64 / 0.91 * 0.25 / 12.0).sqrt() / 64.0;
    let half_period = std::f64::consts::PI / omega;
    let measured = (crossings[crossings.len() - 1] - crossings[0]) / (crossings.len() - 1) as f64;
    assert!(measured < half_period && measured > 0.7 * half_period, "{measured} {half_period}");
}

#[test]
fn two_body() {
    let (_, history) = run("two-body");
    for (name, expected) in [("total_energy", 0.75 - 4.0), ("angular_momentum_z", -1.5)] {
        history[name].iter().for_each(|&value| close(value, expected, 1e-12));
    }
    // Kepler: with mu = 2/3 and g = 6 the semi-axis is a = -g / 2E, the period 2 pi sqrt(mu a^3 / g). The planet starts
    // at its aphelion, on the negative x axis, and returns there after every period.
    let a = 6.0 / 6.5;
    let period = std::f64::consts::TAU * (2.0 / 3.0 * f64::powi(a, 3) / 6.0).sqrt();
    let (x, y, time) = (&history["planet_x"], &history["planet_y"], &history["time"]);
    let back = (1..y.len()).filter(|&i| y[i - 1] < 0.0 && y[i] >= 0.0 && x[i] < 0.0);
    let mut times = back.map(|i| time[i - 1] + 0.05 * y[i - 1] / (y[i - 1] - y[i]));
    close(times.nth(9).unwrap(), 10.0 * period, 2e-3);
}

#[test]
fn comet() {
    let (_, history) = run("comet");
    // a = 1.5/1.9, T = tau sqrt(a^3 mu/g): the nearest distance is a (1 - e), and after each period the comet is where
    // it started.
    let a = 1.5 / 1.9;
    let period = std::f64::consts::TAU * f64::sqrt(a * a * a / 9.0);
    let sizes = &history["step_size"][1..];
    let (least, most) =
        (sizes.iter().copied().fold(f64::INFINITY, f64::min), sizes.iter().copied().fold(0.0, f64::max));
    // The factor in the book.
    assert!((60.0..90.0).contains(&(most / least)), "{}", most / least);
    let radius = |i: usize| 1.5 * history["comet_x"][i].hypot(history["comet_y"][i]);
    let nearest = (0..history["time"].len()).map(radius).fold(f64::INFINITY, f64::min);
    assert!((nearest / (0.1 * a) - 1.0).abs() < 0.02, "{nearest}");
    let energy = history["total_energy"][0];
    // Relative to the largest T + |V|, forty times the total: conservation of the difference is limited by its terms.
    let parts = history["kinetic_energy"].iter().zip(&history["strain_energy"]).map(|(t, v)| t + v.abs());
    let largest = parts.fold(0.0, f64::max);
    assert!(history["total_energy"].iter().all(|e| (e - energy).abs() < 1e-11 * largest));
    let returns = (20.0 / period).floor();
    let at = |t: f64| {
        let i = history["time"].iter().position(|time| *time > t).unwrap();
        let part = (t - history["time"][i - 1]) / (history["time"][i] - history["time"][i - 1]);
        history["comet_x"][i - 1] + part * (history["comet_x"][i] - history["comet_x"][i - 1])
    };
    assert!((at(returns * period) + 1.0).abs() < 0.01, "{}", at(returns * period));
}

#[test]
fn struck_block() {
    let (_, history) = run("struck-block");
    let last = history["time"].len() - 1;
    // The pulse has the impulse 100 * 0.02, along y 20 * 0.02; its drag lets the momentum decay like exp(-t/2), with F
    // a triangle about t = 0.02:
    // P(t) = I exp(-(t - 0.02)/2) (sinh(x)/x)^2, x = 0.02/4, which is 1 + 8e-6.
    for (axis, impulse) in [("x", 2.0), ("y", 0.4)] {
        let momentum = history[&format!("linear_momentum_{axis}")][last];
        close(momentum, impulse * (-0.5f64 * (history["time"][last] - 0.02)).exp(), 3e-5);
    }
    let work = history["external_work"][last];
    for i in 0..=last {
        let left = history["total_energy"][i] + history["dissipated_energy"][i] - history["external_work"][i];
        assert!(left.abs() < 1e-11 * work, "{left:e}");
    }
    // In the end only the motion of the whole body is left, T = P^2/(2 m), and a rotation that only the drag brakes.
    assert!(history["dissipated_energy"][last] > 0.9 * work);
    // The coast takes steps many times as long as in the pulse, which ends at t = 0.04.
    let in_pulse = (1..=last).filter(|&i| history["time"][i] < 0.041).map(|i| history["step_size"][i]);
    assert!(history["step_size"][last] > 10.0 * in_pulse.fold(0.0, f64::max));
}

#[test]
fn spring_network() {
    let (_, history) = run("spring-network");
    // Twelve springs of length sqrt 2 with k = 20 and 1.2 at rest; masses 0.5 and 0.75 at the ends, bars of mass 0.02.
    let springs = 12.0 * 10.0 * (2f64.sqrt() - 1.2).powi(2);
    close(history["strain_energy"][0], springs, 1e-12);
    for name in ["total_energy", "angular_momentum_x", "angular_momentum_y", "angular_momentum_z"] {
        history[name].iter().for_each(|&value| close(value, history[name][0], 1e-11));
    }
    // L_z = m (x v_y - y v_x) of the four ends in the plane, v = omega x X + gradient X, and of two bars m L^2/12
    // omega.
    close(history["angular_momentum_z"][0], (0.75 + 3.0 * 0.5) * 2.0 + 2.0 * 0.02 * 4.0 / 12.0 * 2.0, 1e-12);
}

#[test]
fn driven_beam() {
    let (_, history) = run("driven-beam");
    let (time, energy, work) = (&history["time"], &history["total_energy"], &history["external_work"]);
    let released = time.iter().position(|&t| t == 1.0).expect("a step ends at the release");
    for (energy, work) in energy.iter().zip(work) {
        assert!((energy - work).abs() < 1e-11 * last(&history["total_energy"]), "{energy} {work}");
    }
    // `examples.py`. As a rigid body it would have the energy m (L^2/3 + a^2/12) omega^2/2 = 342,667; it bends, and
    // swings ahead.
    close(energy[released], 427_374.1, 1e-3);
    for (axis, expected) in [("end_x", -10.97), ("end_y", -7.16)] {
        assert!((last(&history[axis]) - expected).abs() < 0.02 * 10.97, "{axis}: {}", last(&history[axis]));
    }
    // Free flight.
    for name in ["total_energy", "linear_momentum_x", "angular_momentum_z", "external_work"] {
        history[name][released..].iter().for_each(|&value| close(value, history[name][released], 1e-10));
    }
}

#[test]
fn balloon() {
    let (place, history) = run("balloon");
    let largest = place.summary("balloon")["largest_energy"].as_f64().unwrap();
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work).abs() < 1e-11 * largest, "{energy} {work}");
    }
    // Once the pressure is constant, at t = 0.01, its work is 30000 times the volume swept since. An inflated square
    // membrane of height w sweeps a volume between a pyramid, L^2 w / 3, and a box, L^2 w; its middle is about the
    // highest point.
    let (time, height) = (&history["time"], &history["middle_z"]);
    let from = time.iter().position(|&t| t >= 0.01 - 1e-9).unwrap();
    let top = (from..time.len()).max_by(|&a, &b| height[a].total_cmp(&height[b])).unwrap();
    let volume = (history["external_work"][top] - history["external_work"][from]) / 3e4;
    let part = volume / (0.04 * (height[top] - height[from]));
    assert!((1.0 / 3.0..1.0).contains(&part), "{part}");
    // `examples.py`.
    close(height[top], 0.093215, 1e-3);
    close(last(height), 0.073290, 1e-2);
}

/// Runs an example in its own folder, because its mesh is there.
fn run_in_place(name: &str) -> (Place, std::collections::BTreeMap<String, Vec<f64>>) {
    let place = Place::new();
    let file = format!("{}/../../examples/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    place.succeed(&["run", &file, "--quiet", "--output", name]);
    let history = place.history(name);
    (place, history)
}

#[test]
fn tuning_fork() {
    let (place, history) = run_in_place("tuning-fork");
    let energy = &history["total_energy"];
    energy.iter().for_each(|&value| close(value, energy[0], 1e-11));
    assert!(place.summary("tuning-fork")["worst_angular_momentum_residual"].as_f64().unwrap() < 1e-13);
    // A tine is nearly a clamped beam (4 mm thick, 55 mm free). By Euler and Bernoulli, half a period is pi L^2 /
    // (1.8751^2 h c / sqrt(12)), c^2 = E / rho. The yoke deforms too, so the tip returns a little later.
    let c = (2.1e5f64 / 7.85e-9).sqrt();
    let half_period = std::f64::consts::PI * 55.0 * 55.0 / (1.8751f64.powi(2) * 4.0 * c / 12f64.sqrt());
    let outside = history["tip_x"].iter().skip(1).take_while(|&&x| x > 7.0).count();
    let back = history["time"][outside + 1];
    assert!(back > half_period && back < 1.25 * half_period, "{back} {half_period}");
}

/// Results of an independent implementation of ties and of the DGM.
#[test]
fn tied_blocks() {
    let place = Place::new();
    let file = format!("{}/../../examples/tied-blocks.toml", env!("CARGO_MANIFEST_DIR"));
    // The strain energy is 1/700 of the whole: the default tolerance leaves it seven digits.
    let run = |sets: &[&str]| {
        let flags = ["run", &file, "--quiet", "--output", "tied-blocks", "--set", "newton.tolerance=1e-13"];
        place.succeed(&[&flags, sets].concat());
        place.history("tied-blocks")
    };
    let finer = ["--set", "time.degree=2", "--set", "time.steps.0.size=0.1"];
    for (sets, energies, top, bottom) in [
        (
            &[][..],
            [3.573158883791574, 0.005241116208426],
            [1.249490358226591, 2.038651597294709, 2.363306591223248],
            [0.750740421868741, -0.038626594418302, -0.363320557016711],
        ),
        (
            &finer[..],
            [3.574196067735902, 0.004203932264101],
            [1.250016272751419, 2.038223019210577, 2.363432640967401],
            [0.749744927132334, -0.038150443788279, -0.363522817419413],
        ),
    ] {
        let history = run(sets);
        for (name, energy) in ["kinetic_energy", "strain_energy"].into_iter().zip(energies) {
            close(last(&history[name]), energy, 1e-9);
        }
        for (probe, place) in [("top", top), ("bottom", bottom)] {
            for (axis, expected) in ["x", "y", "z"].into_iter().zip(place) {
                let x = last(&history[&format!("{probe}_{axis}")]);
                assert!((x - expected).abs() < 1e-9, "{probe}_{axis}: {x} is not {expected}");
            }
        }
        // The moments of inertia of a cube of mass 8 and edges of 2 are 16/3.
        for (axis, spin) in [("x", 0.5), ("y", 0.3), ("z", 1.0)] {
            let momenta = &history[&format!("angular_momentum_{axis}")];
            momenta.iter().for_each(|&momentum| close(momentum, 16.0 / 3.0 * spin, 1e-12));
        }
        let energy = &history["total_energy"];
        energy.iter().for_each(|&own| close(own, energy[0], 1e-12));
    }
}

/// Nutation by elliptic functions, precession by quadrature. Degree 3 with steps of 0.02 has an error of 1.2e-7.
#[test]
fn heavy_top() {
    let (_, history) = run("heavy-top");
    let exact = [0.5095952148872175, -0.24667568140632803, 0.8242959572670331];
    for (axis, exact) in ["x", "y", "z"].into_iter().zip(exact) {
        let x = last(&history[&format!("centre_{axis}")]);
        assert!((x - exact).abs() < 2e-7, "{axis}: {x} is not {exact}");
    }
    // Gravity has no moment about the vertical, and the tip is on it.
    let momenta = &history["angular_momentum_z"];
    momenta.iter().for_each(|&momentum| close(momentum, 8.253356149096783, 1e-12));
}

/// The slider of a rigid rod is where the angle of the crank tells; the bending of a flexible one falls with its
/// stiffness. The drive does the work of the energy.
#[test]
fn slider_crank() {
    let exact = |t: f64| {
        let angle = t * t;
        -1.0 + angle.cos() + (16.0 - angle.sin().powi(2)).sqrt()
    };
    let mut bent = Vec::new();
    for stiffness in [1.0, 100.0, 10_000.0] {
        let place = Place::new();
        place.succeed(&["new", "slider-crank"]);
        let set = |name: &str, value: f64| format!("region.material.neo-hooke.{name}={}", value * stiffness);
        let [lambda, mu] = [set("lambda", 4000.0), set("mu", 2000.0)];
        place.succeed(&["run", "slider-crank.toml", "--quiet", "--set", &lambda, "--set", &mu]);
        let history = place.history("slider-crank");
        let places = history["time"].iter().zip(&history["slider_x"]);
        bent.push(places.map(|(&t, x)| (x - exact(t)).abs()).fold(0.0, f64::max));
        for name in ["slider_y", "slider_z"] {
            history[name].iter().for_each(|y| assert!((y - 0.25).abs() < 1e-14, "{name}: {y}"));
        }
        for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
            assert!((energy - work).abs() < 1e-11, "{energy} {work}");
        }
    }
    close(bent[0], 0.120, 0.01);
    close(bent[1], 5.55e-4, 0.01);
    close(bent[2], 5.53e-6, 0.01);
}

/// Exact solution of the parallel motion; the couplers do not turn.
#[test]
fn four_bar() {
    let (_, history) = run("four-bar");
    let exact = [0.5 + 0.05781579576790679, 0.9983272678634615, 0.0];
    for (axis, exact) in ["x", "y", "z"].into_iter().zip(exact) {
        let x = last(&history[&format!("middle_{axis}")]);
        // Degree 2 with steps of 0.02 has an error of 3.5e-7.
        assert!((x - exact).abs() < 5e-7, "{axis}: {x} is not {exact}");
    }
    // Kinetic energy at the start; gravity has done the rest.
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work - 1.5).abs() < 1e-10, "{energy} {work}");
    }
}

/// The angle of a rigid door obeys J a'' + 30 a' + 20 a = 0; that of the flexible one approaches it with its stiffness.
#[test]
fn door() {
    let inertia = 36.0 * (0.9f64.powi(2) / 3.0 + 0.04f64.powi(2) / 12.0);
    let root = (30f64.powi(2) - 4.0 * inertia * 20.0).sqrt();
    let [slow, fast] = [root, -root].map(|root| (root - 30.0) / (2.0 * inertia));
    let rigid = |t: f64| 4.0 * ((slow * t).exp() - (fast * t).exp()) / (slow - fast);
    let run = |sets: &[&str]| {
        let place = Place::new();
        place.succeed(&["new", "door"]);
        place.succeed(&[&["run", "door.toml", "--quiet"], sets].concat());
        let history = place.history("door");
        // The closer takes the energy of the push, J 4^2 / 2.
        let kept = history["total_energy"].iter().zip(&history["dissipated_energy"]);
        for ((energy, dissipated), work) in kept.zip(&history["external_work"]) {
            let change = energy + dissipated - work - 8.0 * inertia;
            assert!(change.abs() < 1e-11, "{energy} {dissipated} {work}");
        }
        let residual = place.summary("door")["worst_angular_momentum_residual"].as_f64().unwrap();
        assert!(residual < 1e-11, "{residual:e}");
        history
    };
    let bent = |history: &std::collections::BTreeMap<String, Vec<f64>>| {
        let angles = history["time"].iter().zip(&history["hinge_angle"]);
        angles.map(|(&t, angle)| (angle - rigid(t)).abs()).fold(0.0, f64::max)
    };
    let flexible = run(&[]);
    close(bent(&flexible), 2.383e-2, 0.01);
    close(bent(&run(&["--set", "region.material.neo-hooke.youngs_modulus=1e10"])), 1.565e-4, 0.02);
    // `examples.py`.
    let row = flexible["time"].iter().position(|t| (t - 0.5).abs() < 1e-9).unwrap();
    for (name, expected) in
        [("hinge_angle", 0.94079), ("handle_x", 0.54111), ("handle_y", 0.73949), ("handle_z", 0.99999)]
    {
        let own = flexible[name][row];
        assert!((own - expected).abs() < 4e-4, "{name}: {own} is not {expected}");
    }
}

/// Results of an independent implementation of joints and of the DGM, at t = 2.5.
#[test]
fn satellite() {
    let place = Place::new();
    let file = format!("{}/../../examples/satellite.toml", env!("CARGO_MANIFEST_DIR"));
    // One cell of 1 along y, and one of 0.4 along z.
    let check = place.succeed(&["check", &file]).stdout;
    assert!(check.contains("about 1 cell (hex8) over its thickness along z"), "{check}");
    place.succeed(&["run", &file, "--quiet", "--output", "satellite", "--set", "newton.tolerance=1e-13"]);
    let history = place.history("satellite");
    for (angle, sign) in [("right-hinge_angle", 1.0), ("left-hinge_angle", -1.0)] {
        close(last(&history[angle]), sign * std::f64::consts::FRAC_PI_2, 1e-12);
    }
    place.succeed(&["resume", "satellite", "--quiet", "--until", "2.5"]);
    let history = place.history("satellite");
    for (name, expected) in [
        ("kinetic_energy", 3.364297573555207),
        ("strain_energy", 0.3566908721616583),
        ("external_work", 3.1301684457168566),
        ("hub_x", 0.02977523032919386),
        ("hub_y", -0.02249442516014223),
        ("hub_z", 0.28678215451443423),
        ("right-tip_x", -0.6879543607243477),
        ("right-tip_y", -0.25529733088673334),
        ("right-tip_z", -2.4285602485801836),
        ("left-tip_x", -0.5882343525377194),
        ("left-tip_y", -0.2411735258295048),
        ("left-tip_z", -2.4557980016198595),
    ] {
        let own = last(&history[name]);
        assert!((own - expected).abs() < 1e-8, "{name}: {own} is not {expected}");
    }
    // Of hub and panels, which spin about the origin: 0.1 (1.2 + 0.164) and 0.4 (1.5 + 5.8). The centres of the panels
    // lie 0.2 above it.
    for (name, expected) in
        [("linear_momentum_y", -0.024), ("angular_momentum_x", 0.1364), ("angular_momentum_z", 2.92)]
    {
        history[name].iter().for_each(|&momentum| close(momentum, expected, 1e-10));
    }
    let energy = &history["total_energy"];
    for (own, work) in energy.iter().zip(&history["external_work"]) {
        assert!((own - energy[0] - work).abs() < 1e-12, "{own} {work}");
    }
}

/// Digits of the benchmark, by an integration in independent coordinates. Half the step has a sixteenth of the error.
#[test]
fn bricard() {
    let exact = [
        (1.0, [0.510501461188, -1.649167599395, 0.140123114553]),
        (2.0, [-0.969340344777, -1.221246894957, 0.754278010778]),
    ];
    let mut errors = Vec::new();
    for sets in [&[][..], &["--set", "time.steps.0.size=0.025"][..]] {
        let place = Place::new();
        place.succeed(&["new", "bricard"]);
        let check = place.succeed(&["check", "bricard.toml"]).stdout;
        assert!(check.contains("it is a constraint of the joint hinge-6\n"), "{check}");
        place.succeed(&[&["run", "bricard.toml", "--quiet"], sets].concat());
        let history = place.history("bricard");
        for (time, exact) in exact {
            let row = history["time"].iter().position(|t| (t - time).abs() < 1e-9).unwrap();
            let centre = |rod: usize, axis: &str| history[&format!("rod-{rod}_{axis}")][row];
            // Twice the centre of a rod is the sum of its ends; the first rod begins at the origin, the third one ends
            // here.
            let end = ["x", "y", "z"].map(|axis| 2.0 * (centre(1, axis) - centre(2, axis) + centre(3, axis)));
            let squares = end.iter().zip(exact).map(|(own, exact)| (own - exact).powi(2));
            errors.push(squares.sum::<f64>().sqrt());
        }
        for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
            assert!((energy - work).abs() < 1e-12, "{energy} {work}");
        }
        let drift = place.summary("bricard")["worst_constraint_residual"].as_f64().unwrap();
        assert!(drift < 1e-14, "{drift:e}");
    }
    for (error, expected) in errors.into_iter().zip([5.182e-7, 1.2868e-6, 3.245e-8, 8.054e-8]) {
        close(error, expected, 0.01);
    }
}

/// `examples.py`. The error is of order four.
#[test]
fn pendulum_chain() {
    for (sets, error) in [(&[][..], 1.1945e-5), (&["--set", "time.steps.0.size=0.02"][..], 1.772e-4)] {
        let place = Place::new();
        place.succeed(&["new", "pendulum-chain"]);
        place.succeed(&[&["run", "pendulum-chain.toml", "--quiet"], sets].concat());
        let history = place.history("pendulum-chain");
        let [x, y, z] = ["x", "y", "z"].map(|axis| last(&history[&format!("ball_{axis}")]));
        close((x + 1.549508625547).hypot(z + 1.236699062064), error, 0.02);
        assert!(y.abs() < 1e-14, "{y:e}");
        // From rest: gravity does the work of all energy.
        for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
            assert!((energy - work).abs() < 1e-12, "{energy} {work}");
        }
    }
}

#[test]
fn two_materials() {
    let (place, history) = run_in_place("two-materials");
    // From rest: the energy is the work of the load, in every step and after it has gone.
    let largest = place.summary("two-materials")["largest_energy"].as_f64().unwrap();
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work).abs() < 1e-12 * largest, "{energy} {work}");
    }
    // `examples.py`.
    close(last(&history["total_energy"]), 1.45924, 5e-3);
    close(last(&history["tip_z"]) - 1.0, 0.32843, 5e-3);
    assert!(
        (last(&history["tip_x"]) - 11.96427).abs() < 1e-3 && (last(&history["tip_y"]) - 2.0).abs() < 1e-6
    );
}

#[test]
fn bracket() {
    let (place, history) = run_in_place("bracket");
    let largest = place.summary("bracket")["largest_energy"].as_f64().unwrap();
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work).abs() < 1e-10 * largest, "{energy} {work}");
    }
    // The upright alone, 30 mm wide and 4 mm thick, would be a clamped strip. By Euler and Bernoulli, its period is tau
    // L^2 / (1.8751^2 t c / sqrt(12)), c^2 = E / rho. The base between bolts and bend deforms as well, and is about
    // half as long.
    let c = (7.0e4f64 / 2.7e-9).sqrt();
    let strip =
        |length: f64| std::f64::consts::TAU * length * length / (1.8751f64.powi(2) * 4.0 * c / 12f64.sqrt());
    let (time, tip) = (&history["time"], &history["tip_x"]);
    let back: Vec<f64> =
        (1..tip.len()).filter(|&i| tip[i - 1] < 0.0 && tip[i] >= 0.0).map(|i| time[i]).collect();
    let period = (back[back.len() - 1] - back[0]) / (back.len() - 1) as f64;
    assert!(period > strip(50.0) && period < strip(50.0 + 28.0), "{period} {} {}", strip(50.0), strip(78.0));
}

#[test]
fn steel_bracket() {
    let (place, history) = run_in_place("steel-bracket");
    let time = &history["time"];
    let tip = &history["tip_displacement_z"];
    let summary = place.summary("steel-bracket");
    let largest = summary["largest_energy"].as_f64().unwrap();
    for (energy, work) in history["total_energy"].iter().zip(&history["external_work"]) {
        assert!((energy - work).abs() < 1e-10 * largest, "{energy} {work}");
    }
    // `examples.py`: the linear equations, for a deflection of 1 % of the length.
    let [mut low, mut high] = [0; 2];
    for i in 0..tip.len() {
        low = if tip[i] < tip[low] { i } else { low };
        high = if tip[i] > tip[high] { i } else { high };
    }
    close(tip[low], -0.6705, 0.025);
    close(tip[high], 0.6552, 0.025);
    assert!((time[low] - 4.761e-3).abs() <= 5e-5 && (time[high] - 3.783e-3).abs() <= 5e-5);
    // The impulses of the record and of the foot are the momentum at the end.
    let record: Vec<[f64; 2]> = include_str!("../../../../examples/pulse.csv")
        .lines()
        .filter(|line| line.starts_with('0'))
        .map(|line| {
            let (t, force) = line.split_once(',').unwrap();
            [t.parse().unwrap(), force.parse().unwrap()]
        })
        .collect();
    let pulse: f64 = record.windows(2).map(|w| 0.5 * (w[1][0] - w[0][0]) * (w[0][1] + w[1][1])).sum();
    let steps = history["step_size"].iter().zip(&history["foot_force_z"]).skip(1);
    let reaction: f64 = steps.map(|(h, force)| h * force).sum();
    let momentum = history["linear_momentum_z"].last().unwrap();
    assert!((momentum - (reaction - pulse)).abs() < 1e-12 * pulse, "{momentum} {reaction} {pulse}");
    let stress = history["max_von_mises_stress"].iter().copied().fold(0.0, f64::max);
    assert_eq!(summary["largest_von_mises_stress"].as_f64(), Some(stress));
    let input = format!("{}/../../examples/steel-bracket.toml", env!("CARGO_MANIFEST_DIR"));
    place.succeed(&["modes", &input, "--count", "3", "--quiet", "--output", "modes"]);
    let modes = place.read("modes/modes.csv");
    for (row, frequency) in modes.lines().skip(1).zip([524.59, 915.29, 1478.81]) {
        close(row.split(',').nth(2).unwrap().parse().unwrap(), frequency, 1e-5);
    }
}

/// Flapping and lagging frequencies of a clamped blade: 5.585 and, 2.5 times as stiff, sqrt(3.925^2 - 1.6^2) at the
/// speeds 4 and 1.6, in units of sqrt(E I/(rho A L^4)) (Wright and others 1982); `tan(b L)/b - L` of stretch.
#[test]
fn rotor_blade() {
    let (place, history) = run("rotor-blade");
    let unit = (7e10f64 * 0.02 * 0.02 / (12.0 * 2700.0)).sqrt();
    close(117.6 / unit, 4.0, 1e-3);
    let b = 117.6 * (2700.0 / 7e10f64).sqrt();
    // The root does not get thinner, which stiffens it.
    close(last(&history["tip_x"]) - 1.0, b.tan() / b - 1.0, 0.02);
    let output = place.succeed(&["modes", "rotor-blade.toml", "--count", "4"]);
    assert!(output.stderr.contains("the observer sees, who turns with 117.6 1/s"), "{}", output.stderr);
    let modes = place.read("rotor-blade-modes/modes.csv");
    let rows: Vec<Vec<f64>> =
        modes.lines().skip(1).map(|row| row.split(',').map(|text| text.parse().unwrap()).collect()).collect();
    close(rows[0][1], 5.585 * unit, 5e-3);
    close(rows[1][1], (3.925f64.powi(2) - 1.6 * 1.6).sqrt() * 2.5 * unit, 0.01);
    // Modes of bending lack the axial motion that the Coriolis force adds, at most 2 Omega/omega_axial.
    let axial = 0.5 * std::f64::consts::PI * (7e10f64 / 2700.0).sqrt();
    assert!(rows.iter().all(|row| row[7] < 2.02 * 117.6 / axial), "{modes}");
    // A sweep over the speed has the same numbers.
    let speeds = "load.rotation.speed=58.8,117.6";
    place.succeed(&["sweep", "rotor-blade.toml", "--modes", "4", "--set", speeds, "--quiet"]);
    let table = place.read("rotor-blade-sweep/sweep.csv");
    let lines: Vec<Vec<&str>> = table.lines().map(|line| line.split(',').collect()).collect();
    let column = lines[0].iter().position(|name| *name == "frequency_1").unwrap();
    let [slow, fast] = [1, 2].map(|row| lines[row][column].parse::<f64>().unwrap());
    close(fast, rows[0][2], 1e-12);
    close(slow, 4.1373 * unit / std::f64::consts::TAU, 5e-3);
}

/// The reactions at rest are those of FElupe (`rubber.py`: `ThreeFieldVariation` of `NeoHooke(0.5, 1000)`) with the
/// same cells.
#[test]
fn rubber_mount() {
    let (place, history) = run("rubber-mount");
    let force = |history: &std::collections::BTreeMap<String, Vec<f64>>| history["z-max_force_z"][0];
    close(force(&history), -800.099397, 1e-8);
    let (energy, work) = (&history["total_energy"], &history["external_work"]);
    for (energy_now, work) in energy.iter().zip(work) {
        assert!((energy_now - energy[0] - work).abs() < 1e-11 * energy[0], "{energy_now} {work}");
    }
    // Sheared by 8 mm at t = 0.01, and back.
    assert!(history["z-max_force_x"][5] > 200.0 && last(&history["z-max_force_x"]).abs() < 50.0);
    let flags =
        ["--set", "region.0.formulation=standard", "--until", "2e-3", "--output", "locked", "--quiet"];
    place.succeed(&[&["run", "rubber-mount.toml"], &flags[..]].concat());
    close(force(&place.history("locked")), -19_156.391, 1e-8);
}

/// Deflections of the beam before it is let go. Those of hex8 are FElupe's (`rubber.py`) with the same cells; others
/// are compared with 2160 of its hex8 (six over the thickness), whose error is below 3 %.
#[test]
fn rubber_beam() {
    let place = Place::new();
    place.succeed(&["new", "rubber-beam"]);
    let meshes = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/meshes");
    let deflection = |formulation: &str, mesh: Option<&str>| {
        let formulation = format!("region.0.formulation={formulation}");
        let mesh = mesh.map(|name| format!("mesh={{ file = '{meshes}/rubber-beam-{name}.msh' }}"));
        let mut flags = vec!["run", "rubber-beam.toml", "--quiet", "--until", "0.01", "--set", &formulation];
        mesh.iter().for_each(|mesh| flags.extend(["--set", mesh]));
        place.succeed(&flags);
        place.history("rubber-beam")["tip_z"][0] - 10.0
    };
    close(deflection("standard", None), 0.0805979, 1e-5);
    close(deflection("projected-volume", None), 1.3906555, 1e-6);
    // NumPy at small strain (`rubber.py`).
    close(deflection("incompatible-modes", None), 0.777304, 1e-3);
    let fine = 0.980058;
    close(deflection("projected-volume", Some("hex27")), fine, 0.03);
    close(deflection("projected-volume", Some("hex20")), fine, 0.03);
    assert!(deflection("standard", Some("hex20")) < 0.85 * fine);
}

/// Displacements by a small force at the mean of the wall, rigid and with equal weights, and modes of the rigid one, of
/// CalculiX 2.20 (C3D10, `*RIGID BODY`, `*DISTRIBUTING COUPLING`) on the same mesh.
#[test]
fn bolted_bracket() {
    let (place, history) = run_in_place("bolted-bracket");
    // The middle of the hole, not of its nodes.
    let u = [last(&history["axis_x"]) - 2.0, last(&history["axis_z"]) - 40.0];
    close(u[0], -1.543, 0.02);
    let file = format!("{}/../../examples/bolted-bracket.toml", env!("CARGO_MANIFEST_DIR"));
    let mean = "[1.9945602594, 14.9999541695, 40.0000771269]";
    let weights = format!("coupling.weights=[{}]", ["1"; 70].join(","));
    for (kind, x, z) in [("rigid", -1.533365e-3, -3.328408e-4), ("distributing", -1.543258e-3, -3.327208e-4)]
    {
        let sets = [
            format!("coupling.kind={kind}"),
            format!("coupling.point={mean}"),
            format!("output.probes=[{{ name = 'axis', point = {mean}, quantities = ['displacement'] }}]"),
            "load.force=[-0.4, 0, 0.1]".to_string(),
        ];
        let mut flags = vec!["run", &file, "--quiet", "--output", kind];
        sets.iter().for_each(|set| flags.extend(["--set", set]));
        if kind == "distributing" {
            flags.extend(["--set", &weights]);
        }
        place.succeed(&flags);
        let history = place.history(kind);
        close(last(&history["axis_displacement_x"]), x, 1e-4);
        close(last(&history["axis_displacement_z"]), z, 2e-4);
        if kind == "rigid" {
            flags[0] = "modes";
            flags[4] = "modes";
            flags.extend(["--count", "4"]);
            place.succeed(&flags);
            let modes = place.read("modes/modes.csv");
            for (row, frequency) in modes.lines().skip(1).zip([881.1405, 1521.621, 3064.760, 4899.235]) {
                close(row.split(',').nth(2).unwrap().parse().unwrap(), frequency, 1e-4);
            }
        }
    }
}

/// CalculiX 2.20 with the same job (C3D20R, `*RIGID BODY` with six masses that have the engine's inertia): it sinks by
/// 0.3480 mm and moves by 0.0917 mm under 0.5 N to the side on the finest mesh; frequencies without the weight. Under
/// the weight it leaves out that the engine stands above the mount like an inverted pendulum.
#[test]
fn engine_mount() {
    let (place, history) = run("engine-mount");
    let energy = &history["total_energy"];
    let largest = place.summary("engine-mount")["largest_energy"].as_f64().unwrap();
    for (now, work) in energy.iter().zip(&history["external_work"]) {
        assert!((now - energy[0] - work).abs() < 1e-10 * largest, "{now} {work}");
    }
    let fine =
        ["--quiet", "--set", "mesh.box.cells=[8, 8, 6]", "--set", "support.0.fix=[\"x\", \"y\", \"z\"]"];
    let input = place.read("engine-mount.toml");
    let held = input.lines().filter(|line| !line.starts_with("move"));
    let held = held.collect::<Vec<_>>().join("\n").replace("0, 0, -9810", "20.8, 0, -9810");
    place.write("held.toml", &held);
    place.succeed(&[&["run", "held.toml", "--until", "5e-3", "--output", "held"], &fine[..]].concat());
    let start = place.history("held");
    // 20.8 mm/s^2 of its mass to the side are a quarter of a newton.
    close(80.0 - start["engine_z"][0], 0.3480, 0.01);
    close(2.0 * (start["engine_x"][0] - 20.0), 0.0917, 0.02);
    place.write("light.toml", &held.replace("20.8, 0, -9810", "0, 0, -1e-3"));
    place.succeed(&[&["modes", "light.toml", "--count", "6", "--output", "modes"], &fine[..]].concat());
    let modes = place.read("modes/modes.csv");
    let frequencies = [3.147418, 3.147418, 3.718414, 19.76812, 19.76812, 26.54522];
    for (row, frequency) in modes.lines().skip(1).zip(frequencies) {
        close(row.split(',').nth(2).unwrap().parse().unwrap(), frequency, 0.01);
    }
}

/// A thousandth of the shock is a linear one: that of an oscillator with the frequency and the damping of its mode.
#[test]
fn shock_mount() {
    let (place, history) = run("shock-mount");
    let summary = place.summary("shock-mount");
    let largest = summary["largest_energy"].as_f64().unwrap();
    let balance = history["energy_residual"].iter().fold(0f64, |worst, own| worst.max(own.abs()));
    assert!(balance < 1e-12 * largest, "{balance}");
    place.write("weak.toml", &place.read("shock-mount.toml").replace("294200*", "294.2*"));
    place.succeed(&["run", "weak.toml", "--quiet", "--output", "weak"]);
    place.succeed(&["modes", "shock-mount.toml", "--count", "6", "--output", "modes", "--quiet"]);
    let modes = place.read("modes/modes.csv");
    let omega: f64 = modes.lines().last().unwrap().split(',').nth(1).unwrap().parse().unwrap();
    // Relative to the base, at its own frequency: 1/(4e-4 omega).
    let frequency = omega / std::f64::consts::TAU;
    let flags = ["--base", "z", "--quantity", "acceleration", "--output", "response", "--quiet"];
    let range = format!("{frequency}:{}:2", 2.0 * frequency);
    place.succeed(&[&["response", "shock-mount.toml", "--frequencies", &range][..], &flags].concat());
    let response = place.read("response/response.csv");
    let rows: Vec<Vec<&str>> = response.lines().map(|line| line.split(',').collect()).collect();
    let amplitude = |name: &str| -> f64 {
        rows[1][rows[0].iter().position(|own| *own == name).unwrap()].parse().unwrap()
    };
    close(amplitude("stroke_z_amplitude"), 1.0 / (4e-4 * omega), 0.01);
    close(amplitude("plate_z_amplitude"), 1f64.hypot(1.0 / (4e-4 * omega)), 0.01);
    let report = place.succeed(&["check", "shock-mount.toml"]).stdout;
    assert!(report.contains("makes 8 steps in the shortest part of a load, which lasts 0.011 s"), "{report}");
    // z'' + c z' + omega^2 z = -a, c = 4e-4 omega^2, in steps of the classic method of order four.
    let (h, mut z, mut v) = (1e-6, 0.0, 0.0);
    let (mut stroke, mut felt) = (0f64, 0f64);
    let rate = |t: f64, z: f64, v: f64| {
        let a = if t < 0.011 { 294.2 * (std::f64::consts::PI * t / 0.011).sin() } else { 0.0 };
        -a - omega * omega * (z + 4e-4 * v)
    };
    for i in 0..50_000 {
        let t = h * f64::from(i);
        let a = rate(t, z, v);
        let b = rate(t + h / 2.0, z + h / 2.0 * v, v + h / 2.0 * a);
        let c = rate(t + h / 2.0, z + h / 2.0 * v + h * h / 4.0 * a, v + h / 2.0 * b);
        let d = rate(t + h, z + h * v + h * h / 2.0 * b, v + h * c);
        z += h * v + h * h / 6.0 * (a + b + c);
        v += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        (stroke, felt) = (stroke.max(z.abs()), felt.max((omega * omega * (z + 4e-4 * v)).abs()));
    }
    let weak = place.history("weak");
    let peak = |name: &str| weak[name].iter().fold(0f64, |peak, own| peak.max(own.abs()));
    close(peak("stroke_displacement_z"), stroke, 0.01);
    // The device moves with its plate, and is seen from the base, too.
    let device = weak["device_z"].iter().fold(0f64, |peak, own| peak.max((own - 50.0).abs()));
    close(device, peak("stroke_displacement_z"), 1e-9);
    close(peak("plate_acceleration_z"), felt, 0.01);
}

/// The exact answer of a bar that strikes a wall: it pushes with rho c v A for 2 L/c and rebounds with v.
#[test]
fn bar_on_a_wall() {
    let place = Place::new();
    let file = format!("{}/../../examples/bar-on-a-wall.toml", env!("CARGO_MANIFEST_DIR"));
    place.succeed(&["run", &file, "--quiet", "--output", "bar"]);
    let history = place.history("bar");
    let (times, forces) = (&history["time"], &history["wall_force_z"]);
    let (force, duration) = (1270.827, 3.8545e-4);
    let touches: Vec<f64> = (1..times.len()).filter(|i| forces[*i] > 0.5 * force).map(|i| times[i]).collect();
    let (first, n) = (touches[0], touches.len() as f64);
    assert!((first - 5e-4).abs() < 0.03 * duration, "{first}");
    assert!((n * 1.25e-6 / duration - 1.0).abs() < 0.02, "{n}");
    let plateau: Vec<f64> =
        (1..times.len()).filter(|i| (5.5e-4..8.35e-4).contains(&times[*i])).map(|i| forces[i]).collect();
    let mean = plateau.iter().sum::<f64>() / plateau.len() as f64;
    assert!((mean / force - 1.0).abs() < 0.01, "{mean}");
    let rebound = last(&history["linear_momentum_z"]) / (7800.0 * 3.14e-4);
    assert!((rebound / 0.1 - 1.0).abs() < 0.01, "{rebound}");
    // The impulse of the wall is the change of the momentum, and no energy is lost.
    let impulse = forces[1..].iter().sum::<f64>() * 1.25e-6 / (7800.0 * 3.14e-4);
    assert!((impulse - rebound - 0.1).abs() < 1e-12, "{impulse}");
    let energy = &history["total_energy"];
    assert!((last(energy) / energy[0] - 1.0).abs() < 1e-11);
    assert!(history["smallest_gap"].iter().all(|gap| *gap > 0.0 || gap.is_nan()));
    // The summary has the same force, and the times of the theory; the layer touches a little earlier and longer.
    let summary = place.summary("bar");
    let wall = &summary["contacts"][0];
    let number = |name: &str| wall[name].as_f64().unwrap();
    let largest = forces[1..].iter().copied().fold(0.0, f64::max);
    assert!(wall["name"] == "wall" && number("largest_force") == largest && largest < 1.2 * force, "{wall}");
    assert!((number("first_time") - 5e-4).abs() < 0.1 * duration, "{wall}");
    assert!((number("duration") / duration - 1.0).abs() < 0.2, "{wall}");
    assert!((number("last_time") - number("first_time") - number("duration")).abs() < 1e-12, "{wall}");
}

/// A ball that bounces loses no energy, and little of its velocity to vibration; the impulse of the floor is the change
/// of its momentum.
#[test]
fn bouncing_ball() {
    let (_, history) = run("bouncing-ball");
    let energy = &history["total_energy"];
    assert!(energy.iter().all(|own| (own / energy[0] - 1.0).abs() < 1e-11));
    let momentum = &history["linear_momentum_z"];
    assert!((0.97..1.0).contains(&(last(momentum) / -momentum[0])), "{}", last(momentum));
    let forces = &history["floor_force_z"][1..];
    let impulse = forces.iter().sum::<f64>() * 4e-5;
    assert!((impulse - last(momentum) + momentum[0]).abs() < 1e-12);
    // Hertz' theory for small approaches, of a ball with the mass of the mesh: this one is stiffer.
    let (mass, modulus, radius) = (-momentum[0], 1e6 / 0.91, 0.02f64);
    let approach = (15.0 * mass / (16.0 * modulus * radius.sqrt())).powf(0.4);
    let duration = forces.iter().filter(|force| **force > 0.0).count() as f64 * 4e-5;
    assert!((0.85..1.0).contains(&(duration / (2.9432752 * approach))), "{duration}");
    assert!(history["smallest_gap"].iter().all(|gap| *gap > 0.0 || gap.is_nan()));
}

/// The last block leaves with the velocity of the first one, as in an elastic exchange.
#[test]
fn newtons_cradle() {
    let (_, history) = run("newtons-cradle");
    for (block, velocity) in [("first", 0.0), ("fourth", 0.0), ("fifth", 0.01)] {
        let own = last(&history[&format!("{block}_x")]);
        assert!((own - velocity).abs() < 0.005 * 0.01, "{block}: {own}");
    }
    let energy = &history["total_energy"];
    assert!(energy.iter().all(|own| (own / energy[0] - 1.0).abs() < 1e-10));
    assert!(history["linear_momentum_x"].iter().all(|own| (own - 0.01).abs() < 1e-15));
}

/// The numbers of another implementation of the same two blocks.
#[test]
fn two_blocks() {
    let (place, history) = run("two-blocks");
    let total = last(&history["total_energy"]);
    assert!((last(&history["kinetic_energy"]) - 0.995_463_405_612_130_2).abs() < 1e-7 * total);
    assert!((last(&history["strain_energy"]) - 0.131_219_927_720_912_3).abs() < 1e-7 * total);
    for (axis, expected) in [("x", 0.195), ("y", 0.052), ("z", -0.347)] {
        let own = &history[&format!("angular_momentum_{axis}")];
        assert!(own.iter().all(|own| (own - expected).abs() < 1e-11));
    }
    let summary = place.summary("two-blocks");
    assert!((summary["smallest_gap"].as_f64().unwrap() - 0.032_798_664_072_127_656 / 0.05).abs() < 1e-7);
    // The lower block, at rest along y afterwards, is pushed down by the upper one.
    let impulse = history["impact_force_y"][1..].iter().sum::<f64>() * 0.01;
    assert!((impulse - (-0.735_055_014_960_954_3 - 1.0)).abs() < 1e-7, "{impulse}");
}

/// The force on a block that is compressed uniformly is mu A (1/stretch^2 - stretch).
#[test]
fn rubber_bumper() {
    let (_, history) = run("rubber-bumper");
    let stretch = 1.0 + (last(&history["top_z"]) - last(&history["bottom_z"])) / 10.0;
    close(stretch, 0.8, 1e-3);
    close(last(&history["floor_force_z"]), 76.25, 1e-8);
    close(last(&history["top_force_z"]), -76.25, 1e-8);
}
