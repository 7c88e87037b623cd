//! Masses: `CONM2`, and `CMASS1`, `CMASS2` that are alike in all directions.

use emmy::internals::tensor::eigen;

use super::super::super::abaqus::At;
use super::super::super::entry::first_names;
use super::Work;
use super::body::Of;
use super::fields::{Outcome, Reason, Stored};
use super::grids::{Grids, shifted};
use super::register::{matrix, table, text, texts, vector};
use crate::vector::{distance, dot, minus};
use toml::{Table, Value};

/// A mass at a grid point.
#[derive(Debug, Clone)]
pub(super) struct Mass {
    pub(super) card: &'static str,
    pub(super) label: String,
    /// The name of its entry.
    pub(super) name: String,
    pub(super) at: At,
    pub(super) grid: u64,
    pub(super) mass: f64,
    pub(super) centre: [f64; 3],
    /// About the centre.
    pub(super) inertia: Option<[[f64; 3]; 3]>,
}

/// Words of the note on masses.
const MASSES: [&str; 2] = ["mass acts", "masses act"];

/// A tensor that counts as zero beside another one.
const ROUNDING: f64 = 1e-9;

impl Mass {
    /// The mass of `CONM2`.
    fn of_card(card: &Stored, grids: &mut Grids<'_>) -> Outcome<Self> {
        let label = card.number(0)?.to_string();
        let grid = card.number(1)?;
        grids.known(grid)?;
        let mass = card.real(3)?;
        let mut offset = [0.0; 3];
        for (i, x) in offset.iter_mut().enumerate() {
            *x = card.real(4 + i)?;
        }
        let mut lower = [0.0; 6];
        for (i, x) in lower.iter_mut().enumerate() {
            *x = card.real(8 + i)?;
        }
        let place = grids.place(grid);
        let is_absolute = card.field(2) == "-1";
        let system = if is_absolute || card.field(2).is_empty() { 0 } else { card.number(2)? };
        let axes = grids.axes(system, grid)?;
        let centre = if is_absolute { offset } else { shifted(place, &axes, offset) };
        let [xx, yx, yy, zx, zy, zz] = lower;
        let own = [[xx, -yx, -zx], [-yx, yy, -zy], [-zx, -zy, zz]];
        let inertia = lower.iter().any(|x| *x != 0.0).then(|| turned(&own, &axes));
        let has_inertia = inertia.is_some();
        if mass <= 0.0 {
            return Err(Reason::new(match has_inertia {
                true => "an inertia needs a mass above 0",
                false => "its mass is not above 0",
            }));
        }
        let name = format!("conm2_{label}");
        Ok(Mass { card: card.name, label, name, at: card.at, grid, mass, centre, inertia })
    }
}

/// A symmetric tensor with components along some axes, in the basic system.
fn turned(own: &[[f64; 3]; 3], axes: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| {
        let row = |a: usize| (0..3).map(|b| axes[a][i] * own[a][b] * axes[b][j]).sum::<f64>();
        (0..3).map(row).sum::<f64>()
    };
    let mut all = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            // Symmetric to the last digit.
            all[i][j] = entry(i, j);
            all[j][i] = all[i][j];
        }
    }
    all
}

/// Whether a body can have an inertia: no second moment of its mass is negative.
fn is_of_a_body(inertia: &[[f64; 3]; 3]) -> bool {
    let trace = inertia[0][0] + inertia[1][1] + inertia[2][2];
    let second = |i: usize, j: usize| if i == j { 0.5 * trace - inertia[i][j] } else { -inertia[i][j] };
    let (moments, _) = eigen(&[(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)].map(|(i, j)| second(i, j)));
    trace > 0.0 && moments.iter().all(|moment| *moment > -ROUNDING * trace)
}

/// Mass, centre and inertia of several masses that move as one body; none: all lie at one place.
fn combined(masses: &[Mass]) -> (f64, [f64; 3], Option<[[f64; 3]; 3]>) {
    if let [mass] = masses {
        return (mass.mass, mass.centre, mass.inertia);
    }
    let total: f64 = masses.iter().map(|mass| mass.mass).sum();
    let first = masses[0].centre;
    let mean =
        |i: usize| masses.iter().map(|mass| mass.mass * (mass.centre[i] - first[i])).sum::<f64>() / total;
    let centre = [0, 1, 2].map(|i| first[i] + mean(i));
    let mut all = [[0.0; 3]; 3];
    for mass in masses {
        let arm = minus(mass.centre, centre);
        let own = mass.inertia.unwrap_or_default();
        for i in 0..3 {
            for j in 0..3 {
                let square = if i == j { dot(arm, arm) } else { 0.0 };
                all[i][j] += own[i][j] + mass.mass * (square - arm[i] * arm[j]);
            }
        }
    }
    let is_zero = all.iter().flatten().all(|x| *x == 0.0);
    (total, centre, (!is_zero).then_some(all))
}

fn with_inertia(mut table: Table, inertia: Option<[[f64; 3]; 3]>) -> Table {
    table.extend(inertia.map(|inertia| ("inertia".to_string(), matrix(inertia))));
    table
}

impl Work<'_> {
    /// Reads all `CONM2`.
    pub(super) fn collect_masses(&mut self) {
        for card in self.cards.iter().filter(|card| card.name == "CONM2") {
            match Mass::of_card(card, &mut self.grids) {
                Ok(mut mass) => {
                    if mass.inertia.is_some_and(|inertia| !is_of_a_body(&inertia)) {
                        mass.inertia = None;
                        self.without("inertia", &mass, "no body has it");
                    }
                    self.masses.push(mass);
                }
                Err(reason) => self.register.leave_out(card, reason),
            }
        }
    }

    /// Notes that a part of a mass does not act.
    fn without(&mut self, part: &str, mass: &Mass, why: &'static str) {
        let what = format!("the {part} of {}", mass.card);
        self.register.leave_out_named(&what, mass.label.clone(), mass.at, Reason::new(why));
    }

    /// Makes entries of all masses.
    pub(super) fn place_masses(&mut self) {
        let masses = std::mem::take(&mut self.masses);
        for (of, masses) in self.masses_of(masses) {
            match of {
                Of::Body(body) if self.bodies[body].nodes.is_empty() => self.free_body(body, &masses),
                Of::Body(body) => masses.into_iter().for_each(|mass| self.mass_of_body(body, mass)),
                Of::Grid(grid) => match self.means.get(&grid).cloned() {
                    Some(name) => {
                        masses.iter().for_each(|mass| {
                            self.mass_alone(
                                grid,
                                &name,
                                mass,
                                "the point of a distributing coupling has none",
                            );
                        });
                    }
                    None if self.grids.is_of_cell(grid) => {
                        for mass in &masses {
                            let name = self.register.group(&format!("{}-node", mass.name), [grid]);
                            self.mass_alone(grid, &name, mass, "a node of a cell has none");
                        }
                    }
                    None if self.lost.contains(&grid) => {
                        for Mass { card, label, at, .. } in masses {
                            let reason = Reason::new("a rigid element at its grid point is left out");
                            self.register.leave_out_named(card, label, at, reason);
                        }
                    }
                    None => self.free_mass(grid, &masses),
                },
            }
        }
    }

    /// A mass at a point that does not turn.
    fn mass_alone(&mut self, grid: u64, group: &str, mass: &Mass, why: &'static str) {
        if mass.inertia.is_some() {
            self.without("inertia", mass, why);
        }
        if !self.grids.is_near(mass.centre, self.grids.place(grid)) {
            self.without("offset", mass, why);
        }
        self.add_mass(group, mass, None);
    }

    fn add_mass(&mut self, group: &str, mass: &Mass, inertia: Option<[[f64; 3]; 3]>) {
        let name = self.register.name(&mass.name);
        let rows = table([("group", text(group)), ("mass", Value::Float(mass.mass))]);
        let own = (mass.card, mass.label.clone());
        self.register.used.insert(mass.grid);
        self.register.add("mass", &name, own, MASSES, with_inertia(rows, inertia));
    }

    fn mass_of_body(&mut self, body: usize, mass: Mass) {
        let own = self.resolved(mass.grid);
        let is_at = |place: [f64; 3]| self.grids.is_near(mass.centre, place);
        if is_at(self.grids.place(own)) && self.grids.is_of_cell(own) && mass.inertia.is_none() {
            let group = self.register.group(&format!("{}-node", mass.name), [own]);
            return self.add_mass(&group, &mass, None);
        }
        let coupling = self.bodies[body].name.clone();
        if is_at(self.bodies[body].place) {
            return self.add_mass(&coupling, &mass, mass.inertia);
        }
        let name = self.add_rigid((mass.card, mass.label.clone()), &mass.name, &mass, mass.inertia);
        let joint = self.register.name(&format!("{name}-joint"));
        let kind = if mass.inertia.is_some() { "fixed" } else { "spherical" };
        let between = texts([&name, &coupling]);
        let row = Value::Table(table([("between", between), ("at", vector(mass.centre))]));
        let own = (mass.card, mass.label.clone());
        let what = [
            "joint holds a mass beside its rigid coupling",
            "joints hold masses beside their rigid couplings",
        ];
        self.register.add("joint", &joint, own, what, table([("name", text(&joint)), (kind, row)]));
    }

    fn add_rigid(
        &mut self,
        card: (&'static str, String),
        name: &str,
        mass: &Mass,
        inertia: Option<[[f64; 3]; 3]>,
    ) -> String {
        let name = self.register.name(name);
        let rows =
            [("name", text(&name)), ("mass", Value::Float(mass.mass)), ("centre", vector(mass.centre))];
        self.register.used.insert(mass.grid);
        self.register.add("rigid", &name, card, MASSES, with_inertia(table(rows), inertia));
        name
    }

    /// The masses of a rigid body that has no node of a cell.
    fn free_body(&mut self, body: usize, masses: &[Mass]) {
        let (mass, centre, inertia) = combined(masses);
        let own = &self.bodies[body];
        let (name, card) = (own.name.clone(), (own.card, own.label.clone()));
        let rows = [("name", text(&name)), ("mass", Value::Float(mass)), ("centre", vector(centre))];
        let what = ["rigid body without cells acts", "rigid bodies without cells act"];
        let labels: Vec<String> = masses.iter().map(|mass| format!("{} {}", mass.card, mass.label)).collect();
        self.register.remark(format!("{name} has the masses of {}", first_names(&labels)));
        let size = masses.iter().map(|mass| distance(mass.centre, centre)).fold(0.0, f64::max);
        let is_point = inertia.is_none() && size == 0.0;
        let inertia = inertia.filter(|_| !is_point);
        self.register.add("rigid", &name, card, what, with_inertia(table(rows), inertia));
    }

    /// The masses of a grid point without cells.
    fn free_mass(&mut self, grid: u64, masses: &[Mass]) {
        let (mass, centre, inertia) = combined(masses);
        let first = &masses[0];
        let label = |mass: &Mass| match mass.card == first.card {
            true => mass.label.clone(),
            false => format!("{} {}", mass.card, mass.label),
        };
        let labels: Vec<String> = masses.iter().map(label).collect();
        let all = Mass { mass, centre, inertia, ..first.clone() };
        let name = self.add_rigid((first.card, labels.join(", ")), &first.name, &all, inertia);
        self.register.used.insert(grid);
        self.free.insert(grid, (name, centre, inertia.is_some()));
    }
}
