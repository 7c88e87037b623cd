//! Builder of a body: the mesh first, then everything that it consists of and that acts on it.

use std::borrow::Borrow;

use super::{Body, Load, PointTerms, Region, Support};
use crate::error::Result;
use crate::mesh::Mesh;

/// Collects the parts of a body; [`BodyBuilder::build`] checks them against the mesh.
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [2, 4, 2])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.1))
///     .support(Support::fixed("y-min"))
///     .load(Load::acceleration([0.0, 0.0, -9.81]))
///     .build()?;
/// assert_eq!((body.n_dofs(), body.n_free_dofs()), (135, 108));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct BodyBuilder {
    pub(super) mesh: Mesh,
    pub(super) regions: Vec<Region>,
    pub(super) point_terms: PointTerms,
    pub(super) supports: Vec<Support>,
    pub(super) loads: Vec<Load>,
    pub(super) drag: f64,
}

impl BodyBuilder {
    pub(super) fn new(mesh: Mesh) -> Self {
        let (regions, supports, loads) = (Vec::new(), Vec::new(), Vec::new());
        BodyBuilder { mesh, regions, point_terms: PointTerms::default(), supports, loads, drag: 0.0 }
    }

    /// Adds a region. The regions together cover every cell once.
    pub fn region(mut self, region: Region) -> Self {
        self.regions.push(region);
        self
    }

    /// Adds regions.
    pub fn regions(mut self, regions: impl IntoIterator<Item = Region>) -> Self {
        self.regions.extend(regions);
        self
    }

    /// Adds a support.
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// Adds supports.
    pub fn supports(mut self, supports: impl IntoIterator<Item = impl Borrow<Support>>) -> Self {
        self.supports.extend(supports.into_iter().map(|support| support.borrow().clone()));
        self
    }

    /// Adds a load. Loads are superposed.
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// Adds loads.
    pub fn loads(mut self, loads: impl IntoIterator<Item = impl Borrow<Load>>) -> Self {
        self.loads.extend(loads.into_iter().map(|load| load.borrow().clone()));
        self
    }

    /// Sets the masses and forces at single nodes.
    pub fn point_terms(mut self, terms: PointTerms) -> Self {
        self.point_terms = terms;
        self
    }

    /// Sets the drag of a surrounding medium, an external force `f = -rate M v` \[1/time\]. Alone it makes velocities decay like
    /// `exp(-rate t)`.
    pub fn drag(mut self, rate: f64) -> Self {
        self.drag = rate;
        self
    }

    /// The body. Nodes of plane cells are fixed along z.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`], [`crate::Error::RegionCover`] if the regions do not cover the cells,
    /// [`crate::Error::NotPositive`] for a density, [`crate::Error::InvertedCell`], [`crate::Error::NotFinite`] for a load,
    /// [`crate::Error::Support`], [`crate::Error::NoMass`] for a node without mass that is free to move,
    /// [`crate::Error::Viscosity`] unless the drag is finite and not negative.
    pub fn build(self) -> Result<Body> {
        Body::from_parts(self)
    }
}
