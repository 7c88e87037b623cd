//! The block of the README, drawn: the L-shaped block of Betsch and Steinmann (2001) tumbles through space under the
//! hat-shaped load, and its energy and angular momentum stay flat afterwards.
//!
//!     cargo run --release --example tumble > docs/tumble.svg

use std::error::Error;
use std::fmt::Write;

use emmy::body::{Body, History, Load, LoadKind, Region};
use emmy::material::NeoHooke;
use emmy::mesh::Mesh;
use emmy::motion::{Motion, NewtonSettings, Observer, Phase, Record, State, StepPlan, View};
use emmy::time::Scheme;

/// Keeps every record, and the positions at some times.
struct Film {
    times: Vec<f64>,
    records: Vec<Record>,
    frames: Vec<Vec<[f64; 3]>>,
}

impl Observer for Film {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.records.push(view.record.clone());
        if self.times.get(self.frames.len()).is_some_and(|time| view.record.time >= time - 1e-9) {
            let nodes = 0..view.body.mesh().n_nodes();
            self.frames.push(nodes.map(|node| view.state.position(view.body, node)).collect());
        }
        Ok(())
    }
}

fn fly() -> emmy::Result<(Mesh, Film)> {
    let loads = [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| {
        let traction = [256.0, 512.0, 768.0].map(|t| sign * t / 9.0);
        let history = History::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)])?;
        Ok(Load { kind: LoadKind::Traction { group: group.into(), traction }, history })
    });
    let loads: Vec<Load> = loads.into_iter().collect::<emmy::Result<_>>()?;
    let rubber = Region::new(None, 0.5, NeoHooke::new(1000.0, 500.0)?);
    let body = Body::new(emmy::mesh::l_block(1.0)?, vec![rubber], &[], &loads)?;
    let state = State::initial(&body, 0.0, &[])?;
    let mut film = Film { times: vec![0.0, 0.6, 1.2, 1.8, 2.4, 3.0], records: vec![], frames: vec![] };
    let mut motion = Motion::new(&body, Scheme::AssumedStrain(5), 1, NewtonSettings::default(), state)?;
    let plan = vec![Phase { until: 1.0, size: 0.01 }, Phase { until: 4.0, size: 0.04 }];
    motion.march(&StepPlan::new(0.0, plan)?, &mut [&mut film]).expect("the paper's block converges");
    Ok((body.mesh().clone(), film))
}

/// Faces of cells that have no neighbour, as corner nodes.
fn surface(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut faces = std::collections::BTreeMap::new();
    for cell in mesh.cells() {
        for facet in cell.kind.facets() {
            let corners: Vec<u32> =
                facet.nodes[..facet.kind.n_corners()].iter().map(|&a| cell.nodes[a]).collect();
            let mut key = corners.clone();
            key.sort_unstable();
            faces.entry(key).and_modify(|face| *face = None).or_insert(Some(corners));
        }
    }
    faces.into_values().flatten().collect()
}

/// View from a corner: right, up and depth of a position.
fn projected([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.82 * x - 0.57 * z, 0.9 * y - 0.25 * x - 0.36 * z, 0.52 * x + 0.38 * y + 0.76 * z]
}

/// One configuration as shaded polygons, far ones first.
fn draw_frame(svg: &mut String, faces: &[Vec<u32>], frame: &[[f64; 3]], origin: [f64; 2], colour: [f64; 3]) {
    let mut polygons: Vec<(f64, String)> = Vec::new();
    for face in faces {
        let corners: Vec<[f64; 3]> = face.iter().map(|&node| projected(frame[node as usize])).collect();
        let edge = |a: usize, b: usize| [0, 1, 2].map(|i| corners[b][i] - corners[a][i]);
        let (u, v) = (edge(0, 1), edge(0, 3));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        if normal[2] <= 0.0 {
            continue;
        }
        let length = normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        let light = 0.35 + 0.65 * (0.25 * normal[0] + 0.6 * normal[1] + 0.75 * normal[2]).max(0.0) / length;
        let points =
            corners.iter().map(|c| format!("{:.1},{:.1}", origin[0] + 14.0 * c[0], origin[1] - 14.0 * c[1]));
        let points = points.collect::<Vec<_>>().join(" ");
        let depth = corners.iter().map(|c| c[2]).sum::<f64>();
        let fill = colour.map(|c| format!("{:02x}", (c * light.min(1.0)) as u8)).concat();
        polygons.push((depth, format!("<polygon points=\"{points}\" fill=\"#{fill}\"/>\n")));
    }
    polygons.sort_by(|a, b| a.0.total_cmp(&b.0));
    svg.extend(polygons.into_iter().map(|(_, polygon)| polygon));
}

/// A curve over time in a chart that spans 0..4 across and 0..`top` up.
fn curve(records: &[Record], value: impl Fn(&Record) -> f64, top: f64, colour: &str) -> String {
    let point = |r: &Record| format!("{:.1},{:.1}", 70.0 + 215.0 * r.time, 500.0 - 140.0 * value(r) / top);
    let points = records.iter().map(point).collect::<Vec<_>>().join(" ");
    format!("<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"2.5\"/>\n")
}

fn label(x: f64, y: f64, colour: &str, text: &str) -> String {
    format!("<text x=\"{x}\" y=\"{y}\" fill=\"{colour}\">{text}</text>\n")
}

fn picture(mesh: &Mesh, film: &Film) -> Result<String, std::fmt::Error> {
    let mut svg = String::new();
    writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1000 540\" font-family=\"sans-serif\" font-size=\"15\">"
    )?;
    writeln!(
        svg,
        "<rect width=\"1000\" height=\"540\" fill=\"#ffffff\"/><g stroke=\"#33414f\" stroke-width=\"0.5\" stroke-linejoin=\"round\">"
    )?;
    let faces = surface(mesh);
    for (i, (frame, time)) in film.frames.iter().zip(&film.times).enumerate() {
        let x = 70.0 + 160.0 * i as f64;
        // Each configuration is centred on its own place: side by side, not on top of each other.
        let centre = [0, 1, 2].map(|d| frame.iter().map(|q| q[d]).sum::<f64>() / frame.len() as f64);
        let frame: Vec<[f64; 3]> = frame.iter().map(|q| [0, 1, 2].map(|d| q[d] - centre[d])).collect();
        draw_frame(
            &mut svg,
            &faces,
            &frame,
            [x + 25.0, 150.0],
            [90.0 + 27.0 * i as f64, 190.0 - 9.0 * i as f64, 240.0 - 25.0 * i as f64],
        );
        write!(
            svg,
            "</g>{}<g stroke=\"#33414f\" stroke-width=\"0.5\" stroke-linejoin=\"round\">",
            label(x, 318.0, "#33414f", &format!("t = {time}"))
        )?;
    }
    writeln!(svg, "</g><path d=\"M70 360V500H930\" fill=\"none\" stroke=\"#33414f\"/>")?;
    writeln!(
        svg,
        "<rect x=\"70\" y=\"360\" width=\"215\" height=\"140\" fill=\"#33414f\" opacity=\"0.07\"/>"
    )?;
    svg += &label(80.0, 378.0, "#66737f", "load acts");
    let energy = film.records.iter().map(|r| r.total_energy).fold(0.0, f64::max);
    let norm = |r: &Record| r.angular_momentum.iter().map(|l| l * l).sum::<f64>().sqrt();
    let momentum = film.records.iter().map(norm).fold(0.0, f64::max);
    svg += &curve(&film.records, |r| r.total_energy, energy, "#0b6fb8");
    svg += &curve(&film.records, |r| r.kinetic_energy, energy, "#7fb6dc");
    svg += &curve(&film.records, norm, 1.9 * momentum, "#c2571a");
    svg += &label(800.0, 378.0, "#0b6fb8", "total energy H");
    svg += &label(330.0, 424.0, "#5a9bc9", "kinetic energy T");
    svg += &label(765.0, 458.0, "#c2571a", "angular momentum |L|");
    for t in 0..=4 {
        svg += &label(66.0 + 215.0 * f64::from(t), 518.0, "#33414f", &t.to_string());
    }
    svg += &label(480.0, 534.0, "#33414f", "time");
    svg += "</svg>\n";
    Ok(svg)
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, film) = fly()?;
    print!("{}", picture(&mesh, &film)?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_and_angular_momentum_are_flat_after_the_load() {
        let (mesh, film) = fly().unwrap();
        let free: Vec<&Record> = film.records.iter().filter(|r| r.time > 1.0 - 1e-9).collect();
        // Energy and angular momentum of an independent implementation.
        for record in free {
            assert!((record.total_energy - 5500.150056).abs() < 1e-5);
            for (l, expected) in record.angular_momentum.iter().zip([1745.575399, 977.681278, -1233.645985]) {
                assert!((l - expected).abs() < 1e-5);
            }
        }
        assert_eq!(surface(&mesh).len(), 2 * 39 + 3 * 32); // two L of 39 squares, and the rim between them
        assert_eq!(picture(&mesh, &film).unwrap().matches("<polyline").count(), 3);
    }
}
