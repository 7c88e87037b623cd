//! Nearly incompressible rubber against closed forms of incompressible rubber.

use emmy::body::{Formulation, PressureSpace};
use emmy::equilibrium::Equilibrium;
use emmy::prelude::*;

use super::places;
use crate::shared::faces::{Face, with_faces};
use std::collections::HashMap;

/// Position of a point of the unit cube.
type Map<'a> = &'a dyn Fn([f64; 3]) -> [f64; 3];

/// Blocks of cells, joined where their points meet.
fn joined(kind: CellKind, cells: [usize; 3], maps: &[Map<'_>], faces: &[Face<'_>]) -> Mesh {
    let (mut builder, mut nodes) = (MeshBuilder::new(), HashMap::new());
    for map in maps {
        for of_cell in places(kind, cells) {
            let node = |place: &[f64; 3]| {
                let X = map(*place);
                let key = X.map(|x| (1e8 * x).round() as i64);
                *nodes.entry(key).or_insert_with(|| builder.point(X))
            };
            let of_cell: Vec<u32> = of_cell.iter().map(node).collect();
            builder.cell(kind, &of_cell).unwrap();
        }
    }
    with_faces(builder, faces)
}

fn rubber(ratio: f64, formulation: Formulation) -> Region {
    let rubber = NeoHookeIsochoric::new(1.0, ratio, Volumetric::SimoTaylor).unwrap();
    Region::new(rubber, 1.0).with_formulation(formulation)
}

fn displacement(body: &Body, load_steps: usize) -> Vec<f64> {
    let equilibrium = Equilibrium::new(body, 0.0, load_steps).unwrap();
    equilibrium.start(NewtonSettings::default(), &[], &mut []).unwrap().displacement
}

/// Displacement along x of the node at (r, 0, 0).
fn radial(body: &Body, displacement: &[f64], r: f64) -> f64 {
    displacement[3 * body.mesh().nearest_node([r, 0.0, 0.0])]
}

const PROJECTED: Formulation = Formulation::ProjectedVolume(None);
const INNER: f64 = 1.0;
const OUTER: f64 = 1.5;

/// Stretches of the inner and outer surface of a thick shell whose volume is constant; d: 2 of a tube, 3 of a sphere.
fn stretches(inner: f64, d: i32) -> [f64; 2] {
    let outer = (OUTER.powi(d) + (inner.powi(d) - 1.0) * INNER.powi(d)).powf(1.0 / f64::from(d)) / OUTER;
    [inner, outer]
}

/// Inflation of a sphere, exact for incompressible neo-Hooke material: A. E. Green and W. Zerna, *Theoretical
/// Elasticity*, Oxford 1954, section 3.10.
///
/// `p = mu (f(a) - f(b)),      f(l) = -2/l - 1/(2 l^4)` with the stretches a inside, b outside
#[test]
fn a_thick_sphere_is_inflated() {
    let f = |l: f64| -2.0 / l - 0.5 / l.powi(4);
    let [a, b] = stretches(1.3, 3);
    let pressure = f(a) - f(b);
    let patch = |order: [usize; 3]| {
        move |[s, t, depth]: [f64; 3]| {
            let tangent = |s: f64| (std::f64::consts::FRAC_PI_4 * s).tan();
            let (u, v) = (tangent(s), tangent(t));
            let radius = (INNER + depth * (OUTER - INNER)) / (1.0 + u * u + v * v).sqrt();
            let mut X = [0.0; 3];
            (X[order[0]], X[order[1]], X[order[2]]) = (radius * u, radius * v, radius);
            X
        }
    };
    let (x, y, z) = (patch([1, 2, 0]), patch([2, 0, 1]), patch([0, 1, 2]));
    let norm = |X: [f64; 3]| X.iter().map(|x| x * x).sum::<f64>().sqrt();
    let error = |kind, cells, formulation| {
        let mesh = joined(
            kind,
            cells,
            &[&x, &y, &z],
            &[
                ("inside", &|X| (norm(X) - INNER).abs() < 1e-6),
                ("x", &|X| X[0].abs() < 1e-9),
                ("y", &|X| X[1].abs() < 1e-9),
                ("z", &|X| X[2].abs() < 1e-9),
            ],
        );
        let body = Body::builder(mesh)
            .region(rubber(1e5, formulation))
            .supports(["x", "y", "z"].map(Support::symmetry))
            .load(Load::pressure("inside", pressure))
            .build()
            .unwrap();
        radial(&body, &displacement(&body, 4), INNER) / (INNER * (a - 1.0)) - 1.0
    };
    let coarse = error(CellKind::Hex8, [2, 2, 2], PROJECTED);
    let fine = error(CellKind::Hex8, [4, 4, 4], PROJECTED);
    let quadratic = error(CellKind::Hex27, [2, 2, 2], PROJECTED);
    let locked = error(CellKind::Hex8, [4, 4, 4], Formulation::Standard);
    println!("sphere: hex8 {coarse:+.3} {fine:+.3}, hex27 {quadratic:+.4}, standard hex8 {locked:+.3}");
    assert!(quadratic.abs() < 5e-3 && fine.abs() < 0.05 && fine.abs() < 0.4 * coarse.abs());
    assert!(locked < -0.5);
}

/// Inflation of a long tube, exact for incompressible neo-Hooke material: R. S. Rivlin, Phil. Trans. R. Soc. A 242
/// (1949) 173.
///
/// `p = mu [ln(a/b) + (b^-2 - a^-2)/2]`
#[test]
fn a_thick_tube_is_inflated() {
    let [a, b] = stretches(1.5, 2);
    let pressure = (a / b).ln() + 0.5 * (b.powi(-2) - a.powi(-2));
    let map = |[s, t, _]: [f64; 3]| {
        let (r, angle) = (INNER + s * (OUTER - INNER), std::f64::consts::FRAC_PI_2 * t);
        [r * angle.cos(), r * angle.sin(), 0.0]
    };
    let error = |kind, n: usize, formulation| {
        let mesh = joined(
            kind,
            [n, 2 * n, 1],
            &[&map],
            &[
                ("inside", &|X| (X[0].hypot(X[1]) - INNER).abs() < 1e-6),
                ("x", &|X| X[0].abs() < 1e-9),
                ("y", &|X| X[1].abs() < 1e-9),
            ],
        );
        let body = Body::builder(mesh)
            .region(rubber(1e5, formulation))
            .supports(["x", "y"].map(Support::symmetry))
            .load(Load::pressure("inside", pressure))
            .build()
            .unwrap();
        radial(&body, &displacement(&body, 4), INNER) / (INNER * (a - 1.0)) - 1.0
    };
    let constant = Formulation::ProjectedVolume(Some(PressureSpace::Constant));
    let cases = [
        (CellKind::Quad4, PROJECTED, 0.02),
        (CellKind::Quad8, PROJECTED, 2e-3),
        (CellKind::Quad8, constant, 0.02),
        (CellKind::Quad9, PROJECTED, 1e-3),
        (CellKind::Quad9, constant, 0.02),
        (CellKind::Tri6, PROJECTED, 0.02),
    ];
    for (kind, formulation, bound) in cases {
        let found = error(kind, 4, formulation);
        println!("tube: {kind} {formulation:?} {found:+.1e}");
        assert!(found.abs() < bound, "{kind}: {found}");
    }
    assert!(error(CellKind::Quad4, 4, Formulation::Standard) < -0.5);
}

/// A long rubber mount between rigid plates, compressed: Y.-H. Lai, D. A. Dillard, J. S. Thornton, J. Appl. Mech. 59
/// (1992) 902. Its stiffness is that of the pressure in the flow between the plates, with the bulk modulus:
///
/// `E_c = K (1 - tanh(r)/r),      r = S sqrt(12 mu/K),      S = width / (2 thickness)`
///
/// For thin mounts; the terms left out are of the order of `1/S`.
#[test]
fn a_bonded_mount_has_the_stiffness_of_the_literature() {
    let (shape, strain) = (20.0, 1e-6);
    for ratio in [1e4, 5e4] {
        let r = shape * (12.0f64 / ratio).sqrt();
        let expected = ratio * (1.0 - r.tanh() / r);
        let stiffness = |kind, cells: [usize; 3], formulation| {
            // Smaller cells at the free side.
            let map = |[s, t, _]: [f64; 3]| [shape * (1.0 - (1.0 - s).powi(2)), t, 0.0];
            let faces: [Face<'_>; 3] = [
                ("middle", &|X| X[0].abs() < 1e-9),
                ("bottom", &|X| X[1].abs() < 1e-9),
                ("top", &|X| X[1] > 1.0 - 1e-9),
            ];
            let mesh = joined(kind, cells, &[&map], &faces);
            let down = TimeFunction::new(vec![(0.0, -strain), (1.0, -strain)]).unwrap();
            let body = Body::builder(mesh)
                .region(rubber(ratio, formulation))
                .support(Support::of_components("middle", [true, false, false]))
                .support(Support::fixed("bottom"))
                .support(Support {
                    fix: [true, false, true],
                    ..Support::driven("top", [None, Some(down), None])
                })
                .build()
                .unwrap();
            2.0 * body.strain_energy(&displacement(&body, 1)) / (shape * strain * strain)
        };
        let of = |kind, n: usize, formulation| stiffness(kind, [10 * n, n, 1], formulation) / expected;
        let quadratic = [CellKind::Quad9, CellKind::Quad8].map(|kind| of(kind, 2, PROJECTED));
        let linear = [4, 8].map(|n| of(CellKind::Quad4, n, PROJECTED));
        let locked = of(CellKind::Quad4, 4, Formulation::Standard);
        println!(
            "mount, K = {ratio} mu: quad9, quad8 {quadratic:.4?}, quad4 {linear:.4?}, standard {locked:.3}"
        );
        assert!(quadratic.iter().all(|x| (x - 1.0).abs() < 0.01), "{quadratic:?}");
        // Four straight lines instead of a parabola are stiffer by 1/16, eight by 1/64.
        assert!((linear[0] - 1.0 - 1.0 / 16.0).abs() < 0.015 && (linear[1] - 1.0 - 1.0 / 64.0).abs() < 0.015);
        assert!(locked > 1.3, "{locked}");
    }
}
