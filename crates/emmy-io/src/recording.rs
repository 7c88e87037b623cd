//! The frames of a run: fields of the motion, written at the times of the input.

use std::io;
use std::path::PathBuf;

use emmy::body::{FieldName, Fields};
use emmy::motion::Motion;

use crate::checkpoint::Checkpoint;
use crate::history::{Extreme, OutputMotion, RegionMembers};
use crate::input::Problem;
use crate::vtk::{Format, FrameTime, FrameWriter, series_fields};

/// The field whose largest value frames yield.
const STRESS: FieldName = FieldName::VonMisesStress;

/// The frames of a run cannot be resumed with other fields.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`output.fields` is {}, but the frames in {path} have {}: all frames of a .vtkhdf have the same fields; \
     resume with those fields, or with `output.format = \"vtu\"`",
    listed(.now),
    listed(.before)
)]
pub struct OtherFields {
    path: String,
    before: Vec<FieldName>,
    now: Vec<FieldName>,
}

fn listed(fields: &[FieldName]) -> String {
    let quoted: Vec<String> = fields.iter().map(|field| format!("\"{field}\"")).collect();
    format!("[{}]", quoted.join(", "))
}

/// Writes the frames of a run. On a team its methods that write are calls of all ranks, with the same outcome on all.
#[derive(Debug)]
pub(crate) struct Recording {
    files: FrameWriter,
    fields: Fields,
    /// For the largest stresses, if several regions have stresses.
    regions: Option<RegionMembers>,
    names: Vec<FieldName>,
    written: Vec<FrameTime>,
}

impl Recording {
    /// Checks that the frames in the directory of a problem can be continued with its fields.
    ///
    /// # Errors
    /// [`OtherFields`].
    pub(crate) fn check(problem: &Problem) -> Result<(), OtherFields> {
        let output = &problem.output;
        if !output.has_frames() || output.format != Format::Vtkhdf {
            return Ok(());
        }
        let Some((path, before)) = series_fields(&output.directory) else { return Ok(()) };
        let now = names(problem, &Fields::new(&problem.body));
        let is_same = now.len() == before.len() && now.iter().all(|name| before.contains(name));
        if is_same { Ok(()) } else { Err(OtherFields { path: path.display().to_string(), before, now }) }
    }

    /// The frames of a run. A run that is resumed continues the frames up to its checkpoint; they are returned with
    /// those that are missing.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn open(problem: &Problem, after: Option<&Checkpoint>) -> io::Result<(Self, Vec<FrameTime>)> {
        let body = &problem.body;
        let output = &problem.output;
        let fields = Fields::new(body);
        let names = names(problem, &fields);
        let form = (output.format, output.precision);
        let directory = &output.directory;
        let n_stressed =
            (0..fields.regions().count()).filter(|&region| fields.region_has(region, STRESS)).count();
        let has_sides = n_stressed > 1 && names.contains(&STRESS);
        let regions = has_sides.then(|| RegionMembers::new(body, &fields, &[STRESS]));
        let Some(checkpoint) = after else {
            let files = FrameWriter::create(form, directory, body)?;
            let written = Vec::new();
            return Ok((Recording { files, fields, regions, names, written }, Vec::new()));
        };
        // The last state of a run that ended is an extra frame, which the resumed run drops.
        let step = checkpoint.snapshot.state.step;
        let is_kept =
            |frame: &FrameTime| frame.step != step || output.is_frame(&problem.plan, frame.step, frame.time);
        let mut written: Vec<FrameTime> = checkpoint.frames.iter().copied().filter(is_kept).collect();
        let (files, missing) = FrameWriter::resume(form, directory, body, (&written, step))?;
        written.retain(|frame| !missing.contains(frame));
        Ok((Recording { files, fields, regions, names, written }, missing))
    }

    /// Writes a state, once a step, and returns its largest von Mises stress if the frames have this field, of the body
    /// and of each region if there are several.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn write(&mut self, motion: &Motion<'_>) -> io::Result<Vec<Extreme>> {
        let (body, state) = (motion.body(), motion.state());
        if self.files.last_step() == Some(state.step) {
            return Ok(Vec::new());
        }
        let mut fields = self.fields.at([&state.displacement, &state.velocity], &self.names);
        let output = OutputMotion::new(motion, motion.reference(), self.names.iter().copied());
        for field in fields.iter_mut().filter(|field| field.name.is_of_motion()) {
            let n = field.numbers.len();
            field.numbers.copy_from_slice(&output.vectors(field.name)[..n]);
        }
        self.files.write(state.step, state.time, &fields)?;
        self.written.push(FrameTime { step: state.step, time: state.time });
        if let Some(regions) = &self.regions {
            return Ok(regions.extremes(body, &self.fields, state, &[STRESS]));
        }
        let stress = fields.iter().find(|field| field.name == STRESS);
        let whole = (body.mesh(), &**body.ranks());
        let nodes = 0..body.mesh().n_nodes();
        let largest = stress.and_then(|own| Extreme::of(whole, state, STRESS, nodes, &own.numbers));
        Ok(largest.into_iter().collect())
    }

    /// Completes the files.
    ///
    /// # Errors
    /// Errors of the system.
    pub(crate) fn finish(&mut self) -> io::Result<()> {
        self.files.finish()
    }

    /// The collection or the series.
    pub(crate) fn path(&self) -> PathBuf {
        self.files.path()
    }

    /// Frames written so far.
    pub(crate) fn written(&self) -> &[FrameTime] {
        &self.written
    }
}

/// The fields of the input that the body has.
fn names(problem: &Problem, fields: &Fields) -> Vec<FieldName> {
    problem.output.fields.iter().copied().filter(|&name| fields.has(name)).collect()
}
