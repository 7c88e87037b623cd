//! Displacement that is given by its acceleration.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::TimeFunction;
use crate::error::{Error, Result};
use crate::quadrature::{Quadrature, gauss};

/// Displacement with an acceleration, from rest at the start.
///
/// ```math
/// v(t) = integral from start to t of a(s) ds,        u(t) = integral from start to t of (t - s) a(s) ds
/// ```
///
/// Between the entries of a table it is a cubic polynomial. A smooth acceleration is integrated on equal panels, cut at
/// its kinks, by a Gauss rule, a costly one on fewer panels, and only up to the times that were asked for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Integrated {
    acceleration: TimeFunction,
    pieces: Pieces,
    /// Name of the displacement of a smooth acceleration.
    text: Option<Arc<str>>,
}

/// Velocity and displacement at a time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Path {
    pub(super) velocity: f64,
    pub(super) displacement: f64,
}

#[derive(Debug, Clone, PartialEq)]
enum Pieces {
    Cubic(Vec<Cubic>),
    Panels(Panels),
}

/// The path from a time on, with an acceleration that is linear in time.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cubic {
    time: f64,
    acceleration: f64,
    /// Rate of the acceleration.
    rate: f64,
    path: Path,
}

/// Equal panels.
#[derive(Debug)]
struct Panels {
    start: f64,
    size: f64,
    /// Number of panels in the span; a time after it is reached from the last one.
    n: usize,
    points: Quadrature<1>,
    known: Mutex<Known>,
}

/// The path at the ends of the panels that are integrated.
#[derive(Debug, Clone, PartialEq)]
struct Known {
    paths: Vec<Path>,
    sums: [Sum; 2],
}

/// Binary logarithm of the smallest number of panels in the span, also for a costly function.
const PANELS: i32 = 14;
const COSTLY_PANELS: i32 = 9;

/// Gauss points of a panel.
const POINTS: usize = 10;

impl Integrated {
    /// The displacement with an acceleration in a span of time.
    ///
    /// # Errors
    /// [`Error::TimeFunction`] if the acceleration is an integral itself or is not finite.
    pub(super) fn new(acceleration: &TimeFunction, [start, end]: [f64; 2]) -> Result<Self> {
        if acceleration.acceleration().is_some() {
            return Err(Error::TimeFunction { entry: 0, reason: "an acceleration is no double integral" });
        }
        let pieces = match acceleration.text() {
            Some(_) => Pieces::Panels(Panels::new(acceleration, start, end)),
            None => Pieces::Cubic(cubics(acceleration, start)),
        };
        let text = acceleration.text().map(|text| format!("acceleration {text}").into());
        let integrated = Integrated { acceleration: acceleration.clone(), pieces, text };
        if acceleration.is_costly() {
            return Ok(integrated);
        }
        let Path { velocity, displacement } = integrated.at(end);
        match velocity.is_finite() && displacement.is_finite() {
            true => Ok(integrated),
            false => Err(Error::TimeFunction { entry: 0, reason: "its integrals must be finite numbers" }),
        }
    }

    pub(super) fn acceleration(&self) -> &TimeFunction {
        &self.acceleration
    }

    pub(super) fn text(&self) -> Option<&str> {
        self.text.as_deref()
    }

    /// The path at a time; before the start it is at rest.
    pub(super) fn at(&self, time: f64) -> Path {
        match &self.pieces {
            Pieces::Cubic(cubics) => match cubics.partition_point(|cubic| cubic.time <= time) {
                0 => Path::default(),
                after => cubics[after - 1].at(time),
            },
            Pieces::Panels(panels) => panels.at(&self.acceleration, time),
        }
    }
}

/// The pieces of a table from a start on.
fn cubics(table: &TimeFunction, start: f64) -> Vec<Cubic> {
    let entries = table.entries();
    let first = entries.partition_point(|&(time, _)| time <= start);
    let here = std::iter::once((start, table.value(start)));
    let nodes: Vec<(f64, f64)> = here.chain(entries[first..].iter().copied()).collect();
    let mut sums = [Sum::default(); 2];
    let mut cubics = Vec::with_capacity(nodes.len());
    for (index, &(time, acceleration)) in nodes.iter().enumerate() {
        let path = Path { velocity: sums[0].value, displacement: sums[1].value };
        let next = nodes.get(index + 1).copied().unwrap_or((time, acceleration));
        let h = next.0 - time;
        let rate = if h > 0.0 { (next.1 - acceleration) / h } else { 0.0 };
        let cubic = Cubic { time, acceleration, rate, path };
        let [change, distance] = cubic.change(h);
        sums[0].add(change);
        sums[1].add(distance);
        cubics.push(cubic);
    }
    cubics
}

impl Cubic {
    /// Changes of velocity and displacement after a time.
    fn change(&self, s: f64) -> [f64; 2] {
        let Cubic { acceleration, rate, path, .. } = self;
        [s * (acceleration + s * rate / 2.0), s * (path.velocity + s * (acceleration / 2.0 + s * rate / 6.0))]
    }

    fn at(&self, time: f64) -> Path {
        let [change, distance] = self.change(time - self.time);
        Path { velocity: self.path.velocity + change, displacement: self.path.displacement + distance }
    }
}

impl Panels {
    /// Panels whose size is a power of two, so that a span of another length mostly has the same ones.
    fn new(acceleration: &TimeFunction, start: f64, end: f64) -> Self {
        let panels = if acceleration.is_costly() { COSTLY_PANELS } else { PANELS };
        let size = 2f64.powi((end - start).max(f64::MIN_POSITIVE).log2().floor() as i32 - panels);
        let known = Mutex::new(Known { paths: vec![Path::default()], sums: Default::default() });
        Panels { start, size, n: ((end - start) / size).ceil() as usize, points: gauss(POINTS), known }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The path at the start of a panel.
    fn path(&self, acceleration: &TimeFunction, panel: usize) -> Path {
        let mut known = {
            let known = self.known();
            match known.paths.get(panel) {
                Some(path) => return *path,
                None => known.clone(),
            }
        };
        // Not locked: the function may ask for this path itself.
        let Known { paths, sums } = &mut known;
        for panel in paths.len() - 1..panel {
            let path = paths[panel];
            let [change, distance] =
                self.change(acceleration, self.start + panel as f64 * self.size, self.size);
            sums[0].add(change);
            sums[1].add(path.velocity * self.size);
            sums[1].add(distance);
            paths.push(Path { velocity: sums[0].value, displacement: sums[1].value });
        }
        let path = paths[panel];
        let is_finite = path.velocity.is_finite() && path.displacement.is_finite();
        let mut before = self.known();
        // After a failed call it may have values again.
        if is_finite && before.paths.len() < known.paths.len() {
            *before = known;
        }
        path
    }

    /// Changes of velocity and displacement from rest in a part of a panel.
    fn change(&self, acceleration: &TimeFunction, time: f64, length: f64) -> [f64; 2] {
        let mut change = [0.0; 2];
        for [from, to] in acceleration.segments(time, length) {
            let (time, length) = (time + from * length, (to - from) * length);
            // The velocity at its start carries through the segment.
            change[1] += change[0] * length;
            let (mut times, mut values) = ([0.0; POINTS], [0.0; POINTS]);
            times.iter_mut().zip(&self.points.points).for_each(|(t, &[s])| *t = time + s * length);
            acceleration.values(&times, &mut values);
            for ((&[s], w), value) in self.points.iter().zip(values) {
                let weighted = w * length * value;
                change[0] += weighted;
                change[1] += weighted * (1.0 - s) * length;
            }
        }
        change
    }

    fn at(&self, acceleration: &TimeFunction, time: f64) -> Path {
        if time <= self.start {
            return Path::default();
        }
        let mut panel = (((time - self.start) / self.size) as usize).min(self.n);
        let mut path = self.path(acceleration, panel);
        loop {
            let from = self.start + panel as f64 * self.size;
            let length = (time - from).min(self.size);
            let [change, distance] = self.change(acceleration, from, length);
            path.displacement += path.velocity * length + distance;
            path.velocity += change;
            panel += 1;
            if time - from <= self.size {
                return path;
            }
        }
    }
}

impl Clone for Panels {
    fn clone(&self) -> Self {
        let known = Mutex::new(self.known().clone());
        Panels { known, points: self.points.clone(), ..*self }
    }
}

/// Compares the definitions; values already integrated do not count.
impl PartialEq for Panels {
    fn eq(&self, other: &Self) -> bool {
        (self.start, self.size, self.n) == (other.start, other.size, other.n)
    }
}

/// A sum with its rounding error (Neumaier 1974, Z. Angew. Math. Mech. 54, 39-51).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Sum {
    high: f64,
    low: f64,
    value: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        let sum = self.high + term;
        let part = sum - self.high;
        self.low += (self.high - (sum - part)) + (term - part);
        self.high = sum;
        self.value = self.high + self.low;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_is_integrated_exactly() {
        // a = 6 t up to t = 1, then 6 with a jump to -2 at t = 2: u = t^3, 1 + 3 s + 3 s^2, 7 + 9 s - s^2.
        let table = TimeFunction::new(vec![(-1.0, -6.0), (1.0, 6.0), (2.0, 6.0), (2.0, -2.0)]).unwrap();
        let path = TimeFunction::from_acceleration(&table, [0.0, 5.0]).unwrap();
        for (time, value, rate) in
            [(0.0, 0.0, 0.0), (0.5, 0.125, 0.75), (1.5, 3.25, 6.0), (2.0, 7.0, 9.0), (5.0, 25.0, 3.0)]
        {
            assert_eq!((path.value(time), path.rate(time)), (value, rate), "{time}");
        }
        assert_eq!((path.first_jump(), path.next_kink(1.0), path.text()), (None, Some(2.0), None));
        assert!(TimeFunction::from_acceleration(&path, [0.0, 1.0]).is_err());
    }

    #[test]
    fn a_long_table_loses_no_digits() {
        // a = 1/1024 at 10^5 rows of 1/1024: u = a t^2/2, exact in binary numbers.
        let a = 1.0 / 1024.0;
        let table = TimeFunction::measured((0..100_000).map(|i| (a * f64::from(i), a)).collect()).unwrap();
        let path = TimeFunction::from_acceleration(&table, [0.0, 100.0]).unwrap();
        for time in [1.0, 50.0, 97.25, 200.0] {
            assert!((path.value(time) / (0.5 * a * time * time) - 1.0).abs() < 1e-15, "{time}");
            assert!((path.rate(time) / (a * time) - 1.0).abs() < 1e-15, "{time}");
        }
    }

    #[test]
    fn a_costly_acceleration_is_called_when_it_is_needed() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        let calls = Arc::new(AtomicUsize::new(0));
        let count = calls.clone();
        let law = TimeFunction::of_times("sine", move |times, values| {
            count.fetch_add(times.len(), Ordering::Relaxed);
            values
                .iter_mut()
                .zip(times)
                .for_each(|(value, t)| *value = if *t < 2.0 { (20.0 * t).sin() } else { f64::NAN });
        });
        let path = TimeFunction::from_acceleration(&law, [0.0, 4.0]).unwrap();
        assert_eq!(calls.load(Ordering::Relaxed), 0);
        // u = t/20 - sin(20 t)/400.
        for t in [1.9, 0.3] {
            assert!((path.value(t) - (t / 20.0 - (20.0 * t).sin() / 400.0)).abs() < 1e-15, "{t}");
        }
        // 512 panels of 10 points in the span, half of which is needed, and a part of a panel for each time.
        assert!(calls.load(Ordering::Relaxed) <= 10 * 256 + 20);
        assert!(path.value(2.5).is_nan());
        assert!(path.value(1.9).is_finite());
    }

    #[test]
    fn a_smooth_acceleration_is_integrated_to_round_off() {
        // a = cos(20 t) e^-t = Re e^(z t), z = -1 + 20 i: u = Re (e^(z t) - 1 - z t)/z^2.
        let law = |t: f64| [(20.0 * t).cos() * (-t).exp(), 0.0, 0.0];
        let path = TimeFunction::from_acceleration(&TimeFunction::smooth("damped", law), [0.0, 3.0]).unwrap();
        let exact = |t: f64| {
            let e = [(20.0 * t).cos() * (-t).exp(), (20.0 * t).sin() * (-t).exp()];
            let n = [e[0] - 1.0 + t, e[1] - 20.0 * t];
            let z2 = [1.0 - 400.0, -40.0];
            (n[0] * z2[0] + n[1] * z2[1]) / (z2[0] * z2[0] + z2[1] * z2[1])
        };
        // 8 lies beyond the span.
        for t in [1e-5, 0.1, 0.77, 1.0, 2.999, 3.0, 8.0] {
            assert!(
                (path.value(t) - exact(t)).abs() < 1e-15 * (1.0 + t),
                "{t}: {} {}",
                path.value(t),
                exact(t)
            );
        }
        // Panels are of the same size up to twice the span.
        let longer =
            TimeFunction::from_acceleration(&TimeFunction::smooth("damped", law), [0.0, 3.9]).unwrap();
        assert_eq!(longer.value(2.3), path.value(2.3));
        assert_eq!(path.text(), Some("acceleration damped"));
    }
}
