//! Equilibria of the literature and closed forms.

use emmy::body::{Body, Load, Region, Support};
use emmy::equilibrium::Equilibrium;
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::mesh::{CellKind, block};
use emmy::motion::{MarchError, NewtonSettings};
use emmy::{Error, mesh};

use super::{displacement, equilibrium, mapped};
use crate::shared::faces::with_faces;

/// Cook's membrane: R. D. Cook, *Improved two-dimensional finite element*, J. Struct. Div. ASCE 100, 1851-1863 (1974).
/// Plane stress, E = 1, nu = 1/3, a shear force of 1: the middle of the free end moves up by 23.96, the value to which
/// meshes of the literature converge. Plane stress is plane strain with nu / (1 + nu) and E (1 + 2 nu) / (1 + nu)^2.
#[test]
fn cooks_membrane() {
    let map = |[s, t, _]: [f64; 3]| [48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0];
    let mesh = mapped(CellKind::Quad9, [16, 16, 1], &[&map]);
    let mesh = with_faces(mesh, &[("wall", &|X| X[0] == 0.0), ("end", &|X| X[0] == 48.0)]);
    let material = SaintVenantKirchhoff::from_engineering(15.0 / 16.0, 0.25).unwrap();
    let force = 1e-7;
    let body = Body::builder(mesh)
        .region(Region::new(material, 1.0))
        .support(Support::fixed("wall"))
        .load(Load::force("end", [0.0, force, 0.0]))
        .build()
        .unwrap();
    let state = equilibrium(&body, 1);
    let tip = displacement(&body, &state, [48.0, 52.0, 0.0])[1] / force;
    // The corner at the wall makes the last digits converge slowly.
    assert!((tip - 23.96).abs() < 0.02, "{tip}");
}

/// The elastica: K. E. Bisshopp and D. C. Drucker, *Large deflection of cantilever beams*, Quart. Appl. Math. 3,
/// 272-275 (1945); numbers by elliptic integrals from K. Mattiasson, Int. J. Numer. Meth. Engng 17, 145-153 (1981).
///
/// The beam has a slenderness of 100: its tip moves by shear and extension as well, about 1e-4 of its length.
#[test]
fn cantilever_in_large_deflection() {
    let (length, modulus) = (100.0, 1.2e6);
    let stiffness = modulus / 12.0;
    for (number, down, back) in [(1.0, 0.30172, 0.05643), (5.0, 0.71379, 0.38763), (10.0, 0.81061, 0.55500)] {
        let mesh = mapped(CellKind::Quad9, [40, 1, 1], &[&|[s, t, _]| [length * s, t, 0.0]]);
        let mesh = with_faces(mesh, &[("wall", &|X| X[0] == 0.0), ("end", &|X| X[0] == length)]);
        let body = Body::builder(mesh)
            .region(Region::new(SaintVenantKirchhoff::from_engineering(modulus, 0.0).unwrap(), 1.0))
            .support(Support::fixed("wall"))
            .load(Load::force("end", [0.0, -number * stiffness / length.powi(2), 0.0]))
            .build()
            .unwrap();
        let state = equilibrium(&body, 5);
        let [x, y, _] = displacement(&body, &state, [length, 0.5, 0.0]).map(|u| u / length);
        assert!((y + down).abs() < 3e-4 && (x + back).abs() < 3e-4, "{number}: {x} {y}");
    }
}

/// Uniaxial tension: with lateral stretch q, `P = mu (l - 1/l) + lambda ln(l q^2)/l` and
/// `0 = mu (q - 1/q) + lambda ln(l q^2)/q`.
#[test]
fn uniaxial_tension() {
    let (lambda, mu, stretch) = (3.0, 2.0, 1.8f64);
    let side = |q: f64| mu * (q - 1.0 / q) + lambda * (stretch * q * q).ln() / q;
    let (mut low, mut high) = (0.5, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if side(middle) < 0.0 { low = middle } else { high = middle }
    }
    let stress = mu * (stretch - 1.0 / stretch) + lambda * (stretch * low * low).ln() / stretch;
    let planes = ["x-min", "y-min", "z-min"].map(Support::symmetry);
    let body = Body::builder(block([1.0, 2.0, 1.0], [2, 2, 1]).unwrap())
        .region(Region::new(NeoHooke::new(lambda, mu).unwrap(), 1.0))
        .supports(planes)
        .load(Load::traction("x-max", [stress, 0.0, 0.0]))
        .build()
        .unwrap();
    let state = equilibrium(&body, 4);
    let [x, y, z] = displacement(&body, &state, [1.0, 2.0, 1.0]);
    assert!((x - (stretch - 1.0)).abs() < 1e-13, "{x}");
    assert!((y - 2.0 * (low - 1.0)).abs() < 1e-13 && (z - (low - 1.0)).abs() < 1e-13, "{y} {z}");
}

const LAMBDA: f64 = 20.0;
const MU: f64 = 1.0;
const INNER: f64 = 1.0;
const OUTER: f64 = 1.25;

/// A sphere of neo-Hooke material whose outer radius becomes `radius`: its inner radius and pressure, by integration
/// of `dP_r/dR + 2 (P_r - P_t)/R = 0` from the free outer surface inwards (Runge-Kutta).
fn inflated(radius: f64) -> [f64; 2] {
    // Radial stretch of a radial stress, which grows with it.
    let radial = |P: f64, tangential: f64| {
        let stress = |l: f64| MU * (l - 1.0 / l) + LAMBDA * (l * tangential * tangential).ln() / l - P;
        let (mut low, mut high) = (0.05, 2.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if stress(middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let rate = |R: f64, [r, P]: [f64; 2]| {
        let t = r / R;
        let l = radial(P, t);
        let tangential = MU * (t - 1.0 / t) + LAMBDA * (l * t * t).ln() / t;
        [l, 2.0 * (tangential - P) / R]
    };
    let n = 200;
    let h = (INNER - OUTER) / n as f64;
    let mut y = [radius, 0.0];
    let at = |y: [f64; 2], k: [f64; 2], h: f64| [y[0] + h * k[0], y[1] + h * k[1]];
    for i in 0..n {
        let R = OUTER + i as f64 * h;
        let a = rate(R, y);
        let b = rate(R + 0.5 * h, at(y, a, 0.5 * h));
        let c = rate(R + 0.5 * h, at(y, b, 0.5 * h));
        let d = rate(R + h, at(y, c, h));
        y = [0, 1].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    [y[0], -y[1] * (INNER / y[0]).powi(2)]
}

/// An eighth of the sphere under follower pressure from inside.
fn balloon(pressure: f64) -> Body {
    let patch = |order: [usize; 3]| {
        move |[s, t, depth]: [f64; 3]| {
            let tangent = |s: f64| (std::f64::consts::FRAC_PI_4 * s).tan();
            let (a, b) = (tangent(s), tangent(t));
            let radius = (INNER + depth * (OUTER - INNER)) / (1.0 + a * a + b * b).sqrt();
            let mut X = [0.0; 3];
            (X[order[0]], X[order[1]], X[order[2]]) = (radius * a, radius * b, radius);
            X
        }
    };
    let (x, y, z) = (patch([1, 2, 0]), patch([2, 0, 1]), patch([0, 1, 2]));
    let mesh = mapped(CellKind::Hex27, [2, 2, 1], &[&x, &y, &z]);
    let radius = |X: [f64; 3]| X.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mesh = with_faces(
        mesh,
        &[
            ("inside", &|X| (radius(X) - INNER).abs() < 1e-9),
            ("x", &|X| X[0].abs() < 1e-9),
            ("y", &|X| X[1].abs() < 1e-9),
            ("z", &|X| X[2].abs() < 1e-9),
        ],
    );
    Body::builder(mesh)
        .region(Region::new(NeoHooke::new(LAMBDA, MU).unwrap(), 1.0))
        .supports(["x", "y", "z"].map(Support::symmetry))
        .load(Load::pressure("inside", pressure))
        .build()
        .unwrap()
}

/// The inner radius of an inflated sphere, and the pressure beyond which there is no equilibrium: for a thin sphere of
/// an incompressible material `2 mu (t/R) (l^-1 - l^-7)`, largest at l = 7^(1/6).
#[test]
fn inflated_balloon() {
    let [radius, pressure] = inflated(1.45);
    let body = balloon(pressure);
    let state = equilibrium(&body, 3);
    let [x, _, _] = displacement(&body, &state, [INNER, 0.0, 0.0]);
    // The error of the coarse mesh; it falls with the fourth power of the cell size.
    assert!((INNER + x - radius).abs() < 2e-3 * (radius - INNER), "{} {radius}", INNER + x);

    let largest = (0..200).map(|i| inflated(OUTER + 0.005 * i as f64)[1]).fold(0.0, f64::max);
    let stretch = 7f64.powf(1.0 / 6.0);
    let thin = 2.0 * MU * (OUTER - INNER) / (0.5 * (OUTER + INNER)) * (1.0 / stretch - stretch.powi(-7));
    assert!((largest / thin - 1.0).abs() < 0.1, "{largest} {thin}");
    let error = Equilibrium::new(&balloon(1.25 * largest), 0.0, 10)
        .unwrap()
        .start(NewtonSettings::default(), &[], &mut [])
        .unwrap_err();
    let MarchError::Step(Error::NoEquilibrium { fraction, .. }) = error else { panic!("{error}") };
    assert!((1.25 * fraction - 1.0).abs() < 5e-3, "{fraction}");
}

/// Two bars in a shallow frame under a force on top (von Mises truss) snap through at a known force:
/// with engineering strains small, `N = E A e`, a bar of length L and rise H gives `P = 2 E A (h/l) (l0 - l)/l0`.
#[test]
fn a_frame_that_snaps_through_is_named_with_its_load() {
    use emmy::material::Link;
    let (rise, span, stiffness) = (0.1f64, 1.0f64, 1000.0);
    let length = rise.hypot(span);
    let force = |h: f64| {
        let l = h.hypot(span);
        2.0 * stiffness * (h / l) * (length - l) / length
    };
    let largest = (0..=1000).map(|i| force(rise * f64::from(i) / 1000.0)).fold(0.0, f64::max);
    let points = [[-span, 0.0, 0.0], [0.0, 0.0, rise], [span, 0.0, 0.0]];
    let mesh = mesh::Mesh::from_cells(CellKind::Line2, &points, &[[0, 1], [1, 2]]).unwrap();
    let mesh = mesh.with_node_group("feet", [0, 2]).unwrap().with_node_group("top", [1]).unwrap();
    let frame = |load: f64| {
        Body::builder(mesh.clone())
            .region(Region::links(Link::spring(stiffness / length, None).unwrap(), 0.0))
            .point_terms(emmy::body::PointTerms {
                masses: vec![emmy::body::PointMass { group: "top".into(), mass: 1.0 }],
                ..Default::default()
            })
            .support(Support::fixed("feet"))
            .support(Support::of_components("top", [false, true, false]))
            .load(Load::nodal_force("top", [0.0, 0.0, -load]))
            .build()
            .unwrap()
    };
    // Just below the limit the equilibrium is met.
    let state = equilibrium(&frame(0.99 * largest), 10);
    let h = rise + state.displacement[5];
    assert!((force(h) / largest - 0.99).abs() < 1e-9, "{h}");
    let overloaded = frame(2.0 * largest);
    let start = Equilibrium::new(&overloaded, 0.0, 10).unwrap();
    let error = start.start(NewtonSettings::default(), &[], &mut []).unwrap_err();
    let MarchError::Step(Error::NoEquilibrium { fraction, .. }) = error else { panic!("{error}") };
    assert!((2.0 * fraction - 1.0).abs() < 2e-3, "{fraction}");
}
