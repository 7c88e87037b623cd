//! Builder of a body: the mesh first, then regions, supports and loads.

mod added_nodes;
mod contacts;

use std::borrow::Borrow;
use std::sync::{Arc, OnceLock};

use super::couplings;
use super::system::Body;
use crate::error::{Error, Result};
use crate::force::{Drag, Force, ForceSource, Forces, Site, cells, dead};
use crate::input::{Contact, Coupling, Joint, Load, PointTerms, Region, RigidBody, Support, Tie};
use crate::mass::{RegionOfCell, Spread, points, regions, spread};
use crate::mesh::{Mesh, Share};
use crate::space::geometry::MassKind;
use crate::space::{InternalNodes, Space, Supports, Ties};

use crate::team::{Alone, Subdomain, Team};
use crate::unknowns::{Frame, Mechanism};

/// Collects the parts of a body; [`BodyBuilder::build`] checks them against the mesh.
///
/// ```
/// use emmy::prelude::*;
/// let body = Body::builder(mesh::block([1.0, 2.0, 1.0], [2, 4, 2])?)
///     .region(Region::new(NeoHooke::new(1000.0, 500.0)?, 1.1))
///     .support(Support::fixed("y-min"))
///     .load(Load::acceleration([0.0, 0.0, -9.81]))
///     .build()?;
/// assert_eq!((body.n_dofs(), body.n_free_dofs()), (135, 108));
/// # Ok::<(), emmy::Error>(())
/// ```
#[derive(Debug)]
pub struct BodyBuilder {
    mesh: Mesh,
    regions: Vec<Region>,
    point_terms: PointTerms,
    supports: Vec<Support>,
    loads: Vec<Load>,
    drag: f64,
    forces: Vec<Arc<dyn ForceSource>>,
    ties: Vec<Tie>,
    couplings: Vec<Coupling>,
    rigid: Vec<RigidBody>,
    joints: Vec<Joint>,
    contacts: Vec<Contact>,
    ranks: Arc<Subdomain>,
    /// The rank that the share was made for.
    rank: usize,
}

impl BodyBuilder {
    fn new(share: Share, team: Arc<dyn Team>) -> Self {
        let Share { mesh, n_own, n_nodes_of_ranks, nodes, cells, counts, neighbours, rank } = share;
        let ranks = Subdomain::new(team, [n_own, n_nodes_of_ranks], nodes, (cells, counts), neighbours);
        let (regions, supports, loads) = (Vec::new(), Vec::new(), Vec::new());
        let (point_terms, ranks) = (PointTerms::default(), Arc::new(ranks));
        BodyBuilder {
            mesh,
            regions,
            point_terms,
            supports,
            loads,
            drag: 0.0,
            forces: Vec::new(),
            ties: Vec::new(),
            couplings: Vec::new(),
            rigid: Vec::new(),
            joints: Vec::new(),
            contacts: Vec::new(),
            ranks,
            rank,
        }
    }

    /// Adds a region. The regions together cover every cell exactly once.
    pub fn region(mut self, region: Region) -> Self {
        self.regions.push(region);
        self
    }

    /// Adds regions.
    pub fn regions(mut self, regions: impl IntoIterator<Item = Region>) -> Self {
        self.regions.extend(regions);
        self
    }

    /// Adds a support.
    pub fn support(mut self, support: Support) -> Self {
        self.supports.push(support);
        self
    }

    /// Adds supports.
    pub fn supports(mut self, supports: impl IntoIterator<Item = impl Borrow<Support>>) -> Self {
        self.supports.extend(supports.into_iter().map(|support| support.borrow().clone()));
        self
    }

    /// Adds a load. Loads are superposed.
    pub fn load(mut self, load: Load) -> Self {
        self.loads.push(load);
        self
    }

    /// Adds loads.
    pub fn loads(mut self, loads: impl IntoIterator<Item = impl Borrow<Load>>) -> Self {
        self.loads.extend(loads.into_iter().map(|load| load.borrow().clone()));
        self
    }

    /// Adds a tie: nodes that follow others.
    pub fn tie(mut self, tie: Tie) -> Self {
        self.ties.push(tie);
        self
    }

    /// Adds ties.
    pub fn ties(mut self, ties: impl IntoIterator<Item = impl Borrow<Tie>>) -> Self {
        self.ties.extend(ties.into_iter().map(|tie| tie.borrow().clone()));
        self
    }

    /// Adds a distributing coupling: a point that follows a group. Its name becomes a group of the mesh, of this node.
    pub fn coupling(mut self, coupling: Coupling) -> Self {
        self.couplings.push(coupling);
        self
    }

    /// Adds a rigid body: a group of the mesh, or one without cells. Its name becomes a group of the mesh: the node of
    /// its centre, at which supports, masses and forces act. A node for each of three axes follows; initial velocities
    /// of the group move all.
    pub fn rigid(mut self, body: RigidBody) -> Self {
        self.rigid.push(body);
        self
    }

    /// Adds a joint between rigid bodies, nodes and the ground.
    pub fn joint(mut self, joint: Joint) -> Self {
        self.joints.push(joint);
        self
    }

    /// Adds a contact. An obstacle that moves adds a node to the mesh, after those of rigid bodies, and a group of this
    /// node, [`Contact::group_of_obstacle`].
    pub fn contact(mut self, contact: Contact) -> Self {
        self.contacts.push(contact);
        self
    }

    /// Adds contacts.
    pub fn contacts(mut self, contacts: impl IntoIterator<Item = impl Borrow<Contact>>) -> Self {
        self.contacts.extend(contacts.into_iter().map(|contact| contact.borrow().clone()));
        self
    }

    /// Sets the masses and forces at single nodes.
    pub fn point_terms(mut self, terms: PointTerms) -> Self {
        self.point_terms = terms;
        self
    }

    /// Sets the drag of a surrounding medium, an external force `f = -rate M v` \[1/time\]. Alone it makes velocities
    /// decay like `exp(-rate t)`.
    pub fn drag(mut self, rate: f64) -> Self {
        self.drag = rate;
        self
    }

    /// Adds a force of a kind of its own.
    #[doc(hidden)]
    pub fn force(mut self, source: impl ForceSource + 'static) -> Self {
        self.forces.push(Arc::new(source));
        self
    }

    /// The body. Nodes of plane cells are fixed along z.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`], [`crate::Error::RegionCover`] if the regions do not cover the cells,
    /// [`crate::Error::NotPositive`] for a density, [`crate::Error::InvertedCell`],
    /// [`crate::Error::NotFinite`] for a load, [`crate::Error::PressureInside`], [`crate::Error::Support`],
    /// [`crate::Error::Tie`], [`crate::Error::Contact`], [`crate::Error::Coupling`], [`crate::Error::Inertia`],
    /// [`crate::Error::Rigid`], [`crate::Error::Joint`], [`crate::Error::Moment`], [`crate::Error::Rotation`],
    /// [`crate::Error::GroupExists`] for a rigid body named as a group, [`crate::Error::NoMass`] for a node
    /// without mass that is free to move, [`crate::Error::Viscosity`] unless the drag is finite and not
    /// negative; on a team [`crate::Error::NotOnTeam`], and [`crate::Error::OnRank`] for an error of one
    /// rank.
    pub fn build(mut self) -> Result<Body> {
        let ranks = self.ranks.clone();
        ranks.check_partition()?;
        let is_mechanism = !(self.rigid.is_empty() && self.joints.is_empty());
        if ranks.size() > 1 && (is_mechanism || !self.ties.is_empty() || !self.couplings.is_empty()) {
            let what = "a body with ties, couplings, rigid bodies or joints".to_string();
            return Err(Error::NotOnTeam { what });
        }
        if ranks.size() > 1 && !self.contacts.is_empty() {
            return Err(Error::NotOnTeam { what: "a body with contact".to_string() });
        }
        contacts::check_names(&self.contacts, &self.supports, &self.point_terms.springs)?;
        contacts::check_overlaps(&self.mesh, &self.contacts)?;
        let points = self.points()?;
        let frames = self.frames()?;
        contacts::check_motion(&self.mesh, &self.contacts, &self.supports)?;
        let has_obstacles = self.obstacles()?;
        if has_obstacles || !(points.is_empty() && frames.is_empty()) {
            let [n_nodes, n_cells] = [self.mesh.n_nodes(), self.mesh.n_cells()];
            self.ranks = Arc::new(Subdomain::whole(ranks.team().clone(), n_nodes, n_cells));
        }
        let groups = frames.iter().filter(|frame| frame.has_members());
        let followers = groups.map(|frame| frame.followers(&self.mesh)).collect();
        let held = self.held_nodes()?;
        let ties = Ties::new(&mut self.mesh, &self.ties, followers, (points, &held))?;
        for frame in &frames {
            if frame.nodes().any(|node| ties.leaders_of(node).is_some()) {
                let reason = "a tie makes it follow others; join it to them instead".to_string();
                return Err(Error::Rigid { body: frame.name().to_string(), reason });
            }
        }
        let ranks = self.ranks.clone();
        let sizes = GroupSizes::new(&self);
        let own = match (self.rank, ranks.rank()) {
            (given, rank) if given == rank => Ok(()),
            (given, rank) => {
                Err(Error::NotOnTeam { what: format!("the share of rank {given} on rank {rank}") })
            }
        };
        Ok(ranks.agree(own.and_then(|()| Body::from_parts(self, &sizes, ties, frames)))?.with_sums_of_ranks())
    }
}

/// Sizes of groups on all ranks, which divide what is given for a whole group. Zeros where a group or a region is
/// invalid, which [`Body::from_parts`] reports.
struct GroupSizes {
    /// Of each mass that is spread, in two parts.
    masses: Vec<f64>,
    /// Of each load, the area that a total force acts on \[length^2\].
    loads: Vec<f64>,
}

impl GroupSizes {
    /// A call of all ranks.
    fn new(parts: &BodyBuilder) -> Self {
        let BodyBuilder { mesh, regions, point_terms, loads, ranks, .. } = parts;
        let section = RegionOfCell::new(mesh, regions).map(|of_cell| of_cell.sections(mesh, regions));
        let section = section.unwrap_or_else(|_| vec![0.0; mesh.n_cells()]);
        let mut masses = spread::sizes(mesh, &section, &point_terms.spread, ranks);
        ranks.sum("sizes of groups with a mass", &mut masses);
        let mut areas: Vec<f64> =
            loads.iter().map(|load| dead::area(mesh, load, &section, ranks.n_own())).collect();
        ranks.sum("areas of loads", &mut areas);
        GroupSizes { masses, loads: areas }
    }
}

impl Body {
    /// A builder of the body of a mesh.
    pub fn builder(mesh: Mesh) -> BodyBuilder {
        BodyBuilder::new(Share::whole(mesh), Arc::new(Alone))
    }

    /// A builder of the part of a body that a rank of a team computes. All ranks build their parts together, from the
    /// same regions, supports and loads; an error of one is an error of all.
    ///
    /// Teams compute motions and equilibria; modes and adjoints are rejected. A factorisation is one of the team
    /// ([`Team::engine`]); a team without one rejects [`Solver::Direct`], and steps in which projected volumes are so
    /// stiff that they need one. All ranks must call a method together if it sums over the body, such as
    /// [`Body::strain_energy`]. Nodal vectors belong to the nodes of the share; at guests only displacements and
    /// velocities are defined.
    ///
    /// [`Solver::Direct`]: crate::motion::Solver::Direct
    /// [`Team::engine`]: crate::team::Team::engine
    ///
    /// ```
    /// use emmy::prelude::*;
    /// use emmy::mesh::{Share, owners};
    /// use emmy::team::{Team, Threads};
    /// let mesh = mesh::block([4.0, 1.0, 1.0], [4, 1, 1])?;
    /// let owners = owners(&mesh, 2)?;
    /// let energies = Threads::run(2, |team| -> emmy::Result<f64> {
    ///     let rubber = Region::new(NeoHooke::new(1000.0, 500.0)?, 2.0);
    ///     let body = Body::shared(Share::new(&mesh, &owners, team.rank()), team).region(rubber).build()?;
    ///     let flies = InitialVelocity { velocity: [3.0, 0.0, 0.0], ..Default::default() };
    ///     let state = State::initial(&body, 0.0, &[flies])?;
    ///     let mut motion = Motion::new(&body, TimeElement::discrete_gradient(1)?)?.from(state)?;
    ///     Ok(motion.step(0.1)?.total_energy)
    /// });
    /// assert!(energies.unwrap().into_iter().all(|energy| (energy.unwrap() - 36.0).abs() < 1e-12)); // m v^2 / 2
    /// # Ok::<(), emmy::Error>(())
    /// ```
    pub fn shared(share: Share, team: Arc<dyn Team>) -> BodyBuilder {
        BodyBuilder::new(share, team)
    }

    fn from_parts(parts: BodyBuilder, sizes: &GroupSizes, ties: Ties, frames: Vec<Frame>) -> Result<Self> {
        let BodyBuilder {
            mesh,
            regions,
            point_terms: nodal,
            supports,
            loads,
            drag,
            forces,
            joints,
            contacts,
            ranks,
            ..
        } = parts;
        if !(drag >= 0.0 && drag.is_finite()) {
            return Err(Error::Viscosity { name: "drag", value: drag });
        }
        let of_cell = RegionOfCell::new(&mesh, &regions)?;
        let section = of_cell.sections(&mesh, &regions);
        let density_of_cell = of_cell.densities(&mesh, &regions);
        let mut point_masses = points::point_masses(&mesh, &nodal.masses)?;
        frames.iter().for_each(|frame| point_masses[frame.nodes().start as usize] += frame.body().mass);
        let spread = Spread::new(&mesh, &nodal.spread, &sizes.masses)?;
        // Of point masses and of those that are spread.
        let other_masses = |kind: MassKind| {
            let mut masses = point_masses.clone();
            spread.for_each_point(&mesh, &section, kind, |nodes, point| {
                let shares = nodes.iter().zip(point.shapes);
                shares.for_each(|(&node, share)| masses[node as usize] += point.weight * share);
            });
            masses
        };
        let masses = |kind: MassKind| {
            let cells = 0..mesh.n_cells() as u32;
            let mut masses = regions::nodal_masses(&mesh, cells, &density_of_cell, kind);
            masses.iter_mut().zip(other_masses(kind)).for_each(|(sum, mass)| *sum += mass);
            masses
        };
        let mut lumped_mass = masses(MassKind::Lumped);
        let counts = |cell: u32| ranks.counts()[cell as usize];
        let internal = InternalNodes::new(&mesh, &regions, of_cell.indices(), counts);
        let is_rigid = |cell: u32| {
            let nodes = mesh.cell(cell as usize).nodes;
            frames.iter().any(|frame| frame.moves(nodes, |node| ties.leaders_of(node)))
        };
        if let Some(&cell) = internal.cells().iter().find(|cell| is_rigid(**cell)) {
            let formulation = "incompatible modes".to_string();
            let reason =
                format!("it is part of a rigid body, which has no {formulation}: give it another region");
            return Err(Error::Formulation { cell: cell as usize, reason });
        }
        let has_local = cells::check(&mesh, &regions, of_cell.indices(), is_rigid)?;
        let n_own = ranks.n_own();
        // Internal nodes couple with their cell alone: eliminated first, they are condensed without fill.
        let mut mechanism = Mechanism::new(frames, joints, &mesh, |node| ties.leaders_of(node), |_| true)?;
        mechanism.divide(internal.n_all(), || couplings::of_cells(&mesh, &internal, &ties));
        let pattern =
            couplings::pattern(&mesh, &internal, &ties, &mechanism).with_inner_rows_from(mesh.n_nodes());
        // One part per thread; fewer if there is too little to share.
        let n_parts = rayon::current_num_threads().min(n_own / 64).max(1);
        // Rows of guests lie between the others of cells with internal nodes, and mean nothing.
        let n_rows = if internal.dofs().is_empty() { n_own } else { internal.n_all() };
        let parts = pattern.divided_until(n_rows, n_parts);
        let mut regions_and_masses = regions::summaries(&mesh, &regions, &of_cell, counts);
        for mass in &nodal.masses {
            regions_and_masses.push(points::summary(&mesh, mass, n_own)?);
        }
        regions_and_masses.extend(mechanism.frames.iter().map(Frame::summary));
        regions_and_masses.extend(spread.summaries(&mesh, &section, &nodal.spread, &ranks));
        let mut mass = regions::mass(&mesh, &pattern, &density_of_cell, &point_masses);
        spread.add_to(&mesh, &section, &pattern, &mut mass);
        let observers = loads.iter().filter(|load| load.kind.turns_observer()).count();
        if observers > 1 {
            let reason = "there are several such loads, and an observer turns about one axis".to_string();
            return Err(Error::Rotation { reason });
        }
        let mut mass_before_ties = if observers == 1 { mass.clone() } else { Vec::new() };
        if observers == 1 {
            mechanism.frames.iter().for_each(|frame| frame.add_inertia(&pattern, &mut mass_before_ties));
        }
        let point_terms = &nodal;
        let rigid: Vec<_> =
            mechanism.frames.iter().map(|frame| (frame.name().to_string(), frame.nodes())).collect();
        let acting_on = |kind: MassKind| -> Result<Arc<Vec<Arc<dyn Force>>>> {
            let site = Site {
                mesh: &mesh,
                pattern: &pattern,
                parts: &parts,
                n_own,
                section: &section,
                regions: &regions,
                region_of_cell: of_cell.indices(),
                density_of_cell: &density_of_cell,
                kind,
                mass: &mass_before_ties,
                masses: if point_terms.attractions.is_empty() { &[] } else { &masses(kind) },
                other_masses: &other_masses(kind),
                point_masses: &point_masses,
                spread: &spread,
                rigid: &rigid,
                areas: &sizes.loads,
            };
            let drag = Some(Drag { rate: drag }).filter(|drag| drag.rate > 0.0);
            let further = forces.iter().enumerate().map(|(number, source)| source.force(number, &site));
            let all = forces_of(&point_terms.springs, &site)
                .chain(forces_of(&contacts, &site))
                .chain(forces_of(&point_terms.attractions, &site))
                .chain(forces_of(&loads, &site))
                .chain(drag.map(|drag| Ok(Arc::new(drag) as Arc<dyn Force>)))
                .chain(further)
                .chain(mechanism.forces(&pattern).into_iter().map(Ok));
            all.collect::<Result<Vec<_>>>().map(Arc::new)
        };
        let others = acting_on(MassKind::Consistent)?;
        let acts_on_mass = !nodal.attractions.is_empty() || loads.iter().any(|load| load.kind.acts_on_mass());
        let has_quadratic_cells = mesh.cells().any(|cell| cell.nodes.len() > cell.kind.n_corners());
        let on_lumped_mass =
            (acts_on_mass && has_quadratic_cells).then(|| acting_on(MassKind::Lumped)).transpose()?;
        let guests = n_own..mesh.n_nodes();
        let of_groups = contacts::groups_of_forces(&nodal.springs, &contacts);
        let held = Supports::new(&mesh, (&internal, guests, &ties), (&supports, &of_groups), |_| true)?;
        ties.fold_lumped(&mut lumped_mass);
        points::check_masses(&mesh, &lumped_mass, &held.inactive, n_before(&mechanism.frames, &mesh))?;
        lumped_mass.resize(internal.n_all(), 0.0);
        ties.fold_mass(&pattern, &mut mass);
        mechanism.frames.iter().for_each(|frame| frame.add_inertia(&pattern, &mut mass));
        let mass = Arc::new(mass);
        let carried_mass = mechanism.carry(&pattern, &mass)?.map_or(mass.clone(), Arc::new);
        let body = Body {
            forces: Forces { cells: Arc::new(OnceLock::new()), others },
            release: None,
            viscous_time: 0.0,
            mass,
            carried_mass,
            lumped_mass,
            regions: regions_and_masses,
            region_of_cell: of_cell.into_indices(),
            made_of: Arc::new(regions),
            mechanism: Arc::new(mechanism),
            node_order: Arc::new(OnceLock::new()),
            has_local,
            lumped: None,
            pattern: Arc::new(pattern),
            parts,
            space: Space::new(Arc::new(mesh), internal, ranks, held, ties),
        };
        let lumped = on_lumped_mass.map(|others| {
            let body = Body { forces: Forces { others, ..body.forces.clone() }, ..body.clone() };
            body.with_releases(&supports, &of_groups).map(Box::new)
        });
        Ok(Body { lumped: lumped.transpose()?, ..body.with_releases(&supports, &of_groups)? })
    }

    /// The body and its successors after each release of supports and joints, which share its tables.
    fn with_releases(self, supports: &[Support], springs: &[(String, usize)]) -> Result<Self> {
        let of_supports = supports.iter().filter_map(|support| support.until);
        let mut times: Vec<f64> =
            of_supports.chain(self.joints().iter().filter_map(|joint| joint.until)).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut release = None;
        for &time in times.iter().rev() {
            let holds = |support: &Support| support.until.is_none_or(|until| until > time);
            let (mesh, internal) = (self.mesh(), self.space.internal());
            let nodes = (&**internal, self.space.guests(), self.space.ties());
            let held = Supports::new(mesh, nodes, (supports, springs), holds)?;
            points::check_masses(
                mesh,
                &self.lumped_mass,
                &held.inactive,
                n_before(&self.mechanism.frames, mesh),
            )?;
            let (mechanism, forces) = self.without_joints(time)?;
            let space = self.space.with_supports(held);
            release = Some((time, Box::new(Body { space, mechanism, forces, release, ..self.clone() })));
        }
        Ok(Body { release, ..self })
    }

    /// Mechanism and forces without the joints that are released by a time.
    fn without_joints(&self, time: f64) -> Result<(Arc<Mechanism>, Forces)> {
        let Body { mechanism, forces, .. } = self;
        let holds = |joint: &Joint| joint.until.is_none_or(|until| until > time);
        if mechanism.joints.iter().all(holds) {
            return Ok((mechanism.clone(), forces.clone()));
        }
        let ties = self.space.ties();
        let rest = mechanism.with_joints(self.mesh(), |node| ties.leaders_of(node), holds)?;
        Ok(self.with_mechanism(forces, rest))
    }

    /// Another mechanism in the place of the present one, and some forces of the body with those of its joints.
    pub(super) fn with_mechanism(&self, forces: &Forces, other: Mechanism) -> (Arc<Mechanism>, Forces) {
        let Body { mechanism, pattern, .. } = self;
        let n_others = forces.others.len() - mechanism.forces(pattern).len();
        let others = forces.others[..n_others].iter().cloned().chain(other.forces(pattern)).collect();
        (Arc::new(other), Forces { others: Arc::new(others), ..forces.clone() })
    }
}

/// Number of nodes before those of some frames, which come last.
fn n_before(frames: &[Frame], mesh: &Mesh) -> usize {
    frames.first().map_or(mesh.n_nodes(), |frame| frame.nodes().start as usize)
}

/// The forces of some sources of one kind.
fn forces_of<'a>(
    sources: &'a [impl ForceSource],
    site: &'a Site<'a>,
) -> impl Iterator<Item = Result<Arc<dyn Force>>> + 'a {
    sources.iter().enumerate().map(|(number, source)| source.force(number, site))
}
