//! `*TIE`: surfaces that are tied.

use super::find::Surface;
use super::{Entry, Maker, Owned, text};

/// Parameters of ties that are of another kind.
const OTHERS: [&str; 4] = ["CYCLICSYMMETRY", "MULTISTAGE", "FLUIDPERIODIC", "TIEDNSET"];

impl<'a> Maker<'a, '_> {
    pub(super) fn ties(&mut self) {
        for owned in self.cards_of(&["TIE"]) {
            if let Some(other) = OTHERS.iter().find(|key| owned.has(key)) {
                let reason = match *other {
                    "TIEDNSET" => "only some of its nodes are tied (TIED NSET)",
                    _ => "a tie of another kind (symmetry or a fluid)",
                };
                self.leave_out(owned, &["NAME"], reason);
                continue;
            }
            let lines: Vec<&[String]> =
                owned.card.lines.iter().map(|(_, fields)| fields.as_slice()).collect();
            let pairs = lines.into_iter().filter(|fields| fields.iter().any(|field| !field.is_empty()));
            let pairs: Vec<&[String]> = pairs.collect();
            if pairs.is_empty() {
                self.leave_out(owned, &["NAME"], "it names no surfaces");
            }
            for fields in pairs {
                self.tie(owned, fields);
            }
        }
    }

    fn tie(&mut self, owned: Owned<'a>, fields: &'a [String]) {
        let (Some(follower), Some(leader)) = (fields.first(), fields.get(1)) else {
            return self.leave_out(owned, &["NAME"], "it names one surface alone");
        };
        let surface = |name: &str| self.surface(owned.instance, name);
        let (Some(own), Some(other)) = (surface(follower), surface(leader)) else {
            return self.leave_out(owned, &["NAME"], "a surface is not in the file");
        };
        let has_cells = |surface: &Surface| surface.nodes.iter().any(|&node| self.is_of_cells(node));
        if !has_cells(&own) || !has_cells(&other) {
            return self.leave_out(owned, &["NAME"], "a surface has no nodes of cells");
        }
        let called = self.called(owned, &["NAME"]);
        let name = self.name(owned.value("NAME"), "tie");
        let is_of_nodes = owned.value("TYPE").is_some_and(|own| own.to_ascii_uppercase().starts_with("NODE"));
        let kind = (is_of_nodes || !own.is_of_facets()).then(|| ("kind", text("nodes")));
        let follower = self.group_of_surface(own, &format!("{name}-nodes"));
        let leader = self.group_of_surface(other, &format!("{name}-leaders"));
        if follower == leader {
            return self.report.leave_out("*TIE", "the surface is tied to itself", called);
        }
        if owned.has("POSITIONTOLERANCE") {
            let text = "POSITION TOLERANCE is not read: `tolerance` is relative to the edges of the leader, here 0.05";
            self.report.remark("*TIE", None, text);
        }
        // As in Abaqus, nodes that are far from the other surface are not tied.
        let partial = toml::Value::Boolean(true);
        let mut table = vec![("follower", text(&follower)), ("leader", text(&leader)), ("partial", partial)];
        table.extend(kind);
        let words = ["tie acts", "ties act"];
        self.push(Entry { name, section: "tie", card: "*TIE", of: &called, words, table });
    }

    /// The group of a surface; a new one if it has none in the input.
    fn group_of_surface(&mut self, surface: Surface, name: &str) -> String {
        let Surface { group, facets, nodes, .. } = surface;
        if let Some(group) = group {
            return group;
        }
        if facets.is_empty() {
            return self.group(name, nodes);
        }
        let name = self.names.free(name, &self.assembly.group_names);
        self.assembly.facet_group(&name, facets);
        name
    }
}
