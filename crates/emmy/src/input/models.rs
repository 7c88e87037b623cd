//! Every material model by name.

use super::region::Region;
use crate::error::Result;
use crate::material::{Link, Material, Model, Modelled, Values, each_material};

/// A material model for regions.
#[derive(Debug, Clone, Copy)]
pub struct RegionModel {
    /// Name, energy and parameters.
    pub model: Model,
    region: fn(f64, &Values) -> Result<Region>,
}

macro_rules! region_models {
    ($($material:ident),+) => {
        &[
            $(RegionModel {
                model: <crate::material::$material as Modelled>::MODEL,
                region: region::<crate::material::$material>,
            },)+
            RegionModel {
                model: Link::BAR,
                region: |density, values| Ok(Region::links(Link::bar_from_values(values)?, density)),
            },
            RegionModel {
                model: Link::SPRING,
                region: |density, values| Ok(Region::links(Link::spring_from_values(values)?, density)),
            },
            RegionModel {
                model: Link::ATTRACTION,
                region: |density, values| Ok(Region::links(Link::attraction_from_values(values)?, density)),
            },
        ]
    };
}

/// All models; links are last.
pub const MODELS: &[RegionModel] = each_material!(region_models);

fn region<M: Modelled + Material>(density: f64, values: &Values) -> Result<Region> {
    Ok(Region::new(M::from_values(values)?, density))
}

impl RegionModel {
    /// The model of a name.
    ///
    /// ```
    /// use emmy::internals::body::RegionModel;
    /// use emmy::internals::material::{Value, Values};
    /// let model = RegionModel::named("neo-hooke").unwrap();
    /// let values = Values::from_iter([("lambda", Value::Number(1000.0)), ("mu", Value::Number(500.0))]);
    /// assert_eq!(model.region(2.0, &values)?.density, 2.0);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn named(name: &str) -> Option<&'static RegionModel> {
        MODELS.iter().find(|model| model.model.name == name)
    }

    /// The region of all cells, of the model with a reference density.
    ///
    /// # Errors
    /// [`crate::Error::MaterialParameter`] for values that are out of range or missing.
    pub fn region(&self, density: f64, values: &Values) -> Result<Region> {
        (self.region)(density, values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Error;

    #[test]
    fn names_are_unique_and_values_that_are_missing_are_rejected_by_name() {
        for (index, RegionModel { model, region }) in MODELS.iter().enumerate() {
            assert!(MODELS[..index].iter().all(|other| other.model.name != model.name), "{}", model.name);
            match region(1.0, &Values::default()).unwrap_err() {
                Error::MaterialParameter { material, parameter, .. } => {
                    assert_eq!(material, model.name);
                    assert!(model.every_parameter().any(|own| own.name == parameter), "{parameter}");
                }
                other => panic!("{other}"),
            }
        }
    }
}
