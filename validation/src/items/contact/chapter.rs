//! Pictures of the book's chapter on contact: the energies of its collision, and the force with layers of several
//! thicknesses.

use emmy::motion::{Motion, Record, State};

use super::trace::Trace;
use crate::case::Case;
use crate::claim::Item;
use crate::picture::{Pictures, Series};

/// Thicknesses of the layer; the second is the default of this input.
const DISTANCES: [f64; 3] = [0.1, 0.05, 0.01];

/// The collision with a thickness, in steps of a size.
fn collision(distance: f64, size: f64) -> Result<Trace, String> {
    let case = Case::new("contact/collision").with("contact.distance", format!("{distance:?}"));
    let input = case.problem()?;
    let text = |error: emmy::Error| format!("collision, distance {distance}: {error}");
    let start = State::initial(&input.body, 0.0, &input.initial).map_err(text)?;
    let mut motion = Motion::starting(&input.body, input.scheme, input.newton, start).map_err(text)?;
    Trace::march(&mut motion, &input.body, size, input.plan.end())
}

/// Adds the pictures, and what holds in them.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn draw(item: &mut Item, pictures: &Pictures) -> Result<(), String> {
    let traces = DISTANCES.map(|distance| collision(distance, 0.005));
    let [thick, default, thin] = traces;
    let traces = [thick?, default?, thin?];
    let start = traces[1].records[0].total_energy;
    let drift = traces.iter().map(|trace| trace.drift(start)).fold(0.0, f64::max);
    item.claim(
        "Collision of the chapter: H is kept to 1e-11 with layers of three thicknesses",
        format!("{drift:.1e}"),
        drift < 1e-11,
    );
    let part = |label: &str, of: fn(&Record) -> f64| {
        let curve = traces[1].records.iter().map(|record| (record.time, of(record))).collect();
        Series::line(label, curve)
    };
    let parts = vec![
        part("all", |record| record.total_energy),
        part("kinetic", |record| record.kinetic_energy),
        part("strain", |record| record.strain_energy),
        part("contact", |record| record.contact_energy),
    ];
    let title = "A ball strikes a plate";
    item.pictures.push(pictures.linear("contact-collision", title, ["t", "energy"], parts)?);
    let forces = DISTANCES.iter().zip(&traces).map(|(distance, trace)| {
        Series::line(&format!("distance = {distance}"), trace.normal().collect::<Vec<_>>())
    });
    let axes = ["t", "vertical force on the ball"];
    item.pictures.push(pictures.linear("contact-distance", title, axes, forces.collect())?);
    item.commands.push("emmy run validation/inputs/contact/collision.toml".into());
    Ok(())
}
