//! A motion in one part and in two, in the library.

use emmy::motion::{MarchError, Motion, Observer, Record, Snapshot, State, View};
use emmy_io::input::{self, Overrides, Problem};
use fastrand::Rng;

use crate::draw;
use crate::place::Place;

/// Snapshots of a motion that are resumed.
const SNAPSHOTS: usize = 3;

/// Steps after which a motion is stopped: an adaptive one took more than a quarter of an hour.
const MOST_STEPS: usize = 1000;

/// Stops a random motion after some steps and resumes it. Records, events and the last snapshot must be bitwise
/// identical.
///
/// # Errors
/// The difference, with the input.
pub fn resumes_in_every_bit(seed: u64) -> Result<(), String> {
    let mut rng = Rng::with_seed(seed);
    let text = draw::input(&mut rng, draw::Length::Short);
    let place = Place::new();
    place.write("draw.toml", &text);
    let with_input = |fault: String| format!("{fault}\nseed {seed}:\n{text}");
    let problem = input::read(&place.path("draw.toml"), &Overrides::default());
    let problem = problem.map_err(|error| with_input(format!("rejected: {error}")))?;
    resumes(&problem, &mut rng).map_err(with_input)
}

fn resumes(problem: &Problem, rng: &mut Rng) -> Result<(), String> {
    let start = State::initial(&problem.body, problem.plan.start(), &problem.initial);
    let start = start.map_err(|error| error.to_string())?;
    let motion = Motion::starting(&problem.body, problem.scheme, problem.newton, start);
    let mut motion = motion.map_err(|error| error.to_string())?;
    let mut whole = Watch::default();
    let end = march(problem, &mut motion, &mut whole, Motion::march);
    for _ in 0..SNAPSHOTS {
        let (after, snapshot) = whole.snapshots[rng.usize(..whole.snapshots.len())].clone();
        let resumed = Motion::resumed(&problem.body, problem.scheme, problem.newton, snapshot);
        let mut resumed = resumed.map_err(|error| format!("not resumed after step {after}: {error}"))?;
        let mut rest = Watch::default();
        let own_end = march(problem, &mut resumed, &mut rest, Motion::march_on);
        let expected = format!("{:?} {:?}", &whole.seen[after + 1..], motion.snapshot());
        let own = format!("{:?} {:?}", rest.seen, resumed.snapshot());
        if (own, &own_end) != (expected, &end) {
            let pairs = rest.seen.iter().zip(&whole.seen[after + 1..]);
            let first = pairs.into_iter().find(|(own, expected)| own != expected);
            return Err(format!(
                "another motion: resumed after step {after} of {}: {first:#?}",
                whole.seen.len() - 1
            ));
        }
    }
    Ok(())
}

/// Motion::march, or Motion::march_on.
type March<'a> =
    fn(&mut Motion<'a>, &emmy::motion::StepPlan, &mut [&mut dyn Observer]) -> Result<(), MarchError>;

/// Marches to the end or to an error.
fn march<'a>(problem: &Problem, motion: &mut Motion<'a>, watch: &mut Watch, march: March<'a>) -> String {
    motion.allow_cuts(problem.smallest_step);
    let outcome = march(motion, &problem.plan, &mut [watch]);
    outcome.err().map(|error| format!("{error:?}")).unwrap_or_default()
}

/// Every record as text with all digits, and a snapshot after each.
#[derive(Debug, Default)]
struct Watch {
    seen: Vec<String>,
    snapshots: Vec<(usize, Snapshot)>,
}

impl Observer for Watch {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let record: &Record = view.record;
        if record.step >= MOST_STEPS {
            return Err("a long motion ends here".into());
        }
        self.snapshots.push((self.seen.len(), view.motion.snapshot()));
        self.seen.push(format!("{record:?} {:?}", view.newton_residuals));
        Ok(())
    }
}
