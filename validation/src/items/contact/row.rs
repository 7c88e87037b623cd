//! Bodies in a row along z that meet each other, and their motion.

use emmy::body::{Body, Contact};
use emmy::mesh::{self, MeshBuilder, Placement};
use emmy::motion::State;
use emmy::prelude::{InitialVelocity, Region};

use super::data::Run;
use super::trace::Trace;

/// A body of the row, with the section 1.
#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    /// Length, number of cells along it, velocity.
    pub length: f64,
    pub cells: usize,
    pub velocity: f64,
    /// From the end of its layer to the body after it.
    pub gap: f64,
}

/// The motion of a row, and what it leaves.
#[derive(Debug)]
pub(super) struct Row {
    pub trace: Trace,
    /// Mean velocities of the bodies at the end.
    pub velocities: Vec<f64>,
    /// Energy at the end besides that of these velocities.
    pub vibration: f64,
}

impl Row {
    /// The motion of bodies of a material, whose layer has its Young's modulus if the run has none.
    ///
    /// # Errors
    /// The message of a step that fails.
    pub(super) fn of(
        members: &[Member],
        region: Region,
        young: f64,
        run: &Run,
        end: f64,
    ) -> Result<Row, String> {
        let text = |error: emmy::Error| error.to_string();
        let layer = run.layer(young)?;
        let (mut builder, mut at, mut n_nodes) = (MeshBuilder::new(), 0.0, Vec::new());
        for (number, own) in members.iter().enumerate() {
            let block = mesh::block([1.0, 1.0, own.length], [1, 1, own.cells]).map_err(text)?;
            let place = Placement::default().shifted([0.0, 0.0, at]);
            n_nodes.push(block.n_nodes());
            builder.part(&format!("body-{number}"), &block.placed(&place).map_err(text)?).map_err(text)?;
            at += own.length + layer.thickness + own.gap;
        }
        let contact = Contact::of_all_bodies().with_distance(layer.thickness);
        let body = Body::builder(builder.build().map_err(text)?)
            .region(region)
            .contact(contact.with_stiffness(layer.modulus).with_law(layer.law))
            .build()
            .map_err(text)?;
        let thrown = members.iter().enumerate().map(|(number, own)| InitialVelocity {
            group: Some(format!("body-{number}")),
            velocity: [0.0, 0.0, own.velocity],
            ..InitialVelocity::default()
        });
        let start = State::initial(&body, 0.0, &thrown.collect::<Vec<_>>()).map_err(text)?;
        let (trace, state) = Trace::with_state(&body, start, run, end)?;
        let (mut first, mut velocities, mut moving) = (0, Vec::new(), 0.0);
        let masses = body.lumped_mass();
        for n in n_nodes {
            let nodes = first..first + n;
            let mass: f64 = nodes.clone().map(|node| masses[node]).sum();
            let momentum: f64 = nodes.map(|node| state.momentum[3 * node + 2]).sum();
            velocities.push(momentum / mass);
            moving += 0.5 * momentum * momentum / mass;
            first += n;
        }
        let last = trace.at(f64::INFINITY);
        let vibration = last.total_energy - moving;
        Ok(Row { trace, velocities, vibration })
    }
}
