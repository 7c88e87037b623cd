//! The L-shaped block of Betsch and Steinmann (2001), Section 5, against an independent implementation, to nine digits.

use emmy::body::{Body, InitialVelocity, Load, LoadKind, Region, TimeFunction};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::motion::{Motion, NewtonSettings, Phase, State, StepPlan};

use crate::shared::schemes::at;

/// Results of the independent implementation.
struct Expected {
    kinetic: f64,
    strain: f64,
    angular_momentum: [f64; 3],
    probe: [f64; 3],
    tip: [f64; 3],
}

enum Case {
    Rigid,
    Soft,
    Spinning,
}

/// Tractions of the paper's load, t = (256, 512, 768)/9 on y = 10 and the opposite on x = 6, as a hat over 0..1.
fn hat_loads() -> [Load; 2] {
    [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| Load {
        kind: LoadKind::Traction {
            group: group.to_string(),
            traction: [256.0, 512.0, 768.0].map(|t| sign * t / 9.0),
        },
        time_function: TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]).unwrap(),
    })
}

fn body(case: &Case) -> Body {
    let mesh = emmy::mesh::l_block(1.0).unwrap();
    let rubber = || Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.5).on("body");
    match case {
        Case::Rigid => {
            let stiff = SaintVenantKirchhoff::from_engineering(1e7, 0.3).unwrap();
            Body::builder(mesh).region(Region::new(stiff, 1.0)).loads(hat_loads()).build()
        }
        Case::Soft => Body::builder(mesh).region(rubber()).loads(hat_loads()).build(),
        Case::Spinning => Body::builder(mesh).region(rubber()).build(),
    }
    .unwrap()
}

fn assert_case(case: Case, scheme: &str, degree: usize, size: f64, until: f64, expected: Expected) {
    let body = body(&case);
    let spin = InitialVelocity {
        angular_velocity: [0.3, 0.5, 0.8],
        gradient: [[0.2, 0.0, 0.0], [0.0, -0.1, 0.0], [0.0, 0.0, 0.02]],
        ..Default::default()
    };
    let fields = if matches!(case, Case::Spinning) { vec![spin] } else { vec![] };
    let state = State::initial(&body, 0.0, &fields).unwrap();
    // The reference solves to rounding; the strain energy of a stiff body is a small part of the energy.
    let settings = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
    let mut motion = Motion::starting(&body, at(scheme.parse().unwrap(), degree), settings, state).unwrap();
    motion.march(&StepPlan::new(0.0, vec![Phase { until, size }]).unwrap(), &mut []).unwrap();
    let record = motion.record();
    let tip = motion.state().position(&body, body.mesh().nearest_node(expected.tip));
    close("kinetic energy", &[record.kinetic_energy], &[expected.kinetic], 1e-9);
    close("strain energy", &[record.strain_energy], &[expected.strain], 1e-9);
    close("angular momentum", &record.angular_momentum, &expected.angular_momentum, 1e-9);
    close("probe", &tip, &expected.probe, 1e-9);
}

fn close(what: &str, value: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0f64, |size, x| size.max(x.abs()));
    for (value, expected) in value.iter().zip(expected) {
        assert!((value - expected).abs() < tolerance * size, "{what}: {value} instead of {expected}");
    }
}

const FAR_END: [f64; 3] = [0.0, 10.0, 0.0];

#[test]
fn quasi_rigid_as1() {
    let expected = Expected {
        kinetic: 4340.447297984854,
        strain: 0.10501633876750996,
        angular_momentum: [2231.7473935756852, 1302.8250073384627, -1612.4658027508567],
        probe: [4.863540304758653, 6.6878769201081045, 6.73669456563305],
        tip: FAR_END,
    };
    assert_case(Case::Rigid, "AS(1)", 1, 0.01, 1.0, expected);
}

#[test]
fn large_strain_fe1() {
    let expected = Expected {
        kinetic: 5229.105491130474,
        strain: 273.53309664142995,
        angular_momentum: [1745.828154109378, 977.9598897839394, -1233.9159778925496],
        probe: [6.727694069425978, 2.5149797283687794, 6.022789521708359],
        tip: FAR_END,
    };
    assert_case(Case::Soft, "FE(1)", 1, 0.01, 1.0, expected);
}

#[test]
fn large_strain_as5() {
    let expected = Expected {
        kinetic: 5228.912943267011,
        strain: 271.237113263682,
        angular_momentum: [1745.5753989603054, 977.6812779004241, -1233.6459849206103],
        probe: [6.727415744737577, 2.513074223851449, 6.019882027926679],
        tip: FAR_END,
    };
    assert_case(Case::Soft, "AS(5)", 1, 0.01, 1.0, expected);
}

#[test]
fn large_strain_dgm() {
    let expected = Expected {
        kinetic: 5228.9179774465365,
        strain: 271.2243015172606,
        angular_momentum: [1745.5732342798208, 977.6790641230817, -1233.6437875088473],
        probe: [6.727412461644957, 2.5130641815941193, 6.019873130752636],
        tip: FAR_END,
    };
    assert_case(Case::Soft, "DGM", 1, 0.01, 1.0, expected);
}

#[test]
fn large_strain_as5_degree_2() {
    let expected = Expected {
        kinetic: 5226.864233712425,
        strain: 272.6795236018545,
        angular_momentum: [1745.8275773667829, 977.7998480327419, -1233.8090911440481],
        probe: [6.727605490279003, 2.5102869331497066, 6.019536383326125],
        tip: FAR_END,
    };
    assert_case(Case::Soft, "AS(5)", 2, 0.05, 1.0, expected);
}

#[test]
fn spinning_dgm_degree_3() {
    let expected = Expected {
        kinetic: 459.80336777886544,
        strain: 4.727732221124906,
        angular_momentum: [190.73249999999962, -91.26000000000103, 1196.9625000000005],
        probe: [4.656462285929465, 5.187306042233497, -0.8876192088651357],
        tip: [6.0, 3.0, 0.0],
    };
    assert_case(Case::Spinning, "DGM", 3, 0.1, 0.5, expected);
}

#[test]
fn spinning_fe1() {
    let expected = Expected {
        kinetic: 462.2838305003992,
        strain: 2.2698288529643293,
        angular_momentum: [190.73249999998748, -91.26000000003897, 1196.9624999999376],
        probe: [-2.9647663221889506, 9.281949232432694, 1.2205861456172442],
        tip: FAR_END,
    };
    assert_case(Case::Spinning, "FE(1)", 1, 0.02, 0.4, expected);
}
