//! Cells with a projected volume whose nodes are all held or driven: works, impulses and energies of the closed form.

use emmy::body::{Formulation, PressureSpace, TimeFunction};
use emmy::internals::quadrature::gauss;
use emmy::motion::Adaptivity;
use emmy::prelude::*;

use super::mapped;
use crate::shared::schemes::{DGM, TRAPEZOIDAL, assumed_strain, at, fe, lobatto};

const LAMBDA: f64 = 60.0;
const MU: f64 = 20.0;
const DENSITY: f64 = 1.2;
const END: f64 = 0.2;

fn rubber(formulation: Formulation) -> Region {
    Region::new(NeoHooke::new(LAMBDA, MU).unwrap(), DENSITY).with_formulation(formulation)
}

const PROJECTED: Formulation = Formulation::ProjectedVolume(None);

/// Elongation, its rate, and the rate of this.
fn elongation(t: f64) -> [f64; 3] {
    let (sin, cos) = (8.0 * t).sin_cos();
    [0.3 * sin, 2.4 * cos, -19.2 * sin]
}

/// Energy and first Piola-Kirchhoff stress of uniaxial strain to a stretch.
fn energy_and_stress(stretch: f64) -> [f64; 2] {
    let ln = stretch.ln();
    let energy = 0.5 * MU * (stretch * stretch - 1.0) - MU * ln + 0.5 * LAMBDA * ln * ln;
    [energy, MU * (stretch - 1.0 / stretch) + LAMBDA * ln / stretch]
}

/// A support for each height of nodes, which moves in proportion to the height.
fn stretched(mesh: Mesh) -> (Mesh, Vec<Support>) {
    let heights = [0.0, 0.25, 0.5, 0.75, 1.0];
    let mut mesh = mesh;
    let mut supports = Vec::new();
    for (number, height) in heights.into_iter().enumerate() {
        let nodes = mesh.points().iter().enumerate().filter(|(_, x)| (x[1] - height).abs() < 1e-9);
        let nodes: Vec<u32> = nodes.map(|(node, _)| node as u32).collect();
        if nodes.is_empty() {
            continue;
        }
        let name = format!("level-{number}");
        mesh = mesh.with_node_group(&name, nodes).unwrap();
        let moved = TimeFunction::smooth("elongation", move |t| elongation(t).map(|s| height * s));
        let at_rest = TimeFunction::smooth("0", |_| [0.0; 3]);
        supports.push(Support::driven(&name, [Some(at_rest.clone()), Some(moved), Some(at_rest)]));
    }
    (mesh, supports)
}

/// Work of the reactions, largest residual of the energy balance, and impulse of the uppermost support.
fn end_of(body: &Body, scheme: Scheme, size: f64) -> [f64; 3] {
    let mut motion = Motion::new(body, scheme).unwrap();
    let [mut impulse, mut residual] = [0.0; 2];
    for _ in 0..(END / size).round() as usize {
        residual = f64::max(residual, motion.step(size).unwrap().energy_residual.abs());
        impulse += size * motion.reactions()[motion.reactions().len() - 1].force[1];
    }
    [motion.record().external_work, residual, impulse]
}

fn body(mesh: Mesh, formulation: Formulation) -> Body {
    let (mesh, supports) = stretched(mesh);
    Body::builder(mesh).region(rubber(formulation)).supports(&supports).build().unwrap()
}

fn block() -> Mesh {
    mesh::block([1.0; 3], [1; 3]).unwrap()
}

/// Energy at the end less energy at the start, with the kinetic energy of a velocity proportional to the height.
fn exact_work() -> f64 {
    let [s, v, _] = elongation(END);
    energy_and_stress(1.0 + s)[0] + DENSITY / 6.0 * (v * v - elongation(0.0)[1].powi(2))
}

/// The stress on the upper end, integrated over time, and a third of the mass times the change of its velocity.
fn exact_impulse() -> f64 {
    let rule = gauss(30);
    let terms = rule.points.iter().zip(&rule.weights);
    let stress = |t: f64| energy_and_stress(1.0 + elongation(t)[0])[1];
    let of_stress: f64 = terms.map(|([c], w)| END * w * stress(c * END)).sum();
    of_stress + DENSITY / 3.0 * (elongation(END)[1] - elongation(0.0)[1])
}

#[test]
fn reactions_of_energy_momentum_schemes_include_the_pressures() {
    // The numbers of the closed form: a slip in it would be seen.
    assert!((exact_work() - 2.564).abs() < 5e-4 && (exact_impulse() - 2.099).abs() < 5e-4);
    let body = body(block(), PROJECTED);
    assert_eq!(body.n_free_dofs(), 0);
    for scheme in [DGM, assumed_strain(8)] {
        for degree in 1..=4 {
            let [work, residual, impulse] = end_of(&body, at(scheme, degree), 0.01);
            assert!((work - exact_work()).abs() < 1e-12, "{scheme}, k = {degree}: {work}");
            assert!(residual < 1e-13, "{scheme}, k = {degree}: {residual}");
            // Of the order 2k in the step size: errors of (8 h)^2/24 of the impulse of the stress and less.
            let bound = [2e-3, 2e-6, 1e-9, 1e-12][degree - 1];
            assert!((impulse - exact_impulse()).abs() < bound, "{scheme}, k = {degree}: {impulse}");
        }
    }
}

/// In a homogeneous deformation both formulations have the same stress at any time, so all works agree.
#[test]
fn reactions_of_standard_rules_are_those_of_standard_cells() {
    let [projected, standard] = [PROJECTED, Formulation::Standard].map(|of| body(block(), of));
    for scheme in [TRAPEZOIDAL, fe(1), fe(3), at(fe(4), 2), at(lobatto(4), 3)] {
        let [own, other] = [&projected, &standard].map(|body| end_of(body, scheme, 0.01));
        assert!((own[0] - exact_work()).abs() < 0.03, "{scheme}: {}", own[0]);
        assert!((own[0] - other[0]).abs() < 1e-12 && (own[2] - other[2]).abs() < 1e-12, "{scheme}");
    }
}

#[test]
fn both_spaces_of_pressures_and_several_cells_have_the_same_work() {
    let cells = [
        (CellKind::Hex8, [1, 2, 1], None),
        (CellKind::Hex20, [1, 1, 1], Some(PressureSpace::Linear)),
        (CellKind::Hex27, [1, 2, 1], Some(PressureSpace::Linear)),
        (CellKind::Tet10, [1, 1, 1], Some(PressureSpace::Constant)),
    ];
    for (kind, n, space) in cells {
        let mesh = mapped(kind, n, |x| x).build().unwrap();
        let body = body(mesh, Formulation::ProjectedVolume(space));
        assert_eq!(body.n_free_dofs(), 0, "{kind}");
        let [work, residual, _] = end_of(&body, at(DGM, 2), 0.02);
        assert!((work - exact_work()).abs() < 1e-12 && residual < 1e-13, "{kind}: {work} {residual}");
    }
}

/// A driven cell with free ones beside it, which are apart and at rest, or move.
#[test]
fn a_driven_cell_among_free_cells_has_its_work() {
    let driven = |is_moving: bool, scheme: Scheme| {
        let mut builder = MeshBuilder::new();
        for shift in [0.0, 3.0] {
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1]];
            let mut nodes = Vec::new();
            for z in [0.0, 1.0] {
                for [x, y] in corners {
                    nodes.push(builder.point([f64::from(x) + shift, f64::from(y), z]));
                }
            }
            builder.cell(CellKind::Hex8, &nodes).unwrap();
        }
        builder.node_group("bottom", [0, 1, 4, 5]);
        builder.node_group("top", [2, 3, 6, 7]);
        let at_rest = || Some(TimeFunction::smooth("0", |_| [0.0; 3]));
        let moved = Some(TimeFunction::smooth("elongation", elongation));
        let body = Body::builder(builder.build().unwrap())
            .region(rubber(PROJECTED))
            .support(Support::fixed("bottom"))
            .support(Support::driven("top", [at_rest(), moved, at_rest()]))
            .build()
            .unwrap();
        assert_eq!(body.n_free_dofs(), 24);
        let spin = InitialVelocity {
            angular_velocity: [0.0, 0.0, 1.0],
            about: [3.5, 0.5, 0.5],
            gradient: [[0.4, 0.0, 0.0], [0.0, -0.2, 0.0], [0.0; 3]],
            ..Default::default()
        };
        let start = if is_moving { vec![spin] } else { vec![] };
        let state = State::initial(&body, 0.0, &start).unwrap();
        let mut motion = Motion::starting(&body, scheme, NewtonSettings::default(), state).unwrap();
        let mut residual = 0f64;
        (0..20).for_each(|_| residual = residual.max(motion.step(0.01).unwrap().energy_residual.abs()));
        (motion.record().external_work, residual)
    };
    for scheme in [DGM, at(DGM, 3), at(assumed_strain(8), 2)] {
        for is_moving in [false, true] {
            let (work, residual) = driven(is_moving, scheme);
            assert!((work - exact_work()).abs() < 1e-12, "{scheme} {is_moving}: {work}");
            assert!(residual < 1e-13, "{scheme} {is_moving}: {residual}");
        }
    }
}

/// Outer nodes driven, internal ones free: the modes vanish in a homogeneous deformation.
#[test]
fn free_incompatible_modes_do_not_change_the_work() {
    let body = body(block(), Formulation::IncompatibleModes);
    let [work, residual, impulse] = end_of(&body, at(DGM, 2), 0.01);
    assert!((work - exact_work()).abs() < 1e-12 && residual < 1e-13, "{work} {residual}");
    assert!((impulse - exact_impulse()).abs() < 2e-6, "{impulse}");
}

/// Steps of any size have the same work, because the scheme conserves energy.
#[test]
fn adaptive_steps_have_the_same_work() {
    let body = body(block(), PROJECTED);
    let plan = StepPlan::adaptive(0.0, END, Adaptivity::new(1e-3)).unwrap();
    let mut motion = Motion::new(&body, at(DGM, 2)).unwrap();
    motion.march(&plan, &mut []).unwrap();
    assert!((motion.record().external_work - exact_work()).abs() < 1e-12, "{:?}", motion.record());
}
