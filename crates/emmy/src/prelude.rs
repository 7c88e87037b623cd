//! The names that a first program needs.
//!
//! ```
//! use emmy::prelude::*;
//! ```

pub use crate::body::{Body, History, InitialVelocity, Load, LoadKind, PointMass, Region, Rotation, Support};
pub use crate::error::{Error, Result};
pub use crate::material::{
    ArrudaBoyce, CiarletGeymonat, Gent, Hencky, Link, Material, MooneyRivlin, NeoHooke, Ogden,
    SaintVenantKirchhoff, Yeoh,
};
pub use crate::mesh::{self, CellKind, Mesh, MeshBuilder};
pub use crate::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
pub use crate::time::{Scheme, TimeElement};
