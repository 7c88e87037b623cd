//! Names for a first program.
//!
//! ```
//! use emmy::prelude::*;
//! ```

pub use crate::body::Body;
pub use crate::input::{
    Coupling, InitialVelocity, Joint, JointEnd, JointKind, Load, LoadKind, PointMass, Region, RigidBody,
    Rotation, Support, Tie, TieKind, TimeFunction, Viscosity,
};
pub use crate::material::{
    ArrudaBoyce, CiarletGeymonat, EngineeringConstants, Gent, Hencky, HolzapfelGasserOgden, Link, Material,
    MooneyRivlin, NeoHooke, NeoHookeIsochoric, Ogden, Orthotropic, SaintVenantKirchhoff, Volumetric, Yeoh,
};
pub use crate::mesh::{self, CellKind, Mesh, MeshBuilder};
pub use crate::motion::{Motion, NewtonSettings, Phase, Record, State, StepPlan};
pub use crate::time::{Scheme, TimeElement};
