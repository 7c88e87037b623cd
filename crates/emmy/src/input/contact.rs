//! Contacts of surfaces.

use crate::contact::{LayerLaw, Obstacle};

/// Contact between a surface of a body and an obstacle.
///
/// The surface carries a thin layer, which stores energy where the obstacle is nearer than its thickness. Every
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
    /// The obstacle.
    pub obstacle: Obstacle,
    /// Modulus of the layer kappa \[force/length^2\]; `None`: the smallest Young's modulus at its facets.
    pub stiffness: Option<f64>,
    /// Thickness of the layer d \[length\]; `None`: a tenth of the median edge of its facets, at most half of the
    /// smallest gap at the start.
    pub distance: Option<f64>,
    /// How the pressure begins.
    pub law: LayerLaw,
}

impl Contact {
    /// The contact of a group with an obstacle.
    pub fn with_obstacle(surface: impl Into<String>, obstacle: Obstacle) -> Self {
        Contact { surface: Some(surface.into()), ..Contact::of_all_with_obstacle(obstacle) }
    }

    /// The contact of the whole boundary with an obstacle.
    pub fn of_all_with_obstacle(obstacle: Obstacle) -> Self {
        Contact {
            name: None,
            surface: None,
            obstacle,
            stiffness: None,
            distance: None,
            law: LayerLaw::Smooth,
        }
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

    /// The name of its forces; `number`: its place among the contacts, from 0.
    pub fn name(&self, number: usize) -> String {
        self.name.clone().unwrap_or_else(|| format!("contact-{}", number + 1))
    }
}
