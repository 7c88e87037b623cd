//! Builder of a body: the mesh first, then regions, supports and loads.

use std::borrow::Borrow;
use std::sync::{Arc, OnceLock};

use super::system::Body;
use crate::error::{Error, Result};
use crate::force::{FieldLoad, LoadVector, Pressure, Term, cells, ground};
use crate::input::{GroundSpring, Load, PointTerms, Region, Support};
use crate::mass::{RegionOfCell, Spread, points, regions, spread};
use crate::mesh::{Cell, Mesh, Share};
use crate::space::InternalNodes;
use crate::space::geometry::MassKind;
use crate::space::supports::{Constraints, supported_groups};
use crate::sparse::Pattern;
use crate::team::{Subdomain, Team};

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
    team: Option<TeamPart>,
}

impl BodyBuilder {
    fn new(mesh: Mesh, team: Option<TeamPart>) -> Self {
        let (regions, supports, loads) = (Vec::new(), Vec::new(), Vec::new());
        BodyBuilder { mesh, regions, point_terms: PointTerms::default(), supports, loads, drag: 0.0, team }
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

    /// The body. Nodes of plane cells are fixed along z.
    ///
    /// # Errors
    /// [`crate::Error::UnknownGroup`], [`crate::Error::RegionCover`] if the regions do not cover the cells,
    /// [`crate::Error::NotPositive`] for a density, [`crate::Error::InvertedCell`], [`crate::Error::NotFinite`] for a
    /// load, [`crate::Error::PressureInside`], [`crate::Error::Support`], [`crate::Error::NoMass`] for a node without mass that is free to move,
    /// [`crate::Error::Viscosity`] unless the drag is finite and not negative; on a team [`crate::Error::NotOnTeam`], and
    /// [`crate::Error::OnRank`] for an error of one rank.
    pub fn build(self) -> Result<Body> {
        let part = self.team.as_ref().map(|part| &*part.subdomain);
        let mut sizes = spread::sizes(&self.mesh, &self.regions, &self.point_terms.spread, part);
        let Some(TeamPart { subdomain, rank }) = &self.team else { return Body::from_parts(self, &sizes) };
        let subdomain = subdomain.clone();
        subdomain.check_partition()?;
        if !sizes.is_empty() {
            subdomain.sum("sizes of groups with a mass", &mut sizes);
        }
        let own = match (*rank, subdomain.rank()) {
            (given, rank) if given == rank => Ok(()),
            (given, rank) => {
                Err(Error::NotOnTeam { what: format!("the share of rank {given} on rank {rank}") })
            }
        };
        Ok(subdomain.agree(own.and_then(|()| Body::from_parts(self, &sizes)))?.with_sums_of_ranks())
    }
}

/// Loads and ground of a body, which act on a kind of its mass.
struct External {
    loads: Arc<Vec<LoadVector>>,
    fields: Arc<Vec<FieldLoad>>,
    ground: Arc<Vec<Box<dyn Term>>>,
}

/// The part of a rank.
#[derive(Debug)]
struct TeamPart {
    subdomain: Arc<Subdomain>,
    /// The rank that the share was made for.
    rank: usize,
}

impl Body {
    /// A builder of the body of a mesh.
    pub fn builder(mesh: Mesh) -> BodyBuilder {
        BodyBuilder::new(mesh, None)
    }

    /// A builder of the part of a body that a rank of a team computes. All ranks build their parts together, from the same
    /// regions, supports and loads; an error of one is an error of all.
    ///
    /// Teams compute motions and equilibria; modes and adjoints are rejected. A factorisation is one of the team
    /// ([`Team::engine`]); a team without one rejects [`Solver::Direct`], and steps in which projected volumes are so stiff
    /// that they need one. All ranks must call a method together if it sums over the body, such as
    /// [`Body::strain_energy`]. Nodal vectors belong to the nodes of the share; at guests only displacements and velocities
    /// are defined.
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
        let Share { mesh, n_own, n_nodes_of_ranks, nodes, cells, counts, neighbours, rank } = share;
        let subdomain =
            Arc::new(Subdomain::new(team, [n_own, n_nodes_of_ranks], nodes, (cells, counts), neighbours));
        BodyBuilder::new(mesh, Some(TeamPart { subdomain, rank }))
    }

    fn from_parts(parts: BodyBuilder, sizes: &[f64]) -> Result<Self> {
        let BodyBuilder { mesh, regions, point_terms: nodal, supports, loads, drag, team } = parts;
        if !(drag >= 0.0 && drag.is_finite()) {
            return Err(Error::Viscosity { name: "drag", value: drag });
        }
        let of_cell = RegionOfCell::new(&mesh, &regions)?;
        let section = of_cell.sections(&mesh, &regions);
        let density_of_cell = of_cell.densities(&mesh, &regions);
        let point_masses = points::point_masses(&mesh, &nodal.masses)?;
        let spread = Spread::new(&mesh, &nodal.spread, sizes)?;
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
        let counts = |cell: u32| team.as_ref().is_none_or(|team| team.subdomain.counts()[cell as usize]);
        let internal = InternalNodes::new(&mesh, &regions, of_cell.indices(), counts);
        let has_pressures = cells::check_terms(&mesh, &regions, of_cell.indices())?;
        let n_own = team.as_ref().map_or(mesh.n_nodes(), |team| team.subdomain.n_own);
        // Internal nodes couple with their cell alone: eliminated first, they are condensed without fill.
        let pattern = couplings(&mesh, &internal).with_inner_from(mesh.n_nodes());
        // One part per thread; fewer if there is too little to share.
        let n_parts = rayon::current_num_threads().min(n_own / 64).max(1);
        // Rows of guests lie between the others of cells with internal nodes, and mean nothing.
        let has_rows_after_guests = team.is_none() || !internal.dofs().is_empty();
        let n_rows = if has_rows_after_guests { internal.n_all() } else { n_own };
        let parts = pattern.divided_until(n_rows, n_parts);
        let mut regions_and_masses = regions::summaries(&mesh, &regions, &of_cell, counts);
        for mass in &nodal.masses {
            regions_and_masses.push(points::summary(&mesh, mass, n_own)?);
        }
        let part = team.as_ref().map(|team| &*team.subdomain);
        regions_and_masses.extend(spread.summaries(&mesh, &section, &nodal.spread, part));
        let own_nodes = team.as_ref().map(|_| n_own);
        let acting_on = |kind: MassKind| -> Result<External> {
            let attracted = if nodal.attractions.is_empty() { Vec::new() } else { masses(kind) };
            let mut ground = ground::ground_terms(&mesh, &nodal, &section, &attracted, n_own)?;
            ground.iter_mut().for_each(|term| term.attach(&pattern, &parts));
            let (mut vectors, mut fields) = (Vec::new(), Vec::new());
            let others = other_masses(kind);
            let tables = |masses| (&section[..], &density_of_cell[..], masses);
            for (index, load) in loads.iter().enumerate() {
                vectors.extend(LoadVector::new(&mesh, index, load, tables(&others[..]), kind, own_nodes)?);
                let tables = tables(&point_masses[..]);
                fields.extend(FieldLoad::new(&mesh, index, load, tables, (&spread, kind))?);
            }
            Ok(External { loads: Arc::new(vectors), fields: Arc::new(fields), ground: Arc::new(ground) })
        };
        let External { loads: vectors, fields, ground } = acting_on(MassKind::Consistent)?;
        let acts_on_mass = !nodal.attractions.is_empty() || loads.iter().any(|load| load.kind.acts_on_mass());
        let has_quadratic_cells = mesh.cells().any(|cell| cell.nodes.len() > cell.kind.n_corners());
        let on_lumped_mass =
            (acts_on_mass && has_quadratic_cells).then(|| acting_on(MassKind::Lumped)).transpose()?;
        let mut followers = Vec::new();
        for (index, load) in loads.iter().enumerate() {
            followers.extend(Pressure::new(&mesh, &pattern, index, load, &section)?);
        }
        let constraints = Constraints::new(&mesh, &internal, supports.iter().enumerate())?;
        let inactive = constraints.inactive(n_own..mesh.n_nodes());
        points::check_masses(&mesh, &lumped_mass, &inactive)?;
        let has_plane_cells = mesh.cells().any(|cell| cell.kind.dimension() == 2);
        lumped_mass.resize(internal.n_all(), 0.0);
        let mut mass = regions::mass(&mesh, &pattern, &density_of_cell, &point_masses);
        spread.add_to(&mesh, &section, &pattern, &mut mass);
        let body = Body {
            loads: vectors,
            fields,
            pressures: Arc::new(followers),
            release: None,
            drag,
            viscous_time: 0.0,
            held_axes: constraints.held_axes(),
            inactive,
            fixed: constraints.fixed,
            drives: constraints.drives,
            supported: supported_groups(&mesh, &supports, nodal.springs.iter(), |_| true)?,
            mass: Arc::new(mass),
            lumped_mass,
            regions: regions_and_masses,
            region_of_cell: of_cell.into_indices(),
            made_of: Arc::new(regions),
            node_order: Arc::new(OnceLock::new()),
            terms: Arc::new(OnceLock::new()),
            has_pressures,
            has_plane_cells,
            n_dofs_of_ranks: internal.dofs().end,
            subdomain: team.map(|team| team.subdomain),
            ground,
            lumped: None,
            pattern: Arc::new(pattern),
            parts,
            internal: Arc::new(internal),
            mesh: Arc::new(mesh),
        };
        let body = Body { viscous_time: body.own_viscous_time(), ..body };
        let lumped = on_lumped_mass.map(|External { loads, fields, ground }| {
            let body = Body { loads, fields, ground, ..body.clone() };
            body.with_releases(&supports, &nodal.springs).map(Box::new)
        });
        Ok(Body { lumped: lumped.transpose()?, ..body.with_releases(&supports, &nodal.springs)? })
    }

    /// The body and its successors after each release of a support, which share its tables.
    fn with_releases(self, supports: &[Support], springs: &[GroundSpring]) -> Result<Self> {
        let mut times: Vec<f64> = supports.iter().filter_map(|support| support.until).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        let mut release = None;
        for &time in times.iter().rev() {
            let holds = |support: &Support| support.until.is_none_or(|until| until > time);
            let held = supports.iter().enumerate().filter(|(_, support)| holds(support));
            let constraints = Constraints::new(&self.mesh, &self.internal, held)?;
            let supported = supported_groups(&self.mesh, supports, springs.iter(), holds)?;
            let (inactive, held_axes) = (constraints.inactive(self.guests()), constraints.held_axes());
            points::check_masses(&self.mesh, &self.lumped_mass, &inactive)?;
            let Constraints { fixed, drives } = constraints;
            let body = Body { fixed, inactive, held_axes, drives, supported, release, ..self.clone() };
            release = Some((time, Box::new(body)));
        }
        Ok(Body { release, ..self })
    }
}

/// The pattern of the nodes that cells couple.
fn couplings(mesh: &Mesh, internal: &InternalNodes) -> Pattern {
    if internal.dofs().is_empty() {
        return Pattern::new(internal.n_all(), mesh.cells().map(|cell| cell.nodes));
    }
    let nodes = |(index, cell): (usize, Cell<'_>)| -> Vec<u32> {
        cell.nodes.iter().copied().chain(internal.of_cell(index as u32)).collect()
    };
    let lists: Vec<Vec<u32>> = mesh.cells().enumerate().map(nodes).collect();
    Pattern::new(internal.n_all(), lists.iter().map(Vec::as_slice))
}
