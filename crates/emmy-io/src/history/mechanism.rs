//! Columns of joints and rigid bodies.

use emmy::body::{Body, Joint, JointKind, JointState, RigidMotion};
use emmy::motion::Record;

use super::ColumnInfo;
use super::Number::{self, Missing, Real};

/// Column of the largest opening of a joint or change of a rigid body's shape.
pub(crate) const RESIDUAL: &str = "constraint_residual";

/// Column of its rate.
pub(crate) const HIDDEN: &str = "hidden_constraint";

/// The columns of the joints and rigid bodies of a body.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct MechanismColumns {
    joints: Vec<OfJoint>,
    /// Whether there are constraints: joints, or rigid bodies with axes.
    has_constraints: bool,
    bodies: Vec<OfBody>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct OfJoint {
    /// Its place among the joints of the body.
    place: usize,
    name: String,
    /// The coordinate that it leaves.
    coordinate: Option<&'static str>,
    /// Whether it also slides.
    has_slide: bool,
    /// Whether a given motion, a spring, a damping or a motor acts in it.
    has_drive: bool,
}

#[derive(Debug, Clone, PartialEq, Eq)]
struct OfBody {
    name: String,
    /// Whether it turns; a point mass does not.
    has_axes: bool,
    /// Node of its centre.
    node: usize,
    /// Words for the frame of reference of its position.
    relation: String,
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl MechanismColumns {
    /// The columns of a body, with those of the joints of some names; `None`: of all. `relation`: words for the frame
    /// of reference of positions.
    pub(crate) fn of(body: &Body, names: Option<&[String]>, relation: &str) -> Self {
        let is_asked = |joint: &Joint| names.is_none_or(|names| names.contains(&joint.name));
        let joints = body.joints().iter().enumerate().filter(|(_, joint)| is_asked(joint));
        let joints = joints.map(|(place, joint)| OfJoint {
            place,
            name: joint.name.clone(),
            coordinate: joint.kind.coordinate(),
            has_slide: matches!(joint.kind, JointKind::Cylindrical { .. }),
            has_drive: joint.drive.is_some() || joint.has_force(),
        });
        let joints: Vec<OfJoint> = joints.collect();
        let bodies = body.rigid_bodies().map(|own| OfBody {
            name: own.name.clone(),
            has_axes: own.has_axes(),
            node: body.nodes_of_rigid_body(&own.name).map_or(0, |nodes| nodes.start as usize),
            relation: relation.to_string(),
        });
        let bodies: Vec<OfBody> = bodies.collect();
        let has_constraints = !body.joints().is_empty() || bodies.iter().any(|body| body.has_axes);
        MechanismColumns { joints, has_constraints, bodies }
    }

    /// The columns, each with the joint or rigid body that has it.
    pub(crate) fn owned(&self) -> Vec<(Option<&str>, ColumnInfo)> {
        let with = |name| move |column| (Some(name), column);
        let mut all: Vec<(Option<&str>, ColumnInfo)> = Vec::new();
        for joint in &self.joints {
            all.extend(joint.columns().into_iter().map(with(joint.name.as_str())));
        }
        if self.has_constraints {
            all.extend(of_constraints().map(|column| (None, column)));
        }
        for body in &self.bodies {
            all.extend(body.columns().into_iter().map(with(body.name.as_str())));
        }
        all
    }

    /// Appends the numbers of a record; `seen`: the positions of a node in another frame of reference.
    pub(crate) fn add_to(
        &self,
        record: &Record,
        seen: Option<&dyn Fn(usize) -> [f64; 3]>,
        numbers: &mut Vec<Number>,
    ) {
        let mean = |force: f64| if record.has_joint_forces { Real(force) } else { Missing };
        for joint in &self.joints {
            let state: JointState = record.joints.get(joint.place).copied().unwrap_or_default();
            numbers.extend(state.force.into_iter().chain(state.moment).map(mean));
            numbers.extend(joint.coordinate.map(|_| Real(state.coordinate)));
            numbers.extend(joint.has_slide.then_some(Real(state.slide)));
            numbers.extend(joint.drive().map(|_| mean(state.drive)));
        }
        if self.has_constraints {
            numbers.extend([Real(record.constraint_residual), Real(record.hidden_constraint)]);
        }
        for (place, body) in self.bodies.iter().enumerate() {
            let motion: RigidMotion = record.rigid_bodies.get(place).copied().unwrap_or_default();
            numbers.extend(seen.map_or(motion.position, |seen| seen(body.node)).map(Real));
            if body.has_axes {
                numbers.extend(motion.spin.map(Real));
            }
        }
    }
}

impl OfJoint {
    fn columns(&self) -> Vec<ColumnInfo> {
        let OfJoint { name, .. } = self;
        let force = format!("force of the joint {name} on its first body, its mean over the step");
        let moment = format!(
            "moment of the joint {name} on its first body about its point there, its mean over the step"
        );
        let mut all = vectors(&format!("{name}_force"), "force", &force);
        all.extend(vectors(&format!("{name}_moment"), "force·length", &moment));
        let slide = self.has_slide.then_some("slide");
        all.extend(self.coordinate.into_iter().chain(slide).map(|word| {
            let (dimension, meaning) = match word {
                "angle" => {
                    ("radian", "angle of the first body of the joint NAME about the axis of the second")
                }
                "slide" => {
                    ("length", "slide of the first body of the joint NAME along the axis of the second")
                }
                _ => ("length", "distance of the points of the joint NAME"),
            };
            column(format!("{name}_{word}"), dimension, meaning.replace("NAME", name))
        }));
        all.extend(self.drive().map(|(word, dimension)| {
            let what = if word == "torque" { "torque" } else { "force" };
            let meaning = format!(
                "{what} of drive, spring, damping or motor of the joint {name} on its first body, its mean over the step"
            );
            column(format!("{name}_{word}"), dimension, meaning)
        }));
        all
    }

    /// Ending and dimension of the column of its drive.
    fn drive(&self) -> Option<(&'static str, &'static str)> {
        let of = |coordinate| match coordinate {
            "angle" => ("torque", "force·length"),
            _ => ("drive_force", "force"),
        };
        self.coordinate.filter(|_| self.has_drive).map(of)
    }
}

impl OfBody {
    fn columns(&self) -> Vec<ColumnInfo> {
        let OfBody { name, has_axes, relation, .. } = self;
        let what = if *has_axes { "centre of the rigid body" } else { "point mass" };
        let mut all = vectors(name, "length", &format!("current position of the {what} {name}{relation}"));
        if *has_axes {
            let meaning = format!("angular velocity of the rigid body {name}, in the axes of space");
            all.extend(vectors(&format!("{name}_spin"), "1/time", &meaning));
        }
        all
    }
}

fn of_constraints() -> [ColumnInfo; 2] {
    [
        column(
            RESIDUAL.into(),
            "",
            "largest opening of a joint or change of a rigid body's shape, over the size of the whole".into(),
        ),
        column(
            HIDDEN.into(),
            "length/time",
            "largest rate of these; the momenta carry it, the positions do not".into(),
        ),
    ]
}

fn column(name: String, dimension: &str, meaning: String) -> ColumnInfo {
    ColumnInfo { name, dimension: dimension.to_string(), meaning }
}

fn vectors(name: &str, dimension: &str, meaning: &str) -> Vec<ColumnInfo> {
    AXES.map(|axis| column(format!("{name}_{axis}"), dimension, meaning.to_string())).into()
}

#[cfg(test)]
mod tests {
    use emmy::body::{InitialVelocity, JointEnd, RigidBody, TimeFunction};
    use emmy::mesh::Mesh;
    use emmy::motion::{Motion, State};
    use emmy::time::TimeElement;

    use super::*;

    #[test]
    fn each_joint_and_body_has_its_columns_in_their_order() {
        let ground = |body: &str| [JointEnd::Rigid(body.into()), JointEnd::Ground];
        let hinge =
            Joint::new("hinge", JointKind::Revolute { axis: [0.0, 0.0, 1.0] }, ground("arm"), [0.0; 3]);
        let link =
            Joint::new("link", JointKind::Distance { to: [3.0, 0.0, 0.0] }, ground("ball"), [2.0, 0.0, 0.0]);
        let law = |text| TimeFunction::smooth(text, |t| [0.1 * t * t, 0.2 * t, 0.2]);
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("arm", 2.0, [1.0, 0.0, 0.0], [0.1, 0.2, 0.2]))
            .rigid(RigidBody::point("ball", 3.0, [2.0, 0.0, 0.0]))
            .joint(hinge.driven(law("0.1*t^2")))
            .joint(link)
            .build()
            .unwrap();
        let columns = MechanismColumns::of(&body, None, "");
        let names: Vec<String> = columns.owned().into_iter().map(|(_, column)| column.name).collect();
        let of_vector = |name: &str| AXES.map(|axis| format!("{name}_{axis}"));
        let expected = [
            &of_vector("hinge_force")[..],
            &of_vector("hinge_moment"),
            &["hinge_angle".to_string(), "hinge_torque".to_string()],
            &of_vector("link_force"),
            &of_vector("link_moment"),
            &["link_distance", "constraint_residual", "hidden_constraint"].map(str::to_string),
            &of_vector("arm"),
            &of_vector("arm_spin"),
            &of_vector("ball"),
        ];
        assert_eq!(names, expected.concat());
        let mut motion = Motion::new(&body, TimeElement::discrete_gradient(2).unwrap()).unwrap();
        let at = |record: &Record, name: &str| {
            let mut numbers = Vec::new();
            columns.add_to(record, None, &mut numbers);
            assert_eq!(numbers.len(), names.len());
            numbers[names.iter().position(|own| own == name).unwrap()]
        };
        assert_eq!(at(motion.record(), "hinge_torque"), Missing);
        assert_eq!(
            (at(motion.record(), "link_distance"), at(motion.record(), "ball_x")),
            (Real(1.0), Real(2.0))
        );
        let record = motion.step(0.1).unwrap();
        // The inertia about the hinge times the angular acceleration.
        let torque = (0.2 + 2.0) * 0.2;
        assert!((at(record, "hinge_torque").value() - torque).abs() < 1e-3 * torque);
        assert!((at(record, "hinge_angle").value() - 1e-3).abs() < 1e-14);
        assert!((at(record, "arm_x").value() - 1e-3_f64.cos()).abs() < 1e-14);
        assert!((at(record, "arm_spin_z").value() - 0.02).abs() < 1e-4);
    }

    #[test]
    fn a_ring_slides_on_its_axis_and_turns_about_it() {
        let kind = JointKind::Cylindrical { axis: [0.0, 0.0, 2.0] };
        let between = || [JointEnd::Rigid("ring".into()), JointEnd::Ground];
        let body = Body::builder(Mesh::without_cells())
            .rigid(RigidBody::new("ring", 2.0, [0.1, 0.0, 0.0], [0.1, 0.1, 0.2]))
            .joint(Joint::new("axis", kind, between(), [0.0; 3]))
            .build()
            .unwrap();
        let columns = MechanismColumns::of(&body, None, "");
        let names: Vec<String> = columns.owned().into_iter().map(|(_, column)| column.name).collect();
        assert_eq!(names[6..8], ["axis_angle", "axis_slide"]);
        let flies = InitialVelocity {
            velocity: [0.0, 0.0, 0.5],
            angular_velocity: [0.0, 0.0, 2.0],
            ..Default::default()
        };
        let state = State::initial(&body, 0.0, &[flies]).unwrap();
        let mut motion = Motion::new(&body, TimeElement::discrete_gradient(3).unwrap()).unwrap();
        motion = motion.from(state).unwrap();
        let record = (0..20).map(|_| motion.step(0.05).unwrap().clone()).last().unwrap();
        let mut numbers = Vec::new();
        columns.add_to(&record, None, &mut numbers);
        assert!((numbers[6].value() - 2.0).abs() < 1e-8 && (numbers[7].value() - 0.5).abs() < 1e-13);
        let others = MechanismColumns::of(&body, Some(&[]), "");
        let names: Vec<String> = others.owned().into_iter().map(|(_, column)| column.name).collect();
        assert_eq!(names[..2], [RESIDUAL, HIDDEN]);
    }

    #[test]
    fn a_point_mass_has_no_constraints() {
        let body = Body::builder(Mesh::without_cells()).rigid(RigidBody::point("ball", 3.0, [2.0, 0.0, 0.0]));
        let columns = MechanismColumns::of(&body.build().unwrap(), None, "");
        let names: Vec<String> = columns.owned().into_iter().map(|(_, column)| column.name).collect();
        assert_eq!(names, ["ball_x", "ball_y", "ball_z"]);
    }
}
