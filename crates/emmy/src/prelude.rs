//! Names for a first program.
//!
//! ```
//! use emmy::prelude::*;
//! ```

pub use crate::body::Body;
pub use crate::input::InitialVelocity;
pub use crate::input::PointMass;
pub use crate::input::Region;
pub use crate::input::TimeFunction;
pub use crate::input::Viscosity;
pub use crate::input::{Load, LoadKind};
pub use crate::input::{Rotation, Support};
pub use crate::material::{
    ArrudaBoyce, CiarletGeymonat, EngineeringConstants, Gent, Hencky, HolzapfelGasserOgden, Link, Material,
    MooneyRivlin, NeoHooke, NeoHookeIsochoric, Ogden, Orthotropic, SaintVenantKirchhoff, Volumetric, Yeoh,
};
pub use crate::mesh;
pub use crate::mesh::{CellKind, Mesh, MeshBuilder};
pub use crate::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
pub use crate::time::{Scheme, TimeElement};
