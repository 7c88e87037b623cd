//! Springs, dampers and masses between components of grid points: `CELAS1`, `CELAS2`, `CDAMP1`, `CDAMP2`, `CMASS1`,
//! `CMASS2`, and `CBUSH`.

use std::collections::{BTreeMap, HashMap};

use super::super::super::abaqus::At;
use super::super::super::entry::first_names;
use super::super::element::is_blank;
use super::Work;
use super::fields::{Outcome, Reason, Stored, number};
use super::grids::Grids;
use super::line::Line;
use super::mass::Mass;
use super::register::{table, text};
use toml::Value;

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    Spring,
    Damper,
    Mass,
}

/// A component of a grid point.
type End = (u64, u8);

/// A spring, damper or mass between two components, or a component and the ground.
struct Scalar<'a> {
    card: &'a Stored,
    kind: Kind,
    value: f64,
    ends: [Option<End>; 2],
}

/// A spring between a grid point and the ground, alike in all directions.
#[derive(Debug)]
pub(super) struct Support {
    card: &'static str,
    label: String,
    /// The name of its entry.
    name: String,
    at: At,
    grid: u64,
    stiffness: f64,
}

/// Part of a stiffness or mass that is rounding.
const ROUNDING: f64 = 1e-6;

/// Values of properties by their cards and numbers.
type Values = HashMap<(&'static str, u64), f64>;

impl Work<'_> {
    /// Values in `PELAS`, `PDAMP` and `PMASS`, of which several stand in one card.
    fn values(&self) -> Values {
        let mut values = Values::new();
        for card in self.cards {
            let step = match card.name {
                "PELAS" => 4,
                "PDAMP" | "PMASS" => 2,
                _ => continue,
            };
            for first in (0..card.fields.len()).step_by(step) {
                // A property that no element finds is none.
                if let (Ok(number), Ok(value)) = (card.number(first), card.real(first + 1)) {
                    values.insert((card.name, number), value);
                }
            }
        }
        values
    }

    /// Reads springs, dampers and masses of components: masses join the others, and lines are kept.
    pub(super) fn scalars(&mut self) -> Vec<Support> {
        let values = self.values();
        let mut grounded = BTreeMap::<(Kind, u64), Vec<Scalar<'_>>>::new();
        let mut is_damped = Vec::new();
        for card in self.cards {
            let (kind, property) = match card.name {
                "CELAS1" => (Kind::Spring, Some("PELAS")),
                "CELAS2" => (Kind::Spring, None),
                "CDAMP1" => (Kind::Damper, Some("PDAMP")),
                "CDAMP2" => (Kind::Damper, None),
                "CMASS1" => (Kind::Mass, Some("PMASS")),
                "CMASS2" => (Kind::Mass, None),
                _ => continue,
            };
            let scalar = scalar(card, kind, property, &values, &self.grids);
            if card.name == "CELAS2" && card.real(6).is_ok_and(|damping| damping != 0.0) {
                is_damped.push(card.label());
            }
            let made = scalar.and_then(|scalar| match scalar.ends {
                [Some(end), None] | [None, Some(end)] => {
                    grounded.entry((kind, end.0)).or_default().push(scalar);
                    Ok(())
                }
                [Some(a), Some(b)] => self.between(&scalar, [a, b]),
                [None, None] => Err(Reason::fault("it has no grid point")),
            });
            if let Err(reason) = made {
                self.register.leave_out(card, reason);
            }
        }
        if !is_damped.is_empty() {
            let names = first_names(&is_damped);
            self.register.remark(format!("the structural damping GE of springs is left out: CELAS2 {names}"));
        }
        let mut supports = Vec::new();
        for ((kind, grid), scalars) in grounded {
            match alike(kind, &scalars) {
                Ok(value) => {
                    let card = scalars[0].card;
                    let label = |scalar: &Scalar<'_>| match scalar.card.name == card.name {
                        true => scalar.card.label(),
                        false => format!("{} {}", scalar.card.name, scalar.card.label()),
                    };
                    let labels: Vec<String> = scalars.iter().map(label).collect();
                    let name = format!("{}_{}", card.name.to_ascii_lowercase(), card.label());
                    let (label, at) = (labels.join(", "), card.at);
                    if kind == Kind::Mass {
                        let centre = self.grids.place(grid);
                        let (mass, inertia) = (value, None);
                        self.masses.push(Mass {
                            card: card.name,
                            label,
                            name,
                            at,
                            grid,
                            mass,
                            centre,
                            inertia,
                        });
                    } else {
                        supports.push(Support { card: card.name, label, name, at, grid, stiffness: value });
                    }
                }
                Err(reason) => {
                    scalars.iter().for_each(|scalar| self.register.leave_out(scalar.card, reason.clone()));
                }
            }
        }
        supports.extend(self.bushings());
        supports
    }

    /// A spring or damper along the line between its grid points.
    fn between(&mut self, scalar: &Scalar<'_>, ends: [End; 2]) -> Outcome<()> {
        let Scalar { card, kind, value, .. } = scalar;
        let [a, b] = ends.map(|(grid, _)| grid);
        if *kind == Kind::Mass {
            return Err(Reason::new("it is between two grid points"));
        }
        let directions = [self.direction(ends[0])?, self.direction(ends[1])?];
        let line = self.line_along([a, b], directions)?;
        let [stiffness, damping] = match kind {
            Kind::Spring => [*value, 0.0],
            _ => [0.0, *value],
        };
        self.lines.push(Line {
            card: card.name,
            label: card.label(),
            at: card.at,
            stiffness,
            damping,
            ..line
        });
        Ok(())
    }

    fn direction(&mut self, (grid, component): End) -> Outcome<[f64; 3]> {
        Ok(self.grids.directions(grid)?[usize::from(component - 1)])
    }

    /// `CBUSH` with a stiffness: to the ground and alike in all directions, or along a line.
    fn bushings(&mut self) -> Vec<Support> {
        let cards = self.cards;
        let properties: HashMap<u64, &Stored> = cards
            .iter()
            .filter(|card| card.name == "PBUSH")
            .filter_map(|card| Some((card.number(0).ok()?, card)))
            .collect();
        let mut supports = Vec::new();
        for card in cards.iter().filter(|card| card.name == "CBUSH") {
            let is_link = card.number(0).is_ok_and(|number| self.links.contains(&number));
            let number = if card.field(1).is_empty() { card.number(0) } else { card.number(1) };
            let property = number.ok().and_then(|number| properties.get(&number));
            let is_grounded = is_blank(card.field(2)) || is_blank(card.field(3));
            let made = match property {
                _ if is_link => continue,
                // A line without a stiffness is the nodes at its ends.
                None if !is_grounded => continue,
                None => Err(Reason::new("its property has no PBUSH")),
                Some(property) => self.bushing(card, property),
            };
            match made {
                Ok(support) => supports.extend(support),
                Err(reason) => self.register.leave_out(card, reason),
            }
        }
        supports
    }

    fn bushing(&mut self, card: &Stored, property: &Stored) -> Outcome<Option<Support>> {
        let number = card.number(0)?;
        let [stiffness, damping] = [values_of(property, "K")?, values_of(property, "B")?];
        let grids: Vec<u64> = [2, 3]
            .into_iter()
            .filter(|&index| !is_blank(card.field(index)))
            .map(|index| card.number(index))
            .collect::<Outcome<_>>()?;
        grids.iter().try_for_each(|&grid| self.grids.known(grid))?;
        let is_zero = |values: &[f64]| values.iter().all(|value| *value == 0.0);
        let is_alike = stiffness[..3].iter().all(|k| (k - stiffness[0]).abs() <= ROUNDING * stiffness[0]);
        let (name, label) = (format!("cbush_{number}"), number.to_string());
        match grids[..] {
            [grid] if is_alike && stiffness[0] > 0.0 => {
                let turns = !self.grids.is_of_cell(grid) && !is_zero(&stiffness[3..]);
                if turns || !is_zero(&damping[..3]) {
                    let what = if turns { "rotational stiffness" } else { "damping" };
                    let what = format!("the {what} of CBUSH");
                    let reason = Reason::new("a spring to the ground has none");
                    self.register.leave_out_named(&what, label.clone(), card.at, reason);
                }
                Ok(Some(Support { card: card.name, label, name, at: card.at, grid, stiffness: stiffness[0] }))
            }
            [_] => Err(Reason::new("its stiffness is not alike in 1, 2 and 3 (K1, K2, K3)")),
            // Its axis x is the line between the grid points, unless a system is given.
            [a, b] if is_zero(&stiffness[1..]) && is_zero(&damping[1..]) && card.field(7).is_empty() => {
                let line = self.line_between([a, b])?;
                let own = [stiffness[0], damping[0]];
                if own.iter().any(|value| *value < 0.0) || is_zero(&own) {
                    return Err(Reason::new("its stiffness is not above 0"));
                }
                let [stiffness, damping] = own;
                self.lines.push(Line { card: card.name, label, at: card.at, stiffness, damping, ..line });
                Ok(None)
            }
            _ => Err(Reason::new("it has stiffness or damping beside that along its line (K1, B1)")),
        }
    }

    /// Makes the entry of a spring to the ground.
    pub(super) fn support(&mut self, support: Support) {
        let Support { card, label, name, at, grid, stiffness } = support;
        let own = self.resolved(grid);
        let place = self.grids.place(own);
        let is_at = |centre: [f64; 3]| self.grids.is_near(centre, place);
        let body = self.body_of.get(&own).map(|&body| &self.bodies[body]);
        let at_point = match (self.means.get(&own), self.free.get(&own), body) {
            _ if self.grids.is_of_cell(own) => None,
            (Some(mean), ..) => Some(mean.clone()),
            (_, Some((name, centre, _)), _) if is_at(*centre) => {
                self.held.insert(own);
                Some(name.clone())
            }
            (_, _, Some(body)) if is_at(body.place) && !body.nodes.is_empty() => Some(body.name.clone()),
            _ => {
                let why = "its grid point has no cell, and is not the point of a coupling or mass";
                return self.register.leave_out_named(card, label, at, Reason::new(why));
            }
        };
        let group = match at_point {
            Some(name) => name,
            None => self.register.group(&format!("{name}-node"), [own]),
        };
        let name = self.register.name(&name);
        self.register.used.extend([grid, own]);
        let rows = table([("group", text(&group)), ("spring", Value::Float(stiffness))]);
        let what = ["spring to the ground acts", "springs to the ground act"];
        self.register.add("support", &name, (card, label), what, rows);
    }
}

/// A spring, damper or mass with the value of its own or of its property.
fn scalar<'a>(
    card: &'a Stored,
    kind: Kind,
    property: Option<&'static str>,
    values: &Values,
    grids: &Grids<'_>,
) -> Outcome<Scalar<'a>> {
    card.number(0)?;
    let value = match property {
        None => card.real(1)?,
        Some(property) => {
            let number = if card.field(1).is_empty() { card.number(0)? } else { card.number(1)? };
            let missing = || Reason::new(format!("its property has no {property}"));
            *values.get(&(property, number)).ok_or_else(missing)?
        }
    };
    let end = |index: usize| -> Outcome<Option<End>> {
        if is_blank(card.field(index)) {
            return Ok(None);
        }
        let grid = card.number(index)?;
        let component = if is_blank(card.field(index + 1)) { 0 } else { number(card.field(index + 1))? };
        match component {
            0 => Err(Reason::new("it is at a scalar point")),
            1..=3 => grids.known(grid).map(|()| Some((grid, component as u8))),
            4..=6 => Err(Reason::new("it is at a rotation")),
            _ => Err(Reason::fault(format!("there is no component {component}"))),
        }
    };
    let ends = [end(2)?, end(4)?];
    if value <= 0.0 {
        return Err(Reason::new(match kind {
            Kind::Spring => "its stiffness is not above 0",
            Kind::Damper => "its damping is not above 0",
            Kind::Mass => "its mass is not above 0",
        }));
    }
    Ok(Scalar { card, kind, value, ends })
}

/// The value that springs or masses of a grid point have in each direction.
fn alike(kind: Kind, scalars: &[Scalar<'_>]) -> Outcome<f64> {
    if kind == Kind::Damper {
        return Err(Reason::new("no damper acts between a grid point and the ground"));
    }
    let mut sums = [0.0; 3];
    for scalar in scalars {
        for (_, component) in scalar.ends.iter().flatten() {
            sums[usize::from(component - 1)] += scalar.value;
        }
    }
    match sums.iter().all(|sum| (sum - sums[0]).abs() <= ROUNDING * sums[0]) {
        true => Ok(sums[0]),
        false => Err(Reason::new("those of its grid point are not alike in 1, 2 and 3")),
    }
}

/// Six values of `PBUSH` after a word; zeros without it.
fn values_of(property: &Stored, word: &str) -> Outcome<[f64; 6]> {
    let mut values = [0.0; 6];
    let is_word = |&index: &usize| property.field(index).eq_ignore_ascii_case(word);
    let Some(start) = (1..property.fields.len()).step_by(8).find(is_word) else { return Ok(values) };
    for (i, value) in values.iter_mut().enumerate() {
        if property.field(start + 1 + i).eq_ignore_ascii_case("RIGID") {
            return Err(Reason::new("its property has a stiffness RIGID"));
        }
        *value = property.real(start + 1 + i)?;
    }
    Ok(values)
}
