//! The lines of `emmy check` on rigid bodies and joints.

use emmy::body::{Body, Joint, JointEnd, JointKind, RegionSummary};
use emmy_io::input::Problem;
use emmy_io::message::counted;

use super::Report;
use super::report::summary;
use crate::print::vector;

/// Largest number of joints that are named.
const MAX_NAMED: usize = 8;

impl Report {
    /// A rigid body or a point mass, or all of them, under a word and a name.
    pub(super) fn rigid_body(&mut self, [word, name]: [&str; 2], of: &RegionSummary, is_point: bool) {
        let mass = self.units.number(of.mass, "mass");
        let centre = self.units.vector(of.centre, "length");
        let what = if is_point { "point mass" } else { "mass" };
        self.line(word, &format!("{name}: {what} {mass}, centre {centre}"));
        if !is_point {
            self.inertia(of);
        }
    }

    /// A rigid body with nodes of the mesh; `added`: the mass in addition.
    pub(super) fn rigid_group(
        &mut self,
        body: &Body,
        [name, group]: [&str; 2],
        added: &RegionSummary,
        is_point: bool,
    ) {
        let members = body.mesh().group_nodes(group).unwrap_or_default();
        let nodes = counted(members.len(), "node", "nodes");
        let centre = self.units.vector(added.centre, "length");
        self.line("rigid", &format!("{name}: {nodes} of `{group}` with their masses, centre {centre}"));
        if added.mass > 0.0 {
            let mass = self.units.number(added.mass, "mass");
            self.line("", &format!("mass {mass} at the centre in addition"));
            if !is_point {
                self.inertia(added);
            }
        }
    }

    /// Joints, and how many ways the bodies can move.
    pub(super) fn mechanism(&mut self, problem: &Problem) {
        problem.joints.iter().for_each(|joint| self.joint(joint, &problem.body));
        if problem.rigid.is_empty() && problem.joints.is_empty() {
            return;
        }
        let mobility = problem.body.mobility();
        let bodies = counted(mobility.n_bodies, "rigid body", "rigid bodies");
        let joints = counted(mobility.n_joints, "joint", "joints");
        let constraints = counted(mobility.n_constraints, "constraint", "constraints");
        let free = mobility.degrees_of_freedom.map_or("elastic parts are joined".to_string(), |n| {
            let all = counted(n, "degree of freedom", "degrees of freedom");
            match mobility.n_driven {
                0 => all,
                1 if n == 1 => format!("{all}, which is driven"),
                1 => format!("{all}, of which 1 is driven"),
                driven => format!("{all}, of which {driven} are driven"),
            }
        });
        self.line("mechanism", &format!("{bodies}, {joints} with {constraints}; {free}"));
        if mobility.n_redundant > 0 {
            let (n, all) = (mobility.n_redundant, mobility.n_constraints);
            let follow = if n == 1 { "follows" } else { "follow" };
            let text = format!(
                "{n} of {constraints} {follow} from the others: the motion is unique, their single forces are not",
                constraints = counted(all, "constraint", "constraints")
            );
            self.line("", &text);
            let names = &mobility.redundant;
            let mut listed = names[..names.len().min(MAX_NAMED)].join(", ");
            if names.len() > MAX_NAMED {
                listed += &format!(" and {} more", names.len() - MAX_NAMED);
            }
            let which = if names.len() == 1 { "the joint" } else { "the joints" };
            let they = if n == 1 { "it is a constraint" } else { "they are constraints" };
            self.line("", &format!("{they} of {which} {listed}"));
        }
    }

    fn joint(&mut self, joint: &Joint, body: &Body) {
        let end = |end: &JointEnd| match end {
            JointEnd::Ground => "the ground".to_string(),
            JointEnd::Node(node) => {
                let at = self.units.vector(body.mesh().points()[*node as usize], "length");
                format!("node {node} at {at}")
            }
            JointEnd::Rigid(name) => name.clone(),
        };
        let [first, second] = joint.between.each_ref().map(end);
        let at = self.units.vector(joint.at, "length");
        let place = match joint.kind {
            JointKind::Spherical | JointKind::Fixed => format!("at {at}"),
            JointKind::Revolute { axis }
            | JointKind::Cylindrical { axis }
            | JointKind::Prismatic { axis }
            | JointKind::Inline { axis }
            | JointKind::Planar { axis } => format!("at {at}, axis {}", vector(axis)),
            JointKind::Universal { axes: [a, b] } => format!("at {at}, axes {} and {}", vector(a), vector(b)),
            JointKind::Distance { to } | JointKind::Line { to } => {
                let length = (0..3).map(|i| (joint.at[i] - to[i]).powi(2)).sum::<f64>().sqrt();
                let to = self.units.vector(to, "length");
                format!("from {at} to {to}, length {}", self.units.number(length, "length"))
            }
        };
        let (name, kind) = (&joint.name, joint.kind.word());
        self.line("joint", &format!("{name}: {kind}, {first} and {second}, {place}"));
        if let (Some(drive), Some(coordinate)) = (&joint.drive, joint.kind.coordinate()) {
            let dimension = if coordinate == "angle" { "" } else { "length" };
            let change = if coordinate == "distance" { "change of the distance" } else { coordinate };
            self.line("", &format!("{change}: {}", summary(drive, self.units, dimension)));
        }
        self.forces(joint);
        if let Some(time) = joint.until {
            self.line("", &format!("released at t = {}", self.units.number(time, "time")));
        }
    }

    /// Spring, damping and motor of a joint.
    fn forces(&mut self, joint: &Joint) {
        let is_angle = joint.kind.coordinate() == Some("angle");
        let [stiffness, damping, rest, motor] = match is_angle {
            true => ["force·length", "force·length·time", "", "force·length"],
            false => ["force/length", "force·time/length", "length", "force"],
        };
        if let Some(spring) = &joint.spring {
            let stiffness = self.units.number(spring.stiffness, stiffness);
            let rest = spring.rest.map_or("as drawn".to_string(), |own| self.units.number(own, rest));
            self.line("", &format!("spring: stiffness {stiffness}, rest {rest}"));
        }
        if joint.damping > 0.0 {
            self.line("", &format!("damping {}", self.units.number(joint.damping, damping)));
        }
        if let Some(own) = &joint.motor {
            let what = if is_angle { "torque" } else { "force" };
            self.line("", &format!("{what}: {}", summary(own, self.units, motor)));
        }
    }
}
