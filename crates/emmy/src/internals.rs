//! Parts of the implementation for the programs, tests and benches of this repository. No promise of stability: any of
//! these names may change in any release.

/// Averaging rules at a material point.
pub mod average {
    pub use crate::average::*;
}

/// Assembly, and the table of models.
pub mod body {
    pub use crate::body::entries::Entries;
    pub use crate::body::forces::Assembly;
    pub use crate::force::step::{Sampling, StepDamping, StepInput};
    pub use crate::input::Span;
    pub use crate::input::models::{MODELS, RegionModel};
    pub use crate::input::pole::pole;
    pub use crate::input::symmetry::symmetry_axis;
    pub use crate::space::sum;
    pub use crate::space::{OffPlane, affine_weights, check_coupling};
}

/// Contact.
pub mod contact {
    pub use crate::contact::*;
}

/// Reference elements.
pub mod element {
    pub use crate::element::*;
}

/// Descriptions of materials and their parameters, from which inputs are checked and documented.
pub mod material {
    pub use crate::material::elastic::{ELASTIC_CONSTANTS, Elastic};
    pub use crate::material::model::{
        Bounds, IfAbsent, Model, ModelCells, Modelled, Parameter, ParameterKind, Value, Values,
    };
    pub use crate::material::response::Response;
}

/// Quality of some of the cells, and the limit of built-in shapes.
pub mod mesh {
    pub use crate::mesh::quality::quality_of;
    pub use crate::mesh::shapes::{FEWEST_AROUND, ball_count, check_count, cylinder_count};
}

/// Resolution of time functions by the steps.
pub mod motion {
    pub use crate::motion::resolution::{Resolution, Unresolved};
    pub use crate::motion::subdivision::{GOOD_STEPS, Subdivision};
}

/// Newton's method.
pub mod newton {
    pub use crate::newton::*;
}

/// Numbers in messages.
pub mod number {
    pub use crate::number::*;
}

/// Polynomials.
pub mod polynomial {
    pub use crate::polynomial::*;
}

/// Quadrature rules.
pub mod quadrature {
    pub use crate::quadrature::*;
}

/// Linear algebra.
pub mod sparse {
    pub use crate::sparse::*;
}

/// Tensor algebra, one number or one register a component.
pub mod tensor {
    pub use crate::tensor::*;
}

/// Tables of schemes and estimators, and the steppers of the library.
pub mod time {
    pub use crate::time::classic::{BatheStepper, CentralDifferences, NewmarkStepper, StaticStepper};
    pub use crate::time::element_stepper::TimeElementStepper;
    pub use crate::time::error::{ESTIMATORS, LocalError, Reconstruction};
    pub use crate::time::scheme::{SCHEMES, SchemeRow};
}
