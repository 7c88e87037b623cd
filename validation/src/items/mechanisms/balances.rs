//! Balances of two tumbling bodies with every kind of joint.

use std::f64::consts::PI;

use emmy::motion::{Motion, Record, State};
use emmy::prelude::*;

use super::Effort;
use crate::claim::Item;
use crate::measure::norm;

/// Two free bodies with a joint, which tumble.
fn tumbling(joint: Joint) -> Result<(Body, State), String> {
    let text = |error: emmy::Error| error.to_string();
    let body = Body::builder(Mesh::without_cells())
        .rigid(RigidBody::new("a", 2.0, [1.0, 0.0, 0.3], [0.5, 0.6, 0.8]))
        .rigid(RigidBody::new("b", 1.0, [-0.7, 0.4, 0.0], [0.3, 0.25, 0.2]))
        .joint(joint)
        .build()
        .map_err(text)?;
    let start = InitialVelocity {
        velocity: [0.1, 0.2, -0.3],
        angular_velocity: [0.7, -1.1, 0.9],
        ..Default::default()
    };
    let state = State::initial(&body, 0.0, &[start]).map_err(text)?;
    Ok((body, state))
}

/// Largest changes against the start: energy less what is booked, over that of the start; linear and angular momentum;
/// constraints. Largest rise of the energy in a step, and the dissipated energy.
#[derive(Debug, Clone, Copy)]
struct Changes {
    energy: f64,
    linear: f64,
    angular: f64,
    constraints: f64,
    rise: f64,
    dissipated: f64,
}

/// Changes over 40 steps of 0.05.
fn changes(joint: Joint, scheme: &str, degree: usize) -> Result<Changes, String> {
    let text = |error: emmy::Error| error.to_string();
    let (body, state) = tumbling(joint)?;
    let scheme = Scheme::from_name(scheme).and_then(|scheme| scheme.with_degree(degree)).map_err(text)?;
    let mut motion = Motion::new(&body, scheme).and_then(|motion| motion.from(state)).map_err(text)?;
    let first = motion.record().clone();
    let booked = |record: &Record| record.total_energy - record.external_work + record.dissipated_energy;
    let apart = |a: [f64; 3], b: [f64; 3]| norm([0, 1, 2].map(|d| a[d] - b[d]));
    let (mut last, mut own) = (first.total_energy, [0.0f64; 4]);
    let (mut rise, mut dissipated) = (f64::NEG_INFINITY, 0.0);
    for _ in 0..40 {
        let record = motion.step(0.05).map_err(text)?;
        let now = [
            (booked(record) - booked(&first)).abs() / first.total_energy,
            apart(record.linear_momentum, first.linear_momentum),
            apart(record.angular_momentum, first.angular_momentum),
            record.constraint_residual,
        ];
        own = [0, 1, 2, 3].map(|i| own[i].max(now[i]));
        (rise, last, dissipated) =
            (rise.max(record.total_energy - last), record.total_energy, record.dissipated_energy);
    }
    let [energy, linear, angular, constraints] = own;
    Ok(Changes { energy, linear, angular, constraints, rise, dissipated })
}

/// Joints that only constrain, and joints that are driven, sprung and damped.
fn joints() -> Vec<(&'static str, Joint)> {
    let (axis, place) = ([0.3, -0.2, 0.9], [0.4, 0.1, -0.2]);
    let joint = move |kind| {
        let between = ["a", "b"].map(|name| JointEnd::Rigid(name.into()));
        Joint::new("joint", kind, between, place)
    };
    let hinge = || joint(JointKind::Revolute { axis });
    let turns = TimeFunction::smooth("4*pi*(t/2 - sin(pi*t)/(2*pi))", |t| {
        [
            2.0 * PI * t - 2.0 * (PI * t).sin(),
            2.0 * PI * (1.0 - (PI * t).cos()),
            2.0 * PI * PI * (PI * t).sin(),
        ]
    });
    let motor = TimeFunction::smooth("0.5*sin(3*t)", |t| {
        [0.5 * (3.0 * t).sin(), 1.5 * (3.0 * t).cos(), -4.5 * (3.0 * t).sin()]
    });
    vec![
        ("spherical", joint(JointKind::Spherical)),
        ("revolute", hinge()),
        ("universal", joint(JointKind::Universal { axes: [axis, [1.0, 0.2, 0.1]] })),
        ("cylindrical", joint(JointKind::Cylindrical { axis })),
        ("prismatic", joint(JointKind::Prismatic { axis })),
        ("inline", joint(JointKind::Inline { axis })),
        ("planar", joint(JointKind::Planar { axis })),
        ("fixed", joint(JointKind::Fixed)),
        ("distance", joint(JointKind::Distance { to: [-1.0, 0.2, 0.1] })),
        ("driven angle, two turns", hinge().driven(turns)),
        ("torsion spring", hinge().with_spring(4.0, None)),
        ("damper", hinge().with_damping(0.3)),
        ("motor", hinge().with_motor(motor)),
    ]
}

/// Claims that energies and momenta balance.
///
/// # Errors
/// The message of a step that fails.
pub(super) fn balances(item: &mut Item, effort: Effort) -> Result<(), String> {
    let header = ["two bodies, 40 steps, k = 1, 2, 3", "H", "P", "L", "constraints"];
    let mut table = vec![header.map(String::from).to_vec()];
    let mut worst = [[0.0f64; 4]; 2];
    let degrees = if effort.quick { 2..=2 } else { 1..=3 };
    for (name, joint) in joints() {
        let mut own = [0.0f64; 4];
        for degree in degrees.clone() {
            let now = changes(joint.clone(), "DGM", degree)?;
            let now = [now.energy, now.linear, now.angular, now.constraints];
            own = [0, 1, 2, 3].map(|i| own[i].max(now[i]));
        }
        let acts = usize::from(joint.drive.is_some() || joint.has_force());
        worst[acts] = [0, 1, 2, 3].map(|i| worst[acts][i].max(own[i]));
        let cells = own.iter().map(|value| format!("{value:.1e}"));
        table.push(std::iter::once(name.to_string()).chain(cells).collect());
    }
    item.tables.push(table);
    let words = |[energy, linear, angular, constraints]: [f64; 4]| {
        format!("H {energy:.1e}, P {linear:.1e}, L {angular:.1e}, constraints {constraints:.1e}")
    };
    let largest = |own: [f64; 4]| own.into_iter().fold(0.0, f64::max);
    item.claim(
        "Two tumbling bodies: every kind of joint keeps energy, momenta and itself to 1e-13",
        words(worst[0]),
        largest(worst[0]) < 1e-13,
    );
    item.claim(
        "Two tumbling bodies: energy less work and dissipation, and momenta, are kept to 1e-11 with drive, spring, damper and motor",
        words(worst[1]),
        largest(worst[1]) < 1e-11,
    );
    for degree in 1..=2 {
        let (_, hinge) = joints().swap_remove(10);
        let own = changes(hinge, "DGM(0.5)", degree)?;
        item.claim(
            format!("DGM(0.5) of degree {degree}, a hinge with a spring: no step gains energy, and what is lost is booked to 1e-13"),
            format!("loss {:.1e}, largest rise {:.1e}, not booked {:.1e}", own.dissipated, own.rise, own.energy),
            own.rise < 1e-14 && own.dissipated > 0.0 && own.energy < 1e-13,
        );
    }
    Ok(())
}
