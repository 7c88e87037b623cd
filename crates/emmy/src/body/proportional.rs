//! The loads of a time, applied in proportion.

use std::sync::Arc;

use super::system::Body;
use crate::force::LoadVector;
use crate::input::TimeFunction;

impl Body {
    /// The body under the loads and given displacements of a time, before a jump there, all in proportion to a load
    /// fraction from 0 to 1 that takes the place of time. Attractions act in full. Supports released by that time are gone; none is released later.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let pull = Load::traction("x-max", [2.0, 0.0, 0.0]).over([(0.0, 3.0), (1.0, 0.0)])?;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(pull).build()?;
    /// let mut force = vec![0.0; body.n_dofs()];
    /// body.in_proportion(0.0).loads_at(0.5, &mut force)?;
    /// assert!((force.iter().sum::<f64>() - 0.5 * 3.0 * 2.0).abs() < 1e-14);
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn in_proportion(&self, time: f64) -> Body {
        let mut body = self;
        while let Some((_, released)) = body.release().filter(|(until, _)| *until <= time) {
            body = released;
        }
        let grown = |time_function: &TimeFunction| TimeFunction::ramp(time_function.value_before(time));
        let dead = body.loads.iter().map(|load| LoadVector {
            load: load.load,
            force: load.force.clone(),
            area: None,
            time_function: grown(&load.time_function),
        });
        let fields = body.fields.iter().map(|field| {
            let mut force = vec![0.0; body.n_dofs()];
            // A load that is not finite stays so: the march then fails.
            if field.add_at(time, &mut body.load_memory(1), &mut force).is_err() {
                force.fill(f64::NAN);
            }
            LoadVector { load: field.load, force, area: None, time_function: TimeFunction::ramp(1.0) }
        });
        let pressures = body.pressures.iter().map(|p| p.with_time_function(grown(&p.time_function)));
        Body {
            loads: Arc::new(dead.chain(fields).collect()),
            fields: Arc::default(),
            pressures: Arc::new(pressures.collect()),
            drives: body.drives.iter().map(|drive| drive.in_proportion(time)).collect(),
            lumped: None,
            release: None,
            ..body.clone()
        }
    }

    /// Whether a load or a given displacement acts at a time, before a jump there.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// let pull = Load::traction("x-max", [2.0, 0.0, 0.0]).over([(0.0, 3.0), (0.0, 0.0)])?;
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(pull).build()?;
    /// assert!(body.is_loaded_at(0.0) && !body.is_loaded_at(1.0));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn is_loaded_at(&self, time: f64) -> bool {
        let loaded = self.in_proportion(time);
        let acts = loaded.loads_at(1.0, &mut vec![0.0; self.n_dofs()]).unwrap_or(true)
            || loaded.pressures.iter().any(|pressure| pressure.time_function.value(1.0) != 0.0);
        let mut acts = [f64::from(u8::from(acts))];
        self.largest_of_ranks("loads that act", &mut acts);
        acts[0] > 0.0 || loaded.driven_distance(1.0, &vec![0.0; self.n_dofs()]) > 0.0
    }
}
