//! Teams of processes against teams of threads and the whole body.
//!
//! The tests start `mpirun` on this very program, whose ignored test `worker` is what the ranks run.

use std::env;
use std::process::{Command, Output};
use std::sync::Arc;

use emmy::body::{Body, BodyBuilder, InitialVelocity, Load, Region};
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::mesh::{self, Share, owners};
use emmy::motion::{Adaptivity, Motion, NewtonSettings, Phase, Record, Solver, State, StepPlan};
use emmy::team::{Team, Threads};
use emmy::time::TimeElement;

/// Name of the variable with the case that `worker` runs.
const CASE: &str = "EMMY_MPI_CASE";

/// Runs a case on some ranks, which takes a second or two on idle cores. Ranks that wait for ever end after three minutes.
fn mpirun(size: usize, case: &str) -> Output {
    let program = env::current_exe().unwrap();
    Command::new("timeout")
        .args(["180", "mpirun", "-n", &size.to_string()])
        .arg(program)
        .args(["worker", "--exact", "--ignored", "--nocapture", "--test-threads=1"])
        .env(CASE, case)
        // Open MPI: as root in a container, and with more ranks than cores.
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("OMPI_MCA_rmaps_base_oversubscribe", "1")
        .env("OMPI_MCA_mpi_yield_when_idle", "1")
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .expect("mpirun starts")
}

/// What a rank of `mpirun` runs.
#[test]
#[ignore = "run by the other tests under mpirun"]
fn worker() {
    let case = env::var(CASE).expect("the tests set the case");
    emmy_mpi::run(|team| match case.as_str() {
        "panic" if team.rank() == 1 => panic!("a fault of rank 1"),
        "abort" if team.rank() == 1 => std::process::abort(),
        "mismatch" if team.rank() == 1 => team.largest("energy", &mut [0.0]),
        "early" if team.rank() == 1 => {}
        "thread" if team.rank() == 1 => {
            let other = team.clone();
            std::thread::spawn(move || other.sum("energy", &mut [0.0])).join().unwrap();
        }
        "panic" | "abort" | "mismatch" | "early" | "thread" => team.sum("energy", &mut [0.0]),
        motion => {
            let records = shared(motion, team.clone());
            let numbers: Vec<u64> = records.iter().flat_map(numbers).map(f64::to_bits).collect();
            // The same bits on all ranks: the largest number is that of each.
            for record in &records {
                let mut most = numbers_of(record);
                team.largest("numbers", &mut most);
                assert_eq!(most, numbers_of(record));
            }
            if team.rank() == 0 {
                let words: Vec<String> = numbers.iter().map(|bits| format!("{bits:x}")).collect();
                println!("records {}", words.join(" "));
            }
        }
    });
}

/// Energies, momenta and residuals of a record.
fn numbers(record: &Record) -> impl Iterator<Item = f64> {
    numbers_of(record).into_iter()
}

fn numbers_of(record: &Record) -> Vec<f64> {
    let Record { time, kinetic_energy, strain_energy, external_work, energy_residual, .. } = *record;
    let iterations = record.linear_iterations as f64;
    let scalars = [time, kinetic_energy, strain_energy, external_work, energy_residual, iterations];
    [&scalars[..], &record.linear_momentum, &record.angular_momentum].concat()
}

/// The paper's block with its load: soft, nearly rigid, or with steps that are chosen.
fn parts(case: &str, builder: BodyBuilder) -> BodyBuilder {
    let loads = [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| {
        let traction = [256.0, 512.0, 768.0].map(|t| sign * t / 9.0);
        Load::traction(group, traction).over([(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]).unwrap()
    });
    let region = match case {
        "quasi-rigid" => Region::new(SaintVenantKirchhoff::from_engineering(1e7, 0.3).unwrap(), 1.0),
        _ => Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 0.5),
    };
    builder.region(region).loads(loads)
}

fn march(case: &str, builder: BodyBuilder) -> Vec<Record> {
    let body = parts(case, builder).build().unwrap();
    let (degree, plan) = match case {
        "quasi-rigid" => (1, StepPlan::new(0.0, vec![Phase { until: 0.04, size: 0.02 }])),
        "adaptive" => (2, StepPlan::adaptive(0.0, 0.2, Adaptivity::new(1e-4))),
        _ => (2, StepPlan::new(0.0, vec![Phase { until: 0.3, size: 0.1 }])),
    };
    let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
    let state = State::initial(&body, 0.0, &[spin]).unwrap();
    let settings = NewtonSettings { solver: Solver::Iterative, ..Default::default() };
    let element = TimeElement::discrete_gradient(degree).unwrap();
    let mut motion = Motion::starting(&body, element, settings, state).unwrap();
    let plan = plan.unwrap();
    let mut records = vec![motion.record().clone()];
    while let Some(record) = motion.next_step(&plan, &mut []).unwrap() {
        records.push(record.clone());
    }
    records
}

fn shared(case: &str, team: Arc<dyn Team>) -> Vec<Record> {
    let mesh = mesh::l_block(1.0).unwrap();
    let owners = owners(&mesh, team.size()).unwrap();
    march(case, Body::shared(Share::new(&mesh, &owners, team.rank()), team))
}

/// Processes have the bits of threads, and the energies and momenta of the whole body to 1e-12.
#[test]
fn processes_compute_what_threads_compute() {
    for case in ["soft", "quasi-rigid", "adaptive"] {
        let whole = march(case, Body::builder(mesh::l_block(1.0).unwrap()));
        let energy = whole.iter().map(|record| record.total_energy).fold(0.0, f64::max);
        for size in 1..=4 {
            let output = mpirun(size, case);
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
            let line = text.lines().find_map(|line| line.split_once("records ")).unwrap().1;
            let processes: Vec<u64> =
                line.split(' ').map(|word| u64::from_str_radix(word.trim(), 16).unwrap()).collect();
            let threads = Threads::run(size, |team| shared(case, team)).unwrap();
            let of_threads: Vec<u64> = threads[0].iter().flat_map(numbers).map(f64::to_bits).collect();
            assert!(processes == of_threads, "{case} on {size} processes is not what it is on threads");
            assert_eq!(threads[0].len(), whole.len(), "{case} on {size}");
            if case != "adaptive" {
                for (own, other) in threads[0].iter().zip(&whole) {
                    let difference = (own.total_energy - other.total_energy).abs() / energy;
                    assert!(difference < 1e-12, "{case} on {size}: {difference:e}");
                    for d in 0..3 {
                        let difference = own.angular_momentum[d] - other.angular_momentum[d];
                        assert!(difference.abs() < 1e-12 * 10.0 * energy, "{case} on {size}: {difference:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_rank_that_fails_ends_all() {
    for (case, message) in [
        ("panic", "emmy-mpi: rank 1: panicked; all ranks end"),
        ("mismatch", "at the largest \"energy\" of 1; rank 0 is at another call"),
        ("abort", ""),
        ("early", "at the end \"of the program\" of 0; rank 0 is at another call"),
        ("thread", "a call of a team in another thread than that of `run`"),
    ] {
        let output = mpirun(3, case);
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success() && output.status.code() != Some(124), "{case}: {text}");
        assert!(text.contains(message), "{case}: {text}");
    }
}
