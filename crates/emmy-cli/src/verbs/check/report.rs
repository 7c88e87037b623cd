//! The report of `emmy check`: a line for each fact.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt::Write;

use emmy::body::{
    Body, Coupling, InitialVelocity, Load, LoadKind, LoadResultant, PointMass, PointTerms, RegionSummary,
    Support, TieKind, TimeFunction, Viscosity,
};
use emmy::internals::time::CentralDifferences;
use emmy::mesh::{Worst, quality};
use emmy::motion::{Adaptivity, State};
use emmy::time::Scheme;
use emmy_io::input::{Problem, Start, shift_of_followers};
use emmy_io::message::{counted, shown};
use emmy_io::units::Units;

use crate::print::{number, vector};
use crate::verbs::sizes;

/// Largest number of parts that are listed.
const MAX_LISTED_PARTS: usize = 10;

/// Lines under key words.
#[derive(Debug, Default)]
pub(crate) struct Report {
    pub(super) text: String,
    pub(super) units: Units,
    /// Notes beside the report.
    pub(in crate::verbs) notes: Vec<String>,
}

impl Report {
    pub(crate) fn line(&mut self, word: &str, text: &str) {
        let _ = writeln!(self.text, "{word:<11}{}", shown(text));
    }

    pub(super) fn mesh(&mut self, body: &Body) {
        let mesh = body.mesh();
        if mesh.n_cells() == 0 {
            return self.line("mesh", "none: all bodies are rigid");
        }
        let counts = mesh.counts_by_kind();
        let kinds: Vec<String> = counts.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        // Those of couplings and rigid bodies come after the others.
        let rigid = body.rigid_bodies().next().and_then(|own| body.nodes_of_rigid_body(&own.name));
        let point = body.couplings().first().map(|point| point.node);
        let n_nodes = point.or(rigid.map(|nodes| nodes.start)).map_or(mesh.n_nodes(), |first| first as usize);
        let nodes = counted(n_nodes, "node", "nodes");
        let cells = counted(mesh.n_cells(), "cell", "cells");
        self.line("mesh", &format!("{nodes}, {cells} ({})", kinds.join(", ")));
        let quality = quality(mesh);
        for (name, worst) in [
            ("smallest det J ratio", quality.jacobian_ratio),
            ("smallest scaled Jacobian", quality.scaled_jacobian),
            ("largest aspect ratio", quality.aspect_ratio),
        ] {
            let Worst { value, cell } = worst;
            self.line("quality", &format!("{name} {value:.4} (cell {cell}, {})", mesh.cell(cell).kind));
        }
    }

    pub(super) fn groups(&mut self, body: &Body) {
        let mesh = body.mesh();
        let groups = mesh.groups();
        for name in groups.names() {
            let is_point = body.couplings().iter().any(|point| point.name == name);
            if is_point || body.nodes_of_rigid_body(name).is_some() {
                continue;
            }
            let cells = groups.cells.get(name).map(|cells| counted(cells.len(), "cell", "cells"));
            let facets = groups.facets.get(name).map(|facets| counted(facets.len(), "facet", "facets"));
            // Nodes of its own, which `nodes:NAME` chooses, else those of its members.
            let own = groups.nodes.get(name).map(Vec::len);
            let n_nodes = own.or_else(|| mesh.group_nodes(name).map(|nodes| nodes.len()).ok());
            let nodes = match n_nodes {
                Some(0) if cells.is_none() && facets.is_none() => Some("no nodes of cells".to_string()),
                n_nodes => n_nodes.map(|n| counted(n, "node", "nodes")),
            };
            let sizes: Vec<String> = [cells, facets, nodes].into_iter().flatten().collect();
            self.line("group", &format!("{name}: {}", sizes.join(", ")));
        }
    }

    pub(super) fn body(&mut self, problem: &Problem) {
        let body = &problem.body;
        let all = body.n_dofs();
        let free = body.n_free_dofs();
        let given = if body.is_driven() { "fixed or driven" } else { "fixed" };
        let tied = 3 * body.n_followers();
        let of_ties = if tied > 0 { format!(", {tied} tied") } else { String::new() };
        let held = all - free - tied;
        self.line("dofs", &format!("{all} degrees of freedom, {held} {given}{of_ties}, {free} free"));
        let of_cells = all - body.mesh().n_dofs();
        if of_cells > 0 {
            self.line("", &format!("{of_cells} of them in the incompatible modes of cells, without mass"));
        }
        self.parts(body);
        let name = |region: &RegionSummary| region.group.clone().unwrap_or_else(|| "all cells".to_string());
        let n_masses = problem.nodal.masses.len() + problem.nodal.spread.len();
        let n_rigid = problem.rigid.len();
        let n_regions = body.regions().len() - n_masses - n_rigid;
        let (regions, masses) = body.regions().split_at(n_regions);
        regions.iter().for_each(|region| self.region("region", &name(region), region));
        // Point masses come before rigid bodies, and masses that are spread behind them.
        let (points, masses) = masses.split_at(problem.nodal.masses.len());
        let (rigid, spread) = masses.split_at(n_rigid);
        for (own, summary) in problem.rigid.iter().zip(rigid) {
            match &own.group {
                Some(group) => self.rigid_group(body, [&own.name, group], summary, own.inertia.is_none()),
                None => self.rigid_body(["rigid", &own.name], summary, own.inertia.is_none()),
            }
        }
        for (index, masses) in points.iter().chain(spread).enumerate() {
            self.mass(&name(masses), masses);
            if let Some(PointMass { group, mass }) = problem.nodal.masses.get(index) {
                self.nodal_mass(body, group, *mass, masses);
            }
        }
        if body.regions().len() > 1 {
            let whole = RegionSummary::combined(body.regions());
            match body.mesh().n_cells() {
                0 => self.rigid_body(["body", "all"], &whole, false),
                _ => self.region("body", "all regions", &whole),
            }
        }
        problem.formulations.lines.iter().for_each(|line| self.line("cells", line));
        for (load, resultant) in problem.loads.iter().zip(body.load_resultants()) {
            self.load(load, &resultant, body);
        }
        problem.supports.iter().for_each(|support| self.support(support, problem));
        self.ground(&problem.nodal);
        self.ties(body);
        self.contacts(body);
        problem.couplings.iter().for_each(|coupling| self.coupling(coupling, body));
        self.mechanism(problem);
        self.damping(body);
    }

    fn coupling(&mut self, coupling: &Coupling, body: &Body) {
        let Coupling { name, group, point, .. } = coupling;
        let nodes = counted(body.mesh().group_nodes(group).map_or(0, |nodes| nodes.len()), "node", "nodes");
        let point = self.units.vector(*point, "length");
        self.line("coupling", &format!("{name}: the point {point} follows the mean of {nodes} of `{group}`"));
    }

    /// The critical step of central differences while contacts press, if there are any.
    pub(super) fn stability_in_contact(&mut self, problem: &Problem, state: Option<&State>) {
        let body = &problem.body;
        let rest = vec![0.0; body.n_dofs()];
        let displacement = state.map_or(&rest, |state| &state.displacement);
        let pressed = CentralDifferences::critical_step_in_contact(body, displacement).ok().flatten();
        if let Some(step) = pressed {
            let units = problem.units;
            let text = format!(
                "at least {} where layers of contact are pressed to half of their thickness",
                units.number(step, "time")
            );
            self.line("", &text);
        }
    }

    /// Contacts, with their layers, the smallest gap and the stored energy in the reference configuration.
    fn contacts(&mut self, body: &Body) {
        for contact in body.contacts() {
            let facets = counted(contact.n_facets, "facet", "facets");
            let points = counted(contact.n_points, "point", "points");
            let units = self.units;
            let area = units.number(contact.area, "length²");
            let distance = units.number(contact.distance, "length");
            let stiffness = units.number(contact.stiffness, "stress");
            let gap = match contact.smallest_gap.is_finite() {
                true => format!("smallest gap {}", units.number(contact.smallest_gap, "length")),
                false => "no gap is near".to_string(),
            };
            let of_bodies = match contact.n_triangles {
                0 => String::new(),
                n => {
                    let sharp = counted(contact.n_sharp_edges, "sharp edge", "sharp edges");
                    format!(", {}, {sharp}", counted(n, "triangle", "triangles"))
                }
            };
            self.line("contact", &format!("{}: {facets}, {points}{of_bodies}, area {area}", contact.name));
            let energy = match contact.energy > 0.0 {
                true => format!(
                    "stored energy {}: it pushes from the start",
                    units.number(contact.energy, "energy")
                ),
                false => "stored energy 0".to_string(),
            };
            self.line("", &format!("layer of distance {distance}, stiffness {stiffness}; {gap}, {energy}"));
        }
    }

    /// Ties, with the largest shift of their followers.
    fn ties(&mut self, body: &Body) {
        for tie in body.ties() {
            let nodes = counted(tie.n_followers, "node", "nodes");
            let follow = if tie.n_followers == 1 { "follows" } else { "follow" };
            let shift = shift_of_followers(body, tie).map(|shift| self.units.number(shift, "length"));
            let shift = shift.map_or(String::new(), |shift| format!(", shifted by up to {shift}"));
            let kind = match tie.kind {
                TieKind::Mortar => " by mortar",
                TieKind::Nodes => "",
            };
            let free = if tie.n_free > 0 { format!(", {} stay free", tie.n_free) } else { String::new() };
            self.line(
                "tie",
                &format!("{nodes} of {} {follow} {}{kind}{shift}{free}", tie.follower, tie.leader),
            );
        }
    }

    /// Drag and viscosity.
    fn damping(&mut self, body: &Body) {
        if body.drag() > 0.0 {
            let rate = self.units.number(body.drag(), "1/time");
            self.line("load", &format!("drag on all masses: rate {rate}"));
        }
        for (viscosity, region) in body.viscosities().zip(body.regions()).filter(|(v, _)| !v.is_zero()) {
            let group = region.group.as_deref().unwrap_or("all cells");
            let Viscosity { time, shear, bulk } = *viscosity;
            let time = self.units.number(time, "time");
            let [shear, bulk] = [shear, bulk].map(|viscosity| self.units.number(viscosity, "stress·time"));
            self.line("viscosity", &format!("{group}: time {time}, shear {shear}, bulk {bulk}"));
        }
    }

    pub(super) fn start(&mut self, problem: &Problem, state: Option<&State>) {
        match &problem.start {
            Start::Undeformed if problem.is_static() => return,
            Start::Equilibrium { load_steps } => {
                let loads = "static equilibrium under the loads and driven supports at t = 0";
                let increments = counted(*load_steps, "increment", "increments");
                self.line("start", &format!("{loads}, in {increments}"));
            }
            Start::Run(directory) => {
                self.line("start", &format!("last state of the run in {}", directory.display()));
            }
            Start::Undeformed if problem.initial.is_empty() => return self.line("initial", "at rest"),
            Start::Undeformed => {}
        }
        problem.initial.iter().for_each(|field| self.field(field));
        let Some(state) = state else { return };
        let momentum = match problem.scheme {
            Scheme::CentralDifferences => {
                let masses = problem.body.lumped_mass().iter().flat_map(|mass| [mass; 3]);
                Cow::Owned(masses.zip(&state.velocity).map(|(mass, v)| mass * v).collect::<Vec<f64>>())
            }
            _ => Cow::Borrowed(&state.momentum),
        };
        let products = momentum.iter().zip(&state.velocity).map(|(p, v)| p * v);
        let units = self.units;
        let kinetic_energy = units.number(products.sum::<f64>() / 2.0, "energy");
        let linear = [0, 1, 2].map(|i| momentum.iter().skip(i).step_by(3).sum());
        let angular = problem.body.moment(&state.displacement, &momentum);
        self.line("start", &format!("kinetic energy {kinetic_energy}"));
        let linear = units.vector(linear, "mass·length/time");
        self.line("", &format!("linear momentum {linear}"));
        let angular = units.vector(angular, "mass·length²/time");
        self.line("", &format!("angular momentum about the origin {angular}"));
    }

    fn field(&mut self, field: &InitialVelocity) {
        let group = field.group.as_deref().unwrap_or("all nodes");
        let velocity = self.units.vector(field.velocity, "length/time");
        let spin = self.units.vector(field.angular_velocity, "1/time");
        let about = self.units.vector(field.about, "length");
        self.line("initial", &format!("{group}: velocity {velocity}, angular velocity {spin} about {about}"));
        if field.gradient != [[0.0; 3]; 3] {
            let gradient = format!("[{}]", field.gradient.map(vector).join(", "));
            self.line("", &format!("gradient {}", self.units.with_unit(gradient, "1/time")));
        }
    }

    /// Disconnected parts of the mesh, if there are several.
    fn parts(&mut self, body: &Body) {
        let parts = body.mesh().parts();
        if parts.len() <= 1 {
            return;
        }
        let how = match (body.ties().is_empty(), body.joints().is_empty()) {
            (true, true) => "are not connected",
            (true, false) => "share no nodes",
            (false, _) => "share no nodes and are tied",
        };
        self.line("parts", &format!("{}, which {how}", parts.len()));
        for cells in parts.iter().take(MAX_LISTED_PARTS) {
            let mut counts = BTreeMap::<u32, usize>::new();
            cells
                .iter()
                .for_each(|&cell| *counts.entry(body.region_of_cell()[cell as usize]).or_default() += 1);
            let shares = counts.into_iter().map(|(region, count)| {
                let group = body.regions()[region as usize].group.as_deref();
                format!("{} of {}", counted(count, "cell", "cells"), group.unwrap_or("the body"))
            });
            let shares = shares.collect::<Vec<_>>().join(", ");
            let first = cells[0];
            self.line("", &format!("{shares}, the first is cell {first}"));
        }
        if parts.len() > MAX_LISTED_PARTS {
            self.line("", &format!("and {} more", parts.len() - MAX_LISTED_PARTS));
        }
    }

    fn region(&mut self, word: &str, group: &str, region: &RegionSummary) {
        let volume = self.units.number(region.volume, "length³");
        let mass = self.units.number(region.mass, "mass");
        let centre = self.units.vector(region.centre, "length");
        let cells = counted(region.n_cells, "cell", "cells");
        self.line(word, &format!("{group}: {cells}, volume {volume}, mass {mass}, centre {centre}"));
        self.inertia(region);
    }

    /// The inertia of a part of the body.
    pub(super) fn inertia(&mut self, region: &RegionSummary) {
        let inertia = format!("[{}]", without_rounding(region.inertia).map(vector).join(", "));
        let inertia = self.units.with_unit(inertia, "mass·length²");
        self.line("", &format!("inertia about the centre {inertia}"));
    }

    fn mass(&mut self, group: &str, masses: &RegionSummary) {
        let mass = self.units.number(masses.mass, "mass");
        let centre = self.units.vector(masses.centre, "length");
        self.line("mass", &format!("{group}: mass {mass}, centre {centre}"));
    }

    /// A mass at each node of a group, which on an uneven mesh is not in the centre of the group.
    fn nodal_mass(&mut self, body: &Body, group: &str, mass: f64, masses: &RegionSummary) {
        let mesh = body.mesh();
        let n_nodes = mesh.group_nodes(group).map_or(0, |nodes| nodes.len());
        let mass = self.units.number(mass, "mass");
        let groups = mesh.groups();
        let is_spread = groups.facets(group).is_ok() || groups.cells(group).is_ok();
        let nodes = counted(n_nodes, "node", "nodes");
        let centre = if is_spread { body.centre_of(group).ok() } else { None };
        let Some(centre) = centre else { return self.line("", &format!("{nodes} of {mass}")) };
        let distance = (0..3).map(|i| (masses.centre[i] - centre[i]).powi(2)).sum::<f64>().sqrt();
        let what = if groups.facets(group).is_ok() { "area" } else { "cells" };
        let place = match distance <= 1e-9 * mesh.diagonal() {
            true => format!("at the centre of its {what}"),
            false => {
                let [distance, centre] =
                    [self.units.number(distance, "length"), self.units.vector(centre, "length")];
                format!("{distance} from the centre of its {what}, {centre}: `total` puts a mass there")
            }
        };
        self.line("", &format!("{nodes} of {mass}, {place}"));
    }

    /// Springs to the ground, and attractions.
    fn ground(&mut self, nodal: &PointTerms) {
        for spring in &nodal.springs {
            let stiffness = self.units.number(spring.stiffness, "force/length");
            self.line("support", &format!("{}: spring {stiffness}", spring.group));
        }
        for attraction in &nodal.attractions {
            let group = attraction.group.as_deref().unwrap_or("all nodes");
            let centre = self.units.vector(attraction.centre, "length");
            let strength = self.units.number(attraction.strength, "length³/time²");
            self.line("load", &format!("{group}: attraction to {centre}, strength {strength}"));
        }
    }

    fn load(&mut self, load: &Load, resultant: &LoadResultant, body: &Body) {
        let all_masses = if body.rigid_bodies().len() == 0 { "all cells" } else { "all masses" };
        let is_point = |name: &str| body.couplings().iter().any(|own| own.name == name);
        let is_body = |name: &str| body.nodes_of_rigid_body(name).is_some() || is_point(name);
        let force = self.units.vector(resultant.force, "force");
        let torque = self.units.vector(resultant.torque, "force·length");
        let (kind, group) = match &load.kind {
            LoadKind::Traction { group, .. } => ("traction", group.as_str()),
            LoadKind::Force { group, .. } => ("force", group.as_str()),
            LoadKind::Pressure { group, .. } => ("pressure", group.as_str()),
            LoadKind::TractionField { group, .. } => ("traction field", group.as_str()),
            LoadKind::BodyForceField { group, .. } => ("body force", group.as_deref().unwrap_or("all cells")),
            LoadKind::AccelerationField { group, .. } => {
                ("acceleration field", group.as_deref().unwrap_or(all_masses))
            }
            LoadKind::Moment { group, follow: false, .. } => ("moment", group.as_str()),
            LoadKind::Moment { group, follow: true, .. } => ("following moment", group.as_str()),
            LoadKind::FollowingForce { group, .. } => ("following force", group.as_str()),
            LoadKind::Rotation { axis, about, speed } => {
                let speed = self.units.number(*speed, "1/time");
                let about = self.units.vector(*about, "length");
                let axis = vector(*axis);
                let turns =
                    format!("rotation of the observer: {speed} about the axis {axis} through {about}");
                self.line("load", &turns);
                return self
                    .line("", &format!("centrifugal force {force}, torque about the origin {torque}"));
            }
            LoadKind::NodalForce { group, .. } if is_body(group) => ("force", group.as_str()),
            LoadKind::NodalForce { group, .. } => ("force at each node", group.as_str()),
            LoadKind::Acceleration { group, .. } => ("acceleration", group.as_deref().unwrap_or(all_masses)),
        };
        self.line("load", &format!("{kind} on {group}: force {force}, torque about the origin {torque}"));
        let history = summary(&load.time_function, self.units, "");
        match load.kind.field() {
            Some((field, _)) => {
                self.line("", &format!("at t = 0, of [{}]; history: {history}", field.text()))
            }
            None => self.line("", &format!("at factor 1; history: {history}")),
        }
    }

    fn support(&mut self, support: &Support, problem: &Problem) {
        let mesh = problem.body.mesh();
        let n_nodes = mesh.group_nodes(&support.group).map_or(0, |nodes| nodes.len());
        let fix = support.fixed_components(mesh).unwrap_or_default();
        let components = |is_in: &dyn Fn(usize) -> bool| -> Vec<&str> {
            (0..3).filter(|&i| is_in(i)).map(|i| ["x", "y", "z"][i]).collect()
        };
        let fixed = components(&|i| fix[i]);
        let moved = components(&|i| support.drives(i));
        let dofs = n_nodes * (fixed.len() + moved.len());
        let parts = [(fixed, "fixed"), (moved, "driven")];
        let parts = parts.into_iter().filter(|(components, _)| !components.is_empty());
        let parts: Vec<String> =
            parts.map(|(components, how)| format!("{} {how}", components.join(", "))).collect();
        let dofs = counted(dofs, "degree of freedom", "degrees of freedom");
        self.line("support", &format!("{}: {}, {dofs}", support.group, parts.join(", ")));
        for (component, time_function) in ["x", "y", "z"].iter().zip(&support.displacement) {
            match time_function.as_ref().map(|displacement| (displacement, displacement.acceleration())) {
                Some((displacement, Some(acceleration))) => {
                    self.line(
                        "",
                        &format!(
                            "{component} accelerates: {}",
                            summary(acceleration, self.units, "length/time²")
                        ),
                    );
                    self.line("", &drift(displacement, acceleration, problem.plan.end(), self.units));
                }
                Some((displacement, None)) => {
                    self.line(
                        "",
                        &format!("{component} moves: {}", summary(displacement, self.units, "length")),
                    );
                }
                None => {}
            }
        }
        if support.symmetry {
            self.line("", "plane of symmetry");
        }
        if let Some(time) = support.until {
            self.line("", &format!("released at t = {}", self.units.number(time, "time")));
        }
        if let Some(rotation) = &support.rotation {
            let axis = vector(rotation.axis);
            let about = self.units.vector(rotation.about, "length");
            self.line(
                "",
                &format!(
                    "turns about the axis {axis} through {about}: {}",
                    summary(&rotation.angle, self.units, "")
                ),
            );
        }
    }

    pub(super) fn time(&mut self, problem: &Problem) {
        let plan = &problem.plan;
        if problem.is_static() {
            let increments = counted(plan.n_steps(), "increment", "increments");
            self.line("analysis", &format!("static, {increments} of the loads and driven supports at t = 0"));
            return self.newton(problem);
        }
        let time = |value: f64| problem.units.number(value, "time");
        self.line("scheme", &format!("{}, degree {}", problem.scheme.name(), problem.scheme.degree()));
        let steps = counted(plan.n_steps(), "step", "steps");
        let start = time(plan.start());
        let end = time(plan.end());
        match plan.adaptivity() {
            Some(adaptivity) => self.adaptivity(adaptivity, problem),
            None => {
                self.line("plan", &format!("{steps} from t = {start} to t = {end}"));
                for phase in plan.phases() {
                    self.line("", &format!("steps of {} until {}", time(phase.size), time(phase.until)));
                }
            }
        }
        self.newton(problem);
    }

    fn newton(&mut self, problem: &Problem) {
        let newton = &problem.newton;
        let tolerance = number(newton.tolerance);
        let most = newton.max_iterations;
        self.line("newton", &format!("tolerance {tolerance}, at most {most} iterations a step"));
    }

    fn adaptivity(&mut self, adaptivity: &Adaptivity, problem: &Problem) {
        let units = self.units;
        let start = units.number(problem.plan.start(), "time");
        let end = units.number(problem.plan.end(), "time");
        let tolerance = number(adaptivity.tolerance);
        self.line(
            "plan",
            &format!("steps with an error of at most {tolerance} each, from t = {start} to t = {end}"),
        );
        let length = adaptivity.length.unwrap_or_else(|| problem.body.radius_of_gyration());
        let velocity = adaptivity
            .velocity
            .map_or(String::new(), |v| format!(", of velocities {}", units.number(v, "length/time")));
        self.line("", &format!("scale of positions {}{velocity}", units.number(length, "length")));
        if let Some([lowest, highest]) = adaptivity.degrees {
            self.line("", &format!("degrees from {lowest} to {highest}, chosen by cost"));
        }
        let size = |size: f64| if size.is_finite() { units.number(size, "time") } else { "any".into() };
        self.line("", &format!("sizes from {} to {}", size(adaptivity.smallest), size(adaptivity.largest)));
    }

    pub(super) fn output(&mut self, problem: &Problem) {
        let output = &problem.output;
        let frames = match (output.n_frames(&problem.plan), output.interval) {
            (Some(n), Some(interval)) => {
                let frames = counted(n, "frame", "frames");
                format!("{frames}, one every {} of time", self.units.number(interval, "time"))
            }
            (Some(0), None) => "no frames".to_string(),
            (Some(n), None) => counted(n, "frame", "frames"),
            (None, _) if output.every == 1 => "a frame every step".to_string(),
            (None, _) => format!("a frame every {} steps", output.every),
        };
        self.line("output", &format!("{}, {frames}", output.directory.display()));
        self.line("files", &sizes::text(problem));
        for probe in &problem.quantities.probes {
            let at = self.units.vector(problem.body.mesh().points()[probe.node], "length");
            self.line("probe", &format!("{}: node {} at {at}", probe.name, probe.node));
        }
        let limits =
            [("energy", problem.limits.energy), ("angular_momentum", problem.limits.angular_momentum)];
        for (name, limit) in limits {
            if let Some(limit) = limit {
                self.line("limit", &format!("{name} {}", number(limit)));
            }
        }
    }
}

/// A time function in short.
pub(super) fn summary(time_function: &TimeFunction, units: Units, dimension: &str) -> String {
    let entries = time_function.entries();
    match (time_function.text(), entries.iter().map(|(_, factor)| factor.abs()).fold(0.0, f64::max)) {
        (Some(text), _) => text.to_string(),
        (None, 1.0) if entries.len() == 1 => "constant".to_string(),
        (None, _) if time_function.is_measured() => {
            let values = || entries.iter().map(|(_, factor)| *factor);
            let least = values().fold(f64::INFINITY, f64::min);
            let largest = values().fold(f64::NEG_INFINITY, f64::max);
            let [start, end] = [entries[0].0, entries[entries.len() - 1].0].map(|t| units.number(t, "time"));
            let [least, largest] = [number(least), units.number(largest, dimension)];
            format!("{} rows from t = {start} to t = {end}, values from {least} to {largest}", entries.len())
        }
        (None, peak) => format!("{} times, largest factor {}", entries.len(), number(peak)),
    }
}

/// Velocity and displacement to which an acceleration leads at the end of its table or of the run.
fn drift(displacement: &TimeFunction, acceleration: &TimeFunction, end: f64, units: Units) -> String {
    let time = match acceleration.entries() {
        [_, .., (last, _)] => last.min(end),
        _ => end,
    };
    format!(
        "integrated: velocity {}, displacement {} at t = {}",
        units.number(displacement.rate(time), "length/time"),
        units.number(displacement.value(time), "length"),
        units.number(time, "time")
    )
}

/// The tensor with round-off replaced by zeros.
fn without_rounding(tensor: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let largest = tensor.iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    tensor.map(|row| row.map(|x| if x.abs() < 1e-12 * largest { 0.0 } else { x }))
}
