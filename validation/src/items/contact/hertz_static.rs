//! A ball that is pressed on a plane, against Hertz's theory.

use emmy::body::Body;
use emmy::equilibrium::Equilibrium;
use emmy::motion::{Motion, NewtonSettings};
use emmy::prelude::{Support, TimeElement, TimeFunction};

use super::data::{Problem, Run};
use super::{Measured, ball};
use crate::measure::cpu_seconds;

/// Part of the approach, over a/R, by which that of the middle of a ball between two planes is smaller:
/// `4/(3 pi) ((1 + nu)/4 + (1 - nu^2)/2)/(1 - nu^2)` (Tatara).
const FINITE: f64 = 0.3638;

/// Radius 1, Young's modulus 1, Poisson's ratio 0.3; the nodes above the middle move down alike. The load of the run is
/// the radius of the contact that Hertz's theory has for this approach.
///
/// Radius of the contact, approach, approach with the size of the ball, and largest pressure, over those of the theory
/// at the force of the plane.
///
/// # Errors
/// The message of an equilibrium that is not found.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let text = |error: emmy::Error| error.to_string();
    let (poisson, begin) = (0.3, cpu_seconds());
    let aim = run.load.ok_or("a load is needed")?;
    let layer = run.layer(1.0)?;
    let mesh = ball::quarter(1.0, run.cells, 0.5 / aim)?;
    let upper = (0..mesh.n_nodes() as u32).filter(|&node| mesh.points()[node as usize][2] > -1e-9);
    let upper: Vec<u32> = upper.collect();
    let mesh = mesh.with_node_group("upper", upper).map_err(text)?;
    let height = -1.0 - layer.thickness;
    let depth = aim * aim;
    let down = Support::driven(
        "upper",
        [None, None, Some(TimeFunction::smooth("-depth*t", move |t| [-depth * t, -depth, 0.0]))],
    );
    let body = Body::builder(mesh)
        .region(ball::rubber(1.0, poisson, 1.0)?)
        .supports(ball::symmetry())
        .support(down)
        .contact(ball::on_plane(height, layer))
        .build()
        .map_err(text)?;
    let equilibrium = Equilibrium::new(&body, 1.0, 4).map_err(text)?;
    let state = equilibrium
        .start(NewtonSettings::default(), &[], &mut [])
        .map_err(|error| format!("{}: {error}", run.label()))?;
    let pole = body.mesh().nearest_node([0.0, 0.0, -1.0]);
    let approach = depth + state.displacement[3 * pole + 2];
    let [radius, largest] = ball::pressure(body.mesh(), &state.displacement, height, layer)?;
    let motion = Motion::new(&body, TimeElement::discrete_gradient(1).map_err(text)?)
        .and_then(|motion| motion.from(state))
        .and_then(Motion::with_static_reactions)
        .map_err(text)?;
    let force = 4.0 * motion.reactions().last().ok_or("no reaction")?.force[2];
    let modulus = 1.0 / (1.0 - poisson * poisson);
    let hertz = (0.75 * force / modulus).cbrt();
    let values = vec![
        radius / hertz,
        approach / (hertz * hertz),
        approach / (hertz * hertz * (1.0 - FINITE * hertz)),
        largest / (1.5 * force / (std::f64::consts::PI * hertz * hertz)),
    ];
    Ok(Measured { values, seconds: cpu_seconds() - begin, ..Measured::default() })
}
