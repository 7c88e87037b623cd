//! Motions of the parts of a body with rigid bodies and joints that nothing holds.

use std::collections::BTreeMap;

use super::held::{MOTIONS, Part, Twist, listed, reduced};
use super::system::Body;
use crate::average::Rule;
use crate::error::{Error, Result};
use crate::quadrature::gauss;
use crate::sparse::null_space;

/// Components of a motion of a part below this part of the largest of all count as zero.
const ROUNDING: f64 = 1e-6;

/// Change of a constraint by a rigid motion of its part that is rounding.
const NO_CHANGE: f64 = 1e-9;

/// Rows of numbers of the motions of all parts, as the sum of their squares: it is zero for motions that nothing holds.
struct Held {
    n: usize,
    sum: Vec<f64>,
}

impl Held {
    fn new(n: usize) -> Self {
        Held { n, sum: vec![0.0; n * n] }
    }

    /// Adds a row, at unit length.
    fn add(&mut self, row: &BTreeMap<usize, f64>) {
        let square: f64 = row.values().map(|x| x * x).sum();
        if square == 0.0 {
            return;
        }
        for (a, x) in row {
            row.iter().for_each(|(b, y)| self.sum[a * self.n + b] += x * y / square);
        }
    }

    /// Adds a square of the motions of one part.
    fn add_square(&mut self, part: usize, square: &[f64]) {
        for (at, entry) in square.iter().enumerate() {
            let [row, column] = [at / MOTIONS, at % MOTIONS].map(|motion| MOTIONS * part + motion);
            self.sum[row * self.n + column] += entry;
        }
    }
}

/// Receives the entries of a gradient: degree of freedom and number.
type Visit<'v> = dyn FnMut(usize, f64) + 'v;

impl Body {
    /// Checks that supports, springs, attractions and joints hold each part of a body with rigid bodies or joints.
    ///
    /// # Errors
    /// [`Error::NotHeld`] names a part that moves most in some motion, and how.
    pub(super) fn check_mechanism_held(&self) -> Result<()> {
        let parts = self.connected_parts();
        let named: Vec<(String, Part<'_>)> = parts
            .into_iter()
            .map(|(cell, nodes)| (self.name_of(cell, &nodes), Part::new(self, nodes)))
            .collect();
        let mut held = Held::new(MOTIONS * named.len());
        let mut assembly = self.assembly(&Rule::standard(1, &gauss(1)));
        let mut part_of = vec![usize::MAX; self.mesh().n_nodes()];
        for (number, (_, part)) in named.iter().enumerate() {
            part.nodes().iter().for_each(|&node| part_of[node as usize] = number);
            held.add_square(number, &part.held(self, &mut assembly)?);
        }
        // A change of a degree of freedom by the motions of its part.
        let add = |row: &mut BTreeMap<usize, f64>, dof: usize, factor: f64| {
            let (node, component) = (dof / 3, dof % 3);
            let number = part_of[node];
            if number != usize::MAX {
                let twist = named[number].1.row(node as u32, component);
                for (motion, x) in twist.iter().enumerate() {
                    *row.entry(MOTIONS * number + motion).or_insert(0.0) += factor * x;
                }
            }
        };
        let mut hold = |for_each: &dyn Fn(&mut Visit<'_>)| {
            let mut row = BTreeMap::new();
            for_each(&mut |dof, factor| add(&mut row, dof, factor));
            // A joint inside one part does not hold it, but for rounding.
            let largest = row.values().fold(0.0f64, |most, x| most.max(x.abs()));
            row.retain(|_, x| x.abs() > ROUNDING * largest);
            if largest > NO_CHANGE {
                held.add(&row);
            }
        };
        for row in self.constraints().rows() {
            hold(&|visit| row.for_each_gradient(&|_| 0.0, visit));
        }
        for law in self.mechanism.springs() {
            hold(&|visit| law.measure().for_each_gradient(&|_| 0.0, visit));
        }
        let free = null_space(&held.sum)?;
        let Some(first) = free.first() else { return Ok(()) };
        let size = |motion: &[f64]| motion.iter().map(|x| x * x).sum::<f64>();
        let moves = first.chunks_exact(MOTIONS).enumerate();
        let (number, _) =
            moves.fold((0, -1.0), |best, (at, own)| if size(own) > best.1 { (at, size(own)) } else { best });
        let own = |motion: &Vec<f64>| motion[MOTIONS * number..MOTIONS * (number + 1)].to_vec();
        let (name, part) = &named[number];
        let places: Vec<[f64; 3]> = self.joints().iter().map(|joint| joint.at).collect();
        let twists: Vec<Twist> = reduced(free.iter().map(own).collect());
        let is_one = |twist: &&Twist| size(&twist[..]) > ROUNDING;
        let motions: Vec<String> =
            twists.iter().filter(is_one).map(|twist| part.name(twist, &places)).collect();
        let contacts = self.open_contacts(part.nodes());
        Err(Error::NotHeld { part: name.clone(), motions: listed(&motions), contacts })
    }

    /// The name of a part: of its first rigid body, or by a cell.
    fn name_of(&self, cell: usize, nodes: &[u32]) -> String {
        let frames = &self.mechanism.frames;
        let own = frames.iter().find(|frame| nodes.binary_search(&frame.nodes().start).is_ok());
        own.map_or_else(
            || format!("the part of the body with cell {cell}"),
            |frame| format!("the part `{}`", frame.name()),
        )
    }
}
