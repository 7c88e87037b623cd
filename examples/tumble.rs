//! The block of the README, drawn: the L-shaped block of Betsch and Steinmann (2001) tumbles through space under the
//! hat-shaped load, and its energy and angular momentum stay flat afterwards.
//!
//!     cargo run --release --example tumble > book/src/figures/tumble.svg

use std::error::Error;

use emmy::body::{Body, Load, LoadKind, Region, TimeFunction};
use emmy::material::NeoHooke;
use emmy::mesh::Mesh;
use emmy::motion::{self, Motion, Observer, Phase, Record, State, StepPlan};
use emmy::time::TimeElement;
use emmy_io::chart::{Axis, Chart, Figure, Series, Style};
use emmy_io::drawing::{Arrangement, Configuration, Drawing, Viewpoint};

/// Keeps every record, and the positions at some times.
struct Recorder {
    times: Vec<f64>,
    records: Vec<Record>,
    frames: Vec<Vec<[f64; 3]>>,
}

impl Observer for Recorder {
    fn observe(&mut self, view: motion::View<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.records.push(view.record.clone());
        if self.times.get(self.frames.len()).is_some_and(|time| view.record.time >= time - 1e-9) {
            let nodes = 0..view.body.mesh().n_nodes();
            self.frames.push(nodes.map(|node| view.state.position(view.body, node)).collect());
        }
        Ok(())
    }
}

fn fly() -> emmy::Result<(Mesh, Recorder)> {
    let loads = [("face-a", 1.0), ("face-b", -1.0)].map(|(group, sign)| {
        let traction = [256.0, 512.0, 768.0].map(|t| sign * t / 9.0);
        let time_function = TimeFunction::new(vec![(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)])?;
        Ok(Load { kind: LoadKind::Traction { group: group.into(), traction }, time_function })
    });
    let loads: Vec<Load> = loads.into_iter().collect::<emmy::Result<_>>()?;
    let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 0.5);
    let body = Body::builder(emmy::mesh::l_block(1.0)?).region(rubber).loads(&loads).build()?;
    let state = State::initial(&body, 0.0, &[])?;
    let mut recorder =
        Recorder { times: vec![0.0, 0.6, 1.2, 1.8, 2.4, 3.0], records: vec![], frames: vec![] };
    let mut motion = Motion::new(&body, TimeElement::assumed_strain(5, 1)?)?.from(state)?;
    let plan = vec![Phase { until: 1.0, size: 0.01 }, Phase { until: 4.0, size: 0.04 }];
    motion.march(&StepPlan::new(0.0, plan)?, &mut [&mut recorder]).expect("the paper's block converges");
    Ok((body.mesh().clone(), recorder))
}

/// Six configurations side by side; energy and angular momentum over time below.
fn picture<'a>(mesh: &'a Mesh, recorder: &Recorder) -> Drawing<'a> {
    let configuration = |(time, positions): (&f64, &Vec<[f64; 3]>)| Configuration {
        label: format!("t = {time}"),
        positions: positions.clone(),
    };
    let norm = |r: &Record| r.angular_momentum.iter().map(|l| l * l).sum::<f64>().sqrt();
    let energy = vec![
        curve(recorder, "total energy H", 0, |r| r.total_energy),
        curve(recorder, "kinetic energy T", 5, |r| r.kinetic_energy),
    ];
    let momentum = vec![curve(recorder, "angular momentum |L|", 1, norm)];
    Drawing {
        mesh,
        configurations: recorder.times.iter().zip(&recorder.frames).map(configuration).collect(),
        arrangement: Arrangement::Beside(6),
        view: Viewpoint::default(),
        below: Figure {
            charts: vec![chart("energy", energy), chart("angular momentum |L|", momentum)],
            columns: 2,
        },
    }
}

fn chart(label: &str, series: Vec<Series>) -> Chart {
    let title = "The load acts until t = 1".to_string();
    Chart { title, x: Axis::linear("time t"), y: Axis::linear(label), series, guides: vec![] }
}

fn curve(recorder: &Recorder, label: &str, colour: usize, value: impl Fn(&Record) -> f64) -> Series {
    let points = recorder.records.iter().map(|r| (r.time, value(r))).collect();
    Series { label: label.into(), points, style: Style::Line, colour }
}

fn main() -> Result<(), Box<dyn Error>> {
    let (mesh, recorder) = fly()?;
    print!("{}", picture(&mesh, &recorder).svg());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn energy_and_angular_momentum_are_flat_after_the_load() {
        let (mesh, recorder) = fly().unwrap();
        let free: Vec<&Record> = recorder.records.iter().filter(|r| r.time > 1.0 - 1e-9).collect();
        // Energy and angular momentum of an independent implementation.
        for record in free {
            assert!((record.total_energy - 5500.150056).abs() < 1e-5);
            for (l, expected) in record.angular_momentum.iter().zip([1745.575399, 977.681278, -1233.645985]) {
                assert!((l - expected).abs() < 1e-5);
            }
        }
        let svg = picture(&mesh, &recorder).svg();
        assert!(svg.contains("t = 0.6") && svg.contains("kinetic energy T"));
    }
}
