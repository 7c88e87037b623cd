//! Problems with digits, from `data/mechanisms.toml`, whose first lines explain the keys.

use emmy::body::Body;
use emmy::motion::Record;
use emmy_io::input::Problem as Input;
use serde::Deserialize;

use crate::case::Case;

/// A problem with its digits.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Problem {
    /// Key word, also the stem of its input.
    pub name: String,
    /// Heading of its table.
    pub title: String,
    /// Where it is from.
    pub source: String,
    /// Its data in words.
    pub data: String,
    /// The compared quantity.
    pub quantity: Quantity,
    /// Angles at the start.
    #[serde(default)]
    pub start: Vec<f64>,
    /// The quantity at some times.
    pub state: Vec<Digits>,
    /// Step sizes of the degrees 1, 2, 3.
    pub sizes: [Vec<f64>; 3],
    /// Step size of degree 2 in the quick set, if not the first one.
    pub quick: Option<f64>,
    /// Two degrees that agree on the digits.
    pub agree: Option<Agreement>,
    /// Errors of an independent implementation at the last time: degree, step size, error.
    #[serde(default)]
    pub elsewhere: Vec<(usize, f64, f64)>,
    /// The relative difference from these that their digits allow.
    #[serde(default = "two_percent")]
    pub within: f64,
    /// A period.
    pub period: Option<Period>,
    /// Acceleration, where the energy with the potential of it is known.
    #[serde(default)]
    pub gravity: [f64; 3],
    /// Energy.
    pub energy: Option<f64>,
    /// Angular momentum about the vertical.
    pub vertical: Option<f64>,
    /// Bound of the error of the energy by which a solution is judged.
    pub judged: Option<f64>,
    /// Whether it takes minutes.
    #[serde(default)]
    pub long: bool,
}

fn two_percent() -> f64 {
    0.02
}

/// A quantity at a time.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Digits {
    /// Time.
    pub time: f64,
    /// Numbers; a motion may be without its velocity.
    pub value: Vec<f64>,
}

/// Runs of two degrees that agree.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Agreement {
    /// Degrees and step sizes.
    pub runs: [(usize, f64); 2],
    /// Number of digits after the point.
    pub digits: i32,
    /// Whether the runs take minutes.
    #[serde(default)]
    pub long: bool,
}

/// A period by the zeros of a quantity.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Period {
    /// Numbers of the first and the last zero; 0 is the start.
    pub zeros: [usize; 2],
    /// The period over the time between them.
    pub factor: f64,
    /// The quantity.
    pub of: Component,
    /// The period.
    pub value: f64,
    /// Allowed error.
    pub tolerance: f64,
}

/// Quantities of a state.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Quantity {
    Position(String),
    Point { body: String, at: [f64; 3] },
    Motion { body: String, at: [f64; 3] },
    Axes(String),
    Angles(Vec<String>),
}

/// A component of the motion of a rigid body: its name, and `x`, `y` or `z`.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Component {
    Position(String, Axis),
    Velocity(String, Axis),
    BodyRate(String, Axis),
}

/// An axis.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

/// The file.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// Problems with exact digits.
    #[serde(rename = "problem")]
    pub problems: Vec<Problem>,
    /// Results of an independent implementation.
    pub discrete: Vec<Discrete>,
}

/// A problem whose results are those of an independent implementation with the same step size.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Discrete {
    /// Its name in the table.
    pub title: String,
    /// Its input.
    pub input: String,
    /// Its data in words.
    pub data: String,
    /// End of the runs.
    pub until: f64,
    /// Node whose position is compared, by its place in the drawing.
    pub point: [f64; 3],
    /// Results.
    pub runs: Vec<DiscreteRun>,
}

/// Results at the end of a run.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DiscreteRun {
    /// Degree.
    pub degree: usize,
    /// Step size.
    pub size: f64,
    /// Kinetic energy, strain energy, work of the drive.
    pub kinetic_energy: f64,
    pub strain_energy: f64,
    pub work: f64,
    /// Position of the node.
    pub position: [f64; 3],
}

/// The problems and their digits.
///
/// # Errors
/// The message of a file that cannot be read.
pub(super) fn file() -> Result<File, String> {
    let text = include_str!("../../../data/mechanisms.toml");
    toml::from_str(text).map_err(|error| format!("data/mechanisms.toml: {error}"))
}

impl Problem {
    /// Its input.
    pub(super) fn case(&self) -> Case {
        Case::new(format!("mechanisms/{}", self.name))
    }

    /// Step sizes in the quick set: one of degree 2.
    pub(super) fn quick_sizes(&self, degree: usize) -> Vec<f64> {
        let own = self.quick.or(self.sizes[1].first().copied()).filter(|_| degree == 2);
        own.into_iter().collect()
    }

    /// The last time.
    pub(super) fn end(&self) -> f64 {
        self.state.last().map_or(0.0, |state| state.time)
    }

    /// Distance of a record from given numbers.
    pub(super) fn error(&self, body: &Body, record: &Record, exact: &[f64]) -> f64 {
        self.quantity.distance(&self.quantity.value(body, record, &self.start), exact)
    }

    /// Energy with the potential of gravity.
    pub(super) fn energy_with_gravity(&self, input: &Input, record: &Record) -> f64 {
        let height = |own: &emmy::body::RigidBody, at: [f64; 3]| -> f64 {
            own.mass * (0..3).map(|d| self.gravity[d] * at[d]).sum::<f64>()
        };
        let bodies = input.rigid.iter().zip(&record.rigid_bodies);
        record.total_energy - bodies.map(|(own, motion)| height(own, motion.position)).sum::<f64>()
    }
}

impl Quantity {
    /// Its numbers, of angles with those at the start.
    pub(super) fn value(&self, body: &Body, record: &Record, start: &[f64]) -> Vec<f64> {
        match self {
            Quantity::Position(name) => rigid(body, record, name).position.to_vec(),
            Quantity::Point { body: name, at } => point(body, record, name, *at)[..3].to_vec(),
            Quantity::Motion { body: name, at } => point(body, record, name, *at).to_vec(),
            Quantity::Axes(name) => rigid(body, record, name).axes.concat(),
            Quantity::Angles(names) => {
                let angle = |name: &String| {
                    let joint = body.joints().iter().position(|joint| joint.name == *name);
                    joint.map_or(f64::NAN, |joint| record.joints[joint].coordinate)
                };
                names.iter().zip(start).map(|(name, start)| start + angle(name)).collect()
            }
        }
    }
}

impl Quantity {
    /// Distance of its numbers from others: of axes and angles the largest difference, of a motion that of the
    /// position.
    pub(super) fn distance(&self, own: &[f64], other: &[f64]) -> f64 {
        let own = if matches!(self, Quantity::Motion { .. }) { &own[..3] } else { own };
        let differences = own.iter().zip(other).map(|(own, other)| (own - other).abs());
        match self {
            Quantity::Axes(_) | Quantity::Angles(_) => differences.fold(0.0, f64::max),
            _ => differences.map(|difference| difference.powi(2)).sum::<f64>().sqrt(),
        }
    }
}

impl Component {
    /// Its value.
    pub(super) fn value(&self, body: &Body, record: &Record) -> f64 {
        match self {
            Component::Position(name, axis) => rigid(body, record, name).position[*axis as usize],
            Component::Velocity(name, axis) => rigid(body, record, name).velocity[*axis as usize],
            Component::BodyRate(name, axis) => {
                let motion = rigid(body, record, name);
                (0..3).map(|d| motion.axes[*axis as usize][d] * motion.spin[d]).sum()
            }
        }
    }
}

/// Motion of a rigid body.
fn rigid(body: &Body, record: &Record, name: &str) -> emmy::body::RigidMotion {
    let number = body.rigid_bodies().position(|own| own.name == name).expect("the data names a rigid body");
    record.rigid_bodies[number]
}

/// Position and velocity of a point of a rigid body.
fn point(body: &Body, record: &Record, name: &str, at: [f64; 3]) -> [f64; 6] {
    let motion = rigid(body, record, name);
    let own = body.rigid_bodies().find(|own| own.name == name).expect("the data names a rigid body");
    let centre = own.centre.expect("a body without cells has a centre");
    let arm = [0, 1, 2].map(|d| (0..3).map(|i| motion.axes[i][d] * (at[i] - centre[i])).sum::<f64>());
    let turned = [0, 1, 2].map(|d| {
        let (a, b) = ((d + 1) % 3, (d + 2) % 3);
        motion.spin[a] * arm[b] - motion.spin[b] * arm[a]
    });
    let (x, v) = (motion.position, motion.velocity);
    std::array::from_fn(|i| if i < 3 { x[i] + arm[i] } else { v[i - 3] + turned[i - 3] })
}
