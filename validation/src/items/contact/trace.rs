//! Motions with one obstacle or bodies that meet, and what is read from them.

use emmy::body::Body;
use emmy::motion::{Motion, Record, State};
use emmy::time::Scheme;

use super::data::{Problem, Run};
use crate::measure::{cpu_seconds, norm};

/// A motion: records at the start and the ends of steps, and forces of the obstacle.
#[derive(Debug, Default)]
pub(super) struct Trace {
    /// Records.
    pub records: Vec<Record>,
    /// Means over the steps, each with the middle of its step.
    pub forces: Vec<(f64, [f64; 3])>,
    /// Mass of the body.
    pub mass: f64,
    /// CPU time \[s\].
    pub seconds: f64,
}

impl Trace {
    /// Runs the input of a problem to its end, in steps of the size of the run.
    ///
    /// # Errors
    /// The message of an input or a step that fails.
    pub(super) fn of(problem: &Problem, run: &Run, set: &[(&str, String)]) -> Result<Trace, String> {
        let case = set.iter().fold(problem.case(run), |case, (key, value)| case.with(key, value));
        let input = case.problem()?;
        let start = State::initial(&input.body, 0.0, &input.initial).map_err(|error| error.to_string())?;
        let end = input.plan.end();
        let mut motion = Motion::starting(&input.body, input.scheme, input.newton, start)
            .map_err(|error| error.to_string())?;
        Trace::march(&mut motion, &input.body, run.size, end)
            .map_err(|error| format!("{}: {error}", run.label()))
    }

    /// The motion of a body from a state.
    ///
    /// # Errors
    /// The message of a step that fails.
    pub(super) fn from(body: &Body, start: State, run: &Run, end: f64) -> Result<Trace, String> {
        Ok(Trace::with_state(body, start, run, end)?.0)
    }

    /// The motion of a body from a state, and the state at its end.
    ///
    /// # Errors
    /// The message of a step that fails.
    pub(super) fn with_state(
        body: &Body,
        start: State,
        run: &Run,
        end: f64,
    ) -> Result<(Trace, State), String> {
        let text = |error: emmy::Error| format!("{}: {error}", run.label());
        let scheme =
            Scheme::from_name(&run.scheme).and_then(|own| own.with_degree(run.degree)).map_err(text)?;
        let mut motion = Motion::new(body, scheme).and_then(|motion| motion.from(start)).map_err(text)?;
        let trace = Trace::march(&mut motion, body, run.size, end)
            .map_err(|error| format!("{}: {error}", run.label()))?;
        Ok((trace, motion.state().clone()))
    }

    /// Steps of a motion to a time.
    ///
    /// # Errors
    /// The message of a step that fails.
    pub(super) fn march(motion: &mut Motion<'_>, body: &Body, size: f64, end: f64) -> Result<Trace, String> {
        let mut trace = Trace {
            records: vec![motion.record().clone()],
            mass: body.lumped_mass().iter().sum(),
            ..Trace::default()
        };
        let begin = cpu_seconds();
        for _ in 0..(end / size).round() as usize {
            let record = motion.step(size).map_err(|error| error.to_string())?.clone();
            // The supports come first.
            let force = motion.reactions().last().map_or([0.0; 3], |reaction| reaction.force);
            trace.forces.push((record.time - 0.5 * size, force));
            trace.records.push(record);
        }
        trace.seconds = cpu_seconds() - begin;
        Ok(trace)
    }

    /// Forces along z over time.
    pub(super) fn normal(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.forces.iter().map(|&(time, force)| (time, force[2]))
    }

    /// Times at which the normal force passes a level, upwards and downwards in turn.
    pub(super) fn passes(&self, level: f64) -> Vec<f64> {
        crossings(self.normal(), level)
    }

    /// The same of the force against z, that on the first body of a row.
    pub(super) fn pushes(&self, level: f64) -> Vec<f64> {
        crossings(self.normal().map(|(time, force)| (time, -force)), level)
    }

    /// Mean normal force over the steps in an interval.
    pub(super) fn mean(&self, from: f64, to: f64) -> f64 {
        let inside = || self.normal().filter(|(time, _)| (from..to).contains(time));
        inside().map(|(_, force)| force).sum::<f64>() / inside().count() as f64
    }

    /// The record at a time.
    pub(super) fn at(&self, time: f64) -> &Record {
        let index = self.records.partition_point(|record| record.time < time);
        &self.records[index.min(self.records.len() - 1)]
    }

    /// Mean velocity along z at a record.
    pub(super) fn velocity(&self, record: &Record) -> f64 {
        record.linear_momentum[2] / self.mass
    }

    /// Energy besides that of the mean velocity.
    pub(super) fn vibration(&self, record: &Record) -> f64 {
        let [x, y, z] = record.linear_momentum;
        record.kinetic_energy + record.strain_energy - (x * x + y * y + z * z) / (2.0 * self.mass)
    }

    /// Largest change of the energy with work and dissipation since the start, over an energy.
    pub(super) fn drift(&self, scale: f64) -> f64 {
        let booked = |record: &Record| record.total_energy - record.external_work + record.dissipated_energy;
        let first = booked(&self.records[0]);
        self.records.iter().map(|record| (booked(record) - first).abs()).fold(0.0, f64::max) / scale
    }

    /// Largest change of the linear momentum.
    pub(super) fn momentum_change(&self) -> f64 {
        self.change(|record| record.linear_momentum)
    }

    /// Largest change of the angular momentum about the origin.
    pub(super) fn spin_change(&self) -> f64 {
        self.change(|record| record.angular_momentum)
    }

    fn change(&self, vector: impl Fn(&Record) -> [f64; 3]) -> f64 {
        let first = vector(&self.records[0]);
        let far = |own: [f64; 3]| norm([0, 1, 2].map(|d| own[d] - first[d]));
        self.records.iter().map(|record| far(vector(record))).fold(0.0, f64::max)
    }

    /// Newton corrections of a step on average.
    pub(super) fn corrections(&self) -> f64 {
        let all: usize = self.records[1..].iter().map(|record| record.newton_iterations).sum();
        all as f64 / self.forces.len() as f64
    }
}

/// Where a curve passes a level, by straight lines between its points.
pub(super) fn crossings(curve: impl Iterator<Item = (f64, f64)>, level: f64) -> Vec<f64> {
    let points: Vec<(f64, f64)> = curve.collect();
    let between = points.windows(2).filter(|pair| (pair[0].1 < level) != (pair[1].1 < level));
    between
        .map(|pair| pair[0].0 + (level - pair[0].1) * (pair[1].0 - pair[0].0) / (pair[1].1 - pair[0].1))
        .collect()
}
