//! A uniform pressure that passes through the contact with a plane.

use emmy::body::{Body, Contact, FieldName, Fields, LayerLaw, Obstacle};
use emmy::equilibrium::Equilibrium;
use emmy::mesh::CellKind;
use emmy::motion::NewtonSettings;
use emmy::prelude::{Load, Support};

use super::data::{Problem, Run};
use super::{Measured, ball};
use crate::items::locking::{Face, Grid};
use crate::measure::cpu_seconds;

/// Largest difference of the normal stress in a cell from the pressure, over the pressure.
///
/// # Errors
/// The message of an equilibrium that is not found.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let text = |error: emmy::Error| error.to_string();
    let begin = cpu_seconds();
    let kind = match run.kind.as_deref() {
        Some("hex20") => CellKind::Hex20,
        Some("hex27") => CellKind::Hex27,
        Some("tet10") => CellKind::Tet10,
        _ => CellKind::Hex8,
    };
    let edge = 1.0 / run.cells as f64;
    let map = |x: [f64; 3]| x.map(|x| edge * x);
    let face = |d: usize, at: f64| move |x: [f64; 3]| (x[d] - at).abs() < 1e-9;
    let faces =
        [("x-min", face(0, 0.0)), ("y-min", face(1, 0.0)), ("z-min", face(2, 0.0)), ("z-max", face(2, 1.0))];
    let faces: Vec<Face<'_>> = faces.iter().map(|(name, on)| (*name, on as _)).collect();
    let mesh = Grid { kind, n: [run.cells; 3], map: &map }.mesh(&faces)?;
    let (pressure, thickness) = (0.02, 0.1 * edge);
    let plane = Obstacle::Plane { point: [0.0, 0.0, -0.98 * thickness], normal: [0.0, 0.0, 1.0] };
    let body = Body::builder(mesh)
        .region(ball::rubber(1.0, 0.3, 1.0)?)
        .support(Support::of_components("x-min", [true, false, false]))
        .support(Support::of_components("y-min", [false, true, false]))
        .load(Load::traction("z-max", [0.0, 0.0, -pressure]))
        .contact(
            Contact::with_obstacle("z-min", plane)
                .with_distance(thickness)
                .with_stiffness(1.0)
                .with_law(LayerLaw::Smooth),
        )
        .build()
        .map_err(text)?;
    let settings = NewtonSettings { tolerance: 1e-14, ..NewtonSettings::default() };
    let state = Equilibrium::new(&body, 0.0, 1).map_err(text)?.start(settings, &[], &mut []);
    let state = state.map_err(|error| error.to_string())?;
    let velocity = vec![0.0; state.displacement.len()];
    let fields = Fields::new(&body).at([&state.displacement, &velocity], &[FieldName::CellCauchyStress]);
    // A uniform state has the section of the deformed block.
    let far = body.mesh().nearest_node([1.0, 1.0, 1.0]);
    let section = (1.0 + state.displacement[3 * far]) * (1.0 + state.displacement[3 * far + 1]);
    let error = fields[0].numbers.chunks(6).map(|stress| (stress[2] * section / pressure + 1.0).abs());
    Ok(Measured {
        values: vec![error.fold(0.0, f64::max)],
        seconds: cpu_seconds() - begin,
        ..Measured::default()
    })
}
