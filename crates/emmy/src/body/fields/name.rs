//! The fields: one row each, with its name in every file and its formula.

use std::fmt;

use super::point::{PointState, von_mises};
use super::{Fields, NodalMotion};
use crate::force::ContactAtNode;
use crate::tensor::Sym;

/// Where a field has its values.
///
/// ```
/// use emmy::body::{FieldName, Place};
/// assert_eq!(FieldName::CellVonMisesStress.place(), Place::Cells);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// At the nodes.
    Nodes,
    /// In the cells.
    Cells,
}

/// A field, described.
pub(super) struct FieldInfo {
    /// Name of the array.
    name: &'static str,
    /// Description in a line.
    description: &'static str,
    /// Dimension, such as `length/time`; empty for a pure number.
    dimension: &'static str,
    place: Place,
    components: &'static [&'static str],
    pub(super) needs: Needs,
    pub(super) formula: Formula,
}

/// A property that a body must have for a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Needs {
    Nothing,
    /// Cells with a volume: solid and plane ones, bars.
    Volume,
    /// Solid or plane cells.
    Solids,
    Links,
    /// Contact.
    Contact,
}

/// Formula of a field.
pub(super) enum Formula {
    /// A vector at a node from the mean density of the cells around it, its displacement, velocity and acceleration.
    Vector(fn(f64, [[f64; 3]; 3]) -> [f64; 3]),
    /// A number in a cell from the motion, without a deformation gradient.
    OfCell(fn(&Fields, NodalMotion<'_>, usize) -> f64),
    /// The same for a mean over the points of the mass matrix.
    OfMass(fn(&Fields, NodalMotion<'_>, usize) -> f64),
    /// A number of contact at a node.
    Contact(fn(&ContactAtNode) -> f64),
    /// A number of the state at a node or in a cell.
    Number(fn(&PointState) -> f64),
    Stretches(fn(&PointState) -> [f64; 3]),
    Tensor(fn(&PointState) -> Sym<f64>),
}

impl Formula {
    /// Whether it needs the state of the material.
    pub(super) const fn is_of_state(&self) -> bool {
        !matches!(self, Formula::Vector(_) | Formula::OfCell(_) | Formula::OfMass(_) | Formula::Contact(_))
    }
}

const SCALAR: &[&str] = &[""];
const VECTOR: &[&str] = &["x", "y", "z"];
const TENSOR: &[&str] = &["xx", "yy", "zz", "xy", "yz", "xz"];
const ORDERED: &[&str] = &["1", "2", "3"];

/// Declares the fields, each with its [`FieldInfo`].
macro_rules! fields {
    ($($(#[$doc:meta])* $field:ident { $($row:tt)+ })+) => {
        /// A field that is written. Names are the same in every file, and stable.
        ///
        /// ```
        /// use emmy::body::FieldName;
        /// let stress = FieldName::CauchyStress;
        /// assert_eq!((stress.name(), stress.components()[3]), ("cauchy_stress", "xy"));
        /// assert_eq!(FieldName::from_name("cauchy_stress"), Some(stress));
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum FieldName {
            $($(#[$doc])* $field,)+
        }

        const ROWS: [FieldInfo; [$(FieldName::$field),+].len()] = [$(FieldInfo { $($row)+ }),+];

        impl FieldName {
            /// All fields.
            pub const ALL: [FieldName; ROWS.len()] = [$(FieldName::$field),+];
        }
    };
}

// A new field has its row here.
fields! {
    /// u \[length\].
    Displacement {
        name: "displacement",
        description: "displacement u",
        dimension: "length",
        place: Place::Nodes,
        components: VECTOR,
        needs: Needs::Nothing,
        formula: Formula::Vector(|_, [displacement, ..]| displacement),
    }
    /// v \[length/time\].
    Velocity {
        name: "velocity",
        description: "velocity v",
        dimension: "length/time",
        place: Place::Nodes,
        components: VECTOR,
        needs: Needs::Nothing,
        formula: Formula::Vector(|_, [_, velocity, _]| velocity),
    }
    /// Mean of dv/dt over the last step; NaN before the first \[length/time^2\].
    Acceleration {
        name: "acceleration",
        description: "mean acceleration over the last step: the change of the velocity over the step size",
        dimension: "length/time²",
        place: Place::Nodes,
        components: VECTOR,
        needs: Needs::Nothing,
        formula: Formula::Vector(|_, [.., acceleration]| acceleration),
    }
    /// Momentum per reference volume, `rho_0 v`; point masses are not in it \[mass/(length^2 time)\].
    MomentumDensity {
        name: "momentum_density",
        description: "momentum per reference volume, density times velocity",
        dimension: "mass/(length²·time)",
        place: Place::Nodes,
        components: VECTOR,
        needs: Needs::Volume,
        formula: Formula::Vector(|density, [_, velocity, _]| velocity.map(|component| density * component)),
    }
    /// Force per current area, `sigma = F S F^T / J` \[force/length^2\].
    CauchyStress {
        name: "cauchy_stress",
        description: "force per current area, F S F^T / J: xx, yy, zz, xy, yz, xz",
        dimension: "stress",
        place: Place::Nodes,
        components: TENSOR,
        needs: Needs::Solids,
        formula: Formula::Tensor(|state| state.cauchy),
    }
    /// `S = dW/dE` \[force/length^2\].
    SecondPiolaKirchhoffStress {
        name: "second_piola_kirchhoff_stress",
        description: "S = dW/dE: xx, yy, zz, xy, yz, xz",
        dimension: "stress",
        place: Place::Nodes,
        components: TENSOR,
        needs: Needs::Solids,
        formula: Formula::Tensor(|state| state.second),
    }
    /// Equivalent stress `sqrt(3/2 s : s)`, s the deviator of the Cauchy stress \[force/length^2\].
    VonMisesStress {
        name: "von_mises_stress",
        description: "equivalent stress of the Cauchy stress",
        dimension: "stress",
        place: Place::Nodes,
        components: SCALAR,
        needs: Needs::Solids,
        formula: Formula::Number(|state| von_mises(&state.cauchy)),
    }
    /// Square roots of the eigenvalues of C, the largest first.
    PrincipalStretches {
        name: "principal_stretches",
        description: "square roots of the eigenvalues of C, the largest first",
        dimension: "",
        place: Place::Nodes,
        components: ORDERED,
        needs: Needs::Solids,
        formula: Formula::Stretches(PointState::principal_stretches),
    }
    /// Square root of the largest eigenvalue of C, the first of [`FieldName::PrincipalStretches`].
    LargestStretch {
        name: "largest_stretch",
        description: "square root of the largest eigenvalue of C",
        dimension: "",
        place: Place::Nodes,
        components: SCALAR,
        needs: Needs::Solids,
        formula: Formula::Number(|state| state.principal_stretches()[0]),
    }
    /// W per reference volume \[energy/length^3\].
    StrainEnergyDensity {
        name: "strain_energy_density",
        description: "stored energy W per reference volume",
        dimension: "energy/length³",
        place: Place::Nodes,
        components: SCALAR,
        needs: Needs::Solids,
        formula: Formula::Number(|state| state.energy),
    }
    /// Mean Cauchy stress of a cell; of a bar along its axis.
    CellCauchyStress {
        name: "cell_cauchy_stress",
        description: "mean of the Cauchy stress in each cell",
        dimension: "stress",
        place: Place::Cells,
        components: TENSOR,
        needs: Needs::Volume,
        formula: Formula::Tensor(|state| state.cauchy),
    }
    /// Mean second Piola-Kirchhoff stress of a cell; of a bar along its axis at rest.
    CellSecondPiolaKirchhoffStress {
        name: "cell_second_piola_kirchhoff_stress",
        description: "mean of S in each cell",
        dimension: "stress",
        place: Place::Cells,
        components: TENSOR,
        needs: Needs::Volume,
        formula: Formula::Tensor(|state| state.second),
    }
    /// Equivalent stress of the mean Cauchy stress of a cell.
    CellVonMisesStress {
        name: "cell_von_mises_stress",
        description: "equivalent stress of cell_cauchy_stress",
        dimension: "stress",
        place: Place::Cells,
        components: SCALAR,
        needs: Needs::Volume,
        formula: Formula::Number(|state| von_mises(&state.cauchy)),
    }
    /// Minus a third of the trace of the mean Cauchy stress of a cell, positive in compression \[force/length^2\].
    CellPressure {
        name: "cell_pressure",
        description: "minus a third of the trace of cell_cauchy_stress, positive in compression",
        dimension: "stress",
        place: Place::Cells,
        components: SCALAR,
        needs: Needs::Solids,
        formula: Formula::Number(|state| -(state.cauchy[0] + state.cauchy[1] + state.cauchy[2]) / 3.0),
    }
    /// Mean energy density of a cell; times its volume, the stored energy of the cell.
    CellStrainEnergyDensity {
        name: "cell_strain_energy_density",
        description: "mean of W in each cell",
        dimension: "energy/length³",
        place: Place::Cells,
        components: SCALAR,
        needs: Needs::Volume,
        formula: Formula::Number(|state| state.energy),
    }
    /// Mean of det F in a cell, its current volume over its reference volume; 1 in springs and attractions. It is a
    /// number even in an inverted cell.
    CellVolumeRatio {
        name: "cell_volume_ratio",
        description: "mean of J = det F in each cell: current volume over reference volume",
        dimension: "",
        place: Place::Cells,
        components: SCALAR,
        needs: Needs::Volume,
        formula: Formula::Number(|state| state.volume_ratio),
    }
    /// Force in a link, positive in tension; 0 in other cells \[force\].
    AxialForce {
        name: "axial_force",
        description: "force in each link, positive in tension; 0 in other cells",
        dimension: "force",
        place: Place::Cells,
        components: SCALAR,
        needs: Needs::Links,
        formula: Formula::OfCell(|fields, motion, cell| fields.axial_force(motion.displacement, cell)),
    }
    /// Mean of `rho_0 v^2/2` in a cell; times its [`Fields::volume_for`], the kinetic energy of the cell. Point masses
    /// are not in it.
    CellKineticEnergyDensity {
        name: "cell_kinetic_energy_density",
        description: "mean of density times v^2/2 in each cell, per reference volume",
        dimension: "energy/length³",
        place: Place::Cells,
        components: SCALAR,
        needs: Needs::Volume,
        formula: Formula::OfMass(|fields, motion, cell| fields.kinetic_energy_density(motion.velocity, cell)),
    }
    /// Normal force of contact on a node over the reference area around it, on those facets that are pressed; the sum
    /// of all contacts, and 0 where none acts \[force/length^2\].
    ContactPressure {
        name: "contact_pressure",
        description: "normal force of contact on a node over the reference area around it; 0 elsewhere",
        dimension: "stress",
        place: Place::Nodes,
        components: SCALAR,
        needs: Needs::Contact,
        formula: Formula::Contact(|contact| contact.pressure),
    }
    /// Distance of a node to the nearest opponent in contact, up to twice the thickness of its layer; NaN elsewhere
    /// \[length\].
    ContactGap {
        name: "contact_gap",
        description: "distance of a node to the nearest opponent, up to twice the thickness of its layer, else NaN",
        dimension: "length",
        place: Place::Nodes,
        components: SCALAR,
        needs: Needs::Contact,
        formula: Formula::Contact(|contact| contact.gap),
    }
}

impl FieldName {
    /// The row of the field.
    pub(super) const fn info(self) -> &'static FieldInfo {
        &ROWS[self as usize]
    }

    /// Name of the array.
    pub const fn name(self) -> &'static str {
        self.info().name
    }

    /// The field of a name.
    pub fn from_name(name: &str) -> Option<FieldName> {
        FieldName::ALL.into_iter().find(|field| field.name() == name)
    }

    /// The field in cells of the same quantity, such as `cell_von_mises_stress` of `von_mises_stress`; a field in cells
    /// is its own.
    ///
    /// ```
    /// use emmy::body::FieldName;
    /// assert_eq!(FieldName::VonMisesStress.in_cells(), Some(FieldName::CellVonMisesStress));
    /// assert_eq!(FieldName::Velocity.in_cells(), None);
    /// ```
    pub fn in_cells(self) -> Option<FieldName> {
        match self.place() {
            Place::Cells => Some(self),
            Place::Nodes => FieldName::from_name(&format!("cell_{}", self.name())),
        }
    }

    /// Whether it is displacement, velocity or acceleration, which every body has, in any frame of reference; rigid
    /// bodies have no other fields.
    pub const fn is_of_motion(self) -> bool {
        matches!(self, FieldName::Displacement | FieldName::Velocity | FieldName::Acceleration)
    }

    /// Names of the components, in VTK's order of symmetric tensors; one empty name of a scalar.
    pub const fn components(self) -> &'static [&'static str] {
        self.info().components
    }

    /// Description in a line.
    pub const fn description(self) -> &'static str {
        self.info().description
    }

    /// Dimension as a product of powers of mass, length, time, force, stress and energy; empty for a pure number.
    ///
    /// ```
    /// use emmy::body::FieldName;
    /// assert_eq!(FieldName::StrainEnergyDensity.dimension(), "energy/length³");
    /// ```
    pub const fn dimension(self) -> &'static str {
        self.info().dimension
    }

    /// Where it has its values.
    pub const fn place(self) -> Place {
        self.info().place
    }
}

impl fmt::Display for FieldName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
