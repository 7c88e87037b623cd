//! Connectors: elements CONN3D2 with `*CONNECTOR SECTION`, as joints.
//!
//! Directions (Abaqus Elements Guide, "Connection-type library"), local at the first node a unless it says b:
//! - REVOLUTE, and so HINGE, CYLINDRICAL and PLANAR: both bodies keep direction 1 in common.
//! - SLOT, and so CYLINDRICAL and TRANSLATOR: node b stays on the line through a along direction 1.
//! - SLIDE-PLANE, and so PLANAR: node b stays in the plane through it that is normal to direction 1.
//! - UNIVERSAL, and so UJOINT: direction 1 at a stays normal to direction 3 at b.

use toml::Value;

use super::find::{Lump, real};
use super::line::{Line, Rod};
use super::orientation::Axes;
use super::{Entry, Maker, Owned, Rows, inner, list, text, vector};
use crate::vector::{Vector, distance};

/// The constraints of a connector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Spherical,
    Revolute,
    Universal,
    Cylindrical,
    Prismatic,
    Planar,
    Fixed,
    Inline,
    Distance,
    Line,
}

impl Kind {
    /// By the connection types of a section, in upper case.
    fn of(types: &[&str]) -> Option<Kind> {
        Some(match types {
            ["JOIN"] | ["BALL"] => Kind::Spherical,
            // Rotations that are measured but free.
            ["JOIN", "CARDAN" | "EULER" | "ROTATION" | "FLEXION-TORSION"] => Kind::Spherical,
            ["HINGE"] | ["JOIN", "REVOLUTE"] => Kind::Revolute,
            ["UJOINT"] | ["JOIN", "UNIVERSAL"] => Kind::Universal,
            ["CYLINDRICAL"] | ["SLOT", "REVOLUTE"] => Kind::Cylindrical,
            ["TRANSLATOR"] | ["SLOT", "ALIGN"] => Kind::Prismatic,
            ["PLANAR"] | ["SLIDE-PLANE", "REVOLUTE"] => Kind::Planar,
            ["WELD"] | ["JOIN", "ALIGN"] | ["BEAM"] => Kind::Fixed,
            ["SLOT"] => Kind::Inline,
            ["LINK"] => Kind::Distance,
            ["AXIAL"] => Kind::Line,
            _ => return None,
        })
    }

    /// Its key in the input.
    fn key(self) -> &'static str {
        match self {
            Kind::Spherical => "spherical",
            Kind::Revolute => "revolute",
            Kind::Universal => "universal",
            Kind::Cylindrical => "cylindrical",
            Kind::Prismatic => "prismatic",
            Kind::Planar => "planar",
            Kind::Fixed => "fixed",
            Kind::Inline => "inline",
            Kind::Distance => "distance",
            Kind::Line => "line",
        }
    }

    /// Component in which a behaviour can act.
    fn component(self) -> Option<u8> {
        match self {
            Kind::Revolute => Some(4),
            Kind::Prismatic | Kind::Line => Some(1),
            _ => None,
        }
    }

    fn needs_axes(self) -> bool {
        !matches!(self, Kind::Spherical | Kind::Fixed | Kind::Distance | Kind::Line)
    }

    /// Whether the body of node a, and that of node b, must have directions.
    fn needs_directions(self) -> [bool; 2] {
        match self {
            Kind::Spherical | Kind::Distance | Kind::Line => [false; 2],
            Kind::Inline => [true, false],
            _ => [true; 2],
        }
    }
}

/// Linear spring and damper of a behaviour.
#[derive(Debug, Clone, Copy, Default)]
struct Behaviour {
    stiffness: Option<f64>,
    damping: Option<f64>,
}

/// A connector with the data of its section.
struct Connector {
    lump: Lump,
    kind: Kind,
    card: String,
    behaviour: Behaviour,
    axes: Option<[Axes; 2]>,
    name: String,
    of: String,
}

impl<'a> Maker<'a, '_> {
    pub(super) fn connectors(&mut self) {
        for owned in self.cards_of(&["CONNECTORSECTION"]) {
            let lumps = self.lumps_of_card(owned, "CONN");
            if lumps.is_empty() {
                continue;
            }
            let types: Vec<String> = owned
                .card
                .lines
                .first()
                .map(|(_, fields)| fields.as_slice())
                .unwrap_or_default()
                .iter()
                .filter(|field| !field.is_empty())
                .map(|field| field.to_ascii_uppercase())
                .collect();
            let types: Vec<&str> = types.iter().map(String::as_str).collect();
            let section = self.section(owned, &types);
            let set = owned.value("ELSET").unwrap_or_default();
            let card = format!("*CONNECTOR SECTION {}", types.join(", "));
            for lump in lumps {
                match section {
                    Err(reason) => {
                        if self.tell(lump) {
                            self.report.leave_out(
                                card.trim_end(),
                                reason,
                                format!("element {}", self.number_of(lump)),
                            );
                        }
                    }
                    Ok((kind, behaviour, axes)) if self.tell(lump) => {
                        let number = self.number_of(lump);
                        let (name, of) = (format!("{set}-{number}"), format!("element {number}"));
                        let card = card.clone();
                        self.connector(Connector { lump, kind, card, behaviour, axes, name, of });
                    }
                    Ok(_) => {}
                }
            }
        }
    }

    fn section(
        &mut self,
        owned: Owned<'a>,
        types: &[&str],
    ) -> Result<(Kind, Behaviour, Option<[Axes; 2]>), &'static str> {
        let kind = Kind::of(types).ok_or("its connection is not one of a joint")?;
        let behaviour = match owned.value("BEHAVIOR") {
            Some(name) => self.behaviour(owned.instance, name, kind),
            None => Behaviour::default(),
        };
        if kind == Kind::Line && behaviour.stiffness.is_none() && behaviour.damping.is_none() {
            return Err("it has no linear elasticity or damping along its line");
        }
        if !kind.needs_axes() {
            return Ok((kind, behaviour, None));
        }
        let names: Vec<&str> = owned
            .card
            .lines
            .get(1)
            .map(|(_, fields)| fields.as_slice())
            .unwrap_or_default()
            .iter()
            .map(String::as_str)
            .collect();
        let axes = |name: Option<&&str>| {
            name.filter(|name| !name.is_empty())
                .map(|name| self.orientation(owned.instance, name))
                .transpose()
        };
        let first = axes(names.first())?.ok_or("it has no orientation at its first node")?;
        let second = axes(names.get(1))?.unwrap_or(first);
        Ok((kind, behaviour, Some([first, second])))
    }

    /// The linear spring and damper of a behaviour along the coordinate of a joint; the rest is noted.
    fn behaviour(&mut self, instance: Option<u32>, name: &str, kind: Kind) -> Behaviour {
        let mut behaviour = Behaviour::default();
        let is_own = |owned: &Owned<'a>| {
            owned.keyword() == "CONNECTORBEHAVIOR"
                && owned.value("NAME").is_some_and(|own| own.eq_ignore_ascii_case(name))
        };
        let of = |wanted: Option<u32>| {
            self.cards.iter().position(|owned| owned.instance == wanted && is_own(owned))
        };
        let Some(start) = of(instance).or_else(|| of(None)) else {
            self.report.remark("*CONNECTOR BEHAVIOR", Some(name), "not in the file");
            return behaviour;
        };
        let is_part =
            |owned: &Owned<'a>| ["CONNECTORELASTICITY", "CONNECTORDAMPING"].contains(&owned.keyword());
        let parts: Vec<Owned<'a>> = self.cards[start + 1..]
            .iter()
            .copied()
            .take_while(|owned| is_part(owned) || owned.keyword() == "ORIENTATION")
            .collect();
        for part in parts.into_iter().filter(|part| is_part(part)) {
            let component = part.value("COMPONENT").and_then(|component| component.parse::<u8>().ok());
            let value = part.first().and_then(real).filter(|value| *value > 0.0);
            let is_linear = !part.has("NONLINEAR") && !part.has("RIGID") && part.card.lines.len() == 1;
            let reason = match (value, component) {
                _ if !is_linear => "it is not linear",
                (_, component) if component.is_none() || component != kind.component() => {
                    "it is not in the coordinate of its joint"
                }
                (None, _) => "its value is not positive",
                (Some(value), _) => {
                    match part.keyword() {
                        "CONNECTORDAMPING" => behaviour.damping = Some(value),
                        _ => behaviour.stiffness = Some(value),
                    }
                    continue;
                }
            };
            self.leave_out(part, &[], reason);
        }
        behaviour
    }

    fn connector(&mut self, connector: Connector) {
        let Connector { lump, kind, ref card, behaviour, axes, ref name, ref of } = connector;
        let Some(nodes) = self.nodes_of(lump) else {
            return self.report.leave_out(card, "a node of it is not in the file", of.clone());
        };
        if let &[a, b] = &nodes[..] {
            let (card, of, name) = (card.clone(), of.clone(), name.clone());
            let Behaviour { stiffness, damping } = behaviour;
            match kind {
                Kind::Distance => {
                    let words = ["rigid link acts", "rigid links act"];
                    return self.rods.push(Rod { nodes: [a, b], card, called: of, words });
                }
                Kind::Line => {
                    return self.add_line(Line { nodes: [a, b], name, card, of, stiffness, damping });
                }
                _ => {}
            }
        }
        let made = self.joint(kind, &nodes, axes);
        match made {
            Ok((key, mut joint)) => {
                let name = self.name(Some(name), "joint");
                let mut table = vec![("name", text(&name)), (key, inner(std::mem::take(&mut joint)))];
                let spring = |stiffness| ("spring", inner(vec![("stiffness", Value::Float(stiffness))]));
                table.extend(behaviour.stiffness.map(spring));
                table.extend(behaviour.damping.map(|damping| ("damping", Value::Float(damping))));
                self.push(Entry {
                    name,
                    section: "joint",
                    card,
                    of,
                    words: ["joint acts", "joints act"],
                    table,
                });
            }
            Err(reason) => self.report.leave_out(card, reason, of.clone()),
        }
    }

    /// Key and table of a joint; with one node the other body is the ground.
    fn joint(
        &mut self,
        kind: Kind,
        nodes: &[u32],
        axes: Option<[Axes; 2]>,
    ) -> Result<(&'static str, Rows), &'static str> {
        let (a, b) = match *nodes {
            [a, b] => (Some(a), b),
            [b] if !matches!(kind, Kind::Distance | Kind::Line) => (None, b),
            _ => return Err("it has not two nodes"),
        };
        let of_frame = |node| self.frame_of.get(&node).is_some_and(|&frame| self.frames[frame].can_turn);
        let can_turn = |node: u32| of_frame(node) || self.is_ground(node);
        let turns = [a.is_none_or(can_turn), can_turn(b)];
        let points = [a.unwrap_or(b), b].map(|node| self.point(node));
        let mut kind = kind;
        // A node of a cell has no directions: a weld there keeps its place.
        if kind == Kind::Fixed && !(turns[0] && turns[1]) {
            kind = Kind::Spherical;
        }
        let needs = kind.needs_directions();
        if (0..2).any(|at| needs[at] && !turns[at]) {
            return Err("a node of it belongs to no coupling or rigid body, and has no directions");
        }
        let at = self.place(kind, points, turns)?;
        let ends = match a {
            Some(a) => {
                let [a, b] = self.ends([a, b])?;
                [b, a]
            }
            None => {
                let end = self.end(b).ok_or("one of its nodes belongs to no cell, coupling or mass")?;
                [end, "ground".to_string()]
            }
        };
        let mut joint =
            vec![("between", list(ends.iter().map(|end| text(end)).collect())), ("at", vector(at))];
        match (kind, axes) {
            (Kind::Universal, Some([first, second])) => {
                joint.push(("axes", list(vec![vector(second[2]), vector(first[0])])));
            }
            (_, Some([first, _])) if kind.needs_axes() => joint.push(("axis", vector(first[0]))),
            _ => {}
        }
        Ok((kind.key(), joint))
    }

    /// The place of a joint: node b, whose body may lie apart from node a; a node without directions is at its place.
    fn place(&self, kind: Kind, [a, b]: [Vector; 2], turns: [bool; 2]) -> Result<Vector, &'static str> {
        let is_one = distance(a, b) <= self.rounding * 1e-3;
        match (kind, turns) {
            (Kind::Spherical, [false, false]) if !is_one => Err("its nodes do not lie at one place"),
            (Kind::Spherical, [false, true]) => Ok(a),
            _ => Ok(b),
        }
    }
}
