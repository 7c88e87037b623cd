//! The mass of a body: of its regions, of points, and spread over groups.

#![allow(non_snake_case)]

pub(crate) mod points;
pub(crate) mod regions;
pub(crate) mod spread;

pub(crate) use regions::RegionOfCell;
pub use regions::RegionSummary;
pub(crate) use spread::Spread;
