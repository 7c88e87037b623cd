//! `MPC`: three equations that let a grid point move with others in all directions.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use emmy::internals::tensor::det;

use super::super::super::entry::first_names;
use super::Work;
use super::fields::{Outcome, Reason, Stored};
use super::mean::Average;
use super::pair::{How, Pair};
use crate::vector::distance;

/// Part of a sum that is rounding: fields of eight columns have few digits.
const ROUNDING: f64 = 1e-5;

/// Terms: grid point, component and factor; the dependent one comes first.
type Equation = Vec<(u64, u8, f64)>;

/// A matrix of 3 x 3.
type Block = [[f64; 3]; 3];

/// The terms of a card.
fn terms(card: &Stored) -> Outcome<Equation> {
    let n_lines = card.fields.len().div_ceil(8).max(1);
    let mut all = Vec::new();
    for (line, place) in (0..n_lines).flat_map(|line| [(line, 1), (line, 4)]) {
        let first = 8 * line + place;
        if (0..3).all(|i| card.field(first + i).is_empty()) {
            continue;
        }
        let grid = card.number(first)?;
        let component = match card.field(first + 1) {
            "" => 0,
            _ => card.number(first + 1)?,
        };
        if component > 6 {
            return Err(Reason::fault(format!("there is no component {component}")));
        }
        all.push((grid, component as u8, card.real(first + 2)?));
    }
    match all.first() {
        None => Err(Reason::fault("it has no terms")),
        Some((.., 0.0)) => Err(Reason::fault("its first factor is 0")),
        Some(_) => Ok(all),
    }
}

impl Work<'_> {
    /// Makes pairs of equations between two grid points at one place; the others are averages.
    pub(super) fn equations(&mut self) -> Vec<Average> {
        let sets = self.sets_of_equations();
        let mut all = BTreeMap::<(u64, u64), Vec<(&Stored, Equation)>>::new();
        let mut unused = BTreeMap::<u64, usize>::new();
        for card in self.cards.iter().filter(|card| card.name == "MPC") {
            match card.number(0).and_then(|set| Ok((set, terms(card)?))) {
                Ok((set, _)) if sets.as_ref().is_some_and(|sets| !sets.contains(&set)) => {
                    *unused.entry(set).or_default() += 1;
                }
                Ok((set, terms)) => all.entry((set, terms[0].0)).or_default().push((card, terms)),
                Err(reason) => {
                    self.register.leave_out_named("MPC", format!("line {}", card.at.line), card.at, reason)
                }
            }
        }
        let chosen: Vec<String> = self.sets.iter().map(u64::to_string).collect();
        if !unused.is_empty() {
            let n: usize = unused.values().sum();
            let are = crate::message::counted(n, "equation is", "equations are");
            let names: Vec<String> = unused.keys().map(u64::to_string).collect();
            let (names, chosen) = (first_names(&names), first_names(&chosen));
            self.register.remark(format!(
                "MPC: {are} left out, for the case control chooses {chosen} and not {names}"
            ));
        }
        let found: BTreeSet<u64> = all.keys().map(|(set, _)| *set).collect();
        if sets.is_none() && !found.is_empty() {
            let names: Vec<String> = found.iter().map(u64::to_string).collect();
            let act = match &names[..] {
                [set] => format!("set {set} acts"),
                sets => format!("sets {} act", first_names(sets)),
            };
            self.register.remark(format!("MPC: no case control chooses a set: {act}"));
        }
        let mut averages = Vec::new();
        for ((set, grid), mut equations) in all {
            // Equations of rotations beside those of translations.
            let (own, others): (Vec<_>, Vec<_>) =
                equations.drain(..).partition(|(_, terms)| (1..=3).contains(&terms[0].1));
            for (card, terms) in others {
                let reason = match terms[0].1 {
                    0 => "they are of scalar points",
                    _ => "they are of rotations",
                };
                self.leave_out_equation(card, grid, Reason::new(reason));
            }
            match self.weights(grid, &own) {
                Ok(weights) => {
                    let Some((card, _)) = own.first() else { continue };
                    let (label, name) = (format!("{set} of grid point {grid}"), format!("mpc_{set}_{grid}"));
                    match weights[..] {
                        [(leader, _)] => {
                            let how = How::Meet;
                            let ends = [leader, grid];
                            self.pairs.push(Pair { card: "MPC", label, name, at: card.at, ends, how });
                        }
                        _ => averages.push(Average { card: "MPC", label, name, at: card.at, grid, weights }),
                    }
                }
                Err(reason) => {
                    for (card, _) in own {
                        self.leave_out_equation(card, grid, reason.clone());
                    }
                }
            }
        }
        averages
    }

    fn leave_out_equation(&mut self, card: &Stored, grid: u64, reason: Reason) {
        let name = format!("grid point {grid}");
        self.register.leave_out_named("MPC", name, card.at, reason);
    }

    /// The sets that the case control chooses, with those that `MPCADD` adds; none: it chooses none.
    fn sets_of_equations(&mut self) -> Option<BTreeSet<u64>> {
        let mut sums = HashMap::<u64, Vec<u64>>::new();
        for card in self.cards.iter().filter(|card| card.name == "MPCADD") {
            match card.number(0) {
                Ok(set) => {
                    let fields = card.fields.iter().skip(1);
                    sums.entry(set).or_default().extend(fields.filter_map(|field| field.parse::<u64>().ok()));
                }
                Err(reason) => self.register.leave_out(card, reason),
            }
        }
        if self.sets.is_empty() {
            return None;
        }
        let mut all: BTreeSet<u64> = self.sets.iter().copied().collect();
        all.extend(self.sets.iter().filter_map(|set| sums.get(set)).flatten());
        Some(all)
    }

    /// The weights with which a grid point moves: `u = sum w_i u_i`, with a sum of one, and `X = sum w_i X_i`.
    fn weights(&mut self, grid: u64, equations: &[(&Stored, Equation)]) -> Outcome<Vec<(u64, f64)>> {
        if equations.is_empty() {
            return Ok(Vec::new());
        }
        let all = || equations.iter().flat_map(|(_, terms)| terms);
        if all().any(|(_, component, factor)| *component > 3 && *factor != 0.0) {
            return Err(Reason::new("they have rotations"));
        }
        if all().any(|(_, component, _)| *component == 0) {
            return Err(Reason::new("they have scalar points"));
        }
        all().try_for_each(|(grid, ..)| self.grids.known(*grid))?;
        let dependent: BTreeSet<u8> = equations.iter().map(|(_, terms)| terms[0].1).collect();
        if equations.len() != 3 || dependent.len() != 3 {
            return Err(Reason::new("they are not one for each of the components 1, 2 and 3"));
        }
        let mut blocks = BTreeMap::<u64, Block>::new();
        for (row, (_, terms)) in equations.iter().enumerate() {
            for &(grid, component, factor) in terms {
                let direction = self.grids.directions(grid)?[usize::from(component - 1)];
                let block = blocks.entry(grid).or_default();
                (0..3).for_each(|i| block[row][i] += factor * direction[i]);
            }
        }
        let own = blocks.remove(&grid).unwrap_or_default();
        let size = own.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs()));
        if det(&own).abs() <= ROUNDING * size.powi(3) {
            return Err(Reason::new("they do not determine the motion of the grid point"));
        }
        let mut weights = Vec::new();
        for (other, block) in blocks {
            if let Some(weight) = weight(&own, &block)? {
                weights.push((other, weight));
            }
        }
        let total: f64 = weights.iter().map(|(_, weight)| weight).sum();
        if (total - 1.0).abs() > ROUNDING {
            return Err(Reason::new("the sum of their weights is not 1"));
        }
        weights.iter_mut().for_each(|(_, weight)| *weight /= total);
        let place = self.grids.place(grid);
        let (mut reached, mut size) = ([0.0; 3], 0.0_f64);
        for &(other, weight) in &weights {
            let x = self.grids.place(other);
            (0..3).for_each(|i| reached[i] += weight * x[i]);
            size = size.max(distance(x, place));
        }
        let gap = distance(reached, place);
        if gap > ROUNDING * size && !self.grids.is_near(reached, place) {
            return Err(Reason::new("the grid point does not lie at the weighted mean of the others"));
        }
        if weights.len() == 1 && !self.grids.is_near(reached, place) {
            return Err(Reason::new("the grid point does not lie at the weighted mean of the others"));
        }
        Ok(weights)
    }
}

/// The weight w of `own u + block u_i = 0`, if it is `u = w u_i`; none for zero.
fn weight(own: &Block, block: &Block) -> Outcome<Option<f64>> {
    let size = block.iter().flatten().fold(0.0_f64, |size, x| size.max(x.abs()));
    if size == 0.0 {
        return Ok(None);
    }
    // block = -w own.
    let squares: f64 = own.iter().flatten().map(|x| x * x).sum();
    let product: f64 = own.iter().flatten().zip(block.iter().flatten()).map(|(a, b)| a * b).sum();
    let weight = -product / squares;
    let is_alike = own
        .iter()
        .flatten()
        .zip(block.iter().flatten())
        .all(|(a, b)| (b + weight * a).abs() <= ROUNDING * size);
    match is_alike && weight.is_finite() {
        true => Ok(Some(weight)),
        false => Err(Reason::new("their weights are not alike in all directions")),
    }
}
