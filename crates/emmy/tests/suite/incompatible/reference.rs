//! Patch test, and the numbers of independent implementations: `reference.py`, and for Cook's membrane `mixed.json`.

use emmy::body::{Body, Formulation, Load, LoadKind, Support};
use emmy::equilibrium::Equilibrium;
use emmy::internals::average::{Request, Rule};
use emmy::internals::body::{StepDamping, StepInput};
use emmy::internals::quadrature::gauss;
use emmy::material::{NeoHookeIsochoric, Volumetric};
use emmy::mesh::{CellKind, Facet, Mesh, MeshBuilder};
use emmy::motion::{Motion, NewtonSettings, State};
use emmy::time::TimeElement;

use super::{close, distorted_pair, of_mesh, pair, rubber, spin, with_modes};
use crate::shared::patch::Patch;
use crate::shared::plane_patch::plane_patch;

/// Stage forces of a step, `[k][n_nodes][3]`, and their derivatives times a direction.
fn forces(body: &Body, rule: &Rule, u: &[f64], x: &[f64], direction: &[f64]) -> [Vec<f64>; 2] {
    let step = StepInput {
        rule,
        tangent_factor: 1.0,
        displacement: u,
        rates: x,
        coordinates: &[],
        damping: StepDamping::default(),
        local: None,
    };
    let (mut force, mut product) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    let mut assembly = body.assembly(step.rule);
    let no_mass = vec![0.0; rule.degree() * rule.degree()];
    body.assemble(&step, Request::Tangent, &no_mass, &mut assembly).unwrap();
    assembly.matrix.copy_force(&mut force);
    assembly.matrix.multiply(body.pattern(), direction, &mut product);
    [force, product]
}

/// The nodal field of a body whose internal nodes are at the mean over their cell plus the same vector for each mode.
fn with_means(body: &Body, of_mesh: Vec<f64>, mode: f64) -> Vec<f64> {
    let mut field = of_mesh;
    for cell in body.mesh().cells() {
        let mean = |d: usize| {
            cell.nodes.iter().map(|&node| field[3 * node as usize + d]).sum::<f64>() / cell.nodes.len() as f64
        };
        let own = [0, 1, 2].map(|d| mean(d) + mode);
        (0..cell.kind.info().n_modes).for_each(|_| field.extend(own));
    }
    field
}

/// A vector by the unknowns (q, a) from the vector by the positions (q, y) of all nodes: the force on a mode belongs to
/// the corners too, in equal parts.
fn by_modes(body: &Body, vector: &mut [f64]) {
    let mut internal = of_mesh(body);
    for cell in body.mesh().cells() {
        for _ in 0..cell.kind.info().n_modes {
            for (&node, d) in cell.nodes.iter().flat_map(|node| (0..3).map(move |d| (node, d))) {
                vector[3 * node as usize + d] += vector[internal + d] / cell.nodes.len() as f64;
            }
            internal += 3;
        }
    }
}

#[test]
fn stage_forces_and_tangent_agree_with_the_reference() {
    let body = pair();
    let rule = Rule::discrete_gradient(2);
    let g = |s: f64| -> Vec<f64> {
        let at = |[X, Y, Z]: [f64; 3]| {
            [
                0.06 * (1.0 + s + 2.0 * X - Y + 0.5 * Z).sin(),
                0.05 * (0.7 * s + X + 1.5 * Y - Z).cos(),
                0.04 * (2.0 * s - X + Y + 2.0 * Z).sin(),
            ]
        };
        body.mesh().points().iter().flat_map(|&X| at(X)).collect()
    };
    let u = with_means(&body, g(0.0), 0.0);
    let mut x = Vec::new();
    let mut direction = Vec::new();
    for i in [1.0, 2.0] {
        x.extend(with_means(&body, g(i).iter().map(|g| 1.5 * g).collect(), 0.02 * i));
        let own = body.mesh().points().iter().flatten().map(|X| i * X).collect();
        direction.extend(with_means(&body, own, 0.0));
    }
    let mut results = forces(&body, &rule, &u, &x, &direction);
    let expected = [
        [
            [-1.8885763104060396, -0.8730927499613339, 0.08431720485934296],
            [-1.420567654417621, -0.6780195571337153, 0.052622189832380206],
        ],
        [
            [5.207968400357531, 4.649053036235862, 3.4393834978395836],
            [30.986886876735635, 30.737510552342563, 22.009905864613838],
        ],
    ];
    let probe = 3 * body.mesh().nearest_node([2.0909297426825684, 1.15, 0.9]);
    // The tangent of `reference.py` is a difference quotient.
    for ((result, expected), tolerance) in results.iter_mut().zip(expected).zip([1e-13, 1e-9]) {
        for (stage, expected) in result.chunks_exact_mut(body.n_dofs()).zip(expected) {
            by_modes(&body, stage);
            close("at the probe", &stage[probe..probe + 3], &expected, tolerance);
        }
    }
    for (stage, norm) in results[0].chunks_exact(body.n_dofs()).zip([8.138669519192705, 12.88019434943831]) {
        let of_corners = stage[..of_mesh(&body)].iter().map(|f| f * f).sum::<f64>();
        close("norm", &[of_corners.sqrt()], &[norm], 1e-13);
    }
    let end: Vec<f64> = (0..u.len())
        .map(|dof| u[dof] + (0..2).map(|i| rule.weights()[i] * x[i * u.len() + dof]).sum::<f64>())
        .collect();
    let energies = [body.strain_energy(&u), body.strain_energy(&end)];
    close("energies", &energies, &[0.4785651008389912, 2.1815990172402415], 1e-12);
    // The mean-value property of the rule, modes included.
    let force = &forces(&body, &rule, &u, &x, &direction)[0];
    let stages = force.chunks_exact(u.len()).zip(x.chunks_exact(u.len())).zip(rule.weights());
    let work: f64 = stages.map(|((f, x), b)| b * f.iter().zip(x).map(|(f, x)| f * x).sum::<f64>()).sum();
    close("work", &[work], &[1.703033916401249], 1e-12);
}

#[test]
fn a_spinning_pair_agrees_with_the_reference() {
    let body = pair();
    let state = State::initial(&body, 0.0, &[spin()]).unwrap();
    let settings = NewtonSettings { tolerance: 1e-14, ..NewtonSettings::default() };
    let mut motion =
        Motion::starting(&body, TimeElement::discrete_gradient(1).unwrap(), settings, state).unwrap();
    (0..16).for_each(|_| _ = motion.step(0.025).unwrap());
    let (record, state) = (motion.record(), motion.state());
    let node = body.mesh().nearest_node([2.0909297426825684, 1.15, 0.9]);
    let probe = [2.0097414862117717, 1.6118528907401632, 0.6254938361503131];
    close("probe", &state.position(&body, node), &probe, 1e-12);
    close("kinetic energy", &[record.kinetic_energy], &[0.9337033736452283], 1e-12);
    close("strain energy", &[record.strain_energy], &[0.04208470161633968], 1e-11);
    let angular_momentum = [-0.9053466814840443, 1.5198271948674635, 1.5833722747870171];
    close("angular momentum", &record.angular_momentum, &angular_momentum, 1e-13);
    let linear_momentum = [0.4533047276696662, 1.1248535076511454, -0.8689335094727838];
    close("linear momentum", &record.linear_momentum, &linear_momentum, 1e-13);
}

/// Cook's membrane in plane strain with 8 x 8 cells, K/mu = 5000, a vertical force of 100.
#[test]
fn cooks_membrane_agrees_with_the_reference() {
    let m = 8;
    let mut builder = MeshBuilder::new();
    for at in 0..(m + 1) * (m + 1) {
        let [s, t] = [at % (m + 1), at / (m + 1)].map(|i| f64::from(i) / f64::from(m));
        builder.point([48.0 * s, 44.0 * s + t * (44.0 - 28.0 * s), 0.0]);
    }
    for at in 0..m * m {
        let first = at / m * (m + 1) + at % m;
        builder.cell(CellKind::Quad4, &[first, first + 1, first + m + 2, first + m + 1]).unwrap();
    }
    builder.node_group("wall", (0..=m).map(|row| row * (m + 1)));
    let end: Vec<Facet> = (1..=m).map(|row| Facet { cell: row * m - 1, local: 1 }).collect();
    builder.facet_group("end", end);
    let material = NeoHookeIsochoric::new(80.1938, 400942.0, Volumetric::Quadratic).unwrap();
    let body = Body::builder(builder.build().unwrap())
        .region(with_modes(material, 1.0))
        .support(Support::fixed("wall"))
        .load(Load::force("end", [0.0, 100.0, 0.0]))
        .build()
        .unwrap();
    let settings = NewtonSettings { tolerance: 1e-12, ..NewtonSettings::default() };
    let state = Equilibrium::new(&body, 0.0, 5).unwrap().start(settings, &[], &mut []).unwrap();
    let tip = 3 * body.mesh().nearest_node([48.0, 60.0, 0.0]);
    let displacement = [-5.508395143261438, 6.6718724297961245, 0.0];
    close("tip", &state.displacement[tip..tip + 3], &displacement, 1e-8);
    close("strain energy", &[body.strain_energy(&state.displacement)], &[323.92644391916406], 1e-8);
}

/// A homogeneous deformation of distorted cells leaves the modes at zero, and has the forces and the energy of the
/// standard cell.
#[test]
fn patches_deform_homogeneously_without_modes() {
    let H = [[0.1, 0.05, -0.02], [-0.03, 0.2, 0.04], [0.06, -0.01, -0.15]];
    let meshes: [(Mesh, usize); 3] = [
        (Patch { bricks: 2, curved: false, distortion: 1.0 }.mesh(CellKind::Hex8), 3),
        (distorted_pair(CellKind::Hex8), 3),
        (plane_patch(CellKind::Quad4, 2), 2),
    ];
    for (mesh, dimension) in meshes {
        let u = |X: &[f64; 3]| {
            [0, 1, 2].map(|i| if i < dimension { (0..dimension).map(|j| H[i][j] * X[j]).sum() } else { 0.0 })
        };
        let displacement: Vec<f64> = mesh.points().iter().flat_map(u).collect();
        let standard = Body::builder(mesh.clone()).region(rubber().with_formulation(Formulation::Standard));
        let standard = standard.build().unwrap();
        let body = Body::builder(mesh).region(rubber()).build().unwrap();
        let with_modes = with_means(&body, displacement.clone(), 0.0);
        assert_eq!(State::displaced(&body, 0.0, displacement.clone(), &[]).unwrap().displacement, with_modes);
        let rule = Rule::standard(1, &gauss(1));
        let force = |body: &Body, u: &[f64]| {
            let rest = vec![0.0; u.len()];
            forces(body, &rule, u, &rest, &rest)[0].clone()
        };
        let (own, expected) = (force(&body, &with_modes), force(&standard, &displacement));
        for (dof, f) in own.iter().enumerate().filter(|(dof, _)| dimension == 3 || dof % 3 < 2) {
            let expected = expected.get(dof).copied().unwrap_or(0.0);
            assert!((f - expected).abs() < 1e-11, "{f} is not {expected} at {dof}");
        }
        let [own, expected] = [body.strain_energy(&with_modes), standard.strain_energy(&displacement)];
        assert!((own - expected).abs() < 1e-13 * expected);
    }
}

/// Modes soften a cell but leave its stiffness definite: no deformation but the rigid motions is without force.
#[test]
fn a_single_cell_has_six_rigid_modes_alone() {
    let body = Body::builder(emmy::mesh::block([1.0; 3], [1; 3]).unwrap()).region(rubber()).build().unwrap();
    let modes = emmy::modes::modes(&body, 24).unwrap();
    assert_eq!(modes.iter().filter(|mode| mode.angular_frequency == 0.0).count(), 6);
    assert!(modes.iter().all(|mode| mode.angular_frequency >= 0.0));
    assert!(emmy::modes::modes(&body, 25).is_err(), "modes of the cell have no mass, so no frequency");
}

#[test]
fn loads_and_groups_are_of_the_nodes_of_the_mesh() {
    let mesh = emmy::mesh::block([1.0; 3], [2; 3]).unwrap();
    let body = Body::builder(mesh)
        .region(rubber())
        .load(Load::acceleration([0.0, 0.0, -3.0]))
        .load(Load::pressure("z-max", 2.0))
        .build()
        .unwrap();
    let mut force = vec![1.0; body.n_dofs()];
    assert!(body.loads_at(0.0, &mut force).unwrap());
    assert!(force[of_mesh(&body)..].iter().all(|f| *f == 0.0));
    assert!((force.iter().sum::<f64>() + 6.0).abs() < 1e-13);
    let pressure = LoadKind::Pressure { group: "z-max".into(), pressure: 2.0 };
    assert!(
        matches!(pressure, LoadKind::Pressure { .. })
            && (body.load_resultants()[1].force[2] + 2.0).abs() < 1e-14
    );
    assert!((body.lumped_mass().iter().sum::<f64>() - 2.0).abs() < 1e-14);
}
