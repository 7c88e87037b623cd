//! Bodies, meshes and observers that several tests share.

pub(crate) mod blocks;
pub(crate) mod bricks;
pub(crate) mod cells;
pub(crate) mod contact;
pub(crate) mod faces;
pub(crate) mod flight;
pub(crate) mod joints;
pub(crate) mod patch;
pub(crate) mod plane_patch;
pub(crate) mod points;
pub(crate) mod schemes;
pub(crate) mod stiffness;
pub(crate) mod watch;
