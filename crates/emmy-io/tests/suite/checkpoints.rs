//! Checkpoints of any number of ranks, read by any number of ranks.

use std::fs;
use std::path::Path;
use std::sync::{Arc, Mutex};

use emmy::body::{Body, BodyBuilder, Formulation, Load, PressureSpace, Region, Support};
use emmy::material::NeoHooke;
use emmy::mesh::{self, Mesh, Share};
use emmy::motion::{Adaptivity, Motion, NewtonSettings, Record, Snapshot, Solver, State, StepPlan};
use emmy::team::{Alone, Team, Threads};
use emmy::time::{Estimator, NewmarkFamily, Scheme, TimeElement};
use emmy_io::checkpoint::{self, Checkpoint, Checkpoints, Progress};
use emmy_io::input::{self, Overrides, Problem};

const STEP: f64 = 0.01;

/// A block that is held at one end and pulled at the other.
fn block() -> Mesh {
    mesh::block([1.0, 1.0, 2.0], [2, 2, 4]).unwrap()
}

fn with_parts(builder: BodyBuilder) -> Body {
    let rubber = NeoHooke::new(1000.0, 500.0).unwrap();
    let pull = Load::traction("z-max", [3.0, 5.0, 100.0]).over([(0.0, 0.0), (0.02, 1.0)]).unwrap();
    builder.region(Region::new(rubber, 2.0)).support(Support::fixed("z-min")).load(pull).build().unwrap()
}

/// The input of the same body, for the directory of a run and its identity.
fn problem(directory: &Path) -> Problem {
    let input = "mesh.box = { size = [1, 1, 2], cells = [2, 2, 4] }\n\
                 region = { density = 2.0, material.neo-hooke = { lambda = 1000.0, mu = 500.0 } }\n\
                 initial.velocity = [1, 0, 0]\n[time]\nscheme = 'DGM'\nsteps = [{ until = 1.0, size = 0.02 }]\n";
    let file = directory.join("block.toml");
    fs::write(&file, input).unwrap();
    let overrides = Overrides { output: Some(directory.join("run")), ..Overrides::default() };
    input::read(&file, &overrides).unwrap()
}

fn settings() -> NewtonSettings {
    NewtonSettings { solver: Solver::Iterative, ..NewtonSettings::default() }
}

/// Runs a function on every rank of a team; a team of one has the whole body.
fn on_ranks<T: Send>(size: usize, work: impl Fn(&Body, &Arc<dyn Team>) -> T + Sync) -> Vec<T> {
    let mesh = block();
    let owners = mesh::owners(&mesh, size).unwrap();
    let ranks = Threads::run(size, |team| {
        let builder = match size {
            1 => Body::builder(mesh.clone()),
            _ => Body::shared(Share::new(&mesh, &owners, team.rank()), team.clone()),
        };
        work(&with_parts(builder), &team)
    });
    ranks.unwrap()
}

/// A writer for each rank.
fn writers(directory: &Path, size: usize) -> Vec<Mutex<Checkpoints>> {
    let problem = problem(directory);
    (0..size).map(|_| Mutex::new(Checkpoints::new(&problem, None).unwrap())).collect()
}

fn write(writers: &[Mutex<Checkpoints>], rank: usize, motion: &Motion<'_>) -> std::io::Result<()> {
    let progress = Progress { frames: &[], history_checksum: 7, wall_seconds: 1.0, extremes: &[] };
    writers[rank].lock().unwrap().write(motion, progress, true)
}

fn steps(motion: &mut Motion<'_>, n: usize) -> Vec<Record> {
    (0..n).map(|_| motion.step(STEP).unwrap().clone()).collect()
}

/// Records and state at the end.
type End = (Vec<Record>, State);

/// Three steps, a checkpoint, and three further steps.
fn run_with_checkpoint(directory: &Path, scheme: Scheme, size: usize) -> Vec<End> {
    let writers = writers(directory, size);
    on_ranks(size, |body, team| {
        let mut motion = Motion::new(body, scheme).unwrap().newton(settings()).unwrap();
        steps(&mut motion, 3);
        write(&writers, team.rank(), &motion).unwrap();
        (steps(&mut motion, 3), motion.state().clone())
    })
}

/// The checkpoint of a directory for a body, and its motion.
fn read(directory: &Path, body: &Body, team: &dyn Team) -> Snapshot {
    let (checkpoint, note) = checkpoint::newest(&directory.join("run"), team).unwrap();
    assert_eq!((note, checkpoint.history_checksum), (None, 7));
    assert!(checkpoint.snapshot.state.displacement.is_empty());
    checkpoint.snapshot(body).unwrap()
}

/// The further steps after the checkpoint.
fn resumed(directory: &Path, scheme: Scheme, size: usize) -> Vec<End> {
    on_ranks(size, |body, team| {
        let snapshot = read(directory, body, &**team);
        let mut motion = Motion::resumed(body, scheme, settings(), snapshot).unwrap();
        (steps(&mut motion, 3), motion.state().clone())
    })
}

fn assert_near(own: &[Record], other: &[Record], name: &str) {
    let energy = |record: &Record| record.kinetic_energy + record.strain_energy;
    let largest = other.iter().map(energy).fold(0.0, f64::max);
    assert!(largest > 0.1, "{largest}");
    let numbers = |record: &Record| [record.kinetic_energy, record.strain_energy, record.total_energy];
    for (own, other) in own.iter().zip(other) {
        for (own, other) in numbers(own).into_iter().zip(numbers(other)) {
            assert!((own - other).abs() <= 1e-12 * largest, "{name}: {own} {other}");
        }
    }
}

#[test]
fn a_motion_of_three_ranks_continues_on_any_number_of_ranks() {
    let dgm = TimeElement::discrete_gradient(2).unwrap().into();
    let newmark = NewmarkFamily::Newmark { beta: 0.25, gamma: 0.5 }.into();
    for scheme in [dgm, newmark, Scheme::Bathe, Scheme::CentralDifferences] {
        let place = tempfile::tempdir().unwrap();
        let undisturbed = run_with_checkpoint(place.path(), scheme, 3);
        assert_eq!(resumed(place.path(), scheme, 3), undisturbed, "{scheme}");
        for size in [1, 2, 4] {
            for (records, _) in resumed(place.path(), scheme, size) {
                assert_near(&records, &undisturbed[0].0, &format!("{scheme} on {size} ranks"));
            }
        }
    }
}

/// The memory of the control has nodal vectors as well.
#[test]
fn adaptive_steps_continue_with_the_same_bits() {
    let scheme: Scheme = TimeElement::discrete_gradient(2).unwrap().into();
    let adaptivity = Adaptivity { estimator: Some(Estimator::Sampled), ..Adaptivity::new(1e-5) };
    let plan = StepPlan::adaptive(0.0, 0.2, adaptivity).unwrap();
    let place = tempfile::tempdir().unwrap();
    let writers = writers(place.path(), 3);
    let undisturbed = on_ranks(3, |body, team| {
        let mut motion = Motion::new(body, scheme).unwrap().newton(settings()).unwrap();
        (0..4).for_each(|_| assert!(motion.next_step(&plan, &mut []).unwrap().is_some()));
        write(&writers, team.rank(), &motion).unwrap();
        motion.march_on(&plan, &mut []).unwrap();
        (motion.record().clone(), motion.state().clone())
    });
    let continued = |size| {
        on_ranks(size, |body, team| {
            let snapshot = read(place.path(), body, &**team);
            let mut motion = Motion::resumed(body, scheme, settings(), snapshot).unwrap();
            motion.march_on(&plan, &mut []).unwrap();
            (motion.record().clone(), motion.state().clone())
        })
    };
    assert_eq!(continued(3), undisturbed);
    // Decisions may differ by the tolerance of the estimates.
    let (record, _) = &continued(2)[0];
    let energy = undisturbed[0].0.total_energy;
    assert!((record.total_energy - energy).abs() < 1e-3 * energy, "{record:?}");
}

#[test]
fn a_motion_moves_to_a_team_and_back() {
    let scheme: Scheme = TimeElement::discrete_gradient(1).unwrap().into();
    let place = tempfile::tempdir().unwrap();
    let alone = run_with_checkpoint(place.path(), scheme, 1);
    assert_eq!(resumed(place.path(), scheme, 1), alone);
    let writers = writers(place.path(), 2);
    on_ranks(2, |body, team| {
        let snapshot = read(place.path(), body, &**team);
        let mut motion = Motion::resumed(body, scheme, settings(), snapshot).unwrap();
        steps(&mut motion, 1);
        write(&writers, team.rank(), &motion).unwrap();
    });
    let back = on_ranks(1, |body, team| {
        let snapshot = read(place.path(), body, &**team);
        assert_eq!(snapshot.state.step, 4);
        let mut motion = Motion::resumed(body, scheme, settings(), snapshot).unwrap();
        steps(&mut motion, 2)
    });
    assert_near(&back[0], &alone[0].0[1..], "back on one rank");
}

#[test]
fn a_snapshot_is_that_of_the_motion() {
    let mesh = || mesh::block([1.0; 3], [2, 1, 1]).unwrap();
    for formulation in
        [Formulation::IncompatibleModes, Formulation::ProjectedVolume(Some(PressureSpace::Constant))]
    {
        let rubber = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0).with_formulation(formulation);
        let load = Load::traction("x-max", [3.0, 5.0, 40.0]);
        let body = Body::builder(mesh()).region(rubber).load(load).build().unwrap();
        let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2).unwrap()).unwrap();
        steps(&mut motion, 2);
        let place = tempfile::tempdir().unwrap();
        write(&writers(place.path(), 1), 0, &motion).unwrap();
        assert_eq!(read(place.path(), &body, &Alone), motion.snapshot());
        let (found, _) = checkpoint::newest(&place.path().join("run"), &Alone).unwrap();
        assert_eq!(found.complete().unwrap().snapshot, motion.snapshot());
        assert_eq!(found.state(&body).unwrap(), *motion.state());
        // A body without the modes takes the state at the nodes of the mesh.
        let plain = Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 2.0);
        let plain = Body::builder(mesh()).region(plain).build().unwrap();
        let state = found.state(&plain).unwrap();
        assert_eq!(state.velocity, motion.state().velocity[..plain.n_dofs()]);
        let larger = with_parts(Body::builder(block()));
        let error = found.snapshot(&larger).unwrap_err().to_string();
        assert!(error.contains("checkpoint has no numbers of"), "{error}");
        let identity = found.identity.clone();
        let in_memory = Checkpoint::of(identity, &motion);
        let again = checkpoint::parse(&checkpoint::bytes(&in_memory).unwrap()).unwrap();
        assert_eq!(again, in_memory);
    }
}

#[test]
fn a_damaged_block_is_named_on_all_ranks() {
    let place = tempfile::tempdir().unwrap();
    let scheme: Scheme = TimeElement::discrete_gradient(1).unwrap().into();
    run_with_checkpoint(place.path(), scheme, 3);
    let file = place.path().join("run/checkpoint/a.checkpoint");
    let whole = fs::read(&file).unwrap();
    let mut damaged = whole.clone();
    damaged[whole.len() - 20] ^= 1;
    fs::write(&file, &damaged).unwrap();
    for size in [1, 2, 4] {
        let messages = on_ranks(size, |_, team| {
            checkpoint::newest(&place.path().join("run"), &**team).unwrap_err().to_string()
        });
        for message in messages {
            assert!(message.contains("is damaged in block 3 of 3"), "{message}");
        }
    }
    fs::write(&file, &whole[..whole.len() - 8]).unwrap();
    let error = checkpoint::newest(&place.path().join("run"), &Alone).unwrap_err().to_string();
    assert!(error.contains("a.checkpoint is damaged;"), "{error}");
}

#[test]
fn a_rank_that_cannot_write_is_an_error_on_all() {
    let place = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let mut all = writers(place.path(), 3);
    all[1] = writers(elsewhere.path(), 1).pop().unwrap();
    let scheme: Scheme = TimeElement::discrete_gradient(1).unwrap().into();
    let errors = on_ranks(3, |body, team| {
        let motion = Motion::new(body, scheme).unwrap();
        write(&all, team.rank(), &motion).unwrap_err().to_string()
    });
    let missing = "No such file or directory";
    assert!(errors.iter().all(|error| error.contains(missing)), "{errors:?}");
    assert!(errors[0].contains("rank 1: ") && errors[2].contains("rank 1: "), "{errors:?}");
    let left = fs::read_dir(place.path().join("run/checkpoint")).unwrap().count();
    assert_eq!(left, 0);
    // The file cannot be created on rank 0.
    let all = writers(place.path(), 2);
    fs::create_dir(place.path().join("run/checkpoint/a.checkpoint.part")).unwrap();
    let errors = on_ranks(2, |body, team| {
        let motion = Motion::new(body, scheme).unwrap();
        write(&all, team.rank(), &motion).unwrap_err().to_string()
    });
    assert!(errors[0].contains("directory") && errors[1].contains("rank 0: "), "{errors:?}");
}
