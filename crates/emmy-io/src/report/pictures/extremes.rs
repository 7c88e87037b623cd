//! The frames in which the extremes of a run occur.

use std::path::Path;

use serde_json::Value;

use super::nodal::Nodal;
use super::sheet::four_digits;
use super::{MODE, START};
use crate::report::collection::FrameSource;
use crate::report::fields::{ColourField, MOTION};
use crate::report::{ReportError, modes};
use crate::vector::Vector;

/// A picture to be drawn.
#[derive(Debug)]
pub(super) struct Shot {
    /// Name of the file without its ending.
    pub(super) name: String,
    frame: usize,
    pub(super) caption: String,
    colours: Colours,
    /// The value that is marked.
    pub(super) extreme: Option<Marked>,
}

/// The meaning of the colours.
#[derive(Debug)]
enum Colours {
    None,
    Field(&'static ColourField),
    /// The length of the displacement added to the first frame, relative to its largest.
    Mode,
}

/// A value that is marked.
#[derive(Debug)]
pub(super) struct Marked {
    /// Its kind, such as `largest value`.
    pub(super) name: &'static str,
    pub(super) value: f64,
    pub(super) unit: String,
    /// Node of the surface.
    pub(super) node: usize,
    /// Whether zero has the middle colour.
    pub(super) is_signed: bool,
}

impl Shot {
    /// Positions of the nodes, and the values that give the colours.
    pub(super) fn numbers(
        &self,
        frames: &FrameSource,
        nodal: &Nodal,
    ) -> Result<(Vec<Vector>, Vec<f64>), ReportError> {
        let name = if let Colours::Field(field) = self.colours { field.array.0 } else { MOTION.array.0 };
        let arrays = frames.values(self.frame, &[MOTION.array.0, name])?;
        let displacements = nodal.displacements(&arrays[0]);
        let values = match self.colours {
            Colours::None => Vec::new(),
            Colours::Field(field) => nodal.values(field, &arrays[1]),
            Colours::Mode => nodal.lengths_of_mode(&displacements, &at_rest(frames, nodal)?),
        };
        Ok((nodal.moved(&displacements), values))
    }
}

/// Properties of a run that captions show.
#[derive(Debug)]
pub(super) struct Words<'a> {
    /// Units of the run; null if it has none.
    pub(super) units: &'a Value,
    /// Whether the frames are those of a static analysis.
    pub(super) is_static: bool,
    /// Words for the frame of reference of the motion, if it is not at rest.
    pub(super) relation: String,
}

impl Words<'_> {
    /// The quantity of a picture.
    fn quantity(&self, field: &ColourField) -> String {
        let is_of_motion = ["displacement", "velocity"].contains(&field.array.0);
        format!("{}{}", field.label, if is_of_motion { &self.relation } else { "" })
    }

    fn time(&self, time: f64) -> String {
        let unit = self.units["system"]["time"].as_str().unwrap_or_default();
        match self.is_static {
            true => format!("load fraction = {}", four_digits(time)),
            false => format!("t = {} {unit}", four_digits(time)).trim_end().to_string(),
        }
    }
}

/// The largest value of a field so far.
#[derive(Debug, Clone, Copy)]
struct Found {
    frame: usize,
    node: usize,
    value: f64,
    /// Position of the node.
    at: Vector,
}

/// The pictures of a run, and the table of its extremes.
pub(super) fn of_run(
    frames: &FrameSource,
    fields: &[&'static ColourField],
    nodal: &Nodal,
    words: &Words<'_>,
) -> Result<(Vec<Shot>, String), ReportError> {
    let all: Vec<&'static ColourField> = [&MOTION].into_iter().chain(fields.iter().copied()).collect();
    let found = found(frames, &all, nodal)?;
    let start = format!("start, {}", words.time(frames.at(0).1));
    let mut shots =
        vec![Shot { name: START.into(), frame: 0, caption: start, colours: Colours::None, extreme: None }];
    let mut table = "picture,field,extreme,time,value,x,y,z,X,Y,Z\n".to_string();
    for (field, found) in all.into_iter().zip(found).filter_map(|(field, found)| Some((field, found?))) {
        let time = frames.at(found.frame).1;
        let Found { value, at, node, .. } = found;
        let numbers = [time, value].into_iter().chain(at).chain(nodal.points()[node]);
        let numbers = numbers.map(|number| format!("{number:.16e}")).collect::<Vec<_>>().join(",");
        table += &format!("{0}.png,{0},{1},{numbers}\n", field.name, field.extreme.name());
        let unit = words.units["fields"][field.array.0].as_str().unwrap_or_default();
        shots.push(Shot {
            name: field.name.into(),
            frame: found.frame,
            caption: format!("{}, {}", words.quantity(field), words.time(time)),
            colours: Colours::Field(field),
            extreme: Some(Marked {
                name: field.extreme.name(),
                value,
                unit: unit.into(),
                node: found.node,
                is_signed: field.is_signed(),
            }),
        });
    }
    Ok((shots, table))
}

/// Of each field the most extreme value over all frames; the first of equal ones. `None` without a finite value.
fn found(
    frames: &FrameSource,
    fields: &[&ColourField],
    nodal: &Nodal,
) -> Result<Vec<Option<Found>>, ReportError> {
    let arrays: Vec<&str> = fields.iter().map(|field| field.array.0).collect();
    let mut found: Vec<Option<Found>> = vec![None; fields.len()];
    for frame in 0..frames.len() {
        let arrays = frames.values(frame, &arrays)?;
        let moved = nodal.moved(&nodal.displacements(&arrays[0]));
        for ((field, array), found) in fields.iter().zip(&arrays).zip(&mut found) {
            for (node, value) in nodal.values(field, array).into_iter().enumerate() {
                let is_more = |found: &Found| field.extreme.weight(value) > field.extreme.weight(found.value);
                // A node without a position is not in the picture.
                let is_drawn = value.is_finite() && moved[node].iter().all(|x| x.is_finite());
                if is_drawn && found.as_ref().is_none_or(is_more) {
                    *found = Some(Found { frame, node, value, at: moved[node] });
                }
            }
        }
    }
    Ok(found)
}

/// The pictures of natural modes. Frame 0 is the body at rest.
pub(super) fn modes(
    directory: &Path,
    frames: &FrameSource,
    nodal: &Nodal,
    unit: &str,
) -> Result<Vec<Shot>, ReportError> {
    let frequencies = modes::frequencies(directory)?;
    let at_rest = at_rest(frames, nodal)?;
    let shot = |frame: usize| {
        let displacements = nodal.displacements(&frames.values(frame, &[MOTION.array.0])?[0]);
        let lengths = nodal.lengths_of_mode(&displacements, &at_rest);
        let node = lengths.iter().position(|&length| length == 1.0).unwrap_or(0);
        let frequency = frequencies.get(frame - 1).map(|&frequency| match frequency {
            0.0 => ", rigid".to_string(),
            frequency => format!(", frequency {} {unit}", four_digits(frequency)).trim_end().to_string(),
        });
        let frequency = frequency.unwrap_or_default();
        Ok(Shot {
            name: format!("{MODE}{frame}"),
            frame,
            caption: format!("mode {frame}{frequency}; |v| relative to its largest"),
            colours: Colours::Mode,
            extreme: Some(Marked {
                name: "largest |v|",
                value: 1.0,
                unit: String::new(),
                node,
                is_signed: false,
            }),
        })
    };
    (1..frames.len()).map(shot).collect()
}

/// Displacements of the first frame.
fn at_rest(frames: &FrameSource, nodal: &Nodal) -> Result<Vec<Vector>, ReportError> {
    Ok(nodal.displacements(&frames.values(0, &[MOTION.array.0])?[0]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_have_the_time_or_the_load() {
        let units = serde_json::json!({ "system": { "time": "ms" } });
        let text = |units: &Value, is_static: bool| {
            let words = Words { units, is_static, relation: ", relative to base".into() };
            format!("{}; {}", words.quantity(&MOTION), words.time(0.1 + 0.2))
        };
        let displaced = |time: &str| format!("displacement |u|, relative to base; {time}");
        assert_eq!(text(&units, false), displaced("t = 0.3 ms"));
        assert_eq!(text(&Value::Null, false), displaced("t = 0.3"));
        assert_eq!(text(&units, true), displaced("load fraction = 0.3"));
    }
}
