//! Balls of rubber that fly about in a box.

use emmy::body::{Body, Contact, Obstacle};
use emmy::mesh::{self, MeshBuilder, Placement};
use emmy::motion::{Motion, State};
use emmy::prelude::{InitialVelocity, NeoHooke, Region};
use emmy::time::Scheme;

use super::Measured;
use super::data::{Problem, Run};
use crate::measure::{cpu_seconds, norm};

/// Radius of a ball, distance of the middles at the start, and largest velocity along an axis.
const RADIUS: f64 = 0.5;
const APART: f64 = 1.2;
const VELOCITY: f64 = 3.0;

/// Largest changes of H, of P without the impulse of the walls and of L without their moment, each over the sum of the
/// sizes at the start; number of steps after which a gap was not above zero; smallest gap over the thickness of the
/// layer; number of steps in parts. The run has as many balls along each axis as its bodies.
///
/// # Errors
/// The message of a run that fails.
pub(super) fn measure(_: &Problem, run: &Run) -> Result<Measured, String> {
    let text = |error: emmy::Error| format!("{}: {error}", run.label());
    let n = (run.bodies as f64).cbrt().round() as usize;
    let layer = run.layer(4000.0 / 3.0)?;
    let mut seed = 7u64;
    let mut random = move || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let (mut builder, mut thrown) = (MeshBuilder::new(), Vec::new());
    for number in 0..n.pow(3) {
        let middle = [number % n, number / n % n, number / n / n].map(|i| APART * (i as f64 + 0.5));
        let ball = mesh::ball(RADIUS, run.cells).map_err(text)?;
        let place = Placement::default().shifted(middle);
        builder.part(&format!("ball-{number}"), &ball.placed(&place).map_err(text)?).map_err(text)?;
        thrown.push(InitialVelocity {
            group: Some(format!("ball-{number}")),
            velocity: [0; 3].map(|_| VELOCITY * random()),
            angular_velocity: [0; 3].map(|_| VELOCITY * random()),
            about: middle,
            ..InitialVelocity::default()
        });
    }
    let laid = |contact: Contact| {
        contact.with_distance(layer.thickness).with_stiffness(layer.modulus).with_law(layer.law)
    };
    let region = Region::new(NeoHooke::new(1000.0, 500.0).map_err(text)?, 1.0);
    let mut body =
        Body::builder(builder.build().map_err(text)?).region(region).contact(laid(Contact::of_all_bodies()));
    for (axis, side) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let (mut point, mut normal) = ([0.0; 3], [0.0; 3]);
        normal[axis] = side;
        point[axis] = if side > 0.0 { 0.0 } else { APART * n as f64 };
        body = body.contact(laid(Contact::of_all_with_obstacle(Obstacle::Plane { point, normal })));
    }
    let body = body.build().map_err(text)?;
    let scheme = Scheme::from_name(&run.scheme).and_then(|own| own.with_degree(run.degree)).map_err(text)?;
    let start = State::initial(&body, 0.0, &thrown).map_err(text)?;
    let mut motion = Motion::new(&body, scheme).and_then(|motion| motion.from(start)).map_err(text)?;
    let mut walk = Walk { end: motion.record().clone(), ..Walk::default() };
    let first = motion.record().clone();
    let masses = body.lumped_mass();
    let momenta = motion.state().velocity.chunks(3).zip(masses).map(|(v, m)| m * norm([v[0], v[1], v[2]]));
    let momentum: f64 = momenta.sum();
    let (mut energy, mut linear, mut angular) = (0.0f64, 0.0f64, 0.0f64);
    let begin = cpu_seconds();
    let steps = run.steps.ok_or("a number of steps is needed")?;
    for _ in 0..steps {
        walk.advance(&mut motion, run.size).map_err(text)?;
        let record = &walk.end;
        energy = energy.max((record.total_energy - first.total_energy).abs());
        let rest = |now: [f64; 3], first: [f64; 3], given: [f64; 3]| {
            norm([0, 1, 2].map(|d| now[d] - first[d] - given[d]))
        };
        linear = linear.max(rest(record.linear_momentum, first.linear_momentum, walk.impulse));
        angular = angular.max(rest(record.angular_momentum, first.angular_momentum, walk.moment));
    }
    let values = vec![
        energy / first.total_energy,
        linear / momentum,
        angular / (momentum * APART * n as f64),
        walk.n_touching as f64,
        walk.smallest_gap,
        walk.n_parted as f64,
    ];
    let seconds = cpu_seconds() - begin;
    Ok(Measured {
        values,
        steps,
        corrections: walk.corrections as f64 / steps as f64,
        seconds,
        ..Measured::default()
    })
}

/// Extremes since the start.
#[derive(Debug)]
struct Walk {
    end: emmy::motion::Record,
    /// Impulse of the walls, and its moment.
    impulse: [f64; 3],
    moment: [f64; 3],
    /// Steps after which something touched, and steps in parts.
    n_touching: usize,
    n_parted: usize,
    smallest_gap: f64,
    corrections: usize,
}

impl Default for Walk {
    fn default() -> Self {
        Walk {
            end: emmy::motion::Record::default(),
            impulse: [0.0; 3],
            moment: [0.0; 3],
            n_touching: 0,
            n_parted: 0,
            smallest_gap: 1.0,
            corrections: 0,
        }
    }
}

impl Walk {
    /// Takes a step, in halves where it fails.
    fn advance(&mut self, motion: &mut Motion<'_>, size: f64) -> emmy::Result<()> {
        match motion.step(size) {
            Ok(record) => self.end = record.clone(),
            Err(error) if size < 1e-6 => return Err(error),
            Err(_) => {
                self.n_parted += 1;
                self.advance(motion, 0.5 * size)?;
                return self.advance(motion, 0.5 * size);
            }
        }
        // The first contact is that between the balls.
        for wall in &motion.reactions()[1..] {
            (0..3).for_each(|d| self.impulse[d] += size * wall.force[d]);
            (0..3).for_each(|d| self.moment[d] += size * wall.moment[d]);
        }
        let gap = self.end.smallest_gap.unwrap_or(1.0);
        self.n_touching += usize::from(gap <= 0.0);
        self.smallest_gap = self.smallest_gap.min(gap);
        self.corrections += self.end.newton_iterations;
        Ok(())
    }
}
