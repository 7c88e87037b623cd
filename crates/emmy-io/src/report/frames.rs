//! The frames of a run: the surface of the mesh, its displacements, and fields for colouring, as integers.

use serde_json::{Value, json};

use super::coarse::coarsened;
use super::collection::FrameSource;
use super::fields::{ColourField, FIELDS, MOTION};
use super::pack::{Pack, quantised};
use super::run::tables;
use super::surface::{RegionNodes, Surface};
use super::{MAX_NODES, ReportError};
use crate::mesh::{MeshError, vtu};

/// Bytes for the displacement of a node in a frame.
const DISPLACEMENT: usize = 6;

/// Packs mesh and frames into at most `room` bytes before compression. Returns their manifest, or `None` without a
/// frame. `input`: that of the run, with the names of its regions.
pub(super) fn gather(
    frames: &FrameSource,
    input: &toml::Table,
    room: usize,
    pack: &mut Pack,
) -> Result<Option<Value>, ReportError> {
    let n_frames = frames.len();
    if n_frames == 0 {
        return Ok(None);
    }
    // Without displacements there is no motion to show.
    let shown = shown(frames)?.filter(|(frame, _)| has_displacement(frame));
    let Some((frame, whole)) = shown else { return Ok(None) };
    let n_whole = whole.nodes.len();
    let surface = coarsened(whole, &frame.points, MAX_NODES);
    let fields = present(frames, &frame)?;
    let kept = kept(n_frames, room, surface.nodes.len() * (DISPLACEMENT + fields.len()));
    pack_mesh(&surface, &frame.points, pack);
    pack_frames((frames, &kept), &surface, frame.points.len(), &fields, pack)?;
    // The array has the unit of the quantity; stretches have none.
    let of_field = |field: &ColourField| json!({ "name": field.name, "label": field.label, "signed": field.is_signed(), "array": field.array.0 });
    let offered: Vec<Value> = [&MOTION].into_iter().chain(fields.iter().copied()).map(of_field).collect();
    Ok(Some(json!({
        "written": n_frames,
        "kept": kept.len(),
        "n_nodes": surface.nodes.len(),
        "regions": surface.regions.iter().map(|own| region(own, input)).collect::<Vec<_>>(),
        "fields": offered,
        "notes": notes(n_whole, surface.nodes.len(), n_frames, kept.len()),
    })))
}

/// The first frame without its cells, and its surface; `None` if there is nothing to draw.
pub(super) fn shown(frames: &FrameSource) -> Result<Option<(vtu::Frame, Surface)>, ReportError> {
    let mut frame = match frames.first() {
        // Rigid bodies alone have no surface.
        Err(ReportError::Frame(MeshError::NoCells { .. })) => return Ok(None),
        frame => frame?,
    };
    let surface = Surface::of_regions(std::mem::take(&mut frame.cells), &frame.regions);
    Ok((!surface.nodes.is_empty()).then_some((frame, surface)))
}

/// Whether a frame has the displacement.
pub(super) fn has_displacement(frame: &vtu::Frame) -> bool {
    frame.fields.iter().any(|(name, components)| (name.as_str(), *components) == MOTION.array)
}

/// A region with its nodes.
fn region(own: &RegionNodes, input: &toml::Table) -> Value {
    let table =
        usize::try_from(own.number).ok().and_then(|number| tables(input, "region").get(number).copied());
    let group = table.and_then(|table| table.get("group")?.as_str());
    let name = match own.number {
        ..0 => "rigid bodies".to_string(),
        number => group.map_or_else(|| format!("region {number}"), str::to_string),
    };
    json!({ "name": name, "n": own.n, "inside": own.n_inside })
}

/// Quantities in the frames with at least one finite value.
pub(super) fn present(
    frames: &FrameSource,
    frame: &vtu::Frame,
) -> Result<Vec<&'static ColourField>, ReportError> {
    let has = |field: &&ColourField| {
        frame.fields.iter().any(|(name, components)| (name.as_str(), *components) == field.array)
    };
    let mut fields: Vec<&ColourField> = FIELDS.iter().filter(has).collect();
    let names: Vec<&str> = fields.iter().map(|field| field.array.0).collect();
    let mut arrays = frames.values(0, &names)?.into_iter();
    fields.retain(|_| arrays.next().is_some_and(|array| array.iter().any(|number| number.is_finite())));
    // The largest stretch may be in two arrays.
    fields.dedup_by_key(|field| field.name);
    Ok(fields)
}

/// Indices of the frames that are kept: as many as there is room for, equally spaced, with the first and the last.
fn kept(n: usize, bytes: usize, bytes_of_frame: usize) -> Vec<usize> {
    let room = (bytes / bytes_of_frame.max(1)).max(2);
    if n <= room {
        return (0..n).collect();
    }
    (0..room).map(|i| i * (n - 1) / (room - 1)).collect()
}

fn notes(n_whole: usize, n_nodes: usize, n_frames: usize, n_kept: usize) -> Vec<String> {
    let mut notes = Vec::new();
    if n_nodes < n_whole {
        notes.push(format!(
            "The surface is drawn coarser than it is: {n_nodes} of its {n_whole} nodes, each where it was computed."
        ));
    }
    if n_kept < n_frames {
        notes.push(format!("{n_kept} of {n_frames} frames are in this page, at equal distances."));
    }
    notes
}

fn pack_mesh(surface: &Surface, points: &[[f64; 3]], pack: &mut Pack) {
    let at = |&node: &u32| points[node as usize].map(|x| x as f32);
    let points: Vec<f32> = surface.nodes.iter().flat_map(at).collect();
    pack.push("mesh/points", &points);
    pack.push("mesh/triangles", surface.triangles.as_flattened());
    pack.push("mesh/edges", surface.edges.as_flattened());
    pack.push("mesh/links", surface.links.as_flattened());
}

fn pack_frames(
    (frames, kept): (&FrameSource, &[usize]),
    surface: &Surface,
    n_points: usize,
    fields: &[&ColourField],
    pack: &mut Pack,
) -> Result<(), ReportError> {
    let names: Vec<&str> =
        ["displacement"].into_iter().chain(fields.iter().map(|field| field.array.0)).collect();
    let mut displacement = Vec::new();
    let mut bounds = [Vec::new(), Vec::new()];
    let mut packed: Vec<(Vec<u8>, [Vec<f64>; 2])> = vec![Default::default(); fields.len()];
    for &frame in kept {
        let arrays = frames.values(frame, &names)?;
        let at = |array: usize, components: usize| {
            let numbers = arrays[array].chunks_exact(components);
            let numbers: Vec<&[f64]> =
                if arrays[array].len() == components * n_points { numbers.collect() } else { Vec::new() };
            surface.nodes.iter().map(move |&node| numbers.get(node as usize).copied())
        };
        for axis in 0..3 {
            let values: Vec<f64> = at(0, 3).map(|u| u.map_or(f64::NAN, |u| u[axis])).collect();
            let of_axis = quantised(values.iter().copied(), |whole| whole as u16, &mut displacement);
            bounds.iter_mut().zip(of_axis).for_each(|(bounds, bound)| bounds.push(bound));
        }
        for (index, (field, (numbers, bounds))) in fields.iter().zip(&mut packed).enumerate() {
            let values = at(index + 1, field.array.1).map(|numbers| numbers.map_or(f64::NAN, field.value));
            let values: Vec<f64> = values.collect();
            let of_frame = quantised(values.iter().copied(), |whole| whole as u8, numbers);
            bounds.iter_mut().zip(of_frame).for_each(|(bounds, bound)| bounds.push(bound));
        }
    }
    let (steps, times): (Vec<u32>, Vec<f64>) = kept.iter().map(|&frame| frames.at(frame)).unzip();
    pack.push("frames/time", &times);
    pack.push("frames/step", &steps);
    pack.push("frames/displacement", &displacement);
    pack.push("frames/displacement_min", &bounds[0]);
    pack.push("frames/displacement_max", &bounds[1]);
    for (field, (numbers, bounds)) in fields.iter().zip(&packed) {
        pack.push(&format!("frames/{}", field.name), numbers);
        pack.push(&format!("frames/{}_min", field.name), &bounds[0]);
        pack.push(&format!("frames/{}_max", field.name), &bounds[1]);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_kept_as_far_as_there_is_room() {
        assert_eq!(kept(3, 1000, 100), [0, 1, 2]);
        assert_eq!(kept(1, 1000, 2000), [0]);
        let some = kept(1001, 1100, 100);
        assert_eq!((some.len(), some[0], some[5], some[10]), (11, 0, 500, 1000));
        // A surface that fills the page by itself still has two frames.
        assert_eq!(kept(50, 1000, 2000), [0, 49]);
    }
}
