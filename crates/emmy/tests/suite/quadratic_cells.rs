//! Forces per area, volume and mass at the nodes of quadratic cells, whose shape functions have negative integrals.

#![allow(non_snake_case)]

use emmy::body::{Body, BodyBuilder, Field, GroundAttraction, GroundSpring, LoadKind, PointTerms};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::{CellKind, Mesh};
use emmy::modes::modes;
use emmy::motion::{Motion, NewtonSettings, State};
use emmy::prelude::{Load, NeoHooke, Region, Support};
use emmy::time::Scheme;

use crate::shared::patch::Patch;
use crate::shared::plane_patch::plane_patch;
use crate::shared::schemes::{DGM, at};

const DENSITY: f64 = 1.3;
const G: f64 = 9.81;

fn rubber() -> Region {
    Region::new(NeoHooke::new(60.0, 20.0).unwrap(), DENSITY)
}

/// Every kind of cell of a solid or plane, in a patch with distorted and curved cells.
fn patches() -> impl Iterator<Item = (CellKind, Mesh)> {
    let patch = Patch { bricks: 2, curved: true, distortion: 1.0 };
    let solids = CellKind::SOLIDS.into_iter().map(move |kind| (kind, patch.mesh(kind)));
    solids.chain(CellKind::PLANES.into_iter().map(|kind| (kind, plane_patch(kind, 2))))
}

/// Down is -z, in a plane -y.
fn down(kind: CellKind, g: f64) -> [f64; 3] {
    if kind.dimension() == 2 { [0.0, -g, 0.0] } else { [0.0, 0.0, -g] }
}

/// A body after 0.2 units of time from rest in 200 steps, and its largest strain energy.
fn fallen(body: &Body, scheme: Scheme) -> (State, f64) {
    let settings = NewtonSettings { tolerance: 1e-12, ..Default::default() };
    let mut motion =
        Motion::starting(body, scheme, settings, State::initial(body, 0.0, &[]).unwrap()).unwrap();
    let mut strained = 0f64;
    for _ in 0..200 {
        strained = strained.max(motion.step(0.001).unwrap().strain_energy.abs());
    }
    (motion.state().clone(), strained)
}

/// The largest difference of a displacement from a fall by g t^2/2.
fn error(kind: CellKind, state: &State, g: f64) -> f64 {
    let fall = down(kind, 0.5 * g * 0.2 * 0.2);
    let errors = state.displacement.chunks(3).flat_map(|u| [0, 1, 2].map(|d| (u[d] - fall[d]).abs()));
    errors.fold(0.0, f64::max)
}

fn schemes() -> [Scheme; 3] {
    [Scheme::CentralDifferences, at(DGM, 1), "Newmark(0.25, 0.5)".parse().unwrap()]
}

/// Accelerations and body forces, constant or by a field, with the consistent and the lumped mass.
#[test]
fn weight_is_a_free_fall() {
    for (kind, mesh) in patches() {
        let field = |factor: f64| Field::new(move |_, _| down(kind, factor * G));
        let loads = [
            Load::acceleration(down(kind, G)),
            Load::new(LoadKind::AccelerationField { group: None, field: field(1.0) }),
            Load::new(LoadKind::BodyForceField { group: None, field: field(DENSITY) }),
        ];
        for (load, scheme) in loads.iter().flat_map(|load| schemes().map(|scheme| (load, scheme))) {
            let body = Body::builder(mesh.clone()).region(rubber()).load(load.clone()).build().unwrap();
            let (state, strained) = fallen(&body, scheme);
            let error = error(kind, &state, G);
            assert!(error < 1e-11 && strained < 1e-18, "{kind}, {scheme}, {load:?}: {error:e} {strained:e}");
        }
    }
}

/// A star that is far away: its attraction differs by 2e-5 over the body, which it neither tears nor strains.
#[test]
fn a_uniform_attraction_is_a_free_fall() {
    let distance = 1e5;
    for (kind, mesh) in patches() {
        let centre = down(kind, distance);
        let star = GroundAttraction { group: None, centre, strength: G * distance * distance };
        let terms = PointTerms { attractions: vec![star], ..Default::default() };
        let body = Body::builder(mesh).region(rubber()).point_terms(terms).build().unwrap();
        for scheme in schemes() {
            let error = error(kind, &fallen(&body, scheme).0, G);
            assert!(error < 1e-5, "{kind}, {scheme}: {error:e}");
        }
    }
}

/// A body that hangs in its equilibrium stays there, also with the lumped mass.
#[test]
fn an_equilibrium_under_weight_stays_at_rest() {
    let mesh = Patch { bricks: 1, curved: false, distortion: 0.0 }.mesh(CellKind::Hex20);
    let body = Body::builder(mesh)
        .region(rubber())
        .support(Support::fixed("z-max"))
        .load(Load::acceleration([0.0, 0.0, -G]))
        .build()
        .unwrap();
    let settings = NewtonSettings { tolerance: 1e-12, ..Default::default() };
    for scheme in schemes() {
        let equilibrium = Equilibrium::new(scheme.body(&body), 0.0, 2).unwrap();
        let start = equilibrium.start(settings, &[], &mut []).unwrap();
        let mut motion =
            Motion::starting(&body, scheme, settings, start).unwrap().with_static_reactions().unwrap();
        // m g, with the unit volume.
        assert!((motion.reactions()[0].force[2] - DENSITY * G).abs() < 1e-9, "{scheme}");
        for _ in 0..100 {
            assert!(motion.step(0.001).unwrap().kinetic_energy < 1e-16, "{scheme}");
        }
    }
}

/// A displacement along one axis at a point.
type Displacement<'a> = dyn Fn(&[f64; 3]) -> f64 + 'a;

/// A bed of springs is half of k times the integral of |u|^2, for a shift and a turn, and never negative.
#[test]
fn beds_of_springs_have_the_energy_of_their_area() {
    let (k, thickness) = (1000.0, 0.4);
    for kind in CellKind::SOLIDS.into_iter().chain(CellKind::PLANES) {
        let is_plane = kind.dimension() == 2;
        let (mesh, group) = match is_plane {
            true => (plane_patch(kind, 2), "y-min"),
            false => (Patch { bricks: 1, curved: false, distortion: 0.0 }.mesh(kind), "z-min"),
        };
        let area = if is_plane { thickness } else { 1.0 };
        let region = || rubber().with_thickness(thickness);
        let springs = vec![GroundSpring { group: group.into(), stiffness: k }];
        let terms = PointTerms { springs, ..Default::default() };
        let free = Body::builder(mesh.clone()).region(region()).build().unwrap();
        let body = Body::builder(mesh).region(region()).point_terms(terms).build().unwrap();
        // Fields u along one axis, with the mean of u^2 over 0 < x < 1, in a solid also 0 < y < 1.
        let shift = |_: &[f64; 3]| 1e-3;
        let lean = |X: &[f64; 3]| 1e-3 * (X[0] + if is_plane { 0.0 } else { 2.0 * X[1] });
        let mean_of_lean = if is_plane { 1.0 / 3.0 } else { 1.0 / 3.0 + 1.0 + 4.0 / 3.0 };
        let fields: [(&Displacement, f64); 2] = [(&shift, 1.0), (&lean, mean_of_lean)];
        for (field, mean) in fields {
            let of = |X: &[f64; 3]| if is_plane { [0.0, field(X), 0.0] } else { [0.0, 0.0, field(X)] };
            let u: Vec<f64> = body.mesh().points().iter().flat_map(of).collect();
            let energy = body.strain_energy(&u) - free.strain_energy(&u);
            let expected = 0.5 * k * area * mean * 1e-6;
            assert!((energy / expected - 1.0).abs() < 1e-10, "{kind}: {energy} {expected}");
        }
        for seed in 0..20 {
            let u: Vec<f64> =
                (0..body.n_dofs()).map(|dof| 1e-3 * ((dof * dof + seed) as f64 * 1.7).sin()).collect();
            let energy = body.strain_energy(&u) - free.strain_energy(&u);
            assert!(energy > 0.0, "{kind}, {seed}: {energy}");
        }
    }
}

/// A stiff unit cube on a bed of springs: it heaves and turns about the vertical with sqrt(k/m), and rocks while it
/// sways with the roots of a 2 x 2 problem.
#[test]
fn a_stiff_cube_heaves_and_rocks_on_its_bed() {
    let k = 1000.0;
    // About the centre of mass, half an edge above the bed: M = diag(m, m/6), K = k [[1, 1/2], [1/2, 1/4 + 1/12]].
    let (m, J) = (DENSITY, DENSITY / 6.0);
    let (sway, both, rock) = (k / m, 0.5 * k / (m * J).sqrt(), (0.25 + 1.0 / 12.0) * k / J);
    let (mean, half) = (0.5 * (sway + rock), (0.25 * (sway - rock).powi(2) + both * both).sqrt());
    let expected = [mean - half, mean - half, k / m, k / m, mean + half, mean + half].map(f64::sqrt);
    for kind in [CellKind::Hex20, CellKind::Wedge15, CellKind::Pyramid13, CellKind::Tet10, CellKind::Hex27] {
        let mesh = Patch { bricks: 1, curved: false, distortion: 0.0 }.mesh(kind);
        let stiff = Region::new(NeoHooke::new(6e9, 2e9).unwrap(), DENSITY);
        let springs = vec![GroundSpring { group: "z-min".into(), stiffness: k }];
        let terms = PointTerms { springs, ..Default::default() };
        let body = Body::builder(mesh).region(stiff).point_terms(terms).build().unwrap();
        for (mode, expected) in modes(&body, 6).unwrap().iter().zip(expected) {
            let error = mode.angular_frequency / expected - 1.0;
            assert!(error.abs() < 1e-5, "{kind}: {} is not {expected}", mode.angular_frequency);
        }
    }
}

/// A push, then no other force than a bed: the energies stay positive and what they were.
#[test]
fn a_cube_on_a_bed_is_stable() {
    for kind in [CellKind::Hex20, CellKind::Wedge15, CellKind::Pyramid13] {
        let mesh = Patch { bricks: 1, curved: false, distortion: 0.0 }.mesh(kind);
        let springs = vec![GroundSpring { group: "z-min".into(), stiffness: 1000.0 }];
        let terms = PointTerms { springs, ..Default::default() };
        let body: BodyBuilder = Body::builder(mesh).region(rubber()).point_terms(terms);
        let body = body.build().unwrap();
        let push = emmy::body::InitialVelocity {
            gradient: [[1e-4, 0.0, 0.0], [0.0; 3], [0.0; 3]],
            ..Default::default()
        };
        let start = State::initial(&body, 0.0, &[push]).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, 1), NewtonSettings::default(), start).unwrap();
        let first = motion.record().total_energy;
        for _ in 0..100 {
            let record = motion.step(0.001).unwrap();
            assert!(
                record.strain_energy >= 0.0 && record.kinetic_energy <= first * (1.0 + 1e-9),
                "{record:?}"
            );
        }
    }
}
