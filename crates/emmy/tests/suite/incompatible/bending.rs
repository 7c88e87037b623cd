//! Bending: deflections, stresses and frequencies of beams of one row of bricks.

use std::f64::consts::PI;

use emmy::body::{Body, FieldName, Fields, Load, Region, Support};
use emmy::equilibrium::Equilibrium;
use emmy::material::{NeoHooke, NeoHookeIsochoric, Volumetric};
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder, rectangle};
use emmy::modes::{modes, modes_about};
use emmy::motion::{NewtonSettings, State};

use super::with_modes;

const MODULUS: f64 = 1000.0;

/// Bricks 1 x 1 x 1 in a row; the inner nodes at the top and at the bottom are moved along the beam in opposite
/// directions, alternately by +-`skew`.
fn beam(length: usize, skew: f64) -> Mesh {
    let mut builder = MeshBuilder::new();
    for i in 0..=length {
        for (y, z) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            let shift = if i == 0 || i == length { 0.0 } else { sign * skew * (2.0 * z - 1.0) };
            builder.point([i as f64 + shift, y, z]);
        }
    }
    for i in 0..length as u32 {
        let [a, b] = [4 * i, 4 * i + 4];
        builder.cell(CellKind::Hex8, &[a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2]).unwrap();
    }
    builder.node_group("wall", 0..4);
    builder.node_group("side", [0, 3]);
    builder.node_group("bottom", [0, 1]);
    builder.facet_group("end", [Facet { cell: length as u32 - 1, local: 1 }]);
    builder.build().unwrap()
}

/// A cantilever whose wall does not hinder the lateral strain of its cross section.
fn cantilever(mesh: Mesh, nu: f64, has_modes: bool, force: f64) -> Body {
    let material = NeoHooke::from_engineering(MODULUS, nu).unwrap();
    Body::builder(mesh)
        .region(if has_modes { with_modes(material, 1.0) } else { Region::new(material, 1.0) })
        .support(Support::of_components("wall", [true, false, false]))
        .support(Support::of_components("side", [false, true, false]))
        .support(Support::of_components("bottom", [false, false, true]))
        .load(Load::force("end", [0.0, 0.0, force]))
        .build()
        .unwrap()
}

fn equilibrium(body: &Body) -> State {
    let settings = NewtonSettings { tolerance: 1e-11, ..NewtonSettings::default() };
    Equilibrium::new(body, 0.0, 1).unwrap().start(settings, &[], &mut []).unwrap()
}

/// Deflection of the end under a small force over the theory of Timoshenko with the shear factor 5/6.
fn deflection(skew: f64, nu: f64, has_modes: bool) -> f64 {
    let (length, force) = (10, 1e-6);
    let state = equilibrium(&cantilever(beam(length, skew), nu, has_modes, force));
    let end = (4 * length..4 * length + 4).map(|node| state.displacement[3 * node + 2]).sum::<f64>() / 4.0;
    let length = length as f64;
    let shear = MODULUS / (2.0 * (1.0 + nu));
    end / (force * (length.powi(3) / (3.0 * MODULUS / 12.0) + length / (5.0 / 6.0 * shear)))
}

/// The regular beam as in section 8 of `formulation-mixed.md`; the skewed one by a dense NumPy program of the linear
/// element.
#[test]
fn ten_bricks_bend_like_a_beam() {
    for (nu, skew, expected) in [
        (0.3, 0.0, [0.648, 0.993]),
        (0.4999, 0.0, [0.387, 0.932]),
        (0.3, 0.25, [0.5009, 0.7142]),
        (0.4999, 0.25, [0.4059, 0.6917]),
    ] {
        let found = [false, true].map(|has_modes| deflection(skew, nu, has_modes));
        println!("nu = {nu}, skew {skew}: {found:.4?}");
        let tolerance = if skew == 0.0 { 5e-4 } else { 5e-5 };
        assert!((0..2).all(|i| (found[i] - expected[i]).abs() < 1.01 * tolerance), "{found:?} {expected:?}");
    }
}

/// `sigma = M c / I` at the top of a cantilever; the standard cell has two thirds of it.
#[test]
fn stresses_include_the_modes() {
    let force = 1e-4;
    let axial = |has_modes: bool| {
        let body = cantilever(beam(10, 0.0), 0.3, has_modes, force);
        let state = equilibrium(&body);
        let fields = Fields::new(&body);
        let node = body.mesh().nearest_node([5.0, 1.0, 1.0]);
        let stress =
            &fields.at([&state.displacement, &state.velocity], &[FieldName::CauchyStress])[0].numbers;
        let probe = fields.on(
            &fields.select_nodes(&[node as u32]),
            [&state.displacement, &state.velocity],
            FieldName::CauchyStress,
        );
        assert_eq!((stress.len(), probe[0]), (6 * body.mesh().n_nodes(), stress[6 * node]));
        stress[6 * node] / (-force * 5.0 * 0.5 * 12.0)
    };
    let (modes, standard) = (axial(true), axial(false));
    println!("{modes} {standard}");
    assert!((modes - 1.0).abs() < 0.01 && (0.6..0.9).contains(&standard), "{modes} {standard}");
}

/// A square of nearly incompressible rubber between smooth plates, in plane strain, at a stretch: whether its
/// equilibrium is stable.
fn is_stable(stretch: f64) -> bool {
    let (mu, bulk_modulus) = (80.1938, 400_942.0);
    let material = NeoHookeIsochoric::new(mu, bulk_modulus, Volumetric::Quadratic).unwrap();
    let body = Body::builder(rectangle([1.0, 1.0], [6, 6]).unwrap())
        .region(with_modes(material, 1.0))
        .support(Support::of_components("y-min", [false, true, false]))
        .support(Support::of_components("y-max", [false, true, false]))
        .support(Support::of_components("x-min", [true, false, false]))
        .build()
        .unwrap();
    // The lateral stretch q of free sides, P_xx = mu J^(-2/3) (q - tr C/(3 q)) + K (J - 1) J/q = 0 with J = q stretch.
    let mut q = 1.0 / stretch;
    for _ in 0..20 {
        let shear = q - (q * q + stretch * stretch + 1.0) / (3.0 * q);
        q = (1.0 - mu / (bulk_modulus * stretch) * (q * stretch).powf(-2.0 / 3.0) * shear) / stretch;
    }
    let wide = |X: &[f64; 3]| [(q - 1.0) * X[0], (stretch - 1.0) * X[1], 0.0];
    let displacement = body.mesh().points().iter().flat_map(wide).collect();
    let state = State::displaced(&body, 0.0, displacement, &[]).unwrap();
    modes_about(&body, &state, 1).unwrap()[0].angular_frequency > 0.0
}

/// Cells with modes hourglass under compression; the limit is that of a dense NumPy program of the linearised element,
/// and close to 0.68 of `formulation-mixed.md`, section 8.
#[test]
fn compression_has_a_limit() {
    assert!(is_stable(0.8) && is_stable(0.70) && !is_stable(0.69) && !is_stable(0.6));
}

/// Bending frequencies of a free beam, `(4.730/L)^2 sqrt(EI/(rho A))` (Euler and Bernoulli; shear and rotary inertia
/// lower it by `(1 + E/(G 5/6))/2 (pi k/L)^2/12`, about 1 %).
#[test]
fn a_free_beam_has_the_frequency_of_beam_theory() {
    let length = 20usize;
    let body = Body::builder(beam(length, 0.0))
        .region(with_modes(NeoHooke::from_engineering(MODULUS, 0.3).unwrap(), 1.0))
        .build()
        .unwrap();
    let found = modes(&body, 8).unwrap();
    assert_eq!(found.iter().filter(|mode| mode.angular_frequency == 0.0).count(), 6);
    let expected = (4.730_041 / length as f64).powi(2) * (MODULUS / 12.0).sqrt();
    let lowered = (1.0 + 2.6 * 1.2) * (1.5 * PI / length as f64).powi(2) / 24.0;
    for mode in &found[6..8] {
        let ratio = mode.angular_frequency / (expected * (1.0 - lowered));
        println!("{ratio} {lowered}");
        assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    }
}
