//! Formulations of a cell against locking.

use std::fmt;

use super::CellKind;

/// How a cell represents its strain.
///
/// A cell with the standard formulation is too stiff where the material hardly changes its volume, and a linear one in
/// bending.
///
/// ```
/// use emmy::body::{Formulation, PressureSpace};
/// use emmy::mesh::CellKind;
/// let rubber = Formulation::ProjectedVolume(None);
/// assert_eq!(rubber.pressure_space(CellKind::Hex27), Ok(Some(PressureSpace::Linear)));
/// assert!(rubber.pressure_space(CellKind::Tet4).unwrap_err().contains("tet10"));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Formulation {
    /// Displacements alone.
    #[default]
    Standard,
    /// The volumetric energy of the projection of J on few functions of each cell (Simo, Taylor and Pister 1985);
    /// `None`: the default functions of each kind of cell.
    ProjectedVolume(Option<PressureSpace>),
    /// Quadratic modes inside each cell for bending (Simo and Armero 1992).
    IncompatibleModes,
}

/// Functions of the reference position on which the volume of a cell is projected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PressureSpace {
    /// Constants.
    Constant,
    /// Linear functions.
    Linear,
}

impl PressureSpace {
    /// Key word.
    pub const fn name(self) -> &'static str {
        match self {
            PressureSpace::Constant => "constant",
            PressureSpace::Linear => "linear",
        }
    }

    /// Number of functions in a cell of a dimension.
    pub const fn n_functions(self, dimension: usize) -> usize {
        match self {
            PressureSpace::Constant => 1,
            PressureSpace::Linear => 1 + dimension,
        }
    }
}

impl fmt::Display for PressureSpace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Formulation {
    /// Key word.
    pub const fn name(self) -> &'static str {
        match self {
            Formulation::Standard => "standard",
            Formulation::ProjectedVolume(_) => "projected-volume",
            Formulation::IncompatibleModes => "incompatible-modes",
        }
    }

    /// Number of incompatible modes in cells of a kind.
    pub const fn n_modes(self, kind: CellKind) -> usize {
        match self {
            Formulation::Standard | Formulation::ProjectedVolume(_) => 0,
            Formulation::IncompatibleModes => kind.info().n_modes,
        }
    }

    /// The functions of the pressure in cells of a kind, `None` for a formulation without them.
    ///
    /// # Errors
    /// The reason why the kind does not have the formulation, with the remedy.
    pub fn pressure_space(self, kind: CellKind) -> Result<Option<PressureSpace>, String> {
        match self {
            Formulation::Standard => Ok(None),
            Formulation::ProjectedVolume(wanted) => projection(kind, wanted).map(Some),
            Formulation::IncompatibleModes if kind.info().n_modes > 0 => Ok(None),
            Formulation::IncompatibleModes => {
                Err(format!("{kind} has no incompatible modes; they exist for hex8 and quad4"))
            }
        }
    }
}

fn projection(kind: CellKind, wanted: Option<PressureSpace>) -> Result<PressureSpace, String> {
    let spaces = kind.info().pressures;
    let Some(&default) = spaces.first() else {
        return Err(match kind.dimension() {
            1 => format!("{kind} has no volume to project"),
            2 => format!("the volume of {kind} is constant in a cell, so it locks in any case; use tri6"),
            _ => format!("the volume of {kind} is constant in a cell, so it locks in any case; use tet10"),
        });
    };
    match wanted {
        Some(space) if !spaces.contains(&space) => Err(match space {
            PressureSpace::Constant => format!(
                "{kind} with a constant pressure has deformations without energy; use pressure = \"linear\""
            ),
            PressureSpace::Linear => {
                format!("{kind} with a linear pressure locks; use pressure = \"constant\"")
            }
        }),
        Some(space) => Ok(space),
        None => Ok(default),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_its_functions_or_a_remedy() {
        let space = |kind: CellKind, wanted| Formulation::ProjectedVolume(wanted).pressure_space(kind);
        for kind in [CellKind::Hex8, CellKind::Quad4, CellKind::Tri6, CellKind::Tet10, CellKind::Wedge6] {
            assert_eq!(space(kind, None), Ok(Some(PressureSpace::Constant)));
            assert!(space(kind, Some(PressureSpace::Linear)).unwrap_err().contains("constant"), "{kind}");
        }
        for kind in [CellKind::Hex20, CellKind::Hex27, CellKind::Wedge15, CellKind::Pyramid13] {
            assert_eq!(space(kind, None), Ok(Some(PressureSpace::Linear)));
            assert!(space(kind, Some(PressureSpace::Constant)).unwrap_err().contains("without energy"));
        }
        for kind in [CellKind::Quad8, CellKind::Quad9] {
            assert_eq!(space(kind, Some(PressureSpace::Constant)), Ok(Some(PressureSpace::Constant)));
        }
        for (kind, remedy) in
            [(CellKind::Tet4, "tet10"), (CellKind::Tri3, "tri6"), (CellKind::Line2, "no volume")]
        {
            assert!(space(kind, None).unwrap_err().contains(remedy));
        }
        assert!(Formulation::IncompatibleModes.pressure_space(CellKind::Hex20).is_err());
        assert_eq!(Formulation::IncompatibleModes.pressure_space(CellKind::Quad4), Ok(None));
        assert_eq!(
            [CellKind::Quad4, CellKind::Hex8].map(|kind| Formulation::IncompatibleModes.n_modes(kind)),
            [2, 3]
        );
        assert_eq!(Formulation::Standard.n_modes(CellKind::Hex8), 0);
    }
}
