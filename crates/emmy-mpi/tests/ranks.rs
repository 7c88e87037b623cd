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

/// Runs a case on some ranks, which takes a second or two on idle cores. Ranks that wait for ever end after three
/// minutes.
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

/// The case that a rank of `mpirun` runs.
#[test]
#[ignore = "run by the other tests under mpirun"]
fn worker() {
    let case = env::var(CASE).expect("the tests set the case");
    if case == "groups" {
        return emmy_mpi::run_in_groups(2, |team| print_sums(&*team));
    }
    emmy_mpi::run(|team| match case.as_str() {
        "panic" if team.rank() == 1 => panic!("a fault of rank 1"),
        // With the hook of the program.
        "panic of the program" => {
            assert_eq!(emmy_cli::exit_code_on_team(["emmy-mpi", "sing"], team.clone()), 2);
            if team.rank() == 1 {
                panic!("a fault of rank 1");
            }
            team.sum("energy", &mut [0.0]);
        }
        "abort" if team.rank() == 1 => std::process::abort(),
        "mismatch" if team.rank() == 1 => team.largest("energy", &mut [0.0]),
        "early" if team.rank() == 1 => {}
        "thread" if team.rank() == 1 => {
            let other = team.clone();
            std::thread::spawn(move || other.sum("energy", &mut [0.0])).join().unwrap();
        }
        "panic" | "abort" | "mismatch" | "early" | "thread" => team.sum("energy", &mut [0.0]),
        #[cfg(feature = "petsc")]
        "engines" => petsc::worker(&team),
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

/// A sum and a largest number that depend on the order of the ranks.
fn sums(team: &dyn Team) -> [f64; 3] {
    let mut sum = [0.1 * (1.0 + team.rank() as f64), 1e16 / (3.0 + team.rank() as f64)];
    team.sum("sum", &mut sum);
    let mut most = [(1.0 + team.rank() as f64).sin()];
    team.largest("largest", &mut most);
    [sum[0], sum[1], most[0]]
}

fn print_sums(team: &dyn Team) {
    let sums = sums(team);
    for from in 0..team.size() {
        let mut others = if team.rank() == from { sums } else { [0.0; 3] };
        team.sum("numbers of one rank", &mut others);
        assert_eq!(others, sums);
    }
    if team.rank() == 0 {
        println!("sums {}", sums.map(|sum| format!("{:x}", sum.to_bits())).join(" "));
    }
}

/// Groups of two ranks, the last one with one or two.
#[test]
fn sums_in_groups_have_the_bits_of_threads() {
    for size in [3, 4] {
        let output = mpirun(size, "groups");
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
        let line = text.lines().find_map(|line| line.split_once("sums ")).unwrap().1;
        let threads = Threads::run_in_groups(2, size, |team| sums(&*team)).unwrap();
        assert_eq!(line.trim(), threads[0].map(|sum| format!("{:x}", sum.to_bits())).join(" "));
    }
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
        ("panic of the program", "emmy-mpi: rank 1: panicked; all ranks end"),
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

/// Solvers of PETSc.
#[cfg(feature = "petsc")]
mod petsc {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use emmy::team::{Engine, EngineKind, OwnRows, Parcel};

    use super::*;

    /// A body, the degree of its motion and its solver.
    #[derive(Clone, Copy)]
    struct Case {
        body: &'static str,
        degree: usize,
        solver: Solver,
    }

    const CASES: [Case; 10] = [
        Case { body: "soft", degree: 1, solver: Solver::Direct },
        Case { body: "soft", degree: 2, solver: Solver::Direct },
        Case { body: "soft", degree: 1, solver: Solver::Multigrid },
        Case { body: "soft", degree: 2, solver: Solver::Multigrid },
        Case { body: "quasi-rigid", degree: 1, solver: Solver::Direct },
        Case { body: "quasi-rigid", degree: 2, solver: Solver::Direct },
        Case { body: "quasi-rigid", degree: 1, solver: Solver::Multigrid },
        Case { body: "quasi-rigid", degree: 2, solver: Solver::Multigrid },
        // The body turns and bends: GAMG needs the rigid modes of each stiffness.
        Case { body: "quasi-rigid, long steps", degree: 2, solver: Solver::Multigrid },
        Case { body: "quasi-rigid, long steps", degree: 2, solver: Solver::Auto },
    ];

    impl Case {
        fn march(&self, builder: BodyBuilder) -> (Vec<Record>, String) {
            let body =
                parts(if self.body == "soft" { "soft" } else { "quasi-rigid" }, builder).build().unwrap();
            let (n_steps, size) = match self.body {
                "soft" => (3, 0.1),
                "quasi-rigid" => (2, 0.02),
                _ => (5, 0.1),
            };
            let spin = InitialVelocity { angular_velocity: [0.3, 0.5, 0.8], ..Default::default() };
            let state = State::initial(&body, 0.0, &[spin]).unwrap();
            let settings = NewtonSettings { solver: self.solver, ..Default::default() };
            let element = TimeElement::discrete_gradient(self.degree).unwrap();
            let mut motion = Motion::starting(&body, element, settings, state).unwrap();
            let records: Vec<Record> = (0..n_steps).map(|_| motion.step(size).unwrap().clone()).collect();
            let solver = records[records.len() - 1].solver.unwrap().to_string();
            (records, solver)
        }

        fn shared(&self, team: Arc<dyn Team>) -> (Vec<Record>, String) {
            let mesh = mesh::l_block(1.0).unwrap();
            let owners = owners(&mesh, team.size()).unwrap();
            self.march(Body::shared(Share::new(&mesh, &owners, team.rank()), team))
        }
    }

    /// A team that counts the applications of its engines before the first correction is complete.
    #[derive(Debug)]
    struct Counting {
        team: Arc<dyn Team>,
        applied: Arc<AtomicUsize>,
        first: AtomicUsize,
    }

    impl Team for Counting {
        fn size(&self) -> usize {
            self.team.size()
        }

        fn rank(&self) -> usize {
            self.team.rank()
        }

        fn sum(&self, name: &'static str, values: &mut [f64]) {
            self.team.sum(name, values);
        }

        fn largest(&self, name: &'static str, values: &mut [f64]) {
            self.team.largest(name, values);
        }

        fn exchange(&self, name: &'static str, parcels: &mut [Parcel]) {
            if name == "correction" && self.first.load(Ordering::Relaxed) == 0 {
                self.first.store(self.applied.load(Ordering::Relaxed), Ordering::Relaxed);
            }
            self.team.exchange(name, parcels);
        }

        fn engine(&self, kind: EngineKind) -> Option<Box<dyn Engine>> {
            let engine = self.team.engine(kind)?;
            Some(Box::new(Counted { engine, applied: self.applied.clone() }))
        }
    }

    #[derive(Debug)]
    struct Counted {
        engine: Box<dyn Engine>,
        applied: Arc<AtomicUsize>,
    }

    impl Engine for Counted {
        fn name(&self) -> &'static str {
            self.engine.name()
        }

        fn set(&mut self, rows: &OwnRows<'_>) -> Result<(), String> {
            self.engine.set(rows)
        }

        fn apply(&mut self, x: &mut [f64]) {
            self.applied.fetch_add(1, Ordering::Relaxed);
            self.engine.apply(x);
        }
    }

    /// Iterations of the first correction, which is solved to 1e-3, of a body that is nearly at rest, for Courant
    /// numbers 20, 80 and 320.
    fn iterations(team: &Arc<dyn Team>) -> [usize; 3] {
        let mesh = mesh::l_block(0.5).unwrap();
        let owners = owners(&mesh, team.size()).unwrap();
        [20.0, 80.0, 320.0].map(|courant| {
            let applied = Arc::default();
            let counting = Arc::new(Counting { team: team.clone(), applied, first: AtomicUsize::new(0) });
            let share = Share::new(&mesh, &owners, team.rank());
            let body = parts("soft", Body::shared(share, counting.clone())).build().unwrap();
            // The speed of pressure waves is that of (lambda + 2 mu)/rho = 2000/0.5.
            let size = courant * 0.5 / 4000.0f64.sqrt();
            let gradient = [[1e-6, 2e-6, 0.0], [0.0, -1e-6, 0.0], [3e-6, 0.0, 0.0]];
            let start = InitialVelocity { gradient, ..Default::default() };
            // After the loads.
            let state = State::initial(&body, 2.0, &[start]).unwrap();
            let settings = NewtonSettings { solver: Solver::Multigrid, ..Default::default() };
            let element = TimeElement::discrete_gradient(1).unwrap();
            Motion::starting(&body, element, settings, state).unwrap().step(size).unwrap();
            counting.first.load(Ordering::Relaxed)
        })
    }

    /// Computes all cases on a rank, one line each.
    pub(super) fn worker(team: &Arc<dyn Team>) {
        for case in CASES {
            let (records, solver) = case.shared(team.clone());
            let numbers: Vec<f64> = records.iter().flat_map(numbers).collect();
            let mut most = numbers.clone();
            team.largest("numbers", &mut most);
            assert_eq!(most, numbers);
            if team.rank() == 0 {
                let words: Vec<String> = numbers.iter().map(|x| format!("{:x}", x.to_bits())).collect();
                println!("\ncase {} | {solver}", words.join(" "));
            }
        }
        let counts = iterations(team);
        if team.rank() == 0 {
            println!("\niterations {counts:?}");
            let is_expected = |count: &usize| (usize::from(team.size() > 1)..=10).contains(count);
            assert!(counts.iter().all(is_expected), "GAMG takes {counts:?} iterations");
        }
    }

    /// Energies are those of the whole body to 1e-12; GAMG takes ten iterations at most.
    #[test]
    fn engines_compute_what_one_process_computes() {
        let whole = CASES.map(|case| {
            let solver = if case.solver == Solver::Auto { Solver::Auto } else { Solver::Direct };
            Case { solver, ..case }.march(Body::builder(mesh::l_block(1.0).unwrap())).0
        });
        for size in [1, 2, 4] {
            let output = mpirun(size, "engines");
            let text = String::from_utf8_lossy(&output.stdout);
            assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
            let lines: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("case ")).collect();
            assert_eq!(lines.len(), CASES.len());
            for ((case, whole), line) in CASES.iter().zip(&whole).zip(lines) {
                let (words, solver) = line.split_once(" | ").unwrap();
                let name = format!("{} of degree {} on {size}: {solver}", case.body, case.degree);
                let engine = if case.solver == Solver::Multigrid { "by GAMG" } else { "by MUMPS" };
                // One rank has the solvers of one process.
                assert_eq!(solver.contains(engine), size > 1, "{name}");
                let found: Vec<f64> = words
                    .split(' ')
                    .map(|word| f64::from_bits(u64::from_str_radix(word, 16).unwrap()))
                    .collect();
                let energy = whole.iter().map(|record| record.total_energy).fold(0.0, f64::max);
                let (found, _) = found.as_chunks::<12>();
                assert_eq!(found.len(), whole.len(), "{name}");
                for (found, whole) in found.iter().zip(whole) {
                    let expected = numbers_of(whole);
                    // Kinetic and strain energy, work.
                    for at in 1..4 {
                        let difference = (found[at] - expected[at]).abs() / energy;
                        assert!(difference < 1e-12, "{name}, number {at}: {difference:e}");
                    }
                }
            }
        }
    }
}
