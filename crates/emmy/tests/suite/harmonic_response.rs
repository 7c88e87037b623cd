//! Harmonic response by modes against closed forms.

use std::f64::consts::{PI, TAU};

use emmy::Error;
use emmy::body::{Body, FieldName, Fields, Load, PointTerms, Region, Support, Viscosity};
use emmy::material::{Link, NeoHooke};
use emmy::mesh::{self, CellKind};
use emmy::modes::{Excitation, HarmonicResponse, ModalDamping, Quantity, n_modes};
use emmy::motion::State;

use crate::shared::bricks::brick;
use crate::shared::points::{masses, network};

const STIFFNESS: f64 = 18.0;

/// A mass 0.5 on a spring of stiffness 18 along x, omega = 6, and a force of 3 on it.
fn oscillator(time: f64, drag: f64) -> Body {
    let viscosity = Viscosity { time, ..Viscosity::default() };
    let region = Region::links(Link::spring(STIFFNESS, None).unwrap(), 0.0).with_viscosity(viscosity);
    let mesh = network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]]);
    let masses = PointTerms { masses: masses(&[2.0, 0.5]), ..PointTerms::default() };
    Body::builder(mesh)
        .region(region)
        .point_terms(masses)
        .support(Support::fixed("0"))
        .support(Support::of_components("1", [false, true, true]))
        .load(Load::nodal_force("1", [3.0, 0.0, 0.0]))
        .drag(drag)
        .build()
        .unwrap()
}

fn response(body: &Body, damping: &ModalDamping, excitation: &Excitation) -> HarmonicResponse {
    HarmonicResponse::new(body, None, 1, damping, excitation).unwrap()
}

fn close(found: [f64; 2], expected: [f64; 2], relative: f64) {
    let error = (found[0] - expected[0]).hypot(found[1] - expected[1]);
    assert!(error < relative * expected[0].hypot(expected[1]), "{found:?} is not {expected:?}");
}

/// 1/(re + i im).
fn inverse([re, im]: [f64; 2]) -> [f64; 2] {
    let square = re * re + im * im;
    [re / square, -im / square]
}

/// u = F/(k - m omega^2 + i c omega) with c = 2 zeta sqrt(k m); velocity and acceleration by i omega.
#[test]
fn a_mass_on_a_spring_responds_in_closed_form() {
    let body = oscillator(0.0, 0.0);
    let damped = ModalDamping::Ratios(vec![0.05]);
    let found = response(&body, &damped, &Excitation::Loads(vec![0]));
    assert!((found.modal_forces()[0].abs() - 3.0 / 0.5f64.sqrt()).abs() < 1e-12);
    for omega in [0.1, 5.0, 6.0, 7.0, 60.0] {
        let c = 2.0 * 0.05 * (STIFFNESS * 0.5f64).sqrt();
        let u = inverse([STIFFNESS - 0.5 * omega * omega, c * omega]).map(|x| 3.0 * x);
        close(found.relative(omega, 1, Quantity::Displacement)[0], u, 1e-12);
        close(found.relative(omega, 1, Quantity::Velocity)[0], [-omega * u[1], omega * u[0]], 1e-12);
        close(found.absolute(omega, 1, Quantity::Acceleration)[0], u.map(|x| -omega * omega * x), 1e-12);
        assert_eq!(found.relative(omega, 1, Quantity::Displacement)[1..], [[0.0; 2]; 2]);
        assert_eq!(found.relative(omega, 0, Quantity::Displacement), [[0.0; 2]; 3]);
    }
}

/// Absolute over base acceleration (1 + 2 i zeta r)/(1 - r^2 + 2 i zeta r) with r = omega/omega_0; relative
/// displacement -a/(omega_0^2 - omega^2 + 2 i zeta omega_0 omega).
#[test]
fn a_shaking_base_is_transmitted_in_closed_form() {
    let body = oscillator(0.0, 0.0);
    let damped = ModalDamping::Ratios(vec![0.1, 7.0]);
    let found = response(&body, &damped, &Excitation::Base([2.0, 0.0, 0.0]));
    for omega in [0.5, 6.0, 6.0 * 2f64.sqrt(), 30.0] {
        let r = omega / 6.0;
        let [re, im] = inverse([1.0 - r * r, 0.2 * r]);
        let expected = [2.0 * (re - 0.2 * r * im), 2.0 * (im + 0.2 * r * re)];
        close(found.absolute(omega, 1, Quantity::Acceleration)[0], expected, 1e-12);
        close(
            found.relative(omega, 1, Quantity::Displacement)[0],
            [-2.0 * re / 36.0, -2.0 * im / 36.0],
            1e-12,
        );
        // The support moves with the base: -a/omega^2.
        close(found.absolute(omega, 0, Quantity::Displacement)[0], [-2.0 / (omega * omega), 0.0], 1e-12);
        close(found.absolute(omega, 0, Quantity::Velocity)[0], [0.0, -2.0 / omega], 1e-12);
    }
}

/// The damping ratio of t_v is t_v omega/2, that of drag r/(2 omega).
#[test]
fn viscosity_and_drag_of_the_body_damp_its_modes() {
    for (time, drag, expected) in [(0.01, 0.0, 0.03), (0.0, 0.6, 0.05), (0.01, 0.6, 0.08), (0.0, 0.0, 0.0)] {
        let found = response(&oscillator(time, drag), &ModalDamping::OfBody, &Excitation::Loads(vec![0]));
        let ratio = found.damping_ratios()[0];
        assert!((ratio - expected).abs() < 1e-9, "{ratio} {expected}");
    }
    // In a solid, too: each mode has its own ratio.
    let viscosity = Viscosity { time: 1e-3, ..Viscosity::default() };
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0).with_viscosity(viscosity);
    let body = Body::builder(mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap())
        .region(rubber)
        .support(Support::fixed("z-min"))
        .build()
        .unwrap();
    let excitation = Excitation::Base([1.0, 0.0, 0.0]);
    let found = HarmonicResponse::new(&body, None, 8, &ModalDamping::OfBody, &excitation).unwrap();
    for (mode, ratio) in found.modes().iter().zip(found.damping_ratios()) {
        let expected = 0.5e-3 * mode.angular_frequency;
        assert!((ratio / expected - 1.0).abs() < 1e-7, "{ratio} {expected}");
    }
}

/// A bar of length L held at one end, without Poisson's effect: density 2, E = 50, c = 5.
fn bar() -> Body {
    Body::builder(mesh::block([6.0, 1.0, 1.0], [48, 1, 1]).unwrap())
        .region(Region::new(NeoHooke::from_engineering(50.0, 0.0).unwrap(), 2.0))
        .support(Support::of_components("y-min", [false, true, true]))
        .support(Support::of_components("y-max", [false, true, true]))
        .support(Support::fixed("x-min"))
        .load(Load::traction("x-max", [4.0, 0.0, 0.0]))
        .build()
        .unwrap()
}

/// A node of the free end.
fn tip(body: &Body) -> usize {
    body.mesh().nearest_node([6.0, 0.0, 0.0])
}

/// The free end of a bar under its force F sin(omega t) moves by F/(E A k) tan(k L), k = omega/c; with its foot shaken
/// by an acceleration a it has a/cos(k L).
#[test]
fn a_bar_responds_as_one_dimensional_waves() {
    let body = bar();
    let tip = tip(&body);
    let undamped = ModalDamping::Ratios(vec![0.0]);
    let pulled = HarmonicResponse::new(&body, None, 6, &undamped, &Excitation::Loads(vec![0])).unwrap();
    let shaken =
        HarmonicResponse::new(&body, None, 6, &undamped, &Excitation::Base([1.0, 0.0, 0.0])).unwrap();
    // Near an anti-resonance, such as 2.618, large parts cancel: the error is compared with the static response, too.
    let near = |found: [f64; 2], expected: f64, at_rest: f64| {
        let error = (found[0] - expected).abs() / expected.abs().max(at_rest);
        // Linear cells are stiff by (k h)^2/24 in a frequency, up to 4e-4 of it for the second mode.
        assert!(error < 2e-3 && found[1] == 0.0, "{found:?} {expected}");
    };
    // omega_1 = 1.309, omega_2 = 3.927.
    for omega in [0.2, 1.0, 2.0, 3.0] {
        let k = omega / 5.0;
        let displacement = pulled.relative(omega, tip, Quantity::Displacement)[0];
        near(displacement, 4.0 / (50.0 * k) * (k * 6.0).tan(), 4.0 * 6.0 / 50.0);
        let acceleration = shaken.absolute(omega, tip, Quantity::Acceleration)[0];
        near(acceleration, 1.0 / (k * 6.0).cos(), 1.0);
    }
}

/// Few modes with the static correction come close to all modes, but for (omega/omega_{n+1})^2 of the correction.
#[test]
fn the_static_correction_stands_for_the_modes_that_are_left_out() {
    let body = bar();
    let tip = tip(&body);
    let damping = ModalDamping::Ratios(vec![0.01]);
    let excitation = Excitation::Loads(vec![0]);
    let of = |count| HarmonicResponse::new(&body, None, count, &damping, &excitation).unwrap();
    let (all, few) = (of(n_modes(&body)), of(2));
    let exact = all.relative(1.0, tip, Quantity::Displacement)[0];
    close(few.relative(1.0, tip, Quantity::Displacement)[0], exact, 2e-3);
    // Two modes alone lack (8/pi^2)(1/25 + 1/49 + ...) = 10 % of the static displacement.
    let static_part = 4.0 * 6.0 / 50.0;
    let alone: f64 = few
        .modes()
        .iter()
        .zip(few.modal_forces())
        .map(|(mode, f)| mode.shape[3 * tip] * f / mode.angular_frequency.powi(2))
        .sum();
    let lacking = 1.0 - 8.0 / PI.powi(2) * (1.0 + 1.0 / 9.0);
    assert!((1.0 - alone / static_part - lacking).abs() < 1e-3, "{alone}");
}

/// About an equilibrium the modes are those of the loaded body: a weight m g on a spring along x leaves its frequency
/// across it, sqrt(N/(m l)).
#[test]
fn a_loaded_body_responds_with_its_own_modes() {
    let mesh = network(&[[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]]);
    let body = Body::builder(mesh)
        .region(Region::links(Link::spring(100.0, None).unwrap(), 0.0))
        .point_terms(PointTerms { masses: masses(&[1.0, 2.0]), ..PointTerms::default() })
        .support(Support::fixed("0"))
        .load(Load::nodal_force("1", [50.0, 0.0, 0.0]))
        .load(Load::nodal_force("1", [0.0, 1.0, 0.0]).over([(0.0, 0.0), (1.0, 1.0)]).unwrap())
        .build()
        .unwrap();
    let state = State::displaced(&body, 0.0, vec![0.0, 0.0, 0.0, 0.5, 0.0, 0.0], &[]).unwrap();
    let damping = ModalDamping::Ratios(vec![0.02]);
    let excitation = Excitation::Loads(vec![1]);
    let found = HarmonicResponse::new(&body, Some(&state), 3, &damping, &excitation).unwrap();
    // The spring is 1.5 long, with a force of 50.
    let square = 50.0 / (2.0 * 1.5);
    let omega = 3.0;
    let expected = inverse([2.0 * (square - omega * omega), 2.0 * 2.0 * 0.02 * square.sqrt() * omega]);
    close(found.relative(omega, 1, Quantity::Displacement)[1], expected, 1e-9);
}

/// S = mu (1 - 1/l^2) and P = mu (l - 1/l) along a bar whose sides are free, lambda = 0: dS = 2/(l^3 + l) dP at a
/// stretch l; sigma = P changes as P does.
#[test]
fn stresses_change_about_a_stretched_state() {
    let body = Body::builder(mesh::block([1.0, 1.0, 0.1], [1, 1, 2]).unwrap())
        .region(Region::new(NeoHooke::new(0.0, 500.0).unwrap(), 2.0))
        .supports([
            Support::of_components("x-min", [true, false, false]),
            Support::of_components("y-min", [false, true, false]),
            Support::of_components("z-min", [false, false, true]),
        ])
        .load(Load::nodal_force("z-max", [0.0, 0.0, 0.25]))
        .build()
        .unwrap();
    let displacement = body.mesh().points().iter().flat_map(|[_, _, z]| [0.0, 0.0, 0.5 * z]).collect();
    let state = State { displacement, ..State::default() };
    let damping = ModalDamping::Ratios(vec![0.02]);
    let found = HarmonicResponse::new(&body, Some(&state), 6, &damping, &Excitation::Loads(vec![0])).unwrap();
    let fields = Fields::new(&body);
    let nodes = fields.select_nodes(&[body.mesh().nearest_node([0.0, 0.0, 0.05]) as u32]);
    let slow = 1e-3 * found.modes()[0].angular_frequency;
    let l = 1.5f64;
    for (field, expected) in
        [(FieldName::CauchyStress, 1.0), (FieldName::SecondPiolaKirchhoffStress, 2.0 / (l.powi(3) + l))]
    {
        let amplitudes = found.stress_amplitudes(slow, &found.stress(&fields, &nodes, field).unwrap());
        assert!((amplitudes[2][0] / expected - 1.0).abs() < 1e-4, "{field}: {amplitudes:?}");
        let others = amplitudes.iter().enumerate().filter(|(place, _)| *place != 2);
        assert!(others.map(|(_, own)| own[0].abs()).fold(0.0, f64::max) < 1e-6, "{field}: {amplitudes:?}");
    }
}

#[test]
fn impossible_responses_are_rejected() {
    let body = oscillator(0.0, 0.0);
    let message = |ratios: &[f64], excitation| {
        let damping = ModalDamping::Ratios(ratios.to_vec());
        HarmonicResponse::new(&body, None, 1, &damping, &excitation).unwrap_err().to_string()
    };
    let base = || Excitation::Base([1.0, 0.0, 0.0]);
    assert!(message(&[0.1, -0.1], base()).contains("a damping ratio is -0.1"));
    assert!(message(&[], base()).contains("no damping ratio"));
    assert!(message(&[0.1], Excitation::Loads(vec![])).contains("no load to excite"));
    assert!(message(&[0.1], Excitation::Loads(vec![1])).contains("no load with the number 1"));
    let found = response(&body, &ModalDamping::Ratios(vec![0.1]), &base());
    let fields = Fields::new(&body);
    let stress = |field| found.stress(&fields, &fields.select_nodes(&[1]), field).unwrap_err().to_string();
    assert!(stress(FieldName::VonMisesStress).contains("von_mises_stress does not vibrate harmonically"));
    assert!(stress(FieldName::CauchyStress).contains("the body has no cauchy_stress"));
    let damping = ModalDamping::OfBody;
    let error = HarmonicResponse::new(&body, None, 9, &damping, &base()).unwrap_err();
    assert!(matches!(error, Error::TooManyModes { count: 9, free: 1 }), "{error}");
}

/// Steel of NAFEMS R0016 (Maguire, Dawswell and Gould 1993), in m, kg and s.
fn steel() -> Region {
    Region::new(NeoHooke::from_engineering(200e9, 0.3).unwrap(), 8000.0)
}

/// Frequency and size of the largest amplitude of a node along z, near the lowest mode that the load excites, with a
/// damping ratio of 2 %; and the amplitude of the stress xx at another node there.
fn peak(body: &Body, count: usize, places: [[f64; 3]; 2]) -> (f64, f64, f64) {
    let damping = ModalDamping::Ratios(vec![0.02]);
    let found = HarmonicResponse::new(body, None, count, &damping, &Excitation::Loads(vec![0])).unwrap();
    let excited = found.modal_forces().iter().map(|force| force.abs());
    let (at, _) = excited.enumerate().max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap();
    let natural = found.modes()[at].frequency();
    let [node, stressed] = places.map(|place| body.mesh().nearest_node(place));
    let size = |[re, im]: [f64; 2]| re.hypot(im);
    let amplitude = |f: f64| size(found.relative(TAU * f, node, Quantity::Displacement)[2]);
    let frequencies = (0..=2000).map(|i| natural * (0.95 + 5e-5 * f64::from(i)));
    let all = frequencies.map(|f| (f, amplitude(f)));
    let (frequency, largest) = all.max_by(|(_, a), (_, b)| a.total_cmp(b)).unwrap();
    let fields = Fields::new(body);
    let nodes = fields.select_nodes(&[stressed as u32]);
    let change = found.stress(&fields, &nodes, FieldName::CauchyStress).unwrap();
    (frequency, largest, size(found.stress_amplitudes(TAU * frequency, &change)[0]))
}

/// Tests 5H and 5R: a deep beam, 10 x 2 x 2 m, under 1 MN/m: 13.45 mm and 241.9 MPa at 42.65 Hz; under a force with a
/// density of (1 MN/m)^2/Hz a displacement with 180.9 mm^2/Hz there, and a stress with 58516 MPa^2/Hz. Supports hold
/// the end faces across the beam.
#[test]
fn a_deep_beam_has_the_response_of_nafems_5h_and_5r() {
    let body = Body::builder(brick(CellKind::Hex20, [10.0, 2.0, 2.0], [10, 2, 2]))
        .region(steel())
        .support(Support::of_components("x-min", [false, true, true]))
        .support(Support::of_components("x-max", [false, true, true]))
        .support(Support::of_components("centre", [true, false, false]))
        .load(Load::acceleration([0.0, 0.0, 1e6 / (8000.0 * 4.0)]))
        .build()
        .unwrap();
    let (frequency, amplitude, stress) = peak(&body, 12, [[5.0, 1.0, 1.0], [5.0, 1.0, 2.0]]);
    assert!((frequency / 42.65 - 1.0).abs() < 0.01, "{frequency} Hz");
    assert!((1e3 * amplitude / 13.45 - 1.0).abs() < 0.02, "{amplitude} m");
    assert!((1e6 * amplitude * amplitude / 180.9 - 1.0).abs() < 0.04, "{amplitude} m");
    assert!((1e-6 * stress / 241.9 - 1.0).abs() < 0.02, "{stress} Pa");
    assert!((1e-12 * stress * stress / 58516.0 - 1.0).abs() < 0.04, "{stress} Pa");
}

/// Tests 13H and 13R: a thin square plate, 10 x 10 x 0.05 m, with simply supported edges under 100 N/m^2: 45.42 mm at
/// 2.377 Hz; under a pressure with a density of (100 N/m^2)^2/Hz a displacement with 2063.2 mm^2/Hz there. The mode w
/// of a thin plate has the stress `E t/(2 (1 - nu)) w pi^2/a^2` in the middle.
#[test]
fn a_thin_plate_has_the_response_of_nafems_13h_and_13r() {
    let body = Body::builder(brick(CellKind::Hex27, [10.0, 10.0, 0.05], [10, 10, 1]))
        .region(steel())
        .support(Support::of_components("x-min", [false, true, true]))
        .support(Support::of_components("x-max", [false, true, true]))
        .support(Support::of_components("y-min", [true, false, true]))
        .support(Support::of_components("y-max", [true, false, true]))
        .load(Load::acceleration([0.0, 0.0, 100.0 / (8000.0 * 0.05)]))
        .build()
        .unwrap();
    let (frequency, amplitude, stress) = peak(&body, 12, [[5.0, 5.0, 0.025], [5.0, 5.0, 0.05]]);
    assert!((frequency / 2.377 - 1.0).abs() < 0.01, "{frequency} Hz");
    assert!((1e3 * amplitude / 45.42 - 1.0).abs() < 0.02, "{amplitude} m");
    assert!((1e6 * amplitude * amplitude / 2063.2 - 1.0).abs() < 0.04, "{amplitude} m");
    let expected = 200e9 * 0.05 / (2.0 * 0.7) * amplitude * (PI / 10.0).powi(2);
    assert!((stress / expected - 1.0).abs() < 0.02, "{stress} Pa is not {expected}");
}
