//! Bodies, meshes and observers that several tests share.

pub mod blocks;
pub mod flight;
pub mod patch;
pub mod plane_patch;
pub mod points;
pub mod schemes;
pub mod watch;
