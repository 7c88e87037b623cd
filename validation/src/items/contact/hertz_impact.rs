//! A ball that is thrown on a plane, against Hertz's theory.

use emmy::body::Body;
use emmy::motion::State;
use emmy::prelude::InitialVelocity;

use super::data::{Problem, Run};
use super::trace::{Trace, crossings};
use super::{Measured, ball};

/// Radius, density, Young's modulus and Poisson's ratio.
const BALL: [f64; 4] = [0.02, 1000.0, 1e6, 0.3];

/// Duration and largest force over those of Hertz, rebound velocity over that before, vibration left over the energy;
/// the load of the run is the velocity.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let text = |error: emmy::Error| error.to_string();
    let [radius, density, young, poisson] = BALL;
    let velocity = run.load.ok_or("a velocity is needed")?;
    let thickness = run.distance.ok_or("a distance is needed")?;
    let layer = run.layer(young)?;
    let modulus = young / (1.0 - poisson * poisson);
    let deepest = |mass: f64| (15.0 * mass * velocity.powi(2) / (16.0 * modulus * radius.sqrt())).powf(0.4);
    let whole = density * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let mesh = ball::quarter(radius, run.cells, 0.5 / (deepest(whole) / radius).sqrt())?;
    let body = Body::builder(mesh)
        .region(ball::rubber(young, poisson, density)?)
        .supports(ball::symmetry())
        .contact(ball::on_plane(-radius - 1.5 * thickness, layer))
        .build()
        .map_err(text)?;
    // The cells lie inside of the ball and are lighter.
    let deepest = deepest(4.0 * body.lumped_mass().iter().sum::<f64>());
    let duration = 2.943_275_2 * deepest / velocity;
    let force = 4.0 / 3.0 * modulus * radius.sqrt() * deepest.powf(1.5);
    let thrown = InitialVelocity { velocity: [0.0, 0.0, -velocity], ..Default::default() };
    let start = State::initial(&body, 0.0, &[thrown]).map_err(text)?;
    let trace = Trace::from(&body, start, run, 1.3 * duration)?;
    let largest = trace.normal().map(|(_, force)| force).fold(0.0, f64::max);
    // At a hundredth of the force, the ball has still all of its velocity.
    let passes = crossings(trace.normal(), 0.01 * largest);
    let [first, last] = [passes.first(), passes.last()].map(|time| time.copied().unwrap_or(f64::NAN));
    let outside = 2.0 * 0.01f64.powf(2.0 / 3.0) / 2.943_275_2;
    let (start, end) = (&trace.records[0], trace.at(f64::INFINITY));
    let values = vec![
        (last - first) / (1.0 - outside) / duration,
        4.0 * largest / force,
        trace.velocity(end) / velocity,
        (end.total_energy - 0.5 * trace.mass * trace.velocity(end).powi(2)) / start.kinetic_energy,
        trace.drift(start.kinetic_energy),
    ];
    let curve = trace.normal().map(|(time, own)| ((time - first) / duration, 4.0 * own / force)).collect();
    Ok(Measured::of(values, &trace).with_curve(curve))
}
