//! Rigid bodies, couplings and joints together: their names, and the bodies that joints are between.

use emmy::body::{Body, Coupling, InitialVelocity, Joint, JointEnd, Load, LoadKind, Mobility, RigidBody};
use emmy::internals::number::short_vector;
use emmy::mesh::Mesh;
use emmy::time::Scheme;

use super::coupling::{self, PlacedCoupling};
use super::fault::{Fault, Faults, Place};
use super::joint::{self, PlacedJoint};
use super::placed::NamedGroup;
use super::placed::{Members, Placed};
use super::rigid::{self, GROUND, PlacedRigid};
use super::suggest::{did_you_mean, listed};
use super::time::Time;
use crate::message::counted;
use crate::units::Units;

/// The rigid bodies, couplings and joints of an input.
#[derive(Debug, Default)]
pub(super) struct Mechanism {
    pub(super) rigid: Vec<PlacedRigid>,
    /// Distributing couplings.
    pub(super) couplings: Vec<PlacedCoupling>,
    pub(super) joints: Vec<PlacedJoint>,
}

/// A name: what has it, the name and its place.
type Named<'a> = (&'static str, &'a str, &'a Place);

impl Mechanism {
    /// Names of the rigid bodies and couplings.
    pub(super) fn bodies(&self) -> Vec<&str> {
        let couplings = self.couplings.iter().map(|own| own.coupling.name.as_str());
        self.rigid.iter().map(|own| own.body.name.as_str()).chain(couplings).collect()
    }

    /// Adds mass and inertia to the rigid body that has a name.
    pub(super) fn add_mass(
        &mut self,
        name: &str,
        (mass, inertia): (f64, [[f64; 3]; 3]),
        place: &Place,
    ) -> Result<(), Fault> {
        let Some(own) = self.rigid.iter_mut().find(|own| own.body.name == name) else {
            let is_coupling = self.couplings.iter().any(|own| own.coupling.name == name);
            let (message, help) = match is_coupling {
                true => (
                    format!(
                        "`{name}` is a distributing coupling, which has no rotation, so `inertia` has no effect"
                    ),
                    "take kind = \"rigid\" there, or leave `inertia` out",
                ),
                false => (
                    format!("`inertia` turns with a rigid body, and `{name}` is none"),
                    "give the mass a place, `at`, to couple it to the group, or name a rigid body",
                ),
            };
            return Err(Fault::at(place, message, "with an `inertia`").help(help));
        };
        own.body.mass += mass;
        let sum = own.body.inertia.get_or_insert([[0.0; 3]; 3]);
        for (row, other) in sum.iter_mut().zip(inertia) {
            row.iter_mut().zip(other).for_each(|(sum, own)| *sum += own);
        }
        Ok(())
    }

    /// Names of the joints.
    pub(super) fn names_of_joints(&self) -> Vec<&str> {
        self.joints.iter().map(|own| own.name.as_str()).collect()
    }

    /// The place of the name of a rigid body or joint.
    pub(super) fn place(&self, name: &str) -> Option<Place> {
        let bodies = self.rigid.iter().map(|own| (&own.body.name, &own.name));
        let couplings = self.couplings.iter().map(|own| (&own.coupling.name, &own.name));
        let joints = self.joints.iter().map(|own| (&own.name, &own.name_place));
        bodies.chain(couplings).chain(joints).find(|(own, _)| *own == name).map(|(_, place)| place.clone())
    }

    /// Places of the rigid bodies, and whether they have a mass of their own.
    pub(super) fn places(&self) -> impl Iterator<Item = (&Place, bool)> {
        self.rigid.iter().map(|own| (&own.place, own.body.mass > 0.0))
    }

    /// The groups of the mesh that are rigid bodies, or that points follow.
    pub(super) fn groups(&self) -> impl Iterator<Item = NamedGroup> {
        let couplings = self.couplings.iter().map(PlacedCoupling::group);
        self.rigid.iter().filter_map(PlacedRigid::group).chain(couplings)
    }

    /// Names of these groups.
    pub(super) fn names_of_groups(&self) -> impl Iterator<Item = &str> {
        let couplings = self.couplings.iter().map(|own| own.coupling.group.as_str());
        self.rigid.iter().filter_map(|own| own.body.group.as_deref()).chain(couplings)
    }

    /// Whether a joint may move bodies from the start: by a drive, a motor, or a spring that is not as drawn.
    pub(super) fn is_driven(&self) -> bool {
        self.joints.iter().any(|joint| {
            let is_wound = joint.forces.spring.is_some_and(|spring| spring.rest.is_some());
            joint.drive.is_some() || joint.forces.motor.is_some() || is_wound
        })
    }

    /// Checks that no name of a rigid body or joint is given twice; `others` are names of other columns.
    pub(super) fn check_names<'a>(&'a self, others: impl Iterator<Item = Named<'a>>, faults: &mut Faults) {
        let bodies = self.rigid.iter().map(|own| ("rigid body", own.body.name.as_str(), &own.name));
        let couplings = self.couplings.iter().map(|own| ("coupling", own.coupling.name.as_str(), &own.name));
        let joints = self.joints.iter().map(|own| ("joint", own.name.as_str(), &own.name_place));
        let own: Vec<Named<'_>> = bodies.chain(couplings).chain(joints).collect();
        let with_earlier = own.iter().enumerate().map(|(i, named)| (*named, &own[..i]));
        for ((what, name, place), earlier) in with_earlier.chain(others.map(|other| (other, &own[..]))) {
            let Some((first, _, before)) = earlier.iter().find(|(_, other, _)| *other == name) else {
                continue;
            };
            let message = match (*first, what) {
                ("rigid body", "rigid body") => format!("two rigid bodies are named `{name}`"),
                ("joint", "joint") => format!("two joints are named `{name}`"),
                ("coupling", "coupling") => format!("two couplings are named `{name}`"),
                _ => format!("a {first} and a {what} are named `{name}`"),
            };
            faults.push(Fault::at(place, message, "second").label(before, "first"));
        }
    }

    /// Checks that the scheme has multipliers.
    pub(super) fn check_scheme(&self, time: &Time) -> Result<(), Fault> {
        if time.scheme.is_time_element() || time.scheme == Scheme::Static {
            return Ok(());
        }
        let Some((place, label)) = self.first() else { return Ok(()) };
        let message = format!("the scheme {} has no joints, which need a time element", time.scheme.name());
        Err(Fault::at(place, message, label).help("such as scheme = \"DGM\"; ties work with every scheme"))
    }

    /// The first table, and what it is.
    fn first(&self) -> Option<(&Place, &'static str)> {
        let joint = self.joints.first().map(|joint| (&joint.place, "this joint"));
        joint.or_else(|| self.rigid.first().map(|own| (&own.place, "this rigid body")))
    }

    /// Checks that one process computes the body.
    pub(super) fn check_alone(&self) -> Result<(), Fault> {
        let coupling = self.couplings.first().map(|own| (&own.place, "this coupling"));
        match self.first().or(coupling) {
            Some((place, label)) => {
                let message = "several ranks do not compute a body with couplings, rigid bodies or joints";
                Err(Fault::at(place, message, label).help("take threads: `--threads`"))
            }
            None => Ok(()),
        }
    }

    /// Checks names against the groups of the mesh, and the bodies of all joints.
    pub(super) fn check(&self, mesh: &Mesh, faults: &mut Faults) {
        let rigid = self.rigid.iter().map(|own| (&own.body.name, &own.name, "rigid body"));
        let couplings = self.couplings.iter().map(|own| (&own.coupling.name, &own.name, "coupling"));
        for (name, place, what) in rigid.chain(couplings) {
            if !mesh.groups().kinds(name).is_empty() {
                let message = format!("the mesh has a group `{name}`, too; give the {what} another name");
                faults.push(Fault::at(place, message, "taken"));
            }
        }
        for joint in &self.joints {
            faults.keep(self.ends(joint, mesh));
        }
    }

    /// Checks that loads in the axes of a body, and moments, act on rigid bodies that turn.
    pub(super) fn check_moments(&self, loads: &[Placed<(Load, Members)>], mesh: &Mesh, faults: &mut Faults) {
        for load in loads.iter().filter(|load| is_moment(&load.value.0)) {
            let Some((name, place)) = &load.group else { continue };
            let own = self.rigid.iter().find(|own| own.body.name == *name);
            faults.keep(match own {
                Some(own) if own.body.has_axes() => Ok(()),
                Some(_) => {
                    let message =
                        format!("`{name}` is a point mass and has no direction, which a moment turns");
                    Err(Fault::at(place, message, "a point mass").help("give it an `inertia`"))
                }
                None if self.couplings.iter().any(|own| own.coupling.name == *name) => {
                    let message = format!(
                        "`{name}` is a distributing coupling and has no direction, which this load needs"
                    );
                    Err(Fault::at(place, message, "distributing").help("take kind = \"rigid\" there"))
                }
                None if mesh.groups().kinds(name).is_empty() => {
                    let label = did_you_mean(name, self.bodies()).unwrap_or("not there".into());
                    let known = format!("rigid bodies: {}", listed(self.bodies().into_iter()));
                    let message = format!("there is no rigid body `{name}` on which this load could act");
                    Err(Fault::at(place, message, label).help(known))
                }
                None => {
                    let message =
                        format!("`{name}` is a group of an elastic body; this load acts on a rigid body");
                    let help = "couple it: [[coupling]] with this `group` and kind = \"rigid\"";
                    Err(Fault::at(place, message, "no rigid body").help(help))
                }
            });
        }
    }

    /// The joints, in a mesh that was checked.
    pub(super) fn joints(&self, mesh: &Mesh) -> Result<Vec<Joint>, Fault> {
        self.joints.iter().map(|joint| Ok(joint.of(self.ends(joint, mesh)?))).collect()
    }

    /// Pairs of nodes of the mesh that joints join, the lower one first.
    pub(super) fn joined(&self, mesh: &Mesh) -> Vec<[u32; 2]> {
        let ends = self.joints.iter().filter_map(|joint| self.ends(joint, mesh).ok());
        let pairs = ends.filter_map(|ends| match ends {
            [JointEnd::Node(a), JointEnd::Node(b)] => Some([a.min(b), a.max(b)]),
            _ => None,
        });
        pairs.collect()
    }

    /// The rigid bodies.
    pub(super) fn rigid_bodies(&self) -> Vec<RigidBody> {
        self.rigid.iter().map(|own| own.body.clone()).collect()
    }

    /// The distributing couplings.
    pub(super) fn couplings(&self) -> Vec<Coupling> {
        self.couplings.iter().map(|own| own.coupling.clone()).collect()
    }

    /// The load, where a total force on a rigid body is one at its centre.
    pub(super) fn at_centre(&self, load: Load) -> Load {
        let kind = match load.kind {
            LoadKind::Force { group, force } if self.bodies().contains(&group.as_str()) => {
                LoadKind::NodalForce { group, force }
            }
            kind => kind,
        };
        Load { kind, ..load }
    }

    /// The bodies of a joint.
    fn ends(&self, joint: &PlacedJoint, mesh: &Mesh) -> Result<[JointEnd; 2], Fault> {
        let ends = [self.end(joint, 0, mesh)?, self.end(joint, 1, mesh)?];
        if ends[0] != ends[1] {
            return Ok(ends);
        }
        let [(name, first), (_, second)] = &joint.between;
        let message = format!("joint `{}` is between `{name}` and itself", joint.name);
        Err(Fault::at(second, message, "again").label(first, "one body"))
    }

    fn end(&self, joint: &PlacedJoint, end: usize, mesh: &Mesh) -> Result<JointEnd, Fault> {
        let (name, place) = &joint.between[end];
        if name == GROUND {
            return Ok(JointEnd::Ground);
        }
        let own = self.rigid.iter().find(|own| own.body.name == *name);
        let needs_direction = joint.needs_direction(end);
        let without = |what: &str| {
            let kind = joint::with_article(joint.kind);
            let message = format!("`{name}` is {what} and has no direction, which {kind} joint needs");
            Fault::at(place, message, "without a direction")
        };
        match own {
            Some(own) if needs_direction && !own.body.has_axes() => {
                let help =
                    "give it an `inertia`; spherical and distance joints take points, inline ones first";
                Err(without("a point mass").help(help))
            }
            Some(_) => Ok(JointEnd::Rigid(name.clone())),
            None if self.couplings.iter().any(|own| own.coupling.name == *name) => match needs_direction {
                true => {
                    Err(without("the point of a distributing coupling").help("take kind = \"rigid\" there"))
                }
                false => Ok(JointEnd::Rigid(name.clone())),
            },
            None if mesh.groups().kinds(name).is_empty() => Err(self.unknown(name, place, mesh)),
            None if needs_direction => {
                let help = "couple it: [[coupling]] with this `group` and kind = \"rigid\"; spherical and distance joints take nodes, inline ones first";
                Err(without("a group of an elastic body").help(help))
            }
            None => node(joint, end, mesh).map(JointEnd::Node),
        }
    }

    fn unknown(&self, name: &str, place: &Place, mesh: &Mesh) -> Fault {
        let bodies = self.bodies();
        let groups = mesh.groups().names();
        let groups = groups.iter().copied().filter(|group| !bodies.contains(group));
        let known = || bodies.iter().copied().chain([GROUND]).chain(groups.clone());
        let label = did_you_mean(name, known()).unwrap_or("not there".into());
        let message = format!("`between`: there is no rigid body, coupling or group `{name}`");
        Fault::at(place, message, label).help(format!("there is {}", listed(known())))
    }

    /// Checks that a mechanism without elastic parts can move if joints drive it.
    pub(super) fn check_drives(&self, body: &Body) -> Result<(), Fault> {
        let Some(driven) = self.joints.iter().find(|joint| joint.drive.is_some()) else { return Ok(()) };
        match body.mobility().degrees_of_freedom {
            Some(0) => {
                let message = format!("joint `{}` is driven, but the mechanism cannot move", driven.name);
                let help = "`emmy check` without the drive says which constraints follow from others";
                Err(Fault::at(&driven.place, message, "driven").help(help))
            }
            _ => Ok(()),
        }
    }

    /// The fault of a body with an impossible rigid body or joint.
    pub(super) fn fault(&self, error: &emmy::Error) -> Option<Fault> {
        let of_rigid = rigid::fault(error, &self.rigid).or_else(|| coupling::fault(error, &self.couplings));
        of_rigid.or_else(|| joint::fault(error, &self.joints))
    }
}

/// Distance of a node from the place of a joint, over the size of the mesh, that is rounding.
const SAME_PLACE: f64 = 1e-9;

/// The node of a group at the place of a joint.
fn node(joint: &PlacedJoint, end: usize, mesh: &Mesh) -> Result<u32, Fault> {
    let (name, place) = &joint.between[end];
    let point = joint.point(end);
    let distance = |node: u32| {
        let at = mesh.points()[node as usize];
        (0..3).map(|i| (at[i] - point[i]).powi(2)).sum::<f64>().sqrt()
    };
    let nodes = mesh.group_nodes(name).map_err(|error| Fault::at(place, error.to_string(), "empty"))?;
    let nearest = nodes.iter().copied().min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
    match nearest {
        Some(node) if distance(node) <= SAME_PLACE * mesh.diagonal() => Ok(node),
        Some(node) => {
            let (kind, key) = (joint::with_article(joint.kind), joint.key_of_points());
            let (of, at) = (counted(nodes.len(), "node", "nodes"), short_vector(point));
            let message =
                format!("`{name}` has {of}, none at {at}; {kind} joint takes one: give its place in `{key}`");
            let help = format!("the nearest lies at {}", short_vector(mesh.points()[node as usize]));
            Err(Fault::at(place, message, "no node there").help(help))
        }
        None => Err(Fault::at(place, format!("group `{name}` is empty"), "empty")),
    }
}

/// The note on joints whose single forces, and the torques and forces of whose drives, are not unique.
pub(super) fn note_on_forces(body: &Body) -> Option<String> {
    let Mobility { indeterminate, indeterminate_drives: drives, .. } = body.mobility();
    if indeterminate.is_empty() {
        return None;
    }
    let named = |names: &[String]| listed(names.iter().map(String::as_str));
    let of_drives = match drives.is_empty() {
        true => String::new(),
        false => format!(", nor are those by which they obey the given motions of {}", named(&drives)),
    };
    let joints = if indeterminate.len() == 1 { "joint" } else { "joints" };
    Some(format!(
        "single forces and moments of the {joints} {} are not unique{of_drives}: some constraints follow from the others; \
         Emmy's forces are the smallest ones",
        named(&indeterminate)
    ))
}

/// Whether a load acts on rigid bodies by their names.
pub(super) fn is_for_bodies(load: &Load) -> bool {
    matches!(load.kind, LoadKind::Force { .. } | LoadKind::NodalForce { .. })
}

/// Whether a load acts on the axes of a rigid body.
pub(super) fn is_moment(load: &Load) -> bool {
    matches!(load.kind, LoadKind::Moment { .. } | LoadKind::FollowingForce { .. })
}

/// Part of the kinetic energy that joints take out of the initial velocities, or put in, and that is worth a note.
const WORTH_A_NOTE: f64 = 1e-9;

/// The note on initial velocities that the joints do not allow.
pub(super) fn note_on_start(
    body: &Body,
    initial: &[InitialVelocity],
    start: f64,
    units: Units,
) -> Option<String> {
    if body.n_constraints() == 0 {
        return None;
    }
    // Faults of the fields have their own messages.
    let [given, allowed] = body.initial_energies(start, initial).ok()?;
    let change = allowed - given;
    if change.abs() <= WORTH_A_NOTE * given.max(allowed) {
        return None;
    }
    let [size, given] = [change.abs(), given].map(|energy| units.number(energy, "energy"));
    Some(match change < 0.0 {
        true => {
            format!("the joints take {size} of {given} of the kinetic energy out of the initial velocities")
        }
        false => format!(
            "given motions of joints begin with a speed, which adds {size} of kinetic energy at the start"
        ),
    })
}
