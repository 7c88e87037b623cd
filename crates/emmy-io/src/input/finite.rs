//! Numbers whose squares are neither infinite nor zero.

use emmy::body::Region;
use emmy::internals::material::Elastic;
use emmy::internals::number::short;
use emmy::mesh::Mesh;

use super::fault::{Fault, Place};
use super::table::Item;

/// Numbers up to this have finite squares; numbers from its inverse on have squares that are not zero.
pub(super) const LARGEST: f64 = 1e150;

/// Lengths up to this have cubes below [`LARGEST`]; lengths from its inverse on have cubes above the inverse of
/// [`LARGEST`].
const LARGEST_LENGTH: f64 = 1e50;

pub(super) const HELP: &str = "choose other units: the squares of numbers above 1e150 overflow, and those of numbers below 1e-150 vanish \
                    (for lengths, whose cubes count, 1e50 and 1e-50)";

/// Checks the Lame parameters that follow from two elastic constants.
pub(super) fn check_lame(item: &Item<'_>, Elastic { lambda, mu, .. }: Elastic) -> Result<(), Fault> {
    if lambda.abs().max(mu) <= LARGEST || lambda.is_nan() {
        return Ok(());
    }
    let message = format!("the Lame parameters that follow are {} and {}", short(lambda), short(mu));
    Err(item.fault(message, "too large").help(HELP))
}

/// Checks the moduli at rest of a formula.
pub(super) fn check_moduli(item: &Item<'_>, region: &Region) -> Result<(), Fault> {
    match region.moduli() {
        Some([bulk, shear]) if bulk.abs().max(shear.abs()) > LARGEST => {
            let [bulk, shear] = [bulk, shear].map(short);
            let message = format!("the bulk and shear modulus that follow are {bulk} and {shear}");
            Err(item.fault(message, "too large").help(HELP))
        }
        _ => Ok(()),
    }
}

/// Checks that volumes and moments of inertia of a mesh can be computed.
pub(super) fn check_extent(mesh: &Mesh, place: &Place) -> Result<(), Fault> {
    let farthest = mesh.points().iter().flatten().fold(0.0, |farthest: f64, x| farthest.max(x.abs()));
    if farthest > LARGEST_LENGTH || farthest.is_nan() {
        let message = format!("the mesh has coordinates up to {}", short(farthest));
        return Err(Fault::at(place, message, "too large").help(HELP));
    }
    let size = mesh.extent().into_iter().fold(0.0, f64::max);
    if size < 1.0 / LARGEST_LENGTH {
        let message = format!("the mesh has a size of {}", short(size));
        return Err(Fault::at(place, message, "too small").help(HELP));
    }
    Ok(())
}
