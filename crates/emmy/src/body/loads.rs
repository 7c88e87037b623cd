//! Loads and moving supports over time: their kinks, resultants and smooth functions.

use std::collections::HashSet;

use super::system::Body;
use crate::force::{OverTime, Signal};
use crate::input::SignalTarget;

/// Resultant of a load at factor 1 in the reference configuration.
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([2.0, 1.0, 1.0], [1; 3])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0))
///     .load(Load::traction("x-max", [0.0, 0.0, 3.0]))
///     .build()?;
/// let resultant = body.load_resultants()[0];
/// assert!((resultant.force[2] - 3.0).abs() < 1e-14 && (resultant.torque[1] + 6.0).abs() < 1e-14);
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadResultant {
    /// Force \[force\].
    pub force: [f64; 3],
    /// Torque about the origin \[force length\].
    pub torque: [f64; 3],
}

impl Body {
    /// The first time after another at which the time function of a load, a driven support or a joint has a kink or a
    /// jump; of the kinks of a measured table only the corners count.
    pub(crate) fn next_corner(&self, after: f64) -> Option<f64> {
        let drives = self.space.drives().iter().flat_map(|drive| drive.time_functions());
        let of_drives = drives.filter_map(|time_function| time_function.next_corner(after));
        let of_loads = self.over_time().filter_map(|load| load.time_function().next_corner(after));
        let of_joints = self.mechanism.time_functions().filter_map(|(_, law, _)| law.next_corner(after));
        of_loads.chain(of_drives).chain(of_joints).min_by(f64::total_cmp)
    }

    /// The smooth functions of time that act on the body, without repetition. A call of all ranks.
    ///
    /// A field contributes its components at some of its points.
    pub(crate) fn signals(&self) -> Vec<Signal> {
        let of_loads = self.over_time().filter_map(|load| load.signal(self.ranks()));
        let (of_fields, of_loads): (Vec<Signal>, Vec<Signal>) =
            of_loads.partition(|signal| signal.n_components > 1);
        let of_supports = self.space.drives().iter().flat_map(|drive| {
            let target = SignalTarget::Support(drive.support);
            drive
                .arms()
                .filter_map(move |(time_function, arm)| Signal::of(time_function, target, drive.until, arm))
        });
        let of_joints = self.mechanism.time_functions();
        let of_joints = of_joints.filter_map(|(joint, law, arm)| {
            let until = self.mechanism.joints[joint].until;
            Signal::of(law, SignalTarget::Joint(joint), until, arm)
        });
        let mut known = HashSet::new();
        let is_new = |signal: &Signal| {
            signal.text.is_empty()
                || known.insert((signal.text.clone(), signal.arm.to_bits(), signal.until.map(f64::to_bits)))
        };
        of_loads.into_iter().chain(of_supports).chain(of_joints).filter(is_new).chain(of_fields).collect()
    }

    /// The first load by a field that is not a finite number at one of its points between two times: its number, the
    /// point and the time. 1000 times are tried at a few points, fewer at all of them; a costly field is tried at the
    /// start only.
    ///
    /// ```
    /// use emmy::prelude::*;
    /// use emmy::body::Field;
    /// let field = Field::new(|X, t| [X[0] / (t - 0.5), 0.0, 0.0]);
    /// let load = Load::new(LoadKind::BodyForceField { group: None, field });
    /// let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 1.0);
    /// let body = Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).load(load).build()?;
    /// assert!(matches!(body.field_not_finite(0.0, 1.0), Some((0, _, 0.5))));
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn field_not_finite(&self, start: f64, end: f64) -> Option<(usize, [f64; 3], f64)> {
        self.over_time().find_map(|load| {
            let found = load.find_not_finite([start, end]);
            let (X, time) = self.space.of_lowest_rank(found)?;
            Some((load.number(), X, time))
        })
    }

    /// Resultant of every load at factor 1 in the reference configuration; for a field, with its time function, at t =
    /// 0, or NaN if it is not finite there.
    pub fn load_resultants(&self) -> Vec<LoadResultant> {
        let rest = vec![0.0; self.n_dofs()];
        let resultant = |load: &dyn OverTime| {
            let mut force = rest.clone();
            load.add_unit_force(&mut force);
            let (torque, force) = (self.space.moment(&rest, &force), self.space.sum(&force));
            LoadResultant { force, torque }
        };
        self.over_time().map(resultant).collect()
    }

    /// A load at factor 1 in the reference configuration, `[n_nodes][3]`, as [`Body::load_resultants`]; `None` if there
    /// is none of this number.
    pub(crate) fn unit_load(&self, number: usize) -> Option<Vec<f64>> {
        let load = self.over_time().find(|load| load.number() == number)?;
        let mut force = vec![0.0; self.n_dofs()];
        load.add_unit_force(&mut force);
        self.space.gather(&mut force);
        Some(force)
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
        let acts = loaded.loads_at(1.0, &mut vec![0.0; self.n_dofs()]).unwrap_or(true);
        let [acts] = self.ranks().any("loads that act", [acts]);
        acts || loaded.mechanism.acts_at(1.0)
            || loaded.space.driven_distance(1.0, &vec![0.0; self.n_dofs()]) > 0.0
    }
}
