//! Meshes of other programs in motion: every kind of cell keeps its balances for 50 steps of DGM.

use std::path::{Path, PathBuf};

use emmy::body::{Body, InitialVelocity, Region, Support};
use emmy::material::NeoHooke;
use emmy::mesh::Mesh;
use emmy::motion::{Motion, NewtonSettings, Record, State};
use emmy::time::TimeElement;

const STEPS: usize = 50;

/// Marches with strains well above 1e-3 and checks the balances of every step against T + V and the momentum of the
/// body.
fn assert_balances(mesh: Mesh, supports: &[Support], degree: usize) {
    // Sizes of a mesh: its extent, and the time of a wave across it.
    let extent = |i: usize| {
        let x = mesh.points().iter().map(move |p| p[i]);
        x.clone().fold(f64::MIN, f64::max) - x.fold(f64::MAX, f64::min)
    };
    let length = extent(0).max(extent(1)).max(extent(2));
    let wave_speed = 1400f64.sqrt();
    let rubber = Region::new(NeoHooke::from_engineering(1000.0, 0.3).unwrap(), 1.0);
    let free = supports.is_empty();
    let body = Body::builder(mesh).region(rubber).supports(supports).build().unwrap();
    let rate = 0.3 * wave_speed / length;
    let field = InitialVelocity {
        angular_velocity: [0.3 * rate, 0.2 * rate, 0.5 * rate],
        gradient: [[0.3 * rate, 0.1 * rate, 0.0], [0.0, -0.2 * rate, 0.0], [0.1 * rate, 0.0, 0.1 * rate]],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[field]).unwrap();
    let mut motion = Motion::starting(
        &body,
        TimeElement::discrete_gradient(degree).unwrap(),
        NewtonSettings::default(),
        state,
    )
    .unwrap();
    let size = 0.05 * length / wave_speed;
    let momentum = norm(motion.record().angular_momentum);
    let (first, mut strained) = (motion.record().clone(), 0f64);
    for _ in 0..STEPS {
        let record = motion.step(size).unwrap();
        assert!(record.energy_residual.abs() < 1e-9 * record.total_energy, "{record:?}");
        assert!(record.angular_momentum_residual < 1e-9 * momentum, "{record:?}");
        assert!(record.linear_momentum_residual < 1e-9 * momentum / length, "{record:?}");
        strained = strained.max(mean_strain(record, &body));
        if free {
            let drift: Vec<f64> =
                (0..3).map(|i| record.angular_momentum[i] - first.angular_momentum[i]).collect();
            assert!(norm([drift[0], drift[1], drift[2]]) < 1e-9 * momentum);
        }
    }
    assert!(strained > 1e-3, "mean strain {strained:e}");
}

/// Uniform strain with the same energy: V = E/2 strain^2 volume.
fn mean_strain(record: &Record, body: &Body) -> f64 {
    let volume: f64 = body.regions().iter().map(|region| region.volume).sum();
    (2.0 * record.strain_energy / (1000.0 * volume)).sqrt()
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn read(path: &Path) -> Mesh {
    emmy_io::mesh::read(path).unwrap().mesh
}

fn own(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes").join(name)
}

#[test]
fn every_kind_of_cell_flies_free() {
    for kind in ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15", "mixed", "quadratic-mixed"] {
        for degree in [1, 2] {
            assert_balances(read(&own(&format!("{kind}-41-binary.msh"))), &[], degree);
        }
    }
}

#[test]
fn abaqus_meshes_fly_free() {
    for name in ["flat.inp", "quadratic.inp", "assembly.inp", "wedges.inp"] {
        assert_balances(read(&own(name)), &[], 1);
    }
}

#[test]
fn a_clamped_body_vibrates() {
    for kind in ["hex20", "tet10"] {
        let mesh = read(&own(&format!("{kind}-22-ascii.msh")));
        let group = mesh.groups().facets.keys().next().expect("the meshes have facet groups").clone();
        assert_balances(mesh, &[Support { group, fix: [true; 3], ..Default::default() }], 1);
    }
}

/// User meshes: `EMMY_MESHES=folder cargo test -p emmy-io --test suite flights:: -- --ignored`.
#[test]
#[ignore = "needs a folder of meshes in EMMY_MESHES; `.ci/run` and `just validate` give it `examples/meshes`"]
fn meshes_of_a_folder_fly_free() {
    let folder = std::env::var("EMMY_MESHES").expect("EMMY_MESHES names a folder");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    for path in files.filter(|path| path.extension().is_some_and(|e| e == "msh" || e == "inp" || e == "vtu"))
    {
        println!("{}", path.display());
        assert_balances(read(&path), &[], 1);
    }
}
