//! `solvers`: whether the solver that Emmy chooses is about as fast as the best one.

use emmy::mesh::CellKind;

use super::side_by_side::Figure;
use super::{Settings, locking};
use crate::job::{Case, Job};
use crate::measure::{GAVE_UP, UNSOLVED};
use crate::mesh_file::block_file;
use crate::report::{Goal, Limit, Report, Table, number};
use crate::scratch::Scratch;
use crate::session::{Runs, Session};
use crate::work::{Shape, Work};

/// Kinds of `[solver]`; the first one chooses among the others.
const KINDS: [&str; 4] = ["auto", "iterative", "direct", "multigrid"];
/// Schemes and degrees.
const SCHEMES: [(&str, usize); 4] = [("FE(1)", 1), ("DGM", 1), ("DGM", 2), ("DGM", 3)];
/// Limit of the time with the first kind over that with the best one.
const LIMIT: f64 = 1.2;
const STEPS: u32 = 12;
/// A kind that takes this many times as long as the first one gives up.
const HOPELESS: f64 = 4.0;
/// Shortest time that tells anything \[s\].
const LEAST: f64 = 1.0;
/// Sizes and numbers of large steps of the soft block, between those that the mass dominates and stiff ones.
const LARGE_STEPS: [(f64, u32); 2] = [(0.05, STEPS), (0.2, 8)];
/// Steps of the quasi-rigid block.
const QUASI_RIGID: (f64, u32) = (0.2, 8);
/// Bulk over shear modulus of projected cells, and their steps.
const PROJECTED: (f64, f64) = (1e4, 0.02);

/// Whole runs by each kind, of soft to quasi-rigid bodies, hex8 and tet10, with standard and with projected volumes.
pub(super) fn measure(settings: &Settings) -> Result<Vec<Report>, String> {
    let session = &settings.session;
    let scratch = Scratch::new("solvers")?;
    let note = "Motions with their start, one thread; CPU seconds by `[solver]`; -: fails; slow: takes over 4 s and \
        over four times as long as `auto`.";
    let mut report = Report::new("Solvers", note);
    let heading = ["motion", "scheme", "k"].into_iter().chain(KINDS).chain(["auto / best"]);
    let mut table = Table::with_heading(2, heading.map(String::from).collect());
    let mut largest = (0.0, String::new());
    for (name, motion) in motions(session, &scratch)? {
        for (scheme, k) in SCHEMES.into_iter().step_by(session.choose(3, 1)) {
            let case = motion.clone().scheme(scheme, k);
            let of_kind = |kind: &str| case.clone().with("solver.kind", kind);
            let first = solved(session.attempts(&[Job::case(&of_kind(KINDS[0]))?], is_unsolved))?;
            let seconds = first[0].as_ref().map(|runs| runs.median(|o| Figure::WithStart.of(o)));
            let job = |kind| match seconds {
                Ok(seconds) => Job::case(&of_kind(kind).at_longest(HOPELESS * seconds.max(LEAST))),
                Err(_) => Job::case(&of_kind(kind)),
            };
            let jobs = KINDS.into_iter().map(job).collect::<Result<Vec<_>, _>>()?;
            let runs = solved(session.attempts(&jobs, is_unsolved))?;
            let seconds = |runs: &Runs| number(runs.median(|o| Figure::WithStart.of(o)));
            // A choice that fails is infinitely worse.
            let over = |other: &Runs| {
                runs[0].as_ref().map_or(f64::INFINITY, |auto| auto.ratio(other, |o| Figure::WithStart.of(o)))
            };
            let ratio = runs.iter().flatten().map(over).fold(0.0, f64::max);
            let mut row = vec![name.clone(), scheme.to_string(), k.to_string()];
            row.extend(runs.iter().map(|runs| runs.as_ref().map_or_else(|word| word.to_string(), seconds)));
            row.push(number(ratio));
            table.push(row);
            if ratio > largest.0 {
                largest = (ratio, format!("{name}, {scheme}, k = {k}"));
            }
        }
    }
    report.tables.push(table);
    let statement = format!("auto over the best kind, largest of all ({})", largest.1);
    report.goals.push(Goal::new(statement, Limit::AtMost(LIMIT), largest.0));
    Ok(vec![report])
}

/// The motions with their names.
fn motions(session: &Session, scratch: &Scratch) -> Result<Vec<(String, Case)>, String> {
    let (small, r, steps) = session.choose((1, 1, 3), (2, 4, STEPS));
    let mut motions = Vec::new();
    for stiff in [false, true] {
        let hex8 = Work::hex8(r, stiff, steps);
        let tet10 = Work { shape: Shape::Block(CellKind::Tet10, small), ..hex8 };
        let bracket = Work { shape: Shape::Bracket, ..hex8 };
        for work in [Work::hex8(small, stiff, steps), hex8, tet10, bracket] {
            motions.push((work.to_string(), work.case(scratch)?));
        }
    }
    for (r, (h, steps)) in [small, r].into_iter().flat_map(|r| LARGE_STEPS.map(|steps| (r, steps))) {
        let work = Work::hex8(r, false, session.choose(3, steps));
        motions.push((format!("{work}, h = {h}"), work.case(scratch)?.steps(work.steps, h)));
    }
    for r in [small, r] {
        let case = Case::quasi_rigid_block(r).steps(steps.min(QUASI_RIGID.1), QUASI_RIGID.0);
        motions.push((format!("hex8 r = {r}, quasi-rigid, h = {}", QUASI_RIGID.0), case));
    }
    for (kind, r) in [(CellKind::Hex8, r), (CellKind::Tet10, small)] {
        let (ratio, h) = PROJECTED;
        let file = block_file(scratch, kind, r)?;
        let case = locking::case(&file, ("DGM", 1), "projected-volume", ratio).steps(steps, h);
        motions.push((format!("{kind} r = {r}, projected, K/mu = {ratio:e}"), case));
    }
    Ok(motions.into_iter().step_by(session.choose(5, 1)).collect())
}

/// Whether a run failed because a kind does not suit the motion, which is a result.
fn is_unsolved(message: &str) -> bool {
    message.contains(UNSOLVED)
}

/// The runs of the kinds that suit, and for the others a word; an error for any other failure.
fn solved(attempts: Vec<Result<Runs, String>>) -> Result<Vec<Result<Runs, &'static str>>, String> {
    let solved = |attempt: Result<Runs, String>| match attempt {
        Ok(runs) => Ok(Ok(runs)),
        Err(message) if message.contains(GAVE_UP) => Ok(Err("slow")),
        Err(message) if is_unsolved(&message) => Ok(Err("-")),
        Err(message) => Err(message),
    };
    attempts.into_iter().map(solved).collect()
}
