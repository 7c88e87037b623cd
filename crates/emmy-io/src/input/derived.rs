//! Values derived from an input, and their squares, must be finite: masses, volumes, resultants, energies.

use emmy::body::{Body, InitialVelocity, Joint, Load, Region, Support, TimeFunction};
use emmy::internals::number::short;
use emmy::motion::{State, StepPlan};

use super::fault::{Fault, Place};
use super::finite::{HELP, LARGEST};
use super::mechanism::Mechanism;
use super::nodal::PlacedNodal;
use super::placed::{Members, Placed};

/// The remark on a body at rest without loads.
pub const NOTHING_MOVES: &str =
    "nothing moves this body: there is no load, no support that moves, and no initial velocity";

/// The remark on an equilibrium without loads.
pub const UNLOADED: &str =
    "no load acts at t = 0, and no support or obstacle is displaced: the equilibrium is the undeformed body";

/// Remarks on the tables of loads, driven supports and driven joints, and on releases.
pub(super) fn of_tables(
    loads: &[Load],
    supports: &[Support],
    joints: &[Joint],
    plan: &StepPlan,
) -> Vec<String> {
    let of_loads = loads
        .iter()
        .enumerate()
        .flat_map(|(i, load)| of_table(&format!("load {i}"), &load.time_function, plan));
    let of_supports = supports.iter().enumerate().flat_map(|(i, support)| {
        let angle = support.rotation.as_ref().map(|rotation| &rotation.angle);
        let tables = support.displacement.iter().flatten().chain(angle);
        tables.flat_map(move |table| {
            of_table(&format!("support {i}"), table.acceleration().unwrap_or(table), plan)
        })
    });
    let of_joints = joints.iter().flat_map(|joint| {
        let tables = joint.drive.iter().chain(&joint.motor);
        tables.flat_map(move |table| of_table(&format!("joint `{}`", joint.name), table, plan))
    });
    of_loads.chain(of_supports).chain(of_joints).chain(of_releases(supports, joints, plan)).collect()
}

/// Begins the part of a note that says when a run ends, which a body alone does not know.
pub const END_OF_RUN: &str = "the run ends at t = ";

/// Remarks on supports and joints that are released after the end.
fn of_releases<'a>(
    supports: &'a [Support],
    joints: &'a [Joint],
    plan: &StepPlan,
) -> impl Iterator<Item = String> + 'a {
    let of_supports = supports.iter().enumerate().map(|(i, support)| (format!("support {i}"), support.until));
    let of_joints = joints.iter().map(|joint| (format!("joint `{}`", joint.name), joint.until));
    let end = plan.end();
    of_supports.chain(of_joints).filter_map(move |(name, until)| {
        let until = short(until.filter(|time| *time > end)?);
        Some(format!("{name}: {END_OF_RUN}{}, before its release at t = {until}", short(end)))
    })
}

/// Remarks on pulses that lie outside of the run or end after it.
fn of_pulses(name: &str, law: &TimeFunction, plan: &StepPlan) -> Vec<String> {
    let kinks = law.kinks();
    let ([first, ..], [.., last], Some(text)) = (&kinks[..], &kinks[..], law.text()) else {
        return Vec::new();
    };
    let [start, end, last_time] = [plan.start(), plan.end(), *last].map(short);
    if *last <= plan.start() {
        return vec![format!("{name}: no pulse of `{text}` lies in the run, which begins at t = {start}")];
    }
    if *first >= plan.end() {
        return vec![format!("{name}: no pulse of `{text}` lies in the run; {END_OF_RUN}{end}")];
    }
    if *last > plan.end() + ROUNDING * (plan.end() - plan.start()) {
        return vec![format!("{name}: {END_OF_RUN}{end}, before the end of `{text}` at t = {last_time}")];
    }
    Vec::new()
}

/// Distance from the end of a run that is rounding, as a part of its duration.
const ROUNDING: f64 = 1e-9;

/// Remarks on pulses, on a table that begins after the run, and on a measured one that the run does not use as a whole,
/// or that does not end at zero.
fn of_table(name: &str, table: &TimeFunction, plan: &StepPlan) -> Vec<String> {
    let entries = table.entries();
    if entries.is_empty() {
        return of_pulses(name, table, plan);
    }
    let ([(first, before), ..], [.., (last, value)]) = (entries, entries) else { return Vec::new() };
    let mut notes = Vec::new();
    if *first > plan.start() {
        let [first, before, start] = [*first, *before, plan.start()].map(short);
        notes.push(format!(
            "{name}: the table begins at t = {first}; its first value, {before}, acts from t = {start} on"
        ));
    }
    if !table.is_measured() {
        return notes;
    }
    if *first < plan.start() {
        let early = entries.iter().filter(|(time, _)| *time < plan.start()).count();
        let start = short(plan.start());
        notes.push(format!("{name}: {early} rows of the record lie before t = {start} and are not used"));
    }
    let peak = entries.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    if *last < plan.end() && value.abs() > REMAINDER * peak {
        let [last, value] = [*last, *value].map(short);
        notes.push(format!(
            "{name}: the record ends at t = {last} with {value}, which acts until the end of the run"
        ));
    }
    notes
}

/// Last value of a record, as a part of its largest, that is as good as zero.
const REMAINDER: f64 = 1e-3;

/// Whether anything sets the body in motion, apart from attractions to points.
pub(super) fn is_moved(
    regions: &[Placed<Region>],
    loads: &[Placed<(Load, Members)>],
    supports: &[Placed<Support>],
    initial: &[Placed<InitialVelocity>],
    mechanism: &Mechanism,
) -> bool {
    !loads.is_empty()
        || mechanism.is_driven()
        || supports.iter().any(|support| support.value.is_driven())
        || initial.iter().any(|field| is_motion(&field.value))
        || pulls(regions)
}

/// Whether springs or attractions between nodes may pull from the start.
pub(super) fn pulls(regions: &[Placed<Region>]) -> bool {
    regions.iter().any(|region| region.value.link().is_some_and(|link| link.area() == 0.0))
}

fn is_motion(field: &InitialVelocity) -> bool {
    let numbers = field.velocity.iter().chain(&field.angular_velocity).chain(field.gradient.iter().flatten());
    numbers.into_iter().any(|&value| value != 0.0)
}

/// Places of the parts of a body, in its order.
pub(super) struct Places {
    /// Places of regions, point masses, rigid bodies and spread masses, and whether they have a mass.
    masses: Vec<(Place, bool)>,
    loads: Vec<Place>,
    initial: Option<Place>,
}

impl Places {
    pub(super) fn new(
        regions: &[Placed<Region>],
        loads: &[Placed<(Load, Members)>],
        initial: &[Placed<InitialVelocity>],
        nodal: &PlacedNodal,
        mechanism: &Mechanism,
    ) -> Self {
        let regions = regions.iter().map(|region| (region.place.clone(), region.value.density > 0.0));
        let [points, spread] = nodal.places_of_masses();
        let [points, spread] = [points, spread].map(|places| places.into_iter().map(|place| (place, true)));
        let masses = points.chain(mechanism.places()).chain(spread);
        Places {
            masses: regions.chain(masses.map(|(place, has_mass)| (place.clone(), has_mass))).collect(),
            loads: loads.iter().map(|load| load.place.clone()).collect(),
            initial: initial.first().map(|field| field.place.clone()),
        }
    }

    /// Checks masses, volumes, resultants of loads, energy and momenta at the start.
    pub(super) fn check(
        &self,
        body: &Body,
        loads: &[Load],
        initial: &[InitialVelocity],
        plan: &StepPlan,
    ) -> Result<(), Fault> {
        for ((place, has_mass), region) in self.masses.iter().zip(body.regions()) {
            let is_volume = *has_mass && region.n_cells > 0;
            for (what, value, counts) in
                [("volume", region.volume, is_volume), ("mass", region.mass, *has_mass)]
            {
                if counts && !(1.0 / LARGEST..=LARGEST).contains(&value) {
                    let label = if value > 1.0 { "too large" } else { "too small" };
                    let message = format!("the {what} here is {}", short(value));
                    return Err(Fault::at(place, message, label).help(HELP));
                }
            }
        }
        if let Some((load, point, time)) = body.field_not_finite(plan.start(), plan.end()) {
            let [x, y, z] = point.map(short);
            let message = format!("this load is not a finite number at [{x}, {y}, {z}], t = {}", short(time));
            return Err(Fault::at(&self.loads[load], message, "not finite there"));
        }
        for ((place, load), resultant) in self.loads.iter().zip(loads).zip(body.load_resultants()) {
            let peak = load
                .time_function
                .entries()
                .iter()
                .fold(1.0, |peak: f64, (_, factor)| peak.max(factor.abs()));
            let force = resultant.force.map(|x| x * peak);
            check_vector(place, "resultant of this load", &force)?;
            check_vector(place, "torque of this load about the origin", &resultant.torque)?;
        }
        self.check_start(body, initial, plan.start())
    }

    fn check_start(&self, body: &Body, initial: &[InitialVelocity], start: f64) -> Result<(), Fault> {
        // An impossible start has its own fault.
        let (Some(place), Ok(state)) = (&self.initial, State::initial(body, start, initial)) else {
            return Ok(());
        };
        // On a team a call of all ranks, which comes before the first fault.
        let angular = body.moment(&state.displacement, &state.momentum);
        let products = state.momentum.iter().zip(&state.velocity).map(|(p, v)| p * v);
        check_vector(place, "kinetic energy at the start", &[products.sum::<f64>() / 2.0])?;
        check_vector(place, "momentum at the start", &emmy::internals::body::sum(&state.momentum))?;
        check_vector(place, "angular momentum at the start", &angular)
    }
}

fn check_vector(place: &Place, what: &str, values: &[f64]) -> Result<(), Fault> {
    match values.iter().find(|value| value.abs() > LARGEST || value.is_nan()) {
        Some(&value) => {
            let message = format!("the {what} is {}", short(value));
            Err(Fault::at(place, message, "too large").help(HELP))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use emmy::motion::Phase;

    #[test]
    fn tables_that_start_late_are_noted() {
        let plan = StepPlan::new(0.0, vec![Phase { until: 2.0, size: 0.1 }]).unwrap();
        let rows = vec![(0.5, 2.0), (1.0, 0.0)];
        let note = "load 0: the table begins at t = 0.5; its first value, 2, acts from t = 0 on";
        for table in [TimeFunction::new(rows.clone()), TimeFunction::measured(rows)] {
            assert_eq!(of_table("load 0", &table.unwrap(), &plan), [note]);
        }
        assert!(of_table("load 0", &TimeFunction::constant(), &plan).is_empty());
    }

    #[test]
    fn pulses_outside_of_the_run_are_noted() {
        let plan = StepPlan::new(0.0, vec![Phase { until: 2.0, size: 0.1 }]).unwrap();
        let notes = |kinks: [f64; 2]| {
            let law = TimeFunction::smooth("pulse", |t| [t, 1.0, 0.0]).with_kinks(kinks);
            of_table("load 0", &law, &plan).join("")
        };
        assert_eq!(notes([-0.1, 2.0]), "");
        assert_eq!(notes([-2.0, -1.0]), "load 0: no pulse of `pulse` lies in the run, which begins at t = 0");
        assert_eq!(notes([2.0, 3.0]), "load 0: no pulse of `pulse` lies in the run; the run ends at t = 2");
        assert_eq!(notes([1.0, 3.0]), "load 0: the run ends at t = 2, before the end of `pulse` at t = 3");
    }

    #[test]
    fn releases_after_the_end_are_noted() {
        let plan = StepPlan::new(0.0, vec![Phase { until: 2.0, size: 0.1 }]).unwrap();
        let released = |until| Support { until, ..Support::fixed("x-min") };
        let supports = [None, Some(2.0), Some(2.5)].map(released);
        let note = "support 2: the run ends at t = 2, before its release at t = 2.5";
        assert_eq!(of_tables(&[], &supports, &[], &plan), [note]);
    }

    #[test]
    fn records_that_start_early_or_end_with_a_load_are_noted() {
        let plan = StepPlan::new(0.0, vec![Phase { until: 2.0, size: 0.1 }]).unwrap();
        let notes =
            |rows: &[(f64, f64)]| of_table("load 0", &TimeFunction::measured(rows.to_vec()).unwrap(), &plan);
        assert!(notes(&[(0.0, 0.0), (0.5, 8.0), (1.0, 0.001)]).is_empty());
        assert_eq!(
            notes(&[(-0.2, 0.0), (-0.1, 1.0), (1.0, 0.5), (1.5, 0.25)]),
            [
                "load 0: 2 rows of the record lie before t = 0 and are not used",
                "load 0: the record ends at t = 1.5 with 0.25, which acts until the end of the run"
            ]
        );
        // A table in the input is meant as it stands.
        let table = TimeFunction::new(vec![(-1.0, 2.0), (1.0, 1.0)]).unwrap();
        assert!(of_table("load 0", &table, &plan).is_empty());
    }
}
