//! Everything that can go wrong in the library, as one enum with fields.

mod advice;

use self::advice::{
    advice_on_equilibrium, advice_on_failure, advice_on_steps, contradiction, far_away, in_contact, lost,
};
use crate::mesh::CellKind;
use crate::number::{short, short_vector};

/// Result of the library.
///
/// ```
/// use emmy::prelude::*;
/// fn mass() -> emmy::Result<f64> {
///     let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
///     Ok(Body::builder(mesh::block([1.0; 3], [1; 3])?).region(rubber).build()?.regions()[0].mass)
/// }
/// assert_eq!(mass(), Ok(2.0));
/// ```
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// An error of the library. Every message names the fault, its place, and something to try.
///
/// ```
/// let error = emmy::material::NeoHooke::from_engineering(1000.0, 0.5).unwrap_err();
/// assert!(matches!(error, emmy::Error::MaterialParameter { parameter: "poissons_ratio", .. }));
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A mesh without cells.
    #[error("the mesh has no cells that carry a body (see `emmy list elements`)")]
    EmptyMesh,
    /// A cell with a node that does not exist.
    #[error("cell {cell} names node {node}, but the mesh has {n_nodes} nodes")]
    NodeOutOfRange {
        /// Index of the cell.
        cell: usize,
        /// Index of the node.
        node: usize,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// A point that no cell uses: it would have no mass.
    #[error("point {node} belongs to no cell")]
    UnusedPoint {
        /// Index of the point.
        node: usize,
    },
    /// A cell that would lose an edge where near nodes become one.
    #[error(
        "cell {cell} has two nodes within {within} of each other near {position}, which would be one; take a smaller distance",
        within = short(.within),
        position = short_vector(.position)
    )]
    MergedCell {
        /// Index of the cell.
        cell: usize,
        /// Where its nodes are.
        position: [f64; 3],
        /// The distance.
        within: f64,
    },
    /// Two cells that would have the same nodes if near nodes were one.
    #[error(
        "cell {repeated} would have the nodes of cell {first} if nodes within {within} of each other were one; do two \
         bodies overlap?",
        within = short(.within)
    )]
    MergedCells {
        /// Index of the first cell.
        first: u32,
        /// Index of the second cell.
        repeated: u32,
        /// The distance.
        within: f64,
    },
    /// A node of a group that does not exist.
    #[error("group \"{group}\" names node {node}, but the mesh has {n_nodes} nodes")]
    GroupNodeOutOfRange {
        /// Name of the group.
        group: String,
        /// Index of the node.
        node: usize,
        /// Number of nodes.
        n_nodes: usize,
    },
    /// A cell whose number of nodes does not fit its kind.
    #[error("a {kind} cell has {expected} nodes, not {found}")]
    WrongNodeCount {
        /// Kind of the cell.
        kind: CellKind,
        /// Number of nodes of the kind.
        expected: usize,
        /// Number of nodes given.
        found: usize,
    },
    /// A node whose coordinates are NaN or infinite.
    #[error("node {node} has a coordinate that is not a finite number")]
    CoordinateNotFinite {
        /// Index of the node.
        node: usize,
    },
    /// Cells of a body in plane strain that do not lie in one plane z = const.
    #[error(
        "cells in plane strain must lie in one plane z = const, but node {node} is at z = {z} and the first one at \
         z = {plane}; turn the mesh into the x-y plane, or mesh a volume",
        z = short(.z),
        plane = short(.plane)
    )]
    NotInPlane {
        /// Index of the node.
        node: usize,
        /// Its coordinate.
        z: f64,
        /// Coordinate of the first node of a plane cell.
        plane: f64,
    },
    /// A scale factor or size that must be positive and finite.
    #[error("{what} must be positive and finite, not {}", short(.value))]
    NotPositive {
        /// The quantity.
        what: String,
        /// Its value.
        value: f64,
    },
    /// A viscosity or a drag that is negative or not a number.
    #[error("viscosity: {name} must be finite and not negative (of links: zero), not {}", short(.value))]
    Viscosity {
        /// Which number.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A built-in shape with more cells than [`crate::mesh::MAX_CELLS`].
    #[error("this makes {count:.1e} cells; the limit is {most:.0e}", most = crate::mesh::MAX_CELLS)]
    TooManyCells {
        /// Number of cells.
        count: f64,
    },
    /// A cell size that does not divide the edges of the l-block.
    #[error("the l-block needs a cell size of 1, 1/2, 1/3, ..., so that it divides its edges; not {}", short(.value))]
    CellSize {
        /// The cell size.
        value: f64,
    },
    /// A ring whose inner radius is not the smaller one.
    #[error("the inner radius {} must be smaller than the outer radius {}", short(.inner), short(.outer))]
    InnerRadius {
        /// The inner radius.
        inner: f64,
        /// The outer radius.
        outer: f64,
    },
    /// A ring with too few cells around its axis.
    #[error("a ring needs at least {least} cells around its axis, not {count}")]
    CellsAround {
        /// Number of cells.
        count: usize,
        /// Fewest cells.
        least: usize,
    },
    /// A part of a mesh whose name cannot be a word in other names.
    #[error("a part may have only letters, digits, `_` and `-` in its name, not \"{part}\"")]
    PartName {
        /// Name of the part.
        part: String,
    },
    /// A part of a mesh with the name of a group, or with a group, that is there already.
    #[error("part \"{part}\": there is a group \"{group}\" already; give the part another name")]
    GroupOfPartExists {
        /// Name of the part.
        part: String,
        /// The group.
        group: String,
    },
    /// A part in plane strain beside solid ones, or a solid one beside those in plane strain.
    #[error("part \"{part}\": cells in plane strain and solid cells cannot be parts of one mesh")]
    MixedParts {
        /// Name of the part.
        part: String,
    },
    /// A rotation that takes cells in plane strain out of their plane.
    #[error("cells in plane strain turn about the z axis only")]
    TurnedPlane,
    /// A rotation without an axis or an angle.
    #[error(
        "a rotation needs a finite angle, not {}, and an axis that is finite and not 0, not {}",
        short(.angle),
        short_vector(.axis)
    )]
    Turn {
        /// The axis.
        axis: [f64; 3],
        /// The angle.
        angle: f64,
    },
    /// A value that must be a finite number.
    #[error("{what} must be a finite number, not {}", short(.value))]
    NotFinite {
        /// The quantity.
        what: String,
        /// Its value.
        value: f64,
    },
    /// A load or a given motion that is not a finite number at a time. A smaller step does not help.
    #[error("{what} is {value} at t = {}, not a finite number; correct its function of time", short(.time))]
    NotFiniteAt {
        /// The load or support with the text of its function; of a field also the reference position.
        what: String,
        /// The time.
        time: f64,
        /// Its value there.
        value: f64,
    },
    /// A facet of a group that is not a face of any cell.
    #[error("group \"{group}\": the facet with nodes {nodes:?} is not a face of any cell of the body")]
    FacetWithoutCell {
        /// Name of the group.
        group: String,
        /// Corner nodes of the facet (indices into the points).
        nodes: Vec<u32>,
    },
    /// A cell that is inverted or degenerate in the reference configuration.
    #[error("cell {cell} ({kind}) is inverted or degenerate: det(dX/dxi) = {} at one of its points", short(.det))]
    InvertedCell {
        /// Index of the cell.
        cell: usize,
        /// Kind of the cell.
        kind: CellKind,
        /// The smallest determinant.
        det: f64,
    },
    /// A group that the mesh does not have.
    #[error("there is no {what} group \"{group}\" in the mesh; it has: {available}")]
    UnknownGroup {
        /// Kind of the group (`cell`, `facet`, ...).
        what: &'static str,
        /// Name of the group.
        group: String,
        /// Names of the existing groups.
        available: String,
    },
    /// No support moves, so there is no base.
    #[error("no support moves, so there is no base: name a group")]
    NoBase,
    /// A mesh whose cells do not all have a material, or have several.
    #[error("cell {cell} belongs to {count} regions; every cell must belong to exactly one")]
    RegionCover {
        /// Index of the cell.
        cell: usize,
        /// Number of regions that claim it.
        count: usize,
    },
    /// A cell whose region has a material for other kinds of cells.
    #[error(
        "cell {cell} is a {kind}: links (line2) need a bar, a spring or an attraction as their material, and no other cells do"
    )]
    WrongMaterial {
        /// Index of the cell.
        cell: usize,
        /// Its kind.
        kind: CellKind,
    },
    /// A cell that does not have the formulation of its region.
    #[error("cell {cell}: {reason}")]
    Formulation {
        /// Index of the cell.
        cell: usize,
        /// Why not, with the remedy.
        reason: String,
    },
    /// A node without mass that is free to move.
    #[error(
        "node {node} at {} has no mass: springs and attractions have none; give it a point mass, or hold it in all \
         directions",
        short_vector(.position)
    )]
    NoMass {
        /// Index of the node.
        node: usize,
        /// Its reference position.
        position: [f64; 3],
    },
    /// A parameter of a material outside its range.
    #[error("{material}: {parameter} = {} {requirement}", short(.value))]
    MaterialParameter {
        /// Key word of the material.
        material: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// Condition on the value.
        requirement: &'static str,
    },
    /// A direction of a material that is not one, or that is parallel to another.
    #[error("{material}: {parameter} {requirement}")]
    Direction {
        /// Key word of the material.
        material: &'static str,
        /// Name of the parameter.
        parameter: &'static str,
        /// Condition on the direction.
        requirement: &'static str,
    },
    /// A formula that is not the energy of a stable material.
    #[error("energy: {reason}")]
    EnergyFormula {
        /// Reason.
        reason: String,
    },
    /// A time function whose times go back, or with an entry that is not finite.
    #[error("time function: {reason} (entry {entry})")]
    TimeFunction {
        /// Index of the entry.
        entry: usize,
        /// Reason.
        reason: &'static str,
    },
    /// A mass that cannot be spread over its group.
    #[error("mass of \"{group}\": {reason}")]
    Mass {
        /// Group of the mass.
        group: String,
        /// Reason.
        reason: String,
    },
    /// A pressure on facets with cells on both sides.
    #[error(
        "pressure on \"{group}\": the facet at {} has cells on both sides, so the pressure has no sign; take facets of the \
         surface, or a traction, which has a direction",
        short_vector(.at)
    )]
    PressureInside {
        /// Group of the pressure.
        group: String,
        /// Middle of the facet.
        at: [f64; 3],
    },
    /// An impossible support.
    #[error("support of \"{group}\": {reason}")]
    Support {
        /// Group of the support.
        group: String,
        /// Reason.
        reason: String,
    },
    /// A rigid body with the name of a group.
    #[error("there is a group \"{group}\" already; a rigid body needs another name")]
    GroupExists {
        /// The name.
        group: String,
    },
    /// An inertia tensor that is not symmetric, or that no body has.
    #[error(
        "the inertia {inertia:?} of the rigid body \"{body}\" must be symmetric and not zero, and each principal moment \
         at most the sum of the others"
    )]
    Inertia {
        /// Name of the body.
        body: String,
        /// Its inertia.
        inertia: [[f64; 3]; 3],
    },
    /// An impossible rigid body.
    #[error("rigid body \"{body}\": {reason}")]
    Rigid {
        /// Its name.
        body: String,
        /// Reason.
        reason: String,
    },
    /// An impossible joint.
    #[error("joint \"{joint}\": {reason}")]
    Joint {
        /// Its name.
        joint: String,
        /// Reason.
        reason: String,
    },
    /// A moment on what has no directions.
    #[error("a moment acts on a rigid body with an inertia, and \"{group}\" is none")]
    Moment {
        /// Name in the place of that of a rigid body.
        group: String,
    },
    /// An impossible contact.
    #[error("contact \"{contact}\": {reason}")]
    Contact {
        /// Its name.
        contact: String,
        /// The key of its table in an input that is wrong; empty: the contact as a whole.
        key: &'static str,
        /// Reason.
        reason: String,
    },
    /// A surface would pass through an obstacle or another surface.
    #[error("contact \"{contact}\": its surface would pass through its opponent near {}; take smaller steps", short_vector(*at))]
    Passed {
        /// Name of the contact.
        contact: String,
        /// Position \[length\].
        at: [f64; 3],
    },
    /// An impossible distributing coupling.
    #[error("coupling \"{coupling}\": {reason}")]
    Coupling {
        /// Its name.
        coupling: String,
        /// Reason.
        reason: String,
    },
    /// An impossible tie.
    #[error("tie of \"{follower}\" to \"{leader}\": {reason}")]
    Tie {
        /// Number of the tie, from 0.
        number: usize,
        /// Group of the nodes that follow.
        follower: String,
        /// Group that they follow.
        leader: String,
        /// Reason.
        reason: String,
    },
    /// A prescribed motion that does not begin where its nodes are, which is zero in an undeformed body.
    #[error(
        "a prescribed motion starts with a displacement of {} from its nodes at t = {}; let it start from zero, or the \
         body from its equilibrium",
        short(.distance),
        short(.time)
    )]
    DrivenStart {
        /// Time of the start.
        time: f64,
        /// Largest displacement.
        distance: f64,
    },
    /// A start whose momentum is not p = M v.
    #[error(
        "momentum and velocity of the start do not belong together: the momentum of node {node} is {}, but M v is {} with \
         the masses of this body",
        short_vector(.momentum),
        short_vector(.product)
    )]
    StartMomentum {
        /// Index of the node.
        node: usize,
        /// Its momentum.
        momentum: [f64; 3],
        /// Its momentum M v.
        product: [f64; 3],
    },
    /// A start in which a node moves that a support holds.
    #[error(
        "the start does not belong to the body: node {node} moves with the velocity {}, although a support holds it",
        short_vector(.velocity)
    )]
    StartHeld {
        /// Index of the node.
        node: usize,
        /// Its velocity.
        velocity: [f64; 3],
    },
    /// A body that is to be in equilibrium, and is free to move as a rigid body.
    #[error(
        "nothing holds {part} against {motions}; an equilibrium needs supports or springs to the ground there, or a contact that touches{}",
        far_away(.contacts)
    )]
    NotHeld {
        /// The body, or a part of it.
        part: String,
        /// The rigid motions that are free.
        motions: String,
        /// Contacts of this part that do not touch anything, each with its smallest gap and its distance \[length\].
        contacts: Vec<(String, [f64; 2])>,
    },
    /// A body in equilibrium with a part that moves without resistance: a link that can turn, or a buckled member.
    #[error(
        "the stiffness is singular at a load fraction of {fraction}: node {node} near {position} moves without resistance; \
         look for links that can turn, and for members that buckle there",
        fraction = short(.fraction),
        position = short_vector(.position)
    )]
    Singular {
        /// Load fraction of the increment.
        fraction: f64,
        /// Node with the largest motion.
        node: usize,
        /// Its last position in equilibrium.
        position: [f64; 3],
    },
    /// An equilibrium that does not belong to the path of the loads: the body would snap through.
    #[error(
        "the next equilibrium, at a load fraction of {fraction}, lies far away: the body snaps through, node {node} near {position} \
         most of all",
        fraction = short(.fraction),
        position = short_vector(.position)
    )]
    OtherPath {
        /// Load fraction of the increment.
        fraction: f64,
        /// Node that moves farthest.
        node: usize,
        /// Its last position in equilibrium.
        position: [f64; 3],
    },
    /// An increment without equilibrium, with every size down to the smallest one.
    #[error(
        "no equilibrium was found beyond a load fraction of {fraction}, with increments down to {increment}; {advice}",
        advice = advice_on_equilibrium(.cause),
        fraction = short(.fraction),
        increment = short(.increment)
    )]
    NoEquilibrium {
        /// Load fraction of the last equilibrium.
        fraction: f64,
        /// The last increment that was tried.
        increment: f64,
        /// Why the last attempt failed.
        #[source]
        cause: Box<Error>,
    },
    /// Newton's iteration for an equilibrium that did not converge.
    #[error(
        "no convergence at a load fraction of {fraction}: residual {residual:.3e} after {iterations} \
         (wanted {target:.3e}), largest at node {node} near {position}{}",
        in_contact(.contact),
        iterations = counted(*.iterations),
        fraction = short(.fraction),
        position = short_vector(.position)
    )]
    NotBalanced {
        /// Load fraction of the increment.
        fraction: f64,
        /// Number of Newton iterations done.
        iterations: usize,
        /// Norm of the last residual.
        residual: f64,
        /// Bound on the norm.
        target: f64,
        /// Node with the largest residual.
        node: usize,
        /// Its last position in equilibrium.
        position: [f64; 3],
        /// Name of a contact in which something was near it there.
        contact: Option<Box<str>>,
    },
    /// A scheme that does not parse or does not exist for the degree.
    #[error("scheme \"{scheme}\": {reason}")]
    Scheme {
        /// The text.
        scheme: String,
        /// Reason, and the possible values.
        reason: String,
    },
    /// A step plan that goes back in time or has a step size that is not positive.
    #[error("phase {phase} of the step plan: {reason}")]
    Plan {
        /// Index of the phase.
        phase: usize,
        /// Reason.
        reason: String,
    },
    /// A step whose error is above the tolerance of adaptive steps.
    #[error("its error {error:.1e} is above the tolerance {}", short(.tolerance))]
    Tolerance {
        /// Error of the step, relative to the scales.
        error: f64,
        /// Tolerance.
        tolerance: f64,
    },
    /// A load or a given motion that steps of the smallest size do not resolve.
    #[error("{what} is not resolved by steps of {size:e}; give it as a table, or allow smaller steps")]
    Unresolved {
        /// The function and the time.
        what: String,
        /// Size of the step.
        size: f64,
    },
    /// A setting of adaptive steps that is out of range, or that contradicts another.
    #[error("adaptive steps: {setting} {reason}")]
    Adaptivity {
        /// Name of the setting in an input.
        setting: &'static str,
        /// Reason.
        reason: String,
    },
    /// A determinant of the deformation gradient that became zero or negative, or NaN.
    #[error("cell {cell} is turned inside out: det F = {}", short(.det))]
    Inverted {
        /// Index of the cell.
        cell: usize,
        /// Smallest determinant seen.
        det: f64,
    },
    /// A configuration in which a force is not defined.
    #[error("{reason}")]
    Refused {
        /// Reason, of the force.
        reason: String,
    },
    /// A step beyond the stability limit of an explicit scheme.
    #[error(
        "step {step}, to t = {time}: {step_size} is too large for an explicit scheme, whose critical step is \
         {critical} now (2/omega_max); try at most {limit}, or an implicit scheme",
        time = short(.time),
        step_size = short(.step_size),
        critical = short(.critical),
        limit = short(.limit)
    )]
    StepTooLarge {
        /// Number of the step that was rejected.
        step: usize,
        /// Time at its end.
        time: f64,
        /// Requested step size.
        step_size: f64,
        /// Estimate of the critical step, 2/omega_max.
        critical: f64,
        /// Largest step that is accepted.
        limit: f64,
    },
    /// A step whose size is lost in the rounding of the time.
    #[error("a step of {step_size:e} at t = {time} is lost in the rounding of the time")]
    NoDuration {
        /// Time at its start.
        time: f64,
        /// Its size.
        step_size: f64,
    },
    /// Newton's iteration that did not converge.
    #[error(
        "no convergence in step {step}, to t = {time}: residual {residual:.3e} after {iterations} \
         (wanted {target:.3e}), largest at node {node} near {position}{of}{}; try a smaller step, or more iterations",
        in_contact(.contact),
        iterations = counted(*.iterations),
        time = short(.time),
        position = short_vector(**.position),
        of = .rigid.as_ref().map_or(String::new(), |name| format!(" of the rigid body \"{name}\""))
    )]
    NoConvergence {
        /// Number of the step that failed.
        step: usize,
        /// Time at its end.
        time: f64,
        /// Number of Newton iterations done.
        iterations: usize,
        /// Norm of the last residual.
        residual: f64,
        /// Bound on the norm.
        target: f64,
        /// Node with the largest residual.
        node: usize,
        /// Its last good position.
        position: Box<[f64; 3]>,
        /// Name of the rigid body to whose frame it belongs.
        rigid: Option<Box<str>>,
        /// Name of a contact in which something was near it in the last good state.
        contact: Option<Box<str>>,
    },
    /// Joints whose given motions no velocity obeys.
    #[error(
        "no motion obeys all joints at t = {time}: {}, or the mechanism is locked",
        contradiction(.driven),
        time = short(.time)
    )]
    NoMotion {
        /// The time.
        time: f64,
        /// Names of the joints whose given motions take part in the contradiction, as far as they are known.
        driven: Vec<String>,
    },
    /// A step after which constraints do not hold.
    #[error(
        "step {step}, to t = {time}: joints are open by {residual:.3e}{}",
        lost(.joints, .driven),
        time = short(.time)
    )]
    ConstraintsLost {
        /// Number of the step that failed.
        step: usize,
        /// Time at its end.
        time: f64,
        /// Largest opening \[length\].
        residual: f64,
        /// Names of the joints with the largest openings; of rigid bodies if these alone are strained.
        joints: Vec<String>,
        /// Names of the joints whose given motions take part in the contradiction.
        driven: Vec<String>,
    },
    /// A step in which rounding of the internal forces leaves less than three digits of energy or momenta.
    #[error(
        "step {step}, to t = {time}: rounding leaves {digits:.1} correct digits of the body's inertia, fewer than three: the body is too \
         stiff for a step of this size; try a smaller step, or an energy-momentum scheme (DGM, AS)"
    )]
    NoDigits {
        /// Number of the step that failed.
        step: usize,
        /// Time at its end.
        time: f64,
        /// Digits that are left.
        digits: f64,
    },
    /// A step whose equations cannot be solved from any starting point.
    #[error(
        "step {step}, to t = {}, cannot be solved{}",
        short(.time),
        advice_on_failure(.cause, *.has_cells)
    )]
    StepFailed {
        /// Number of the step that failed.
        step: usize,
        /// Time at its end.
        time: f64,
        /// Whether the body has cells, with a material.
        has_cells: bool,
        /// Reason.
        #[source]
        cause: Box<Error>,
    },
    /// A step in which a cell is inverted.
    #[error(
        "step {step}, to t = {time}: cell {cell} ({kind}) near {position} is turned inside out, det F = {det}; try a smaller \
         step, a finer mesh there, or a material that resists compression, and look at the loads there",
        time = short(.time),
        position = short_vector(.position),
        det = short(.det)
    )]
    CellInverted {
        /// Number of the step that failed.
        step: usize,
        /// Time at its end.
        time: f64,
        /// Index of the cell.
        cell: usize,
        /// Its kind.
        kind: CellKind,
        /// Its centre in the last good state.
        position: [f64; 3],
        /// Smallest determinant seen.
        det: f64,
    },
    /// A step in which a number is not finite.
    #[error(
        "step {step}, to t = {}: the forces at node {node} near {} are not numbers; look at the time functions of the \
         loads, and at the material or the joints there",
        short(.time),
        short_vector(.position)
    )]
    NotANumber {
        /// Number of the step that failed.
        step: usize,
        /// Time at its end.
        time: f64,
        /// First node with such a number.
        node: usize,
        /// Its last good position.
        position: [f64; 3],
    },
    /// A step that failed with every size down to the smallest one.
    #[error(
        "step {step} from t = {start} failed with every size down to {step_size}; {advice}",
        start = short(.start),
        step_size = short(.step_size),
        advice = advice_on_steps(.cause, *.has_cells)
    )]
    SmallestStep {
        /// Number of the step.
        step: usize,
        /// Time at its start.
        start: f64,
        /// The last size that was tried.
        step_size: f64,
        /// Whether the body has cells, which a finer mesh could change.
        has_cells: bool,
        /// Why the last attempt failed.
        #[source]
        cause: Box<Error>,
    },
    /// A state or a stepper's memory that belongs to another problem.
    #[error("the snapshot of the motion does not fit: `{name}` {reason}")]
    Memory {
        /// Name of the list.
        name: String,
        /// Reason.
        reason: String,
    },
    /// A vector of another length than that of the body or the step.
    #[error("{what} has {expected} numbers here, not {found}")]
    Length {
        /// Name of the vector.
        what: &'static str,
        /// Its numbers.
        found: usize,
        /// The numbers that it must have.
        expected: usize,
    },
    /// A mesh too large for the memory of the machine.
    #[error("not enough memory for {what} ({gigabytes:.1} GB); try a coarser mesh")]
    OutOfMemory {
        /// Purpose of the memory.
        what: &'static str,
        /// Memory needed.
        gigabytes: f64,
    },
    /// A motion that the adjoint does not cover.
    #[error("adjoint: {reason}")]
    Adjoint {
        /// The unsupported feature, and the supported ones.
        reason: String,
    },
    /// A computation that has no multipliers for the constraints of a body.
    #[error("{what} does not cover rigid bodies and joints; steps of a time element do")]
    Constrained {
        /// The computation.
        what: &'static str,
    },
    /// A harmonic response that does not exist.
    #[error("harmonic response: {reason}")]
    Response {
        /// Reason.
        reason: String,
    },
    /// An impossible load by an observer that turns, or vibrations that it does not have.
    #[error("load `rotation`: {reason}")]
    Rotation {
        /// Reason.
        reason: String,
    },
    /// An equilibrium at which the centrifugal force softens a body more than it is stiff.
    #[error(
        "at a load fraction of {fraction} the centrifugal force softens the body more than it is stiff, so the equilibrium is \
         unstable for an observer that turns with it: take a lower speed",
        fraction = short(.fraction)
    )]
    Softened {
        /// Load fraction of the increment.
        fraction: f64,
    },
    /// Something that a team of ranks does not compute.
    #[error("{what} is not possible on a team")]
    NotOnTeam {
        /// The rejected request.
        what: String,
    },
    /// An error of one rank of a team, reported by all.
    #[error("rank {rank}: {message}")]
    OnRank {
        /// Its number.
        rank: usize,
        /// Its message.
        message: String,
    },
    /// An observer of a march that failed.
    #[error("{message}")]
    Observer {
        /// Message of its error.
        message: String,
    },
    /// More natural modes than the body has degrees of freedom.
    #[error(
        "{} requested, but the body has {}",
        if *.count == 1 { "1 mode was".to_string() } else { format!("{count} modes were") },
        if *.free == 0 { "no free degree of freedom".to_string() } else {
            format!("only {free}, one for each free degree of freedom")
        }
    )]
    TooManyModes {
        /// Number of modes that are wanted.
        count: usize,
        /// Number of free degrees of freedom.
        free: usize,
    },
    /// Natural modes that were not found: the relative residual of one is too large, or infinite if one is missing.
    #[error(
        "the search for {count} natural mode{} did not converge: the largest relative residual is {residual:.1e}, more than \
         {limit:e}",
        if *.count == 1 { "" } else { "s" }
    )]
    Modes {
        /// Number of modes that are wanted.
        count: usize,
        /// Largest relative residual.
        residual: f64,
        /// Largest relative residual of a mode.
        limit: f64,
    },
    /// A linear system that could not be factorised or solved.
    #[error("linear solver: {reason}")]
    Linear {
        /// Reason.
        reason: String,
    },
}

/// `1 iteration`, `2 iterations`.
fn counted(n: usize) -> String {
    format!("{n} iteration{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_the_digits_and_the_advice_that_are_meant() {
        let error = Error::StepTooLarge {
            step: 3,
            time: 0.00045000000000000004,
            step_size: 0.00029296875000000003,
            critical: 9.497169926235665e-8,
            limit: 1.0 / 3.0,
        };
        let message = error.to_string();
        for part in ["t = 0.00045:", "0.000292969 is", "critical step is 9.49717e-8 now", "at most 0.333333,"]
        {
            assert!(message.contains(part), "{message}");
        }
        let cause = Box::new(Error::Refused { reason: "no".into() });
        let smallest = |has_cells| Error::SmallestStep {
            step: 1,
            start: 0.0,
            step_size: 0.5,
            has_cells,
            cause: cause.clone(),
        };
        assert!(smallest(true).to_string().contains("a finer mesh"));
        let passed = Box::new(Error::Passed { contact: "floor".into(), at: [0.0, 0.5, 1.0] });
        let failed = Error::StepFailed { step: 1, time: 0.5, has_cells: true, cause: passed.clone() };
        let passing = "in contact \"floor\" something would pass near [0, 0.5, 1]";
        assert!(
            failed.to_string().ends_with(&format!("cannot be solved: {passing}; try a smaller step")),
            "{failed}"
        );
        let no_equilibrium =
            |cause: Box<Error>| Error::NoEquilibrium { fraction: 0.5, increment: 0.1, cause };
        for error in [
            Error::SmallestStep {
                step: 1,
                start: 0.0,
                step_size: 0.5,
                has_cells: true,
                cause: passed.clone(),
            },
            Error::SmallestStep {
                step: 1,
                start: 0.0,
                step_size: 0.5,
                has_cells: true,
                cause: Box::new(failed),
            },
            no_equilibrium(passed),
        ] {
            assert!(error.to_string().contains(&format!("; {passing}: try")), "{error}");
        }
        let no_balance = Error::NotBalanced {
            fraction: 0.6,
            iterations: 9,
            residual: 1.0,
            target: 1e-9,
            node: 3,
            position: [1.0; 3],
            contact: Some("floor".into()),
        };
        assert!(no_balance.to_string().ends_with("near [1, 1, 1] in contact \"floor\""), "{no_balance}");
        let message = no_equilibrium(Box::new(no_balance)).to_string();
        assert!(message.contains("buckle there, or slide in contact \"floor\": try"), "{message}");
        assert!(!smallest(false).to_string().contains("mesh"));
        let names = |names: &str| names.chars().map(String::from).collect::<Vec<_>>();
        for (driven, expected) in [
            (
                "",
                "open by 1.000e-1, most at \"x\" and \"y\"; the mechanism may be at a dead point: try other step sizes",
            ),
            (
                "x",
                ", most at \"x\" and \"y\"; the given motion of \"x\" contradicts other joints, or the mechanism is",
            ),
            (
                "xy",
                "open by 1.000e-1: the given motions of \"x\" and \"y\" contradict each other, or the mechanism is",
            ),
            (
                "abcdefgh",
                ": the given motions of \"a\", \"b\", \"c\", \"d\", \"e\", \"f\" and 2 more contradict each",
            ),
        ] {
            let (joints, driven) = (names("xy"), names(driven));
            let lost =
                Error::ConstraintsLost { step: 1, time: 0.5, residual: 0.1, joints, driven }.to_string();
            assert!(lost.contains(expected), "{lost}");
        }
        let position = [1e20, 0.1 + 0.2, -1.0];
        let error = Error::NotANumber { step: 1, time: 1e-300, node: 7, position };
        assert!(
            error.to_string().contains("t = 1e-300: the forces at node 7 near [1e20, 0.3, -1]"),
            "{error}"
        );
    }
}
