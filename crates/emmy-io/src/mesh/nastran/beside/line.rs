//! Springs and dampers along the line between two grid points.

use super::super::super::abaqus::At;
use super::Work;
use super::fields::{Outcome, Reason};
use super::register::{table, text, vector};
use crate::vector::{distance, dot, minus};
use toml::Value;

/// A spring or damper along a line.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) card: &'static str,
    pub(super) label: String,
    pub(super) at: At,
    pub(super) ends: [u64; 2],
    pub(super) stiffness: f64,
    pub(super) damping: f64,
}

/// Sine of an angle that is rounding of coordinates.
const ROUNDING: f64 = 1e-5;

impl Work<'_> {
    /// A line between two grid points at different places.
    pub(super) fn line_between(&self, ends: [u64; 2]) -> Outcome<Line> {
        let [a, b] = ends.map(|end| self.grids.place(end));
        if self.grids.is_near(a, b) {
            return Err(Reason::new("its two grid points lie at one place"));
        }
        let at = At { file: 0, line: 0 };
        Ok(Line { card: "", label: String::new(), at, ends, stiffness: 0.0, damping: 0.0 })
    }

    /// The same, if the components of both ends lie along it.
    pub(super) fn line_along(&self, ends: [u64; 2], directions: [[f64; 3]; 2]) -> Outcome<Line> {
        let line = self.line_between(ends)?;
        let [a, b] = ends.map(|end| self.grids.place(end));
        let along = minus(b, a);
        let cosines = directions.map(|direction| dot(direction, along) / distance(a, b));
        // 1 - cos is half the square of the angle.
        let is_along = cosines.iter().all(|cosine| 1.0 - cosine.abs() <= 0.5 * ROUNDING * ROUNDING);
        match is_along && cosines[0] * cosines[1] > 0.0 {
            true => Ok(line),
            false => Err(Reason::new("its component is not along the line between its grid points")),
        }
    }

    /// Makes entries of all lines; those between the same two grid points are one.
    pub(super) fn lines(&mut self) {
        let mut order: Vec<[u64; 2]> = Vec::new();
        let mut of_pair = std::collections::HashMap::<[u64; 2], Vec<Line>>::new();
        for line in std::mem::take(&mut self.lines) {
            let [a, b] = line.ends;
            let key = [a.min(b), a.max(b)];
            let own = of_pair.entry(key).or_default();
            if own.is_empty() {
                order.push(key);
            }
            own.push(line);
        }
        for lines in order.iter().filter_map(|pair| of_pair.remove(pair)) {
            if let Err(reason) = self.line(&lines) {
                for line in lines {
                    self.register.leave_out_named(line.card, line.label, line.at, reason.clone());
                }
            }
        }
    }

    fn line(&mut self, lines: &[Line]) -> Outcome<()> {
        // The spring gives the name.
        let first = lines.iter().find(|line| line.stiffness > 0.0).unwrap_or(&lines[0]);
        let wanted = format!("{}_{}", first.card.to_ascii_lowercase(), first.label);
        let ends = first.ends.map(|end| self.resolved(end));
        let body = ends.map(|end| self.body_of.get(&end));
        if ends[0] == ends[1] || body[0].is_some() && body[0] == body[1] {
            return Err(Reason::new("both ends move as one"));
        }
        let n_groups = self.register.groups.len();
        let between = self.ends_of(ends, &wanted).inspect_err(|_| self.register.groups.truncate(n_groups));
        let points = Value::Array(ends.map(|end| vector(self.grids.place(end))).to_vec());
        let line = table([("between", between?), ("points", points)]);
        let name = self.register.name(&wanted);
        let mut rows = table([("name", text(&name)), ("line", Value::Table(line))]);
        let sum = |of: fn(&Line) -> f64| lines.iter().map(of).sum::<f64>();
        let (stiffness, damping) = (sum(|line| line.stiffness), sum(|line| line.damping));
        if stiffness > 0.0 {
            let spring = table([("stiffness", Value::Float(stiffness))]);
            rows.insert("spring".to_string(), Value::Table(spring));
        }
        if damping > 0.0 {
            rows.insert("damping".to_string(), Value::Float(damping));
        }
        let others = lines.iter().filter(|line| line.label != first.label || line.card != first.card);
        let others = others.map(|line| format!(", {} {}", line.card, line.label));
        let label = first.label.clone() + &others.collect::<String>();
        let what = match stiffness > 0.0 {
            true => ["spring along a line acts", "springs along lines act"],
            false => ["damper along a line acts", "dampers along lines act"],
        };
        self.register.add("joint", &name, (first.card, label), what, rows);
        Ok(())
    }
}
