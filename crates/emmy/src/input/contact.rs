//! Contacts of surfaces.

use super::TimeFunction;
use crate::contact::{LayerLaw, ObstacleSurface};
use crate::error::Error;
use crate::tensor::dot3;

/// An obstacle; at rest, unless its contact moves it ([`Contact::moved`]).
///
/// ```
/// use emmy::body::Obstacle;
/// let bowl = Obstacle::Sphere { centre: [0.0; 3], radius: 2.0, inside: true };
/// assert_ne!(bowl, Obstacle::Plane { point: [0.0; 3], normal: [0.0, 0.0, 2.0] });
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// A half-space.
    Plane {
        /// A point of its surface \[length\].
        point: [f64; 3],
        /// Direction out of it, towards the body, of any length.
        normal: [f64; 3],
    },
    /// A sphere.
    Sphere {
        /// Centre \[length\].
        centre: [f64; 3],
        /// Radius \[length\].
        radius: f64,
        /// Whether the body is inside.
        inside: bool,
    },
    /// A cylinder without ends.
    Cylinder {
        /// A point of its axis \[length\].
        point: [f64; 3],
        /// Direction of its axis, of any length.
        axis: [f64; 3],
        /// Radius \[length\].
        radius: f64,
        /// Whether the body is inside.
        inside: bool,
    },
}

/// The key of a contact that is wrong, and the reason.
pub(crate) type ContactFault = (&'static str, String);

impl Obstacle {
    /// Its surface; the error is the fault for which there is none.
    pub(crate) fn surface(&self) -> Result<ObstacleSurface, ContactFault> {
        let round = |origin, axis, radius: f64, inside| {
            if !(radius > 0.0 && radius.is_finite()) {
                let reason = format!("the radius of its obstacle must be a positive number, not {radius}");
                return Err(("radius", reason));
            }
            let sign = if inside { -1.0 } else { 1.0 };
            Ok(ObstacleSurface::Round { origin, axis, radius, sign })
        };
        match *self {
            Obstacle::Plane { point, normal } => {
                let (origin, normal) = (finite("point", point)?, unit("normal", normal)?);
                Ok(ObstacleSurface::Plane { origin, normal })
            }
            Obstacle::Sphere { centre, radius, inside } => {
                round(finite("centre", centre)?, [0.0; 3], radius, inside)
            }
            Obstacle::Cylinder { point, axis, radius, inside } => {
                round(finite("point", point)?, unit("axis", axis)?, radius, inside)
            }
        }
    }
}

fn finite(what: &'static str, place: [f64; 3]) -> Result<[f64; 3], ContactFault> {
    match place.iter().find(|value| !value.is_finite()) {
        Some(value) => Err((what, format!("the {what} of its obstacle must be finite numbers, not {value}"))),
        None => Ok(place),
    }
}

fn unit(what: &'static str, direction: [f64; 3]) -> Result<[f64; 3], ContactFault> {
    let size = dot3(direction, direction).sqrt();
    match size > 0.0 && size.is_finite() {
        true => Ok(direction.map(|x| x / size)),
        false => Err((what, format!("the {what} of its obstacle has no direction"))),
    }
}

/// The opponent that a surface may touch.
///
/// ```
/// use emmy::body::Opponent;
/// assert_ne!(Opponent::Surface("floor".into()), Opponent::Bodies);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Opponent {
    /// An obstacle.
    Obstacle(Obstacle),
    /// Another surface: a group of facets, or of cells, whose facets on the boundary are meant.
    Surface(String),
    /// The bodies that the surface itself consists of: all that are not connected touch each other.
    Bodies,
}

/// Contact between a surface of a body and an obstacle, another surface, or all bodies of the surface.
///
/// The surfaces carry a thin layer, which stores energy where something is nearer than its thickness. Every
/// energy-momentum scheme keeps the sum of all energies, and nothing passes through the layer.
///
/// ```
/// use emmy::prelude::*;
/// use emmy::body::{Contact, Obstacle};
/// let floor = Obstacle::Plane { point: [0.0; 3], normal: [0.0, 0.0, 1.0] };
/// let bounce = Contact::with_obstacle("z-min", floor).named("bounce").with_distance(0.02);
/// assert_eq!((bounce.name.as_deref(), bounce.stiffness), (Some("bounce"), None));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Name of its forces; `None`: `contact-1`, `contact-2`, ... by its place among the contacts.
    pub name: Option<String>,
    /// Group of facets, or of cells, whose facets on the boundary are meant; `None`: the whole boundary.
    pub surface: Option<String>,
    /// The opponent.
    pub opponent: Opponent,
    /// Modulus of the layer kappa \[force/length^2\]; `None`: the smallest Young's modulus at its facets.
    pub stiffness: Option<f64>,
    /// Thickness of the layer d \[length\]; `None`: a tenth of the median edge of its facets, at most half of the
    /// smallest gap at the start.
    pub distance: Option<f64>,
    /// How the pressure begins.
    pub law: LayerLaw,
    /// Displacement of the obstacle over time \[length\], without jumps, with a rate, and zero at the start; `None`:
    /// at rest.
    pub motion: [Option<TimeFunction>; 3],
}

impl Contact {
    /// The contact of a group with an obstacle.
    pub fn with_obstacle(surface: impl Into<String>, obstacle: Obstacle) -> Self {
        Contact { surface: Some(surface.into()), ..Contact::of_all_with_obstacle(obstacle) }
    }

    /// The contact of the whole boundary with an obstacle.
    pub fn of_all_with_obstacle(obstacle: Obstacle) -> Self {
        Contact::new(None, Opponent::Obstacle(obstacle))
    }

    /// The contact between two groups.
    ///
    /// ```
    /// use emmy::body::{Contact, Opponent};
    /// let impact = Contact::between("ball", "plate");
    /// assert_eq!(impact.opponent, Opponent::Surface("plate".into()));
    /// ```
    pub fn between(surface: impl Into<String>, other: impl Into<String>) -> Self {
        Contact::new(Some(surface.into()), Opponent::Surface(other.into()))
    }

    /// The contact of all bodies with each other.
    ///
    /// ```
    /// use emmy::body::{Contact, Opponent};
    /// assert_eq!(Contact::of_all_bodies().opponent, Opponent::Bodies);
    /// ```
    pub fn of_all_bodies() -> Self {
        Contact::new(None, Opponent::Bodies)
    }

    /// The contact of a surface, by default of the whole boundary, with an opponent.
    pub fn new(surface: Option<String>, opponent: Opponent) -> Self {
        let motion = [const { None }; 3];
        Contact {
            name: None,
            surface,
            opponent,
            stiffness: None,
            distance: None,
            law: LayerLaw::Smooth,
            motion,
        }
    }

    /// The same contact with an obstacle that moves by a displacement over time, in the components that are given. Its
    /// work counts as that of a support.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// use emmy::body::{Contact, Obstacle};
    /// let press = Obstacle::Plane { point: [0.0, 0.0, 1.1], normal: [0.0, 0.0, -1.0] };
    /// let down = TimeFunction::smooth("-0.1*t", |t| [-0.1 * t, -0.1, 0.0]);
    /// let contact = Contact::with_obstacle("top", press).moved([None, None, Some(down)]).named("press");
    /// assert_eq!((contact.moves(), contact.group_of_obstacle(0)), (true, "press-obstacle".to_string()));
    /// ```
    pub fn moved(self, motion: [Option<TimeFunction>; 3]) -> Self {
        Contact { motion, ..self }
    }

    /// Whether its obstacle moves.
    pub fn moves(&self) -> bool {
        self.motion.iter().any(Option::is_some)
    }

    /// Group of the node that stands for an obstacle that moves; `number`: the place of the contact, from 0.
    pub fn group_of_obstacle(&self, number: usize) -> String {
        format!("{}-obstacle", self.name(number))
    }

    /// The same contact with a name.
    pub fn named(self, name: impl Into<String>) -> Self {
        Contact { name: Some(name.into()), ..self }
    }

    /// The same contact with a modulus of its layer.
    pub fn with_stiffness(self, stiffness: f64) -> Self {
        Contact { stiffness: Some(stiffness), ..self }
    }

    /// The same contact with a thickness of its layer.
    pub fn with_distance(self, distance: f64) -> Self {
        Contact { distance: Some(distance), ..self }
    }

    /// The same contact with a law.
    pub fn with_law(self, law: LayerLaw) -> Self {
        Contact { law, ..self }
    }

    /// The error of a fault; `number`: its place among the contacts, from 0.
    pub(crate) fn error(&self, number: usize, (key, reason): ContactFault) -> Error {
        Error::Contact { contact: self.name(number), key, reason }
    }

    /// The name of its forces; `number`: its place among the contacts, from 0.
    pub fn name(&self, number: usize) -> String {
        self.name.clone().unwrap_or_else(|| format!("contact-{}", number + 1))
    }
}
