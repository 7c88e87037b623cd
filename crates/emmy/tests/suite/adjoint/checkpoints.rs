//! Independence of a gradient from checkpoints, and the steps of a gradient.

use emmy::adjoint::{Goal, Parameter, Trajectory};
use emmy::body::{Body, Region};
use emmy::material::NeoHooke;
use emmy::mesh;
use emmy::motion::{Adaptivity, Motion, Observer, StepPlan, View};

use super::problems::*;
use super::state::oscillator;
use crate::shared::schemes::{DGM, at};

#[test]
fn the_gradient_does_not_depend_on_the_checkpoints() {
    let body = rubber();
    let (start, goal) = (disturbed(&body, 0.05, 0.5), scattered_goal(&body));
    let plan = equal(1.15, 0.05);
    for degree in [1, 3] {
        let (mut gradients, mut errors) = (Vec::new(), Vec::new());
        for spacing in [None, Some(1), Some(4), Some(7), Some(23), Some(100)] {
            let mut motion = Motion::starting(&body, at(DGM, degree), settings(), start.clone()).unwrap();
            let mut trajectory = Trajectory::new(&motion).unwrap();
            if let Some(spacing) = spacing {
                trajectory = trajectory.with_spacing(spacing);
            }
            motion.march(&plan, &mut [&mut trajectory]).unwrap();
            assert_eq!(trajectory.n_steps(), 23);
            println!("{spacing:?}: {} checkpoints", trajectory.n_checkpoints());
            let parameter =
                Parameter::linear(15.0, 15.0, |mu| held_block([30.0, mu], 1.0, 2.0, true)).unwrap();
            gradients.push(trajectory.gradient(&goal, &[parameter]).unwrap());
            errors.push(trajectory.goal_error(&goal).unwrap());
        }
        assert!(gradients.iter().all(|gradient| *gradient == gradients[0]));
        assert!(errors.iter().all(|error| *error == errors[0]));
    }
}

#[test]
fn the_gradient_does_not_depend_on_the_threads() {
    let gradient = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let rubber = Region::new(NeoHooke::new(30.0, 15.0).unwrap(), 1.0);
            let body = Body::builder(mesh::block([3.0, 6.0, 3.0], [3, 6, 3]).unwrap())
                .region(rubber)
                .build()
                .unwrap();
            let (start, goal) = (disturbed(&body, 0.02, 0.5), scattered_goal(&body));
            trajectory(&body, DGM, 2, &start, &equal(0.2, 0.1)).gradient(&goal, &[]).unwrap()
        })
    };
    let alone = gradient(1);
    assert!(alone == gradient(2) && alone == gradient(3));
}

#[test]
fn checkpoints_grow_with_the_square_root_of_the_steps() {
    let body = oscillator(1.0).unwrap();
    let start = disturbed(&body, 0.0, 0.1);
    for n in [10, 100, 1000] {
        let checkpoints = trajectory(&body, DGM, 1, &start, &equal(0.01 * n as f64, 0.01)).n_checkpoints();
        let root = f64::from(n).sqrt();
        assert!((0.5 * root..3.0 * root).contains(&(checkpoints as f64)), "{n}: {checkpoints}");
    }
}

/// Adaptive step sizes are data: differences of motions that repeat exactly these steps.
#[test]
fn gradients_of_adaptive_motions_are_those_at_their_steps() {
    let (body, start) = orbit(0.5);
    let goal = Goal::displacement_at(&body, 0, [0.6, 0.8, 0.0]);
    for degree in [1, 2] {
        let plan = StepPlan::adaptive(0.0, 1.5, Adaptivity::new(1e-4)).unwrap();
        let mut motion = Motion::starting(&body, at(DGM, degree), settings(), start.clone()).unwrap();
        let (mut trajectory, mut sizes) = (Trajectory::new(&motion).unwrap(), Sizes::default());
        motion.march(&plan, &mut [&mut trajectory, &mut sizes]).unwrap();
        let gradient = trajectory.gradient(&goal, &[]).unwrap();
        let value = |d: f64| {
            let mut state = start.clone();
            let direction = scattered(6, 1);
            shift(&body, &mut state, d, &direction, d, &direction);
            let mut motion = Motion::starting(&body, at(DGM, degree), settings(), state).unwrap();
            sizes.0.iter().for_each(|&[size, _]| {
                motion.step(size).unwrap();
            });
            goal.value(motion.state())
        };
        let direction = scattered(6, 1);
        let along = dot(&gradient.displacement, &direction) + dot(&gradient.velocity, &direction);
        let slope = slope(1e-4, value);
        println!("k = {degree}, {} steps: {along} {slope}", sizes.0.len());
        assert!((along - slope).abs() < 1e-7 * size(&gradient, [&direction; 2]), "{along} {slope}");
    }
}

/// Sizes and ends of steps.
#[derive(Default)]
struct Sizes(Vec<[f64; 2]>);

impl Observer for Sizes {
    fn observe(&mut self, view: View<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        if view.record.step > 0 {
            self.0.push([view.record.step_size, view.record.time]);
        }
        Ok(())
    }
}
