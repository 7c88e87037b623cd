//! The rigid bodies and joints of a body.

use std::collections::BTreeMap;
use std::ops::Range as Rows;
use std::sync::Arc;

use super::attachments::Attachments;
use super::carrier::Carrier;
use super::component::Component;
use super::constraint::Constraint;
use super::constraint_step::ConstraintStep;
use super::constraints::Constraints;
use super::frame::{Frame, RigidMotion};
use super::joint::JointParts;
use super::joint_force::{self, JointLaw};
use super::joint_output::{JointOutput, JointState};
use super::range::Range;
use super::rank::Rank;
use crate::error::{Error, Result};
use crate::force::{Force, StepInput};
use crate::input::{Joint, JointEnd, JointKind, TimeFunction};
use crate::mesh::{Mesh, distance};
use crate::nodal;
use crate::number::short_vector;
use crate::sparse::Pattern;
use crate::tensor::cross;

/// Rigid bodies, joints, and the constraints of both.
#[derive(Debug, Default)]
pub(crate) struct Mechanism {
    pub frames: Vec<Frame>,
    pub joints: Vec<Joint>,
    pub constraints: Constraints,
    /// Of the directions of rigid bodies without mass.
    pub carriers: Vec<Carrier>,
    /// The components between the joints; none without joints.
    pub components: Vec<Component>,
    /// Whether joints or groups of rigid bodies have nodes of elastic parts.
    is_elastic: bool,
    outputs: Vec<JointOutput>,
}

/// How many ways a mechanism can move.
///
/// ```
/// use emmy::prelude::*;
/// let between = [JointEnd::Rigid("door".into()), JointEnd::Ground];
/// let hinge = Joint::new("hinge", JointKind::Revolute { axis: [0.0, 0.0, 1.0] }, between, [0.0; 3]);
/// let door = RigidBody::new("door", 20.0, [0.5, 0.0, 1.0], [7.0, 8.5, 2.0]);
/// let body = Body::builder(Mesh::without_cells()).rigid(door).joint(hinge).build()?;
/// let mobility = body.mobility();
/// assert_eq!((mobility.n_constraints, mobility.n_redundant, mobility.degrees_of_freedom), (5, 0, Some(1)));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Mobility {
    /// Number of rigid bodies, point masses included.
    pub n_bodies: usize,
    /// Number of joints.
    pub n_joints: usize,
    /// Number of the constraints of all joints, drives included.
    pub n_constraints: usize,
    /// Number of those that follow from the others where the mechanism is drawn.
    pub n_redundant: usize,
    /// Degrees of freedom where the mechanism is drawn, given motions included; `None` if joints or rigid bodies have
    /// nodes of elastic parts, which deform.
    pub degrees_of_freedom: Option<usize>,
    /// Number of these that have a given motion.
    pub n_driven: usize,
    /// Names of the joints whose constraints, some of them at least, follow from those of the joints before them, or
    /// whose given motion follows from the constraints of all.
    pub redundant: Vec<String>,
    /// Names of the joints whose single forces are not unique where the mechanism is drawn: a force in one of their
    /// constraints can be balanced by forces in the others.
    pub indeterminate: Vec<String>,
    /// Names of those of them whose given motion needs no unique torque or force, because it follows from the others.
    pub indeterminate_drives: Vec<String>,
}

impl Mechanism {
    /// The mechanism of some rigid bodies, whose nodes are in the mesh, and joints, of which some hold.
    ///
    /// # Errors
    /// [`Error::Joint`].
    pub(crate) fn new<'t>(
        frames: Vec<Frame>,
        joints: Vec<Joint>,
        mesh: &Mesh,
        leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]> + Copy,
        holds: impl Fn(&Joint) -> bool,
    ) -> Result<Self> {
        let attachments = Attachments { mesh, frames: &frames };
        let (mut rows, mut outputs) = (Vec::new(), Vec::new());
        for (number, joint) in joints.iter().enumerate() {
            let JointParts { constraints, points, measure, slide } =
                JointParts::new(joint, number, &attachments)?;
            let points = points.map(|point| point.on_leaders(leaders));
            if points[0].nodes.iter().any(|node| points[1].nodes.contains(node)) {
                let reason = "its two points are tied to each other".to_string();
                return Err(Error::Joint { joint: joint.name.clone(), reason });
            }
            if let Some(time) = joint.until.filter(|time| !time.is_finite()) {
                return Err(Error::NotFinite { what: "time of a release".into(), value: time });
            }
            let begin = rows.len();
            let constraints = constraints.into_iter().filter(|_| holds(joint));
            rows.extend(constraints.map(|row| row.on_leaders(leaders)));
            let [measure, slide] = [measure, slide].map(|own| own.map(|measure| measure.on_leaders(leaders)));
            let law = JointLaw::new(joint, number, measure.as_ref())?.filter(|_| holds(joint)).map(Arc::new);
            outputs.push(JointOutput::new(points, begin..rows.len(), [measure, slide], law));
        }
        rows.extend(frames.iter().flat_map(Frame::constraints));
        let held = || joints.iter().filter(|joint| holds(joint));
        let is_grounded = held().any(|joint| joint.between.contains(&JointEnd::Ground));
        let release = held().filter_map(|joint| joint.until).min_by(f64::total_cmp);
        let size = size_of(mesh, &joints);
        let of_laws = outputs.iter().filter_map(JointOutput::law).flat_map(|law| law.nodes()).copied();
        let constraints = Constraints::new(rows.into_iter(), of_laws, size, is_grounded, release);
        let moves = |node: u32| frames.iter().any(|frame| frame.moves(&[node], leaders));
        let has_elastic_node = |joint: &Joint| {
            joint.between.iter().any(|end| matches!(end, JointEnd::Node(node) if !moves(*node)))
        };
        // Where a rigid body has nodes of a mesh, elastic parts have some, too, unless all cells move as one.
        let is_in_part = |nodes: &[u32]| {
            nodes.iter().any(|&node| moves(node)) && !frames.iter().any(|frame| frame.moves(nodes, leaders))
        };
        let is_elastic = joints.iter().any(has_elastic_node)
            || frames.iter().any(Frame::has_members) && mesh.cells().any(|cell| is_in_part(cell.nodes));
        Ok(Mechanism {
            frames,
            joints,
            constraints,
            carriers: Vec::new(),
            components: Vec::new(),
            is_elastic,
            outputs,
        })
    }

    /// Whether a rigid body moves all nodes of a cell.
    pub(crate) fn moves<'t>(
        &self,
        nodes: &[u32],
        leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]> + Copy,
    ) -> bool {
        self.frames.iter().any(|frame| frame.moves(nodes, leaders))
    }

    /// Finds the directions of rigid bodies that a mass of each coupling leaves without mass. Returns the mass with
    /// their carriers, `None` if there are none.
    ///
    /// # Errors
    /// As [`Carrier::of`]; [`Error::Rigid`] for a rod that may spin about itself, which nothing determines.
    pub(crate) fn carry(&mut self, pattern: &Pattern, mass: &[f64]) -> Result<Option<Vec<f64>>> {
        for frame in &self.frames {
            let own = Carrier::of(frame, pattern, mass)?;
            if own.len() > 1 {
                self.check_rod(frame)?;
            }
            self.carriers.extend(own);
        }
        if self.carriers.is_empty() {
            return Ok(None);
        }
        let mut carried = mass.to_vec();
        self.carriers.iter().for_each(|carrier| carrier.add_to(pattern, &mut carried));
        Ok(Some(carried))
    }

    /// Checks that joints hold the spin of a rod about itself.
    fn check_rod(&self, rod: &Frame) -> Result<()> {
        let (axis, first) = (rod.rod_axis(), rod.nodes().start as usize);
        let spin = |dof: usize| match (dof / 3).checked_sub(first) {
            Some(end @ 1..4) => {
                let mut arm = [0.0; 3];
                arm[end - 1] = 1.0;
                cross(axis, arm)[dof % 3]
            }
            _ => 0.0,
        };
        let holds = |row: &Constraint| {
            let mut rate = 0.0;
            row.for_each_gradient(&|_| 0.0, &mut |dof, value| rate += value * spin(dof));
            rate.abs() > LEAST_RATE
        };
        if self.constraints.rows()[..self.n_constraints()].iter().any(holds) {
            return Ok(());
        }
        let reason = format!(
            "no joint holds its spin about {}, and it has no moment of inertia about that axis: give it a small one",
            short_vector(axis)
        );
        Err(Error::Rigid { body: rod.name().to_string(), reason })
    }

    /// The same with some of its joints.
    ///
    /// # Errors
    /// As [`Mechanism::new`].
    pub(crate) fn with_joints<'t>(
        &self,
        mesh: &Mesh,
        leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]> + Copy,
        holds: impl Fn(&Joint) -> bool,
    ) -> Result<Self> {
        let rest = Mechanism::new(self.frames.clone(), self.joints.clone(), mesh, leaders, holds)?;
        let components = if rest.n_constraints() > 0 { self.components.clone() } else { Vec::new() };
        Ok(Mechanism { carriers: self.carriers.clone(), components, ..rest })
    }

    /// Finds the components of n nodes between the joints; `of_cells`: lists of nodes that cells and ties connect.
    pub(crate) fn divide(&mut self, n: usize, of_cells: impl FnOnce() -> Vec<Vec<u32>>) {
        if self.n_constraints() > 0 {
            self.components = self.connected(n, &of_cells());
        }
    }

    /// The components of n nodes, given lists of nodes that cells and ties connect.
    pub(crate) fn connected(&self, n: usize, of_cells: &[Vec<u32>]) -> Vec<Component> {
        let of_frames: Vec<Vec<u32>> = self.frames.iter().map(|frame| frame.nodes().collect()).collect();
        Component::all(n, of_cells.iter().chain(&of_frames).map(Vec::as_slice))
    }

    /// The same with drives and motors of a time, in proportion to a load fraction that takes the place of time.
    ///
    /// # Errors
    /// As [`Mechanism::new`].
    pub(crate) fn in_proportion<'t>(
        &self,
        time: f64,
        mesh: &Mesh,
        leaders: impl Fn(u32) -> Option<&'t [(u32, f64)]> + Copy,
    ) -> Result<Self> {
        let grown = |law: &TimeFunction| TimeFunction::ramp(law.value_before(time));
        let joints = self.joints.iter().map(|joint| Joint {
            drive: joint.drive.as_ref().map(grown),
            motor: joint.motor.as_ref().map(grown),
            // A joint that was released by then stays so.
            until: joint.until.filter(|until| *until <= time),
            ..joint.clone()
        });
        let holds = |joint: &Joint| joint.until.is_none();
        let rest = Mechanism::new(self.frames.clone(), joints.collect(), mesh, leaders, holds)?;
        Ok(Mechanism { carriers: self.carriers.clone(), ..rest })
    }

    /// Whether a node is the end of an axis of a rigid body.
    pub(crate) fn is_end(&self, node: usize) -> bool {
        self.frame_of(node).is_some_and(|frame| frame.nodes().start as usize != node)
    }

    /// The frame to which a node belongs.
    fn frame_of(&self, node: usize) -> Option<&Frame> {
        let after = self.frames.partition_point(|frame| frame.nodes().start as usize <= node);
        let last = after.checked_sub(1).map(|own| &self.frames[own]);
        last.filter(|frame| frame.nodes().contains(&(node as u32)))
    }

    /// Name of the rigid body to whose frame a node belongs.
    pub(crate) fn name_at(&self, node: usize) -> Option<&str> {
        self.frame_of(node).map(Frame::name)
    }

    /// Whether a node belongs to the frame of a rigid body.
    pub(crate) fn is_rigid(&self, node: usize) -> bool {
        self.frame_of(node).is_some()
    }

    /// Whether it has neither rigid bodies nor joints.
    pub(crate) fn is_empty(&self) -> bool {
        self.frames.is_empty() && self.joints.is_empty()
    }

    /// Whether a node is one of a rigid body without nodes of a mesh.
    pub(crate) fn is_free_of_mesh(&self, node: usize) -> bool {
        self.frame_of(node).is_some_and(|frame| !frame.has_members())
    }

    /// The nodes that each rigid body and each joint with a force couples.
    pub(crate) fn coupled_nodes(&self) -> impl Iterator<Item = Vec<u32>> {
        let of_joints = self.outputs.iter().filter_map(|output| Some(output.law()?.nodes().to_vec()));
        self.frames.iter().map(|frame| frame.nodes().collect()).chain(of_joints)
    }

    /// The springs, dampers and motors of the joints.
    pub(crate) fn forces(&self, pattern: &Pattern) -> Vec<Arc<dyn Force>> {
        let joints = self.joints.iter().zip(&self.outputs);
        let laws = joints
            .filter_map(|(joint, output)| Some((output.law()?, joint.between.contains(&JointEnd::Ground))));
        laws.flat_map(|(law, is_grounded)| joint_force::forces(law, is_grounded, pattern)).collect()
    }

    /// The laws of the joints with a spring, a damper or a motor.
    pub(crate) fn laws(&self) -> impl Iterator<Item = &Arc<JointLaw>> {
        self.outputs.iter().filter_map(JointOutput::law)
    }

    /// The laws of the joints with a spring.
    pub(crate) fn springs(&self) -> impl Iterator<Item = &Arc<JointLaw>> {
        self.laws().filter(|law| law.has_spring())
    }

    /// Sets the forces of the joints in a solved step or an equilibrium; multipliers times the factor are forces.
    pub(crate) fn set_states(
        &self,
        step: (&StepInput<'_>, &ConstraintStep),
        multipliers: (f64, &[f64]),
        points: &[[f64; 3]],
        states: &mut [JointState],
    ) {
        for (output, state) in self.outputs.iter().zip(states) {
            *state = output.state(&self.constraints, step, multipliers, points);
        }
    }

    /// The functions of time of the joints that hold, each with the number of its joint and the displacement per unit,
    /// 0 of a motor.
    pub(crate) fn time_functions(&self) -> impl Iterator<Item = (usize, &TimeFunction, f64)> {
        self.joints.iter().zip(&self.outputs).enumerate().flat_map(|(number, (joint, output))| {
            let arm = if joint.kind.coordinate() == Some("angle") { self.constraints.size() } else { 1.0 };
            let drive = joint.drive.iter().filter(|_| output.n_rows() > 0);
            let motor = joint.motor.iter().filter(|_| output.law().is_some());
            drive.map(move |law| (number, law, arm)).chain(motor.map(move |law| (number, law, 0.0)))
        })
    }

    /// Whether drives, motors or strained springs act at a time on the bodies as drawn.
    pub(crate) fn acts_at(&self, time: f64) -> bool {
        let mut laws = self.time_functions();
        laws.any(|(_, law, _)| law.value(time) != 0.0) || self.springs().any(|law| law.is_strained())
    }

    /// Coordinates of the joints at displacements, angles within half a turn.
    pub(crate) fn coordinates(&self, displacement: &[f64]) -> Vec<f64> {
        let u = |dof: usize| displacement[dof];
        self.outputs.iter().map(|output| output.coordinate(&u, 0.0)).collect()
    }

    /// Sets coordinates to those at displacements if they are not those of its joints.
    pub(crate) fn fit_coordinates(&self, displacement: &[f64], coordinates: &mut Vec<f64>) {
        if coordinates.len() != self.outputs.len() {
            *coordinates = self.coordinates(displacement);
        }
    }

    /// Takes the coordinates of the joints from the start of a solved step to its end.
    pub(crate) fn count_on(&self, step: (&StepInput<'_>, &ConstraintStep), coordinates: &mut [f64]) {
        let joints = self.outputs.iter().zip(coordinates);
        joints.for_each(|(output, coordinate)| *coordinate = output.counted_on(step, *coordinate));
    }

    /// Sets the coordinates in the states of the joints at some displacements, to which `coordinates` belong.
    pub(crate) fn set_coordinates(
        &self,
        u: &dyn Fn(usize) -> f64,
        coordinates: &[f64],
        states: &mut [JointState],
    ) {
        let joints = self.outputs.iter().zip(coordinates).zip(states);
        joints.for_each(|((output, coordinate), state)| output.set_coordinates(u, *coordinate, state));
    }

    /// Position and motion of the rigid bodies.
    pub(crate) fn motions(&self, u: &dyn Fn(usize) -> f64, v: &dyn Fn(usize) -> f64) -> Vec<RigidMotion> {
        self.frames.iter().map(|frame| frame.motion(u, v)).collect()
    }

    /// Number of the constraints of all joints.
    pub(crate) fn n_constraints(&self) -> usize {
        self.outputs.iter().map(JointOutput::n_rows).sum()
    }

    /// How many ways it can move, where `is_held` are the degrees of freedom that supports hold.
    pub(crate) fn mobility(&self, is_held: &[bool]) -> Mobility {
        let rows = self.constraints.rows();
        let n_of_joints = self.n_constraints();
        let mut rank = Rank::default();
        let mut add = |row: &Constraint| {
            let mut gradient = BTreeMap::new();
            row.for_each_gradient(&|_| 0.0, &mut |dof, value| {
                if !is_held[dof] {
                    *gradient.entry(dof).or_insert(0.0) += value;
                }
            });
            rank.add(gradient)
        };
        // The constraints of the frames come first: those of joints follow from them, not the other way round. Given
        // motions come last.
        let n_of_frames = rows[n_of_joints..].iter().filter(|row| add(row)).count();
        let mut n_dependent = vec![0; self.joints.len()];
        let mut n_new = [0; 2];
        for (pass, is_driven) in [false, true].into_iter().enumerate() {
            for (output, n_dependent) in self.outputs.iter().zip(&mut n_dependent) {
                for row in rows[output.rows()].iter().filter(|row| row.drive.is_some() == is_driven) {
                    let is_new = add(row);
                    n_new[pass] += usize::from(is_new);
                    *n_dependent += usize::from(!is_new);
                }
            }
        }
        let redundant: Vec<String> = self
            .joints
            .iter()
            .zip(&n_dependent)
            .filter(|(_, n)| **n > 0)
            .map(|(joint, _)| joint.name.clone())
            .collect();
        let [indeterminate, indeterminate_drives] =
            if redundant.is_empty() { Default::default() } else { self.indeterminate(is_held) };
        let [n_free, n_driven] = n_new;
        let free = |frame: &Frame| {
            frame.nodes().flat_map(|node| nodal::dofs(node as usize)).filter(|&dof| !is_held[dof]).count()
        };
        let dofs: usize = self.frames.iter().map(free).sum();
        Mobility {
            n_bodies: self.frames.len(),
            n_joints: self.joints.len(),
            n_constraints: n_of_joints,
            n_redundant: n_dependent.iter().sum(),
            degrees_of_freedom: (!self.is_elastic).then(|| dofs - n_of_frames - n_free),
            n_driven,
            redundant,
            indeterminate,
            indeterminate_drives,
        }
    }

    /// Names of the joints with constraints whose forces can balance each other where they are drawn, and of those of
    /// them whose drive can take part in that.
    fn indeterminate(&self, is_held: &[bool]) -> [Vec<String>; 2] {
        let rows = self.constraints.rows();
        let mut range = Range::new(&self.constraints);
        range.set(&self.constraints, rows.iter(), is_held, &|_| 0.0);
        let mut part = vec![0.0f64; rows.len()];
        for z in range.complement() {
            part.iter_mut().zip(z).for_each(|(part, z)| *part = part.max(z.abs()));
        }
        let names = |takes_part: &dyn Fn(usize) -> bool| {
            let joints = self.joints.iter().zip(&self.outputs);
            joints
                .filter(|(_, output)| output.rows().any(takes_part))
                .map(|(joint, _)| joint.name.clone())
                .collect()
        };
        let takes_part = |c: usize| part[c] > LEAST_PART;
        [names(&takes_part), names(&|c| takes_part(c) && rows[c].drive.is_some())]
    }

    /// Names of the joints with constraints that are far from zero, and of those of them whose given motion is; without
    /// joints, of rigid bodies. `residuals` are those of all constraints.
    pub(crate) fn open(&self, residuals: &[f64]) -> [Vec<String>; 2] {
        let largest_of =
            |rows: Rows<usize>| residuals[rows].iter().fold(0.0f64, |most, own| most.max(own.abs()));
        let largest = largest_of(0..residuals.len());
        let is_open = |rows: Rows<usize>| largest_of(rows) > PART_OF_LARGEST * largest;
        let joints = self.joints.iter().zip(&self.outputs);
        let names = |which: &dyn Fn(&JointOutput) -> bool| -> Vec<String> {
            joints.clone().filter(|(_, output)| which(output)).map(|(joint, _)| joint.name.clone()).collect()
        };
        let mut open = names(&|output| is_open(output.rows()));
        if open.is_empty() {
            let mut end = self.n_constraints();
            let strained = self.frames.iter().filter(|frame| {
                let begin = end;
                end += frame.constraints().len();
                is_open(begin..end)
            });
            open = strained.map(|frame| frame.name().to_string()).collect();
        }
        let is_driven = |c: usize| self.constraints.rows()[c].drive.is_some();
        let takes_part = |c: usize| is_driven(c) && residuals[c].abs() > LEAST_OPENING * largest;
        [open, names(&|output| output.rows().any(takes_part))]
    }
}

/// Part of a constraint in forces that balance each other, over all of them, that is rounding.
const LEAST_PART: f64 = 1e-6;

/// Residual of a constraint over the largest one with which it is named.
const PART_OF_LARGEST: f64 = 0.5;

/// Residual of a given motion over the largest one with which it takes part in a contradiction.
const LEAST_OPENING: f64 = 1e-3;

/// Rate of a constraint of unit gradient in the spin of a rod that is rounding.
const LEAST_RATE: f64 = 1e-6;

/// The diagonal of a box around the nodes and the places of the joints.
fn size_of(mesh: &Mesh, joints: &[Joint]) -> f64 {
    let places = joints.iter().flat_map(|joint| match joint.kind {
        JointKind::Distance { to } | JointKind::Line { to } => [joint.at, to],
        _ => [joint.at; 2],
    });
    let bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [least, most] = mesh.points().iter().copied().chain(places).fold(bounds, |[least, most], X| {
        [[0, 1, 2].map(|d| X[d].min(least[d])), [0, 1, 2].map(|d| X[d].max(most[d]))]
    });
    distance(least, most)
}
