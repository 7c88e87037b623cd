//! Gradients of motions that start from an equilibrium, which depends on the parameters: differences of whole motions,
//! each from its own equilibrium.

use emmy::adjoint::{Parameter, Trajectory};
use emmy::body::{Body, Formulation, GroundSpring, InitialVelocity, PointTerms, Region};
use emmy::equilibrium::Equilibrium;
use emmy::material::{Hencky, NeoHookeIsochoric, Volumetric};
use emmy::mesh::{self, CellKind, Mesh};
use emmy::motion::{Motion, State};
use emmy::prelude::{Load, NeoHooke, Support};
use emmy::time::Scheme;

use super::problems::*;
use crate::shared::patch::Patch;
use crate::shared::schemes::{DGM, assumed_strain, at, fe};

/// Stiffness, density, factor of the traction, stiffness per area of a bed.
const VALUES: [f64; 4] = [15.0, 1.2, 2.0, 30.0];

/// A body on its lower face and a bed of springs, drawn by a traction that is released (with a jump at the start, and
/// later with a kink), under its own weight.
fn body(mesh: Mesh, region: impl Fn(f64) -> Region, [mu, density, traction, bed]: [f64; 4]) -> Result<Body> {
    let is_solid = mesh.groups().names().contains(&"z-min");
    let [lower, upper] = if is_solid { ["z-min", "z-max"] } else { ["y-min", "y-max"] };
    let springs = vec![GroundSpring { group: "x-min".into(), stiffness: bed }];
    let pull = [traction, 0.4 * traction, if is_solid { 0.7 * traction } else { 0.0 }];
    let weight = if is_solid { [0.3, 0.2, -1.0] } else { [0.3, -1.0, 0.0] };
    let mut region = region(mu);
    region.density = density;
    Body::builder(mesh)
        .region(region)
        .support(Support::fixed(lower))
        .point_terms(PointTerms { springs, ..Default::default() })
        .load(Load::traction(upper, pull).over([(0.0, 1.0), (0.0, 0.6), (0.3, 0.2), (1.0, 0.0)])?)
        .load(Load::acceleration(weight))
        .build()
}

fn spin() -> InitialVelocity {
    InitialVelocity { angular_velocity: [0.0, 0.0, 0.4], ..Default::default() }
}

fn start(body: &Body) -> State {
    Equilibrium::new(body, 0.0, 2).unwrap().start(settings(), &[spin()], &mut []).unwrap()
}

type Make<'m> = Box<dyn Fn([f64; 4]) -> Result<Body> + 'm>;

/// The largest relative difference between a derivative by a parameter and differences of whole motions.
fn error(body: &Make<'_>, (scheme, degree): (Scheme, usize), linear: bool) -> f64 {
    let own = body(VALUES).unwrap();
    let (plan, goal) = (equal(0.45, 0.15), scattered_goal(&own));
    let varied = |index: usize, value: f64| {
        let mut values = VALUES;
        values[index] = value;
        body(values)
    };
    let parameter = |index: usize| match linear {
        true => Parameter::linear(VALUES[index], VALUES[index], |value| varied(index, value)),
        false => Parameter::smooth(VALUES[index], VALUES[index], |value| varied(index, value)),
    };
    let parameters: Vec<Parameter> = (0..4).map(|index| parameter(index).unwrap()).collect();
    let gradient =
        trajectory(&own, scheme, degree, &start(&own), &plan).gradient(&goal, &parameters).unwrap();
    let error = |(index, by): (usize, &f64)| {
        let slope = slope(5e-4 * VALUES[index], |d| {
            let body = varied(index, VALUES[index] + d).unwrap();
            goal.value(&end(&body, scheme, degree, &start(&body), &plan))
        });
        (by - slope).abs() / slope.abs()
    };
    gradient.parameters.iter().enumerate().map(error).fold(0.0, f64::max)
}

#[test]
fn the_equilibrium_at_the_start_depends_on_the_parameters() {
    let block = || mesh::block([1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    let square = || mesh::rectangle([1.0, 2.0], [1, 2]).unwrap();
    let quadratic = || Patch { bricks: 1, curved: false, distortion: 0.0 }.mesh(CellKind::Hex20);
    let rubber = |mu: f64| Region::new(NeoHooke::new(30.0, mu).unwrap(), 1.0);
    let isochoric = |mu: f64| Region::new(NeoHookeIsochoric::new(mu, 150.0, Volumetric::Miehe).unwrap(), 1.0);
    let hencky = |mu: f64| Region::new(Hencky::new(30.0, mu).unwrap(), 1.0);
    let projected = move |mu: f64| isochoric(mu).with_formulation(Formulation::ProjectedVolume(None));
    let modes = move |mu: f64| hencky(mu).with_formulation(Formulation::IncompatibleModes);
    let bodies: [(&str, Make<'_>); 5] = [
        ("standard", Box::new(move |values| body(block(), rubber, values))),
        ("plane", Box::new(move |values| body(square(), rubber, values))),
        ("projected volume", Box::new(move |values| body(block(), projected, values))),
        ("projected volume, hex20", Box::new(move |values| body(quadratic(), projected, values))),
        ("incompatible modes", Box::new(move |values| body(block(), modes, values))),
    ];
    for (name, body) in &bodies {
        for (scheme, k, linear) in
            [(DGM, 1, false), (DGM, 2, true), (assumed_strain(3), 2, true), (fe(2), 1, false)]
        {
            let error = error(body, (scheme, k), linear);
            println!("{name}, {scheme}, k = {k}: {error:.1e}");
            assert!(error < 2e-8, "{name}, {scheme}, k = {k}: {error:e}");
        }
    }
}

/// The same state as data: it does not change with the parameter, nor does a state after a step.
#[test]
fn any_other_start_does_not_depend_on_the_parameters() {
    let rubber = |mu: f64| Region::new(NeoHooke::new(30.0, mu).unwrap(), 1.0);
    let make = |mu: f64| body(mesh::block([1.0, 1.0, 2.0], [1, 1, 2])?, rubber, [mu, 1.2, 2.0, 30.0]);
    let own = make(15.0).unwrap();
    let (plan, goal) = (equal(0.45, 0.15), scattered_goal(&own));
    let parameter = Parameter::smooth(15.0, 15.0, make).unwrap();
    let given = start(&own);
    assert!(given.is_equilibrium && !given.clone().transferred(&own, 0.0).unwrap().is_equilibrium);
    let data = State { is_equilibrium: false, ..given.clone() };
    let by =
        trajectory(&own, DGM, 1, &data, &plan).gradient(&goal, std::slice::from_ref(&parameter)).unwrap();
    let difference = slope(1e-3, |d| goal.value(&end(&make(15.0 + d).unwrap(), DGM, 1, &data, &plan)));
    assert!((by.parameters[0] / difference - 1.0).abs() < 2e-8, "{} {difference}", by.parameters[0]);
    // A trajectory that begins one step later.
    let mut motion = Motion::starting(&own, at(DGM, 1), settings(), given).unwrap();
    motion.step(0.15).unwrap();
    assert!(!motion.state().is_equilibrium);
    let later = motion.state().clone();
    let mut trajectory = Trajectory::new(&motion).unwrap();
    trajectory.record(&motion).unwrap();
    motion.step(0.15).unwrap();
    trajectory.record(&motion).unwrap();
    let by = trajectory.gradient(&goal, &[parameter]).unwrap().parameters[0];
    let one = |mu: f64| {
        let body = make(mu).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, 1), settings(), later.clone()).unwrap();
        motion.step(0.15).unwrap();
        goal.value(motion.state())
    };
    let difference = slope(1e-3, |d| one(15.0 + d));
    assert!((by / difference - 1.0).abs() < 2e-8, "{by} {difference}");
}
