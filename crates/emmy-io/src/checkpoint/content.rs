//! What stands in a checkpoint, as texts and lists of numbers.

use emmy::motion::{Record, Snapshot, State, Subdivision};
use emmy::sparse::{SolverChoice, SolverKind};

use super::file::Parts;
use super::{Checkpoint, Identity};
use crate::tally::Tally;

/// Before the names of the stepper's lists.
const STEPPER: &str = "stepper.";

/// Before the names of the lists of what chooses the step sizes.
const CONTROL: &str = "control.";

/// The bytes of the file of a checkpoint.
pub fn bytes(checkpoint: &Checkpoint) -> Vec<u8> {
    let Checkpoint { version, identity, snapshot, tally, frames, history, wall_seconds } = checkpoint;
    let Snapshot { state, record, subdivision, control, releases, was_at_rounding_floor, memory } = snapshot;
    let texts = [("version", version), ("input", &identity.input), ("mesh", &identity.mesh)];
    let place = [
        state.time,
        state.step as f64,
        f64::from(subdivision.halvings),
        subdivision.substep as f64,
        f64::from(subdivision.successes),
        *releases as f64,
        f64::from(u8::from(*was_at_rounding_floor)),
        f64::from(u8::from(memory.is_some())),
        f64::from(u8::from(control.is_some())),
        *wall_seconds,
    ];
    let mut lists = vec![
        ("place".to_string(), place.to_vec()),
        ("displacement".to_string(), state.displacement.clone()),
        ("momentum".to_string(), state.momentum.clone()),
        ("velocity".to_string(), state.velocity.clone()),
        ("displacement.low".to_string(), state.displacement_low.clone()),
        ("momentum.error".to_string(), state.momentum_error.to_vec()),
        ("record".to_string(), record_numbers(record).to_vec()),
        ("record.solver".to_string(), solver_numbers(record.solver)),
        ("tally".to_string(), tally.numbers().to_vec()),
        ("tally.solver".to_string(), solver_numbers(tally.solver)),
        ("history".to_string(), vec![f64::from(*history)]),
        ("frames.steps".to_string(), frames.iter().map(|(step, _)| *step as f64).collect()),
        ("frames.times".to_string(), frames.iter().map(|(_, time)| *time).collect()),
    ];
    for (prefix, memory) in [(STEPPER, memory), (CONTROL, control)] {
        let own = memory.iter().flat_map(|memory| memory.lists());
        lists.extend(own.map(|(name, list)| (format!("{prefix}{name}"), list.to_vec())));
    }
    let texts = texts.map(|(name, text)| (name.to_string(), text.clone())).to_vec();
    Parts { texts, lists }.bytes()
}

/// Reads the bytes of a file; else why it cannot be used.
pub fn read(bytes: &[u8]) -> Result<Checkpoint, String> {
    let parts = Parts::read(bytes)?;
    let [time, step, level, part, good, releases, floor, has_memory, has_control, wall_seconds] =
        parts.array("place")?;
    let state = State {
        time,
        step: whole(step)?,
        displacement: parts.list("displacement")?.to_vec(),
        momentum: parts.list("momentum")?.to_vec(),
        velocity: parts.list("velocity")?.to_vec(),
        displacement_low: parts.list("displacement.low")?.to_vec(),
        momentum_error: parts.array("momentum.error")?,
    };
    if !is_finite(&state) {
        return Err("has a state that is not finite".into());
    }
    let [history] = parts.array("history")?;
    let history = whole(history)? as u32;
    // More would not fit into the counter of parts.
    if whole(level)? > 60 {
        return Err("has a step that is divided too often".into());
    }
    let memory = |prefix: &str| {
        let own = |(name, list): &(String, Vec<f64>)| {
            name.strip_prefix(prefix).map(|name| (name.to_string(), list.clone()))
        };
        parts.lists.iter().filter_map(own).collect()
    };
    let snapshot = Snapshot {
        state,
        record: record(parts.array("record")?, solver(parts.list("record.solver")?)),
        subdivision: Subdivision {
            halvings: whole(level)? as u32,
            substep: whole(part)? as u64,
            successes: whole(good)? as u32,
        },
        control: (has_control != 0.0).then(|| memory(CONTROL)),
        releases: whole(releases)?,
        was_at_rounding_floor: floor != 0.0,
        memory: (has_memory != 0.0).then(|| memory(STEPPER)),
    };
    let frames = parts.list("frames.steps")?.iter().zip(parts.list("frames.times")?);
    let frames = frames.map(|(step, time)| Ok((whole(*step)?, *time))).collect::<Result<_, String>>()?;
    Ok(Checkpoint {
        version: parts.text("version")?.to_string(),
        identity: Identity { input: parts.text("input")?.to_string(), mesh: parts.text("mesh")?.to_string() },
        snapshot,
        tally: Tally::of(parts.array("tally")?, solver(parts.list("tally.solver")?)),
        frames,
        history,
        wall_seconds,
    })
}

/// Whether all numbers of a state are finite.
pub fn is_finite(state: &State) -> bool {
    let State { time, displacement, momentum, velocity, displacement_low, .. } = state;
    let lists = [displacement, momentum, velocity, displacement_low];
    time.is_finite() && lists.iter().all(|list| list.iter().all(|number| number.is_finite()))
}

/// A number that counts something; more than a million millions is none.
fn whole(number: f64) -> Result<usize, String> {
    let is_count = (0.0..=1e12).contains(&number) && number.fract() == 0.0;
    if is_count { Ok(number as usize) } else { Err(format!("has {number} where a count should be")) }
}

fn solver_numbers(choice: Option<SolverChoice>) -> Vec<f64> {
    let numbers = |choice: SolverChoice| {
        let own = [f64::from(u8::from(choice.kind == SolverKind::Iterative)), choice.stiffness];
        own.into_iter().chain(choice.limit).collect()
    };
    choice.map_or(Vec::new(), numbers)
}

fn solver(numbers: &[f64]) -> Option<SolverChoice> {
    let [is_iterative, stiffness, limit @ ..] = numbers else { return None };
    Some(SolverChoice {
        kind: if *is_iterative != 0.0 { SolverKind::Iterative } else { SolverKind::Direct },
        stiffness: *stiffness,
        limit: limit.first().copied(),
    })
}

/// All of a record but its solver.
fn record_numbers(record: &Record) -> [f64; 31] {
    let [p, l] = [record.linear_momentum, record.angular_momentum];
    [
        record.step as f64,
        record.time,
        record.step_size,
        record.kinetic_energy,
        record.strain_energy,
        record.external_work,
        record.total_energy,
        record.energy_residual,
        p[0],
        p[1],
        p[2],
        l[0],
        l[1],
        l[2],
        record.linear_momentum_residual,
        record.angular_momentum_residual,
        record.newton_iterations as f64,
        record.linear_iterations as f64,
        record.renewals as f64,
        f64::from(u8::from(record.took_exact_tangent)),
        f64::from(u8::from(record.at_rounding_floor)),
        record.cuts as f64,
        record.releases as f64,
        record.smallest_determinant,
        record.newton_target,
        record.local_error,
        record.refusals as f64,
        record.dissipated_energy,
        record.degree as f64,
        record.rounding,
        f64::from(u8::from(record.is_unresolved)),
    ]
}

fn record(numbers: [f64; 31], solver: Option<SolverChoice>) -> Record {
    let n = numbers;
    Record {
        step: n[0] as usize,
        time: n[1],
        step_size: n[2],
        kinetic_energy: n[3],
        strain_energy: n[4],
        external_work: n[5],
        total_energy: n[6],
        energy_residual: n[7],
        linear_momentum: [n[8], n[9], n[10]],
        angular_momentum: [n[11], n[12], n[13]],
        linear_momentum_residual: n[14],
        angular_momentum_residual: n[15],
        newton_iterations: n[16] as usize,
        linear_iterations: n[17] as usize,
        renewals: n[18] as usize,
        took_exact_tangent: n[19] != 0.0,
        at_rounding_floor: n[20] != 0.0,
        cuts: n[21] as usize,
        releases: n[22] as usize,
        smallest_determinant: n[23],
        newton_target: n[24],
        local_error: n[25],
        refusals: n[26] as usize,
        dissipated_energy: n[27],
        degree: n[28] as usize,
        rounding: n[29],
        is_unresolved: n[30] != 0.0,
        solver,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_that_are_not_finite_are_not_taken() {
        let with = |x: f64| {
            let state = State { displacement: vec![0.0, x, 0.0], ..Default::default() };
            bytes(&Checkpoint {
                version: "0.1.0".into(),
                identity: Identity { input: String::new(), mesh: String::new() },
                snapshot: Snapshot { state, ..Default::default() },
                tally: Tally::default(),
                frames: vec![(3, 0.5)],
                history: 0xdead_beef,
                wall_seconds: 1.0,
            })
        };
        let whole = read(&with(1.0)).unwrap();
        assert_eq!((whole.history, whole.frames), (0xdead_beef, vec![(3, 0.5)]));
        for x in [f64::NAN, f64::INFINITY] {
            assert_eq!(read(&with(x)), Err("has a state that is not finite".into()));
        }
    }

    #[test]
    fn counts_are_whole_numbers_of_a_size_that_can_be() {
        assert_eq!(whole(1e12), Ok(1_000_000_000_000));
        for number in [-1.0, 0.5, 1e19, f64::NAN, f64::INFINITY] {
            assert!(whole(number).is_err(), "{number}");
        }
    }
}
