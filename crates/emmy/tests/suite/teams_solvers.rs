//! Linear solvers whose rows a team shares, against the whole body on one rank.

use std::sync::Arc;

use emmy::Result;
use emmy::body::{Body, BodyBuilder, InitialVelocity, Load, Region, Support};
use emmy::internals::sparse::inverse;
use emmy::material::{NeoHooke, SaintVenantKirchhoff};
use emmy::mesh::{self, Share};
use emmy::motion::{Motion, NewtonSettings, Record, Solver, State};
use emmy::team::{Engine, EngineKind, OwnRows, Parcel, Team, Threads};

use crate::shared::schemes::{DGM, at};

/// A team of threads with engines: the inverse of the whole matrix, and of its diagonal blocks.
#[derive(Debug)]
struct WithEngines {
    team: Arc<dyn Team>,
    /// A kind that fails, and where.
    fails: Option<(EngineKind, Place)>,
}

/// A method of an engine.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Set,
    Apply,
}

impl Team for WithEngines {
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
        self.team.exchange(name, parcels);
    }

    fn engine(&self, kind: EngineKind) -> Option<Box<dyn Engine>> {
        let fails = self.fails.filter(|(own, _)| *own == kind).map(|(_, place)| place);
        Some(Box::new(Dense { team: self.team.clone(), kind, fails, first: 0, inverse: Vec::new() }))
    }
}

/// The inverse of a matrix, or of its diagonal blocks, whole on every rank.
#[derive(Debug)]
struct Dense {
    team: Arc<dyn Team>,
    kind: EngineKind,
    fails: Option<Place>,
    first: usize,
    inverse: Vec<f64>,
}

impl Engine for Dense {
    fn name(&self) -> &'static str {
        match self.kind {
            EngineKind::Factorization => "an inverse",
            EngineKind::Multigrid => "inverse blocks",
        }
    }

    fn set(&mut self, rows: &OwnRows<'_>) -> std::result::Result<(), String> {
        if self.fails == Some(Place::Set) {
            return Err("no inverse".to_string());
        }
        let n = 3 * rows.n_of_ranks;
        let n_own = rows.begin.len() - 1;
        assert_eq!((rows.columns.len(), rows.positions.len()), (rows.begin[n_own], 3 * n_own));
        let mut whole = vec![0.0; n * n];
        for row in 0..n_own {
            for position in rows.begin[row]..rows.begin[row + 1] {
                let column = rows.columns[position];
                let is_wanted = self.kind == EngineKind::Factorization || column == rows.first + row;
                for (at, entry) in rows.blocks[9 * position..9 * position + 9].iter().enumerate() {
                    let to = (3 * (rows.first + row) + at / 3) * n + 3 * column + at % 3;
                    whole[to] = if is_wanted { *entry } else { 0.0 };
                }
            }
        }
        self.team.sum("matrix", &mut whole);
        // Rows and columns of other ranks fit each other.
        let size = whole.iter().fold(0.0, |most: f64, entry| most.max(entry.abs()));
        assert!((0..n * n).all(|at| (whole[at] - whole[at % n * n + at / n]).abs() < 1e-12 * size));
        self.first = rows.first;
        self.inverse = inverse(&whole);
        Ok(())
    }

    fn apply(&mut self, x: &mut [f64]) {
        let n = self.inverse.len().isqrt();
        let mut whole = vec![0.0; n];
        whole[3 * self.first..][..x.len()].copy_from_slice(x);
        self.team.sum("vector", &mut whole);
        for (x, row) in x.iter_mut().zip(self.inverse.chunks_exact(n).skip(3 * self.first)) {
            *x = row.iter().zip(&whole).map(|(a, x)| a * x).sum();
        }
        if self.fails == Some(Place::Apply) {
            x.fill(f64::NAN);
        }
    }
}

/// A rod on a plane of symmetry that is pulled at its end and spins about its axis.
#[derive(Clone, Copy)]
struct Rod {
    stiff: bool,
    degree: usize,
    solver: Solver,
    exact_tangent: bool,
}

const ROD: Rod = Rod { stiff: false, degree: 1, solver: Solver::Direct, exact_tangent: false };

impl Rod {
    fn mesh() -> mesh::Mesh {
        mesh::block([1.0, 1.0, 2.0], [2, 2, 4]).unwrap()
    }

    fn march(&self, builder: BodyBuilder) -> Result<Vec<Record>> {
        let region = match self.stiff {
            true => Region::new(SaintVenantKirchhoff::from_engineering(1e7, 0.3)?, 1.0),
            false => Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0),
        };
        let load = Load::traction("z-max", [10.0, 0.0, 30.0]).over([(0.0, 0.0), (0.1, 1.0)])?;
        let body = builder.region(region).support(Support::symmetry("z-min")).load(load).build()?;
        let spin = InitialVelocity { angular_velocity: [0.0, 0.0, 3.0], ..Default::default() };
        let settings =
            NewtonSettings { solver: self.solver, exact_tangent: self.exact_tangent, ..Default::default() };
        let state = State::initial(&body, 0.0, &[spin])?;
        let mut motion = Motion::starting(&body, at(DGM, self.degree), settings, state)?;
        (0..3).map(|_| motion.step(0.02).cloned()).collect()
    }

    /// The records of all ranks.
    fn on_ranks(&self, size: usize, engines: bool, fails: Option<(EngineKind, Place)>) -> Vec<Record> {
        let mesh = Rod::mesh();
        let owners = mesh::owners(&mesh, size).unwrap();
        let ranks = Threads::run(size, |team| {
            let team: Arc<dyn Team> = if engines { Arc::new(WithEngines { team, fails }) } else { team };
            self.march(Body::shared(Share::new(&mesh, &owners, team.rank()), team))
        });
        let mut ranks: Vec<Vec<Record>> = ranks.unwrap().into_iter().collect::<Result<_>>().unwrap();
        assert!(ranks.iter().all(|records| *records == ranks[0]));
        ranks.swap_remove(0)
    }

    /// Compares the energies with those of the whole body; returns the records.
    fn assert_equal(&self, size: usize, engines: bool, fails: Option<(EngineKind, Place)>) -> Vec<Record> {
        let whole = Rod { solver: Solver::Direct, ..*self }.march(Body::builder(Rod::mesh())).unwrap();
        let energy = whole.iter().map(|record| record.total_energy).fold(0.0, f64::max);
        let records = self.on_ranks(size, engines, fails);
        for (own, other) in records.iter().zip(&whole) {
            let numbers = |r: &Record| [r.kinetic_energy, r.strain_energy, r.external_work];
            for (own_number, number) in numbers(own).into_iter().zip(numbers(other)) {
                let difference = (own_number - number).abs() / energy;
                assert!(difference < 1e-12, "step {} on {size} ranks: {difference:e}", own.step);
            }
        }
        records
    }
}

fn name(records: &[Record]) -> String {
    records[records.len() - 1].solver.unwrap().to_string()
}

#[test]
fn a_factorisation_by_an_engine_is_that_of_the_whole_body() {
    for (stiff, degree, size) in [(false, 1, 2), (true, 1, 3), (true, 2, 2)] {
        let records = Rod { stiff, degree, ..ROD }.assert_equal(size, true, None);
        assert!(name(&records).starts_with("Cholesky factorisation by an inverse (stiffness number "));
        // The factorisation is exact, so real modes need one iteration a correction.
        let is_exact = |record: &Record| record.linear_iterations == record.newton_iterations;
        assert!(degree > 1 || records.iter().all(is_exact));
    }
}

#[test]
fn cycles_by_an_engine_and_within_ranks_are_those_of_the_whole_body() {
    for degree in 1..=2 {
        let rod = Rod { degree, solver: Solver::Multigrid, ..ROD };
        let records = rod.assert_equal(2, true, None);
        assert!(name(&records).starts_with("conjugate gradients with multigrid by inverse blocks (stiff"));
        let records = rod.assert_equal(3, false, None);
        assert!(name(&records).starts_with("conjugate gradients with multigrid (stiffness number "));
    }
}

/// A soft body needs no engine, a stiff one the factorisation, and if that fails the cycles.
#[test]
fn the_choice_of_a_team_falls_back() {
    let auto = Rod { solver: Solver::Auto, ..ROD };
    assert!(name(&auto.assert_equal(2, true, None)).contains("incomplete Cholesky factors (stiff"));
    let stiff = Rod { stiff: true, ..auto };
    assert!(name(&stiff.assert_equal(2, true, None)).contains("factorisation by an inverse"));
    for place in [Place::Set, Place::Apply] {
        let records = stiff.assert_equal(2, true, Some((EngineKind::Factorization, place)));
        assert!(name(&records).contains("multigrid by inverse blocks"));
    }
    let records = stiff.assert_equal(2, true, Some((EngineKind::Multigrid, Place::Set)));
    assert!(name(&records).contains("factorisation by an inverse"));
    assert!(name(&stiff.on_ranks(2, false, None)).contains("incomplete Cholesky factors (stiff"));
}

/// A failing engine without a choice is an error of all ranks.
#[test]
fn an_engine_that_fails_is_named() {
    let (mesh, rod) = (Rod::mesh(), Rod { stiff: true, ..ROD });
    let owners = mesh::owners(&mesh, 2).unwrap();
    let errors = Threads::run(2, |team| {
        let share = Share::new(&mesh, &owners, team.rank());
        let team = Arc::new(WithEngines { team, fails: Some((EngineKind::Factorization, Place::Set)) });
        let error = rod.march(Body::shared(share, team)).unwrap_err();
        std::error::Error::source(&error).unwrap().to_string()
    });
    let errors = errors.unwrap();
    assert!(
        errors[0] == errors[1] && errors[0].contains("linear solver: an inverse: no inverse"),
        "{errors:?}"
    );
}

/// Classical Gram-Schmidt of a team spans the same Krylov space as the modified one.
#[test]
fn gmres_with_an_engine_is_that_of_the_whole_body() {
    Rod { degree: 2, exact_tangent: true, ..ROD }.assert_equal(2, true, None);
}

/// An incomplete factor on each rank loses the couplings between ranks: at the Courant number 20, at most half as many
/// iterations more than with one factor of the whole matrix, to the same accuracy.
#[test]
fn factors_of_ranks_need_few_more_iterations() {
    let mesh = mesh::l_block(0.25).unwrap();
    let iterations = |builder: BodyBuilder| -> Result<usize> {
        let body = builder.region(Region::new(NeoHooke::new(1000.0, 500.0)?, 0.5)).build()?;
        let gradient = [[1e-6, 2e-6, 0.0], [0.0, -1e-6, 0.0], [3e-6, 0.0, 0.0]];
        let start = InitialVelocity { gradient, ..Default::default() };
        let settings = NewtonSettings { tolerance: 1e-13, solver: Solver::Iterative, ..Default::default() };
        let state = State::initial(&body, 0.0, &[start])?;
        // The speed of pressure waves is that of (lambda + 2 mu)/rho = 2000/0.5.
        let size = 20.0 * 0.25 / 4000.0f64.sqrt();
        let mut motion = Motion::starting(&body, at(DGM, 1), settings, state)?;
        Ok(motion.step(size)?.linear_iterations)
    };
    let whole = iterations(Body::builder(mesh.clone())).unwrap();
    for size in [2, 4] {
        let owners = mesh::owners(&mesh, size).unwrap();
        let ranks = Threads::run(size, |team| {
            iterations(Body::shared(Share::new(&mesh, &owners, team.rank()), team))
        });
        let ranks: Vec<usize> = ranks.unwrap().into_iter().collect::<Result<_>>().unwrap();
        let most = 3 * whole / 2;
        assert!(ranks.iter().all(|n| (whole..=most).contains(n)), "{whole} iterations; {ranks:?} on {size}");
    }
}
