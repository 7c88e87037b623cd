//! Regions and schemes that meet in contact.

use super::schemes::{DGM, assumed_strain, at, dgm, fe, lobatto};
use emmy::body::Formulation;
use emmy::prelude::*;

pub(crate) fn rubber() -> Region {
    Region::new(NeoHooke::new(1000.0, 500.0).unwrap(), 1.0)
}

/// Regions and energy-momentum schemes with a step size for each, in proportion to a size.
pub(crate) fn conserving(size: f64) -> Vec<(Region, Scheme, f64)> {
    let projected = || rubber().with_formulation(Formulation::ProjectedVolume(None));
    let incompatible = || rubber().with_formulation(Formulation::IncompatibleModes);
    let further = [
        (rubber(), at(assumed_strain(4), 1), size),
        (projected(), at(DGM, 1), size),
        (projected(), at(DGM, 2), 2.0 * size),
        (incompatible(), at(DGM, 1), size),
        (incompatible(), at(DGM, 3), 2.0 * size),
    ];
    (1..=8).map(|k| (rubber(), at(DGM, k), 0.0025 * (k + 1) as f64)).chain(further).collect()
}

/// The other schemes with a step size for each, in proportion to a size.
pub(crate) fn others(size: f64) -> [(Scheme, f64); 7] {
    [
        (at(fe(2), 1), size),
        (at(fe(4), 2), 2.0 * size),
        (at(lobatto(4), 3), 2.0 * size),
        (Scheme::from_name("HHT(0)").unwrap(), size),
        (Scheme::from_name("Bathe").unwrap(), size),
        (Scheme::CentralDifferences, 0.4 * size),
        (at(dgm(0.8), 2), 2.0 * size),
    ]
}
