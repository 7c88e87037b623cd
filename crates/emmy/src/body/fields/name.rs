//! Names of the fields: the same in every file, and stable.

use std::fmt;

/// A field that is written.
///
/// ```
/// use emmy::body::fields::FieldName;
/// let stress = FieldName::CauchyStress;
/// assert_eq!((stress.name(), stress.components()[3]), ("cauchy_stress", "xy"));
/// assert_eq!(FieldName::from_name("cauchy_stress"), Some(stress));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FieldName {
    /// u \[length\].
    Displacement,
    /// v \[length/time\].
    Velocity,
    /// Momentum per reference volume, `rho_0 v`; point masses are not in it \[mass/(length^2 time)\].
    MomentumDensity,
    /// Force per current area, `sigma = F S F^T / J` \[force/length^2\].
    CauchyStress,
    /// `S = dW/dE` \[force/length^2\].
    SecondPiolaKirchhoffStress,
    /// Equivalent stress `sqrt(3/2 s : s)`, s the deviator of the Cauchy stress \[force/length^2\].
    VonMisesStress,
    /// Square roots of the eigenvalues of C, the largest first.
    PrincipalStretches,
    /// W per reference volume \[energy/length^3\].
    StrainEnergyDensity,
    /// Mean Cauchy stress of a cell; of a bar along its axis.
    CellCauchyStress,
    /// Mean second Piola-Kirchhoff stress of a cell; of a bar along its axis at rest.
    CellSecondPiolaKirchhoffStress,
    /// Equivalent stress of the mean Cauchy stress of a cell.
    CellVonMisesStress,
    /// Mean energy density of a cell; times its volume, the stored energy of the cell.
    CellStrainEnergyDensity,
    /// Force in a link, positive in tension; 0 in other cells \[force\].
    AxialForce,
}

/// Where a field has its values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// At the nodes.
    Nodes,
    /// In the cells.
    Cells,
}

const ONE: &[&str] = &[""];
const VECTOR: &[&str] = &["x", "y", "z"];
const TENSOR: &[&str] = &["xx", "yy", "zz", "xy", "yz", "xz"];
const ORDERED: &[&str] = &["1", "2", "3"];

impl FieldName {
    /// All fields.
    pub const ALL: [FieldName; 13] = [
        FieldName::Displacement,
        FieldName::Velocity,
        FieldName::MomentumDensity,
        FieldName::CauchyStress,
        FieldName::SecondPiolaKirchhoffStress,
        FieldName::VonMisesStress,
        FieldName::PrincipalStretches,
        FieldName::StrainEnergyDensity,
        FieldName::CellCauchyStress,
        FieldName::CellSecondPiolaKirchhoffStress,
        FieldName::CellVonMisesStress,
        FieldName::CellStrainEnergyDensity,
        FieldName::AxialForce,
    ];

    /// Name of the array.
    pub const fn name(self) -> &'static str {
        match self {
            FieldName::Displacement => "displacement",
            FieldName::Velocity => "velocity",
            FieldName::MomentumDensity => "momentum_density",
            FieldName::CauchyStress => "cauchy_stress",
            FieldName::SecondPiolaKirchhoffStress => "second_piola_kirchhoff_stress",
            FieldName::VonMisesStress => "von_mises_stress",
            FieldName::PrincipalStretches => "principal_stretches",
            FieldName::StrainEnergyDensity => "strain_energy_density",
            FieldName::CellCauchyStress => "cell_cauchy_stress",
            FieldName::CellSecondPiolaKirchhoffStress => "cell_second_piola_kirchhoff_stress",
            FieldName::CellVonMisesStress => "cell_von_mises_stress",
            FieldName::CellStrainEnergyDensity => "cell_strain_energy_density",
            FieldName::AxialForce => "axial_force",
        }
    }

    /// The field of a name.
    pub fn from_name(name: &str) -> Option<FieldName> {
        FieldName::ALL.into_iter().find(|field| field.name() == name)
    }

    /// Names of the components, in VTK's order of symmetric tensors; one empty name of a scalar.
    pub const fn components(self) -> &'static [&'static str] {
        match self {
            FieldName::Displacement | FieldName::Velocity | FieldName::MomentumDensity => VECTOR,
            FieldName::CauchyStress
            | FieldName::SecondPiolaKirchhoffStress
            | FieldName::CellCauchyStress
            | FieldName::CellSecondPiolaKirchhoffStress => TENSOR,
            FieldName::PrincipalStretches => ORDERED,
            _ => ONE,
        }
    }

    /// Description in a line.
    pub const fn description(self) -> &'static str {
        match self {
            FieldName::Displacement => "displacement u [length]",
            FieldName::Velocity => "velocity v [length/time]",
            FieldName::MomentumDensity => {
                "momentum per reference volume, density times velocity [mass/(length^2 time)]"
            }
            FieldName::CauchyStress => {
                "force per current area, F S F^T / J: xx, yy, zz, xy, yz, xz [force/length^2]"
            }
            FieldName::SecondPiolaKirchhoffStress => "S = dW/dE: xx, yy, zz, xy, yz, xz [force/length^2]",
            FieldName::VonMisesStress => "equivalent stress of the Cauchy stress [force/length^2]",
            FieldName::PrincipalStretches => "square roots of the eigenvalues of C, the largest first",
            FieldName::StrainEnergyDensity => "stored energy W per reference volume [energy/length^3]",
            FieldName::CellCauchyStress => "mean of the Cauchy stress in each cell [force/length^2]",
            FieldName::CellSecondPiolaKirchhoffStress => "mean of S in each cell [force/length^2]",
            FieldName::CellVonMisesStress => "equivalent stress of cell_cauchy_stress [force/length^2]",
            FieldName::CellStrainEnergyDensity => "mean of W in each cell [energy/length^3]",
            FieldName::AxialForce => "force in each link, positive in tension; 0 in other cells [force]",
        }
    }

    /// Where it has its values.
    pub const fn place(self) -> Place {
        match self {
            FieldName::CellCauchyStress
            | FieldName::CellSecondPiolaKirchhoffStress
            | FieldName::CellVonMisesStress
            | FieldName::CellStrainEnergyDensity
            | FieldName::AxialForce => Place::Cells,
            _ => Place::Nodes,
        }
    }

    /// Whether it needs no deformation gradient.
    pub(super) const fn is_motion(self) -> bool {
        matches!(
            self,
            FieldName::Displacement
                | FieldName::Velocity
                | FieldName::MomentumDensity
                | FieldName::AxialForce
        )
    }
}

impl fmt::Display for FieldName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
