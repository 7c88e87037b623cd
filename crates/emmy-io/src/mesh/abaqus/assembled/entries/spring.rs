//! Springs and dampers: `*SPRING` and `*DASHPOT` with their elements.

use std::collections::BTreeMap;

use super::find::{Lump, real};
use super::line::Line;
use super::{Entry, Maker, Owned, text};
use crate::vector::{minus, norm};

/// Springs of a node to the ground.
#[derive(Debug, Default)]
struct Grounded {
    /// Along x, y and z.
    stiffness: [f64; 3],
    lumps: Vec<Lump>,
    set: String,
}

/// Data of a card.
#[derive(Debug, Clone, Copy)]
struct Constant {
    /// Stiffness or damping.
    value: f64,
    /// Components at the two ends, if it has them.
    dofs: [Option<usize>; 2],
}

const ALONG: &str = "it does not act along the line between its nodes";

impl<'a> Maker<'a, '_> {
    /// Reads springs and dampers: supports, and lines for joints.
    pub(super) fn springs(&mut self) {
        let mut grounded = BTreeMap::<u32, Grounded>::new();
        for owned in self.cards_of(&["SPRING", "DASHPOT"]) {
            let lumps = self.lumps_of_card(owned, owned.keyword());
            for lump in lumps {
                let element_type = self.type_of(lump);
                let is_axial = element_type.ends_with('A');
                let constant = match constant(owned, is_axial) {
                    Ok(constant) => constant,
                    Err(reason) => {
                        self.leave_out_lump(lump, reason);
                        continue;
                    }
                };
                let Some(nodes) = self.nodes_of(lump) else {
                    self.leave_out_lump(lump, "a node of it is not in the file");
                    continue;
                };
                match (nodes[..].as_ref(), element_type) {
                    (&[node, ..], "SPRING1") => self.ground(owned, lump, node, constant, &mut grounded),
                    (_, "DASHPOT1") => self.leave_out_lump(lump, "it is a damper to the ground"),
                    (&[a, b], _) => self.line_of_lump(owned, lump, [a, b], constant),
                    _ => self.leave_out_lump(lump, "it has not two nodes"),
                }
            }
        }
        self.supports(grounded);
    }

    fn line_of_lump(&mut self, owned: Owned<'a>, lump: Lump, nodes: [u32; 2], constant: Constant) {
        if !self.type_of(lump).ends_with('A') {
            let along = match constant.dofs {
                [Some(a), Some(b)] if a == b && a < 3 => Some(a),
                _ => None,
            };
            let [a, b] = nodes.map(|node| self.point(node));
            let line = minus(b, a);
            let is_along = |axis: usize| line[axis].abs() >= (1.0 - 1e-9) * norm(line) && norm(line) > 0.0;
            if !along.is_some_and(is_along) {
                return self.leave_out_lump(lump, ALONG);
            }
        }
        if !self.tell(lump) {
            return;
        }
        let set = owned.value("ELSET").unwrap_or_default();
        let number = self.number_of(lump);
        let value = Some(constant.value);
        let is_spring = owned.keyword() == "SPRING";
        self.add_line(Line {
            nodes,
            name: format!("{set}-{number}"),
            card: owned.title().to_string(),
            of: format!("element {number}"),
            stiffness: value.filter(|_| is_spring),
            damping: value.filter(|_| !is_spring),
        });
    }

    fn ground(
        &mut self,
        owned: Owned<'a>,
        lump: Lump,
        node: u32,
        constant: Constant,
        grounded: &mut BTreeMap<u32, Grounded>,
    ) {
        let Some(dof) = constant.dofs[0].filter(|dof| *dof < 3) else {
            return self.leave_out_lump(lump, "it is not a spring along x, y or z");
        };
        if !self.tell(lump) {
            return;
        }
        let own = grounded.entry(node).or_default();
        own.stiffness[dof] += constant.value;
        own.lumps.push(lump);
        if own.set.is_empty() {
            own.set = owned.value("ELSET").unwrap_or_default().to_string();
        }
    }

    /// Adds the springs to the ground that are alike in all directions, those of one stiffness in one entry.
    fn supports(&mut self, grounded: BTreeMap<u32, Grounded>) {
        const WORDS: [&str; 2] = ["spring to the ground acts", "springs to the ground act"];
        let mut alike = BTreeMap::<(String, u64), Vec<u32>>::new();
        for (node, own) in grounded {
            let [x, y, z] = own.stiffness;
            let same = |a: f64, b: f64| (a - b).abs() <= 1e-12 * a.abs();
            let is_alike = x > 0.0 && same(x, y) && (self.assembly.is_plane || same(x, z));
            let is_at_point =
                || self.frame_of.get(&node).is_some_and(|&at| self.frames[at].reference == Some(node));
            let reason = if !is_alike {
                "springs to the ground that are not alike in x, y and z"
            } else if self.is_of_cells(node) {
                alike.entry((own.set, x.to_bits())).or_default().push(node);
                continue;
            } else if is_at_point() {
                let frame = &self.frames[self.frame_of[&node]];
                let (group, which) = (frame.name.clone(), self.number_of(own.lumps[0]));
                let name = self.name(Some(&format!("{group}-spring")), "spring");
                let table = vec![("group", text(&group)), ("spring", toml::Value::Float(x))];
                let of = format!("of element {which}");
                self.push(Entry { name, section: "support", card: "*SPRING", of: &of, words: WORDS, table });
                continue;
            } else {
                "its node belongs to no cell, coupling or mass"
            };
            for lump in own.lumps {
                let which = format!("element {}", self.number_of(lump));
                self.report.leave_out(self.type_of(lump), reason, which);
            }
        }
        for ((set, bits), nodes) in alike {
            let name = self.name(Some(&format!("spring-{set}")), "spring");
            let group = self.group(&format!("{name}-nodes"), nodes);
            let table = vec![("group", text(&group)), ("spring", toml::Value::Float(f64::from_bits(bits)))];
            self.push(Entry { name, section: "support", card: "*SPRING", of: &set, words: WORDS, table });
        }
    }
}

/// The data of a spring or damper. The components stand in a line of their own before the value; elements along a line
/// have none there.
fn constant(owned: Owned<'_>, is_axial: bool) -> Result<Constant, &'static str> {
    if owned.has("NONLINEAR") {
        return Err("it is not linear");
    }
    if owned.has("ORIENTATION") {
        return Err("its directions are not read (ORIENTATION)");
    }
    let has_data = |fields: &&[String]| fields.iter().any(|field| !field.is_empty());
    let lines = owned.card.lines.iter().map(|(_, fields)| fields.as_slice()).filter(has_data);
    let lines: Vec<&[String]> = lines.collect();
    let component = |at: usize| -> Option<usize> {
        let dof: usize = lines.first()?.get(at)?.parse().ok()?;
        (1..=6).contains(&dof).then(|| dof - 1)
    };
    let is_first = match lines[..] {
        // A component that an element along a line does not need.
        [[only], [_]] if is_axial => only.parse::<u8>().is_ok_and(|dof| dof <= 6),
        _ => !is_axial,
    };
    let dofs = if is_axial { [None; 2] } else { [component(0), component(1)] };
    let values =
        lines.iter().skip(usize::from(is_first)).map(|fields| fields.first().and_then(|field| real(field)));
    let values: Option<Vec<f64>> = values.collect();
    match values.as_deref() {
        Some([first, rest @ ..]) if rest.iter().all(|value| value == first) => {
            Ok(Constant { value: *first, dofs })
        }
        Some([_, ..]) => Err("its data depend on a temperature, a frequency or a field"),
        _ => Err("its data are not numbers"),
    }
}
