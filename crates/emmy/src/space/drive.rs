//! Prescribed motion: nodes of a group whose displacement is a function of time.

use crate::average::Rule;
use crate::input::{NotFinite, Rotation, TimeFunction};
use crate::nodal;

/// Displacement `B (r, 1)` of a node from its offset `r = X - about`, row by row.
pub(crate) type Map = [[f64; 4]; 3];

/// Times at which a motion is evaluated at once, and the largest number of stages.
pub(crate) const AT_ONCE: usize = 32;

/// A function of time that is not a finite number, and its text.
pub(crate) type Fault<'a> = (&'a str, NotFinite);

/// The given motion of a group: a displacement over time in some components, or a rotation with one.
///
/// ```math
/// u(t) = (R(angle(t)) - I) (X - about) + displacement(t)
/// ```
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    /// Number of the support.
    pub(crate) support: usize,
    displacement: [Option<TimeFunction>; 3],
    /// Rotation with an axis of unit length.
    rotation: Option<Rotation>,
    /// Driven components.
    pub(crate) components: [bool; 3],
    nodes: Vec<u32>,
    /// X - about of every node.
    offsets: Vec<[f64; 3]>,
    /// Largest distance of a node from `about` \[length\].
    pub(crate) radius: f64,
    /// Time at which the support is released.
    pub(crate) until: Option<f64>,
}

impl Drive {
    /// The motion of some nodes. `rotation` has an axis of unit length.
    pub(crate) fn new(
        support: usize,
        displacement: [Option<TimeFunction>; 3],
        rotation: Option<Rotation>,
        until: Option<f64>,
        nodes: Vec<u32>,
        points: &[[f64; 3]],
    ) -> Self {
        let about = rotation.as_ref().map_or([0.0; 3], |rotation| rotation.about);
        let offset = |&node: &u32| [0, 1, 2].map(|i| points[node as usize][i] - about[i]);
        let components = [0, 1, 2].map(|i| rotation.is_some() || displacement[i].is_some());
        let offsets: Vec<[f64; 3]> = nodes.iter().map(offset).collect();
        let length = |r: &[f64; 3]| r.iter().map(|x| x * x).sum::<f64>().sqrt();
        Drive {
            support,
            radius: offsets.iter().map(length).fold(0.0, f64::max),
            offsets,
            displacement,
            rotation,
            components,
            nodes,
            until,
        }
    }

    /// The motion that grows evenly, from no displacement at t = 0 to the displacement at a time at t = 1.
    pub(crate) fn in_proportion(&self, time: f64) -> Drive {
        let grown = |time_function: &TimeFunction| TimeFunction::ramp(time_function.value_before(time));
        let rotation = self.rotation.as_ref();
        Drive {
            displacement: self.displacement.each_ref().map(|component| component.as_ref().map(grown)),
            rotation: rotation.map(|rotation| Rotation { angle: grown(&rotation.angle), ..rotation.clone() }),
            until: None,
            ..self.clone()
        }
    }

    /// Driven degrees of freedom.
    pub(crate) fn dofs(&self) -> impl Iterator<Item = usize> + '_ {
        self.entries().map(|(dof, _, _)| dof)
    }

    /// Driven degrees of freedom with their component and the offset of their node.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (usize, usize, &[f64; 3])> + '_ {
        let nodes = self.nodes.iter().zip(&self.offsets);
        nodes.flat_map(move |(&node, offset)| {
            let components = (0..3).filter(|&i| self.components[i]);
            components.map(move |i| (nodal::dof(node as usize, i), i, offset))
        })
    }

    pub(crate) fn time_functions(&self) -> impl Iterator<Item = &TimeFunction> + '_ {
        self.displacement.iter().flatten().chain(self.rotation.as_ref().map(|rotation| &rotation.angle))
    }

    /// The time functions, each with the largest displacement per unit of it.
    pub(crate) fn arms(&self) -> impl Iterator<Item = (&TimeFunction, f64)> + '_ {
        let shifts = self.displacement.iter().flatten().map(|time_function| (time_function, 1.0));
        shifts.chain(self.rotation.as_ref().map(|rotation| (&rotation.angle, self.radius)))
    }

    /// The displacement at a time.
    pub(crate) fn map(&self, time: f64) -> Map {
        self.map_of(|time_function| time_function.value(time), turn)
    }

    /// The displacements at some times; a function of many times is called once.
    pub(crate) fn set_maps(&self, times: &[f64], maps: &mut [Map]) -> Result<(), Fault<'_>> {
        let mut values = [[0.0; AT_ONCE]; 4];
        for (time_function, values) in self.time_functions().zip(&mut values) {
            let values = &mut values[..times.len()];
            time_function.values(times, values);
            if let Some(at) = values.iter().position(|value| !value.is_finite()) {
                let found = NotFinite { time: times[at], value: values[at] };
                return Err((time_function.text().unwrap_or_default(), found));
            }
        }
        for (m, map) in maps.iter_mut().enumerate() {
            // In the order of the functions.
            let mut next = values.iter().map(|values| values[m]);
            *map = self.map_of(|_| next.next().unwrap_or(0.0), turn);
        }
        Ok(())
    }

    /// Rate of the displacement at a time; at a kink, on the side given by the sign of `shift`.
    ///
    /// # Errors
    /// A function whose rate is not a finite number.
    pub(crate) fn finite_rate(&self, time: f64, shift: f64) -> Result<Map, Fault<'_>> {
        let map = self.rate(time, shift);
        let Some(&value) = map.as_flattened().iter().find(|value| !value.is_finite()) else { return Ok(map) };
        let is_undefined = |own: &&TimeFunction| !own.rate_beside(time, shift).is_finite();
        let text = self.time_functions().find(is_undefined).and_then(TimeFunction::text);
        Err((text.unwrap_or_default(), NotFinite { time, value }))
    }

    fn rate(&self, time: f64, shift: f64) -> Map {
        let side = |time_function: &TimeFunction| time_function.rate_beside(time, shift);
        let spin = self.rotation.as_ref().map_or(0.0, |rotation| side(&rotation.angle));
        self.map_of(side, |_| {
            let angle = self.rotation.as_ref().map_or(0.0, |rotation| rotation.angle.value(time));
            (spin * angle.cos(), spin * angle.sin())
        })
    }

    /// `[s A + c A^2 | d]` with the cross product A of the axis; `part` gives d, `turn` gives (s, c) of the angle.
    fn map_of(&self, mut part: impl FnMut(&TimeFunction) -> f64, turn: impl Fn(f64) -> (f64, f64)) -> Map {
        let mut map = [[0.0; 4]; 3];
        for (row, time_function) in map.iter_mut().zip(&self.displacement) {
            row[3] = time_function.as_ref().map_or(0.0, &mut part);
        }
        let Some(rotation) = &self.rotation else { return map };
        let a = rotation.axis;
        let (s, c) = turn(part(&rotation.angle));
        let cross = [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]];
        for (i, j) in (0..9).map(|n| (n / 3, n % 3)) {
            // A^2 = a a^T - I.
            let square = a[i] * a[j] - f64::from(u8::from(i == j));
            map[i][j] = s * cross[i][j] + c * square;
        }
        map
    }

    /// Rates x_i of the displacement in a step, for every stage of a rule, `rates: [k]`.
    ///
    /// ```math
    /// x_i = (1/b_i) integral l_i u' dalpha = (1/b_i) ( l_i(1) w(1) - integral l_i' w dalpha ),   w = u - u(0)
    /// ```
    ///
    /// # Errors
    /// A function that is not a finite number.
    pub(crate) fn set_stage_rates(
        &self,
        rule: &Rule,
        time: f64,
        h: f64,
        rates: &mut [Map],
    ) -> Result<(), Fault<'_>> {
        let mut ends = [[[0.0; 4]; 3]; 2];
        self.set_maps(&[time, time + h], &mut ends)?;
        let [start, end] = ends;
        for (i, rate) in rates.iter_mut().enumerate() {
            *rate = [[0.0; 4]; 3];
            add(rate, rule.basis(i, 1.0), &end, &start);
        }
        let mut outcome = Ok(());
        self.for_each_segment(time, h, |[from, to]| {
            let weights = rule.smooth_quadrature().weights.chunks(AT_ONCE);
            for (points, weights) in rule.smooth_quadrature().points.chunks(AT_ONCE).zip(weights) {
                let n = points.len();
                let mut alphas = [0.0; AT_ONCE];
                alphas.iter_mut().zip(points).for_each(|(alpha, &[s])| *alpha = from + (to - from) * s);
                let mut maps = [[[0.0; 4]; 3]; AT_ONCE];
                let found = self.set_maps(&alphas.map(|alpha| time + alpha * h)[..n], &mut maps[..n]);
                outcome = outcome.and(found);
                for ((&alpha, w), map) in alphas.iter().zip(weights).zip(&maps) {
                    for (i, rate) in rates.iter_mut().enumerate() {
                        add(rate, -(w * (to - from)) * rule.basis_rate(i, alpha), map, &start);
                    }
                }
            }
        });
        let weighted = rates.iter_mut().zip(rule.weights());
        weighted.for_each(|(rate, b)| *rate = rate.map(|row| row.map(|x| x / b)));
        outcome
    }

    /// The parts of a step between kinks, as parts of [0, 1].
    fn for_each_segment(&self, time: f64, h: f64, mut visit: impl FnMut([f64; 2])) {
        let mut from = 0.0;
        let mut after = time;
        while from < 1.0 {
            let kinks = self.time_functions().filter_map(|time_function| time_function.next_kink(after));
            after = kinks.fold(f64::INFINITY, f64::min);
            let to = ((after - time) / h).min(1.0);
            if to > from {
                visit([from, to]);
                from = to;
            }
        }
    }
}

/// Adds `factor (map - start)`.
fn add(sum: &mut Map, factor: f64, map: &Map, start: &Map) {
    for (sum, (map, start)) in sum.iter_mut().zip(map.iter().zip(start)) {
        (0..4).for_each(|j| sum[j] += factor * (map[j] - start[j]));
    }
}

/// `(sin, 1 - cos)` of an angle, without cancellation.
fn turn(angle: f64) -> (f64, f64) {
    (angle.sin(), 2.0 * (0.5 * angle).sin().powi(2))
}

/// A row of a map times `(r, 1)`.
pub(crate) fn apply(row: &[f64; 4], offset: &[f64; 3]) -> f64 {
    row[0] * offset[0] + row[1] * offset[1] + row[2] * offset[2] + row[3]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turning(angle: TimeFunction) -> Drive {
        let rotation = Rotation { axis: [0.6, 0.0, 0.8], about: [1.0, 2.0, 3.0], angle };
        let displacement = [
            None,
            Some(TimeFunction::new(vec![(0.0, 0.0), (0.13, 0.1), (0.3, 0.0)]).unwrap()),
            Some(shaken()),
        ];
        Drive::new(0, displacement, Some(rotation), None, vec![0], &[[2.0, 1.0, 5.0]])
    }

    /// An acceleration by a table with kinks and a jump.
    fn shaken() -> TimeFunction {
        let entries = vec![(0.0, 2.0), (0.11, -3.0), (0.16, 5.0), (0.16, 1.0), (0.4, 0.0)];
        TimeFunction::from_acceleration(&TimeFunction::new(entries).unwrap(), [0.0, 0.4]).unwrap()
    }

    fn displacement(drive: &Drive, map: &Map) -> [f64; 3] {
        [0, 1, 2].map(|i| apply(&map[i], &drive.offsets[0]))
    }

    #[test]
    fn rotations_keep_lengths_and_rates_match_differences() {
        let drive = turning(TimeFunction::smooth("t + t^2", |t| [t + t * t, 1.0 + 2.0 * t, 2.0]));
        let at = |t: f64| displacement(&drive, &drive.map(t));
        let t = 0.2;
        let d = 1e-5;
        let r = drive.offsets[0];
        let mut q = at(t);
        q[1] -= 0.1 * 0.1 / 0.17;
        q[2] -= shaken().value(t);
        (0..3).for_each(|i| q[i] += r[i]);
        let length = |r: &[f64; 3]| r.iter().map(|x| x * x).sum::<f64>();
        assert!((length(&q) - length(&r)).abs() < 1e-14);
        let rate = displacement(&drive, &drive.rate(t, 0.0));
        for i in 0..3 {
            assert!((rate[i] - (at(t + d)[i] - at(t - d)[i]) / (2.0 * d)).abs() < 1e-9);
        }
    }

    /// `sum_i b_i c_i^m x_i = integral alpha^m u' dalpha` for m < k, with a kink inside the step; for m = 0 that is the
    /// displacement of the step.
    #[test]
    fn stage_rates_have_the_moments_of_the_motion() {
        let drive = turning(TimeFunction::smooth("3 t", |t| [3.0 * t, 3.0, 0.0]));
        let time = 0.1;
        let h = 0.15;
        for degree in 1..=4 {
            let rule = Rule::discrete_gradient(degree);
            let mut rates = vec![[[0.0; 4]; 3]; degree];
            drive.set_stage_rates(&rule, time, h, &mut rates).unwrap();
            let x: Vec<[f64; 3]> = rates.iter().map(|rate| displacement(&drive, rate)).collect();
            for m in 0..degree {
                let mut exact = [0.0; 3];
                drive.for_each_segment(time, h, |[from, to]| {
                    for (&[s], w) in crate::quadrature::gauss(12).iter() {
                        let (alpha, w) = (from + (to - from) * s, w * (to - from));
                        let rate = displacement(&drive, &drive.rate(time + alpha * h, 0.0));
                        (0..3).for_each(|i| exact[i] += w * alpha.powi(m as i32) * h * rate[i]);
                    }
                });
                for component in 0..3 {
                    let term =
                        |i: usize| rule.weights()[i] * rule.nodes()[i].powi(m as i32) * x[i][component];
                    let sum: f64 = (0..degree).map(term).sum();
                    assert!((sum - exact[component]).abs() < 1e-13, "k = {degree}, m = {m}");
                }
            }
        }
    }
}
