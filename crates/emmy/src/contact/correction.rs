//! The correction by which forces at Gauss points do exactly the work of an energy.

/// A defect below this part of the products of forces with lengths is rounding. In random sliding steps, 8 epsilon left
/// correcting forces of the size of the gradient.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// The correction of the gradients of an energy psi(s) in a step, where s is a gap or a squared distance.
///
/// The forces `(psi'_i + c s'_i) grad s_i + c [s] Ds_i` do the work `[psi]`, if the mean product of `Ds_i` with the
/// rates is the change `[s]`:
///
/// ```math
/// c = D/N,    D = [psi] - sum_i b_i psi'_i s'_i,    N = sum_i b_i s'_i^2 + [s]^2
/// ```
#[derive(Debug, Clone, Copy)]
pub(super) struct Correction {
    /// c, or zero where D is rounding: N of a point at rest, or of one that moves along the surface, is small, and c
    /// would be rounding over rounding.
    pub factor: f64,
    /// N.
    pub norm: f64,
}

/// Numbers at a Gauss point.
pub(super) struct GaussPoint {
    /// Weight b_i.
    pub weight: f64,
    /// `psi'_i`.
    pub slope: f64,
    /// Rate s'_i.
    pub rate: f64,
    /// Size of the terms in this rate.
    pub size: f64,
}

impl Correction {
    /// The correction of a step from the quotient `[psi]/[s]` and the change `[s]`.
    pub(super) fn new(quotient: f64, change: f64, points: impl Iterator<Item = GaussPoint>) -> Correction {
        let (mut defect, mut norm, mut rounding) = (quotient * change, change * change, 0.0);
        for GaussPoint { weight, slope, rate, size } in points {
            defect -= weight * slope * rate;
            norm += weight * rate * rate;
            rounding += ROUNDING * weight * quotient.abs().max(slope.abs()) * size;
        }
        Correction { factor: if defect.abs() > rounding { defect / norm } else { 0.0 }, norm }
    }
}
